"""Passages through a light gate: how a file of them is told from others, and what it holds.

A gate tells when the bob came by, and by how long it was dark how fast. Times, intervals or the gate's states with their times
are such a file; where its values do not tell whether a half-swing or a period passes from row to row, that is asked.
"""

import re
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
import xarray as xr

from ...arrays import Floats, longest
from ...errors import InputError
from ...pendulum.half_swings import half_swings
from ..files.columns import COUNTS, TIME, UNTOLD, VOLTAGE, Meaning, place_of
from ..files.source import Table
from ..sheet import TIME_UNITS, Row
from .points_recording import PASSED, about_file, as_recording
from .points_table import in_window, is_number, peeked
from .swing_counts import FEWEST, counts
from .turning_points import FASTEST, PASSAGES, PERIODS, Points, falls, too_few, unequal_sides, used_from

_GATE = re.compile(
    r"(?i)\b(gate ?\d*|gate ?states?|edge( ?type)?|state|blocked|photogate|lichtschranke) ?\d*\b"
)
_NAMED = r"period\w*|période|período|schwingungsdauer"
_PERIOD = re.compile(rf"(?i)\b(t|{_NAMED})\b")
_ONE_PERIOD = re.compile(rf"(?i)\b({_NAMED})\b")  # what a hand calls T may be the time of several swings
_INTERVAL = re.compile(r"(?i)\b(intervals?|dt|Δt|delta t)\b")
_HALF = re.compile(r"(?i)half|halb|demi|medio|t ?/ ?2")
_SPEED = re.compile(r"(?i)\b(speed|velocity|geschwindigkeit)\b")
_SPEEDS = ("m/s", "cm/s")
_DARK = re.compile(r"(?i)\b(block(ed)?|dark|dunkel\w*|gate|transito?) ?(time|duration)?\b")
_ALIKE = 0.25  # of the usual step: a step that differs by more is no half-swing beside another
_USUAL = 0.9  # of all steps that are alike: the others are passages missed
_TURNS = 0.7  # of the steps between passages, at which a speed that has a sign changes it: a passage that is missed keeps it
_LIGHT = 3.0  # times as long as it is dark: beyond the side of a swing, which lasts half a period, as a comparator tells it
_BETWEEN = 0.05  # of the samples of a gate's voltage, that are on their way from one level to the other
_LEVEL = 0.25  # of the voltage's range, about either level: a sine is beyond them for a third of its time
_BARE = 0.01  # of the numbers of the fullest column: one with fewer holds what is said once, as the start and the step of a clock
_SLOWEST = 100.0  # s; a pendulum with this period is 2.5 km long
_WIDTHS = "bob widths/s"
_WORDS = "write passages (each passage: two a period) or periods (one a period) ⟨in signal_kind⟩"


class Gate(NamedTuple):
    """What a file says of passages: times (s), speeds at them (nan where not known) in a unit, how far apart they are by the file's
    own words (``PASSAGES``, ``PERIODS``, "" where it has none), how it was read, and remarks."""

    times: Floats
    speeds: Floats
    unit: str
    kind: str
    taken: str
    remarks: list[str]


def passages(table: Table, row: Row, place: str) -> tuple[Table, xr.Dataset | None]:
    """The table, to be read on, and the dataset of its passages; None where it holds something else.

    The dataset is as that of ``points_table.turning_points``, with speeds for readings, nan where the file has none.
    ``signal_kind`` of the ``row`` is the last word. InputError where a half-swing must be told from a period, and for too few.
    """
    stated = str(row.get("signal_kind", ""))
    ours = stated in (PASSAGES, PERIODS)
    if stated and not ours:
        return table, None
    rows, table = peeked(table, row)
    if rows is None or rows.empty:
        return table, None
    gate = _gate(rows, table, row)
    if gate is None:
        if ours:
            raise InputError(
                f"{row['file']} ({place})", "it holds no passages of a light gate", "a column of increasing times, of periods, or of the gate's states",
                "leave ⟨signal_kind⟩ empty, or export the times",
            )  # fmt: skip
        return table, None
    inside = in_window(gate.times, row)
    gate = gate._replace(times=gate.times[inside], speeds=gate.speeds[inside])
    points, kind = counted(gate, stated, f"{row['file']} ({place})")
    words = "each half-swing" if kind == PASSAGES else "one a period"
    about = about_file(table, row, ", ".join([gate.taken, words, *([table.layout] if table.layout else [])]))
    return table, as_passages(points, kind, gate.unit, about, row)


