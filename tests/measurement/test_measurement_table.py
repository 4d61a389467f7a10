"""A table's cells are numbers in its own decimal sign; what holds pairs becomes two columns, and looking at rows loses none."""

import numpy as np
import pandas as pd
import pytest

from swingdown.measurement.files.table import Table, apart, first_rows, numbers, prefixed


@pytest.mark.parametrize(
    ("cells", "decimal", "found"),
    [
        (["1.5", " -2e3 ", "x", ""], ".", [1.5, -2000, np.nan, np.nan]),
        (["1,5", "2.5", "3"], ",", [1.5, np.nan, 3]),
        (["1,5", "2.5", "3"], "[.,]", [1.5, 2.5, 3]),
        (["1,5"], ".", [np.nan]),
        (["Blocked", "unblocked", "?"], ".", [1, 0, np.nan]),
        ([1, 2], ".", [1, 2]),
        ([True, False], ".", [np.nan, np.nan]),
    ],
)
def test_cells_are_numbers_in_the_file_s_own_sign(cells, decimal, found):
    np.testing.assert_array_equal(numbers(pd.Series(cells), decimal), found)


def pieces(*sizes):
    edges = np.cumsum([0, *sizes])
    return [pd.DataFrame({"a": np.arange(a, b)}) for a, b in zip(edges, edges[1:], strict=False)]


@pytest.mark.parametrize(("most", "held"), [(0, 1), (2, 1), (3, 2), (7, 2), (8, 3), (99, 3)])
def test_the_first_rows_are_those_asked_for_and_one_more_and_come_again(most, held):
    table, seen = first_rows(Table(("a",), {}, iter(pieces(3, 5, 2))), most)
    assert len(seen) == held
    assert list(pd.concat(table.pieces)["a"]) == list(range(10))


def test_pairs_become_two_columns_in_their_place():
    frame = pd.DataFrame(
        {"t": [0, 1, 2], "bob": ["(1392, 685)", "[-1.5; 2e1]", "lost"], "n": ["(a, b)", "", ""]}
    )
    table = apart(Table(("t", "bob", "n"), {}, [frame.head(2), frame.tail(1)]))
    assert table.names == ("t", "bob x", "bob y", "n")
    whole = pd.concat(table.pieces)
    np.testing.assert_array_equal(table.numbers(whole, "bob x"), [1392, -1.5, np.nan])
    np.testing.assert_array_equal(table.numbers(whole, "bob y"), [685, 20, np.nan])


@pytest.mark.parametrize(("of", "split"), [(2, False), (3, True)])
def test_more_than_half_of_the_first_cells_are_pairs_of_a_column_that_is(of, split):
    cells = ["(1, 2)"] * of + ["3"] * (4 - of)
    table = apart(Table(("a",), {}, [pd.DataFrame({"a": cells})]))
    assert table.names == (("a x", "a y") if split else ("a",))


def test_no_rows_hold_no_pairs():
    assert apart(Table(("a",), {}, [])).names == ("a",)


def test_a_unit_that_the_file_states_apart_is_the_column_s():
    table = Table(("time", "angle"), {}, [], units={"angle": "deg"})
    assert [one.unit for one in table.meanings] == ["", "deg"]


def test_words_go_before_what_is_told_of_a_layout():
    found = prefixed("in a.zip", {"run 1": Table(("a",), {}, [], layout="tabs")})
    assert found["run 1"].layout == "in a.zip, tabs"
