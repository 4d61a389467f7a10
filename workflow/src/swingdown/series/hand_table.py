"""A table of times that were taken by hand: its heads, and its cells as numbers."""

import csv
import io
import re
from collections.abc import Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd

from ..errors import InputError
from ..measurement.files.archive import unpacked
from ..measurement.files.columns import TIME, meaning
from ..measurement.sheet import TIME_UNITS, cells_of
from .values import KNOWN, head

COUNTED = "the number of swings in the head, as `time for 10 swings (s)`; of one swing `period (s)`"
OF_TIMES = "of times taken by hand write into the head how many swings each covers, as `time for 10 swings (s)` or `period (s)`"
_LINES = 200  # of trials; a recording has more
_WORDS = 5  # of a head that stands in a comment
_HEADS = 10  # lines in which the heads stand
_TITLES = 3000  # bytes of them
_TEXT = (".csv", ".tsv", ".txt", ".dat")
_WORKBOOKS = (".xlsx", ".xls", ".ods")
_LETTERS = "abcdefghijklmnopqrstuvwxyz"  # of the lines of tables side by side, the first without
_SMALL = 12_000  # bytes: as many lines of trials have no more
_LARGEST = 300_000  # bytes: a recording may have more than can be held
_SWINGS = "osc|swing|cycle|period|périod|períod|vibr|schwing|slinger|wahni|kmit|salını|период|колеб"
_COUNTED = re.compile(rf"(?<![\d.,])(\d+)\s*[x×*·]?\s*(?:(?:full|complete)\s+)?(?:{_SWINGS}|t(?![^\W\d_]))|^t_?\{{?(\d\d+)\}}?(?!\d)", re.I)  # fmt: skip
_COUNTS = re.compile(rf"(?:n|nr|no|num|number|count|anzahl|zahl|aantal|numero|número|nombre|liczba|ilość|počet|кол|количество|число)\b\D*(?:{_SWINGS})\D*", re.I)  # fmt: skip
_HALVES = re.compile("half|halb|halv|mezz|medi|demi|meio|pół|полу|½|1/2", re.I)
_PERIOD = re.compile(r"(?:(?:mean|average|avg)\W*)?(?:(?-i:T)|period|periode|période|periodo|período|schwingungsdauer)(?:[\s_]*(?:mean|avg|average|\d))?", re.I)  # fmt: skip
_TRIAL = re.compile(r"(?:trial|try|versuch|essai|prova|ensayo|tentativa)[\s_]*\d", re.I)
_NOT = re.compile(
    r"\^|²|\*\*|squared|uncert|unsicher|incert|(?<![^\W\d_])err|fehler|fout|std|s\.?d\.?\b|±|^[uδΔd]_|delta|theor|calc|expected",
    re.I,
)
_LENGTH = re.compile(
    "length|länge|longueur|lunghezza|longitud|comprimento|lengte|długość|délka|uzunluk|длина"
)
_COUNTER = re.compile(
    r"#|n[or°]?\.?|(?:\w+_)?(?:no\.|nr\.|number|#)|(?:trial|sample|run|measurement|reading|attempt|versuch|messung|essai|prova|ensayo|tentativa)s?(?:_?(?:#|no\.?|number|nr\.?))?"
)
# `release_angle`, `angle_of_release`, `initial amplitude`, `theta_0`
_ANGLE = re.compile(
    r"(?:(?:release|initial|start(?:ing)?|anfangs|start|auslenk)[_ ]?)?(?:angle|amplitude|winkel|theta|θ|angolo|[áâ]ngulo|ampiezza|amplitud)"
    r"(?:[_ ](?:of[_ ]release|iniziale|inicial|initiale?|de[_ ]départ|0)|0)?"
)


class Times(NamedTuple):
    """A column of times: its head, of how many swings they are (0: it does not say), and the factor to s."""

    name: str
    swings: int
    factor: float


