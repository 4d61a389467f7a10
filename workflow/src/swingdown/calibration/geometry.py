"""From the height of the tower under the bob to the angle of the arm (Eqs. 7-10)."""

from collections.abc import Sequence

import numpy as np

from ..arrays import Floats, Numbers


def arm_angle(
    over_shaft: Numbers, shaft_diameter: Numbers, bob_diameter: Numbers, arm: Numbers, height: Numbers
) -> Floats:
    """The angle (rad) of the arm from the vertical (Eqs. 7a, 8, 9, 10); NaN where the drop is longer than the arm.

    Parameters
    ----------
    over_shaft, shaft_diameter, bob_diameter, arm
        Height of the shaft's top, diameters, and length of the arm, in m.
    height
        Of the tower that the bob rests on, in m.
    """
    drop = _drop_below_shaft(over_shaft, shaft_diameter, bob_diameter, height)
    with np.errstate(over="ignore"):
        ratio = drop / arm
    return np.arccos(np.where(np.abs(ratio) <= 1, ratio, np.nan))


def _drop_below_shaft(
    over_shaft: Numbers, shaft_diameter: Numbers, bob_diameter: Numbers, height: Numbers
) -> Numbers:
    """The height (m) of the shaft's centre above the bob's (Eqs. 8-10); all lengths in m."""
    return (over_shaft - shaft_diameter / 2) - (height + bob_diameter / 2)


def printed_bound(
    lengths: Sequence[float] | Floats,
    limits: Sequence[float],
    height: float,
    height_limit: float,
    signed: bool = True,
) -> float:
    """The limit of error (rad) of the angle as Eq. 7b prints it, limits added as in Eqs. 9 and 10.

    Parameters
    ----------
    lengths, limits
        Of over_shaft, shaft_diameter, bob_diameter and arm, in m. Eq. 10's "½ δh_bob" is read as ½ δd_bob.
    height, height_limit
        Of the tower, in m.
    signed
        Whether the printed signs stay, by which the two terms cancel in part. Otherwise their sizes add: the worst case.
    """
    over_shaft, shaft, bob, arm = lengths
    drop = _drop_below_shaft(over_shaft, shaft, bob, height)
    drop_limit = (limits[0] + limits[1] / 2) + (height_limit + limits[2] / 2)
    root = np.sqrt(1 - (drop / arm) ** 2)
    by_drop, by_arm = -drop_limit / (arm * root), drop * limits[3] / (arm**2 * root)
    return abs(by_drop + by_arm) if signed else abs(by_drop) + abs(by_arm)
