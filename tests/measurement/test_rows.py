"""What a spreadsheet's user would call the table is found: among titles, notes, comments, units, other tables, a serial monitor's stamps."""

import io

import numpy as np
import pandas as pd
import pytest

from swingdown.errors import InputError
from swingdown.measurement.files.columns import choose
from swingdown.measurement.files.source import table_of, tables

TIME = np.arange(300) / 20
SWING = np.round(0.4 * np.exp(-0.03 * TIME) * np.cos(5 * TIME), 5)


def rows(separator=",", start=0, stop=300):
    return "".join(
        f"{t:.3f}{separator}{x:.5f}\n" for t, x in zip(TIME[start:stop], SWING[start:stop], strict=True)
    )


def monitor(form, late=False):
    """What a serial monitor shows of a board that prints whole numbers, just before midnight where it is late."""
    lines = []
    for t, x in zip(TIME, SWING, strict=True):
        seconds = 23 * 3600 + 59 * 60 + 56 + t if late else 12 * 3600 + 3 * 60 + 11 + t
        hours, rest = divmod(seconds % 86400, 3600)
        clock = f"{int(hours):02}:{int(rest // 60):02}:{rest % 60:06.3f}"
        lines.append(form.format(clock=clock, raw=round(512 + 400 * x), t=round(1000 * t)))
    return "\n".join(lines) + "\n"


HEAD = "t_s,theta_rad\n"
# The file, and words of the remark on what was left out ("" for none).
FOUND = {
    "notes below": (HEAD + rows() + "\nmeasured in room 3\nlength 0.5 m\n", "2 lines (the first 303) below the table"),
    "an empty line of cells before the notes": (HEAD + rows() + ",\n,\nroom 3,\n", "line 304 below the table"),
    "a last row without numbers": (HEAD + rows() + "end,\n", "line 302 below the table"),
    "a last row of empty cells": (HEAD + rows() + ",\n", ""),
    "a line of zeros of a crash": (HEAD + rows() + "\0" * 4000, "below the table"),
    "a row that a crash cut": (HEAD + rows() + "15.000,0.1" + "\0" * 4000, "line 302 below the table"),
    "a comment between the rows": (HEAD + rows(stop=200) + "# knocked\n" + rows(start=200), "line 202 between the rows"),
    "a row commented out": (HEAD + rows(stop=200) + "# 9.999,0.1\n" + rows(start=200), "line 202 between the rows"),
    "notes between the rows": (
        HEAD + rows(stop=200) + "\nhere the door, which is old, slammed\nagain\n\n" + rows(start=200), "2 lines (the first 203) between",
    ),
    "an empty line between the rows": (HEAD + rows(stop=200) + "\n" + rows(start=200), ""),
    "the header once more on each page": (
        HEAD + rows(stop=100) + HEAD + rows(start=100, stop=200) + HEAD + rows(start=200), "2 lines (the first 102) between",
    ),
    "titles of several lines": ("Experiment 3\n\n9b, Monday\n\n" + HEAD + rows(), ""),
    "settings above, which are a small table": ("mass,0.3\nlength,0.5\n\n" + HEAD + rows(), ""),
    "a few rows of numbers above": ("0.1,0.2\n0.2,0.3\n\n" + HEAD + rows(), "2 lines (the first 1) of numbers above"),
    "a summary below": (HEAD + rows() + "\nperiod,decay\n1.25,33\n0.01,2\n", "2 lines (the first 304) below"),
    "a note with a comma below the header": (HEAD + "by Anna, Ben\n" + rows(), ""),
    "names, short names and units": ("Vernier Format 2\nMy.cmbl 7/5/2019\nData Set\nTime\tAngle\nt\tA\ns\trad\n\n" + rows("\t"), ""),
    "units in brackets": ("time;angle\n(s);(rad)\n" + rows(";"), ""),
    "one quoted cell over all columns": ('"t_s,theta_rad"\n' + rows(), ""),
    "names between points": ("--- a wheel ---\nt_s.theta_rad\n" + rows("\t"), ""),
    "names of uncertainties that are not there": ("t_s theta_rad dt dtheta\n" + rows(" "), ""),
    "a remark beside names in a comment": ("# t_s theta_rad | from a web page\n" + rows(" "), ""),
    "an oscilloscope's channel above the names": ("x-axis,4\nsecond,theta_rad\n" + rows(), ""),
    "a comment sign of Matlab": ("% t_s theta_rad\n% by hand\n" + rows(" "), ""),
    "a comment sign of C": ("// board 3\n// t_s, theta_rad\n" + rows(), ""),
    "an index before each row": (
        ",t_s,theta_rad\n" + "".join(f"{k},{row}\n" for k, row in enumerate(rows().splitlines())), "",
    ),
    "rows that were taken for one cell each": ('"' + (HEAD + rows()).strip().replace("\n", '"\n"') + '"\n', ""),
    "exponents of Fortran": (HEAD + "".join(f"{t:.6E},{x:.6E}\n" for t, x in zip(TIME, SWING, strict=True)).replace("E", "D"), ""),
    "a clock of twelve hours": (
        "clock,theta_rad\n" + "".join(f"{pd.Timestamp('2024-03-05 11:59:51') + pd.Timedelta(milliseconds=round(1000 * t)):%I:%M:%S.%f %p},{x:.5f}\n" for t, x in zip(TIME, SWING, strict=True)), "",
    ),
    "a row with a cell more": (HEAD + rows(stop=200) + "9.999,0.1,0.2\n" + rows(start=200), "line 202 has more cells"),
}  # fmt: skip


