"""Files of Logger Pro (Vernier), ``.cmbl``: the columns of its data sets."""

from typing import BinaryIO
from xml.etree.ElementTree import Element

from ...errors import InputError
from .elements import Columns, distinct, number, of_elements, roots, text_in

PROGRAM, WAY = "Logger Pro", "with File > Export As > CSV"
_TAGS = "DataObjectName", "DataObjectShortName", "ColumnUnits"


def data_sets(source: BinaryIO, name: str) -> dict[str, Columns]:
    """The Columns of each data set by its name. InputError where none has two columns of numbers."""
    found: list[tuple[str, Columns]] = []
    for root in roots(source, name, PROGRAM, ".cmbl", WAY):
        for one in root.iter("DataSet"):
            columns = [(column, cells) for column in one.findall("DataColumn") if (cells := _cells(column))]
            if len(columns) > 1:
                made = of_elements(columns, _TAGS, "columns of Logger Pro", {"source": PROGRAM})
                found.append((text_in(one, "DataSetName"), made))
    if not found:
        problem = "it holds no data set with two columns of numbers"
        expected = "a column of time and one of the signal"
        raise InputError(name, problem, expected, f"collect the data in {PROGRAM}, or export them {WAY}")
    names = distinct([key or "data set" for key, _ in found], [""] * len(found))
    return {key: columns for key, (_, columns) in zip(names, found, strict=True)}


def _cells(column: Element) -> list[float]:
    """The numbers, one a line, NaN for a cell without one; none where no cell has a number."""
    cells = [number(line) for line in (column.findtext("ColumnCells") or "").strip("\r\n").splitlines()]
    return cells if any(cell == cell for cell in cells) else []
