"""The recordings that a report leaves out."""

from types import SimpleNamespace

import numpy as np
import pandas as pd

from swingdown.report.sections.left_out import left_out, notice
from swingdown.studies.left_out import OF_ALL, OF_SEARCH

COLUMNS = ["recording", "campaign", "file", "left_out_of", "problem", "mend"]


def material(*rows):
    return SimpleNamespace(tables={"left_out": pd.DataFrame(rows, columns=COLUMNS)})


def row(name, of=OF_ALL):
    return [name, "bench", f"{name}.csv", of, "it is a picture", np.nan]


def test_each_has_its_row_with_the_reason_and_an_empty_cell_stays_empty():
    (table,) = left_out(material(row("a"), row("b", OF_SEARCH))).items
    assert table.rows == [
        ["a", "bench", "a.csv", OF_ALL, "it is a picture", ""],
        ["b", "bench", "b.csv", OF_SEARCH, "it is a picture", ""],
    ]
    assert [column.head for column in table.columns] == [
        "recording",
        "campaign",
        "file",
        "left out of",
        "why",
        "mend",
    ]


def test_there_is_no_section_where_all_were_used():
    assert left_out(material()) is None and left_out(SimpleNamespace(tables={})) is None
    assert notice(material()) == notice(SimpleNamespace(tables={})) == []


def test_above_all_else_stand_those_that_are_in_no_result():
    assert notice(material(row("a"), row("b", OF_SEARCH))) == [
        "1 recording was left out: a. “Recordings left out” says why."
    ]
    (line,) = notice(material(row("a"), row("c")))
    assert line.startswith("2 recordings were left out: a, c.")
    assert notice(material(row("b", OF_SEARCH))) == []
