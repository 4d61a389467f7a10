"""The columns of time and swing are those that names, units and what they hold leave; what more than one could be is asked."""

import numpy as np
import pandas as pd
import pytest

from swingdown.errors import InputError
from swingdown.measurement.choice import (
    SeveralSwings,
    Uncalibrated,
    alike_in,
    ask_which,
    columns_of,
    guessed_in,
    input_of,
    may_be_it,
    says_nothing,
    unnamed,
    widest,
    with_rising_time,
    with_running_time,
    without_still,
)
from swingdown.measurement.files.table import Table
from swingdown.measurement.sheet import COLUMNS

TIMES = np.arange(600) / 30
SWING = np.exp(-0.03 * TIMES) * np.cos(4.4 * TIMES)
NOISE = np.random.default_rng(1).standard_normal((3, 600))


def table(columns, layout="commas", sizes=(600,), **more):
    frame = pd.DataFrame(columns)
    frame.index = frame.index + 2
    edges = np.cumsum([0, *sizes])
    pieces = [frame.iloc[a:b] for a, b in zip(edges, edges[1:], strict=False)]
    return Table(tuple(frame), {}, pieces, layout=layout, **more)


def row(**cells):
    return {**COLUMNS, "recording": "a", "file": "a.csv"} | cells


@pytest.mark.parametrize(
    ("still", "told"),
    [
        ({"one": np.full(600, 3.0)}, "`one` holds one value throughout: left out"),
        ({"one": np.full(600, 3.0), "two": np.zeros(600)}, "`one`, `two` hold one value throughout: left out"),
        ({"row": np.arange(600) + 5.0}, "`row` counts the rows: left out"),
        ({"bare": np.where(np.arange(600) < 9, SWING, np.nan)}, "`bare` holds next to no numbers: left out"),
        ({"Unnamed: 3": np.full(600, 3.0)}, None),
    ],
)  # fmt: skip
def test_what_does_not_move_or_counts_the_rows_is_left_out_beside_others(still, told):
    made, remarks = without_still(table({"t (s)": TIMES} | still | {"angle": SWING}, sizes=(250, 350)), row())
    assert made.names == ("t (s)", "angle") and remarks == ([told] if told else [])
    assert [list(piece) for piece in made.pieces] == [["t (s)", "angle"]] * 2


@pytest.mark.parametrize(
    ("columns", "cells"),
    [
        ({"t (s)": TIMES, "one": 0 * TIMES, "angle": SWING}, {"signal_column": "one"}),
        ({"t (s)": TIMES, "one": 0 * TIMES, "angle": SWING}, {"input_column": "one"}),
        ({"t (s)": TIMES, "one": 0 * TIMES, "angle": SWING}, {"role": "static"}),
        ({"t (s)": TIMES, "x": SWING, "y": 0 * TIMES}, {}),  # a position may keep its height
        ({"t (s)": TIMES, "angle": 0 * TIMES}, {}),
        ({"row": np.arange(600.0), "angle": SWING}, {}),  # it may be all the time there is
        ({"t (s)": TIMES, "ten": np.where(np.arange(600) < 10, SWING, np.nan), "angle": SWING}, {}),
    ],
)
def test_what_is_named_a_position_or_all_there_is_stays(columns, cells):
    made, remarks = without_still(table(columns), row(**cells))
    assert made.names == tuple(columns) and remarks == [] and len(pd.concat(made.pieces)) == 600


def test_noise_beside_a_swing_of_the_same_kind_is_left_out_and_a_second_swing_is_not():
    """As the channels of an oscilloscope."""
    noise = {"t (s)": TIMES, "CH1 (V)": NOISE[0], "CH2 (V)": 3 * SWING + 0.1 * NOISE[1]}
    made, told = without_still(table(noise), row())
    assert made.names == ("t (s)", "CH2 (V)") and told == ["`CH1 (V)` holds noise alone: left out"]
    for other in (SWING, np.cumsum(NOISE[0]), 3 * SWING + NOISE[0]):
        kept, told = without_still(table(noise | {"CH1 (V)": other}), row())
        assert kept.names == tuple(noise) and told == []
    last = {"t (s)": TIMES, "CH2 (V)": SWING, "CH1 (V)": NOISE[0]}  # it is taken anyway
    assert without_still(table(last), row())[1] == []


def test_times_since_the_row_before_are_summed_over_all_pieces():
    steps = 0.03 + 0.002 * np.random.default_rng(2).random(600)
    made, cells, told = with_running_time(table({"dt (s)": steps, "angle": SWING}, sizes=(200, 400)), row())
    times = pd.concat(made.pieces)["dt (s)"]
    np.testing.assert_allclose(times, np.cumsum(steps) - steps[0])
    assert cells["time_column"] == "dt (s)" and told == ["`dt (s)` tells what passed since the row before: its running sum is the time"]  # fmt: skip
    again, _, _ = with_running_time(table({"dt (s)": steps, "angle": SWING}), row())
    np.testing.assert_allclose(pd.concat(again.pieces)["dt (s)"], times)


