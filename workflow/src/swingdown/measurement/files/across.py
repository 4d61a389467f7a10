"""Tables that lie across the page: the times in one row, what was read at them in the rows below."""

import io
import re
from collections.abc import Sequence
from itertools import islice

from .cells import EITHER, NUMBER, split, stripped
from .layout import COMMENT, DIALECTS

FEWEST = 10  # samples: fewer rows are none of a recording's, and fewer columns none of its samples
# as a program prints it, with its name
_LIST = re.compile(r"(?:([^\W\d]\w*)\s*[=:]\s*)?(?:[\w.]+\()?[\[({]([^\[\](){}]*)[\])}]+[;,]?")
_NUMBER = NUMBER[EITHER]


def upright(lines: Sequence[str], timed: bool = True) -> io.BytesIO | None:
    """The text of a table whose rows become columns, between tabs; None where the lines, all of a file, are no table that lies across.

    It has fewer rows than a recording has samples, each with a name before its numbers or each without, and as many numbers in one as in the
    other. Those of one row rise; of a table that is not ``timed`` they need not, and one row will do.
    """
    some = (_bare(line.strip()) for line in lines if line.strip() and not COMMENT.match(line))
    filled = list(islice(some, FEWEST))
    if not 1 + timed <= len(filled) < FEWEST:
        return None
    for separator in dict.fromkeys(one for one, _ in DIALECTS):
        rows = [stripped(split(line, separator)) for line in filled]
        named = [not _NUMBER.fullmatch(row[0]) if row else True for row in rows]
        sizes = {len(row) for row in rows}
        if len(sizes) > 1 or min(sizes) - any(named) < FEWEST or any(named) != all(named):
            continue
        numbers = [row[any(named) :] for row in rows]
        whole = all(not cell or _NUMBER.fullmatch(cell) for row in numbers for cell in row)
        if whole and (not timed or any(map(_rises, numbers))):
            text = "\n".join("\t".join(cells) for cells in zip(*rows, strict=True))
            return io.BytesIO(f"{text}\n".encode())
    return None


def _bare(line: str) -> str:
    """A list or an array of a program, `t = [0, 0.1, 0.2]`, as its name and its numbers; any other line as it is."""
    if not (found := _LIST.fullmatch(line)):
        return line
    between = "," if "," in found[2] else " "
    return f"{found[1]}{between}{found[2].strip()}" if found[1] else found[2].strip()


def _rises(cells: Sequence[str]) -> bool:
    """True for numbers that rise from cell to cell."""
    values = [float(cell.replace(",", ".")) for cell in cells if cell]
    return all(a < b for a, b in zip(values, values[1:], strict=False))
