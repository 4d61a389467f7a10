"""Propagation of uncertainty: first order (JCGM 100), by Monte Carlo (JCGM 101), and of means of correlated samples."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import inf, isinf, sqrt
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import stdtrit

from ..arrays import Floats
from ..errors import InputError

# What a stated limit is divided by to get a standard uncertainty. A normal limit is taken for a 95 % one.
DIVISORS = {"uniform": sqrt(3), "triangular": sqrt(6), "arcsine": sqrt(2), "normal": 1.959963984540054}
KINDS = ("random", "systematic")


@dataclass(frozen=True)
class Input:
    """An input quantity: its best value and its uncertainty.

    Attributes
    ----------
    name, unit
        What it is.
    value, standard_uncertainty
        In that unit.
    distribution
        ``normal``, ``uniform``, ``triangular``, ``arcsine``, or ``t`` with ``dof`` degrees of freedom.
    dof
        Degrees of freedom.
    limit
        The stated half width that the uncertainty comes from, or None.
    kind
        ``random`` errors differ from sample to sample, ``systematic`` ones are shared by all.
    """

    name: str
    value: float
    standard_uncertainty: float
    distribution: str = "normal"
    dof: float = inf
    unit: str = "1"
    limit: float | None = None
    kind: str = "systematic"

    @property
    def divisor(self) -> float:
        """limit / standard uncertainty; 1 if the uncertainty was given as a standard uncertainty."""
        return DIVISORS[self.distribution] if self.limit is not None else 1.0

    def draw(self, generator: np.random.Generator, draws: int) -> Floats:
        """``draws`` values of the quantity from a numpy ``generator``."""
        if self.distribution == "t":
            scale = self.standard_uncertainty * (sqrt((self.dof - 2) / self.dof) if self.dof > 2 else 1.0)
            return self.value + scale * generator.standard_t(self.dof, draws)
        if self.distribution == "normal":
            return self.value + self.standard_uncertainty * generator.standard_normal(draws)
        half = self.standard_uncertainty * DIVISORS[self.distribution]
        if self.distribution == "uniform":
            return self.value + half * generator.uniform(-1, 1, draws)
        if self.distribution == "triangular":
            return self.value + half * generator.triangular(-1, 0, 1, draws)
        return self.value + half * np.sin(generator.uniform(-np.pi, np.pi, draws))


def from_limit(name: str, value: float, limit: float, distribution: str = "uniform", **more: Any) -> Input:
    """The ``Input`` whose true value lies within ``limit`` of ``value``.

    Raises
    ------
    InputError
        For a limit that is not above 0.
    """
    if not limit > 0:
        problem = f"it is {limit:g}"
        raise InputError(f"limit of {name}", problem, "a number above 0", "state the instrument's limit")
    if distribution not in DIVISORS:
        problem = f"unknown distribution {distribution!r}"
        raise InputError(f"distribution of {name}", problem, ", ".join(DIVISORS), "use one of these")
    return Input(name, float(value), limit / DIVISORS[distribution], distribution, limit=float(limit), **more)


@dataclass(frozen=True)
class Propagation:
    """A first-order propagation of n inputs to m outputs.

    Attributes
    ----------
    inputs
        The inputs, in their order.
    value
        Of shape (m,).
    sensitivity
        Of shape (m, n).
    covariance
        Of shape (m, m).
    contributions
        Sensitivity times standard uncertainty, of shape (m, n).
    dof
        Effective degrees of freedom, of shape (m,).
    """

    inputs: tuple
    value: np.ndarray
    sensitivity: np.ndarray
    covariance: np.ndarray
    contributions: np.ndarray
    dof: np.ndarray

    @property
    def standard_uncertainty(self) -> Floats:
        """The standard uncertainties of the outputs."""
        return np.sqrt(np.diag(self.covariance))

    def expanded(self, coverage: float = 0.95) -> Floats:
        """The half widths of the coverage intervals, U = k u."""
        return self.standard_uncertainty * coverage_factor(self.dof, coverage)


def propagate_gum(
    function: Callable[[Floats], ArrayLike], inputs: Sequence[Input], correlation: ArrayLike | None = None
) -> Propagation:
    """The ``Propagation`` of ``inputs`` through ``function`` to first order (JCGM 100, 5.1 and 5.2).

    Sensitivities are central differences over a third of a standard uncertainty, extrapolated once. Degrees of freedom follow
    Welch and Satterthwaite, which holds for independent inputs only.

    Parameters
    ----------
    function
        Takes the inputs along the first axis, and returns one output or several along the first axis; draws are along the last.
    inputs
        The n input quantities.
    correlation
        Of the inputs, of shape (n, n). Default: none.
    """
    values = np.array([i.value for i in inputs])
    u = np.array([i.standard_uncertainty for i in inputs])
    value = np.atleast_1d(np.asarray(function(values), dtype=float))
    sensitivity = np.zeros((len(value), len(inputs)))
    moved = np.flatnonzero(u)
    if moved.size:
        # one call for all of them: each input moved by a third and by a sixth of u, up and down
        parts = np.array([1 / 6, -1 / 6, 1 / 3, -1 / 3])
        shifted = np.repeat(values[:, np.newaxis], parts.size * moved.size, axis=1)
        rows = np.repeat(moved, parts.size)
        shifted[rows, np.arange(rows.size)] += np.tile(parts, moved.size) * u[rows]
        found = np.broadcast_to(function(shifted), (len(value), rows.size)).reshape(
            -1, moved.size, parts.size
        )
        at = shifted[rows, np.arange(rows.size)].reshape(moved.size, parts.size)
        # an u that is nothing beside its value moves it by nothing
        with np.errstate(invalid="ignore", divide="ignore"):
            near, far = ((found[:, :, k] - found[:, :, k + 1]) / (at[:, k] - at[:, k + 1]) for k in (0, 2))
            sensitivity[:, moved] = (4 * near - far) / 3
    contributions = sensitivity * u
    correlation = np.eye(len(inputs)) if correlation is None else np.asarray(correlation, dtype=float)
    covariance = contributions @ correlation @ contributions.T
    dof = np.array(
        [
            _welch_satterthwaite(row, [i.dof for i in inputs], sqrt(max(variance, 0.0)))
            for row, variance in zip(contributions, np.diag(covariance), strict=True)
        ]
    )
    return Propagation(tuple(inputs), value, sensitivity, covariance, contributions, dof)


def draw_inputs(
    inputs: Sequence[Input], draws: int, seed: int | Sequence[int], correlation: ArrayLike | None = None
) -> Floats:
    """Joint draws of the inputs (JCGM 101), of shape (input, draw).

    Parameters
    ----------
    inputs, correlation
        As in ``propagate_gum``. Correlated inputs are drawn as multivariate normal ones, which they must be.
    draws
        How many draws.
    seed
        The same seed gives the same draws.
    """
    generator = np.random.Generator(np.random.PCG64(seed))
    if correlation is None:
        return np.array([i.draw(generator, draws) for i in inputs])
    if any(i.distribution != "normal" for i in inputs):
        problem = "correlated inputs that are not normal"
        raise InputError("monte carlo", problem, "normal inputs, or no correlation")
    u = np.array([i.standard_uncertainty for i in inputs])
    covariance = np.asarray(correlation) * np.outer(u, u)
    return generator.multivariate_normal([i.value for i in inputs], covariance, draws, method="eigh").T


def symmetric_interval(values: Floats, coverage: float = 0.95) -> tuple[Floats, Floats]:
    """The ends of the interval that leaves out equal shares of draws on either side.

    Parameters
    ----------
    values
        Of shape (…, draw).
    coverage
        The share of draws in the interval.

    Returns
    -------
    low, high
        Each of shape (…).
    """
    return tuple(np.quantile(values, [(1 - coverage) / 2, (1 + coverage) / 2], axis=-1))


def _welch_satterthwaite(contributions: Floats, dof: Sequence[float], combined: float) -> float:
    """The effective degrees of freedom of a sum of independent contributions (JCGM 100, G.4) to a ``combined`` uncertainty; inf if all are."""
    below = sum(c**4 / d for c, d in zip(contributions, dof, strict=True) if not isinf(d) and c)
    return combined**4 / below if below else inf


def coverage_factor(dof: ArrayLike, coverage: float = 0.95) -> Floats:
    """The k for which an interval of half width k u covers a share (Student's t; normal for infinite dof).

    Parameters
    ----------
    dof
        Degrees of freedom, of any shape, which the result has too.
    coverage
        The share.
    """
    return stdtrit(np.asarray(dof, dtype=float), (1 + coverage) / 2)  # scipy.stats takes a second to load


@dataclass(frozen=True)
class Mean:
    """A mean of successive samples: ``standard_uncertainty`` and ``dof`` take their correlation into account."""

    value: float
    standard_deviation: float
    standard_uncertainty: float
    dof: float
    lag_1: float
    effective_samples: float


def mean_of_samples(samples: ArrayLike) -> Mean:
    """The ``Mean`` of equally spaced samples, its Type A uncertainty widened for autocorrelation.

    The correlation time sums the autocorrelation up to the first lag where the sum of two neighbours is not positive (Geyer
    1992). Anticorrelation narrows nothing.

    Parameters
    ----------
    samples
        Of shape (n,), in any unit.
    """
    x = np.asarray(samples, dtype=float)
    n = len(x)
    if n < 2:
        raise InputError("mean of samples", f"{n} sample(s)", "at least two", "record for longer")
    centre = x[0] + np.mean(x - x[0])  # the mean of small differences keeps its digits under a large offset
    r = x - centre
    r = r - r.mean()
    variance = np.dot(r, r) / (n - 1)
    if variance == 0:
        return Mean(float(centre), 0.0, 0.0, float(n - 1), 0.0, float(n))
    size = 1 << (2 * n - 1).bit_length()
    power = np.abs(np.fft.rfft(r, size)) ** 2
    rho = np.fft.irfft(power, size)[:n] / np.dot(r, r)
    pairs = rho[1 : n - (n - 1) % 2].reshape(-1, 2).sum(axis=1) if n > 2 else np.array([])
    pairs = pairs[: int(np.argmax(pairs <= 0))] if np.any(pairs <= 0) else pairs
    effective = n / max(1.0, 1 + 2 * pairs.sum())
    u = sqrt(variance / effective)
    return Mean(float(centre), sqrt(variance), u, max(effective - 1, 1.0), float(rho[1]), float(effective))
