"""Whether a recording can be a pendulum in the units it is taken for: its turns, its period, where it hangs."""

from math import pi
from typing import NamedTuple

import numpy as np

from ..arrays import Floats
from ..errors import InputError

LONGEST, SHORTEST = 60.0, 0.02  # s; a pendulum of 900 m, and one of a tenth of a millimetre
CENTRED = 0.1  # rad; friction does not hold a pendulum that far from the vertical
DRIFTED = 0.05  # rad; what the amplitude does to the middle of an eccentric sensor is less
TURNED = 2.6  # rad; nearer to half a turn than this the zero is at the top
GROWS = 1.15  # times: from its first third to its last
SHRINKS = 0.002  # of the swing: less says nothing of what stops it
DEAD_ZONE = 0.05  # of the range: crossings of the middle by noise alone do not count
TO_RAD = {"rad": 1.0, "deg": pi / 180}


class Swings(NamedTuple):
    """The half-swings of a recording: where each begins (index), and the signal at its turning point."""

    starts: np.ndarray
    turns: Floats

    def period(self, times: Floats) -> float:
        """The usual period (s), or nan for fewer than three crossings of the middle."""
        return 2 * float(np.median(np.diff(times[self.starts]))) if len(self.starts) > 2 else float("nan")

    def centre(self) -> float:
        """The middle that the swings have, or nan for fewer than four half-swings."""
        centres = self.centres()
        return float(np.median(centres)) if len(centres) else float("nan")

    def centres(self) -> Floats:
        """The middle at each turning point, from it and its neighbours; of fewer than five half-swings none. The first one may be cut, the last too."""
        turns = self.turns[1:-1]
        return (turns[:-2] + 2 * turns[1:-1] + turns[2:]) / 4 if len(turns) > 2 else np.empty(0)


