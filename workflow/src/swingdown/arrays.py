"""Names for the kinds of numbers that functions take and give."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.floating[Any]]
Bools = NDArray[np.bool_]
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


def runs(marked: NDArray[Any]) -> list[tuple[int, int]]:
    """The first place, and the one after the last, of each run of one value that is not 0 (or False)."""
    edges = np.flatnonzero(np.diff(marked.astype(np.int8), prepend=0, append=0))
    return [(int(a), int(b)) for a, b in zip(edges, edges[1:], strict=False) if marked[a]]


def longest(joined: Bools) -> slice:
    """The longest stretch of places that are each ``joined`` to the next one, of which there is one more than there are joints."""
    edges = np.flatnonzero(np.concatenate([[True], ~joined, [True]]))
    k = int(np.argmax(np.diff(edges)))
    return slice(int(edges[k]), int(edges[k + 1]))


def extremes(values: Floats, columns: int) -> NDArray[np.intp]:
    """The indices of the least and the greatest value in each of so many columns of equal width: what a picture shows of a series."""
    parts = np.array_split(np.arange(values.size), columns)
    return np.unique([rows[[np.argmin(values[rows]), np.argmax(values[rows])]] for rows in parts])


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

    @staticmethod
    def by_recording(shown: "Sequence[Shown]") -> "dict[str, list[Shown]]":
        """The swings of each recording, in the order in which these come."""
        names = dict.fromkeys(one.recording for one in shown)
        return {name: [one for one in shown if one.recording == name] for name in names}


def finite_or_none(value: float | None) -> float | None:
    """The number, or None where it is not known: JSON has none for that."""
    return float(value) if value is not None and np.isfinite(value) else None
