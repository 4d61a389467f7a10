"""Turning points counted off a scale, or picked from a recording: how such a series is told from a sampled swing, and what it holds.

A sampled swing comes back through its middle with samples on the way. A series of which each value lies on the other side of the
middle than the one before, or which falls from its first value to its last and never comes back, shows no swing: between two
of its values there is a half-swing or a whole one.
"""

import re
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.special import bdtr, stdtrit

from ...arrays import Bools, Floats, longest
from ...errors import InputError
from ...pendulum.half_swings import half_swings, middles
from ...rounding import moment
from .swing_counts import FEWEST, counts

SWING, ONE_SIDE, BOTH_SIDES = "swing", "turning_points", "half_swings"
PASSAGES, PERIODS = "passages", "periods"  # through a light gate: each, or one a period
KINDS = (SWING, ONE_SIDE, BOTH_SIDES, PASSAGES, PERIODS)
# of the range: what a falling series scatters about a parabola; a sine's RMS is more than a third
_NOISE = 0.2
FASTEST = 0.1  # s; a pendulum with this period is 2.5 mm long
_SMOOTH = 5  # degree of a polynomial that follows any envelope, and no swing of as many sides
_WRONG = 0.1  # of the signs of turning points: more are none of both sides by turns
_RISES = 0.5  # of its range: an envelope that rises again by so much is none
_SURE = 4.0  # standard errors of a bend
_CHANCE = 1e-5  # of taking the two sides for different where they are not
_ASKED = 0.01  # of asking where they are not
_UNSIGNED = re.compile(r"(?i)\babs\b|absolute|\||betrag|magnitude")
_ALTERNATIVES = "write turning_points (one a period), half_swings (one each half-swing) or swing (samples of the motion) ⟨in signal_kind⟩"


class Points(NamedTuple):
    """A series of turning points: times (s; counts where they are not timed), half-swings since the first, readings signed so that
    every second half-swing's has the other sign, whether both sides are there, and remarks."""

    times: Floats
    halves: np.ndarray
    readings: Floats
    both: bool
    timed: bool
    remarks: list[str]

    @property
    def each(self) -> str:
        """How often there is one, in words."""
        return "each half-swing" if self.both else "one a period"


