"""The colour of a fit's residuals at the pendulum's frequencies, and what it does to the fitted values' uncertainty.

Residuals are rarely independent: noise has a spectrum, and an incomplete model leaves swings of its own. What counts is
their spectrum where the fitted values act, at the pendulum's frequency and its first harmonics. There it is taken from an
autoregressive model of the residuals, averaged to so many a period (Burg's recursion; the order by BIC), which is a flat
spectrum for white noise and a peak for a model that misses something. Least squares keep their optimum: where the noise's
spectrum is smooth about one frequency, weights by it would gain next to nothing (Grenander, Ann. Math. Stat. 25, 252 (1954)).
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.special import stdtrit

from ..arrays import Floats
from ..engine.trajectory import sensitivities
from ..pendulum.effect import NATURAL_FREQUENCY
from ..quantisation import quantisation_step, rounding
from .problem import RELEASE, Swings
from .result import Fit

_A_PERIOD = 24  # means of residuals, a period: the pendulum's third harmonic is still there
_HIGHEST = 12  # order of the autoregressive model
_LEAST_DOF = 3.0
_FEWEST = 20  # means for each order


class Colour(NamedTuple):
    """An autoregressive model of a series: x_k = sum of coefficients times the x before + noise of this variance (rad^2)."""

    coefficients: Floats
    variance: float

    def spectrum(self, size: int) -> Floats:
        """The variance (rad^2) of white noise as strong at each of ``size // 2 + 1`` frequencies up to half the rate."""
        return self.variance / np.abs(np.fft.rfft(np.r_[1.0, -self.coefficients], size)) ** 2


@dataclass(frozen=True)
class Uncertainty:
    """The uncertainty of a fit's values that knows the colour of its residuals, in the order of ``fit.free``.

    ``random`` is their covariance by noise and by what the model misses, ``systematic`` (free, source) what the fit's
    ``sources`` do, ``covariance`` both together. ``inflation``: the random variance over that of independent residuals,
    geometric mean; n over this is the number of samples that count as independent. ``noise`` (rad): the standard deviation of
    white noise with this spectrum at the pendulum's frequencies; ``dof``: degrees of freedom that its size is known to. NaN for
    values that a bound holds.
    """

    random: Floats
    systematic: Floats
    inflation: float
    noise: float
    dof: float

    @property
    def factors(self) -> Floats:
        """By value the k of an interval value ± k standard errors that holds it with 95 % (JCGM 100, annex G): Student's, with
        the degrees of freedom of the random part and any number of the systematic one."""
        systematic = np.sum(self.systematic**2, axis=1)
        with np.errstate(invalid="ignore", divide="ignore"):
            whole = self.dof * (1 + systematic / np.diag(self.random)) ** 2
        return np.where(np.isfinite(whole), stdtrit(np.where(np.isfinite(whole), whole, 1e9), 0.975), np.nan)

    @property
    def covariance(self) -> Floats:
        """Random and systematic covariance together."""
        return self.random + self.systematic @ self.systematic.T


def uncertainty(fit: Fit, swings: Swings) -> Uncertainty:
    """The ``Uncertainty`` of a fit's values; ``swings`` are the (times in s, angles in rad) that were fitted.

    The sandwich A S A: A the inverse of J'J with what is known beforehand, S = J' R J with the autocovariance R that the
    residuals' autoregressive model has (White, Econometrica 48, 817 (1980), with a parametric middle). Swings count as
    independent. Where readings come in steps, S has what their rounding adds.
    """
    held = ~np.isfinite(np.diag(fit.covariance))
    scale = np.sqrt(np.where(held, 1.0, np.diag(fit.covariance)))
    size = len(fit.free)
    hessian, scores = np.zeros((2, size, size))
    parts = list(_means(fit, swings))
    for colour, members in _coloured(parts):
        for part in members:
            place = np.ix_(part.where, part.where)
            slopes = part.slopes * scale[part.where, np.newaxis]
            hessian[place] += part.each * slopes @ slopes.T
            scores[place] += part.each**2 * _weighted(slopes, colour)
            scores[place] += part.rounding * np.outer(scale[part.where], scale[part.where])
    kept = np.ix_(~held, ~held)
    slack, precision = fit.model.slack, np.zeros((size, size))
    if slack.names and all(name in fit.free for name in slack.parameters):
        at = [fit.free.index(name) for name in slack.parameters]
        precision[np.ix_(at, at)] = slack.precision * np.outer(scale[at], scale[at])
    random = np.full((size, size), np.nan)
    inverse = np.linalg.inv((hessian + precision)[kept])
    random[kept] = inverse @ scores[kept] @ inverse * np.outer(scale, scale)[kept]
    plain = fit.rss / fit.n * np.diag(inverse @ hessian[kept] @ inverse) * scale[~held] ** 2
    ratio = np.diag(random)[~held] / plain
    ratio = ratio[np.isfinite(ratio) & (ratio > 0)]
    inflation = float(np.exp(np.mean(np.log(ratio)))) if ratio.size else np.nan
    # the fit took its values' share out of the residuals just where their spectrum is asked for
    dof = max(fit.n / max(1.0, inflation) - size, _LEAST_DOF) if ratio.size else np.nan
    random *= 1 + size / dof
    noise = float(np.sqrt(fit.rss / fit.n * inflation * (1 + size / dof)))
    return Uncertainty(random, fit.systematic, inflation, noise, dof)


