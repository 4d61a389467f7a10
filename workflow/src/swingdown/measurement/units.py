"""Which units a recording can be in, by what a pendulum does: those that only one reading allows are taken and told."""

from math import pi

import numpy as np

from ..arrays import Floats
from ..errors import InputError
from ..pendulum.half_swings import half_swings
from ..rounding import moment
from .plausibility import TO_RAD
from .refused import WHICH_COLUMN

LONGEST, SHORTEST = 60.0, 0.02  # s; a pendulum of 900 m, and one of a tenth of a millimetre
ROOM = 4.0  # s; a pendulum of 4 m hardly fits into a room
SINCE_1970 = (0.9e9, 4e9)  # s: from 1998 to 2096; no other clock shows so many
DAYS = (35_796, 71_600)  # the same years in days since 1900, as spreadsheets keep a date and a time of day
A_DAY = 86_400.0  # s
SLOWEST = 700.0  # s; a torsion balance
WHOLE = 1.02  # turns from one turning point to the next: weight swings nothing further back and forth
_A_BYTE = 8  # bits
_EXACT = 2.0**53  # below it a number holds each count
WRAPPED = 0.1  # of a turn: a jump that is so nearly a whole one is that of a sensor that begins anew
TURNS = {"rad": 2 * pi, "deg": 360.0}
NO_SCALE = "1"  # the unit of a reading whose scale nobody states
COUNTED = ("counts", NO_SCALE)  # units of readings that may come from a counter


def time_factor(
    times: Floats, signal: Floats, told: bool, place: str, ticks: str = ""
) -> tuple[float, list[str]]:
    """Seconds per unit of the times, and a remark where it is not 1 or the period is odd.

    Parameters
    ----------
    times, signal
        The swing, of shape (sample,).
    told
        Whether anybody stated the unit. Else it is s, or ms, us or a spreadsheet's days where a pendulum's period is possible in that alone.
    place
        What an error names as its place.
    ticks
        Of times as a processor counts them, at which nobody reads a torsion balance: ``taken`` for ms, or ``asked``, where it is open as
        well which column swings.

    Raises
    ------
    InputError
        If no unit will do, both ms and us would, or ms and a torsion balance in s.
    """
    swings = half_swings(signal)
    period, interval = swings.period(times), float(np.median(np.diff(times)))
    for unit, factor in (("ms", 1e-3), ("us", 1e-6), ("ns", 1e-9)):
        if not told and all(SINCE_1970[0] < factor * one < SINCE_1970[1] for one in (times[0], times[-1])):
            return factor, [f"its times are {unit} since 1970, as a computer counts them"]
    length, what = (period, "a period of") if period == period else (interval, "a sample every")
    if SHORTEST <= period <= LONGEST or (period != period and interval <= 1):
        if told or not period > ROOM:
            return 1.0, []
        remark = f"NO UNIT OF THE TIME IS STATED: taken for s, in which a pendulum of so long a period, {period:.3g} s, is {9.81 * (period / 2 / pi) ** 2:.2g} m long"
        return 1.0, [remark]
    if not told and DAYS[0] < times[0] < times[-1] < DAYS[1] and SHORTEST <= A_DAY * period <= LONGEST:
        return A_DAY, [
            f"its times are days since 1900, as a spreadsheet keeps them: a period of {A_DAY * period:.4g} s"
        ]
    if told:
        remark = f"{what} {length:.3g} s is none of a pendulum on a bench: is the unit of the time right?"
        return 1.0, [remark]
    others = {"ms": 1e-3, "us": 1e-6}
    possible = [(unit, one) for unit, one in others.items() if SHORTEST <= one * period <= LONGEST]
    if LONGEST < period <= SLOWEST:
        return _ms_or_s(period, ticks, place)
    if len(possible) == 1:
        unit, factor = possible[0]
        remark = f"no unit of the time is stated, and a period of {period:.4g} s is too long for a pendulum: TAKEN AS {unit}, a period of {factor * period:.4g} s"
        return factor, [remark]
    raise InputError(
        place,
        f"{what} {length:.3g} s is too long or too short for a pendulum, and no unit of the time is stated",
        f"a period between {SHORTEST:g} and {LONGEST:g} s",
        "write ms, us or s ⟨in time_unit⟩, or in the column's name: `t (ms)`",
    )


def _ms_or_s(period: float, ticks: str, place: str) -> tuple[float, list[str]]:
    """As ``time_factor`` of a period that would suit a torsion balance in s, and a pendulum in ms."""
    if ticks == "taken":
        remark = f"no unit of the time is stated, and its whole numbers do not rise evenly, as a processor's clock counts: TAKEN AS ms, a period of {period / 1e3:.4g} s"
        return 1e-3, [remark]
    if ticks:
        raise InputError(
            place,
            "the file does not say what its columns hold, nor the unit of its times, which seem to be ms",
            "a column with the angle",
            "name the column of the angle ⟨in signal_column⟩; an accelerometer that rides on the bob shows none",
            WHICH_COLUMN,
        )
    problem = f"a period of {period:.4g}, and no unit of the time is stated: in s it would suit a torsion balance, in ms a pendulum"
    mend = "write ms or s ⟨in time_unit⟩, or in the column's name: `t (ms)`"
    raise InputError(place, problem, "the unit of the time", mend)


