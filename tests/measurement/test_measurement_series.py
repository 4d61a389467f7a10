"""Numbers of columns are those within the window, piece by piece, and what holds none is counted as missing or refused."""

import numpy as np
import pandas as pd
import pytest

from swingdown.errors import InputError
from swingdown.measurement.files import series as module
from swingdown.measurement.files.series import series
from swingdown.measurement.files.table import Table

TIMES = np.arange(40) / 10
ANGLES = np.arange(40) + 0.5


def table(angles=ANGLES, times=TIMES, sizes=(40,), **more):
    """A table in pieces of these sizes, of which line 2 is the first row."""
    whole = pd.DataFrame({"t": times, "a": angles, "b": np.arange(len(times)) * 2.0})
    whole.index = whole.index + 2
    edges = np.cumsum([0, *sizes])
    pieces = [whole.iloc[a:b] for a, b in zip(edges, edges[1:], strict=False)]
    return Table(("t", "a", "b"), {}, pieces, **more)


def read(found, columns=("a",), unit="s", beside=(), **window):
    row = {"file": "a.csv", "start_s": np.nan, "stop_s": np.nan} | window
    return series(found, row, "t", list(columns), unit, beside)


@pytest.mark.parametrize("sizes", [(40,), (1, 30, 9), (20, 20)])
@pytest.mark.parametrize(("unit", "factor"), [("s", 1), ("ms", 1e-3), ("us", 1e-6), ("ns", 1e-9)])
def test_the_window_is_in_seconds_and_its_edges_are_in_it(sizes, unit, factor):
    times, (angles, beside), told = read(
        table(sizes=sizes), unit=unit, beside=["b"], start_s=1.0 * factor, stop_s=3.0 * factor
    )
    np.testing.assert_allclose(times, np.arange(10, 31) / 10 * factor)
    np.testing.assert_array_equal(angles, np.arange(10, 31) + 0.5)
    np.testing.assert_array_equal(beside, 2.0 * np.arange(10, 31))
    assert told == []


def test_a_last_line_without_an_end_is_left_out():
    times, (angles,), _ = read(table(sizes=(20, 20), cut=True))
    np.testing.assert_array_equal(times, TIMES[:-1])
    np.testing.assert_array_equal(angles, ANGLES[:-1])


def test_what_is_beside_may_hold_no_number_and_loses_the_rows_of_the_others():
    angles = ANGLES.astype(object)
    angles[5] = ""
    found = table(angles, sizes=(10, 30))
    found.pieces[0].loc[:, "b"] = np.nan
    times, (one, beside), told = read(found, beside=["b"])
    np.testing.assert_array_equal(times, np.delete(TIMES, 5))
    np.testing.assert_array_equal(one, np.delete(ANGLES, 5))
    assert np.isnan(beside[:9]).all() and beside[9] == 20
    assert told == ["1 of 40 cells of `a` hold no number (they are empty): missing samples"]


def test_what_is_written_in_a_cell_is_told_with_its_line():
    angles = ANGLES.astype(object)
    angles[[3, 25, 30]] = "-", "  oops ", "n/a"
    _, _, told = read(table(angles, sizes=(20, 20)))
    assert told == ["3 of 40 cells of `a` hold no number (the first 'oops' in line 27): missing samples"]
    _, _, told = read(table(angles, sizes=(20, 20)), stop_s=2.4)
    assert told == ["1 of 25 cells of `a` hold no number (they are empty): missing samples"]


@pytest.mark.parametrize(("empty", "refused"), [(20, False), (21, True)])
def test_a_column_of_which_more_than_half_is_empty_is_another(empty, refused):
    angles = np.where(np.arange(40) < empty, np.nan, ANGLES)
    if not refused:
        assert len(read(table(angles))[0]) == 20
        return
    with pytest.raises(InputError, match="21 of 40 cells hold no finite number .they are empty.") as told:
        read(table(angles))
    assert "the 19 rows with a number are turning points" in told.value.mend
    assert told.value.where == "a.csv, column a"


@pytest.mark.parametrize(("words", "refused"), [(2, False), (3, True)])
def test_more_than_one_cell_of_twenty_with_words_is_damage(words, refused):
    angles = ANGLES.astype(object)
    angles[10 : 10 + words] = "oops"
    if not refused:
        assert len(read(table(angles))[0]) == 38
        return
    with pytest.raises(InputError, match="3 of 40 cells .*the first 'oops' in line 12") as told:
        read(table(angles))
    assert "turning points" not in told.value.mend and told.value.where == "a.csv, line 12, column a"


def test_a_start_long_before_the_first_time_is_meant_from_there():
    """A clock that counts from 1000 s on, for 3.9 s: 2 s cuts nothing off, 0 is from the first, 996.5 s may be a margin."""
    late = table(times=1000 + TIMES)
    with pytest.raises(InputError, match="2 s, is long before its first time, 1000 s") as told:
        read(late, start_s=2.0)
    assert "start_s: 1002" in told.value.mend
    for start in (0.0, 996.5):
        assert len(read(late, start_s=start)[0]) == 40


def test_more_samples_than_can_be_held_are_refused_by_those_in_the_window(monkeypatch):
    monkeypatch.setattr(module, "MOST", 30)
    with pytest.raises(InputError, match="more than 30 samples"):
        read(table(sizes=(20, 20)))
    assert len(read(table(sizes=(20, 20)), stop_s=2.9)[0]) == 30


def test_no_rows_are_no_numbers():
    times, (angles,), told = read(table(sizes=()))
    assert times.size == angles.size == 0 and told == []
