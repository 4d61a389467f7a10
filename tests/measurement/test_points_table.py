"""Which columns of a table are turning points, in which units, and what their uncertainties say."""

import numpy as np
import pandas as pd
import pytest

from swingdown.measurement.files.columns import meaning
from swingdown.measurement.files.table import Table
from swingdown.measurement.points.points_table import in_window, is_number, peeked, turning_points, unit_of
from swingdown.measurement.sheet import COLUMNS

HALVES = np.arange(30)
TIMES = 0.7 * HALVES + 1 + 0.002 * np.resize([0, 1, 0, 3, 1, 4, 2], 30)
SIZES = 0.3 * 0.97**HALVES
SIDES = SIZES * (-1.0) ** HALVES


def read(columns, units=(), layout="commas", pieces=1, cut=False, **cells):
    frame = pd.DataFrame(columns)
    frame.index = frame.index + 2
    parts = [frame.iloc[part] for part in np.array_split(np.arange(len(frame)), pieces)]
    table = Table(tuple(frame), {}, parts, layout=layout, units=dict(units), cut=cut)
    row = {**COLUMNS, "recording": "p", "campaign": "p", "file": "p.csv"} | cells
    return turning_points(table, row, "sheet.csv")


def points(*args, **kwargs):
    found = read(*args, **kwargs)[1]
    assert found is not None
    return found


@pytest.mark.parametrize(("head", "factor"), [("t (s)", 1), ("t (ms)", 1e-3), ("t (us)", 1e-6)])
def test_times_and_their_uncertainties_are_in_seconds_readings_in_their_own_unit(head, factor):
    found = points(
        {head: TIMES / factor, "angle (deg)": np.degrees(SIDES), "t_err": 0.01 / factor, "error": 0.2}
    )
    np.testing.assert_allclose(found["time"], TIMES)
    np.testing.assert_allclose(np.abs(found["signal"]), np.degrees(SIZES))
    assert found["signal"].attrs["units"] == "deg"
    assert found.attrs["u_times"] == pytest.approx(0.01) and found.attrs["u_readings"] == pytest.approx(0.2)


def test_a_single_column_of_errors_is_of_the_readings_and_a_typical_one_is_the_median():
    error = np.where(HALVES < 14, 0.5, 0.1)
    found = points({"t (s)": TIMES, "angle (rad)": SIDES, "error": error})
    assert found.attrs["u_readings"] == pytest.approx(0.1) and np.isnan(found.attrs["u_times"])
    assert np.isnan(points({"t (s)": TIMES, "angle (rad)": SIDES, "error": 0 * TIMES}).attrs["u_readings"])
    bare = points({"column 1": TIMES, "column 2": SIDES}, layout="commas, no header")
    assert np.isnan(bare.attrs["u_readings"])


def test_the_unit_that_nobody_states_is_the_one_in_which_a_pendulum_can_swing():
    assert unit_of(np.array([3.1, -3.1]), "") == ("rad", [])
    unit, (told,) = unit_of(np.array([1.0, -3.2]), "")
    assert unit == "deg" and "taken for degrees" in told
    assert unit_of(np.array([5.0]), "rad") == ("rad", []) and unit_of(np.empty(0), "") == ("rad", [])
    found = points({"t (s)": TIMES, "amplitude": 100 * SIDES})
    assert found["signal"].attrs["units"] == "deg" and "taken for degrees" in found.attrs["remarks"]
    assert "in degrees (no unit is stated)" in found.attrs["taken"]
    stated = points({"t (s)": TIMES, "amplitude": SIDES}, signal_unit="deg")
    assert stated["signal"].attrs["units"] == "deg" and "in degrees, `t (s)` as s" in stated.attrs["taken"]


@pytest.mark.parametrize(
    ("head", "cells", "told"), [("t", {}, "`t` as s (no unit is stated)"), ("t (s)", {}, "`t (s)` as s,"), ("t (s)", {"time_unit": "ms"}, "`t (s)` as ms,")]
)  # fmt: skip
def test_the_unit_of_the_times_is_told_as_stated_or_that_none_is(head, cells, told):
    assert told in points({head: TIMES, "angle (rad)": SIDES}, **cells).attrs["taken"]


@pytest.mark.parametrize(("head", "unit"), [("x (cm)", "cm"), ("x", "units of its own")])
def test_a_coordinate_is_no_angle(head, unit):
    found = points(
        {"t (s)": TIMES, head: SIDES, "y (cm)": 5.0}, signal_column=head, signal_kind="half_swings"
    )
    assert found["signal"].attrs["units"] == unit
    assert f"an amplitude in {unit} is no angle" in found.attrs["remarks"]


def test_rows_beyond_the_window_or_without_a_number_are_none():
    readings = SIDES.copy()
    readings[29] = np.nan
    found = points(
        {"t (s)": TIMES, "angle (rad)": readings}, start_s=float(TIMES[2]), stop_s=float(TIMES[27])
    )
    np.testing.assert_allclose(found["time"], TIMES[2:28])
    in_ms = points({"t (ms)": 1e3 * TIMES, "angle (rad)": SIDES}, start_s=float(TIMES[2]) - 1e-3)
    np.testing.assert_allclose(in_ms["time"], TIMES[2:])
    row = {"start_s": 1.0, "stop_s": np.nan}
    assert list(in_window(np.array([0.5, 1.0, 9.0, np.nan]), row)) == [False, True, True, True]


@pytest.mark.parametrize(
    ("name", "values", "number"),
    [("n", [0, 1, 5], True), ("Swing No.", [1, 2, 3], True), ("n", [0, 0.5, 1], False), ("what", [3, 1, 2], True), ("what", [0, 2, 4], False), ("what", [1], False), ("t (s)", [1, 2, 3], False)],
)  # fmt: skip
def test_a_column_counts_swings_by_its_name_or_by_whole_numbers_one_apart(name, values, number):
    assert is_number(meaning(name), np.array(values, float)) is number


@pytest.mark.parametrize(
    ("columns", "cells"),
    [
        ({"t (s)": TIMES, "angle (rad)": SIDES}, {"signal_kind": "swing"}),
        ({"t (s)": TIMES, "angle (rad)": SIDES}, {"rate_hz": 0.5}),
        ({"t (s)": TIMES, "angle (rad)": SIDES}, {"role": "static"}),
        ({"t (s)": TIMES, "U (V)": SIDES}, {}),
        ({"t (s)": TIMES, "x (m)": SIDES, "y (m)": 1 + SIZES}, {}),
        ({"t (s)": np.arange(600) / 30, "angle (rad)": np.cos(np.arange(600) / 7)}, {}),
        ({"t (s)": []}, {}),
    ],
)
def test_what_is_none_is_read_on_with_all_its_rows(columns, cells):
    table, found = read(columns, **cells)
    assert found is None and len(pd.concat(table.pieces)) == len(columns["t (s)"])


def test_of_a_larger_table_each_row_is_a_sample_and_none_is_lost():
    """More than two pieces; of two, as where a last line has no end, all rows are points but one that was cut."""
    columns = {"t (s)": TIMES, "angle (rad)": SIDES}
    assert read(columns, pieces=3)[1] is None
    assert points(columns, pieces=2).sizes["time"] == 30
    assert points(columns, pieces=2, cut=True).sizes["time"] == 29
    frame = pd.DataFrame(columns)
    table = Table(tuple(frame), {}, iter([frame] * 4))
    first, again = peeked(table, {})
    assert first is None and len(pd.concat(again.pieces)) == 120
