"""Lines that say beside each number what it is, as a board prints them or a log in JSON has them: ``t=0.02 angle: 12.3 deg``, ``0.02 s, 12.3°``."""

import csv
import io
import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from typing import BinaryIO, NamedTuple

from .cells import STAMP
from .columns import UNITS
from .text import HEAD, charset, pieces_of

FEWEST, SHARE = 10, 0.8  # lines of one wording, and of those that hold a number: what makes them a table
_LINES = 8  # of a record at most
_LATER = 0.8  # times as often as the commonest of them the rarest is there
_NUMBER = re.compile(
    rf"(?<![\w.^])(?:{STAMP.pattern.removeprefix('(?i)')}|[-+]?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?)(?![\d.:])",
    re.I,
)
_NAME = re.compile(r"""([^\W\d]\w*(?: [^\W\d]\w*)*)\s*["'\])}]*\s*(?:=>|[:=])\s*["'\[({]*\s*$""")
_LAST = re.compile(r"([^\W\d]\w*)\W*$")
_FIRST = re.compile(r"^\s*([^\W\d_][^\s,;:=|\"'{}\[\]]*|°)")
_AXIS = re.compile(r"(?i)(.+) [xy]")


class _Line(NamedTuple):
    """A line's numbers, and the texts before, between and behind them."""

    wording: tuple[str, ...]
    numbers: tuple[str, ...]
    text: str


def reworded(source: BinaryIO, coded: str, name: str, surely: bool = False) -> BinaryIO | None:
    """The same numbers as an open CSV file with a header; None where most lines have no common wording.

    Lines of another wording are left as they are, to be told as no rows. ``surely``: each number but a first one, which may be a
    clock's, has its word.
    """
    own = charset(coded)
    source.seek(0)
    head = [_line(text) for text in _texts(next(pieces_of(source, coded, name))[1][:HEAD], own)]
    wordings = _record([one.wording for one in head if one.numbers])
    names = [called for wording in wordings for called in _names(wording)]
    if not any(names) or (surely and not all(names[1:])):
        return None
    made = io.StringIO(newline="")
    rows = csv.writer(made, lineterminator="\n")
    header: list[str] = [one or f"column {k}" for k, one in enumerate(names, 1)]
    record: dict[int, _Line] = {}
    for _, piece in pieces_of(source, coded, name):
        for line in map(_line, _texts(piece, own)):
            if line.wording not in wordings:
                if line.numbers or not (record or len(wordings) > 1):
                    rows.writerow([line.text])
                continue
            place = wordings.index(line.wording)
            if header:  # above the first row, below what stands above it in the file
                rows.writerow(header)
                header = []
            if any(place <= one for one in record):  # what was begun lacks its end
                rows.writerow(_cells(record, wordings))
                record = {}
            record[place] = line
            if place == len(wordings) - 1:
                rows.writerow(_cells(record, wordings))
                record = {}
    return io.BytesIO(made.getvalue().encode())


def _cells(record: Mapping[int, _Line], wordings: Sequence[tuple[str, ...]]) -> list[str]:
    """The numbers of a record's lines, and empty cells for those of a line that is not there."""
    lines = (record[k].numbers if k in record else [""] * (len(one) - 1) for k, one in enumerate(wordings))
    return [cell for line in lines for cell in line]


def _record(wordings: Sequence[tuple[str, ...]]) -> list[tuple[str, ...]]:
    """The wordings of the lines that make a record, one line or several that follow each other in turn; none where most lines are neither."""
    counts = Counter(wordings).most_common(_LINES)
    for size in range(1, len(counts) + 1):
        usual, least = [one for one, _ in counts[:size]], counts[size - 1][1]
        if least < FEWEST or least < _LATER * counts[0][1]:
            break
        if sum(count for _, count in counts[:size]) >= SHARE * len(wordings):
            first = next(k for k, one in enumerate(wordings) if one in usual)
            turn = list(wordings[first : first + size])
            return turn if set(turn) == set(usual) else []
    return []


def _texts(piece: bytes, coded: str) -> Iterator[str]:
    return (text for text in piece.decode(coded, errors="replace").split("\n") if text.strip())


def _line(text: str) -> _Line:
    found = list(_NUMBER.finditer(text))
    ends = [0, *(one.end() for one in found)]
    begins = [*(one.start() for one in found), len(text)]
    between = (" ".join(text[end:begin].split()) for end, begin in zip(ends, begins, strict=True))
    return _Line(tuple(between), tuple(one.group() for one in found), text)


def _names(wording: tuple[str, ...]) -> list[str]:
    """What each number is, with its unit: the words before it up to another sign, and a unit right behind it; of the axes of one thing, as
    ``Rotation X: 0.1, Y: 0.2, Z: 0.3 rad/s``, the words stand before the first and the unit behind the last."""
    signed = any(_NAME.search(text) for text in wording[:-1])
    found, known = list[str](), None
    for before, behind in zip(wording[:-1], wording[1:], strict=True):
        called = (_NAME if signed else _LAST).search(before, known.end() if known else 0)
        unit = _FIRST.match(behind)
        known = unit if unit and unit[1].lower() in UNITS else None
        name = called[1].strip() if called else ""
        if re.fullmatch("(?i)[yz]", name) and found and (words := _AXIS.fullmatch(found[-1])):
            name = f"{words[1]} {name}"
            if known:
                found = [f"{one} ({known[1]})" if one.startswith(f"{words[1]} ") else one for one in found]
        name = name or (f"column {len(found) + 1}" if known else "")
        found.append(f"{name} ({known[1]})" if known else name)
    return found
