"""Somebody's table of numbers: its encoding, separator, decimal sign and header recognised, its rows read in pieces."""

import codecs
import csv
import io
import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from typing import BinaryIO

import numpy as np
import pandas as pd

from ..arrays import Floats
from ..errors import InputError
from .columns import UNTOLD, meaning

HEAD = 1 << 16  # bytes from which the layout is told
PIECE = 100_000  # rows held at a time
SPACES = r"\s+"
# In this order: where two fit equally well, the first is taken.
DIALECTS = (
    (",", "."), ("\t", "."), (";", "."), ("\t", ","), (";", ","), (SPACES, "."), (SPACES, ","), (",", ","),
)  # fmt: skip
MISSING = ("", "nan", "na", "n/a", "null", "none", "inf", "-inf", "-", "--", "---")
NUMBER = {
    sign: re.compile(rf"[+-]?(\d+{sign}?\d*|{sign}\d+)([eE][+-]?\d+)?") for sign in (r"\.", ",", "[.,]")
}
FOREIGN = {
    b"\x89PNG": ("a PNG picture", "export the table of numbers, not its picture"),
    b"\xff\xd8\xff": ("a JPEG picture", "export the table of numbers, not its picture"),
    b"GIF8": ("a GIF picture", "export the table of numbers, not its picture"),
    b"%PDF": ("a PDF document", "export the table of numbers itself"),
    b"PK\x03\x04": ("a zip archive inside another", "unpack it"),
    b"\x1f\x8b": ("compressed with gzip", "unpack it"),
    b"\x89HDF": ("netCDF or HDF5", "name it .nc"),
    b"CDF": ("netCDF", "name it .nc"),
    b"<": (
        "XML or a web page, as programs save their own documents",
        "export the data as CSV from the program",
    ),
}


@dataclass(frozen=True)
class Layout:
    """How a file's numbers are laid out."""

    encoding: str
    separator: str
    decimal: str
    names: tuple[str, ...]  # of the columns, one for each
    named: bool  # False where the file has no header
    skip: int  # lines before the first row of numbers
    about: dict[str, str]  # the file's own account of itself: its leading lines `# key: value`

    def __str__(self) -> str:
        sign = {"\t": "tabs", SPACES: "spaces"}.get(self.separator, f"`{self.separator}`")
        parts = [sign, *(["decimal comma"] if self.decimal == "," else [])]
        parts += [self.encoding.upper().replace("CP1252", "Latin-1")] if self.encoding != "utf-8-sig" else []
        return ", ".join(parts + ([] if self.named else ["no header"]))


def encoding(source: BinaryIO, name: str) -> str:
    """The encoding of a text file, read through by the megabyte; InputError if it is no text."""
    head = source.read(HEAD)
    source.seek(0)
    found, fault = _marked(head), None
    decoder = codecs.getincrementaldecoder(found)()
    try:
        while piece := source.read(1 << 20):
            decoder.decode(piece)
        decoder.decode(b"", final=True)
    except UnicodeDecodeError as error:
        fault = error
    source.seek(0)
    _check_text(head, name, fault if found != "utf-8-sig" else None, found)
    return "cp1252" if fault else found


def _marked(head: bytes) -> str:
    """UTF-16 where its mark or its zeros are seen, else UTF-8 until a byte says otherwise."""
    if head.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        return "utf-16"
    if len(head) > 3 and head.count(0) > 0.3 * len(head):
        return "utf-16-le" if head[1] == 0 else "utf-16-be"
    return "utf-8-sig"


def _check_text(head: bytes, name: str, fault: Exception | None, found: str) -> None:
    for mark, (what, mend) in FOREIGN.items():
        if head.removeprefix(codecs.BOM_UTF8).lstrip().startswith(mark):
            raise InputError(name, f"it is {what}, not text", "a table of numbers as text, or netCDF", mend)
    text = head.decode(found, errors="replace")
    if fault or re.search(r"[\x00-\x08\x0e-\x1f]", text):
        raise InputError(
            name, f"it is not text ({fault or 'it holds control characters'})", "CSV, or netCDF", "convert it"
        )
    if not text.strip("\ufeff \t\r\n"):
        raise InputError(name, "it is empty: not a table", "a table of numbers", "export it again")


