"""The torque that a model lacks over angle and speed together, as its discrepancy has it."""

import numpy as np
import pandas as pd

from .discrepancy import Unnamed
from .green import motions_of, plane
from .kinds import shapes, weights
from .linear import Frame

PLANE = ["angle_rad", "speed_rad_per_s", "torque", "band", "known", "seen"]
_ANGLES, _SPEEDS = 11, 6  # nodes of the plane: angles, and speeds to either side
_SLOW = 1e-9  # of the largest speed: at rest friction has no side


def torques(unnamed: Unnamed, frame: Frame) -> pd.DataFrame:
    """The torque that a fit seen in a ``Frame`` lacks, but for what changes in time: a table of ``PLANE``.

    What the fit's own values imitate is open. Angle (rad), speed (rad/s), torque and its standard error ``band`` (rad/s^2), how much of it the data determine (``known``, 0 to 1), and the
    share of the time that the swings spend around there (``seen``).
    """
    over, (largest, fastest) = plane(motions_of(frame), _ANGLES, _SPEEDS), unnamed.reach
    seen = np.concatenate(over.torques).sum(axis=0)
    speeds = np.r_[over.speeds, -over.speeds]
    angle, speed = (one.ravel() for one in np.meshgrid(over.angles, speeds, indexing="ij"))
    moving = np.copysign(np.maximum(np.abs(speed) / fastest, _SLOW), speed)
    there = weights(shapes(angle / largest, moving, np.zeros_like(angle)), unnamed.recordings)
    torque, band, before = unnamed.most_likely(frame).linear(there)
    known = 1 - (band / np.maximum(before, 1e-300)) ** 2
    return pd.DataFrame(dict(zip(PLANE, (angle, speed, torque, band, known, seen / seen.sum()), strict=True)))
