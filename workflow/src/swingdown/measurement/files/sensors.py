"""Rows of several sensors in one table, each with the number or the name of the one that it was read on."""

import re
from collections.abc import Mapping

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from ...arrays import Floats
from ..choice import LOOKED_AT, SHORTEST
from ..plausibility import ENOUGH, in_a_row
from ..sheet import Row
from .columns import TIME
from .runs import by_name, clock_part, several_runs
from .table import Table, first_rows

_LABEL = re.compile(
    r"(?i)(pin|channel|chan|sensor|probe|port|kanal|canal)[ _.-]*(no|nr|num|number|id|index|nummer|#)\.?"
)
_MOST, _LOOK = 16, 200  # sensors that take turns, and rows in which no more are named
_TURNS = 0.9  # of the rows: so often the next one is another sensor's, whatever the column is called


def of_one_sensor(table: Table, row: Row) -> Table:
    """The table of one sensor, without the column that numbers or names them; as it is where none does.

    Of several sensors it is the one that the sheet's cell ``run`` names, or else the only one that swings: SeveralRuns where more or none
    do, and InputError where there is none of that name.
    """
    asked = "" if clock_part(run := str(row.get("run", ""))) else run
    table, held = first_rows(table, LOOKED_AT)
    first = pd.concat(held) if held else pd.DataFrame(columns=list(table.names))
    by_title = [name for name in table.names if _LABEL.fullmatch(name.strip())]
    found = {name: _labels(table, first, name) for name in by_title}
    if len(by_title) != 1:
        # what has a unit, as steps of time by two turns, is no label
        bare = [one.name for one in table.meanings if not (one.unit or one.written or one.kind == TIME)]
        few = (name for name in bare if first[name].head(_LOOK).nunique() <= _MOST)
        found = {name: known for name in few if _take_turns(known := _labels(table, first, name))}
    if len(found) != 1 or not np.any(known := next(iter(found.values()))):
        if asked:
            by_name((), asked, row["file"])
        return table
    (label,) = found
    named = {
        f"{label.strip()} {one}": one
        for one in dict.fromkeys(sorted(known[known != ""], key=_in_order))
        if np.sum(known == one) >= SHORTEST
    }
    if asked:
        able = [by_name(named, asked, row["file"])]
    else:
        able = list(named) if len(named) < 2 else _swinging(table, first, label, known, named)
    if not able and not by_title:
        return table
    if len(able) != 1:
        raise several_runs(tuple(named), row, row["file"], "its rows are of {} sensors")
    (taken,) = able
    others = ", ".join(f"`{name}`" for name in named if name != taken)
    why = "" if asked else ", as no other swings"
    told = (f"`{taken}` was taken of its sensors{why}; left out: {others}",) if others else ()

    def of_it(rows: pd.DataFrame) -> pd.DataFrame:
        return rows[_labels(table, rows, label) == named[taken]].drop(columns=label)

    names = tuple(name for name in table.names if name != label)
    return table._replace(names=names, pieces=map(of_it, table.pieces), remarks=(*table.remarks, *told))


def _labels(table: Table, rows: pd.DataFrame, name: str) -> NDArray[np.str_]:
    """The cells of a column as labels: whole numbers, and words; "" for all others."""
    values = table.numbers(rows, name)
    known = np.isfinite(values)
    if not known.any():
        return rows[name].astype(str).str.strip().to_numpy(dtype=str)
    if np.any(values[known] != np.round(values[known])):
        return np.full(values.size, "")
    return np.where(known, np.char.mod("%.0f", np.where(known, values, 0.0)), "")


def _in_order(label: str) -> tuple[float, str]:
    return (float(label), "") if re.fullmatch(r"-?\d+", label) else (np.inf, label)


def _take_turns(labels: NDArray[np.str_]) -> bool:
    """True for a few labels that stand in turns: nearly each row has another one than the row before, and each stands often enough."""
    known = labels[labels != ""]
    if known.size < 2 * SHORTEST or np.mean(known[1:] != known[:-1]) < _TURNS:
        return False
    counts = np.unique(known, return_counts=True)[1]
    return bool(2 <= counts.size <= _MOST and counts.min() >= SHORTEST)


def _swinging(
    table: Table, rows: pd.DataFrame, label: str, of: NDArray[np.str_], named: Mapping[str, str]
) -> list[str]:
    """The sensors of which a column swings over the time."""
    others = [name for name in table.names if name != label]
    clocks = [name for name in others if table.meaning(name).kind == TIME]
    values: dict[str, Floats] = {name: table.numbers(rows, name) for name in others}
    times = values[clocks[0]] if clocks else np.arange(of.size, dtype=float)
    read = [values[name] for name in others if name not in clocks]
    able = []
    for name, one in named.items():
        own = [(of == one) & np.isfinite(times) & np.isfinite(column) for column in read]
        if any(
            in_a_row(times[here], column[here]) >= ENOUGH
            for here, column in zip(own, read, strict=True)
            if here.any() and np.ptp(column[here])
        ):
            able.append(name)
    return able
