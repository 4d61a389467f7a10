"""How a text file's table is laid out: separator and decimal sign, told from its rows, and the names of its columns, told from the lines above."""

import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd

from ...errors import InputError
from .cells import ARRIVAL, EITHER, NUMBER, SPACES, THOUSANDS, Dialect, split, stripped
from .columns import ANGLE, LENGTH, RATE, TIME, UNITS, UNNAMED, UNTOLD, VOLTAGE, meaning
from .table import MISSING, numbers

# In this order: where two fit equally well, the first is taken.
DIALECTS = (
    (",", "."), ("\t", "."), (";", "."), ("\t", ","), (";", ","), (SPACES, "."), (SPACES, ","), (",", ","), ("|", "."), ("|", ","),
)  # fmt: skip
LOOKED_AT = 400  # lines from which the dialect is told
MOST_COLUMNS = 16384  # as many as an office program has
COMMENT = re.compile(r"^\s*(#+|%+|//+|!)\s*")
# a frequency by itself may be the pendulum's, but as a setting of motion capture (QTM)
STATES_RATE = re.compile(
    r"(?i)\b(sample|sampling)[ _]?(rate|frequency)\b|^((?-i:FREQUENCY)|fps|frame[ _]?rate)\t"
)
GROUPED = re.compile(r"[+-]?[1-9]\d{0,2}[.,]\d{3}")  # 1,234 may be a thousand and more
NEAR = 3  # lines above the rows in which names, symbols and units stand
CLOCKED, ARRIVED, READING, SIGNAL = "time (s)", "arrival", "raw", "signal"


@dataclass(frozen=True)
class Layout:
    """How a table's numbers are laid out."""

    encoding: str
    dialect: Dialect
    names: tuple[str, ...]  # of the columns, one for each
    headers: tuple[str, ...]  # the same as they stand in the file, where one may be there twice
    titles: tuple[str, ...]  # the cells of the line above them
    named: bool  # False where the table has no header
    stamps: tuple[int, ...]  # columns that hold a clock's stamps
    joined: bool = False  # True where the first row stands in the header's line

    def __str__(self) -> str:
        separator, decimal = self.dialect.separator, self.dialect.decimal
        sign = {"\t": "tabs", SPACES: "spaces"}.get(separator, f"`{separator}`")
        parts = ["one column"] if len(self.names) == 1 else [sign]
        parts += {",": ["decimal comma"], EITHER: ["decimal comma in some columns"]}.get(decimal, [])
        parts += [f"groups of digits by `{self.dialect.thousands}`"] if self.dialect.thousands else []
        parts += [self.encoding.upper().replace("CP1252", "Latin-1")] if self.encoding != "utf-8-sig" else []
        parts += ["times of day"] if self.stamps else []
        parts += ["the first row stands in the header's line and is left out"] if self.joined else []
        return ", ".join(parts + ([] if self.named else ["no header"]))


def dialect(lines: Sequence[str], name: str, single: bool = False) -> Dialect | None:
    """The Dialect in which most of the lines are rows of numbers, all of one length; None where none are.

    ``single``: a number a line is asked for, and a comma is its decimal sign. InputError where some numbers have a
    decimal point and others a decimal comma, and not each column one of them.
    """
    filled = [line for line in lines if line.strip() and not COMMENT.match(line)]
    for start in range(0, len(filled), LOOKED_AT):  # further on where a file opens with long notes
        if found := _dialect(filled[start : start + LOOKED_AT], name, single):
            return found
    return None


def _dialect(lines: Sequence[str], name: str, single: bool) -> Dialect | None:
    arrivals = sum(bool(ARRIVAL.match(line)) for line in lines) > len(lines) / 2
    bare = [ARRIVAL.sub("", line) for line in lines] if arrivals else lines
    alone = [k for k, line in enumerate(bare) if NUMBER[EITHER].fullmatch(line.strip())]
    found = [_rows(bare, *one) for one in DIALECTS]
    rows, separator, decimal = max(found, key=lambda one: len(one[0]))
    text = "\n".join(bare)  # one search for each mark: most files are without groups
    marks = [mark for mark in THOUSANDS if re.search(rf"\d{re.escape(mark)}\d{{3}}(?!\d)", text)]
    grouped = max(
        (_grouped(bare, *one, marks) for one in DIALECTS), key=lambda one: one[0], default=(0, None)
    )
    if grouped[1] and grouped[0] > max(len(rows), len(alone)) and not arrivals:
        return grouped[1]
    mixed, between, _ = max(
        (_rows(bare, one, EITHER) for one in ("\t", ";", SPACES)), key=lambda one: len(one[0])
    )
    if 4 * len(mixed) > 5 * max(len(rows), len(alone)) and len(mixed) > 2:
        columns = list(zip(*(split(bare[k], between) for k in mixed), strict=True))
        if all(map(_one_sign, columns)):
            return Dialect(between, EITHER, arrivals, size=len(columns) + arrivals)
        raise InputError(
            f"{name}, `{lines[mixed[0]].strip()[:40]}` and other lines",
            "some numbers have a decimal point and others a decimal comma",
            "one decimal sign in each column",
            "export it again, or replace one of them",
        )
    if len(alone) > len(rows) or (single and alone and len(alone) >= len(rows)):
        comma = sum("," in bare[k] for k in alone) > sum("." in bare[k] for k in alone)
        return Dialect("\t", "," if comma else ".", arrivals, size=1 + arrivals)
    words = not rows
    if words:
        found = [_rows(bare, *one, every=False) for one in DIALECTS]
        rows, separator, decimal = max(found, key=lambda one: len(one[0]))
    if not rows:
        return None
    usual, one = len(split(bare[rows[0]], separator)) + arrivals, Dialect(separator, decimal)
    led = 2 * sum(one.is_number(split(bare[k], separator)[0]) for k in rows) > len(rows)
    return Dialect(separator, decimal, arrivals, words, usual, led=led)