class Head(NamedTuple):
    """What another head says: its column, its unit, and whether it holds standard uncertainties."""

    column: str
    unit: str
    error: bool

    @property
    def counts(self) -> bool:
        """Whether it numbers the trials."""
        return bool(_COUNTER.fullmatch(self.column))

    @property
    def angle(self) -> bool:
        """Whether it is the angle of release."""
        return bool(_ANGLE.fullmatch(self.column))


class HandTable(NamedTuple):
    """The cells as text by line and head, the columns of times of one kind, each other head, whether the file says that it is emulated, and
    the column that counts in each line how many swings the times are, "" for none; and how many tables of these heads stood side by side."""

    cells: pd.DataFrame
    times: Sequence[Times]
    heads: Mapping[str, Head]
    emulated: bool
    counts: str = ""
    beside: int = 1

    def seconds(self, path: Path) -> pd.DataFrame:
        """The times of one swing by line and column, NaN for empty cells.

        InputError if the heads do not say of how many swings the times are, or a cell is no number above 0.
        """
        if not self.times[0].swings:
            raise InputError(f"{path.name}, column {self.times[0].name}", "it does not say how many swings each time covers", COUNTED, "write it into the head")  # fmt: skip
        found, swings = {}, self._swings(path)
        for one in self.times:
            values = pd.to_numeric(_decimal(self.cells[one.name]), errors="coerce")
            wrong = (self.cells[one.name] != "") & ~(values > 0)
            if wrong.any():
                line = wrong.idxmax()
                if re.fullmatch(r"[\d.]+(\s+[\d.]+)+", _decimal(self.cells[one.name])[line]):
                    raise InputError(
                        f"{path.name}, line {line}", "it holds several times between spaces, and nothing says which one is meant",
                        "a column for each kind of time", f"put tabs or commas between them, and write {COUNTED}",
                    )  # fmt: skip
                raise InputError(
                    f"{path.name}, line {line}, column {one.name}", f"{self.cells[one.name][line]!r} is no time", "a number of s above 0", "correct the cell, or leave it empty",
                )  # fmt: skip
            found[one.name] = values * one.factor / swings
        return pd.DataFrame(found, self.cells.index)

    def _swings(self, path: Path) -> pd.Series:
        """How many swings the times of each line are; InputError for a count that is no whole number above 0."""
        if not self.counts:
            return pd.Series(float(self.times[0].swings), self.cells.index)
        found = pd.to_numeric(self.cells[self.counts], errors="coerce")
        timed = self.cells[[one.name for one in self.times]].ne("").any(axis=1)
        wrong = timed & ~((found >= 1) & (found == np.round(found)))
        if wrong.any():
            line = wrong.idxmax()
            raise InputError(
                f"{path.name}, line {line}, column {self.counts}", f"{self.cells[self.counts][line]!r} is no number of swings", "a whole number above 0", "correct the cell",
            )  # fmt: skip
        return found

    @property
    def usual(self) -> float:
        """How many swings a time is of, as a rule."""
        counted = pd.to_numeric(self.cells[self.counts]).median() if self.counts else self.times[0].swings
        return float(counted)

    @property
    def last_digit(self) -> float:
        """A unit of the last digit that the times are written to, of one swing, in s."""
        texts = [text for one in self.times for text in _decimal(self.cells[one.name])]
        places = max(len(text.partition(".")[2]) for text in texts)
        counted = pd.to_numeric(self.cells[self.counts]).min() if self.counts else self.times[0].swings
        return float(10.0**-places * self.times[0].factor / counted)


def _decimal(cells: pd.Series) -> pd.Series:
    return cells.str.replace(",", ".", regex=False)