class _Part(NamedTuple):
    """One swing's residual and slopes as means of ``each`` samples: where its free values sit, slopes, residual, interval (s);
    and what rounding adds to the covariance of slopes times residuals, of all samples."""

    where: Floats
    slopes: Floats
    residual: Floats
    interval: float
    each: int
    rounding: Floats


def _means(fit: Fit, swings: Swings) -> Iterator[_Part]:
    own = [*fit.swings[0].own, *(RELEASE if RELEASE[0] in fit.free else ())]
    shared = len(fit.free) - len(own) * len(swings)
    period = 2 * np.pi / fit.model.values[NATURAL_FREQUENCY.name]
    for k, ((times, angle), fitted) in enumerate(zip(swings, fit.swings, strict=True)):
        where = np.r_[:shared, shared + k * len(own) : shared + (k + 1) * len(own)]
        release = fitted.release_angle, fitted.release_velocity
        slopes = sensitivities(fitted.model, times, *release, free=[fit.free[i] for i in where])[1]
        interval = (times[-1] - times[0]) / (times.size - 1)
        each = max(1, int(period / _A_PERIOD / interval))
        residual = angle - fitted.angle
        rounded = _rounding(slopes, angle, fitted.angle, float(np.var(residual)))
        yield _Part(where, _mean(slopes, each), _mean(residual, each), each * interval, each, rounded)


def _rounding(slopes: Floats, angle: Floats, fitted: Floats, variance: float) -> Floats:
    """What the steps in which the angles (rad) of a swing come add to the covariance of slopes times residuals."""
    step = quantisation_step(angle)
    before = np.sqrt(max(0.0, variance - step**2 / 12))
    return rounding(slopes, fitted, step, before) if step else np.zeros((len(slopes), len(slopes)))


def _mean(series: Floats, each: int) -> Floats:
    """Means of ``each`` neighbours along the last axis; what is left at the end goes."""
    whole = series.shape[-1] // each * each
    return series[..., :whole].reshape(*series.shape[:-1], -1, each).mean(axis=-1)


def _coloured(parts: Sequence[_Part]) -> Iterator[tuple[Colour, list[_Part]]]:
    """The colour of all swings of about one sampling interval together, with these swings."""
    left = list(parts)
    while left:
        alike = [part for part in left if abs(part.interval / left[0].interval - 1) < 0.05]
        left = [part for part in left if not any(part is one for one in alike)]
        yield autoregression([part.residual for part in alike]), alike


def _weighted(slopes: Floats, colour: Colour) -> Floats:
    """J' R J for the slopes (free, means) and the autocovariance of a colour."""
    size = 2 * slopes.shape[1]
    spectrum = np.fft.rfft(slopes, size)
    weight = colour.spectrum(size) / size
    weight[1 : (size + 1) // 2] *= 2
    return np.real((spectrum * weight) @ spectrum.conj().T)


def autoregression(series: Sequence[Floats], highest: int = _HIGHEST) -> Colour:
    """The ``Colour`` of series that share one: Burg's coefficients of the order that BIC prefers.

    Their means are not taken off: of a residual they are part of the error.
    """
    forward, backward = [np.asarray(one, dtype=float) for one in series], []
    backward = list(forward)
    n = sum(one.size for one in forward)
    variance = sum(float(one @ one) for one in forward) / n
    best, coefficients = Colour(np.zeros(0), variance), np.zeros(0)
    least = n * np.log(variance) if variance > 0 else -np.inf
    for order in range(1, min(highest, min(one.size for one in forward) // _FEWEST) + 1):
        ahead, behind = [one[1:] for one in forward], [one[:-1] for one in backward]
        power = sum(float(a @ a + b @ b) for a, b in zip(ahead, behind, strict=True))
        if not (variance > 0 and power > 0):
            break
        reflection = 2 * sum(float(a @ b) for a, b in zip(ahead, behind, strict=True)) / power
        coefficients = np.r_[coefficients - reflection * coefficients[::-1], reflection]
        forward = [a - reflection * b for a, b in zip(ahead, behind, strict=True)]
        backward = [b - reflection * a for a, b in zip(ahead, behind, strict=True)]
        variance *= 1 - reflection**2
        bic = n * np.log(variance) + order * np.log(n)
        if bic < least:
            best, least = Colour(coefficients, variance), bic
    return best