def layout(source: BinaryIO, encoding: str, name: str) -> Layout:
    """The Layout of a text file, told from its first 64 kB; InputError for one that more than one reading fits.

    The separator and decimal sign are those with which most lines are rows of numbers, all of one length. The
    line above the first of them names the columns; lines above that are titles. A file whose numbers cannot be
    recognised is taken for CSV with its first line as the header.
    """
    raw = source.read(HEAD)
    source.seek(0)
    text = raw.decode(encoding, errors="replace" if encoding == "cp1252" else "ignore")
    lines = re.split(r"\r\n|\n|\r", text)
    if len(raw) == HEAD:
        lines.pop()  # cut short
    if not lines:
        raise InputError(
            name,
            f"its first line is longer than {HEAD} bytes: it is not a table",
            "a table",
            "export it again",
        )
    own = next((k for k, line in enumerate(lines) if not line.startswith("#")), len(lines))
    about = {}
    for line in lines[:own]:
        key, colon, value = line.lstrip("# ").partition(":")
        if colon:
            about[key.strip().lower()] = value.strip()
    separator, decimal, rows = _dialect(lines[own:], name)
    first, size = own + rows[0], len(split(lines[own + rows[0]], separator))
    above = [k for k in range(own, first) if lines[k].strip()]
    while above and _broken(split(lines[above[-1]], separator), size, decimal):
        first = above.pop()
    names = _names(lines, above, separator)
    if above and len(names) != size and len(words := lines[above[-1]].split()) == size:
        names = words  # a header with spaces above rows with tabs
    named = bool(names)
    if not names and own and len(split(lines[own - 1].lstrip("# "), separator)) == size:
        names, named = split(lines[own - 1].lstrip("# "), separator), True  # as numpy.savetxt writes a header
    if not names:
        names = [f"column {k}" for k in range(1, size + 1)]
    if any(names[size:]):
        if any(_tells(one) for one in names):
            raise _other_count(len(names), size, f"{name}, line {above[-1] + 1}")
        names, named = [f"column {k}" for k in range(1, size + 1)], False  # a title
    names = names[:size]
    if len(names) < size:
        surplus = [split(lines[own + k], separator)[len(names) :] for k in rows]
        if any(cell for cells in surplus for cell in cells):
            raise _other_count(len(names), size, f"{name}, line {above[-1] + 1 if above else first}")
        names = [*names, *[""] * (size - len(names))]
    return Layout(encoding, separator, decimal, _unique(names), named, first, about)


def _other_count(names: int, cells: int, place: str) -> InputError:
    return InputError(
        place,
        f"the header names {names} column(s) and the rows have {cells} cells",
        "a name for each column, and a decimal sign that is not the separator",
        "export it with another separator (`;` or tabs), or mend the header",
    )


def _tells(name: str) -> bool:
    """True for a cell that says what a column holds, as none in a title does."""
    found = meaning(name)
    return found.kind != UNTOLD or bool(found.axis)


def split(line: str, separator: str) -> list[str]:
    """The cells of a line. Between spaces, a unit in brackets belongs to the name before it."""
    if separator == SPACES:
        return re.split(r"\s+(?![(\[])", line.strip())
    if '"' not in line:
        return [cell.strip() for cell in line.split(separator)]
    return [
        cell.strip() for cell in next(csv.reader([line], delimiter=separator, skipinitialspace=True), [""])
    ]


def _dialect(lines: list[str], name: str) -> tuple[str, str, list[int]]:
    """Separator, decimal sign, and which of the lines are rows of numbers."""
    lines = lines[:400]
    found = [(_rows(lines, *dialect), *dialect) for dialect in DIALECTS]
    rows, separator, decimal = max(found, key=lambda one: len(one[0]))
    mixed = max((_rows(lines, one, "[.,]") for one in ("\t", ";", SPACES)), key=len)
    if 4 * len(mixed) > 5 * len(rows) and len(mixed) > 2:
        raise InputError(
            f"{name}, line {mixed[0] + 1} and others",
            "some numbers have a decimal point and others a decimal comma",
            "one decimal sign in the whole file",
            "export it again, or replace one of them",
        )
    if not rows:
        found = [(_rows(lines, *dialect, every=False), *dialect) for dialect in DIALECTS]
        rows, separator, decimal = max(found, key=lambda one: len(one[0]))
    if not rows:
        header = next((k for k, line in enumerate(lines) if line.strip()), 0)
        return ",", ".", [min(header + 1, len(lines) - 1)]
    return separator, decimal, rows


def _rows(lines: list[str], separator: str, decimal: str, every: bool = True) -> list[int]:
    """The lines that hold two numbers or more, all of the commonest length; ``every`` cell must be one, or missing."""
    number = NUMBER[r"\." if decimal == "." else decimal]
    sizes = {}
    for k, line in enumerate(lines):
        if separator != SPACES and separator not in line:
            continue
        cells = split(line, separator)
        numbers = sum(bool(number.fullmatch(cell)) for cell in cells)
        gaps = sum(cell.lower() in MISSING for cell in cells)
        if len(cells) > 1 and (numbers and numbers + gaps == len(cells) if every else numbers > 1):
            sizes[k] = len(cells)
    if not sizes:
        return []
    usual = Counter(sizes.values()).most_common(1)[0][0]
    return [k for k, size in sizes.items() if size == usual]


def _broken(cells: list[str], size: int, decimal: str) -> bool:
    """True for a row of numbers one of which is spoilt: no header, and not to be passed over in silence."""
    number = NUMBER[r"\." if decimal == "." else decimal]
    return len(cells) == size and any(number.fullmatch(cell) for cell in cells)


