"""The ideal pendulum, without friction: how much longer a large swing takes than a small one."""

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
