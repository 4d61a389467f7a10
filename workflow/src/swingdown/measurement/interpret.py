"""What a file's columns mean: the times in order, the signal, and what it is read as; which columns these are is ``choice``."""

from dataclasses import replace
from itertools import pairwise

import numpy as np

from ..arrays import Floats
from ..errors import InputError
from ..pendulum.half_swings import half_swings
from ..rounding import moment
from .choice import (
    LOOKED_AT,
    SHORTEST,
    Chosen,
    alike_in,
    ask_which,
    columns_of,
    guessed_in,
    input_of,
    unnamed,
    with_rising_time,
    with_running_time,
    without_still,
)
from .files.columns import ANGLE, LENGTH, OF_AN_ERROR, SPEED, VOLTAGE, axes_beside, place_of
from .files.columns import drives as moves_it
from .files.columns import third as third_of
from .files.runs import clock_part, several_runs
from .files.series import series
from .files.table import Table, apart, first_rows
from .positions import check_no_positions
from .refused import WHICH_COLUMN
from .sheet import Row
from .signal import Interpreted, signal_of
from .swings.clock import RESTART, counts_rows, counts_ticks, in_order, parts
from .swings.continuity import check_one_series
from .units import A_DAY, time_factor

TWICE = 0.2  # by which the ratio of two periods may be off 2


def interpret(table: Table, row: Row, place: str, restoring: str) -> Interpreted:
    """What the columns of a table are: the time, and the angle, rate or position.

    Parameters
    ----------
    table
        As ``source.table_of`` returns it.
    row
        Of the sample sheet; its cells go first.
    place
        What an error names as its place.
    restoring
        ``sine`` or ``linear``.

    Raises
    ------
    InputError
        If the columns can be no swing, or leave open what they are; it names the option that answers.
    """
    table = apart(table)
    if (paired := f"{row['signal_column']} x") in table.names:
        row = {**row, "signal_column": paired}
    table, still = without_still(table, row)
    table, row, running = with_running_time(table, row)
    table, row, rising = with_rising_time(table, row)
    rising = still + running + rising
    drives = input_of(table, row, place)
    columns = columns_of(
        table._replace(names=tuple(one for one in table.names if one not in drives)), row, place, restoring
    )
    names, beside, alike = [one.name for one in columns.found], [], []
    if len(names) == 2:
        others = [table.meaning(one) for one in table.names if one not in names]
        names += [one.name for one in (third_of(others, columns.found[0]),) if one]
    elif not row["signal_column"]:
        names = axes_beside(table.names, columns.found[0], table.units) or names
    if not row["signal_column"] and not drives and len(columns.found) == 1:
        beside = unnamed(table, names)[:1]
        alike = [] if beside else alike_in(table, columns)
    where = f"{row['file']}, {place_of(columns.clock.name)} ({place})"
    read = [*names, *drives]
    table, row, found = _with_window(table, row, columns, where)
    table, numbering = _numbering(table, columns.clock.name, read)
    times, values, told = series(
        table, row, columns.clock.name, read, columns.time_unit or "s", [*beside, *alike, *numbering]
    )
    numbers = values.pop() if numbering else np.zeros(len(times))
    piece, chosen = _part(times, numbers, numbering, row, where)
    times, values, told = times[piece], [one[piece] for one in values], told + chosen
    if len(times) < SHORTEST:
        raise InputError(
            f"{row['file']} ({place})",
            f"{len(times)} samples with a number in each cell between ⟨start_s⟩ and ⟨stop_s⟩",
            f"at least {SHORTEST}, as fewer show no swing",
            "record longer or more samples a second, widen ⟨start_s⟩ and ⟨stop_s⟩, or correct the unit of the time",
        )
    check_one_series(times, values[0], f"{row['file']}, {place_of(names[0])} ({place})")
    ordered, factor, odd = in_order(times, values[0], where), 1.0, list[str]()
    if row["role"] != "static":
        if not columns.time_unit:
            _check_no_count(ordered.times, where)
        factor, odd = found or time_factor(
            ordered.times, values[0][ordered.kept], bool(columns.time_unit), where, _ticks(times, table, row)
        )
    if factor != 1.0:
        ordered = in_order(times * factor, values[0], where)
    times, values = ordered.times, [one[ordered.kept] for one in values]
    drive = values.pop(len(names)) if drives else None
    remarks = rising + (["the last line has no end and was left out"] if table.cut else [])
    paused = [table.about["paused"]] if "paused" in table.about else []
    remarks += [*table.remarks, *paused, *told, *ordered.remarks, *odd]
    remarks += _passed_over(table, columns, row, read)
    if alike:
        ask_which(times, dict(zip([*names, *alike], values, strict=True)), f"{row['file']} ({place})")
    if beside:
        pair, both = (values[0], values[len(names)]), f"{row['file']}, {names[0]} and {beside[0]} ({place})"
        _check_slowest(times, *pair, both)
        if not columns.unit and np.isfinite(pair[1]).all():
            check_no_positions(*pair, both)
        remarks.append(
            f"the file has {len(table.names)} columns and no names of them: `{names[0]}` was taken (⟨signal_column⟩ says otherwise)"
        )
    third = next((name for name in table.names if name.strip().lower() == "z"), "")
    made = signal_of(row, place, columns, times, dict(zip(names, values, strict=False)), restoring, third)
    if len(names) > 1 and len(columns.found) == 1:  # of a gyroscope's axes the one that turns most
        columns = columns._replace(found=[replace(columns.found[0], name=made.column)])
    taken = {1e-3: "MS", 1e-6: "US", 1e-9: "NS", A_DAY: "DAYS"}.get(factor, "s")
    told_unit = columns.time_unit or f"{taken} (no unit is stated)"
    if moved := [one for one in table.names if one not in read and moves_it(one)]:
        made = made._replace(about=made.about | {"drive_beside": ", ".join(moved)})
    return made._replace(
        remarks=remarks + made.remarks, rate=ordered.rate, input=drive,
        read=_read(table, columns, told_unit, made.times, "pivot_x" in made.about),
        input_unit=_written(table, drives[0]) if drives else "", guessed=not row["signal_column"] and guessed_in(table),
    )  # fmt: skip


