"""A table is a swing in order of time: which part of it, in which unit of time, what was passed over, and how that is told."""

import numpy as np
import pandas as pd
import pytest

from swingdown.errors import InputError
from swingdown.measurement.choice import SeveralSwings
from swingdown.measurement.files.runs import SeveralRuns
from swingdown.measurement.files.table import Table
from swingdown.measurement.interpret import interpret
from swingdown.measurement.sheet import COLUMNS

TIMES = np.arange(600) / 30
SWING = 0.3 * np.exp(-0.03 * TIMES) * np.cos(4.4 * TIMES)
NOISE = 1e-3 * np.random.default_rng(1).standard_normal((3, 600))


def read(columns, layout="commas", restoring="sine", about=(), sizes=None, cut=False, units=(), **cells):
    frame = pd.DataFrame(columns)
    frame.index = frame.index + 2
    edges = np.cumsum([0, *(sizes or [len(frame)])])
    pieces = [frame.iloc[a:b] for a, b in zip(edges, edges[1:], strict=False)]
    table = Table(tuple(frame), dict(about), pieces, layout=layout, cut=cut, units=dict(units))
    row = {**COLUMNS, "recording": "a", "file": "a.csv", "start_s": np.nan, "stop_s": np.nan} | cells
    return interpret(table, row, "sheet.csv", restoring)


def test_a_swing_is_told_with_its_columns_rate_and_layout():
    found = read({"t (s)": TIMES, "angle (rad)": SWING})
    np.testing.assert_array_equal(found.times, TIMES)
    np.testing.assert_array_equal(found.signal, SWING)
    assert (
        found.taken(found.reading) == "took `angle (rad)` as rad, `t (s)` as s, 30.0 samples a second, commas"
    )
    assert found.remarks == [] and found.column == "angle (rad)" and not found.guessed and found.input is None


@pytest.mark.parametrize(
    ("head", "cells", "seconds", "told"),
    [
        ("t (ms)", {}, 1e-3, "`t (ms)` as ms,"),
        ("t", {}, 1.0, "`t` as s (no unit is stated),"),
        ("t", {"time_unit": "us"}, 1e-6, "`t` as us,"),
        ("t", {}, 1e-3, "`t` as MS (no unit is stated),"),
        ("t", {}, 1e-6, "`t` as US (no unit is stated),"),
    ],
)
def test_times_are_in_seconds_by_their_unit_or_by_what_a_pendulum_can_do(head, cells, seconds, told):
    found = read({head: TIMES / seconds + 0.25 / seconds, "angle (rad)": SWING}, **cells)
    np.testing.assert_allclose(found.times, TIMES + 0.25)
    assert told in found.taken(found.reading)


@pytest.mark.parametrize(("head", "unit"), [("t", 1e-3), ("t (ms)", 1e-3), ("t (s)", 1)])
def test_a_window_is_in_seconds_whatever_the_file_counts_in(head, unit):
    """And narrower than a period, so that it alone tells no unit."""
    found = read({head: TIMES / unit, "angle (rad)": SWING}, start_s=3.0, stop_s=4.0)
    np.testing.assert_allclose(found.times[[0, -1]], [3.0, 4.0])
    assert len(found.times) == 31


def test_what_counts_the_rows_is_no_time_until_somebody_says_so():
    columns = {"t": np.arange(600.0), "angle (rad)": SWING}
    with pytest.raises(InputError, match="it counts the rows, and no unit says that it is a time"):
        read(columns)
    assert read(columns, time_unit="ms").times[-1] == pytest.approx(0.599)
    assert read(columns, role="static").times[-1] == 599


def test_columns_of_angles_that_were_passed_over_are_told():
    columns = {"t (s)": TIMES, "theta1 (deg)": SWING, "theta2 (deg)": 2 * SWING, "theta3 (deg)": SWING}
    found = read(columns)
    (told,) = [one for one in found.remarks if "was taken" in one]
    assert told.startswith(
        "`theta1 (deg)` was taken, the first column of angles, and not `theta2 (deg)`, `theta3 (deg)` ("
    )
    assert not any("was taken" in one for one in read(columns, signal_column="theta2 (deg)").remarks)
    for other in ("theta2 (rad)", "sigma theta (deg)", "motor angle (deg)", "U (V)"):
        found = read({"t (s)": TIMES, "theta1 (deg)": SWING, other: 2 * SWING})
        assert not any("was taken" in one for one in found.remarks)
    assert read(columns | {"motor angle (deg)": SWING}).about.get("drive_beside") == "motor angle (deg)"


def test_without_a_header_the_second_column_is_the_swing_and_that_is_told():
    bare = {"layout": "commas, no header"}
    found = read({"column 1": TIMES, "column 2": SWING, "column 3": NOISE[0]}, **bare)
    assert found.guessed and found.remarks[-1] == "the file has 3 columns and no names of them: `column 2` was taken (⟨signal_column⟩ says otherwise)"  # fmt: skip
    with pytest.raises(
        InputError, match=r"swing with periods of 0.7\d+ and 1.4\d* s: an acceleration or a height"
    ) as told:
        read({"column 1": TIMES, "column 2": np.cos(8.8 * TIMES), "column 3": SWING}, **bare)
    assert "name the column of the angle" in told.value.mend
    with pytest.raises(InputError, match="its columns lie on a circle"):
        read({"column 1": TIMES, "column 2": 5 * np.sin(SWING), "column 3": 5 * np.cos(SWING)}, **bare)
    named = read(
        {"column 1": TIMES, "column 2": np.cos(8.8 * TIMES), "column 3": SWING},
        signal_column="column 3",
        **bare,
    )
    np.testing.assert_array_equal(named.signal, SWING)


