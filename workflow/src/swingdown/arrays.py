"""Names for the kinds of numbers that functions take and give."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.floating[Any]]
Numbers = float | Floats  # one, or one a point or draw
Swing = tuple[Floats, Floats]  # times (s) and angles (rad), one as long as the other


class DrivenSwing(tuple[Floats, Floats]):
    """A ``Swing`` under a measured drive, which is a curve over its clock: a pair like any other, that brings its ``drive`` along."""

    drive: Any

    def __new__(cls, times: Floats, angles: Floats, drive: Any) -> "DrivenSwing":
        found = super().__new__(cls, (times, angles))
        found.drive = drive
        return found


def standard_errors(covariance: Floats) -> Floats:
    """The roots of a covariance's diagonal; NaN where rounding left a variance below 0, as of a value that the data do not tell."""
    variances = np.diag(covariance)
    return np.sqrt(np.where(variances >= 0, variances, np.nan))


def swing_under(drive: Any, times: Floats, angles: Floats) -> Swing:
    """The pair of times (s) and angles (rad), with the drive where there is one."""
    return (times, angles) if drive is None else DrivenSwing(times, angles, drive)


class Shown(NamedTuple):
    """A swing, or a part of one, beside what a model makes of it: names, times (s), angles and fitted angles (rad).

    Of an angular rate both are in rad/s, as ``unit`` says.
    """

    recording: str
    part: str
    times: Floats
    angle: Floats
    fit: Floats
    held_out: bool = False
    unit: str = "rad"

    @staticmethod
    def named(name: str) -> tuple[str, str]:
        """Recording and part of a name such as ``anna, part 2 of 5``."""
        recording, comma, part = name.rpartition(", part ")
        return (recording, f"part {part}") if comma else (name, "")


def finite_or_none(value: float | None) -> float | None:
    """The number, or None where it is not known: JSON has none for that."""
    return float(value) if value is not None and np.isfinite(value) else None
