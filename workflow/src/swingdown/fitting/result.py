"""What fits give: a model with its covariance and each swing's part in it, and many fits at once as arrays."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..arrays import Bools, Floats
from ..pendulum.model import Model


class SwingStart(NamedTuple):
    """The start of the fit of one swing.

    Attributes
    ----------
    values
        By parameter name.
    release_angle, release_velocity
        In rad and rad/s.
    """

    values: Mapping[str, float]
    release_angle: float
    release_velocity: float


@dataclass(frozen=True)
class Begin:
    """Where a joint fit begins: a model, and for each swing its values and its release."""

    model: Model
    swings: tuple[SwingStart, ...]


@dataclass(frozen=True)
class SwingFit:
    """One swing's part in a fit.

    Attributes
    ----------
    model
        The shared values with the swing's own.
    release_angle, release_velocity
        In rad and rad/s.
    angle
        The fitted series, in rad.
    rms
        Of its residual, in rad.
    own
        By name, the parameters that other swings do not share.
    """

    model: Model
    release_angle: float
    release_velocity: float
    angle: Floats
    rms: float
    own: Mapping[str, float]


@dataclass(frozen=True)
class Fit:
    """A model fitted to one swing, or to several at once.

    Attributes
    ----------
    model
        The model with the fitted values; the means of parameters that are not shared.
    free
        Names of the fitted values: parameters, then ``release_angle`` (rad) and ``release_velocity`` (rad/s) of each swing.
    values
        The fitted values, of shape (free,).
    covariance
        s^2 (J'J)^-1 with s^2 = rss / (n - k), plus what slack and clock leave open.
    systematic
        The effect of one standard uncertainty of each of ``sources`` on each value, of shape (free, source).
    rss
        Sum of squares, in rad^2, with the nuisance values' distance from their prior.
    n
        Number of samples.
    swings
        Each swing's part.
    method, converged, message, evaluations
        How it was reached.
    """

    model: Model
    method: str
    free: tuple[str, ...]
    values: Floats
    covariance: Floats
    rss: float
    n: int
    swings: tuple[SwingFit, ...]
    converged: bool
    message: str
    evaluations: int
    systematic: Floats

    @property
    def sources(self) -> tuple[str, ...]:
        """Where the systematic part comes from: the sources of the model's slack, then the clock."""
        return (*self.model.slack.sources, "clock")

    @property
    def rms(self) -> float:
        """Root mean square of data minus fit, rad."""
        return float(np.sqrt(self.rss / self.n))

    @property
    def only(self) -> SwingFit:
        """The one swing of a fit that has no other; ValueError where there are several."""
        (swing,) = self.swings
        return swing

    @property
    def models(self) -> tuple[Model, ...]:
        """The model of each swing: shared values with the swing's own."""
        return tuple(swing.model for swing in self.swings)

    @property
    def angle(self) -> Floats:
        """The fitted series (rad), of all swings one after the other."""
        return np.concatenate([swing.angle for swing in self.swings])

    @property
    def begin(self) -> Begin:
        """Where another fit of the same swings begins to go on from this one."""
        swings = (SwingStart(s.model.values, s.release_angle, s.release_velocity) for s in self.swings)
        return Begin(self.model, tuple(swings))

    @property
    def standard_errors(self) -> Floats:
        """Standard errors in the order of ``free``; not finite where the data do not determine a value."""
        return np.sqrt(np.diag(self.covariance))

    @property
    def correlation(self) -> Floats:
        """The correlation matrix in the order of ``free``."""
        errors = self.standard_errors
        return self.covariance / np.outer(errors, errors)

    @property
    def bic(self) -> float:
        """Bayesian information criterion, n ln(rss/n) + k ln n, for independent residuals of one unknown variance."""
        return float(self.n * np.log(self.rss / self.n) + len(self.free) * np.log(self.n))

    @property
    def aicc(self) -> float:
        """Akaike's criterion with the correction for small samples."""
        k = len(self.free) + 1
        return float(self.n * np.log(self.rss / self.n) + 2 * k + 2 * k * (k + 1) / (self.n - k - 1))


@dataclass(frozen=True)
class BatchFit:
    """Many series fitted alike.

    Attributes
    ----------
    free
        Names of the fitted values.
    values
        Of shape (series, free).
    rss
        Sums of squares, in rad^2, of shape (series,).
    converged, evaluations, alone
        Of each series; ``alone`` was not fitted side by side with others.
    off
        RMS (rad) of the fit less the reference, or None.
    """

    free: tuple[str, ...]
    values: Floats
    rss: Floats
    converged: Bools
    evaluations: NDArray[np.int32]
    alone: Bools
    off: Floats | None = None
