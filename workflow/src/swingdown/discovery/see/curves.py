"""The missing torque as smooth curves over angle, speed or time: as columns to test with, and as a table to draw."""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
import pandas as pd
from scipy.optimize import minimize_scalar

from ...arrays import Floats
from ...pendulum.effect import NATURAL_FREQUENCY
from ..data.noise import Noise
from .green import Motion, motions_of, reach, responses
from .linear import Frame

COLUMNS = ["over", "part", "x", "torque", "band"]
_POINTS = 41  # of a curve
_POWERS = (0, 2, 3, 4, 5, 6, 7)  # of the angle: the first is the fit's own natural frequency
_BUMPS = np.arange(7)  # over the speed: friction changes most where it is slow, and powers have no room there
_COURSES = (1, 2, 3)  # powers of the time, for each part of what changes with it
_PARTS = ("drag", "stiffness", "push")


class Form(NamedTuple):
    """A family of curves: what each does to the readings (sample, curve), and by part the places to draw at (rad, rad/s, share of the
    record) with what each curve is there, in rad/s^2 (place, curve)."""

    columns: Floats
    drawn: dict[str, tuple[Floats, Floats]]


def forms(frame: Frame) -> dict[str, Form]:
    """The ``Form`` over ``position``, ``velocity`` and ``time`` of what a fit's swings reach."""
    motions, natural = motions_of(frame), frame.fit.model.values[NATURAL_FREQUENCY.name]
    largest, fastest = reach(motions)
    x, v, since = np.linspace(-1, 1, _POINTS), np.linspace(0, 1, _POINTS), np.linspace(0, 1, _POINTS)
    # each part of the time is drawn where it is seen: a drag at the largest speed, a stiffness at the largest angle
    seen = _over_time(fastest / natural, largest, since)
    of = np.repeat(np.arange(len(_PARTS)), len(_COURSES))
    return {
        "position": Form(
            responses(motions, [_over_angle(one.angle / largest) for one in motions]),
            {"torque": (largest * x, _over_angle(x))},
        ),
        "velocity": Form(
            responses(motions, [_over_speed(one.speed / fastest) for one in motions]),
            {"torque": (fastest * v, _over_speed(np.maximum(v, 1e-9)))},  # at rest friction has no side
        ),
        "time": Form(
            responses(motions, [_over_time(one.speed / natural, one.angle, _since(one)) for one in motions]),
            {part: (since, np.where(of == k, seen, 0.0)) for k, part in enumerate(_PARTS)},
        ),
    }


def missing(frame: Frame, noise: Noise, curves: Mapping[str, Form]) -> pd.DataFrame:
    """The missing torque over angle, speed and time (``forms``), each as if it alone were missing: a table.

    Columns ``over`` (position, velocity, time), ``part`` (torque; over time: drag, stiffness, push), ``x`` (rad, rad/s,
    share of the record), ``torque`` and ``band`` (its standard error, both in rad/s^2; for drag and stiffness the torque
    at the largest speed and angle).
    """
    tables = []
    for over, form in curves.items():
        estimate, covariance = _estimate(frame, form.columns, noise)
        for part, (x, shapes) in form.drawn.items():
            spread = np.sqrt(np.maximum(np.einsum("ij,jk,ik->i", shapes, covariance, shapes), 0.0))
            columns = (over, part, x, shapes @ estimate, spread)
            tables.append(pd.DataFrame(dict(zip(COLUMNS, columns, strict=True))))
    return pd.concat(tables, ignore_index=True)


def _over_angle(x: Floats) -> Floats:
    return np.column_stack([x**power for power in _POWERS])


def _over_speed(v: Floats) -> Floats:
    return np.sign(v)[:, None] * np.exp(-((6 * np.abs(v)[:, None] - _BUMPS) ** 2))


def _over_time(drag: Floats | float, stiffness: Floats | float, since: Floats) -> Floats:
    courses = np.column_stack([since**power for power in _COURSES])
    return np.hstack([np.reshape(of, (-1, 1)) * courses for of in (drag, stiffness, 1.0)])


def _since(one: Motion) -> Floats:
    return (one.times - one.times[0]) / (one.times[-1] - one.times[0])


def _estimate(frame: Frame, columns: Floats, noise: Noise) -> tuple[Floats, Floats]:
    """Coefficients of the columns beyond the fit, as large as the data ask for (maximum of the evidence), and their covariance: what the fit's
    own values could imitate is as open as they are large."""
    size = np.linalg.norm(columns, axis=0)
    size[size == 0] = 1.0
    left, singular, right = np.linalg.svd(frame.outside(columns) / size, full_matrices=False)
    residual = frame.outside(frame.residual)
    seen = left.T @ residual
    whole = float(residual @ residual)
    power, kept = _most_likely(singular, seen, noise.slow_variance, whole, frame.samples)
    along = right.T / size[:, None]
    mean = kept * seen / np.maximum(singular, 1e-300)
    return along @ mean, (along * (power * (1 - kept))) @ along.T


def _most_likely(
    singular: Floats, seen: Floats, variance: float, whole: float, samples: int
) -> tuple[float, Floats]:
    """(variance, share of each that the data determine) of most evidence for coefficients along directions that do so much to the readings (``singular``), of which the
    residual, whose sum of squares is ``whole``, has so much (``seen``). What is left of it beyond the noise's ``variance`` counts as noise."""
    for _ in range(3):

        def cost(logarithm: float, variance: float = variance) -> float:
            power = variance + np.exp(logarithm) * singular**2
            return float(np.sum(np.log(power) + seen**2 / power))

        scale = np.log(variance / np.max(singular) ** 2)
        size = float(np.exp(minimize_scalar(cost, bounds=(scale - 5, scale + 40), method="bounded").x))
        kept = size * singular**2 / (variance + size * singular**2)
        squares = whole - float(np.sum((1 - (1 - kept) ** 2) * seen**2))
        variance = max(variance, squares / samples)
    return size, kept
