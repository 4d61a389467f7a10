"""The numbers of a recording's columns within its window, read piece by piece; a row with a cell that is none is a missing sample."""

from collections.abc import Iterable, Iterator

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from ...arrays import Bools, Floats
from ...errors import InputError
from ...rounding import moment
from ..sheet import TIME_UNITS, Row
from .columns import place_of
from .source import Table
from .table import MISSING

MOST_EMPTY = 0.5  # of the rows of a window: a column with fewer numbers is another one
MOST_SPOILT = 0.05  # of them, with something else in a cell: a file that is damaged
MOST = 18_000_000  # samples that are held at once: with all that is asked of them, less than a gigabyte


def series(
    table: Table, row: Row, time_column: str, columns: list[str], time_unit: str, beside: Iterable[str] = ()
) -> tuple[Floats, list[Floats], list[str]]:
    """Times (s) within the window, the columns there, and remarks on rows without a number in one of them: missing samples.

    What is ``beside`` follows the columns, and no cell of it needs to be a number. Only what lies in the window is held, and the rows
    that are being read. InputError where half of the rows have no number, or many hold something else.
    """
    spoilt = {key: _Spoilt() for key in (time_column, *columns)}
    held, parts = 0, [[] for _ in (time_column, *columns, *beside)]  # type: ignore[var-annotated]
    first, last_of_all = np.inf, -np.inf
    for rows, last in _with_last(table.pieces):
        piece = rows.iloc[:-1] if table.cut and last else rows
        lines = piece.index.to_numpy()
        times = table.numbers(piece, time_column) * TIME_UNITS[time_unit]
        first, last_of_all = np.fmin.reduce(times, initial=first), np.fmax.reduce(times, initial=last_of_all)
        # NaN, of the times or of a limit, is neither
        inside = ~((times < row["start_s"]) | (times > row["stop_s"]))
        values = [table.numbers(piece[key], inside) for key in (*columns, *beside)]
        whole = np.ones(np.count_nonzero(inside), dtype=bool)
        for key, own in zip((time_column, *columns), (times[inside], *values), strict=False):
            whole &= spoilt[key].note(piece[key][inside], own, lines[inside])
        for kept, part in zip(parts, (times[inside], *values), strict=True):
            kept.append(part if whole.all() else part[whole])
        if (held := held + int(whole.sum())) > MOST:
            mend = "choose a part of it with ⟨start_s⟩ and ⟨stop_s⟩"
            raise InputError(row["file"], f"more than {MOST} samples", f"at most {MOST} in the window", mend)
    # 0 is "from the first"; a start so long before counts from there, and not as the file does
    if 0 < row["start_s"] < first - (last_of_all - first):
        problem = f"⟨start_s⟩, {row['start_s']:g} s, is long before its first time, {moment(first, 9)} s: it cuts nothing off"
        mend = f"write ⟨start_s={moment(first + row['start_s'], 9)}⟩, or leave it out"
        raise InputError(
            f"{row['file']}, {place_of(time_column)}", problem, "a time as the file counts it", mend
        )
    told = [remark for key, one in spoilt.items() for remark in one.told(row["file"], key)]
    joined = []
    for pieces_of_one in parts:
        joined.append(np.concatenate(pieces_of_one) if pieces_of_one else np.empty(0))
        pieces_of_one.clear()  # only one column is held twice at a time
    return joined[0], joined[1:], told


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
    """The cells of a column that are no finite numbers: how many, of how many, and the first that is not empty."""

    def __init__(self) -> None:
        self.line, self.cell, self.count, self.odd, self.rows = 0, "", 0, 0, 0

    def note(self, cells: pd.Series, values: Floats, lines: NDArray[np.integer]) -> Bools:
        """True for the cells that are numbers."""
        sound = np.isfinite(values)
        self.rows += sound.size
        bad = np.flatnonzero(~sound)
        self.count += len(bad)
        for k in bad:
            written = str(cells.iloc[k]).strip()
            if written.lower() not in MISSING:
                self.odd += 1
                if self.odd == 1:
                    self.line, self.cell = int(lines[k]), written
        return sound

    def told(self, name: str, key: str) -> list[str]:
        """A remark on them, or none; InputError where they are too many."""
        if not self.count:
            return []
        first = f"the first {self.cell[:40]!r} in line {self.line}" if self.odd else "they are empty"
        if self.count > MOST_EMPTY * self.rows or self.odd > MOST_SPOILT * self.rows:
            mend = "mend the file, choose another column, or leave the part out with ⟨start_s⟩ and ⟨stop_s⟩"
            if not self.odd:
                mend += (
                    f"; if the {self.rows - self.count} rows with a number are turning points alone, name the column ⟨in signal_column⟩ "
                    "and write half_swings (both sides) or turning_points (one side) ⟨in signal_kind⟩"
                )
            raise InputError(
                f"{name}, {place_of(key)}" if not self.odd else f"{name}, line {self.line}, {place_of(key)}",
                f"{self.count} of {self.rows} cells hold no finite number ({first})",
                "numbers (a few samples may be missing)",
                mend,
            )
        return [f"{self.count} of {self.rows} cells of `{key}` hold no number ({first}): missing samples"]
