"""Turning points in a table: its columns of times or numbers, of readings, and of their uncertainties."""

import itertools
import re
from collections.abc import Iterable, Iterator, Sequence
from math import pi
from typing import NamedTuple

import numpy as np
import pandas as pd
import xarray as xr

from ...arrays import Bools, Floats
from ...errors import InputError
from ..files.columns import ANGLE, LENGTH, OF_AN_ERROR, TIME, UNNAMED, UNTOLD, Meaning, choose, place_of
from ..files.source import Table
from ..files.table import numbers
from ..sheet import TIME_UNITS, Row
from .points_recording import about_file, as_recording
from .turning_points import PASSAGES, PERIODS, SWING, Points, points_in

_MOST = 100_000  # rows: of a file with more each is a sample
_NUMBER = re.compile(
    r"(?i)^(n|no|nr|num|number|#|k|i|index|swings?|oscillations?|peaks?|cycles?|count|schwingung(en)?"
    r"|(number|no\.?|nr\.?) of (swings|oscillations|cycles)|zahl der schwingungen)( (no|nr|number|#))?\.?$"
)


class Columns(NamedTuple):
    """What of a table may be turning points: the column of times or numbers, that of the readings, those of their uncertainties."""

    clock: Meaning
    signal: Meaning
    u_clock: str = ""
    u_signal: str = ""


def turning_points(table: Table, row: Row, place: str) -> tuple[Table, xr.Dataset | None]:
    """The table, to be read on, and the dataset of its turning points; None where it holds something else.

    The dataset has ``signal`` over ``time`` in the readings' unit and ``half_swings`` since the first. ``signal_kind`` of the ``row``
    is the last word. InputError where one of several readings must be chosen, and for too few points.
    """
    stated = str(row.get("signal_kind", ""))
    if stated in (SWING, PASSAGES, PERIODS):
        return table, None
    first, table = peeked(table, row)
    if first is None:
        return table, None
    asked = (row["time_column"], row["signal_column"])
    of_numbers = tuple(one for one in table.names if one in asked or first[one].notna().any())
    columns = _columns(table._replace(names=of_numbers), row)
    if columns is None:
        return table, None
    values = {one: table.numbers(first, one) for one in (columns.clock.name, columns.signal.name)}
    clock, signal = values.values()
    scale = TIME_UNITS[row["time_unit"] or columns.clock.unit or "s"]
    sound = np.isfinite(clock) & np.isfinite(signal) & in_window(clock * scale, row)
    counted = is_number(columns.clock, clock[sound])
    where = f"{row['file']}, {place_of(columns.signal.name)} ({place})"
    unit, told = _unit(signal[sound], columns, row)
    in_rad = {"rad": 1.0, "deg": pi / 180}.get(unit, 0.0)
    times = clock[sound] * (1.0 if counted else scale)
    points = points_in(times, signal[sound], where, stated, counted, columns.signal.name, in_rad)
    if points is None:
        return table, None
    u_clock, u_signal = (_typical(first, name, table.decimal) for name in (columns.u_clock, columns.u_signal))
    points = points._replace(remarks=[*told, *points.remarks])
    about = about_file(table, row, _taken(points, columns, row, table, unit))
    return table, as_recording(points, unit, about, row, (u_clock * scale, u_signal))


def peeked(table: Table, row: Row) -> tuple[pd.DataFrame | None, Table]:
    """The numbers of a small table, and the table as it was before they were read; None of a larger one, or where the ``row`` states a rate
    or a bob at rest."""
    if row.get("rate_hz", np.nan) > 0 or row.get("role") == "static":
        return None, table
    pieces, seen = iter(table.pieces), []
    problem: InputError | None = None
    try:
        seen = list(itertools.islice(pieces, 3))  # a last line without an end is a piece of its own
    except InputError as error:  # it is told where the table is read
        problem = error
    whole = table._replace(pieces=_again(seen, pieces, problem))
    if problem is not None or len(seen) > 2 or not 0 < sum(map(len, seen)) <= _MOST:
        return None, whole
    told = [pd.DataFrame({name: table.numbers(one, name) for name in one}) for one in seen]
    rows = pd.concat(told, ignore_index=True)  # as numbers: of a piece with words a column is of another type
    return rows.iloc[: -1 if table.cut else None], whole


