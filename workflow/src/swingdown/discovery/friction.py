"""What a model leaves that only something that takes energy could do.

A spring that stiffens, a string that stretches, a zero that is another in each recording: they move a swing in time and to a side, and
take nothing from it. What they would do to the residuals tells nothing of friction, and is projected out: any torque over the angle, in
each recording its own, and the zero of its readings, each beside what the fit itself can imitate.
"""

from collections.abc import Sequence

import numpy as np

from ..arrays import Floats
from ..fitting.result import Fit
from .campaign import Swing
from .green import Motion, hats, motion, motions_of, response
from .linear import Frame, orthonormal

_ANGLES = 7  # nodes over the angle of a recording
_EACH = 2  # samples for each direction that is projected out, of fewer nothing is told


def fitted(frame: Frame) -> float | None:
    """The mean square (rad^2) of a fit's residuals beyond what takes no energy; None of too few samples."""
    columns = frame.padded(_conserving(motions_of(frame)))
    return _beyond(frame.residual, np.hstack([frame.slopes, columns]), frame.samples)


def held_out(fit: Fit, swings: Sequence[Swing]) -> float | None:
    """The same of swings of which only the releases were fitted."""
    pairs = zip(fit.swings, swings, strict=True)
    motions = [motion(one.model, swing, one.release_angle, one.release_velocity) for one, swing in pairs]
    residual = np.concatenate(
        [swing.angle - one.angle for one, swing in zip(fit.swings, swings, strict=True)]
    )
    releases = _apart([one.slopes.T for one in motions])
    return _beyond(residual, np.hstack([releases, _conserving(motions)]), residual.size)


def _conserving(motions: Sequence[Motion]) -> Floats:
    """What torques over the angle and a zero do to the readings (sample, any), of each recording its own."""
    worked = []
    for one in motions:
        torques = hats(one.angle / np.max(np.abs(one.angle)), np.linspace(-1, 1, _ANGLES))
        worked.append(np.column_stack([response(one, torques), np.ones(one.at.size)]))
    return _apart(worked)


def _apart(blocks: Sequence[Floats]) -> Floats:
    """The blocks one below the other, each with columns of its own."""
    wide = np.zeros((sum(len(one) for one in blocks), sum(one.shape[1] for one in blocks)))
    row = column = 0
    for one in blocks:
        wide[row : row + len(one), column : column + one.shape[1]] = one
        row, column = row + len(one), column + one.shape[1]
    return wide


def _beyond(residual: Floats, columns: Floats, samples: int) -> float | None:
    basis = orthonormal(columns)
    if samples < _EACH * basis.shape[1]:
        return None
    left = residual - basis @ (basis.T @ residual)
    return float(left @ left) / (residual.size - basis.shape[1])