def test_a_step_beside_a_time_is_left_out_and_one_that_rises_is_the_time():
    steps = 0.03 + 0.002 * np.random.default_rng(2).random(600)
    columns = {"t (s)": TIMES, "dt (s)": steps, "angle": SWING}
    made, cells, told = with_running_time(table(columns), row())
    assert made.names == ("t (s)", "angle") and cells["time_column"] == "" and told == []
    kept, _, _ = with_running_time(table(columns), row(signal_column="dt (s)"))
    assert kept.names == tuple(columns)
    named, cells, told = with_running_time(table(columns), row(time_column="dt (s)"))
    assert named.names == ("t (s)", "dt (s)", "angle") and told and cells["time_column"] == "dt (s)"
    rising, _, told = with_running_time(table({"dt (s)": TIMES, "angle": SWING}), row())
    assert told == [] and rising.names == ("dt (s)", "angle")


def test_the_only_column_that_rises_is_the_time():
    made, cells, told = with_rising_time(table({"a": SWING, "b": TIMES, "c": NOISE[0]}), row())
    assert cells["time_column"] == "b" and "`b` alone rises from row to row: taken for it" in told[0]
    counted, cells, _ = with_rising_time(table({"a": SWING, "b": TIMES, "c": np.arange(600.0)}), row())
    assert cells["time_column"] == "b" and counted.names == ("a", "b")
    only, cells, _ = with_rising_time(table({"a": SWING, "c": np.arange(600.0)}), row())
    assert cells["time_column"] == "c" and only.names == ("a", "c")


@pytest.mark.parametrize(
    "columns",
    [{"a": TIMES, "b": SWING}, {"a": TIMES, "b": 2 * TIMES}, {"a": SWING, "b": TIMES, "c": 2 * TIMES}, {"a": TIMES[::-1], "b": SWING}, {"t (s)": SWING, "b": TIMES}],
)  # fmt: skip
def test_where_the_first_rises_or_several_do_or_one_says_so_nothing_is_chosen(columns):
    made, cells, told = with_rising_time(table(columns), row())
    assert cells["time_column"] == "" and told == [] and made.names == tuple(columns)


@pytest.mark.parametrize(
    ("name", "words"),
    [("frame", "it counts frames or samples"), ("ticks", "it counts ticks of a clock"), ("a", "none rises from row to row")],
)  # fmt: skip
def test_without_a_time_it_is_asked_for(name, words):
    own = SWING if name == "a" else np.arange(600.0)
    with pytest.raises(InputError, match=words):
        with_rising_time(table({name: own, "b": NOISE[0]}), row())
    if name != "a":
        assert with_rising_time(table({name: own, "b": NOISE[0]}), row(time_unit="ms"))[2] == []
    assert with_rising_time(table({"a": SWING[:9], "b": NOISE[0][:9]}, sizes=(9,)), row())[2] == []


def test_three_columns_that_say_nothing_are_guessed_at():
    nothing, two = table({"t (s)": TIMES, "a": SWING, "b": SWING}), table({"a": TIMES, "b": SWING})
    assert says_nothing(nothing) and guessed_in(nothing) and not says_nothing(two) and not guessed_in(two)
    assert not says_nothing(table({"t (s)": TIMES, "x": SWING, "b": SWING}))  # x is a position
    bare = {"layout": "commas, no header"}
    assert guessed_in(table({"column 1": TIMES, "angle (rad)": SWING, "c": SWING}, **bare))
    assert not guessed_in(table({"column 1": TIMES, "column 2": SWING}, **bare))
    assert unnamed(table({"a": TIMES, "b": SWING, "c": SWING}, **bare), ["a", "b"]) == ["c"]
    assert unnamed(nothing, ["a"]) == []


@pytest.mark.parametrize(
    ("names", "cells", "found"),
    [
        (("t (s)", "a", "b"), {}, ["t (s)", "a", "b"]),
        (("t (s)", "angle a (rad)", "angle b (rad)", "f (N)"), {}, ["angle a (rad)", "angle b (rad)"]),
        (("t (s)", "angle a (rad)", "angle b (deg)"), {}, []),
        (("t (s)", "CH1 (V)", "CH2 (mV)"), {}, ["CH1 (V)", "CH2 (mV)"]),
        (("t (s)", "CH1 (V)", "drive (V)"), {}, []),
        (("t (s)", "a", "b"), {"signal_column": "a"}, []),
        (("t (s)", "a", "b"), {"time_column": "gone"}, []),
        (("t (s)", "x (m)", "y (m)"), {}, []),
    ],
)
def test_columns_of_one_kind_may_each_be_the_swing(names, cells, found):
    assert may_be_it(table(dict.fromkeys(names, SWING)), row(**cells)) == found