def whole(content):
    """The one table of a file, and its columns in full."""
    table = table_of(io.BytesIO(content.encode()), {"file": "swing.csv"})
    return table, np.concatenate([piece.to_numpy() for piece in table.pieces]).T


@pytest.mark.parametrize("what", FOUND)
def test_the_table_is_found_and_what_was_left_out_is_told(take, what):
    content, told = FOUND[what]
    made = take(content)
    np.testing.assert_array_equal(made["time"].values, TIME)
    np.testing.assert_array_equal(made["signal"].values, SWING)
    assert made["signal"].attrs["units"] == "rad" and "no unit" not in made.attrs["taken"]
    assert told in made.attrs.get("remarks", "") and (told or "remarks" not in made.attrs)


def test_a_line_that_lost_its_start_is_a_missing_sample(take):
    spoilt = rows(start=250, stop=251)[1:]  # 12.500 becomes 2.500
    made = take(HEAD + rows(stop=250) + spoilt + rows(start=251))
    np.testing.assert_allclose(made["time"].values, np.delete(TIME, 250))
    assert "in 1 of 300 rows the time alone jumps back" in made.attrs["remarks"]


@pytest.mark.parametrize("separator", [" ", "\t", ","])
def test_a_header_that_lost_its_end_names_the_columns(take, separator):
    made = take(f"t_s{separator}theta_rad{rows(separator)}")
    np.testing.assert_array_equal(made["time"].values, TIME[1:])
    assert (
        "`theta_rad` as rad" in made.attrs["taken"] and "stands in the header's line" in made.attrs["taken"]
    )


@pytest.mark.parametrize("piece", [150, 1000])
@pytest.mark.parametrize("what", FOUND)
def test_a_table_is_the_same_in_pieces_of_any_size(monkeypatch, what, piece):
    _, columns = whole(FOUND[what][0])
    monkeypatch.setattr("swingdown.measurement.files.text.PIECE", piece)
    _, again = whole(FOUND[what][0])
    np.testing.assert_array_equal(columns, again)


