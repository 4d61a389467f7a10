"""Several recordings in one file: which of its columns belong to which run, and the rows of each without the blanks beside longer runs."""

import re
from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple

import numpy as np
import pandas as pd

from ...errors import InputError
from ..sheet import Row, rows_of_parts
from .columns import TIME, UNNAMED, meaning
from .table import MISSING

# How programs mark the run that a column belongs to: `Angle (rad) Run #2` of Capstone, `Data Set 2:Angle(rad)` of Vernier's.
_MARKS = (
    re.compile(r"(?i)^(?P<label>.*?)[ ,]*(?P<run>\brun\s*#?\s*\d+)\s*(?P<rest>[^:]*)$"),
    re.compile(r"^\s*(?P<run>[^:()\[\]]*[^:()\[\]\s])\s*:\s*(?P<label>\S.*)$"),
)
_NUMBERED = re.compile(
    r"^(?P<label>.*?[^\W\d_])(?:[ _#-]?(?=\d)|[ _](?=[A-Z]))(?P<run>\d+|[A-Z])(?P<rest>\s*[(\[].*)?$"
)


class SeveralRuns(InputError):
    """A file with several runs, none of which is asked for: ``names`` are theirs."""

    names: tuple[str, ...] = ()


class Run(NamedTuple):
    """The columns of a run, by their positions in the file, and what they are called in it."""

    columns: list[int]
    names: list[str]
    own: list[int]  # of ``columns``, those that no other run has


def side_by_side(names: Sequence[str], titles: Sequence[str] = ()) -> dict[str, Run]:
    """The Runs that stand side by side in a table, by their names in the order of the file; none where it holds one recording.

    ``names`` are the headers as written and ``titles`` the cells of the line above them. Runs are told by what
    programs write into the headers, by headers that repeat from a time on, and by positions and times that are numbered.
    A time that stands outside of all runs belongs to each.
    """
    for split in (_marked, _repeated, _pairs_again, _numbered):
        marks = split(names, titles)
        if len(set(filter(None, marks))) > 1 and (found := _runs(names, marks)):
            return found
    return {}


def _marked(names: Sequence[str], titles: Sequence[str]) -> list[str]:
    """The run that a program's mark in each header tells, "" where there is none."""
    for mark in _MARKS:
        found = [mark.match(name) for name in names]
        if any(found):
            return [" ".join(one["run"].split()) if one else "" for one in found]
    return [""] * len(names)


def _repeated(names: Sequence[str], titles: Sequence[str]) -> list[str]:
    """A run from each column on that has the name of the first time."""
    clock = next((name for name in names if meaning(name).kind == TIME), None)
    starts = [k for k, name in enumerate(names) if name == clock]
    if len(starts) < 2:
        return [""] * len(names)
    of = [int(np.searchsorted(starts, k, "right")) for k in range(len(names))]
    called = _called(titles, starts, len(names))
    return [called[k - 1] if k else "" for k in of]


def _pairs_again(names: Sequence[str], titles: Sequence[str]) -> list[str]:
    """A run for each time that the positions x and y are there again."""
    axes = [meaning(name).axis for name in names]
    starts = [k for k, axis in enumerate(axes) if axis == "x" and axes[k + 1 : k + 2] == ["y"]]
    called = _called(titles, starts, len(names))
    marks = [""] * len(names)
    for start, run in zip(starts, called, strict=True):
        marks[start : start + 2] = [run, run]
    return marks


def _called(titles: Sequence[str], starts: Sequence[int], size: int) -> list[str]:
    """The names of runs that begin at these columns: what stands above them, else their numbers."""
    ends = [*starts, size][1:]
    pieces = (titles[start:end] for start, end in zip(starts, ends, strict=True))
    above = [next(filter(None, cells), "") for cells in pieces]
    if all(above) and len(set(above)) == len(above):
        return above
    return [f"run {k}" for k in range(1, len(starts) + 1)]


