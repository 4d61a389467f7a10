"""Tables in a text file: cells between commas, tabs, semicolons or spaces, or a number a line."""

import io
import itertools
import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any, BinaryIO

import numpy as np
import pandas as pd

from ...errors import InputError
from ..swings.clock import counts_rows, goes_on
from .across import FEWEST, upright
from .cells import Dialect
from .columns import TIME, UNTOLD, meaning
from .layout import ARRIVED, CLOCKED, STATES_RATE, Layout, dialect
from .rows import Block, cut_short, find_blocks, layout_of, left_out, read
from .runs import rows_of, side_by_side
from .table import WHOLE, Table, prefixed
from .text import HEAD, charset, encoding, pieces_of
from .worded import reworded

_BRACKETED = re.compile(
    r"^[ \t]*(?:[(\[]{1,2}([^()\[\]\n]*)[)\]]{1,2}|\{{1,2}([^{}:=\n]*)\}{1,2})[ \t,;]*\r?$", re.MULTILINE
)
_NEXT = re.compile(r"([)\]}])[ \t,;]*(?=[(\[{])")  # between two rows that stand in one line
_MOSTLY = 0.9  # of the rows; notes stand above and below
# as oscilloscopes and LabVIEW state above or beside the rows what they measured
_VOLTS = re.compile(r"(?i)^\s*(?:vertical[ _]units?|y[ _]unit[ _]label)[,;:\t ]+(?:ch\d:)?v(?:olts?)?\b")
_SETTINGS = 40  # lines in which that stands
_MARKERS = re.compile(r"MARKER_NAMES\t(.*\S)")
_INTERVAL = re.compile(r"(?i)^\W*(delta[ _]x|sample[ _]interval|sampling[ _]interval|increment|t[ _]?inc)\b")


def delimited(source: BinaryIO, name: str, rate: float = np.nan) -> dict[str, Table]:
    """The Tables of a text file; of several below each other those of each, named by it."""
    coded = encoding(source, name)
    head, whole_head = _head(source, coded, name)
    if text := _without_brackets(source, coded, name, head):
        return prefixed("rows in brackets", delimited(text, name, rate))
    rows = head if whole_head else []
    if text := upright(rows, timed=not rate > 0):
        return prefixed("its rows as columns", delimited(text, name, rate))
    if sum(bool(line.strip()) for line in rows) == 1 and upright(rows, timed=False):
        problem = "its numbers stand in one row, and nothing says when each was read"
        mend = "write the samples a second ⟨in rate_hz⟩"
        raise InputError(name, problem, "a time for each, or the samples a second", mend)
    how = dialect(head, name, single=rate > 0)
    if (how is None or how.words) and (text := reworded(source, coded, name, surely=how is not None)):
        return prefixed("a word beside each number", delimited(text, name, rate))
    blocks, opening = find_blocks(source, coded, how, name) if how else ([], [])
    if not how or not blocks:
        problem = "it holds no table of numbers"
        raise InputError(name, problem, "columns of numbers: a time and a swing", "export it again")
    about, volts = _about(opening), any(map(_VOLTS.match, head[:_SETTINGS]))
    found = {}
    for number, block in enumerate(blocks, 1):
        whole, laid = _table(source, block, how, coded, name, rate)
        known = 0.0 if rate > 0 else stated_rate([*block.above, *block.sample[:1]])
        if known and _untimed(whole, laid):
            whole, laid = _table(source, block, how, coded, name, known, told=True)
        whole = _in_volts(whole) if volts else whole
        whole = whole._replace(about=about, cut=block is blocks[-1] and cut_short(source, block, laid))
        part = f"table {number}" if len(blocks) > 1 else WHOLE
        beside = side_by_side(laid.headers, laid.titles)
        if not (part and beside):
            found[part] = whole
        for run, own in beside.items():
            found[f"{part}, {run}" if part else run] = whole._replace(
                names=tuple(own.names), pieces=rows_of(own, whole.pieces), cut=False
            )
    return found


def _table(
    source: BinaryIO, block: Block, how: Dialect, coded: str, name: str, rate: float, told: bool = False
) -> tuple[Table, Layout]:
    """A block's Table and Layout; ``told``: it is the file that states the rate."""
    laid = layout_of(block, how, coded, name)
    markers = next((found[1].split("\t") for line in block.above if (found := _MARKERS.match(line))), [])
    axes = tuple(f"{marker.strip()} {axis}" for marker in markers for axis in "XYZ")
    if not laid.named and len(laid.names) == len(axes):
        laid = replace(laid, names=axes, headers=axes, named=True)
    how_laid, names = str(laid), laid.names
    if rate > 0:
        _check_untimed(laid, name, told)
        how_laid, names = f"{how_laid} at {rate:g} Hz", (CLOCKED, *names)
    units = {laid.names[k]: "s" for k in laid.stamps if laid.names[k] != ARRIVED}
    if axes:  # motion capture (QTM) writes millimetres
        units |= {one: "mm" for one in names if re.search(r"(?i)(^|\s)[xyz]$", one)}
    if any(meaning(one).kind == TIME and one not in units for one in names):
        # a device's own time goes before a computer's
        names = (*(one for one in names if one not in units), *units)
    rows = _Rows(source, block, laid, name, rate)
    return Table(names, {}, rows, how.decimal, how_laid, units, remarks=left_out(block)), laid


