"""The ideal pendulum, without friction: how much longer a large swing takes than a small one, and how far a fast one gets."""

import numpy as np
from scipy.special import ellipk

from ..arrays import Floats

LARGEST = 3.0  # rad; above it a swing takes as long as one likes


def lengthening(amplitude: Floats | float) -> Floats:
    """The period of an undamped pendulum at an amplitude over that of small swings: 2 K(sin²(amplitude / 2)) / pi.

    Source: any text on the elliptic integral, as DLMF 22.19.

    Parameters
    ----------
    amplitude
        In rad, of any shape, which the result has too; more than 3 rad counts as 3 rad.
    """
    return ellipk(np.sin(np.minimum(np.abs(amplitude), LARGEST) / 2) ** 2) * 2 / np.pi


def reached(speed: Floats | float, restoring: str = "sine") -> Floats:
    """The angle (rad, with the sign of the speed) at which a pendulum turns that is so fast where it hangs; of one that goes over, pi.

    Parameters
    ----------
    speed
        In natural frequencies, of any shape, which the result has too.
    restoring
        ``sine`` or ``linear``.
    """
    if restoring == "linear":
        return np.asarray(speed, dtype=float)
    return 2 * np.arcsin(np.clip(np.asarray(speed, dtype=float) / 2, -1.0, 1.0))