def unwrapped(signal: Floats, unit: str, steps: float = np.nan) -> tuple[Floats, list[str]]:
    """The signal that runs on where the sensor began a turn anew, and a remark on it.

    ``unit`` is rad or deg, "" where nobody states it, or of readings, of which a turn has so many ``steps`` (NaN where nobody says).
    Without a unit a jump of 360 tells degrees; without steps one of a power of two tells a counter of so many bits.
    """
    jumps = np.abs(np.diff(signal))
    stated = TURNS.get(unit, steps)
    counter = [] if np.isfinite(stated) else _counter(signal)
    for turn in [stated] if np.isfinite(stated) else counter if unit else [*TURNS.values(), *counter]:
        wraps = np.count_nonzero(np.abs(jumps - turn) < WRAPPED * turn)
        if not (wraps and np.ptp(signal) < (1 + WRAPPED) * turn):
            continue
        whole = np.unwrap(signal, period=turn)
        if turn in counter and np.ptp(whole) < WRAPPED * turn:  # on and off, as a light gate
            continue
        remark = f"the angle jumps by a whole turn {wraps} times, where the sensor begins anew: these were added up"
        return whole - turn * np.round(np.median(whole) / turn), [remark]
    return signal, []


def _counter(signal: Floats) -> list[float]:
    """The number at which a counter of bytes or more begins anew, which holds these readings; none where they are no whole numbers above 0."""
    if not (signal.min() >= 0 and signal.max() < _EXACT and np.all(signal == np.round(signal))):
        return []
    bits = int(np.ceil(np.log2(signal.max() + 1)))
    return [2.0**bits] if bits >= _A_BYTE else []


def angle_unit(signal: Floats, unit: str, restoring: str, place: str) -> tuple[str, list[str]]:
    """The unit of an angle, ``rad``, ``deg``, or ``NO_SCALE``, and a remark where it is not as stated.

    Weight makes nothing swing back and forth by more than a turn. An angle that would in rad is in degrees; an angle that would in degrees
    as well is a reading of unknown scale.

    Parameters
    ----------
    signal
        Of shape (sample,).
    unit
        The stated unit, which stands; "" for none.
    restoring
        ``sine`` or ``linear``: a disc on a spring may turn further.
    place
        What an error names as its place.

    Raises
    ------
    InputError
        If it would swing too far in the stated unit, with ``restoring`` ``sine``.
    """
    swings = half_swings(signal)
    reach = np.abs(np.diff(swings.turns)) if len(swings.turns) > 1 else np.zeros(1)
    # one push over the top is no swing back and forth; against a stated unit it takes one more
    seen = 3 if unit else 2
    far = sorted(reach)[-seen] if len(reach) > 2 else 0.0

    def too_far(known: str) -> bool:
        return bool(far > WHOLE * TURNS[known])

    if unit:
        if unit in TURNS and restoring == "sine" and too_far(unit):
            other = unit == "rad" and not too_far("deg")
            raise InputError(
                place,
                f"in {unit}, as stated, it swings back and forth by {reach.max() / TURNS[unit]:.3g} turns, which no pendulum does by its weight",
                "less than a turn for a pendulum; a disc or a wheel on a spring may turn further",
                "if a spring pulls it back write ⟨restoring=linear⟩"
                + ("; if these are degrees write deg ⟨in signal_unit⟩" if other else ""),
            )
        return unit, []
    if not too_far("rad"):
        return "rad", []
    turns = f"no unit is stated, and in rad it would swing back and forth by {reach.max() / TURNS['rad']:.3g} turns"
    # a spring's period is the same for all swings: it needs no unit
    wheel = restoring == "linear" and far < 3 * TURNS["rad"]
    aside = abs(swings.centre()) / TURNS["deg"]
    if wheel or too_far("deg") or aside > 1:
        doubt = (
            "which a wheel on a spring may do"
            if wheel
            else f"in degrees by {reach.max() / 360:.3g}"
            if too_far("deg")
            else f"in degrees about {aside:.3g} turns, as no pendulum hangs and a converter's readings do"
        )
        scale = "state the degrees that one unit is worth ⟨in scale⟩"
        mend = "write rad or deg ⟨in signal_unit⟩" if wheel else scale
        remark = f"{turns}, {doubt}: TAKEN AS A READING OF UNKNOWN SCALE. Period and decay need none; for angles {mend}"
        return NO_SCALE, [remark]
    return "deg", [f"{turns}: TAKEN AS DEGREES (⟨signal_unit⟩ says otherwise)"]


def check_steps(times: Floats, angle: Floats, place: str) -> None:
    """None for an angle (rad) that moves by less than half a turn from sample to sample; InputError otherwise.

    Across a hole it may do more.
    """
    steps = np.diff(times)
    jumps = np.abs(np.diff(angle)) * (steps < 1.5 * np.median(steps))
    far = np.flatnonzero(jumps > pi)
    if len(far):
        problem = f"the angle changes by {jumps[far[0]] / (2 * pi):.3g} turns between two samples"
        mend = "mend the file there, or correct ⟨signal_unit⟩"
        raise InputError(f"{place}, {moment(times[far[0] + 1])} s", problem, "less than half a turn", mend)


def turns_counted(angle: Floats) -> list[str]:
    """A remark on an angle (rad) beyond a turn, or none."""
    largest = float(np.abs(angle).max())
    if largest <= 2 * pi:
        return []
    return [f"it reaches {largest / (2 * pi):.3g} turns, which are taken for counted turns"]


def in_rad(unit: str) -> float:
    """Rad per unit of an angle; 0.0 for any other unit."""
    return TO_RAD.get(unit, 0.0)