def hand_table(path: Path) -> HandTable | None:
    """The ``HandTable`` of a text file or a workbook; None for a file that is none.

    Its heads name times of a counted number of swings, or a period and what was varied with it.
    """
    lines = _lines(path)
    for place in _head_lines(lines):
        names, below = lines[place], _between_spaces(lines, place)
        own = [name for name in names if name]
        times = [one for name in own if (one := _times(name))]
        counts = next((name for name in own if _COUNTS.fullmatch(name) and not _HALVES.search(name)), "")
        if counts and not any(one.swings > 1 for one in times):
            times = [one for name in own if (one := _clocked(name))]
        else:
            counts = ""
        heads = {name: _head(name) for name in own if name not in {counts, *(one.name for one in times)}}
        varied = any(one.column in KNOWN and not one.error for one in heads.values())
        if not (any(one.swings > 1 for one in times) or (times and (varied or counts))):
            continue
        parts = _side_by_side(names)
        names = names[parts[0]]
        if len(set(filter(None, names))) * len(parts) < len(own):
            raise InputError(f"{path.name}, line {place + 1}", "two columns have one name", "a name of its own for each column", "rename one of them")  # fmt: skip
        if heads_below := [_spelt(cells) for cells in below if _heads_again(cells)]:
            raise InputError(
                f"{path.name}, line {place + 1}", f"it holds {1 + len(heads_below)} tables of times, one below the other ({'; '.join([_spelt(names), *heads_below])}): which one is meant?",
                "one table of times", "put the one that is meant into a file of its own",
            )  # fmt: skip
        rows = {
            f"{number}{_LETTERS[k]}" if k else number: [*cells[part], *[""] * len(names)][: len(names)]
            for k, part in enumerate(parts)
            for number, cells in enumerate(below, place + 2)
            if any(cells[part]) and not cells[0].startswith("#")
        }
        # What was timed, before the period that somebody worked out of it.
        most = max(one.swings for one in times)
        times = [one for one in dict.fromkeys(times) if one.swings == most]
        cells = pd.DataFrame.from_dict(rows, orient="index", columns=names, dtype=str)
        # a sentence with commas is no head: there are no times below it
        empty = not cells[[one.name for one in times]].ne("").to_numpy().any()
        running = counts and any(_goes_on(cells, counts, one) for one in times)
        if empty or running or not 0 < len(rows) <= _LINES or _is_clock(cells, times[0]):
            return None
        emulated = any("emulated: yes" in " ".join(cells) for cells in lines[:place])
        return HandTable(cells, times, heads, emulated, counts, len(parts))
    return None


def _side_by_side(names: Sequence[str]) -> list[slice]:
    """The columns of each table where several of the same heads stand side by side, an empty column between them; else all of them."""
    bounds = [-1, *(k for k, name in enumerate(names) if not name), len(names)]
    parts = [slice(low + 1, high) for low, high in pairwise(bounds) if high > low + 1]
    same = len(parts) > 1 and len({tuple(names[part]) for part in parts}) == 1
    return parts if same else [slice(0, len(names))]


def _heads_again(cells: Sequence[str]) -> bool:
    """Whether a comment below a table is the head of another: a few words, among them times of counted swings."""
    if not cells or not cells[0].startswith("#"):
        return False
    return any(_times(one.lstrip("# ")) for one in cells if one and len(one.split()) <= _WORDS)


def _spelt(cells: Sequence[str]) -> str:
    """The words of a head that may stand in a comment."""
    return ", ".join(filter(None, cells)).lstrip("# ")


def may_be_times(path: Path) -> bool:
    """Whether a file is so short that its numbers may be times taken by hand, whatever its heads say; a text without numbers holds none."""
    ending = path.suffix.lower()
    if ending in _WORKBOOKS:
        return 0 < len(_lines(path)) <= _LINES  # its bytes are of styles as well
    if ending not in _TEXT or not path.is_file() or path.stat().st_size >= _SMALL:
        return False
    text = path.read_bytes()
    return bool(re.search(rb"\d", text)) and len(text.splitlines()) <= _LINES


def _between_spaces(lines: Sequence[Sequence[str]], place: int) -> Sequence[Sequence[str]]:
    """The lines below a head; where its names stand between other signs than the numbers below, which spaces part, with a cell for each."""
    below = lines[place + 1 :]
    size = len([name for name in lines[place] if name])
    rows = [[one for one in cells if one] for cells in below]
    single = [len(cells) == 1 and not cells[0].startswith("#") for cells in rows]
    parted = [cells[0].split() if one else cells for cells, one in zip(rows, single, strict=True)]
    whole = any(len(cells) == 1 for cells in rows) and all(len(cells) in (0, size) for cells in parted)
    return parted if size > 1 and whole else below