def _passed_over(table: Table, columns: Chosen, row: Row, read: list[str]) -> list[str]:
    """A remark on the columns of angles, or of volts, that were not taken, for the first was; none where the sheet names one."""
    swing = columns.found[0]
    if row["signal_column"] or len(columns.found) > 1 or swing.kind not in (ANGLE, VOLTAGE):
        return []
    others = [
        one.name
        for one in table.meanings
        if (one.kind, one.unit) == (swing.kind, swing.unit)
        and one.name not in read
        and not (moves_it(one.name) or OF_AN_ERROR.search(one.name.replace("_", " ")))
    ]
    if not others:
        return []
    also = ", ".join(f"`{name}`" for name in others)
    first = "the first column of angles" if swing.kind == ANGLE else "the first column of volts"
    return [f"`{swing.name}` was taken, {first}, and not {also} (⟨signal_column⟩ says otherwise)"]


def _written(table: Table, column: str) -> str:
    """The unit that a column's header states, as the sheet writes it; "" for none."""
    found = table.meaning(column)
    return (found.unit or found.written).replace("²", "^2").replace("s2", "s^2")


def _numbering(table: Table, clock: str, read: list[str]) -> tuple[Table, list[str]]:
    """The table, and the column that numbers the runs in it, where there is one: it holds one number while the clock goes on, and a larger
    one where that counts anew or goes on much later."""
    others = [name for name in table.names if name not in (clock, *read)]
    table, held = first_rows(table, LOOKED_AT) if others else (table, [])
    if sum(map(len, held)) < 2 * SHORTEST:
        return table, []
    steps = np.diff(np.concatenate([table.numbers(rows, clock) for rows in held]))
    back = steps < 0
    breaks = back | (steps > RESTART * np.nanmedian(steps))
    for name in others:
        rises = np.diff(np.concatenate([table.numbers(rows, name) for rows in held]))
        new = rises != 0  # NaN too, which is no rise
        runs = np.diff(np.flatnonzero(new), prepend=-1, append=len(new))
        if new.any() and (rises[new] > 0).all() and breaks[new].all() and not back[~new].any():
            return table, [name] if runs.min() >= SHORTEST else []
    return table, []