def test_columns_passed_over_may_be_the_swing_where_no_name_says_so():
    columns = {"t (s)": TIMES, "frame": TIMES, "drive": SWING, "a": SWING, "b": SWING}
    known = table(columns)
    chosen = columns_of(known, row(), "sheet.csv")
    assert chosen.found[0].name == "a" and alike_in(known, chosen) == []
    assert alike_in(known._replace(ordered=False), chosen) == ["b"]
    later = columns_of(known, row(signal_column="b"), "sheet.csv")
    assert alike_in(known, later) == ["a"]
    angle = table(columns | {"angle (rad)": SWING})
    assert alike_in(angle, columns_of(angle, row(), "sheet.csv")) == []


def test_of_several_that_swing_it_is_asked_which():
    swings = {"a": SWING, "b": NOISE[0], "c": np.where(np.arange(600) % 50 == 0, np.nan, 0.2 * SWING)}
    with pytest.raises(SeveralSwings, match="2 of its columns swing, .*: a, c"):
        ask_which(TIMES, swings, "a.csv")
    ask_which(TIMES, {"a": SWING, "b": NOISE[0]}, "a.csv")


def test_of_a_body_s_angles_the_widest_swing_is_taken_unless_another_is_nearly_as_wide():
    angles = {"roll": np.cumsum(NOISE[0]), "pitch": 0.09 * SWING, "yaw": SWING}
    at, (told,) = widest(TIMES, angles, "a.csv")
    assert at == 2 and told.startswith("of 3 angles `yaw` swings and was taken")
    with pytest.raises(SeveralSwings):
        widest(TIMES, angles | {"pitch": 0.11 * SWING}, "a.csv")


def test_columns_that_are_not_there_are_told_with_those_that_are():
    columns = {"t (s)": TIMES, "angle (rad)": SWING}
    for key in ("time_column", "signal_column"):
        with pytest.raises(InputError, match="no column 'gone'. Expected: one of t .s., angle .rad."):
            columns_of(table(columns), row(**{key: "gone"}), "sheet.csv")
    with pytest.raises(InputError, match=r"the file has 1 column\(s\).*write the samples a second"):
        columns_of(table({"angle (rad)": SWING}), row(), "sheet.csv")
    assert input_of(table(columns), row(), "sheet.csv") == []
    assert input_of(table(columns), row(input_column="t (s)"), "sheet.csv") == ["t (s)"]
    with pytest.raises(InputError, match="no column 'gone'"):
        input_of(table(columns), row(input_column="gone"), "sheet.csv")


def test_units_that_contradict_or_need_a_calibration_are_asked_about():
    volts = table({"t (s)": TIMES, "U (V)": SWING})
    with pytest.raises(Uncalibrated, match="seems to be in V"):
        columns_of(volts, row(), "sheet.csv")
    for cells in ({"signal_unit": "V"}, {"scale": "20"}):
        assert columns_of(volts, row(**cells), "sheet.csv").unit == "V"
    apart = table({"t": TIMES, "angle": SWING}, units={"angle": "deg"})
    with pytest.raises(InputError, match="the sheet says 'rad' and the file says 'deg' of 'angle'"):
        columns_of(apart, row(signal_unit="rad"), "sheet.csv")
    assert columns_of(apart, row(signal_unit="deg"), "sheet.csv").unit == "deg"
    for head, wrong in (("angle (rad)", "zero_tolerance_rad_per_s"), ("gyro (rad/s)", "zero_tolerance_rad")):
        with pytest.raises(InputError, match="the limit of its zero in rad"):
            columns_of(table({"t (s)": TIMES, head: SWING}), row(**{wrong: 0.1}), "sheet.csv")
        right = ({"zero_tolerance_rad", "zero_tolerance_rad_per_s"} - {wrong}).pop()
        columns_of(table({"t (s)": TIMES, head: SWING}), row(**{right: 0.1}), "sheet.csv")


def test_a_force_is_a_swing_on_a_spring_where_it_is_named():
    force = table({"t (s)": TIMES, "F (N)": SWING})
    assert columns_of(force, row(signal_column="F (N)"), "sheet.csv", "linear").found[0].name == "F (N)"
    for cells, restoring in (({"signal_column": "F (N)"}, "sine"), ({}, "linear")):
        with pytest.raises(InputError, match="is no angle"):
            columns_of(force, row(**cells), "sheet.csv", restoring)