def _numbered(names: Sequence[str], titles: Sequence[str]) -> list[str]:
    """A run for each number or capital letter that headers end in, where each has the same headers and a time or positions are among them."""
    found = [_NUMBERED.match(name) for name in names]
    groups: dict[str, list[str]] = {}
    for one in filter(None, found):
        groups.setdefault(one["run"], []).append(one["label"] + (one["rest"] or ""))
    labels = next(iter(groups.values()), [])
    told = [meaning(label) for label in labels]
    whole = any(one.kind == TIME for one in told) or {"x", "y"} <= {one.axis for one in told}
    if not whole or any(sorted(other) != sorted(labels) for other in groups.values()):
        return [""] * len(names)
    return [f"run {one['run']}" if one else "" for one in found]


def _runs(names: Sequence[str], marks: Sequence[str]) -> dict[str, Run]:
    """The Runs of these marks; none unless each has a time, of its own or shared, and a column beside it."""
    bare = [_bare(name, mark) for name, mark in zip(names, marks, strict=True)]
    clocks = [k for k, name in enumerate(bare) if meaning(name).kind == TIME]
    shared = [k for k, mark in enumerate(marks) if not mark]
    found = {}
    for run in dict.fromkeys(filter(None, marks)):
        own = [k for k, mark in enumerate(marks) if mark == run]
        timed = [k for k in own if k in clocks]
        columns = own if timed else sorted([*shared, *own])
        if not (timed or set(shared) & set(clocks)) or len(columns) < 2:
            return {}
        named = [bare[k] or f"{UNNAMED}{k}" for k in columns]
        # what stands beside the runs has one name twice: which is meant is not told
        if len(set(named)) < len(named):
            return {}
        found[run] = Run(columns, named, own)
    return found


def _bare(name: str, run: str) -> str:
    """A numbered position or time by the name that it would have alone; any other name as it is."""
    found = _NUMBERED.match(name)
    if found and run == f"run {found['run']}":
        label = found["label"] + (found["rest"] or "")
        return label if meaning(label).axis or meaning(label).kind == TIME else name
    return name


def rows_of(run: Run, pieces: Iterable[pd.DataFrame]) -> Iterator[pd.DataFrame]:
    """The rows of a run: those before its first number and after its last, which stand there for longer runs alone, are left out."""
    own = [run.columns.index(k) for k in run.own]
    begun, held = False, []
    for piece in pieces:
        part = piece.iloc[:, run.columns].set_axis(run.names, axis=1)
        filled = np.flatnonzero(~blank(part.iloc[:, own]))
        if not len(filled):
            held += [part] if begun else []
            continue
        first, last = (0 if begun else filled[0]), filled[-1] + 1
        yield from held
        yield part.iloc[first:last]
        begun, held = True, [part.iloc[last:]] if last < len(part) else []


def blank(cells: pd.DataFrame) -> np.ndarray:
    """True for the rows in which every cell is empty, or a word for that."""
    empty = cells.isna()
    for key, column in cells.items():
        if column.dtype.kind not in "fiub":
            empty[key] |= column.astype(str).str.strip().str.lower().isin(MISSING)
    return empty.to_numpy().all(axis=1)


def by_name(found: Iterable[str], asked: str, place: str) -> str:
    """The run of that name, in whatever capitals; InputError where there is none."""
    names = list(found)
    for name in names:
        if name.casefold() == asked.casefold():
            return name
    problem = f"there is no run {asked!r} in it"
    expected = ", ".join(names) or "one recording, and no runs"
    raise InputError(f"{place} (column run)", problem, expected, "correct ⟨run⟩, or leave it empty")


def several_runs(
    names: tuple[str, ...], row: Row, place: str, why: str = "the file holds {} runs"
) -> SeveralRuns:
    """The refusal of a file with several runs, ``why`` with their number. Its mend holds the rows of the sheet that make each of them a recording."""
    rows = rows_of_parts(row, [{"run": name} for name in names])
    problem = f"{why.format(len(names))}: {', '.join(names)}"
    mend = f"put these rows in place of this one:\n{rows}"
    refusal = SeveralRuns(f"{place} (column run)", problem, "one recording", mend)
    refusal.names = names
    return refusal


def clock_part(asked: str) -> int:
    """The number of the part that is asked for of a recording whose clock counts anew, as ``part 2``; 0 for another name."""
    found = re.fullmatch(r"part (\d+)", asked)
    return int(found[1]) if found else 0