def _one_sign(column: Sequence[str]) -> bool:
    """True for cells of which none has another decimal sign than the others, nor is each one that may have a group of three digits."""
    signed = [cell for cell in column if re.search("[.,]", cell)]
    return not signed or (
        len({"," in cell for cell in signed}) == 1 and not all(map(GROUPED.fullmatch, signed))
    )


def _grouped(
    lines: Sequence[str], separator: str, decimal: str, marks: Sequence[str]
) -> tuple[int, Dialect | None]:
    """How many lines are rows of numbers with groups of three digits by one of the ``marks``, and in which Dialect; 0 for none.

    In a column with groups some number has none, or a decimal sign too: ``1,234`` alone may be a little more than 1. One such cell
    is a spoilt one.
    """
    best: tuple[int, Dialect | None] = (0, None)
    for mark in marks:
        if mark in (decimal, separator if separator != "," else "") or (mark == " " and separator == SPACES):
            continue
        rows, *_ = _rows(lines, separator, decimal, thousands=mark)
        cells = [split(lines[k], separator) for k in rows]
        columns = list(zip(*cells, strict=True))
        marked = [column for column in columns if sum(mark in cell for cell in column) > 1]
        sure = all(any(mark not in cell or decimal in cell for cell in column) for column in marked)
        if len(rows) > best[0] and marked and sure:
            best = len(rows), Dialect(separator, decimal, size=len(columns), thousands=mark)
    return best


def _rows(
    lines: Sequence[str], separator: str, decimal: str, every: bool = True, thousands: str = ""
) -> tuple[list[int], str, str]:
    """The lines that hold two numbers or more, all of the commonest length; ``every`` cell must be one, or missing."""
    one = Dialect(separator, decimal, thousands=thousands)
    sizes = {}
    for k, line in enumerate(lines):
        if separator != SPACES and separator not in line:
            continue
        cells = split(line, separator)
        if len(cells) < 2:
            continue
        numbers = sum(map(one.is_number, cells))
        gaps = sum(cell.lower() in MISSING for cell in cells)
        if numbers and numbers + gaps == len(cells) if every else numbers > 1:
            sizes[k] = len(cells)
    if not sizes:
        return [], separator, decimal
    usual = Counter(sizes.values()).most_common(1)[0][0]
    return [k for k, size in sizes.items() if size == usual], separator, decimal


def layout(above: Sequence[str], sample: Sequence[str], how: Dialect, encoding: str, place: str) -> Layout:
    """The Layout of a table from the lines ``above`` it and some of its rows; InputError for a header of another size than they have.

    The names are those of the lowest line that has one for each column; a line of units alone below it belongs to them.
    """
    rows = [how.cells(line) for line in sample]
    size = how.size
    if size > MOST_COLUMNS:
        problem = f"it has {size} columns"
        raise InputError(place, problem, f"at most {MOST_COLUMNS}", "export those of time and swing alone")
    stamps = tuple(
        k for k in range(size) if 2 * sum(":" in row[k] for row in rows if k < len(row)) > len(rows)
    )
    plain, comments = list[list[str]](), list[list[str]]()
    for line in above:
        cells = [] if STATES_RATE.search(line) else _header_cells(line, how)
        if cells and "=" not in cells:  # a setting and its value
            (comments if COMMENT.match(line) else plain).append(cells)
    names, titles = _named(plain, how, rows, place)
    if not names:
        fitting = [cells for cells in comments if len(cells) <= size]  # what else a comment says is no header
        names, titles = _named(fitting, how, rows, place)
    named = bool(names)
    if how.arrivals:
        names = (names if any(map(tells, names[1:])) else _of_readings(rows, size))[1:]
        names = [ARRIVED if any(meaning(one).kind == TIME for one in names) else CLOCKED, *names]
    headers = tuple(names or [f"column {k}" for k in range(1, size + 1)])
    joined = named and any(_before_a_row(how.cells(COMMENT.sub("", line)), how) == names for line in above)
    return Layout(encoding, how, _unique(headers), headers, titles, named or how.arrivals, stamps, joined)


