"""The columns of somebody's file, before any of them is read, and their cells as numbers."""

import itertools
import re
from collections.abc import Iterable, Mapping
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from ...arrays import Floats
from .columns import Meaning, meaning

WHOLE = ""  # the name of a table that is no run: all of the file
STATES = {"blocked": 1, "unblocked": 0}  # of a light gate, as Capstone writes them
MISSING = ("", "nan", "na", "n/a", "null", "none", "inf", "-inf", "-", "--", "---")
_PAIR = re.compile(r"^\s*[(\[]\s*([-+.\deE]+)\s*[,; ]\s*([-+.\deE]+)\s*[)\]]\s*$")
SEEN, HALF = 100, 0.5  # first rows, and the share of them with a pair that makes two columns


class Table(NamedTuple):
    """A file's columns, before any of them is read."""

    names: tuple[str, ...]
    about: dict[str, Any]  # the file's own account of itself
    pieces: Iterable[pd.DataFrame]  # its rows, indexed by line
    decimal: str = "."
    layout: str = ""  # told to the user
    units: dict[str, str] = {}  # those that the file itself states apart from the names
    cut: bool = False  # the last line was cut while it was written
    remarks: tuple[str, ...] = ()  # to the user: on lines that are no rows, pauses, how a film was followed
    usual: dict[str, float] = {}  # cells of the sample sheet where it says nothing
    ordered: bool = True  # False of arrays by name: the first of them is the swing no more than another

    def meaning(self, name: str) -> Meaning:
        """What a column holds, by its header and by the unit that the file states apart from it."""
        return meaning(name, self.units.get(name, ""))

    @property
    def meanings(self) -> list[Meaning]:
        """The same of each column, in their order."""
        return [self.meaning(name) for name in self.names]

    def numbers(self, rows: pd.DataFrame, name: str) -> Floats:
        """A column of some of its rows as floats, NaN for a cell that is no number."""
        return numbers(rows[name], self.decimal)


def prefixed(words: str, found: Mapping[str, Table]) -> dict[str, Table]:
    """The tables, each with these words before what is told of its layout."""
    return {run: one._replace(layout=f"{words}, {one.layout}") for run, one in found.items()}


def first_rows(table: Table, most: int) -> tuple[Table, list[pd.DataFrame]]:
    """The table with all its pieces yet to come, and the first of them: those that hold the first ``most`` rows and one more, or all."""
    pieces, held, rows = iter(table.pieces), list[pd.DataFrame](), 0
    for piece in pieces:
        held.append(piece)
        rows += len(piece)
        if rows > most:
            break
    return table._replace(pieces=itertools.chain(held, pieces)), held


def apart(table: Table) -> Table:
    """The table with two columns, `… x` and `… y`, for each whose cells hold a pair of numbers, as ``(1392, 685)``."""
    table, held = first_rows(table, 0)
    seen = held[-1].head(SEEN) if held else pd.DataFrame()
    pairs = [key for key in table.names if held and _pairs(seen[key]).notna().all(axis=1).mean() > HALF]
    if not pairs:
        return table
    names = tuple(own for key in table.names for own in ([f"{key} x", f"{key} y"] if key in pairs else [key]))

    def split(rows: pd.DataFrame) -> pd.DataFrame:
        return rows.join([_pairs(rows[key]).set_axis([f"{key} x", f"{key} y"], axis=1) for key in pairs])

    return table._replace(names=names, pieces=map(split, table.pieces))


def _pairs(column: pd.Series) -> pd.DataFrame:
    """What stands first and second in each cell that holds a pair of numbers, missing in the others."""
    return column.astype(str).str.extract(_PAIR)


def numbers(column: pd.Series, decimal: str) -> Floats:
    """The column as floats, NaN wherever a cell is no number in the file's own decimal sign; 1 and 0 for a gate's ``STATES``."""
    if column.dtype.kind in "fiu":
        return column.to_numpy(dtype=float)
    if column.dtype.kind == "b":
        return np.full(len(column), np.nan)
    words = column.astype(str).str.strip().str.lower()
    if words.isin(STATES).any():
        return words.map(STATES).to_numpy(dtype=float)
    if "," in decimal:
        text = column.astype(str)
        own = text if "." in decimal else text.where(~text.str.contains(".", regex=False))
        column = own.str.replace(",", ".", regex=False)
    return pd.to_numeric(column, errors="coerce").to_numpy(dtype=float)