class _Rows:
    """The rows of a table, read anew each time that they are asked for."""

    def __init__(self, *asked: Any) -> None:
        self.asked = asked

    def __iter__(self) -> Iterator[pd.DataFrame]:
        return read(*self.asked)


def _without_brackets(source: BinaryIO, coded: str, name: str, head: Sequence[str]) -> BinaryIO | None:
    """The same text where each row stands in brackets, as a program prints its tuples or lists; None of another."""
    rows = [line for line in head if line.strip()]
    in_one = len(rows) < 2  # of a list as long as the head no line is whole
    if not in_one and np.mean([bool(_BRACKETED.match(line)) for line in rows]) < _MOSTLY:
        return None
    texts = (piece.decode(charset(coded), errors="replace") for _, piece in pieces_of(source, coded, name))
    first = next(texts, "")
    if in_one and len(_NEXT.findall(first, 0, HEAD)) < FEWEST:
        return None
    text = first + "".join(texts)
    return io.BytesIO(_BRACKETED.sub(r"\1\2", _NEXT.sub(r"\1\n", text)).encode())


def _head(source: BinaryIO, coded: str, name: str) -> tuple[list[str], bool]:
    """The first lines of a text, none of them cut short, and whether they are all."""
    _, piece = next(pieces_of(source, coded, name), (1, b""))
    lines = piece[:HEAD].decode(charset(coded), errors="replace").split("\n")
    return (lines, True) if len(piece) <= HEAD else (lines[:-1], False)


def _about(opening: Sequence[str]) -> dict[str, str]:
    """What the leading lines `# key: value` tell."""
    own = itertools.takewhile(lambda line: line.startswith("#"), opening)
    parts = [line.lstrip("# ").partition(":") for line in own]
    return {key.strip().lower(): value.strip() for key, colon, value in parts if colon}


def stated_rate(above: Sequence[str]) -> float:
    """The samples a second that the lines above a table state, by themselves or by the time between two samples; 0 for none.

    The value stands beside its name, or below it: ``Delta_X 0.02``, ``Sample Rate: 100 Hz``, ``X,CH1,Start,Increment``.
    """
    cells = [re.split(r"[,;:=\t]\s*", line.strip()) for line in above]
    for whole, line, below in zip(above, cells, [*cells[1:], []], strict=True):
        for k, name in enumerate(line):
            for value in (*line[k + 1 : k + 2], *below[k : k + 1]):
                number = re.match(r"\s*(\d+\.?\d*(?:[eE][-+]?\d+)?)\s*(k?)(?:Hz|Sa?/s|s|$)", value)
                found = float(number[1]) if number else 0.0
                if found and (STATES_RATE.search(name) or not k and STATES_RATE.match(whole)):
                    return found * (1e3 if number and number[2] else 1.0)
                if found and _INTERVAL.search(name):
                    return 1 / found
    return 0.0


def _in_volts(table: Table) -> Table:
    """The table with V as the unit of each column without one that neither is a time nor goes on as one."""
    first = next(iter(table.pieces))
    untold = (one.name for one in table.meanings if one.kind == UNTOLD and not one.axis)
    plain = [name for name in untold if not goes_on(table.numbers(first, name))]
    return table._replace(units={**dict.fromkeys(plain, "V"), **table.units})


def _untimed(table: Table, laid: Layout) -> bool:
    """True for a table of which no column is a time, by its name or by numbers that go on."""
    if laid.stamps:
        return False
    first = next(iter(table.pieces))
    values = {one: table.numbers(first, one) for one in table.names}
    clocks = [one for one, own in values.items() if goes_on(own) and not counts_rows(own)]
    filled = [one for one, own in values.items() if np.isfinite(own).any()]
    return not clocks and not any(meaning(one).kind == TIME for one in filled)


def _check_untimed(laid: Layout, name: str, told: bool) -> None:
    """InputError for a table with times of its own where the sheet states a rate; of one whose own rate is ``told`` the columns may have no names."""
    unnamed = not laid.named and len(laid.names) > 1 and not told
    timed = not told and any(meaning(one).kind == TIME for one in laid.names)
    if unnamed or laid.stamps or timed:
        raise InputError(
            f"{name} (column rate_hz)",
            f"the file has {len(laid.names)} columns" + ("" if unnamed else ", and times of its own"),
            "one number a line where the sheet states rate_hz, or a header that names no time",
            "leave rate_hz away: times are read from the file",
        )
