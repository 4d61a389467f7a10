"""Whether the beginning of a swing is what comes before its later part, if only weight and drag act: a lift that looks free is not."""

from math import pi

import numpy as np
from scipy.optimize import least_squares

from ...arrays import Floats
from ...engine.trajectory import TrajectoryError, sensitivities
from ...pendulum.half_swings import half_swings, quickening
from ...pendulum.model import Model

ASSUMED = ("viscous", "quadratic_drag")
BACK = np.array([1.0, -1.0, -1.0, 1.0, -1.0])  # what turns round with time: drag and the velocity
# half-swings from which weight and drag are learned: fewer where a fit of many loses its way
LEARNED = (8, 6, 4)
POINTS = 60  # samples a period that are used of them
ODD = 10.0  # times what the fit leaves where it is learned (RMS); what friction of another kind leaves stays below
SHARED = 3.0  # samples that err alike: so much less is known than of as many that err alone
LASTING = 0.03  # of a period
SEEN = 0.02  # of the amplitude; less is no hand


def lifted_until(times: Floats, angle: Floats) -> float | None:
    """Until when (s) a hand is at the pendulum, before it passes the middle for the first time; None where nothing tells of one.

    ``angle`` in rad, swinging from the first passage on. Weight and drag are fitted to some periods after that passage and the motion is followed back to the first sample.
    """
    swings = half_swings(angle)
    halves = len(swings.starts) - 2
    if halves < LEARNED[-1]:
        return None
    away, first = angle - swings.centre(), int(swings.starts[1])
    for learned in (number for number in LEARNED if number <= halves):
        stop = int(swings.starts[1 + learned])
        step = max(1, round(2 * (stop - first) / learned / POINTS))
        before = np.arange(first, -1, -step)
        later = slice(first, stop, step)
        try:
            values, covariance, left = _fitted(times[later] - times[first], away[later], learned)
            found, slopes = _motion(values * BACK, times[first] - times[before])
            break
        except TrajectoryError:  # no such pendulum on the way of the fit
            continue
    else:
        return None
    slopes *= BACK[:, None]
    unsure = np.sqrt(1 + SHARED * np.einsum("ij,ik,kj->j", slopes, covariance, slopes))
    least = np.maximum(ODD * left * unsure, SEEN * float(np.ptp(away)) / 2)
    odd = np.flatnonzero(np.abs(found - away[before]) > least)
    period = 2 * (times[stop] - times[first]) / learned
    lasting = len(odd) and times[before[odd[0]]] - times[0] > LASTING * period
    return float(times[before[odd[0]]]) if lasting else None


def _fitted(times: Floats, angle: Floats, halves: int) -> tuple[Floats, Floats, float]:
    """Fitted values (the model's, then angle and velocity at the first sample), their covariance for errors of 1 rad, and what the fit leaves (rad, RMS)."""
    amplitude = min(float(np.abs(angle).max()), 0.98 * pi)
    start = max(1, len(times) // (halves * 10))
    frequency = pi * halves / times[-1] / quickening(amplitude)
    velocity = (angle[start] - angle[0]) / times[start]
    found = least_squares(
        lambda values: _motion(values, times)[0] - angle,
        [frequency, 0.01, 0.0, angle[0], velocity],
        jac=lambda values: _motion(values, times)[1].T,
        bounds=([0.0, 0.0, 0.0, -np.inf, -np.inf], np.inf),  # a drag that pushes may run away
        x_scale="jac",
        max_nfev=40,
    )
    covariance = np.linalg.pinv(found.jac.T @ found.jac)
    return found.x, covariance, float(np.sqrt(2 * found.cost / len(times)))


def _motion(values: Floats, times: Floats) -> tuple[Floats, Floats]:
    """The angle (rad) and its slopes by the values."""
    named = dict(zip(Model(ASSUMED).parameters, map(float, values), strict=False))
    return sensitivities(Model(ASSUMED, named), times, float(values[-2]), float(values[-1]))
