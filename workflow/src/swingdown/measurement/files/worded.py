"""Lines that say before each number what it is, as a board prints them or a log in JSON has them: ``t=0.02 angle: 12.3 deg``."""

import csv
import io
import re
from collections import Counter
from collections.abc import Iterator
from typing import BinaryIO, NamedTuple

from .cells import STAMP
from .columns import UNITS
from .text import HEAD, charset, pieces_of

FEWEST, SHARE = 10, 0.8  # lines of one wording, and of those that hold a number: what makes them a table
_NUMBER = re.compile(
    rf"(?<![\w.])(?:{STAMP.pattern.removeprefix('(?i)')}|[-+]?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?)(?![\d.:])",
    re.I,
)
_NAME = re.compile(r"""([^\W\d]\w*(?: [^\W\d]\w*)*)\s*["'\])}]*\s*(?:=>|[:=])\s*["'\[({]*\s*$""")
_LAST = re.compile(r"([^\W\d]\w*)\W*$")
_FIRST = re.compile(r"^\s*([^\W\d_][^\s,;:=|\"'{}\[\]]*|°)")


class _Line(NamedTuple):
    """A line's numbers, and the texts before, between and behind them."""

    wording: tuple[str, ...]
    numbers: tuple[str, ...]


def reworded(source: BinaryIO, coded: str, name: str, surely: bool = False) -> BinaryIO | None:
    """The same numbers as an open CSV file with a header; None where most lines have no common wording.

    Lines of another wording are left as they are, to be told as no rows. ``surely``: each number but a first one, which may be a
    clock's, has its word.
    """
    own = charset(coded)
    source.seek(0)
    head = [_line(text) for text in _texts(next(pieces_of(source, coded, name))[1][:HEAD], own)]
    wordings = Counter(one.wording for one in head if one.numbers)
    if not wordings:
        return None
    wording, count = wordings.most_common(1)[0]
    names = _names(wording)
    if count < FEWEST or count < SHARE * sum(wordings.values()) or not any(names):
        return None
    if surely and not all(names[1:]):
        return None
    made = io.StringIO(newline="")
    rows = csv.writer(made, lineterminator="\n")
    rows.writerow([one or f"column {k}" for k, one in enumerate(names, 1)])
    for _, piece in pieces_of(source, coded, name):
        for text in _texts(piece, own):
            line = _line(text)
            rows.writerow(line.numbers if line.wording == wording else [text])
    return io.BytesIO(made.getvalue().encode())


def _texts(piece: bytes, coded: str) -> Iterator[str]:
    return (text for text in piece.decode(coded, errors="replace").split("\n") if text.strip())


def _line(text: str) -> _Line:
    found = list(_NUMBER.finditer(text))
    ends = [0, *(one.end() for one in found)]
    begins = [*(one.start() for one in found), len(text)]
    between = (" ".join(text[end:begin].split()) for end, begin in zip(ends, begins, strict=True))
    return _Line(tuple(between), tuple(one.group() for one in found))


def _names(wording: tuple[str, ...]) -> list[str]:
    """What each number is, with its unit: the words before it up to another sign, and a unit right behind it."""
    signed = any(_NAME.search(text) for text in wording[:-1])
    found, known = [], None
    for before, behind in zip(wording[:-1], wording[1:], strict=True):
        called = (_NAME if signed else _LAST).search(before, known.end() if known else 0)
        unit = _FIRST.match(behind)
        known = unit if unit and unit[1].lower() in UNITS else None
        name = called[1].strip() if called else ""
        found.append(f"{name} ({known[1]})" if name and known else name)
    return found
