"""Columns in units that are a known number of another one, as min or mrad: they are read in s, rad and V."""

from math import pi
from typing import Any

import pandas as pd

from ...errors import InputError
from ..sheet import LENGTHS, Row
from .columns import TIME, UNTOLD
from .table import Table

# "grad" is none of them: to some it is a degree, to others a 400th of a turn
_WORTH = {
    "s": {"min": 60.0, "minutes": 60.0, "h": 3600.0, "hours": 3600.0}
    | dict.fromkeys(("1/10 s", "0.1 s", "0,1 s"), 0.1)
    | dict.fromkeys(("1/100 s", "0.01 s", "0,01 s"), 0.01),
    "rad": {"mrad": 1e-3, "gon": pi / 200, "arcmin": pi / 10_800, "arcsec": pi / 648_000}
    | dict.fromkeys(("rev", "revs", "revolutions", "turn", "turns"), 2 * pi),
    "V": {"mv": 1e-3, "µv": 1e-6, "μv": 1e-6},
    "rad/s": {"rpm": pi / 30, "mdps": pi / 180_000},
}
FACTORS = {written: (unit, worth) for unit, all_ in _WORTH.items() for written, worth in all_.items()}


def with_stated_length(table: Table, row: dict[str, Any], place: str) -> tuple[Table, dict[str, Any]]:
    """The table and the sheet's ``row`` where that states a length: it then is the positions' own unit, as if the header had it.

    InputError where no column that says nothing of a unit can hold positions.
    """
    unit = row["signal_unit"]
    if unit not in LENGTHS:
        return table, row
    untold = [one for one in table.meanings if one.kind == UNTOLD and one.name != row["time_column"]]
    wanted = row["signal_column"] or (table.names[-1] if len(table.names) == 2 else "")
    named = [one.name for one in untold if one.name == wanted or (one.axis and not wanted)]
    if not named:
        raise InputError(
            f"{row['file']} ({place}, column signal_unit)",
            f"{unit} is the unit of a position, and no column without a unit is one",
            "a column x or y whose unit the file does not state",
            "name the column of the position ⟨in signal_column⟩, or leave ⟨signal_unit⟩ out",
        )
    return table._replace(units={**table.units, **dict.fromkeys(named, unit)}), {**row, "signal_unit": ""}


def in_known_units(table: Table, row: Row) -> Table:
    """The table with the columns in such a unit in s, rad, V or rad/s, each with a remark; where the sheet's ``row`` states a unit, as it is."""
    known = table.meanings
    found = {
        one.name: FACTORS[one.written.lower()]
        for one in known
        if one.written.lower() in FACTORS and not row["time_unit" if one.kind == TIME else "signal_unit"]
    }
    if not found:
        return table

    def converted(rows: pd.DataFrame) -> pd.DataFrame:
        return rows.assign(
            **{name: factor * table.numbers(rows, name) for name, (_, factor) in found.items()}
        )

    told = tuple(
        f"`{name}` is read in {unit}, {factor:.6g} for one of its unit"
        for name, (unit, factor) in found.items()
    )
    units = {name: unit for name, (unit, _) in found.items()}
    return table._replace(
        pieces=map(converted, table.pieces), units={**table.units, **units}, remarks=(*table.remarks, *told)
    )