def half_swings(signal: Floats) -> Swings:
    """The Swings about the median of the later half (the first may be held), with a dead zone of a twentieth of the range."""
    away = signal - np.median(signal[len(signal) // 2 :])
    low, high = np.percentile(signal, (0.5, 99.5))  # a spike is no swing
    zone = DEAD_ZONE * float(high - low)
    outside = np.flatnonzero((away > zone) | (away < -zone))
    side = (away > 0)[outside]
    starts = outside[np.concatenate(([True], side[1:] != side[:-1]))] if len(outside) else outside
    if not len(starts):
        return Swings(starts, np.empty(0))
    top, bottom = np.maximum.reduceat(signal, starts), np.minimum.reduceat(signal, starts)
    return Swings(starts, np.where(away[starts] > 0, top, bottom))


def check_plausible(
    times: Floats, signal: Floats, unit: str, time_told: bool, unit_told: bool, place: str
) -> list[str]:
    """Remarks on units and zero of a swing, each one line; InputError where no pendulum moves so.

    ``time_told`` and ``unit_told`` say whether anybody stated the units. Back and forth by more than a turn goes
    no pendulum, whoever says that it is in rad; a period beyond 60 s or below 0.02 s is refused where s is a guess.
    """
    swings = half_swings(signal)
    remarks = _time_remarks(times, swings, time_told, place)
    if unit in TO_RAD:
        remarks += _angle_remarks(times, signal * TO_RAD[unit], swings, unit, unit_told, place)
    return remarks


def _time_remarks(times: Floats, swings: Swings, told: bool, place: str) -> list[str]:
    period, interval = swings.period(times), float(np.median(np.diff(times)))
    length = period if period == period else interval
    what = "a period" if period == period else "a sample every"
    if SHORTEST <= period <= LONGEST or (period != period and interval <= 1):
        return []
    if told:
        return [f"{what} of {length:.3g} s is none of a pendulum on a bench: is the unit of the time right?"]
    raise InputError(
        place,
        f"{what} of {length:.3g} s is none of a pendulum, and no unit of the time is stated",
        f"a period between {SHORTEST:g} and {LONGEST:g} s",
        "write ms, us or s in the cell time_unit of the sheet, or in the column's name: `t (ms)`",
    )


def _angle_remarks(
    times: Floats, angle: Floats, swings: Swings, unit: str, told: bool, place: str
) -> list[str]:
    largest, remarks = float(np.abs(angle).max()), []
    turns = swings.turns * TO_RAD[unit]
    wide = np.abs(np.diff(turns)) > 2 * pi * 1.02
    if wide.sum() > 2:
        raise _no_angle(
            f"it swings back and forth by {np.abs(np.diff(turns)).max() / (2 * pi):.3g} turns",
            swings,
            unit,
            place,
        )
    wraps = np.flatnonzero(np.abs(np.abs(np.diff(angle)) - 2 * pi) < 0.6)
    if len(wraps):
        raise InputError(
            f"{place}, {times[wraps[0] + 1]:.6g} s",
            f"the angle jumps by a whole turn ({len(wraps)} times)",
            "an angle that runs on where the sensor begins anew",
            "unwrap it (add or take away a turn), or turn the sensor so that its zero is at the bottom",
        )
    far = np.flatnonzero(np.abs(np.diff(angle)) > pi)
    if len(far):
        raise InputError(
            f"{place}, {times[far[0] + 1]:.6g} s",
            f"the angle changes by {np.abs(np.diff(angle))[far[0]] / (2 * pi):.3g} turns between two samples",
            "less than half a turn",
            "mend the file there, or correct signal_unit in the sheet",
        )
    if unit == "rad" and largest > 2 * pi and not told:
        raise _no_angle(f"it reaches {largest:.4g} rad and no unit is stated", swings, unit, place)
    if largest > 2 * pi:
        remarks.append(f"it reaches {largest / (2 * pi):.3g} turns, which are taken for counted turns")
    centre = swings.centre() * TO_RAD[unit]
    if centre == centre:
        rest = (centre + pi) % (2 * pi) - pi
        if abs(rest) > TURNED:
            raise InputError(
                place,
                f"it swings about {np.degrees(centre):.4g}°, which is the top",
                "0 where the pendulum hangs",
                "take half a turn away from the angle",
            )
        remarks += _drift(swings.centres() * TO_RAD[unit])
    return remarks


def check_shrinks(signal: Floats, place: str) -> list[str]:
    """A remark on a swing that does not shrink, or none; InputError for one that grows. Of fewer than 12 half-swings nothing is told.

    Whatever the friction, what swings by itself swings less and less; a motor at its resonance, or an unstable computation, makes it grow.
    """
    sizes = np.abs(np.diff(half_swings(signal).turns[1:-1]))  # the first and the last may be cut
    part = len(sizes) // 3
    if part < 3:
        return []
    first, last = float(np.median(sizes[:part])), float(np.median(sizes[-part:]))
    if last > GROWS * first:
        raise InputError(
            place,
            f"its swings grow: in the last third of the recording they are {last / first:.2f} times as wide as in the first",
            "a pendulum that nothing drives: it swings less and less",
            "leave out with start_s and stop_s where something drives it",
        )
    if last < (1 - SHRINKS) * first:
        return []
    return [
        f"its swings do not shrink (the last third to {100 * last / first:.1f} % of the first): if a motor drives it, this is the "
        "motor's period; what stops it cannot be told"
    ]


def hanging(signal: Floats, scale: float) -> tuple[float, list[str]]:
    """The angle (rad) that a pendulum swings about where that is no zero, and a remark on it; else 0.0 and none.

    ``scale`` is rad per unit of ``signal``. An encoder's zero is where it was switched on, and some programs count from the
    horizontal: no friction holds a pendulum so far from the vertical. Of counted turns only what is beyond whole ones is told.
    """
    centre = half_swings(signal).centre() * scale
    rest = (centre + pi) % (2 * pi) - pi
    if not CENTRED < abs(rest) <= TURNED:  # nan too: nearer to the top it is refused
        return 0.0, []
    told = f"it swings about {rest:.3g} rad ({np.degrees(rest):.3g}°), and 0 should be where it hangs"
    return rest, [f"{told}: this is taken away"]


def _drift(centres: Floats) -> list[str]:
    """A remark where the middle of the swings wanders. What swings less and less has it at one place, whatever the friction."""
    part = max(3, len(centres) // 4)
    if len(centres) < 2 * part:
        return []
    moved = float(np.median(centres[-part:]) - np.median(centres[:part]))
    if abs(moved) < DRIFTED:
        return []
    return [
        f"its middle drifts by {moved:.2g} rad ({np.degrees(moved):.2g}°) from its first swings to its last, and 0 should stay where it hangs"
    ]


def _no_angle(problem: str, swings: Swings, unit: str, place: str) -> InputError:
    """The refusal of what no pendulum's angle does in ``unit``; degrees are proposed where it does not in degrees either."""
    wide = float(np.median(np.abs(np.diff(swings.turns)))) if len(swings.turns) > 1 else 0.0
    if unit == "rad" and wide <= 360:
        return InputError(
            place,
            f"taken for rad {problem}",
            "an angle in rad of a pendulum; these may be degrees",
            "write deg in the cell signal_unit of the sheet (or rad for counted turns), or the unit in the column's name",
        )
    return InputError(
        place,
        f"taken for {unit} {problem}",
        "an angle of a pendulum: so far it swings in no unit of angles",
        "name the column of the angle in the cell signal_column of the sheet, or write counts in signal_unit, with counts_per_revolution",
    )