@pytest.mark.parametrize(
    ("between", "second"),
    [
        ("", HEAD + rows()),
        ("\n\n", HEAD + rows()),
        ("\n", rows()),
        ("Run 2\n", rows()),
        ("\nof the second pendulum\n", "t_s,x,y\n" + "".join(f"{row},1\n" for row in rows().splitlines())),
        ("\n", "t_s,omega_rad\n" + "".join(f"{row}\n" for row in rows().splitlines())),
    ],
)
def test_a_table_below_another_is_a_recording_of_its_own(between, second):
    found = tables(io.BytesIO((HEAD + rows() + between + second).encode()), {"file": "swing.csv"})
    assert list(found) == ["table 1", "table 2"]
    for table in found.values():
        part = np.concatenate([piece.to_numpy() for piece in table.pieces]).T
        np.testing.assert_array_equal(part[0], TIME)
        np.testing.assert_array_equal(part[1], SWING)
    assert found["table 1"].names == ("t_s", "theta_rad")


def test_a_table_below_another_is_taken_by_its_name(take):
    made = take("Run 1\n" + HEAD + rows(stop=150) + "\nRun 2\n" + HEAD + rows(), run="table 2")
    np.testing.assert_array_equal(made["signal"].values, SWING)


def test_two_data_sets_of_vernier_are_two_recordings():
    one = "Vernier Format 2\nMy.cmbl 7/5/2019 9:37:43\nData Set\nTime\tAngle\nt\tA\ns\trad\n\n" + rows("\t")
    found = tables(io.BytesIO((one + "\n" + one).encode()), {"file": "swing.txt"})
    assert [table.names for table in found.values()] == [("Time (s)", "Angle (rad)")] * 2


@pytest.mark.parametrize("form", ["{clock} -> {raw}", "[{clock}] {raw}", "[{clock}] -> {raw}"])
@pytest.mark.parametrize("late", [False, True])
def test_a_serial_monitors_log(form, late):
    table, columns = whole("12:03:10.998 -> Ready.\n" + monitor(form, late))
    assert table.names == ("time (s)", "raw") and table.units == {"time (s)": "s"}
    assert columns[0].astype(float) == pytest.approx(TIME, abs=1e-9)
    np.testing.assert_array_equal(columns[1].astype(float), np.round(512 + 400 * SWING))


def test_a_serial_monitors_log_of_a_board_with_a_clock_of_its_own():
    table, columns = whole("12:03:10.998 -> millis,adc\n" + monitor("{clock} -> {t},{raw}"))
    assert table.names == ("arrival", "millis", "adc") and not table.units
    np.testing.assert_array_equal(columns[1].astype(float), np.round(1000 * TIME))


def test_dates_and_times_of_day_are_times(take):
    stamps = np.datetime64("2024-05-01T23:59:55") + np.round(1e6 * TIME).astype("timedelta64[us]")
    for between in ("T", " "):
        lines = [f"{str(one).replace('T', between)},{x}" for one, x in zip(stamps, SWING, strict=True)]
        made = take("Timestamp,angle (rad)\n" + "\n".join(lines))
        assert made["time"].values == pytest.approx(TIME, abs=1e-9)
        assert "`Timestamp` as s" in made.attrs["taken"] and "times of day" in made.attrs["taken"]


def test_a_devices_own_time_goes_before_a_computers(take):
    stamps = monitor("{clock}").split()
    lines = [f"{stamp}, {row}" for stamp, row in zip(stamps, rows(", ").splitlines(), strict=True)]
    made = take("Timestamp, Elapsed (s), Angle (rad)\n-----\n" + "\n".join(lines))
    assert "`Elapsed (s)` as s" in made.attrs["taken"]
    np.testing.assert_array_equal(made["signal"].values, SWING)


def test_units_that_contradict_each_other_are_refused(take):
    with pytest.raises(
        InputError, match=r"column angle \(rad\): its name says 'rad' and the line below says 'deg'"
    ):
        take("t (s),angle (rad)\ns,deg\n" + rows())
    assert take("t (s),angle (rad)\ns,radians\n" + rows())["signal"].attrs["units"] == "rad"


def test_rows_of_more_cells_than_columns_are_another_way_of_writing(take):
    with pytest.raises(InputError, match="line 203: it is not a table: the row has more cells"):
        take(HEAD + rows(stop=200) + "1,000.0,0.5\n1,000.1,0.4\n" + rows(start=200))