def ask_periods(table: Table, row: Row, place: str) -> Table:
    """The table, to be read on; InputError where all that it holds are numbers, nearly alike in each column, and nobody says what they are."""
    if row.get("signal_kind") or row["signal_column"]:
        return table
    rows, table = peeked(table, row)
    if rows is None or rows.empty:
        return table
    values = {one: _sound(table.numbers(rows, one.name)) for one in table.meanings}
    rest = [one for one, own in values.items() if not is_number(one, own)]
    each = [values[one] for one in rest]
    if not rest or any(one.kind != UNTOLD for one in rest) or not all(map(_like_periods, each)):
        return table
    names = place_of(", ".join(one.name for one in rest))
    several = f"of {names} name one ⟨in signal_column⟩ and " if len(rest) > 1 else ""
    raise InputError(
        f"{row['file']}, {place_of(rest[0].name)} ({place})", f"{each[0].size} numbers, nearly all about {np.median(each[0]):.4g}: are they periods of a pendulum, or readings?",
        "periods, the times between passages, or readings with their rate",
        f"{several}write periods (one a period) or passages (two a period) ⟨in signal_kind⟩; for readings write the samples a second ⟨in rate_hz⟩",
    )  # fmt: skip


def _like_periods(values: Floats) -> bool:
    """True for numbers nearly alike that do not swing themselves, as samples do."""
    crossed = half_swings(values).starts if values.size else np.empty(0)
    sampled = crossed.size > 3 and _alike(np.diff(crossed).astype(float))
    return values.size >= FEWEST and not sampled and _alike(values)


def as_passages(
    points: Points, kind: str, unit: str, attrs: Mapping[str, Any], row: Row | None = None
) -> xr.Dataset:
    """The dataset of passages as recorded; ``kind`` is ``PASSAGES`` or ``PERIODS``, ``unit`` that of the speeds, "" for none."""
    found = as_recording(points, unit or "1", attrs, row)
    found["signal"].attrs["long_name"] = "speed at a passage, as read"
    found["half_swings"].attrs["long_name"] = "half-swings since the first passage"
    return found.assign_attrs(kind=kind, **({} if unit else {"points": PASSED}))