def _again(
    seen: Sequence[pd.DataFrame], rest: Iterable[pd.DataFrame], problem: InputError | None
) -> Iterator[pd.DataFrame]:
    yield from seen
    if problem:
        raise problem
    yield from rest


def _columns(table: Table, row: Row) -> Columns | None:
    """The columns that may be turning points; None where the file has none, or positions."""
    found = [table.meaning(name) for name in table.names if not name.startswith(UNNAMED)]
    usable = [one for one in found if not OF_AN_ERROR.search(one.name.replace("_", " "))]
    stated = row["time_unit"], row["signal_unit"]
    try:
        clock, chosen = choose(
            [one.name for one in usable], row["time_column"], row["signal_column"], "", stated, table.units
        )
    except (InputError, KeyError):  # as an amplitude in cm without its partner
        if len(usable) < 2:
            return None
        clock, *chosen = usable[:2]
    # one coordinate at its turning points, without its partner
    if row["signal_kind"] and row["signal_column"]:
        chosen = [one for one in usable if one.name == row["signal_column"]]
    if len(chosen) != 1 or clock.kind not in (TIME, UNTOLD) or chosen[0].kind not in (ANGLE, LENGTH, UNTOLD):
        return None
    signal = chosen[0]
    headed = "no header" not in table.layout
    errors = [one.name for one in found if one not in usable and headed]  # one alone is of the readings
    return Columns(clock, signal, *["", "", *errors[:2]][-2:])


def in_window(times: Floats, row: Row) -> Bools:
    """True for the times (s) within the window of the ``row``, and for what is no number."""
    start, stop = (float(row.get(key, np.nan)) for key in ("start_s", "stop_s"))
    return ~(times < start) & ~(times > stop)


def is_number(clock: Meaning, values: Floats) -> bool:
    """True for a column that counts the swings: it is called so, or has no name, and holds whole numbers one apart."""
    if not np.all(values == np.round(values)):
        return False
    one_apart = values.size > 1 and bool(np.all(np.diff(np.sort(values)) == 1))
    return bool(_NUMBER.match(clock.name.strip())) or (clock.kind == UNTOLD and one_apart)


def _typical(rows: pd.DataFrame, name: str, decimal: str) -> float:
    """The median of a column of uncertainties; nan where there is none, or it says 0."""
    if not name:
        return float("nan")
    values = numbers(rows[name], decimal)
    middle = float(np.nanmedian(values)) if np.isfinite(values).any() else 0.0
    return middle if middle > 0 else float("nan")


def _taken(points: Points, columns: Columns, row: Row, table: Table, unit: str) -> str:
    """How a file's turning points were read."""
    seconds = row["time_unit"] or columns.clock.unit or "s (no unit is stated)"
    clock = f"`{columns.clock.name}` as {seconds if points.timed else 'the number of the swing'}"
    words = {"rad": "rad", "deg": "degrees"}.get(unit, unit)
    said = words if columns.signal.written or row["signal_unit"] else f"{words} (no unit is stated)"
    taken = f"took `{columns.signal.name}` as turning points, {points.each}, in {said}, {clock}"
    return f"{taken}, {table.layout}" if table.layout else taken


def _unit(readings: Floats, columns: Columns, row: Row) -> tuple[str, list[str]]:
    """The unit of a column's readings, and a remark where it was inferred or is none of angles."""
    signal = columns.signal
    coordinate = signal.kind == LENGTH or (signal.axis and columns.clock.axis != "x")  # y over x is a graph's
    if coordinate and not row["signal_unit"]:
        unit = signal.written or "units of its own"
        return unit, [f"an amplitude in {unit} is no angle: how the period depends on it is not reported"]
    return unit_of(readings, row["signal_unit"] or (signal.unit if signal.kind == ANGLE else ""))


def unit_of(readings: Floats, stated: str) -> tuple[str, list[str]]:
    """The unit of angles that is ``stated``, or else the only one that a pendulum's readings can have, with a remark."""
    if stated:
        return stated, []
    if float(np.abs(readings).max(initial=0.0)) > pi:
        return "deg", ["no unit is stated, and no pendulum swings by so many rad: taken for degrees"]
    return "rad", []