def points_in(
    times: Floats,
    readings: Floats,
    place: str,
    stated: str = "",
    counted: bool = False,
    name: str = "",
    in_rad: float = 0.0,
) -> Points | None:
    """The ``Points`` of a series of times and readings; None where they are samples of a swing.

    Parameters
    ----------
    times
        In s, or counts of swings (``counted``), of shape (point,).
    readings
        Of the same shape.
    place
        What an error names as its place.
    stated
        One of ``KINDS``, or "".
    name
        That of the readings' column.
    in_rad
        What the readings' unit is in rad; 0 for a unit that is none of angles.

    Raises
    ------
    InputError
        If their kind is not stated and cannot be decided.
    """
    if times.size < FEWEST:
        if stated and stated != SWING:
            raise too_few(times.size, place)
        return None
    order = np.argsort(times, kind="stable")
    remarks = ["its rows were put in the order of their times"] if np.any(np.diff(times) < 0) else []
    times, readings = times[order], readings[order]
    if not np.all(np.diff(times) > 0):
        return None
    sides = _sides(times, readings, place, stated, name)
    if sides is None:
        return None
    both, signed, told = sides
    remarks += told
    step = 1 if both else 2
    if counted:
        halves = np.round((times - times[0]) * (step if np.min(np.diff(times)) >= 1 else 1)).astype(int)
        if not both:
            remarks.append(
                "each number is taken for a whole swing (half_swings ⟨in signal_kind⟩ says otherwise)"
            )
    else:
        times, readings, halves, told = _numbered(times, readings, sides, in_rad, place, stated)
        remarks += told
    if signed:
        flipped = readings * (1.0 if readings[0] > 0 else -1.0)
        used = _by_turns(np.sign(flipped) == (-1.0) ** halves, place) if both else slice(None)
        if used != slice(None):
            why = "beyond two turning points on one side follow each other as if on both"
            remarks.append(used_from(times[used], why))
            times, halves = times[used], halves[used] - halves[used][0]
            flipped = flipped[used] * np.sign(flipped[used][0])
    else:
        flipped = np.abs(readings) * (-1.0) ** halves
    missed = int(halves[-1] // step + 1 - halves.size)
    if missed:
        remarks.append(f"between its {halves.size} points {missed} more were not written down")
    if not both:
        remarks.append("the law of its damping depends on the zero of its scale: only one side was recorded")
    return Points(times, halves, flipped, both, not counted, remarks)


def _numbered(
    times: Floats,
    readings: Floats,
    sides: tuple[bool, bool, list[str]],
    in_rad: float,
    place: str,
    stated: str,
) -> tuple[Floats, Floats, NDArray[np.int_], list[str]]:
    """Times and readings of the turning points that can be counted by their times, their numbers in half-swings, and remarks."""
    both, signed, _ = sides
    times, readings, told = _once(times, readings, signed)
    if (found := counts(times, np.abs(readings) * in_rad)) is None:
        raise _no_count(place)
    count, used = found
    halves = (1 if both else 2) * count
    if halves.size < min(times.size, 2 * FEWEST) and not stated:
        # that they are turning points is a guess: of a few points it has to suit all
        raise _no_count(place)
    if halves.size < times.size:
        told.append(used_from(times[used]))
    times, readings = times[used], readings[used]
    if np.min(np.diff(count)) > 1:
        told.append(
            "no two of its points follow each other: a whole fraction of this period fits them as well"
        )
    if not both and not stated:
        _check_marks(times, place)
        told.append(
            "were they of both sides without signs, the period would be twice this (half_swings ⟨in signal_kind⟩)"
        )
    return times, readings, halves, told


def used_from(times: Floats, why: str = "how many swings passed beyond cannot be told") -> str:
    """A remark that the points of these times (s) alone are used."""
    return f"used from {moment(times[0])} to {moment(times[-1])} s: {why}"


def _sides(
    times: Floats, readings: Floats, place: str, stated: str, name: str
) -> tuple[bool, bool, list[str]] | None:
    """Whether both sides are there, whether the readings bear signs, and remarks; None for samples of a swing."""
    signs = np.sign(readings)
    one_sign = bool(np.all(signs >= 0) or np.all(signs <= 0))
    if not one_sign:
        usual = np.diff(times) < 1.5 * np.median(np.diff(times))
        middle = float(np.median(middles(readings)))
        side = np.sign(readings - middle)
        # a sign that was written wrongly stays a turning point; three samples a period leave a third on one side
        if stated == ONE_SIDE or np.mean((side[1:] != side[:-1])[usual]) < 1 - _WRONG:
            if stated:
                raise InputError(
                    place, "its values lie on both sides of 0, but do not alternate", "the turning points of one side, or of both sides alternately",
                    "leave ⟨signal_kind⟩ empty, or correct the column",
                )  # fmt: skip
            return None
        if not falls(np.abs(readings - middle)) and not stated:
            raise InputError(
                place, "each value lies on the other side than the value before, and they do not fall: turning points, or fewer than three samples a period",
                "turning points of a pendulum that nothing drives, or more samples", _ALTERNATIVES,
            )  # fmt: skip
        return True, True, []
    size = np.abs(readings)
    if stated:
        return stated == BOTH_SIDES, False, []
    other = unequal_sides(size)
    if other or _UNSIGNED.search(name):
        by_side = size - other * (-1.0) ** np.arange(size.size)
        if not falls(by_side):
            return None
        why = ", as the two sides' readings differ" if other else ""
        return True, False, [f"both sides are there without signs{why}"]
    if not falls(size) or _is_sampled(times, size):
        return None
    if difference := unequal_sides(size, _ASKED):
        raise InputError(
            place, f"the values fall, and every second one is higher than its neighbours by {2 * abs(difference):.2g}: are they of one side, or of both sides without signs?",
            "turning points of one side, or of both", _ALTERNATIVES,
        )  # fmt: skip
    return False, False, []


def _is_sampled(times: Floats, size: Floats) -> bool:
    """True for samples of a swing: a part that bends the other way than any envelope or rises again, several, or ones too close for turning points."""
    at = np.linspace(-1, 1, size.size)
    coefficients, covariance = np.polyfit(at, size, 2, cov="unscaled")
    left = size - np.polyval(coefficients, at)
    error = float(np.sqrt(covariance[0, 0] * (left @ left) / (size.size - 3)))
    concave = coefficients[0] < -_SURE * error and coefficients[0] < -0.05 * np.ptp(size)
    # about its envelope a series scatters to either side by chance; a swing stays on one for some samples
    beside = size - np.polyval(np.polyfit(at, size, _SMOOTH), at)
    sides = len(half_swings(beside, 0.0).starts)
    swings = sides > _SMOOTH + FEWEST and float(bdtr(sides - 1, size.size - 1, 0.5)) < _CHANCE
    rises = float(np.max(size - np.minimum.accumulate(size))) > _RISES * float(np.ptp(size))
    return bool(concave) or swings or rises or float(np.median(np.diff(times))) < FASTEST


def _once(times: Floats, readings: Floats, signed: bool) -> tuple[Floats, Floats, list[str]]:
    """Times and readings without turning points that stand twice, and a remark: none follows another on its side within half the usual time."""
    kept, usual = [0], float(np.median(np.diff(times)))
    for k in range(1, times.size):
        near = times[k] - times[kept[-1]] < 0.5 * usual
        if not (near and (not signed or readings[k] * readings[kept[-1]] > 0)):
            kept.append(k)
        elif abs(readings[k]) > abs(readings[kept[-1]]):
            kept[-1] = k
    lost = times.size - len(kept)
    told = [
        f"{lost} of its turning points {'stand' if lost > 1 else 'stands'} twice, less than half the usual time apart: the larger is taken"
    ]
    return times[kept], readings[kept], told if lost else []


def _by_turns(in_turn: Bools, place: str) -> slice:
    """The points used of those on both sides: all, or the longest part on alternate sides; InputError where that is less than half."""
    if np.mean(in_turn) >= 1 - _WRONG:
        return slice(None)
    used = longest(in_turn[1:] == in_turn[:-1])
    if 2 * (used.stop - used.start) < in_turn.size:
        raise _no_count(place)
    return used


def unequal_sides(size: Floats, chance: float = _CHANCE) -> float:
    """By how much every second amplitude is larger than its neighbours, halved; 0 where ``chance`` would make that more often."""
    signs = (-1.0) ** np.arange(size.size)
    smooth = np.vander(np.linspace(-1, 1, size.size), 4)
    if size.size < 8:
        return 0.0
    columns = np.column_stack([smooth, signs])
    found = np.linalg.lstsq(columns, size)[0]
    left = size - columns @ found
    free = size.size - columns.shape[1]
    error = float(np.sqrt(left @ left / free * np.linalg.inv(columns.T @ columns)[-1, -1]))
    return float(found[-1]) if abs(found[-1]) > stdtrit(free, 1 - chance / 2) * error else 0.0


def falls(size: Floats) -> bool:
    """True for sizes that fall from the first to the last about a line that bends a little, as an amplitude does."""
    at = np.linspace(-1, 1, size.size)
    left = size - np.polyval(np.polyfit(at, size, 2), at)
    third = max(2, size.size // 3)
    fallen = float(np.median(size[:third]) - np.median(size[-third:]))
    return fallen > 0 and float(np.sqrt(np.mean(left**2))) < _NOISE * float(np.ptp(size))


def _check_marks(times: Floats, place: str) -> None:
    """InputError for times of equal steps, to the last digit, as a watch's marks and what a table fills in: are these periods?"""
    gaps = np.diff(times)
    gap = float(gaps[0])
    if np.any(np.abs(gaps - gap) > 1e-9 * times[-1]):
        return
    raise InputError(
        place, f"the values fall and are {gap:g} s apart to the last digit: is that the period, or was the amplitude read at these times?",
        "a turning point each period or half-swing, or samples of the motion", _ALTERNATIVES,
    )  # fmt: skip


def _no_count(place: str) -> InputError:
    return InputError(
        place, "the swings between its points cannot be counted: the times are not multiples of one interval",
        "turning points of which some follow each other",
        "write down every turning point, or their numbers instead of times; " + _ALTERNATIVES,
    )  # fmt: skip


def too_few(count: int, place: str, what: str = "turning points") -> InputError:
    """What is told of a series too short to fit."""
    return InputError(place, f"{count} {what}", f"at least {FEWEST}", "write down more of them")
