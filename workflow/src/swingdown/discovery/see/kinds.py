"""The kinds of discrepancy, each as many units: what unnamed torques and an error of the sensor do to the readings."""

from collections.abc import Sequence
from functools import cache

import numpy as np
from numpy.typing import NDArray

from ...arrays import Floats
from .green import Motion, hats, over_both, reach, response

DISSIPATIVE = "dissipative"
KINDS = ("restoring", DISSIPATIVE, "time", "sensor")

# nodes over angle, over speed to either side, and over the time of a record
_ANGLES, _SPEEDS, _TIMES = 11, 6, 6
# of the largest angle, speed and of the record: how far neighbouring torques hang together, of each kind both
SMOOTH = 0.35, 1.2
_KEPT = 1e-5  # of the largest variance of a kind: directions that have less are left out
# nodes over angle, and how far they hang together, of a torque that is there at some angles only
_FINE = 25, 0.12
_EACH = 3  # torques of each smoothness


def units(motions: Sequence[Motion], alike: bool = False) -> tuple[list[Floats], NDArray[np.intp]]:
    """The work of each unit of discrepancy on the readings of each motion (bin, unit), and the kind of each unit, first of the first
    smoothness.

    The torque in time is each recording's own, or ``alike`` in all.
    """
    largest, fastest = reach(motions)
    blocks: list[list[Floats]] = []
    for k, one in enumerate(motions):
        elapsed = (one.times - one.times[0]) / (one.times[-1] - one.times[0])
        torques = shapes(one.angle / largest, one.speed / fastest, elapsed)
        edges = np.cumsum([0, *(shape.shape[1] for shape in torques)])
        worked = np.split(response(one, np.hstack(torques)), edges[1:-1], axis=1)
        found = []
        for first in range(0, _EACH * len(SMOOTH), _EACH):
            restoring, dissipative, in_time = worked[first : first + _EACH]
            if not alike:
                own = np.zeros((len(in_time), len(motions), in_time.shape[1]))
                own[:, k] = in_time
                in_time = own.reshape(len(in_time), -1)
            found += [restoring, dissipative, in_time, torques[first][one.at]]
        blocks.append([*found, *worked[-2:]])
    kinds = np.concatenate([np.full(block.shape[1], k) for k, block in enumerate(blocks[0])])
    return [np.hstack(found) for found in blocks], kinds


def shapes(angle: Floats, speed: Floats, elapsed: Floats) -> list[Floats]:
    """What the torque of each unit is (place, unit) at places given as shares of the largest angle and speed and of the record: over the
    angle, over angle and speed, and in time (steady, with the angle and with the speed), for each smoothness, and a fine one over the angle,
    in either direction and in each. An error of the sensor goes over the reading as the first of each smoothness over the angle."""
    angles, speeds, times = np.linspace(-1, 1, _ANGLES), np.linspace(0, 1, _SPEEDS), np.linspace(0, 1, _TIMES)
    at, both, since = hats(angle, angles), over_both(angle, speed, angles, speeds), hats(elapsed, times)
    found: list[Floats] = []
    for smooth in SMOOTH:
        course = since @ _root(_TIMES, 1.0, smooth)
        in_time = [course, course * angle[:, None], course * speed[:, None]]
        found += [at @ _root(_ANGLES, 2.0, smooth), both @ _root_of_both(smooth), np.hstack(in_time)]
    fine = hats(angle, np.linspace(-1, 1, _FINE[0])) @ _root(_FINE[0], 2.0, _FINE[1])
    side = (speed >= 0)[:, None]
    return [*found, fine, np.hstack([fine * side, fine * ~side])]


def weights(torques: Sequence[Floats], recordings: int) -> list[Floats]:
    """What ``shapes`` are at some places as weights of the units of each kind (place, unit), without those in time, which each of the
    ``recordings`` has for itself unless they are the same in all (1), and without errors of the sensor."""
    found: list[Floats] = []
    for first in range(0, _EACH * len(SMOOTH), _EACH):
        over_angle, both, in_time = torques[first : first + _EACH]
        found += [over_angle, both, np.tile(0 * in_time, (1, recordings)), 0 * over_angle]
    return [*found, *torques[-2:]]


def rubs(recordings: int) -> list[Floats]:
    """The weights of the units of each kind in the torque against the motion at the middle, as the speed goes to nothing.

    At the middle, since at an edge a loss in bent material is a torque at rest as well.
    """
    forward, back = (
        weights(shapes(np.zeros(1), np.array([side]), np.zeros(1)), recordings) for side in (1e-300, -1e-300)
    )
    return [((two - one) / 2)[0] for one, two in zip(forward, back, strict=True)]


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