def test_one_number_a_line_needs_a_rate(take):
    content = "Ready\n" + "\n".join(map(str, SWING)) + "\n"
    with pytest.raises(InputError, match="in the cell rate_hz of the sheet"):
        take(content)
    made = take(content, rate_hz=20)
    assert made["time"].values == pytest.approx(TIME)
    np.testing.assert_array_equal(made["signal"].values, SWING)


def test_columns_without_a_time_take_the_rate():
    lines = "".join(f"{k},{x}\n" for k, x in enumerate(SWING))
    table = table_of(io.BytesIO(("frame,angle\n" + lines).encode()), {"file": "a.csv", "rate_hz": 20})
    assert table.names == ("time (s)", "frame", "angle")
    part = next(iter(table.pieces))
    assert part["time (s)"].to_numpy() == pytest.approx(TIME)
    for content in (HEAD + rows(), rows(), monitor("{clock} -> {raw}")):
        with pytest.raises(InputError, match="column rate_hz"):
            table_of(io.BytesIO(content.encode()), {"file": "a.csv", "rate_hz": 20})


def test_a_line_that_is_no_number_takes_its_time():
    lines = [*map(str, SWING[:100]), "overrun", *map(str, SWING[101:])]
    table = table_of(io.BytesIO("\n".join(lines).encode()), {"file": "a.csv", "rate_hz": 20})
    part = pd.concat(list(table.pieces))
    assert part["time (s)"].to_numpy() == pytest.approx(np.delete(TIME, 100))
    assert "line 101 between the rows" in table.remarks[0]


def test_a_separator_that_ends_each_line_is_no_name():
    """As a video program writes it: names of several words, decimal commas, and a `;` behind the last column."""
    sizes = [f"{name}{axis} [{unit}]" for name, unit in (("Abstand", "mm"), ("Strecke", "mm"), ("Geschwindigkeit", "mm/s"), ("Beschleunigung", "mm/s²")) for axis in ("", " in x-Richtung", " in y-Richtung")]  # fmt: skip
    names = [
        "Bildnummer",
        "Zeit [s]",
        "Pixel (X) [px]",
        "Pixel (Y) [px]",
        "X Position [mm]",
        "Y Position [mm]",
        *sizes,
    ]
    table = "".join(f"{';'.join([str(k), f'{t:.3f}', *[f'{x:.5f}'] * 16])};\n".replace(".", ",") for k, (t, x) in enumerate(zip(TIME, SWING, strict=True)))  # fmt: skip
    read = table_of(io.BytesIO((";".join(names) + ";\n" + table).encode()), {"file": "film.csv"})
    assert list(read.names[:18]) == names


def test_a_second_stamp_is_no_swing():
    """As a robot's log has it: the time of the arrival, that of the message, then what swings."""
    head, start = "__time,/joints/header/stamp,/joints/arm/position\n", 1.7e9
    lines = (f"{start + t:.6f},{start + t - 0.0003:.6f},{x:.5f}\n" for t, x in zip(TIME, SWING, strict=True))
    _, swing = choose(
        table_of(io.BytesIO((head + "".join(lines)).encode()), {"file": "log.csv"}).names, "", "", "log.csv"
    )
    assert [one.name for one in swing] == ["/joints/arm/position"]


# an uneven clock: from row to row its steps rise and fall
PASSED = np.append(0.0, np.random.default_rng(3).integers(40, 60, 299)) / 1000
UNEVEN = np.cumsum(PASSED)
UNEVEN_SWING = 0.4 * np.exp(-0.03 * UNEVEN) * np.cos(5 * UNEVEN)


def columns(header, *values):
    return (
        header
        + "\n"
        + "".join(",".join(f"{one:.6g}" for one in row) + "\n" for row in zip(*values, strict=True))
    )


