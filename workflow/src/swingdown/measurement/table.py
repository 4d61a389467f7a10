"""The columns of somebody's file, before any of them is read, and their cells as numbers."""

from collections.abc import Iterable
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from ..arrays import Floats

WHOLE = ""  # the name of a table that is no run: all of the file
STATES = {"blocked": 1, "unblocked": 0}  # of a light gate, as Capstone writes them
MISSING = ("", "nan", "na", "n/a", "null", "none", "inf", "-inf", "-", "--", "---")


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


def numbers(column: pd.Series, decimal: str) -> Floats:
    """The column as floats, NaN wherever a cell is no number in the file's own decimal sign; 1 and 0 for a gate's ``STATES``."""
    if column.dtype.kind in "fiu":
        return column.to_numpy(dtype=float)
    if column.dtype.kind == "b":
        return np.full(len(column), np.nan)
    words = column.astype(str).str.strip().str.lower()
    if words.isin(STATES).any():
        return words.map(STATES).to_numpy(dtype=float)
    if decimal == ",":
        text = column.astype(str)
        column = text.where(~text.str.contains(".", regex=False)).str.replace(",", ".", regex=False)
    return pd.to_numeric(column, errors="coerce").to_numpy(dtype=float)
