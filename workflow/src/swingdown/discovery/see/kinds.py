"""The kinds of discrepancy, each as many units: what unnamed torques and an error of the sensor do to the readings."""

from collections.abc import Sequence
from functools import cache

import numpy as np
from numpy.typing import NDArray

from ...arrays import Floats
from .green import Motion, hats, over_both, response

DISSIPATIVE = "dissipative"
KINDS = ("restoring", DISSIPATIVE, "time", "sensor")

# nodes over angle, over speed to either side, and over the time of a record
_ANGLES, _SPEEDS, _TIMES = 11, 6, 6
# of the largest angle, speed and of the record: how far neighbouring torques hang together, of each kind both
SMOOTH = 0.35, 1.2
_KEPT = 1e-5  # of the largest variance of a kind: directions that have less are left out
# nodes over angle, and how far they hang together, of a torque that is there at some angles only
_FINE = 25, 0.12


def units(motions: list[Motion], alike: bool = False) -> tuple[list[Floats], NDArray[np.intp]]:
    """The work of each unit of discrepancy on the readings of each motion (bin, unit), and the kind of each unit, first of the first
    smoothness.

    The torque in time is each recording's own, or ``alike`` in all.
    """
    largest = max(float(np.max(np.abs(one.angle))) for one in motions)
    fastest = max(float(np.max(np.abs(one.speed))) for one in motions)
    blocks: list[list[Floats]] = []
    for k, one in enumerate(motions):
        torques, readings = _shapes(one, largest, fastest)
        edges = np.cumsum([0, *(shape.shape[1] for shape in torques)])
        worked = response(one, np.hstack(torques))
        found = []
        for first in range(0, len(torques) - 2, 3):
            restoring, dissipative, in_time = (
                worked[:, edges[first + j] : edges[first + j + 1]] for j in range(3)
            )
            if not alike:
                own = np.zeros((len(worked), len(motions), in_time.shape[1]))
                own[:, k] = in_time
                in_time = own.reshape(len(worked), -1)
            found += [restoring, dissipative, in_time, readings[first // 3]]
        found += [worked[:, edges[-3] : edges[-2]], worked[:, edges[-2] :]]
        blocks.append(found)
    kinds = np.concatenate([np.full(block.shape[1], k) for k, block in enumerate(blocks[0])])
    return [np.hstack(found) for found in blocks], kinds


def _shapes(one: Motion, largest: float, fastest: float) -> tuple[list[Floats], list[Floats]]:
    """Torques on the grid of times (restoring, dissipative, in time for each smoothness, and a fine one over the angle of either) and errors of the reading at its samples."""
    angles, speeds, since = np.linspace(-1, 1, _ANGLES), np.linspace(0, 1, _SPEEDS), np.linspace(0, 1, _TIMES)
    at = hats(one.angle / largest, angles)
    side = (one.speed >= 0)[:, None]
    both = over_both(one.angle / largest, one.speed / fastest, angles, speeds)
    elapsed = hats((one.times - one.times[0]) / (one.times[-1] - one.times[0]), since)
    torques: list[Floats] = []
    readings: list[Floats] = []
    for smooth in SMOOTH:
        course = elapsed @ _root(_TIMES, 1.0, smooth)
        in_time = [course, course * (one.angle / largest)[:, None], course * (one.speed / fastest)[:, None]]
        along = at @ _root(_ANGLES, 2.0, smooth)
        torques += [along, both @ _root_of_both(smooth), np.hstack(in_time)]
        readings.append(along[one.at])
    fine = hats(one.angle / largest, np.linspace(-1, 1, _FINE[0])) @ _root(_FINE[0], 2.0, _FINE[1])
    return [*torques, fine, np.hstack([fine * side, fine * ~side])], readings


def rubs(parts: Sequence[Floats]) -> list[Floats]:
    """The weights of the units of each kind in the torque against the motion at the middle, as the speed goes to nothing.

    At the middle, since at an edge a loss in bent material is a torque at rest as well.
    """
    weights: list[Floats] = [np.zeros(part.shape[1]) for part in parts]
    slow = np.zeros((_ANGLES, 2, _SPEEDS))
    slow[_ANGLES // 2, :, 0] = -0.5, 0.5  # of those of either direction (``over_both``)
    for k, smooth in enumerate(SMOOTH):
        weights[len(KINDS) * k + 1] = _root_of_both(smooth).T @ slow.ravel()
    middle = _root(_FINE[0], 2.0, _FINE[1])[_FINE[0] // 2]
    weights[-1] = np.concatenate([-0.5 * middle, 0.5 * middle])
    return weights


def _near(count: int, span: float, smooth: float) -> Floats:
    nodes = np.linspace(0, span, count)
    return np.exp(-0.5 * np.square((nodes[:, None] - nodes) / smooth))


@cache
def _root(count: int, span: float, smooth: float) -> Floats:
    return _square_root(_near(count, span, smooth))


@cache
def _root_of_both(smooth: float) -> Floats:
    return _square_root(np.kron(_near(_ANGLES, 2.0, smooth), np.kron(np.eye(2), _near(_SPEEDS, 1.0, smooth))))


def _square_root(covariance: Floats) -> Floats:
    """Columns whose products sum to the covariance, those of next to no variance left out."""
    values, vectors = np.linalg.eigh(covariance)
    kept = values > _KEPT * values[-1]
    return vectors[:, kept] * np.sqrt(values[kept])