@pytest.mark.parametrize(
    "name", ["time_from_previous_sample(ms)", "dt (ms)", "delta_t_ms", "Time since last row (ms)"]
)
@pytest.mark.parametrize("piece", [500, 1 << 20])
def test_what_passed_since_the_row_before_is_summed(take, monkeypatch, name, piece):
    monkeypatch.setattr("swingdown.measurement.files.text.PIECE", piece)
    made = take(columns(f"theta_rad,{name}", UNEVEN_SWING, 1000 * PASSED))
    np.testing.assert_allclose(made["time"].values, UNEVEN, atol=1e-9)
    np.testing.assert_allclose(made["signal"].values, UNEVEN_SWING, atol=1e-6)
    assert "its running sum is the time" in made.attrs["remarks"]


@pytest.mark.parametrize("header", ["dt,t_s,theta", "delta t (s),time (s),theta"])
def test_a_clock_goes_before_what_passed_since_the_row_before(take, header):
    made = take(columns(header, PASSED, UNEVEN, UNEVEN_SWING))
    np.testing.assert_allclose(made["time"].values, UNEVEN, atol=1e-5)
    assert "running sum" not in made.attrs.get("remarks", "")


def test_a_clock_that_is_called_dt_is_one(take):
    made = take(columns("dt (s),theta_rad", UNEVEN, UNEVEN_SWING))
    np.testing.assert_allclose(made["time"].values, UNEVEN, atol=1e-5)


def test_what_runs_back_and_forth_is_no_clock(take):
    with pytest.raises(InputError, match=r"no time: it falls at \d\d %") as caught:
        take(columns("t (ms),theta_rad", 1000 * PASSED, UNEVEN_SWING))
    assert "rate_hz" in caught.value.mend


@pytest.mark.parametrize(
    "above",
    [
        "X,theta_rad,Start,Increment,\nSequence,rad,0.0e+00,5.0e-02,\n{k},{x:.5f},,\n",
        "Delta_X\t0.05\n\nX_Value\ttheta_rad\tComment\n\t{x:.5f}\t\n",
        "Sample Rate: 20 Hz. Values on a linear scale.\n\ntheta_rad\n{x:.5f}\n",
    ],
)
def test_the_rate_that_a_file_states_stands_for_its_times(take, above):
    *head, row = above.splitlines()
    made = take("\n".join([*head, *(row.format(k=k, x=x) for k, x in enumerate(SWING)), ""]))
    np.testing.assert_allclose(np.diff(made["time"].values), 0.05)
    np.testing.assert_array_equal(made["signal"].values, SWING)


QTM = "NO_OF_FRAMES\t300\nFREQUENCY\t20\nANALOG_FREQUENCY\t0\nDATA_INCLUDED\t3D\nMARKER_NAMES\tbob\n"


@pytest.mark.parametrize(
    "head",
    [
        QTM,
        "SAMPLE_RATE\t20\n",
        "Sampling Rate\t20\nName\tbob\n",
        "SamplingRate\t20 Hz\n",
        "fps\t20\n",
        "Frame rate\t20\n",
    ],
)
def test_a_rate_beside_its_name_above_the_rows_makes_their_times(take, head):
    made = take(head + "theta_rad\tz\n" + "".join(f"{x:.9f}\t{x**2:.5f}\n" for x in SWING))
    np.testing.assert_allclose(np.diff(made["time"].values), 0.05)
    np.testing.assert_allclose(made["signal"].values, SWING, atol=1e-9)
    assert "20.0 samples a second, tabs at 20 Hz" in made.attrs["taken"]


@pytest.mark.parametrize(
    "head", ["Frequency\t0.67\n", "FREQUENCY: 0.67\n", "ANALOG_FREQUENCY\t1000\n", "FREQUENCY\t0\n"]
)
def test_a_frequency_that_may_be_another_makes_no_times(take, head):
    with pytest.raises(InputError, match="cannot be the time"):
        take(head + "theta_rad\tz\n" + "".join(f"{x:.9f}\t{x**2:.5f}\n" for x in SWING))


