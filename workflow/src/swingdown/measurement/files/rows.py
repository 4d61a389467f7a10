"""Where the rows of numbers stand in a text file: one table or several below each other, and what stands between them and is none."""

import io
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import BinaryIO

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from ...errors import InputError
from .cells import SPACES, Clock, Dialect, stamps, stripped
from .columns import TIME, meaning
from .layout import CLOCKED, COMMENT, Layout, layout, tells
from .table import MISSING, numbers
from .text import charset, pieces_of

FEWEST = 10  # rows; a smaller table beside a larger one is none of a swing
KEPT = 40  # lines above a table that may name its columns, and rows of it from which a header is told
HEADED = 3 * KEPT  # lines in which a table begins
MOST_ODD = 1_000_000  # lines that are no rows of numbers; a file with more of them is no table
BEYOND = "\0beyond the last column"


@dataclass
class Block:
    """A table: the lines above it, where its rows stand, and the lines between and below them that are none."""

    above: list[str]
    size: int
    clock: int = 0  # the column whose number grows
    parts: list[list[int]] = field(default_factory=list)  # first and last line of rows that stand together
    sample: list[str] = field(default_factory=list)
    between: list[int] = field(default_factory=list)
    below: list[int] = field(default_factory=list)
    surplus: list[int] = field(default_factory=list)  # of ``between``, rows with too many cells
    small: list[int] = field(default_factory=list)  # rows of numbers above, too few for a table
    tail: str = ""  # the last row

    @property
    def rows(self) -> int:
        """How many rows it has."""
        return sum(last - first + 1 for first, last in self.parts)

    @property
    def lines(self) -> list[int]:
        """The lines of its rows."""
        return [line for first, last in self.parts for line in range(first, last + 1)]


def find_blocks(source: BinaryIO, encoding: str, how: Dialect, name: str) -> tuple[list[Block], list[str]]:
    """The Blocks of a text file in order, and the lines above the first of them; InputError for a file that is no table.

    A table ends where a header of another one follows, or where the clock goes back after lines that are no rows. Tables of
    fewer than 10 rows are none where there is a larger one.
    """
    finder = _Finder(how, charset(encoding), name)
    for first, piece in pieces_of(source, encoding, name):
        finder.take(first, piece)
    found = finder.found()
    return found, finder.opening