def _head_lines(lines: Sequence[Sequence[str]]) -> list[int]:
    """The lines, by place, in which heads may stand: the first, and the last of however many comments above the rows."""
    comments = next((k for k, cells in enumerate(lines) if any(cells) and not cells[0].startswith("#")), 0)
    return [*range(min(_HEADS, len(lines))), *([comments - 1] if comments > _HEADS else [])]


def _lines(path: Path) -> list[list[str]]:
    """The cells of each line; none for a file that holds no such table at a glance."""
    ending = path.suffix.lower()
    if not path.is_file() or path.stat().st_size > _LARGEST:
        return []
    try:
        return _of_text(path) if ending in _TEXT else _of_workbook(path) if ending in _WORKBOOKS else []
    except InputError:  # the readers of recordings tell it better
        return []


def _of_text(path: Path) -> list[list[str]]:
    with path.open("rb") as file:
        first = file.read(_TITLES).decode(errors="replace")
    named = re.search(rf"(?i){_SWINGS}|(\b|\d)t", first)
    return cells_of(path, path)[0] if named else []


def _of_workbook(path: Path) -> list[list[str]]:
    with path.open("rb") as file:
        inside = unpacked(file, path.name, "")
        if inside is None:
            return []
        rows = csv.reader(io.TextIOWrapper(inside[0], "utf-8", newline=""), delimiter="\t")
        return [[one.strip() for one in cells] for cells in rows]


def _head(name: str) -> Head:
    column, unit, error = head(name)
    return Head("length" if _LENGTH.search(column) else column, unit, error or bool(_NOT.search(name)))


def _is_clock(cells: pd.DataFrame, one: Times) -> bool:
    """Whether the times go on in equal steps, line by line, as those of a recording do."""
    steps = np.diff(pd.to_numeric(_decimal(cells[one.name]), errors="coerce"))
    return one.swings < 2 and steps.size > 2 and bool(np.all(np.abs(steps - steps.mean()) < 1e-3 * steps.mean()))  # fmt: skip


def _goes_on(cells: pd.DataFrame, counts: str, one: Times) -> bool:
    """Whether the counts and the times rise from line to line, as those of one swing that goes on do."""
    both = cells[[counts, one.name]].apply(lambda own: pd.to_numeric(_decimal(own), errors="coerce")).dropna()
    return len(both) > 2 and bool((both.diff().iloc[1:] > 0).to_numpy().all())


def _clocked(name: str) -> Times | None:
    """What a head says of a column of times whose swings another one counts; None where it is of something else."""
    one = meaning(name)
    return None if one.kind != TIME or _NOT.search(name) else Times(name, 1, TIME_UNITS[one.unit or "s"])


def _times(name: str) -> Times | None:
    """What a head says of a column of times; None where it is of something else."""
    text, unit = re.fullmatch(r"(.*?)\s*(?:[(\[]\s*([^)\]]*?)\s*[)\]])?", name.strip(), re.S).groups()  # type: ignore[union-attr]
    stem, _, end = text.rpartition("_")
    if stem and not unit and end.lower() in ("s", "ms", "sec"):
        text, unit = stem, end
    factor = {"": 1.0, "s": 1.0, "sec": 1.0, "seconds": 1.0, "sek": 1.0, "ms": 1e-3}.get((unit or "").lower())
    if factor is None or _NOT.search(text):
        return None
    if counted := _COUNTED.search(text):
        return Times(name, int(counted[1] or counted[2]), factor)
    if _PERIOD.fullmatch(text.strip()):
        return Times(name, 1, factor)
    return Times(name, 0, factor) if _TRIAL.fullmatch(text.strip()) else None
