"""The numbers of a recording's columns within its window, read piece by piece; a cell that is none is told by its line."""

import math
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from ..arrays import Floats
from ..errors import InputError
from .sheet import TIME_UNITS
from .source import Table
from .table import numbers

MOST = 18_000_000  # samples that are held at once: with all that is asked of them, less than a gigabyte


def series(
    table: Table,
    row: Mapping[str, Any],
    time_column: str,
    columns: list[str],
    time_unit: str,
    beside: Iterable[str] = (),
) -> tuple[Floats, list[Floats], NDArray[np.integer], int]:
    """Times (s) within the window, the columns there, the lines they stand in, and the rows in the file.

    What is ``beside`` follows the columns, and no cell of it needs to be a number.
    Only what lies in the window is held, and the rows that are being read.
    """
    name, spoilt, total, held = row["file"], {key: _Spoilt() for key in (time_column, *columns)}, 0, 0
    parts: list[list[Any]] = [[] for _ in (time_column, *columns, *beside, "lines")]
    for rows, last in _with_last(table.pieces):
        piece = rows.iloc[:-1] if table.cut and last else rows
        lines = piece.index.to_numpy()
        total += len(piece)
        times = numbers(piece[time_column], table.decimal) * TIME_UNITS[time_unit]
        spoilt[time_column].note(piece[time_column], times, lines)
        inside = np.ones(len(times), dtype=bool)
        if not math.isnan(row["start_s"]):
            inside &= times >= row["start_s"]
        if not math.isnan(row["stop_s"]):
            inside &= times <= row["stop_s"]
        values = [numbers(piece[key][inside], table.decimal) for key in (*columns, *beside)]
        for key, own in zip(columns, values, strict=False):
            spoilt[key].note(piece[key][inside], own, lines[inside])
        for kept, part in zip(parts, (times[inside], *values, lines[inside].astype(np.int32)), strict=True):
            kept.append(part)
        if (held := held + int(inside.sum())) > MOST:
            raise InputError(
                name,
                f"more than {MOST} samples",
                f"at most {MOST} in the window",
                "choose a part of it with start_s and stop_s",
            )
    for key, one in spoilt.items():
        one.check(name, key)
    if not parts[0]:
        return np.empty(0), [np.empty(0)] * (len(parts) - 2), np.empty(0, dtype=int), 0
    joined = []
    for pieces_of_one in parts:
        joined.append(np.concatenate(pieces_of_one))
        pieces_of_one.clear()  # only one column is held twice at a time
    return joined[0], joined[1:-1], joined[-1], total


def _with_last(pieces: Iterable[pd.DataFrame]) -> Iterator[tuple[pd.DataFrame, bool]]:
    """Each piece, and whether it is the last."""
    before = None
    for piece in pieces:
        if before is not None:
            yield before, False
        before = piece
    if before is not None:
        yield before, True


class _Spoilt:
    """The cells of a column that are no finite numbers: the first of them, and how many."""

    def __init__(self) -> None:
        self.line, self.cell, self.count = 0, "", 0

    def note(self, cells: pd.Series, values: Floats, lines: NDArray[np.integer]) -> None:
        bad = np.flatnonzero(~np.isfinite(values))
        if len(bad) and not self.count:
            self.line, self.cell = int(lines[bad[0]]), str(cells.iloc[bad[0]])
        self.count += len(bad)

    def check(self, name: str, key: str) -> None:
        if self.count:
            raise InputError(
                f"{name}, line {self.line}, column {key}",
                f"{self.cell} is not a finite number ({self.count} such cells)",
                "a number in every row",
                "mend the file, or leave the part out with start_s and stop_s",
            )