class _Finder:
    """Goes through a file once: pieces of plain rows as a whole, others by the line."""

    def __init__(self, how: Dialect, charset: str, name: str) -> None:
        self.how, self.charset, self.name = how, charset, name
        self.blocks: list[Block] = []
        self.opening: list[str] = []
        self.gap: list[tuple[int, str]] = []  # lines since the last row that are no rows
        self.empty = False  # an empty line is among them
        self.odd = 0
        between = b" \t" if how.separator == SPACES else how.separator.encode()
        self.plain = b"0123456789+-eE \n" + between + how.decimal.encode()

    def take(self, first: int, piece: bytes) -> None:
        """Goes on with the lines of a piece."""
        if self._as_a_whole(first, piece):
            return
        # where a table begins, what follows may be plain
        if not self.blocks and (end := _after(piece, HEADED)):
            self._by_the_line(first, piece[:end])
            first, piece = first + HEADED, piece[end:]
            if self.blocks and len(self.blocks[-1].sample) == KEPT and self._as_a_whole(first, piece):
                return
        self._by_the_line(first, piece)

    def _by_the_line(self, first: int, piece: bytes) -> None:
        before = first - 1
        for number, line in _filled_lines(first, piece):
            self.empty |= number > before + 1
            before = number
            self._line(number, line.decode(self.charset, errors="replace"))
        self.empty |= first + piece.count(b"\n") > before + 1

    def _as_a_whole(self, first: int, piece: bytes) -> bool:
        """True where all lines are rows of the table that goes on, and are taken."""
        if not piece.strip(b"\n"):
            self.empty = True
            return True
        block = self.blocks[-1] if self.blocks else None
        if block is None or self.gap or self.empty or self.how.arrivals:
            return False
        if (b"\n" + piece).find(b"\n" + self.how.separator.encode()) >= 0:  # perhaps a row of empty cells
            return False
        bare, separator = piece, self.how.separator
        if b'"' in piece and separator != SPACES:  # each cell is quoted, or the lines are looked at singly
            bare, separator = piece.replace(f'"{separator}"'.encode(), b"\t").replace(b'"', b""), "\t"
        if bare.translate(None, self.plain + b"\t") or (_counts(bare, separator) != block.size).any():
            return False
        block.parts[-1][1] = first + piece.count(b"\n") - 1
        block.tail = piece[piece.rfind(b"\n", 0, -1) + 1 : -1].decode()
        return True

    def _line(self, number: int, line: str) -> None:
        block = self.blocks[-1] if self.blocks else None
        cells = stripped(self.how.cells(line), block.size if block else self.how.size)
        if not any(cells):
            self.empty = True
            return
        if not self._is_row(line, cells, block):
            self._no_row(number, line, block)
            return
        parted = bool(self.gap or self.empty) and not (block and block.surplus[-1:] == [number - 1])
        if block is None or (parted and not self._goes_on(line, cells, block)):
            block = self._begin(len(cells))
        elif len(cells) > block.size:
            self._surplus(number, line, block)
            return
        self._add(number, line, block)

    def _is_row(self, line: str, cells: Sequence[str], block: Block | None) -> bool:
        """True for a row of numbers, one of which may be spoilt or missing."""
        bare = cells[1:] if self.how.arrivals else cells
        found = sum(map(self.how.is_number, bare))
        if not found or line.count('"') % 2 or "\0" in line or COMMENT.match(line):
            return False
        if found + sum(cell.lower() in MISSING for cell in bare) == len(bare):
            return len(cells) > 1 or self.how.size == 1 or (block is not None and not self.gap)
        if len(cells) != (block.size if block else self.how.size):
            return False
        leads = self.how.is_number(bare[0]) or bare[0].lower() in MISSING
        if block is None and self.how.led and not self.how.words and not leads:
            return False  # a setting and its value, above the table
        # a header may hold numbers, as of releases from 30 and 40 degrees
        header = not self.how.is_number(cells[0]) and meaning(cells[0]).kind == TIME
        return not header and (block is not None or not self.how.words or found > 1)

    def _no_row(self, number: int, line: str, block: Block | None) -> None:
        self.odd += 1
        if self.odd > MOST_ODD:
            problem = f"{MOST_ODD} of its lines are not rows of numbers"
            raise InputError(self.name, problem, "a table of numbers as text", "export it again")
        self.gap.append((number, line))
        if block is None:
            self.opening.append(line)
            del self.opening[: -10 * KEPT]

    def _goes_on(self, line: str, cells: Sequence[str], block: Block) -> bool:
        """True where a row after other lines belongs to the table before them."""
        gap = [one for _, text in self.gap if len(one := self.how.cells(text)) == len(cells)]
        if block.rows < FEWEST and any(map(self._names, gap)):
            return False  # settings and their values, above the names
        again = [one for one in gap if any(map(tells, one))]
        if again and again[-1] not in [self.how.cells(text) for text in block.above]:
            return False
        return self.how.size == 1 or not self._clock(line, block) < self._clock(block.tail, block)

    def _names(self, cells: Sequence[str]) -> bool:
        """True for words in all cells, each another one; words between spaces, or in one cell, are a sentence."""
        if self.how.separator == SPACES or len(cells) < 2:
            return False
        words = [one for one in cells if one and one.lower() not in MISSING and not self.how.is_number(one)]
        return len(set(words)) == len(cells)

    def _clock(self, line: str, block: Block) -> float:
        cells = self.how.cells(line)
        cell = pd.Series(cells[block.clock : block.clock + 1])
        if ":" in "".join(cell):
            return float(stamps(cell).astype("int64")[0])
        return float(numbers(cell, self.how.decimal)[0]) if len(cell) else np.nan

    def _begin(self, size: int) -> Block:
        above = [line for _, line in self.gap]
        passed: list[int] = []
        if self.blocks and self.blocks[-1].rows < FEWEST:
            small = self.blocks.pop()
            above = [*small.above, *small.sample, *above]
            whole = [all(map(self.how.is_number, self.how.cells(line))) for line in small.sample]
            passed = [*small.small, *(line for line, row in zip(small.lines, whole, strict=True) if row)]
        header = self._header(above, size)
        if not header and self.blocks and self.blocks[-1].size == size:
            above = [*self.blocks[-1].above, *above]
            header = self._header(above, size)
        clock = next((k for k, cell in enumerate(header) if meaning(cell).kind == TIME), 0)
        self.blocks.append(Block(above[-KEPT:], size, clock, small=passed))
        self.gap, self.empty = [], False
        return self.blocks[-1]

    def _header(self, above: Sequence[str], size: int) -> list[str]:
        """The cells of the lowest line that says what so many columns hold."""
        cells = (self.how.cells(line) for line in reversed(above))
        return next((one for one in cells if len(one) == size and any(map(tells, one))), [])

    def _surplus(self, number: int, line: str, block: Block) -> None:
        if block.surplus and block.surplus[-1] == number - 1:
            raise too_long(self.name, number, block.size)
        block.surplus.append(number)
        self.gap.append((number, line))

    def _add(self, number: int, line: str, block: Block) -> None:
        block.between += [number for number, _ in self.gap]
        self.gap, self.empty = [], False
        if block.parts and block.parts[-1][1] == number - 1:
            block.parts[-1][1] = number
        else:
            block.parts.append([number, number])
        if len(block.sample) < KEPT:
            block.sample.append(line)
        block.tail = line

    def found(self) -> list[Block]:
        """The tables, when all lines are taken."""
        if self.blocks:
            self.blocks[-1].below = [number for number, _ in self.gap]
        if len(self.blocks) > 1 and self.blocks[-1].rows < FEWEST:
            last = self.blocks.pop()
            self.blocks[-1].below += [*last.lines, *last.below]
        return self.blocks


