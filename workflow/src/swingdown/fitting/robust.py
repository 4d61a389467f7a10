"""Covariance of a fit's values where its residuals are autocorrelated, as those of an incomplete model are."""

from collections.abc import Iterator
from math import ceil, pi
from typing import Any

import numpy as np

from ..arrays import Floats
from ..engine.trajectory import sensitivities
from .problem import Swings
from .result import Fit

_SHARE = 10  # of the record: the longest memory that is looked for


def robust_covariance(fit: Fit, swings: Swings) -> Floats:
    """The covariance of the values in ``fit.free`` (same order and units) that allows for autocorrelated residuals.

    ``swings`` are the (times in s, angles in rad) that were fitted, one or several, all parameters shared. The sandwich
    H^-1 S H^-1 with H = J'J and S the sum of residual products up to a tenth of a swing apart (and no less than a
    period), with Bartlett's weights (Newey and West, Econometrica 55, 703 (1987)). Swings count as independent. NaN for
    values whose ordinary covariance is NaN.
    """
    held = ~np.isfinite(np.diag(fit.covariance))
    scale = np.sqrt(np.where(held, 1.0, np.diag(fit.covariance)))
    hessian, scores = np.zeros((2, len(fit.free), len(fit.free)))
    for where, slopes, residual, times in _each(fit, swings):
        slopes = slopes * scale[where, np.newaxis]
        rate = (times.size - 1) / (times[-1] - times[0])
        lag = max(times.size // _SHARE, ceil(rate * 2 * pi / fit.model.values["natural_frequency"]))
        place = np.ix_(where, where)
        hessian[place] += slopes @ slopes.T
        scores[place] += _bartlett(slopes * residual, lag)
    covariance = np.full(hessian.shape, np.nan)
    kept = np.ix_(~held, ~held)
    inverse = np.linalg.inv(hessian[kept])
    covariance[kept] = (
        inverse @ scores[kept] @ inverse * np.outer(scale, scale)[kept] * fit.n / (fit.n - len(fit.free))
    )
    return covariance


def _each(fit: Fit, swings: Swings) -> Iterator[tuple[Any, Floats, Floats, Floats]]:
    """Of each swing: where its free values sit in ``fit.free``, the angle's derivatives, the residual, the times."""
    shared = len(fit.model.parameters)
    own = (len(fit.free) - shared) // len(swings)
    for k, ((times, angle), fitted) in enumerate(zip(swings, fit.swings, strict=True)):
        where = np.r_[:shared, shared + k * own : shared + (k + 1) * own]
        release = fitted.release_angle, fitted.release_velocity
        slopes = sensitivities(fit.model, times, *release, free=[fit.free[i] for i in where])[1]
        yield where, slopes, angle - fitted.angle, times


def _bartlett(scores: Floats, lag: int) -> Floats:
    """The sum of products of scores up to ``lag`` samples apart, weighted 1 - distance/(lag + 1).

    It equals the mean over all windows of lag + 1 samples, those cut by the ends included, of the window's sum squared.
    """
    running = np.cumsum(np.pad(scores, ((0, 0), (lag + 1, lag))), axis=1)
    windows = running[:, lag + 1 :] - running[:, : -lag - 1]
    return windows @ windows.T / (lag + 1)


def variance_inflation(fit: Fit, robust: Floats) -> float:
    """Variance for autocorrelated over that for independent residuals: geometric mean over the fit's values, at least 1.

    n over this is the number of samples that count as independent.
    """
    ratio = np.diag(robust) / np.diag(fit.covariance)
    ratio = ratio[np.isfinite(ratio) & (ratio > 0)]
    return float(max(1.0, np.exp(np.mean(np.log(ratio))))) if ratio.size else np.nan