def test_coordinates_may_stand_behind_the_name_of_what_was_followed():
    _, found = choose(["Time (ms)", "Bob/0/X", "Bob/0/Y"], "", "", "")
    assert [one.name for one in found] == ["Bob/0/X", "Bob/0/Y"]


def test_settings_beside_the_rows_are_no_columns(take):
    beside = ["Record Length,2.5e+03,", "Source,CH1,", "Vertical Units,V,", *[",,"] * 297]
    text = "".join(f"{own},{row},\n" for own, row in zip(beside, rows().splitlines(), strict=True))
    made = take(text, scale="relative")
    assert "`column 5` as volts" in made.attrs["taken"]  # as the settings state
    np.testing.assert_array_equal(made["signal"].values, SWING)
    assert "next to no numbers: left out" in made.attrs["remarks"]


def test_x_y_and_z_on_no_circle_may_be_an_acceleration(take):
    y = 0.1 * np.exp(-0.03 * TIME) * np.cos(10 * TIME + 1) + 0.05 * np.random.default_rng(2).standard_normal(
        300
    )
    with pytest.raises(InputError, match="positions of a bob, its acceleration"):
        take(columns("t (s),X,Y,Z", TIME, SWING, y, 9.8 + SWING**2))
    with pytest.raises(InputError, match="positions of a bob, its acceleration"):
        take(columns("t (s),X,Y,Z", TIME, 9.8 - 4 * SWING**2, 1e-3 * y, 9.8 * SWING))
    assert "one coordinate" in take(columns("t (s),X,Y", TIME, SWING, y)).attrs["remarks"]


@pytest.mark.parametrize(
    ("zero", "words"), [(9.85, "swings about 9.8.* accelerometer"), (40.0, "of one side stay where they are")]
)
def test_what_a_bob_does_twice_a_period_is_asked_about(take, zero, words):
    long = np.arange(1200) / 20
    swing = 0.4 * np.exp(-0.01 * long) * np.cos(5 * long)
    values = zero + swing if zero < 10 else zero - 2 * swing**2
    with pytest.raises(InputError, match=words):
        take(columns("t (s),data", long, values))
    assert take(columns("t (s),data (rad)", long, zero + swing))["signal"].size == 1200


@pytest.mark.parametrize("header", ["Sample,Distance (cm)", "Sampleid,Distance"])
def test_with_a_rate_what_counts_the_rows_is_no_swing(take, header):
    rows = "".join(f"{k},{20 + 2 * x:.4f}\n" for k, x in enumerate(SWING))
    with pytest.raises(InputError, match="counts frames or samples"):
        take(f"{header}\n{rows}")
    recording = take(f"{header}\n{rows}", rate_hz=20)
    assert "`Distance" in recording.attrs["taken"]
    assert "counts the rows: left out" in recording.attrs["remarks"]


@pytest.mark.parametrize("header", ["ID,Value,Timestamp", "ID,Value,TM"])
def test_rows_with_the_last_one_first_have_their_own_time(take, header):
    """Their number falls as well, by more than one where a row was lost."""
    kept = np.delete(np.arange(len(SWING)), [50, 120, 121])
    rows = [f"{k},{SWING[k]:.4f},{1_492_543_854_411 + 50 * k}\n" for k in kept[::-1]]
    recording = take(f"{header}\n" + "".join(rows))
    assert "`Value`" in recording.attrs["taken"] and header.rpartition(",")[2] in recording.attrs["taken"]
    assert np.ptp(recording["time"].values) == pytest.approx(0.05 * (len(SWING) - 1))


def test_a_sentence_between_rows_names_no_columns(take):
    """Of ten swings at a time by hand, first two pendulums side by side and then one below the other."""
    text = "T1\tT2\n9.94\t9.4\n9.34\t9.57\n9.26\t9.38\n\nIn step\n" + "".join(
        f"{9.5 + 0.01 * k:.2f}\n" for k in range(40)
    )
    with pytest.raises(InputError, match="column T2: 40 of 43 cells"):
        take(text)
