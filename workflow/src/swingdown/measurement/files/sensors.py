"""Rows of several sensors in one table, each with the number of the pin or channel that it was read on."""

import re
from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd

from ...arrays import Floats
from ..choice import LOOKED_AT, SHORTEST
from ..plausibility import ENOUGH, in_a_row
from .columns import TIME
from .runs import by_name, clock_part, several_runs
from .table import Table, first_rows

_LABEL = re.compile(
    r"(?i)(pin|channel|chan|sensor|probe|port|kanal|canal)[ _.-]*(no|nr|num|number|id|index|nummer|#)\.?"
)


def of_one_sensor(table: Table, row: Mapping[str, Any]) -> Table:
    """The table of one sensor, without the column that numbers them; as it is where none does.

    Of several sensors it is the one that the sheet's cell ``run`` names, or else the only one that swings: SeveralRuns where more or none
    do, and InputError where there is none of that name.
    """
    labels = [name for name in table.names if _LABEL.fullmatch(name.strip())]
    asked = "" if clock_part(run := str(row.get("run", ""))) else run
    table, held = first_rows(table, LOOKED_AT) if len(labels) == 1 else (table, [])
    each = [table.numbers(piece, labels[0]) for piece in held]
    known = np.concatenate([*each, np.empty(0)])
    found = np.unique(known[np.isfinite(known)])
    if not found.size or np.any(found != np.round(found)):
        if asked:
            by_name((), asked, row["file"])
        return table
    (label,) = labels
    named = {f"{label.strip()} {one:.0f}": one for one in found if np.sum(known == one) >= SHORTEST}
    if asked:
        able = [by_name(named, asked, row["file"])]
    else:
        able = list(named) if len(named) < 2 else _swinging(table, pd.concat(held), label, named)
    if len(able) != 1:
        raise several_runs(tuple(named), row, row["file"], "its rows are of {} sensors")
    (taken,) = able
    others = ", ".join(f"`{name}`" for name in named if name != taken)
    why = "" if asked else ", as no other swings"
    told = (f"`{taken}` was taken of its sensors{why}; left out: {others}",) if others else ()

    def of_it(rows: pd.DataFrame) -> pd.DataFrame:
        return rows[table.numbers(rows, label) == named[taken]].drop(columns=label)

    names = tuple(name for name in table.names if name != label)
    return table._replace(names=names, pieces=map(of_it, table.pieces), remarks=(*table.remarks, *told))


def _swinging(table: Table, rows: pd.DataFrame, label: str, named: Mapping[str, float]) -> list[str]:
    """The sensors of which a column swings over the time."""
    others = [name for name in table.names if name != label]
    clocks = [name for name in others if table.meaning(name).kind == TIME]
    values: dict[str, Floats] = {name: table.numbers(rows, name) for name in others}
    of = table.numbers(rows, label)
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