def _after(piece: bytes, count: int) -> int:
    """Where so many lines of a piece end; 0 where it has no more."""
    end = 0
    for _ in range(count):
        if not (end := piece.find(b"\n", end) + 1):
            return 0
    return end if end < len(piece) else 0


def _filled_lines(first: int, piece: bytes) -> Iterator[tuple[int, bytes]]:
    """The lines that are not empty, with their numbers."""
    number, at = first, 0
    for found in re.finditer(rb"[^\n]+", piece):
        number += piece.count(b"\n", at, found.start())
        at = found.start()
        yield number, found[0]


def _counts(piece: bytes, separator: str) -> NDArray[np.integer]:
    """How many cells each line has, without regard to quotes."""
    letters = np.frombuffer(piece, dtype=np.uint8)
    starts = np.concatenate([[0], np.flatnonzero(letters[:-1] == ord("\n")) + 1])
    if separator != SPACES:
        return np.add.reduceat((letters == ord(separator)).astype(np.int64), starts) + (
            letters[starts] != ord("\n")
        )
    spaces = (letters == ord(" ")) | (letters == ord("\t")) | (letters == ord("\n"))
    begins = ~spaces & np.concatenate([[True], spaces[:-1]])
    return np.add.reduceat(begins.astype(np.int64), starts)


def layout_of(block: Block, how: Dialect, encoding: str, name: str) -> Layout:
    """The Layout of a table."""
    place = f"{name}, line {max(block.parts[0][0] - 1, 1)}"
    return layout(block.above, block.sample, replace(how, size=block.size), encoding, place)


def left_out(block: Block) -> tuple[str, ...]:
    """Remarks on the lines that are no rows of the table."""
    surplus = set(block.surplus)
    notes = [line for line in block.between if line not in surplus]
    remarks = []
    if block.small:
        remarks.append(f"{_lines(block.small)} of numbers above the table, too few for one, left out")
    if notes:
        remarks.append(
            f"{_lines(notes)} between the rows hold{'s' if len(notes) == 1 else ''} no numbers, left out"
        )
    if surplus:
        remarks.append(
            f"{_lines(block.surplus)} ha{'s' if len(surplus) == 1 else 've'} more cells than there are columns, left out as missing"
        )
    if block.below:
        remarks.append(f"{_lines(block.below)} below the table, left out")
    return tuple(remarks)


def _lines(numbers: Sequence[int]) -> str:
    if len(numbers) == 1:
        return f"line {numbers[0]}"
    return f"{len(numbers)} lines (the first {numbers[0]})"


