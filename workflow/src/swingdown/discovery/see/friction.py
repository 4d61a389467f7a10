"""What a model leaves that only friction or drag could do.

A spring that stiffens, a string that stretches, a zero that is another in each recording: they move a swing in time and to a side, and
take nothing from it. What they would do to the residuals tells nothing of friction, and is projected out: any torque over the angle, in
each recording its own, and the zero of its readings, each beside what the fit itself can imitate. Of the rest that counts which a
torque over angle, speed and side would do: what comes and goes with time is no law of friction.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.linalg import block_diag

from ...arrays import Floats
from ...fitting.result import Fit
from ..data.campaign import Swing
from .green import Motion, hats, motion, motions_of, plane, response, responses
from .linear import Frame, orthonormal

_ANGLES = 7  # nodes over the angle of a recording
_OVER, _SPEEDS = 11, 5  # nodes of a dissipative torque over the angle, and over the speed to either side
_SEEN = 1e-3  # of the strongest direction: weaker ones are left out
_EACH = 2  # samples for each direction that is projected out, of fewer nothing is told


class Work(NamedTuple):
    """The mean square (rad^2) of residuals that friction could take away, and what share of them that is in directions."""

    mean_square: float
    share: float


def fitted(frame: Frame) -> Work | None:
    """The ``Work`` that is left to friction in a fit's residuals; None of too few samples, or of nothing that moves."""
    motions = motions_of(frame)
    conserving, dissipative = (frame.padded(one(motions)) for one in (_conserving, _dissipative))
    return _work(frame.residual, np.hstack([frame.slopes, conserving]), dissipative, frame.samples)


def held_out(fit: Fit, swings: Sequence[Swing]) -> Work | None:
    """The same of swings of which only the releases were fitted."""
    pairs = zip(fit.swings, swings, strict=True)
    motions = [motion(one.model, swing, one.release_angle, one.release_velocity) for one, swing in pairs]
    residual = np.concatenate(
        [swing.angle - one.angle for one, swing in zip(fit.swings, swings, strict=True)]
    )
    releases = block_diag(*(one.slopes.T for one in motions))
    own = np.hstack([releases, _conserving(motions)])
    return _work(residual, own, _dissipative(motions), residual.size)


def _conserving(motions: Sequence[Motion]) -> Floats:
    """What torques over the angle and a zero do to the readings (sample, any), of each recording its own."""
    worked = []
    for one in motions:
        torques = hats(one.angle / np.max(np.abs(one.angle)), np.linspace(-1, 1, _ANGLES))
        worked.append(np.column_stack([response(one, torques), np.ones(one.at.size)]))
    return block_diag(*worked)


def _dissipative(motions: Sequence[Motion]) -> Floats:
    """What torques over angle, speed and side do to the readings (sample, any), the same in all recordings."""
    return responses(motions, plane(motions, _OVER, _SPEEDS).torques)


def _work(residual: Floats, own: Floats, columns: Floats, samples: int) -> Work | None:
    basis = orthonormal(own)
    if samples < _EACH * basis.shape[1]:
        return None
    left, beyond = (one - basis @ (basis.T @ one) for one in (residual, columns))
    directions, strength, _ = np.linalg.svd(beyond, full_matrices=False)
    directions = directions[:, strength > _SEEN * strength[0]]
    if not directions.shape[1]:  # of a pendulum that hangs still
        return None
    return Work(float(np.sum((directions.T @ left) ** 2)) / samples, directions.shape[1] / samples)