def test_of_columns_that_say_nothing_two_that_swing_are_asked_about():
    columns = {"t (s)": TIMES, "left": SWING + NOISE[0], "right": 2 * SWING + NOISE[1]}
    found = read(columns)  # the order speaks for the first
    np.testing.assert_array_equal(found.signal, columns["left"])
    with pytest.raises(SeveralSwings, match="left, right|right, left"):
        table = Table(tuple(columns), {}, [pd.DataFrame(columns)], layout="arrays", ordered=False)
        interpret(table, {**COLUMNS, "recording": "a", "file": "a.csv"}, "sheet.csv", "sine")


def anew(count=3):
    """Runs of which the clock counts anew, each with a swing of another size."""
    return {
        "t (s)": np.tile(TIMES, count),
        "angle (rad)": np.concatenate([(k + 1) * SWING for k in range(count)]),
    }


def test_a_clock_that_counts_anew_parts_the_file():
    with pytest.raises(SeveralRuns) as asked:
        read(anew())
    assert asked.value.names == ("part 1", "part 2", "part 3")
    assert "the clock jumps back from 19.9667 to 0 s" in str(asked.value)
    found = read(anew(), run="part 3")
    np.testing.assert_allclose(found.signal, 3 * SWING)
    assert found.remarks == ["the clock counts anew 2 times in it: this is part 3"]
    with pytest.raises(SeveralRuns):
        read(anew(), run="part 4")


@pytest.mark.parametrize("sizes", [None, [700, 1100]])
def test_a_column_that_numbers_the_runs_parts_the_file(sizes):
    """Where the clock counts anew, or goes on much later; one that changes meanwhile numbers none."""
    late = anew() | {"t (s)": np.concatenate([TIMES + 100 * k for k in range(3)])}
    for columns in (anew(), late):
        numbered = columns | {"run": np.repeat([1.0, 2, 3], 600)}
        with pytest.raises(SeveralRuns) as asked:
            read(numbered, sizes=sizes)
        assert "`run` numbers 3 runs in it" in str(asked.value)
        found = read(numbered, sizes=sizes, run="part 2")
        np.testing.assert_allclose(found.signal, 2 * SWING)
        assert found.remarks[-1] == "`run` numbers 3 runs in it: this is part 2"
    for other in (np.repeat([1.0, 2, 1], 600), np.repeat(np.arange(6.0), 300), np.repeat([1.0, 2], 900)):
        with pytest.raises(SeveralRuns) as asked:
            read(anew() | {"run": other})
        assert "numbers" not in str(asked.value)


def test_ten_samples_in_the_window_are_the_fewest():
    columns = {"t (s)": TIMES, "angle (rad)": SWING}
    assert len(read(columns, stop_s=9 / 30 + 1e-3).times) == 10
    with pytest.raises(InputError, match="9 samples with a number in each cell.*at least 10"):
        read(columns, stop_s=8 / 30 + 1e-3)


def test_what_was_put_right_is_told_in_its_order():
    order = np.arange(600)
    order[[100, 101]] = 101, 100
    found = read(
        {"t (s)": TIMES[order], "angle (rad)": SWING[order], "one": 0 * TIMES},
        about={"paused": "it was paused"}, cut=True,
    )  # fmt: skip
    np.testing.assert_array_equal(found.signal, SWING[:-1])
    assert found.remarks == [
        "`one` holds one value throughout: left out", "the last line has no end and was left out", "it was paused",
        "the time runs back at 1 of 599 rows, which were put in order of time",
    ]  # fmt: skip


def test_series_that_take_turns_row_by_row_are_refused():
    rows = np.column_stack([SWING, 0.5 + SWING]).ravel()
    with pytest.raises(InputError, match="2 series take turns in it"):
        read({"t (s)": np.arange(1200) / 60, "angle (rad)": rows})


def test_an_input_goes_with_the_swing_in_its_order():
    drive = np.sin(3 * TIMES)
    back = {"t (s)": TIMES[::-1], "angle (rad)": SWING[::-1], "motor (m/s^2)": drive[::-1]}
    found = read(back, input_column="motor (m/s^2)")
    np.testing.assert_array_equal(found.input, drive)
    np.testing.assert_array_equal(found.signal, SWING)
    assert found.input_unit == "m/s^2" and "drive_beside" not in found.about


@pytest.mark.parametrize(
    ("columns", "restoring", "told"),
    [
        ({"x (m)": np.sin(SWING), "y (m)": -np.cos(SWING)}, "sine", "took `x (m)` and `y (m)` as positions, the angle about a fitted pivot"),
        ({"x (cm)": SWING, "y (cm)": 0.5 * SWING}, "sine", "took `x (cm)` and `y (cm)` as positions, how far along the axis"),
        ({"x (cm)": SWING}, "sine", "took `x (cm)` as one coordinate"),
        ({"v (m/s)": SWING}, "sine", "took `v (m/s)` as a speed"),
        ({"U (V)": SWING}, "linear", "took `U (V)` as volts"),
    ],
)  # fmt: skip
def test_what_is_no_angle_is_told_as_what_it_is(columns, restoring, told):
    found = read(
        {"t (s)": TIMES} | columns, restoring=restoring, signal_unit="V" if "U (V)" in columns else ""
    )
    assert found.taken(found.reading).startswith(told)


def test_of_a_gyroscope_the_axis_that_turns_most_is_taken():
    found = read(
        {"t (s)": TIMES, "gyro x (rad/s)": NOISE[0], "gyro y (rad/s)": SWING, "gyro z (rad/s)": NOISE[1]}
    )
    assert found.column == "gyro y (rad/s)" and found.taken(found.reading).startswith(
        "took `gyro y (rad/s)` as rad/s"
    )
    np.testing.assert_array_equal(found.signal, SWING)
