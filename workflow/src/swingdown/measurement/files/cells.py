"""The cells of a line of text, and which of them are numbers or stamps of a clock."""

import csv
import re
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from ...arrays import Floats
from .table import STATES

SPACES = r"\s+"
EITHER = "[.,]"  # a decimal point in some columns and a comma in others
NUMBER = {
    sign: re.compile(rf"[+-]?(\d+{sign}?\d*|{sign}\d+)([eE][+-]?\d+)?") for sign in (r"\.", ",", EITHER)
}
THOUSANDS = ",.\u2019' \u00a0\u202f"  # what stands between groups of three digits
_CLOCK = r"\d{1,2}:\d{1,2}:\d{1,2}(?:[.,]\d+)?|\d{1,3}:\d{1,2}[.,]\d+"
STAMP = re.compile(
    rf"(?i)(?:\d{{1,4}}[-/.](?:\d{{1,2}}|[a-z]{{3}})[-/.]\d{{1,4}}[T ]\s*)?(?:{_CLOCK})(?:\s?[ap]m)?(?:Z|[+-]\d\d:?\d\d)?"
)
# What a serial monitor sets before each line: `12:03:11.245 -> 512`, `[12:03:11.245] 512`.
_UNQUOTED = re.compile(r'^"([^"]*)"$')
ARRIVAL = re.compile(rf"^\s*(?:({_CLOCK})\s*->|\[({_CLOCK})\](?:\s*->)?)[ \t]*")
_HALF_A_DAY, _DAY = 43200.0, 86400.0


@dataclass(frozen=True)
class Dialect:
    """How the cells of a line stand: what is between them, the decimal sign, and whether a serial monitor's stamp goes before them."""

    separator: str
    decimal: str
    arrivals: bool = False
    words: bool = False  # True where rows hold words beside numbers
    size: int = 2  # cells of most rows
    thousands: str = ""  # what stands between groups of three digits
    led: bool = False  # True where most rows begin with a number

    def plain(self, line: str) -> str:
        """The line with a serial monitor's stamp as its first cell."""
        if not self.arrivals or not (found := ARRIVAL.match(line)):
            return line
        between = " " if self.separator == SPACES else self.separator
        return f"{found[1] or found[2]}{between}{line[found.end() :]}"

    def cells(self, line: str) -> list[str]:
        """The cells of a line."""
        return split(self.plain(line), self.separator)

    def is_number(self, cell: str) -> bool:
        """True for a number in the file's own decimal sign, for a clock's stamp, and for a light gate's state."""
        sign = r"\." if self.decimal == "." else self.decimal
        return bool(
            NUMBER[sign].fullmatch(without_groups(cell, self.thousands))
            or (":" in cell and STAMP.fullmatch(cell))
            or cell.lower() in STATES
        )


def without_groups(cell: str, thousands: str) -> str:
    """A number without what stands between its groups of three digits; any other cell as it is."""
    if not thousands or thousands not in cell:
        return cell
    whole = re.fullmatch(rf"([+-]?[1-9]\d{{0,2}}(?:{re.escape(thousands)}\d{{3}})+)(\D.*)?", cell)
    return whole[1].replace(thousands, "") + (whole[2] or "") if whole else cell


def split(line: str, separator: str) -> list[str]:
    """The cells of a line. Between spaces, a unit in brackets belongs to the name before it."""
    if separator == SPACES:
        return [_UNQUOTED.sub(r"\1", cell) for cell in re.split(r"\s+(?![(\[])", line.strip())]
    if '"' not in line:
        return [cell.strip() for cell in line.split(separator)]
    return [
        cell.strip() for cell in next(csv.reader([line], delimiter=separator, skipinitialspace=True), [""])
    ]


def stripped(cells: list[str], least: int = 0) -> list[str]:
    """The cells without empty ones at their end, ``least`` of them in any case."""
    while len(cells) > least and not cells[-1]:
        cells = cells[:-1]
    return cells


class Clock:
    """A column of a clock's stamps, piece by piece, as seconds since the first; a clock without a date goes on past midnight."""

    def __init__(self) -> None:
        self.first: Any = None
        self.last, self.days = np.nan, 0.0

    def seconds(self, column: pd.Series) -> Floats:
        """Seconds since the first stamp, NaN for a cell that is none."""
        found = stamps(column)
        known = found.dropna()
        if self.first is None:
            if not len(known):
                return np.full(len(column), np.nan)
            self.first = known.iloc[0]
        seconds = ((found - self.first) / pd.Timedelta(seconds=1)).to_numpy(dtype=float, copy=True)
        return np.round(self._past_midnight(seconds), 9) if found.dtype.kind == "m" else seconds

    def _past_midnight(self, found: Floats) -> Floats:
        known = np.flatnonzero(np.isfinite(found))
        steps = np.diff(found[known], prepend=self.last if len(known) else [])
        turns = self.days + np.cumsum(np.where(steps < -_HALF_A_DAY, 1.0, 0.0))
        if len(known):
            self.last, self.days = float(found[known[-1]]), float(turns[-1])
            found[known] += _DAY * turns
        return found


def stamps(column: pd.Series) -> pd.Series:
    """A clock's stamps as pandas has them: moments where they have a date, else times since midnight; a cell that is none is missing."""
    text = column.astype(str).str.strip().str.replace(",", ".", regex=False)
    if text.str.contains(r"^\d{1,4}[-/.](?:\d{1,2}|[A-Za-z]{3})[-/.]\d", regex=True).any():
        return pd.to_datetime(text, errors="coerce", utc=True, format="mixed")
    if text.str.contains(r"(?i)[ap]m$", regex=True).any():
        midnight = "2000-01-01 "
        return pd.to_datetime(midnight + text, errors="coerce", format="mixed") - pd.Timestamp(midnight)
    return pd.to_timedelta(text.where(text.str.count(":") == 2, "00:" + text), errors="coerce")