def _part(
    times: Floats, numbers: Floats, numbering: list[str], row: Row, where: str
) -> tuple[slice, list[str]]:
    """The piece of a recording whose clock counts anew, or of which each run has one of the ``numbers``, that the sheet's cell ``run`` names;
    SeveralRuns where it names none."""
    edges = [0, *(np.flatnonzero(np.diff(numbers)) + 1), len(times)]
    pieces = [slice(a, b) for a, b in pairwise(edges)] if len(edges) > 2 else parts(times)
    if len(pieces) == 1:
        return slice(None), []
    at = pieces[1].start
    if len(edges) > 2:
        told = why = f"`{numbering[0]}` numbers {len(pieces)} runs in it"
    else:
        told = f"the clock counts anew {len(pieces) - 1} times in it"
        why = f"the clock jumps back from {moment(times[at - 1])} to {moment(times[at])} s and counts anew, so that the file holds {{}} parts"
    number = clock_part(str(row.get("run", "")))
    if 0 < number <= len(pieces):
        return pieces[number - 1], [f"{told}: this is part {number}"]
    raise several_runs(tuple(f"part {k}" for k in range(1, len(pieces) + 1)), row, where, why)


def _with_window(
    table: Table, row: Row, columns: Chosen, where: str
) -> tuple[Table, Row, tuple[float, list[str]] | None]:
    """The table, the row with its window (s) in the unit of the file's times, and what ``time_factor`` finds where nobody states that unit.

    A window can leave no whole period: the first rows tell the unit, whatever the window.
    """
    window = {key: row[key] for key in ("start_s", "stop_s") if np.isfinite(row[key])}
    if columns.time_unit or not window or row["role"] == "static":
        return table, row, None
    table, held = first_rows(table, LOOKED_AT)
    names = (columns.clock.name, columns.found[0].name)
    times, values = (np.concatenate([table.numbers(rows, name) for rows in held]) for name in names)
    known = np.isfinite(times) & np.isfinite(values)
    times, values = times[known], values[known]
    if len(times) < SHORTEST:
        return table, row, None
    piece = parts(times)[0]
    order = np.argsort(times[piece], kind="stable")
    found = time_factor(times[piece][order], values[piece][order], False, where, _ticks(times, table, row))
    return table, {**row, **{key: limit / found[0] for key, limit in window.items()}}, found


def _ticks(times: Floats, table: Table, row: Row) -> str:
    """The word for ``time_factor`` on times as a processor's clock counts them; "" for others."""
    counted = "asked" if guessed_in(table) and not row["signal_column"] else "taken"
    return counted if counts_ticks(times) else ""


def _check_no_count(times: Floats, place: str) -> None:
    """InputError where what stands for the time, in no stated unit, counts the rows: how many a second were taken nobody says."""
    if counts_rows(times):
        problem = "it counts the rows, and no unit says that it is a time"
        mend = "write the samples a second ⟨in rate_hz⟩; if one was taken each second or millisecond, s or ms ⟨in time_unit⟩"
        raise InputError(place, problem, "a column of time, or the samples a second", mend)


def _check_slowest(times: Floats, taken: Floats, other: Floats, place: str) -> None:
    """InputError where a column beside the one ``taken`` swings half as fast: a pendulum's height, tension and acceleration along its string do
    so twice a period, its angle once."""
    known = np.isfinite(other)
    fast, slow = half_swings(taken).period(times), half_swings(other[known]).period(times[known])
    if abs(slow / fast - 2) < TWICE:  # not nan
        raise InputError(
            place,
            f"its columns swing with periods of {fast:.3g} and {slow:.3g} s: an acceleration or a height swings twice as fast as an angle, "
            "and the file does not say what its columns hold",
            "a column with the angle",
            "name the column of the angle ⟨in signal_column⟩; an accelerometer that rides on the bob shows none",
            WHICH_COLUMN,
        )


def _read(table: Table, columns: Chosen, time_unit: str, times: Floats, scaled: bool) -> tuple[str, ...]:
    """The words of ``Interpreted.taken``."""
    found, instead = columns.found, ""
    if len(found) == 2 and scaled:
        instead = "positions, the angle about a fitted pivot"
    elif len(found) == 2:
        instead = "positions, how far along the axis on which they move"
    elif found[0].kind in (LENGTH, SPEED) and not columns.unit:
        instead = "one coordinate" if found[0].kind == LENGTH else "a speed"
    rate = 1 / float(np.median(np.diff(times)))
    what = " and ".join(f"`{one.name}`" for one in found)
    clock = f"`{columns.clock.name}` as {time_unit}"
    return what, instead, clock, f"{rate:.1f} samples a second", *([table.layout] if table.layout else [])