def _of_readings(rows: Sequence[Sequence[str]], size: int) -> list[str]:
    """Names for what a board prints without one: whole numbers are a converter's readings."""
    if size > 2:
        return [f"column {k}" for k in range(size)]
    whole = all(row[-1].lstrip("+-").isdigit() for row in rows if len(row) == 2 and row[-1])
    return ["", READING if whole else SIGNAL]


def _header_cells(line: str, how: Dialect) -> list[str]:
    """The cells of a line above the rows: without a comment sign, and of one quoted cell for all columns those inside it."""
    bare = COMMENT.sub("", line)
    if bare != line:
        bare = bare.partition(" | ")[0]  # a remark beside the names
    if how.separator != ";" and bare.startswith(";"):
        bare = bare.lstrip("; ")
    if how.size == 1:
        return [bare.strip()] if not re.search(r"[,;\t]", bare) else split(bare, ",")
    whole = how.cells(bare)
    cells = stripped(whole, 1)
    cells = _before_a_row(cells, how) or cells
    while len(cells) > how.size and how.is_number(cells[-1].rpartition("=")[2].strip()):
        cells = cells[:-1]  # what is said once beside the names, as the start and the step of a clock
    ended = len(whole) == how.size and sum(map(tells, cells)) > 1  # by a separator
    if len(cells) == how.size or ended:
        return cells
    for separator in dict.fromkeys((how.separator, ",", ";", "\t", SPACES, ".")):
        # one quoted cell over all columns; spaces above rows with tabs; a decimal comma set by machine: `t.a.b` above `0,1`
        if separator == SPACES and how.separator != SPACES and len(stripped(whole, 1)) > 1:
            continue  # what stands in its cells are words
        inside = stripped(split(bare.strip().strip('"'), separator), 1)
        if separator == "." and not re.fullmatch(r"\S+", bare.strip()):
            continue  # sentences
        if len(inside) == how.size and any(map(tells, inside)):
            return inside
    return cells


def _before_a_row(cells: list[str], how: Dialect) -> list[str]:
    """The names in a line that lacks its end, so that the first row follows the last of them: ``t x0 0.58``; none of another line."""
    last = how.size - 1
    joined = (
        re.fullmatch(r"(.*[^\d.,+-])([\d.,+-]+)", cells[last]) if len(cells) == 2 * how.size - 1 else None
    )
    row = [joined[2], *cells[last + 1 :]] if joined else []
    if not joined or not all(map(how.is_number, row)) or any(map(how.is_number, cells[:last])):
        return []
    return [*cells[:last], joined[1].strip()]


def tells(name: str) -> bool:
    """True for a cell that says what a column holds, as none in a title does."""
    found = meaning(name)
    return found.kind != UNTOLD or bool(found.axis)


def _named(
    lines: Sequence[list[str]], how: Dialect, rows: Sequence[Sequence[str]], place: str
) -> tuple[list[str], tuple[str, ...]]:
    """The columns' names and the cells above them; none where no line above names them."""
    size, units = how.size, list[str]()
    if len(lines) > 1 and _are_units(lines[-1], lines[-2], size):
        *lines, units = lines
    lowest, whole = len(lines) - 1, bool(lines) and len(lines[-1]) == size
    for k in range(lowest, -1, -1):
        cells, near = lines[k], k > lowest - NEAR
        if not near and whole:
            break
        if k < lowest and any(map(how.is_number, cells)):
            continue  # a setting and its value
        fits = cells if len(cells) == size else _padded(cells, how, rows, place, lowest=k == lowest)
        if fits and sum(map(tells, fits)) > (0 if near else 1):
            if k and _symbols(fits, lines[k - 1], how):
                k, fits = k - 1, lines[k - 1]
            fits = _with_those_above(fits, lines[k - 1] if k else [])
            return _with_units(fits, units, place), tuple(lines[k - 1] if k else [])
    if whole:
        above = lines[-2] if len(lines) > 1 else []
        return _with_units(_with_those_above(lines[-1], above), units, place), tuple(above)
    return [], ()


def _with_those_above(names: list[str], above: Sequence[str]) -> list[str]:
    """The names, a column without one by what stands above it, where that says what such columns hold."""
    bare = [k for k, name in enumerate(names) if not name and k < len(above) and above[k]]
    told = any(tells(above[k]) for k in bare)
    if sum(map(bool, above)) < 2 or not told:  # one cell alone is a title or a setting
        return names
    return [above[k] if k in bare else name for k, name in enumerate(names)]


