"""Cells of a line and a clock's stamps are what somebody wrote there, whatever stands between and before them."""

import numpy as np
import pandas as pd
import pytest

from swingdown.measurement.files.cells import SPACES, Clock, Dialect, split, stripped, without_groups


@pytest.mark.parametrize(
    ("line", "separator", "cells"),
    [
        ("1; 2 ;3", ";", ["1", "2", "3"]),
        ('"a, b", 2,"c"', ",", ["a, b", "2", "c"]),
        ("  1  2\t3 ", SPACES, ["1", "2", "3"]),
        ("t (s) angle [deg]", SPACES, ["t (s)", "angle [deg]"]),
        ('"t" "angle"', SPACES, ["t", "angle"]),
        ("1,,", ",", ["1", "", ""]),
    ],
)
def test_a_line_is_split_into_its_cells(line, separator, cells):
    assert split(line, separator) == cells


def test_empty_cells_at_the_end_are_none_but_for_the_least():
    assert stripped(["1", "", "2", "", ""]) == ["1", "", "2"]
    assert stripped(["1", "", "", ""], 3) == ["1", "", ""] and stripped(["", ""]) == []


@pytest.mark.parametrize(
    ("cell", "sign", "plain"),
    [("1,234,567.5", ",", "1234567.5"), ("-12.345", ".", "-12345"), ("1,23", ",", "1,23"), ("0,123", ",", "0,123"), ("1234", ",", "1234"), ("1,234", "", "1,234"), ("1'234 m", "'", "1234 m")],
)  # fmt: skip
def test_groups_of_three_digits_are_one_number(cell, sign, plain):
    assert without_groups(cell, sign) == plain


@pytest.mark.parametrize(
    ("cell", "point", "comma"),
    [("1.5", True, False), ("1,5", False, True), ("-2", True, True), (".5e-3", True, False), ("12:03:11.2", True, True), ("Blocked", True, True), ("1.5x", False, False), ("", False, False), ("a:b", False, False)],
)  # fmt: skip
def test_a_number_has_the_file_s_own_sign(cell, point, comma):
    assert Dialect(";", ".").is_number(cell) is point and Dialect(";", ",").is_number(cell) is comma


@pytest.mark.parametrize("line", ["12:03:11.245 -> 512;7", "[12:03:11.245] 512;7"])
def test_a_serial_monitor_s_stamp_is_a_cell_of_its_own(line):
    assert Dialect(";", ".", arrivals=True).cells(line) == ["12:03:11.245", "512", "7"]
    assert Dialect(SPACES, ".", arrivals=True).cells(line.replace(";", " ")) == ["12:03:11.245", "512", "7"]
    assert Dialect(";", ".").cells(line)[-1] == "7" and len(Dialect(";", ".").cells(line)) == 2


def seconds(*pieces):
    clock = Clock()
    return [list(clock.seconds(pd.Series(one))) for one in pieces]


def test_stamps_are_seconds_since_the_first_over_pieces_and_midnights():
    """A second before one midnight, then a second after it, then a second after the next."""
    assert seconds(["x"], ["23:59:59.000", "23:59:59.500", "", "0:00:01.000"], ["13:00:00", "0:00:01"])[
        1:
    ] == [pytest.approx([0, 0.5, np.nan, 2], nan_ok=True), [46_801, 86_402]]
    assert np.isnan(seconds(["x", ""])[0]).all()


@pytest.mark.parametrize(
    ("stamps", "passed"),
    [
        (["1:02.5", "1:03,75", "2:00.0"], [0, 1.25, 57.5]),  # minutes and seconds
        (["11:59:59 am", "12:00:01 pm", "1:00:00 PM"], [0, 2, 3601]),
        (["2024-07-20 23:59:59.5", "2024-07-21 00:00:00.5", "2024-07-21T00:01:00Z"], [0, 1, 60.5]),
        (["20/Jul/2024 10:00:00", "20/Jul/2024 10:00:02", "oops"], [0, 2, np.nan]),
    ],
)  # fmt: skip
def test_stamps_of_any_form_are_a_clock_s(stamps, passed):
    assert seconds(stamps)[0] == pytest.approx(passed, nan_ok=True)


def test_a_stamp_out_of_place_is_no_midnight():
    assert seconds(["10:00:02", "10:00:01", "10:00:03"])[0] == [0, -1, 1]
