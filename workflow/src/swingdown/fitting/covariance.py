"""The covariance of fitted values: from independent residuals, and from what the measurement leaves open."""

import numpy as np

from ..arrays import Floats
from ..engine.trajectory import sensitivities
from ..pendulum.slack import time_power
from .problem import RELEASE, Problem

CLOCK = "clock"
_SINGULAR = 1e15
_NOTHING = 1e-50  # rad: what a value of one does to all readings, below which they know nothing of it
_RELEASE_UNITS = dict(zip(RELEASE, ("rad", "rad/s"), strict=True))


def covariance_of(problem: Problem, hessian: Floats, rss: float, best: Floats) -> tuple[Floats, Floats]:
    """The covariance of the free values for independent residuals, and its systematic part.

    Parameters
    ----------
    problem
        What was fitted.
    hessian
        J'J with the precision of what is known beforehand, of shape (free, free).
    rss
        The sum of squares at the minimum; rss / (n - k) is the variance of the noise.
    best
        The free values there, of shape (free,).

    Returns
    -------
    covariance
        Of shape (free, free); NaN for values that a bound holds or that are undetermined.
    systematic
        Of shape (free, source).
    """
    noise, inverse = rss / (problem.n - len(problem.free)), inverse_of(problem, hessian, best)
    systematic = systematic_of(problem, inverse, best)
    if problem.known is not None:
        known = np.nan_to_num(inverse)  # what a bound holds does not move, and leaves the others known
        with np.errstate(over="ignore", invalid="ignore"):  # of what the data leave anywhere
            random = noise * (known @ (hessian - problem.known.precision) @ known)
        random[np.isnan(inverse)] = np.nan
        return random + systematic @ systematic.T, systematic
    return noise * inverse + systematic @ systematic.T, systematic


def inverse_of(problem: Problem, hessian: Floats, best: Floats) -> Floats:
    """The inverse of J'J over the variables that no bound holds; NaN for those held or undetermined.

    Parameters
    ----------
    problem
        What was fitted.
    hessian
        J'J, of shape (free, free).
    best
        The free values at the minimum, of shape (free,).
    """
    scale = np.sqrt(hessian.diagonal())
    free = (best > problem.lower) & (best < problem.upper) & (scale > _NOTHING)
    found, at = np.full(hessian.shape, np.nan), np.ix_(free, free)
    if free.any() and (inverse := _inverse(hessian[at], scale[free])) is not None:
        found[at] = inverse
    return found


def _inverse(matrix: Floats, scale: Floats) -> Floats | None:
    """The inverse of a positive matrix with the roots ``scale`` of its diagonal; None where it is singular or not of numbers."""
    with np.errstate(over="ignore", invalid="ignore"):
        size = scale[:, None] * scale
        scaled = matrix / size
    if not np.isfinite(scaled).all():
        return None
    try:
        inverse = np.linalg.inv(scaled)
        # by the product of Frobenius' norms first, which is never smaller than the condition number and takes a tenth of the time
        surely = np.vdot(scaled, scaled) * np.vdot(inverse, inverse) < _SINGULAR**2
        if not (surely or np.linalg.cond(scaled) < _SINGULAR):
            return None
    except np.linalg.LinAlgError:
        return None
    inverse /= size
    return inverse


def systematic_of(problem: Problem, inverse: Floats, best: Floats) -> Floats:
    """What a standard uncertainty of each source of the slack, and of the clock, does to each free value (free, source)."""
    slack, free = problem.model.slack, list(problem.free)
    found = np.zeros((len(free), len(slack.sources) + 1))
    if problem.known is not None:
        at = [free.index(name) for name in slack.parameters]
        pull = problem.known.precision[np.ix_(at, at)] @ slack.contributions
        held = np.isnan(np.diag(inverse))
        found[:, :-1] = np.where(np.isnan(inverse), 0.0, inverse)[:, at] @ pull
        found[held, :] = np.nan
    if not slack.clock:
        return found
    units = problem.model.units | _RELEASE_UNITS
    found[:, -1] = [
        time_power(units[name]) * value * slack.clock for name, value in zip(free, best, strict=True)
    ]
    return found


def covariance_at(problem: Problem, best: Floats, rss: float) -> tuple[Floats, Floats]:
    """The same for the one swing of a problem, from the trajectory's own slopes there."""
    (times, _), (*values, release_angle, release_velocity) = problem.swings[0], problem.slots(best)[0]
    model = problem.model.with_values(dict(zip(problem.model.parameters, values, strict=True)))
    model = model.driven_by(problem.drives[0])
    _, slopes = sensitivities(model, times, release_angle, release_velocity, free=problem.free)
    hessian = slopes @ slopes.T
    if problem.known is not None:
        hessian = hessian + problem.known.precision
    return covariance_of(problem, hessian, rss, best)