def _symbols(cells: Sequence[str], above: Sequence[str], how: Dialect) -> bool:
    """True for a line of symbols, ``t θ``, below one of the same quantities' names."""
    return (
        len(above) == len(cells) == len(set(above))
        and all(above)
        and not any(map(how.is_number, above))
        and all(len(cell) < 3 for cell in cells)
        and any(map(tells, above))
    )


def _padded(
    cells: list[str], how: Dialect, rows: Sequence[Sequence[str]], place: str, lowest: bool
) -> list[str]:
    """A header of another size than the rows for these: names without a column are left out, a column without a name has none.

    InputError for one that tells what columns hold, where it is not seen which.
    """
    size = how.size
    if not any(map(tells, cells)) or len(cells) == 1:
        return []
    if all(re.fullmatch(r"(?i)(d|u|s|err(or)?|delta|sigma)[ _]?(.+)|.+'", one) for one in cells[size:]):
        cells = cells[:size]  # those of uncertainties, which are not there
        if len(cells) == size:
            return cells
    surplus = any(cell for row in rows for cell in row[len(cells) :])
    if len(cells) < size and not surplus:
        return _filled(cells, size)
    if lowest and sum(map(tells, cells)) > 1:
        # where no cell has a decimal point a comma may be one; of names that tell what is not there any may be the one too many
        pointed = how.separator != "," or any("." in cell for row in rows for cell in row)
        if pointed and not any(map(tells, cells[size:])):
            counted = len(cells) + 1 == size and _steps(rows, 0, how.decimal) == {1.0}
            found = ["", *cells] if counted else _filled(cells[:size], size)
            if _clock_rises(found, rows, how.decimal):
                return found
        raise InputError(
            place,
            f"the header names {len(cells)} column(s) and the rows have {size} cells",
            "a name for each column, and a decimal sign that is not the separator",
            "export it with another separator (`;` or tabs), or mend the header",
        )
    return []


def _steps(rows: Sequence[Sequence[str]], k: int, decimal: str) -> set[float]:
    """The steps of a column from row to row."""
    column = pd.Series([row[k] if k < len(row) else "" for row in rows])
    return set(np.diff(numbers(column, decimal)).tolist())


def _clock_rises(names: Sequence[str], rows: Sequence[Sequence[str]], decimal: str) -> bool:
    """True where a column is named as a time and its numbers rise from row to row: the names stand above their columns."""
    clocks = [k for k, name in enumerate(names) if meaning(name).kind == TIME]
    return bool(clocks) and len(rows) > 1 and all(step > 0 for step in _steps(rows, clocks[0], decimal))


def _filled(cells: list[str], size: int) -> list[str]:
    return [*cells, *[""] * (size - len(cells))]


def _are_units(cells: list[str], above: list[str], size: int) -> bool:
    """True for a line of units below one of names: known ones, or each in brackets, `[au]`, below names without."""
    if all(map(_is_boxed, cells)) and len(cells) == size == len(above) and not any(map(_is_boxed, above)):
        return True
    bare = [cell.strip("()[] ").lower() for cell in cells]
    known = [UNITS[cell][0] for cell in bare if cell in UNITS]
    told = any(kind in (TIME, ANGLE, LENGTH, VOLTAGE, RATE) for kind in known)
    all_ = all(cell in UNITS or cell in ("", "-", "1") for cell in bare)
    return told and all_ and len(cells) <= size == len(above)


def _is_boxed(cell: str) -> bool:
    return bool(re.fullmatch(r"\[.*\]|\(.*\)", cell))


def _with_units(names: list[str], units: list[str], place: str) -> list[str]:
    """The names, each with the unit that stands below it; InputError where it states another one itself."""
    told = []
    for name, below in zip(names, _filled(units, len(names)), strict=True):
        unit = below.strip("()[] ")
        own = meaning(name)
        if not unit or unit in ("-", "1"):
            told.append(name)
        elif unit not in UNITS and unit.lower() not in UNITS:  # one of the program's own
            told.append(f"{name} [{unit}]")
        elif not own.written:
            told.append(f"{name} ({unit})")
        elif UNITS.get(own.written.lower()) == UNITS[unit.lower()]:
            told.append(name)
        else:
            problem = f"its name says {own.written!r} and the line below says {unit!r}"
            expected = "one unit"
            raise InputError(f"{place}, column {name}", problem, expected, "correct one of them in the file")
    return told


def _unique(names: Sequence[str]) -> tuple[str, ...]:
    told: dict[str, None] = {}
    counts: Counter[str] = Counter()
    for k, name in enumerate(names):
        name = own = name or f"{UNNAMED}{k}"
        while own in told:
            counts[name] += 1
            own = f"{name}.{counts[name]}"
        told[own] = None
    return tuple(told)