def read(
    source: BinaryIO, block: Block, how: Layout, name: str, rate: float = np.nan
) -> Iterator[pd.DataFrame]:
    """The rows of a table, some at a time, each indexed by its line in the file; times are made of the ``rate`` (Hz) where it is given.

    InputError for a row that has more cells than there are columns.
    """
    firsts = np.array([first for first, _ in block.parts])
    lasts = np.array([last for _, last in block.parts])
    clocks = {k: Clock() for k in how.stamps}
    taken = 0
    for first, piece in pieces_of(source, how.encoding, name):
        size = piece.count(b"\n")
        if first > lasts[-1]:
            return
        own = np.flatnonzero((firsts < first + size) & (lasts >= first))
        if not len(own):
            continue
        lines = np.concatenate(
            [np.arange(max(firsts[k], first), min(lasts[k], first + size - 1) + 1) for k in own]
        )
        if len(lines) < size:
            every = piece.split(b"\n")
            piece = b"\n".join([every[line - first] for line in lines]) + b"\n"
        part = _parsed(piece, how, name, lines)
        for k, clock in clocks.items():
            part.isetitem(k, clock.seconds(part.iloc[:, k]))
        if rate > 0:
            slots = taken + np.arange(len(lines)) + np.searchsorted(block.between, lines)
            part.insert(0, CLOCKED, slots / rate)
            taken += len(lines)
        yield part


def _parsed(piece: bytes, how: Layout, name: str, lines: NDArray[np.integer]) -> pd.DataFrame:
    if how.dialect.arrivals:
        text = piece.decode(charset(how.encoding), errors="replace").splitlines()
        piece = "\n".join(map(how.dialect.plain, text)).encode(charset(how.encoding)) + b"\n"
    if (mark := how.dialect.thousands) and not mark.isascii():
        piece, mark = piece.replace(mark.encode(charset(how.encoding), "ignore"), b""), ""
    try:
        part = pd.read_csv(
            io.BytesIO(piece),
            sep=how.dialect.separator,
            decimal="," if how.dialect.decimal == "," else ".",
            thousands=mark or None,
            header=None,
            names=[*how.names, BEYOND],
            index_col=False,
            skip_blank_lines=False,
            skipinitialspace=True,
            encoding=charset(how.encoding),
            encoding_errors="replace",
        )
    except pd.errors.ParserError as error:
        problem = f"it is not a table ({error})"
        raise InputError(name, problem, "CSV with a header", "correct the file") from error
    if len(part) != len(lines):
        problem = "a quote is opened there or below and never closed"
        raise InputError(f"{name}, line {lines[0]}", problem, "cells with both their quotes", "mend the row")
    part.index = pd.Index(lines)
    if (extra := part[BEYOND].notna()).any():
        raise too_long(name, int(lines[int(np.argmax(extra))]), len(how.names))
    return part.drop(columns=BEYOND)


def cut_short(source: BinaryIO, block: Block, how: Layout) -> bool:
    """True if the last line is a row without an end and a cell is shorter than in the rows above it: it was cut while it was written."""
    source.seek(0, io.SEEK_END)
    source.seek(max(0, source.tell() - 4096) // 2 * 2)
    lines = re.split(r"\r\n|\n|\r", source.read().decode(how.encoding.removesuffix("-sig"), errors="ignore"))
    rows = [how.dialect.cells(line) for line in lines[-22:]]
    if not lines[-1].strip() or lines[-1].strip() != block.tail.strip() or len(rows) < 12:
        return False
    last, usual = rows[-1], rows[1:-1]
    if len(last) < len(usual[-1]):
        return True
    places = [[_places(cells[k]) for cells in usual if k < len(cells)] for k in range(len(last))]
    return any(_places(cell) < min(own, default=0) for cell, own in zip(last, places, strict=True))


def _places(cell: str) -> int:
    return len(re.split("[.,]", f"{cell}.")[1])


def too_long(name: str, line: int, columns: int) -> InputError:
    """The refusal of rows with more cells than the table has columns."""
    problem = f"it is not a table: the row has more cells than the {columns} columns of the table"
    mend = "mend the row; numbers with a decimal comma or thousands between commas need quotes or another separator"
    return InputError(f"{name}, line {line}", problem, "as many cells in each row", mend)
