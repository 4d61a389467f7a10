"""The covariance of fitted values for independent residuals."""

import numpy as np

from ..arrays import Floats
from ..engine.trajectory import sensitivities
from .problem import Problem


def covariance_of(problem: Problem, hessian: Floats, rss: float, best: Floats) -> Floats:
    """s^2 (J'J)^-1 over the variables that no bound holds, s^2 = rss / (n - k); NaN for those held or undetermined."""
    free = (best > problem.lower) & (best < problem.upper)
    covariance = np.full(hessian.shape, np.nan)
    scale = np.sqrt(np.diag(hessian))
    free &= scale > 0
    if not free.any():
        return covariance
    scaled = hessian[np.ix_(free, free)] / np.outer(scale[free], scale[free])
    try:
        inverse = np.linalg.inv(scaled)
    except np.linalg.LinAlgError:
        return covariance
    if np.linalg.cond(scaled) < 1e15:
        freedom = problem.n - len(problem.free)
        covariance[np.ix_(free, free)] = inverse / np.outer(scale[free], scale[free]) * rss / freedom
    return covariance


def covariance_at(problem: Problem, best: Floats, rss: float) -> Floats:
    """The same for the one swing of a problem, from the trajectory's own slopes there."""
    (times, _), (*values, release_angle, release_velocity) = problem.swings[0], problem.slots(best)[0]
    model = problem.model.with_values(dict(zip(problem.model.parameters, values, strict=True)))
    _, slopes = sensitivities(model, times, release_angle, release_velocity, free=problem.free)
    return covariance_of(problem, slopes @ slopes.T, rss, best)