def _names(lines: list[str], above: list[int], separator: str) -> list[str]:
    """The columns' names: the last line above the numbers, joined with the one before where it holds units alone."""
    if not above:
        return []
    names = split(lines[above[-1]], separator)
    before = split(lines[above[-2]], separator) if len(above) > 1 else []
    units = [cell.strip("()[] ") for cell in names]
    if len(before) == len(names) and all(before) and all(unit in UNIT_CELLS for unit in units):
        return [f"{title} ({unit})" if unit else title for title, unit in zip(before, units, strict=True)]
    return names


# What a second line of a header may hold
UNIT_CELLS = (
    "",
    "s",
    "ms",
    "us",
    "µs",
    "rad",
    "deg",
    "°",
    "V",
    "m",
    "cm",
    "mm",
    "px",
    "rad/s",
    "deg/s",
    "°/s",
)


def _unique(names: list[str]) -> tuple[str, ...]:
    told: list[str] = []
    for k, name in enumerate(names):
        name, count = name or f"Unnamed: {k}", 0
        while (own := f"{name}.{count}" if count else name) in told:
            count += 1
        told.append(own)
    return tuple(told)


def pieces(source: BinaryIO, layout: Layout, name: str) -> Iterator[pd.DataFrame]:
    """The rows, some at a time, each indexed by its line in the file. Empty lines at the end are left out.

    InputError for a row that has more cells than the header has names, and for an empty line between rows.
    """
    text = io.TextIOWrapper(source, encoding=layout.encoding, errors="replace", newline="")
    try:
        for _ in range(layout.skip):
            text.readline()
        reader = pd.read_csv(
            text,
            sep=layout.separator,
            decimal=layout.decimal,
            header=None,
            names=[*layout.names, BEYOND],
            index_col=False,
            skip_blank_lines=False,
            skipinitialspace=True,
            chunksize=PIECE,
        )
        empty = 0  # line of the first empty one, where rows may follow it
        for piece in reader:
            piece.index = piece.index + layout.skip + 1
            blank = piece.isna().all(axis=1).to_numpy()
            filled = np.flatnonzero(~blank)
            if len(filled) and (empty or blank[: filled[-1]].any()):
                raise InputError(
                    f"{name}, line {empty or piece.index[np.flatnonzero(blank)[0]]}",
                    "the line is empty and rows follow it",
                    "a number in every row",
                    "mend the file: are these two tables, or is a part missing?",
                )
            if blank.any() and not empty:
                empty = int(piece.index[np.flatnonzero(blank)[0]])
            if (extra := piece[BEYOND].notna()).any():
                raise _too_long(name, int(piece.index[int(np.argmax(extra))]), len(layout.names))
            if len(filled):
                yield piece.iloc[: filled[-1] + 1].drop(columns=BEYOND)
    except pd.errors.ParserError as error:
        if told := re.search(r"Expected \d+ fields in line (\d+)", str(error)):
            raise _too_long(name, int(told[1]) + layout.skip, len(layout.names)) from error
        raise InputError(
            name, f"it is not a table ({error})", "CSV with a header", "correct the file"
        ) from error
    except pd.errors.EmptyDataError:
        return
    finally:
        if not source.closed:
            text.detach()


BEYOND = "\0beyond the last column"


def _too_long(name: str, line: int, columns: int) -> InputError:
    return InputError(
        f"{name}, line {line}",
        f"it is not a table: the row has more cells than the {columns} columns that the header names",
        "as many cells in each row",
        "mend the row; numbers with a decimal comma or thousands between commas need quotes or another separator",
    )


def numbers(column: pd.Series, decimal: str) -> Floats:
    """The column as floats, NaN wherever a cell is no number in the file's own decimal sign."""
    if column.dtype.kind in "fiu":
        return column.to_numpy(dtype=float)
    if column.dtype.kind == "b":
        return np.full(len(column), np.nan)
    if decimal == ",":
        text = column.astype(str)
        column = text.where(~text.str.contains(".", regex=False)).str.replace(",", ".", regex=False)
    return pd.to_numeric(column, errors="coerce").to_numpy(dtype=float)


def cut_short(source: BinaryIO, layout: Layout) -> bool:
    """True if the last line has no end and a cell shorter than in the lines above it: it was cut while it was written."""
    source.seek(0, io.SEEK_END)
    size = source.tell()
    source.seek(max(0, size - 4096) // 2 * 2)
    tail = source.read()
    source.seek(0)
    lines = re.split(r"\r\n|\n|\r", tail.decode(layout.encoding.removesuffix("-sig"), errors="ignore"))
    rows = [split(line, layout.separator) for line in lines[-22:]]
    if not lines[-1].strip() or len(rows) < 12:
        return False
    last, usual = rows[-1], rows[1:-1]
    if len(last) != len(usual[-1]):
        return False  # a missing cell is refused where it is read
    places = [
        [_places(cells[k], layout.decimal) for cells in usual if k < len(cells)] for k in range(len(last))
    ]
    return any(_places(cell, layout.decimal) < min(own) for cell, own in zip(last, places, strict=True))


def _places(cell: str, decimal: str) -> int:
    return len(cell.partition(decimal)[2])