def counted(gate: Gate, stated: str, place: str) -> tuple[Points, str]:
    """The ``Points`` of passages, each with the half-swings since the first, and their kind; InputError where that cannot be told."""
    times, kind = gate.times, stated or gate.kind
    if times.size < FEWEST:
        raise too_few(times.size, place, "passages")
    if not kind:
        if not unequal_sides(np.diff(times)[: _halves(times, PASSAGES, 1, place)[1].stop - 1]):
            step = float(np.median(np.diff(times)))
            raise InputError(
                place, f"its times are {step:.4g} s apart: is that a half-swing, a whole period, or several?", "passages through a gate, and which of these", _WORDS + "; of several swings write their number into the name, as `10T (s)`",
            )  # fmt: skip
        kind = PASSAGES
    step, remarks = (1 if kind == PASSAGES else 2), list(gate.remarks)
    halves, used = _halves(times, kind, step, place)
    if halves.size < times.size:
        remarks.append(used_from(times[used]))
    missed = int(halves[-1] // step + 1 - halves.size)
    if missed:
        remarks.append(f"between its {halves.size} passages {missed} more were missed")
    speeds = np.abs(gate.speeds[used]) * (-1.0) ** halves
    return Points(times[used], halves, speeds, False, True, remarks), kind


def _halves(times: Floats, kind: str, step: int, place: str) -> tuple[np.ndarray, slice]:
    """Half-swings since the first passage, and the part of the passages that can be counted.

    Two within half the usual time are the bob turning in the gate: beyond them nothing is counted.
    """
    gaps = np.diff(times)
    usual = float(np.median(gaps[1:] + gaps[:-1])) / 2  # of pairs: a gate may be beside the middle
    part = longest(gaps >= usual / 2)
    own = times[part]
    in_pairs = np.abs((own[2:] - own[:-2]) / 2 - usual) < _ALIKE * usual
    if kind == PASSAGES and own.size >= FEWEST and in_pairs.all():
        return np.arange(own.size), part
    if own.size >= FEWEST and (found := counts(own, np.zeros(own.size))) is not None:
        return step * found[0], slice(part.start + found[1].start, part.start + found[1].stop)
    raise InputError(
        place, "the swings between its passages cannot be counted: the times are not multiples of one interval",
        "passages of which some follow each other", "leave out what is no passage of the bob (⟨start_s⟩ and ⟨stop_s⟩)",
    )  # fmt: skip


def _gate(rows: pd.DataFrame, table: Table, row: Row) -> Gate | None:
    """The ``Gate`` of a file's rows; None where they are something else."""
    columns = table.meanings
    values = {one.name: table.numbers(rows, one.name) for one in columns}
    filled = {one.name: np.count_nonzero(np.isfinite(values[one.name])) for one in columns}
    columns = [one for one in columns if filled[one.name] > _BARE * max(filled.values())]
    number = [one for one in columns if is_number(one, _sound(values[one.name]))]
    rest = [one for one in columns if one not in number]
    clock = row["time_column"]
    rest.sort(key=lambda one: one.name != clock if clock else one.kind != TIME)
    if not rest:
        return None
    states = [one for one in rest[1:] if _GATE.search(_label(one)) and _are_states(values[one.name])]
    if states and row["signal_column"] in ("", *(one.name for one in states)):
        return _of_gates(rest[0], states, values, row)
    alone = len(rest) == 2 and row["signal_column"] in ("", rest[1].name)
    if alone and (gate := _of_voltage(rest[0], rest[1], values, row)):
        return gate
    if row["signal_column"]:
        rest = [one for one in rest if one.name == row["signal_column"]] if row["signal_kind"] else []
    if len(rest) == 1:
        return _alone(rest[0], _sound(values[rest[0].name]), row)
    return _of_columns(rest[0], rest[1:], values, row) if rest else None


def _of_columns(
    clock: Meaning, beside: Sequence[Meaning], values: Mapping[str, Floats], row: Row
) -> Gate | None:
    """Times with the period that ends at each, with the speed or the dark time there, or with both; None where a column is neither."""
    speeds = [one for one in beside if _is_dark(one) or _SPEED.search(_label(one)) or one.written in _SPEEDS]
    others = (one for one in beside if one not in speeds and one.kind in (UNTOLD, TIME))
    periods = [one for one in others if _PERIOD.search(_label(one))]
    if len(speeds) + len(periods) < len(beside):
        return None
    counted = _with_periods(clock, *_beside(values, clock, periods[0]), row) if periods else None
    if not speeds or (periods and counted is None):
        return counted
    found = _with_speeds(clock, speeds[0], values, row)
    return found._replace(kind=counted.kind) if found and counted else found


def _of_gates(
    clock: Meaning, states: Sequence[Meaning], values: Mapping[str, Floats], row: Row
) -> Gate | None:
    """Passages of the gate that the sheet names, or else of the one that has most; each gate is passed twice a period."""
    named = [one for one in states if one.name == row["signal_column"]]
    gates = [(one, _of_states(clock, one, values, row)) for one in named or states]
    found = [(one, gate) for one, gate in gates if gate is not None]
    if not found:
        return None
    best, gate = max(found, key=lambda one: one[1].times.size)
    others = ", ".join(f"`{one.name}`" for one in states if one is not best)
    told = [
        f"another gate is left out, for each is passed twice a period: {others} (⟨signal_column⟩ says otherwise)"
    ]
    return gate._replace(remarks=gate.remarks + (told if others else []))


def _with_periods(clock: Meaning, times: Floats, periods: Floats, row: Row) -> Gate | None:
    """Times with the period that ends at each."""
    steps = np.diff(times)
    found = _alone(clock, times, row) if steps.size > 1 and np.all(steps > 0) else None
    if found is None:
        return None
    ratio = float(np.median(periods) / np.median(steps))
    kind = PERIODS if abs(ratio - 1) < _ALIKE / 2 else PASSAGES if abs(ratio - 2) < _ALIKE else None
    return None if kind is None else found._replace(kind=kind)


def _label(one: Meaning) -> str:
    return re.sub(r"(?i)^latest:", "", one.name).replace("_", " ")


def _sound(values: Floats) -> Floats:
    return values[np.isfinite(values)]


def _beside(values: Mapping[str, Floats], clock: Meaning, other: Meaning) -> tuple[Floats, Floats]:
    """The times, and what stands beside them, of the rows that have both."""
    both = np.isfinite(values[clock.name]) & np.isfinite(values[other.name])
    return values[clock.name][both], values[other.name][both]


def _is_dark(one: Meaning) -> bool:
    """True for a column of how long a gate was dark; a voltage of the gate is none."""
    return one.kind in (UNTOLD, TIME) and bool(_DARK.search(_label(one)))


def _are_states(values: Floats) -> bool:
    return bool(np.isin(_sound(values), (0, 1)).all()) and np.ptp(_sound(values)) == 1


def _alone(one: Meaning, values: Floats, row: Row) -> Gate | None:
    """Times or intervals that stand alone, or beside their numbers."""
    name = _label(one)
    if values.size < 3 or values.min() < 0 or not np.ptp(values) or one.kind not in (UNTOLD, TIME):
        return None
    intervals = row["signal_kind"] or any(word.search(name) for word in (_PERIOD, _INTERVAL, _HALF))
    for steps in (np.diff(values), values) if intervals else (np.diff(values),):
        scale, unit, told = _seconds(one, float(np.median(steps)), row)
        # periods may grow from first to last: they are no times, which lie a half-swing apart or more
        if np.all(steps > 0) and _alike(steps) and scale * float(np.median(steps)) >= FASTEST / 2:
            break
    else:
        return None
    times, kind, what = values, "", "times of passages"
    if steps is values:
        times, what = np.concatenate([[0.0], np.cumsum(values)]), "intervals between passages"
        kind = PASSAGES if _HALF.search(name) else PERIODS if _ONE_PERIOD.search(name) else ""
    taken = f"took `{one.name}` as {what}, in {unit}"
    return Gate(scale * times, np.full(times.size, np.nan), "", kind, taken, told)


def _with_speeds(clock: Meaning, beside: Meaning, values: Mapping[str, Floats], row: Row) -> Gate | None:
    """Times with the speed at each, or with the time for which the gate was dark."""
    times, read = _beside(values, clock, beside)
    steps, turns, read = np.diff(times), np.mean(np.diff(np.sign(read)) != 0), np.abs(read)
    if times.size < FEWEST or not (np.all(steps > 0) and _alike(steps) and np.all(read > 0)):
        return None
    scale, unit, told = _seconds(clock, float(np.median(steps)), row)
    dark = _is_dark(beside)
    # of passages each goes the other way, or none is said to; samples of a speed turn now and then
    if not dark and (0 < turns < _TURNS or not falls(read)):
        return None
    speeds, words = read, beside.written or "as written"
    if dark:
        speeds, words = 1 / (read * TIME_UNITS[beside.unit or "s"]), _WIDTHS
    what = f"`{beside.name}` as {'the time that the gate was dark' if dark else 'speeds'}"
    taken = f"took `{clock.name}` as times of passages, in {unit}, {what}"
    return _dying(Gate(scale * times, speeds, words, "", taken, told))


def _of_states(clock: Meaning, state: Meaning, values: Mapping[str, Floats], row: Row) -> Gate | None:
    """Passages from a gate's states: each begins where it goes dark and ends where it is light again."""
    times, states = _beside(values, clock, state)
    dark = states > 0
    if np.any(np.diff(times) < 0) or not np.any(np.diff(dark)):
        return None
    stretches = (_blocked(times, dark), _blocked(times, ~dark))  # some gates tell 0 where it is dark
    found = next((one for one in stretches if _is_brief(*one)), None)
    if found is None:
        return None  # about a period's half each: a comparator of the side, no gate
    begin, end = found
    scale, unit, told = _seconds(clock, float(np.median(np.diff(begin))) if begin.size > 1 else 1.0, row)
    taken = (
        f"took `{state.name}` as a light gate's, each passage from dark to light, `{clock.name}` as {unit}"
    )
    length = scale * (end - begin)
    if not np.all(length > 0):
        return Gate(scale * begin, np.full(begin.size, np.nan), "", PASSAGES, taken, told)
    return _dying(Gate(scale * (begin + end) / 2, 1 / length, _WIDTHS, PASSAGES, taken, told))


def _blocked(times: Floats, dark: np.ndarray) -> tuple[Floats, Floats]:
    """When each whole stretch begins in which the gate is dark, and when it ends."""
    changes = np.diff(dark)
    edges = np.flatnonzero(changes) + 1
    if dark[0] and changes.all():  # each row is a change: the first as well
        edges = np.concatenate([[0], edges])
    edges = edges[int(not dark[edges[0]]) :]
    edges = edges[: edges.size // 2 * 2]
    return times[edges[::2]], times[edges[1::2]]


def _is_brief(begin: Floats, end: Floats) -> bool:
    """True where the stretches are much shorter than what is between them; so is one alone."""
    light = begin[1:] - end[:-1]
    return not light.size or _LIGHT * float(np.median(end - begin)) <= float(np.median(light))


def _of_voltage(clock: Meaning, state: Meaning, values: Mapping[str, Floats], row: Row) -> Gate | None:
    """Passages from samples of a gate's voltage, which jumps between two levels and is dark for the shorter time; None of another signal.

    Whether it is passed twice a period is left open: that only unequal gaps tell.
    """
    times, read = _beside(values, clock, state)
    if state.kind not in (UNTOLD, VOLTAGE, COUNTS) or times.size < FEWEST or not np.all(np.diff(times) > 0):
        return None
    low, high = float(read.min()), float(read.max())
    share = (read - low) / (high - low) if high > low else np.zeros(read.size)
    if np.mean((share > _LEVEL) & (share < 1 - _LEVEL)) > _BETWEEN:
        return None
    up = share > 0.5
    at = np.flatnonzero(np.diff(up))
    if at.size < 2 * FEWEST:
        return None
    crossed = times[at] + (times[at + 1] - times[at]) * (0.5 - share[at]) / (share[at + 1] - share[at])
    found = _of_states(clock, state, {clock.name: crossed, state.name: up[at + 1].astype(float)}, row)
    return found and found._replace(kind="")


def _dying(gate: Gate) -> Gate:
    """The gate; without its speeds where they do not fall, for then they hold no damping."""
    if gate.times.size < FEWEST or falls(gate.speeds):
        return gate
    return gate._replace(
        speeds=np.full(gate.times.size, np.nan), unit="", remarks=[*gate.remarks, "its speeds do not fall: no damping is fitted to them"]
    )  # fmt: skip


def _alike(steps: Floats) -> bool:
    """True for steps of which nearly all are the usual one, in pairs where the gate is off the middle."""
    pairs = (steps[1:] + steps[:-1]) / 2 if steps.size > 2 else steps
    usual = float(np.median(pairs))
    return usual > 0 and float(np.mean(np.abs(pairs - usual) < _ALIKE * usual)) >= _USUAL


def _seconds(clock: Meaning, step: float, row: Row) -> tuple[float, str, list[str]]:
    """How many seconds a unit of time is, its name as told, and a remark where it was taken by the only period that a pendulum can have."""
    unit = row["time_unit"] or clock.unit
    if unit:
        return TIME_UNITS[unit], unit, []
    taken = next((one for one in TIME_UNITS if step * TIME_UNITS[one] < _SLOWEST), "us")
    if taken == "s":
        return 1.0, "s (no unit is stated)", []
    told = "no unit of time is stated, and no pendulum takes so many s: taken for " + taken
    return TIME_UNITS[taken], taken, [told]
