"""Files as other programs export them, named in a sheet of two columns: read as they are meant, or refused with the mend."""

import numpy as np
import pytest

from swingdown.errors import InputError
from swingdown.measurement import series
from swingdown.measurement.columns import meaning
from swingdown.measurement.recording import ingest
from swingdown.measurement.sheet import read_sheet

TIME = np.arange(600) / 60
SWING = 0.4 * np.exp(-0.03 * TIME) * np.cos(7 * TIME + 0.1)


@pytest.fixture
def take(tmp_path, monkeypatch):
    """A function that writes bytes as a file and ingests it by a sheet that says no more than its name."""
    monkeypatch.chdir(tmp_path)

    def take(content, file="swing.csv", encoding="utf-8", **cells):
        if content is not None:
            (tmp_path / file).write_bytes(content if isinstance(content, bytes) else content.encode(encoding))
        cells = {"recording": "a", "file": file, **cells}
        (tmp_path / "sheet.csv").write_text(
            ",".join(cells) + "\n" + ",".join(map(str, cells.values())) + "\n"
        )
        return ingest(read_sheet("sheet.csv").loc["a"], "sheet.csv")

    return take


def rows(*columns, separator=",", comma=False, digits=6):
    lines = [separator.join(f"{x:.{digits}f}" for x in row) + "\n" for row in zip(*columns, strict=True)]
    text = "".join(lines)
    return text.replace(".", ",") if comma else text


def video(angle=SWING, tilt=0.0):
    """x and y in m about a pivot at (0.31, 1.2) on an arm of 0.8 m."""
    return 0.31 + 0.8 * np.sin(angle + tilt), 1.2 - 0.8 * np.cos(angle + tilt)


# What each program writes: text, encoding, and the unit in which the swing stands in it.
EXPORTS = {
    # Tracker: a line with the track's name, then the header without units; tabs; the decimal sign of the country
    "tracker": ("mass A\t\t\nt\tx\ty\n" + rows(TIME, *video(), separator="\t", comma=True), "utf-8", "rad"),
    # phyphox, "CSV (semicolon, decimal comma)": quoted names with units
    "phyphox": (
        '"Time (s)";"Angle (°)"\n' + rows(TIME, np.degrees(SWING), separator=";", comma=True),
        "utf-8",
        "deg",
    ),
    # phyphox, the gyroscope's raw data: three axes and how fast it turns in all, of which one is the pendulum's
    "phyphox_gyroscope": (
        '"Time (s)";"Gyroscope x (rad/s)";"Gyroscope y (rad/s)";"Gyroscope z (rad/s)";"Absolute (rad/s)"\n'
        + rows(TIME, 0.01 * SWING, 0.02 * SWING, SWING, np.abs(SWING), separator=";", comma=True),
        "utf-8",
        "rad/s",
    ),
    # Logger Pro and Graphical Analysis: the data set's name before each column
    "logger_pro": (
        "Latest: Time (s),Latest: Angle (°)\r\n" + rows(TIME, np.degrees(SWING)).replace("\n", "\r\n"),
        "latin-1",
        "deg",
    ),
    "graphical_analysis": (
        "Data Set 1:Time(s)\tData Set 1:Angle(rad)\n" + rows(TIME, SWING, separator="\t"),
        "utf-8-sig",
        "rad",
    ),
    # PASCO Capstone: the run's number in each name
    "capstone": (
        "Time (s) Run #1,Angular Velocity (rad/s) Run #1,Angle (rad) Run #1\n"
        + rows(TIME, np.gradient(SWING, TIME), SWING),
        "utf-16",
        "rad",
    ),
    "arduino": ("millis,angle_deg\n" + rows(1000 * TIME, np.degrees(SWING)), "utf-8", "deg"),
    "arduino_without_header": (rows(TIME, SWING, separator="\t"), "utf-8", "rad"),
    "spaces": ("t/s theta/rad\n" + rows(TIME, SWING, separator="  "), "utf-8", "rad"),
    "savetxt": ("# t_s theta_rad\n" + rows(TIME, SWING, separator=" "), "utf-8", "rad"),
    "units_below": (
        "time;angle\nms;deg\n" + rows(1000 * TIME, np.degrees(SWING), separator=";"),
        "utf-8",
        "deg",
    ),
    "quoted": (
        '"Zeit (s)","Winkel [rad]"\n'
        + "".join(f'"{t:.6f}","{x:.6f}"\n'.replace(".", ",") for t, x in zip(TIME, SWING, strict=True)),
        "latin-1",
        "rad",
    ),
}


@pytest.mark.parametrize("program", EXPORTS)
def test_exports_are_read_as_they_are_meant(take, program):
    text, encoding, unit = EXPORTS[program]
    made = take(text, encoding=encoding)
    assert made.signal.attrs["units"] == unit
    factor = np.pi / 180 if unit == "deg" else 1
    assert made.sizes["time"] == len(TIME)
    assert made["time"].values == pytest.approx(TIME, abs=2e-6)
    assert made["signal"].values * factor == pytest.approx(SWING, abs=2e-5)
    assert "60.0 samples a second" in made.attrs["taken"]


def test_what_was_taken_is_told_in_one_line(take):
    text, *_ = EXPORTS["phyphox"]
    assert take(text).attrs["taken"] == (
        "took `Angle (°)` as degrees, `Time (s)` as s, 60.0 samples a second, `;`, decimal comma"
    )
    assert "no unit is stated" in take(rows(TIME, SWING)).attrs["taken"]
    assert take(rows(TIME, SWING)).attrs["taken"].endswith("no header")
    assert "Latin-1" in take(EXPORTS["logger_pro"][0], encoding="latin-1").attrs["taken"]


def test_the_sheet_has_the_last_word(take):
    made = take("t (ms),Angle (°)\n" + rows(TIME, SWING), time_unit="s", signal_unit="rad")
    assert made["signal"].values == pytest.approx(SWING, abs=1e-6) and made["time"].values[-1] > 9
    made = take("t,a,b\n" + rows(TIME, TIME, SWING), signal_column="b")
    assert made["signal"].values == pytest.approx(SWING, abs=1e-6)


@pytest.mark.parametrize(
    ("header", "kind", "unit"),
    [
        ("Angle (°)", "an angle", "deg"),
        ("theta [rad]", "an angle", "rad"),
        ("θ", "an angle", ""),
        ("theta_rad", "an angle", "rad"),
        ("angle_deg", "an angle", "deg"),
        ("Latest: Angle (º)", "an angle", "deg"),
        ("t (ms)", "a time", "ms"),
        ("t/s", "a time", "s"),
        ("millis", "a time", "ms"),
        ("Time (µs)", "a time", "us"),
        ("Gyroscope z (rad/s)", "an angular rate", "rad/s"),
        ("Gyroscope z (°/s)", "an angular rate", "deg/s"),
        ("Gyroscope z (rpm)", "an angular rate", ""),
        ("Angular velocity", "an angular rate", ""),
        ("Temperature (°C)", "something else", ""),
        ("x (m)", "a length", ""),
        ("Potential (mV)", "a voltage", ""),
        ("voltage_V", "a voltage", "V"),
        ("angle (filtered)", "an angle", ""),
        ("signal", "", ""),
    ],
)
def test_what_a_header_says(header, kind, unit):
    assert (meaning(header).kind, meaning(header).unit) == (kind, unit)


@pytest.mark.parametrize(
    ("header", "told"),
    [
        (
            "Time (s),Gyroscope z (rpm)",
            [
                "Gyroscope z (rpm)",
                "an angular rate in 'rpm' is no angle and no rate in a unit known here",
                "deg/s",
            ],
        ),
        ("Time (s),Temperature (°C)", ["'°C'", "is no angle"]),
        (
            "Time (s),Linear Acceleration x (m/s^2)",
            ["an acceleration in 'm/s^2' is no angle", "record the gyroscope"],
        ),
        ("t (s),U (V)", ["recordings in volts need one", "docs/calibrate.md"]),
        ("t,y", ["column y", "the height of a bob", "x too"]),
        ("t (s),x (m)", ["column x (m)", "one coordinate", "cell length"]),
        ("t (s),lap (s)", ["lap (s)", "a time in 's' is no angle"]),
        ("t (s),phi (gon)", ["'gon'", "convert it to rad or deg"]),
        ("t (min),phi (rad)", ["'min'", "s, ms or us"]),
        ("x (m),phi (rad)", ["cannot be the time"]),
    ],
)
def test_what_cannot_be_an_angle_is_refused_by_name(take, header, told):
    with pytest.raises(InputError) as caught:
        take(header + "\n" + rows(TIME, SWING))
    for part in (*told, "swing.csv", "Expected:", "Mend:"):
        assert part in str(caught.value), str(caught.value)


BROKEN = {
    "a picture": lambda text: b"\x89PNG\r\n\x1a\n\x00\x00\x00\rIHDR",
    "empty": lambda text: "",
    "blank": lambda text: "\n \n\n",
    "a workbook": lambda text: b"PK\x03\x04\x14\x00\x06\x00",
    "its program's own document": lambda text: '<?xml version="1.0"?>\n<document/>\n',
    "another header": lambda text: text + text,
}

# What is spoilt of a sample or two, and what is told: the others are read as they stand.
SPOILT = {
    "a cell more": lambda text: edit(text, 50, lambda cells: [*cells, "1"]),
    "a lost line end": lambda text: edit(text, 50, lambda cells: [*cells, *cells]),
    "an empty line inside": lambda text: edit(text, 50, lambda cells: [""]),
    "a cell of text": lambda text: edit(text, 50, lambda cells: [*cells[:-1], "oops"]),
    "not a number": lambda text: edit(text, 50, lambda cells: [*cells[:-1], "NaN"]),
    "a cell less": lambda text: edit(text, 50, lambda cells: cells[:-1]),
    "thousands": lambda text: edit(text, 50, lambda cells: ["1.234,5", *cells[1:]]),
    "two rows exchanged": lambda text: exchange(text),
    "a row twice": lambda text: edit(text, 50, lambda cells: cells, again=True),
    "a row gone": lambda text: "".join(
        line for k, line in enumerate(text.splitlines(True)) if k not in (50, 51)
    ),
}


IN_THE_LAST_CELL = ("a cell of text", "not a number", "a cell less")
WORDS = {
    "two rows exchanged": "put in order of time",
    "a row twice": "repeat the time of another",
    "a row gone": "samples are missing",
}


def edit(text, number, change, again=False):
    lines = text.splitlines()
    separator = next(one for one in (";", "\t", ",", "  ", " ") if one in lines[number])
    changed = separator.join(change(lines[number].split(separator)))
    return "\n".join([*lines[:number], *([changed] * (2 if again else 1)), *lines[number + 1 :]]) + "\n"


def exchange(text):
    lines = text.splitlines(True)
    lines[50], lines[51] = lines[51], lines[50]
    return "".join(lines)


@pytest.mark.parametrize("how", BROKEN)
@pytest.mark.parametrize("program", [name for name in EXPORTS if name != "quoted"])
def test_a_broken_export_gives_no_number(take, program, how):
    text, encoding, _ = EXPORTS[program]
    with pytest.raises(InputError, match=r"swing\.csv.*Mend:"):
        take(BROKEN[how](text), encoding=encoding)


@pytest.mark.parametrize("how", SPOILT)
@pytest.mark.parametrize("program", [name for name in EXPORTS if name != "quoted"])
def test_of_an_export_spoilt_in_a_row_the_others_are_read_and_that_is_told(take, program, how):
    text, encoding, _ = EXPORTS[program]
    if (
        program == "phyphox_gyroscope" and how in IN_THE_LAST_CELL
    ):  # that is how fast it turns in all, which nothing is read from
        text = "".join(line.rpartition(";")[0] + "\n" for line in text.splitlines())
    whole = take(text, encoding=encoding)
    made = take(SPOILT[how](text), encoding=encoding)
    assert WORDS.get(how, "missing") in made.attrs["remarks"]
    lost = whole.sizes["time"] - made.sizes["time"]
    assert lost == {"two rows exchanged": 0, "a row twice": 0, "a row gone": 2}.get(how, 1)
    near = np.abs(made["time"].values[:, None] - whole["time"].values).min(axis=1)
    assert near.max() < 1e-5
    if program != "tracker":  # the angle of positions depends on all of them
        assert set(made["signal"].values) <= set(whole["signal"].values)


@pytest.mark.parametrize("program", EXPORTS)
def test_of_a_decimal_sign_of_the_other_kind_no_number_is_made(take, program):
    text, encoding, _ = EXPORTS[program]
    lines = text.splitlines(True)
    cells = lines[300]
    lines[300] = cells.replace(",", ".") if "." not in cells else cells.replace(".", ",")
    try:
        told = take("".join(lines), encoding=encoding).attrs["remarks"]
    except InputError as error:
        assert "swing.csv" in str(error)
    else:
        assert "missing" in told
    half = [line.replace(".", ",") if k % 2 else line.replace(",", ".") for k, line in enumerate(lines)]
    if program not in ("logger_pro", "capstone", "arduino", "quoted"):  # there the comma separates
        with pytest.raises(InputError, match="decimal"):
            take("".join(half), encoding=encoding)


@pytest.mark.parametrize("cut", range(1, 18))
@pytest.mark.parametrize("program", EXPORTS)
def test_a_file_cut_in_the_middle_of_a_row_keeps_only_whole_numbers(take, program, cut):
    text, encoding, unit = EXPORTS[program]
    whole = take(text, encoding=encoding)
    kept = text[: len(text) // 2]
    kept = kept[: kept.rindex("\n") + 1 + cut]
    try:
        made = take(kept, encoding=encoding)
    except InputError as error:
        # of quoted cells the last quote is lost, and then nothing tells where the cell ends
        assert any(words in str(error) for words in ("finite", "empty", "EOF inside string"))
        return
    n = made.sizes["time"]
    assert n > 250
    if program != "tracker":  # the angle of positions depends on all of them
        assert (made["signal"].values == whole["signal"].values[:n]).all()
    assert made["time"].values == pytest.approx(
        whole["time"].values[:n], abs=1e-5
    )  # rounded stamps are an even clock's


def test_a_decimal_comma_between_commas_is_refused(take):
    with pytest.raises(InputError, match="the header names 2 column.s. and the rows have 4 cells"):
        take("t,angle\n" + rows(TIME, SWING, comma=True))


def test_the_first_row_is_not_taken_for_a_header_when_a_cell_is_spoilt(take):
    made = take("t_s,theta_rad\n0.0,oops\n" + rows(TIME[1:], SWING[1:]))
    assert (
        "1 of 600 cells of `theta_rad` hold no number (the first 'oops' in line 2)" in made.attrs["remarks"]
    )
    assert made.sizes["time"] == 599


def test_a_long_file_is_read_in_pieces_and_has_the_same_numbers(take, monkeypatch):
    text = "t_s;theta_rad\n" + rows(TIME, SWING, separator=";", comma=True)
    whole = take(text)
    monkeypatch.setattr("swingdown.measurement.text.PIECE", 150)
    made = take(text)
    assert made.identical(whole)
    spoilt = take(edit(text, 301, lambda cells: [cells[0], "oops"]))
    assert "the first 'oops' in line 302" in spoilt.attrs["remarks"]
    monkeypatch.setattr(series, "MOST", 300)
    with pytest.raises(InputError, match="more than 300 samples"):
        take(text)
    assert take(text, stop_s=2).sizes["time"] == 121


def test_a_line_without_end_is_no_table(take):
    with pytest.raises(InputError, match="no table"):
        take("1," * 100_000)


@pytest.mark.parametrize("tilt", [0.0, 0.3])
def test_positions_become_an_angle_about_a_fitted_pivot(take, tilt):
    draws = np.random.default_rng(3)
    x, y = video(tilt=tilt)
    x, y = x + 0.001 * draws.standard_normal(x.size), y + 0.001 * draws.standard_normal(x.size)
    made = take("t (s),x (m),y (m)\n" + rows(TIME, x, y))
    assert made["signal"].values == pytest.approx(SWING + tilt, abs=0.01)
    found = made.attrs
    for key, value in (("x", 0.31), ("y", 1.2), ("radius", 0.8)):
        assert abs(found[f"pivot_{key}"] - value) < 4 * found[f"pivot_u_{key}"] < 0.01
    assert found["pivot_residual"] == pytest.approx(0.001, rel=0.1)
    assert "the pivot was fitted" in found["remarks"]
    assert ("it swings about 0.3 rad" in found["remarks"]) == (tilt > 0)


def test_the_pivots_uncertainty_holds_it(take):
    """Two standard uncertainties hold the radius in 95 % of 400 draws (89 % would be six deviations away)."""
    from swingdown.measurement.positions import fit_circle

    draws, held = np.random.default_rng(8), 0
    for _ in range(400):
        x, y = (one + 0.002 * draws.standard_normal(one.size) for one in video())
        circle = fit_circle(x, y)
        held += abs(circle.radius - 0.8) < 1.96 * circle.u_radius
    assert 0.92 < held / 400 < 0.98


@pytest.mark.parametrize(
    ("x", "y"),
    [
        (np.random.default_rng(1).standard_normal(600), np.random.default_rng(2).standard_normal(600)),
        (np.ones(600), np.ones(600)),
    ],
)
def test_positions_on_no_arc_are_refused(take, x, y):
    with pytest.raises(InputError, match=r"columns x and y.*Mend"):
        take("t,x,y\n" + rows(TIME, x, y, digits=9))


@pytest.mark.parametrize("slope", [0.0, 0.5])
def test_positions_on_a_line_are_one_coordinate(take, slope):
    """A long pendulum's arc tells no pivot; of how far along it is period and decay are told."""
    made = take("t,x,y\n" + rows(TIME, 400 * SWING, 400 * slope * SWING))
    assert "the positions lie on a line" in made.attrs["remarks"] and made.attrs["scale"] == "unknown"
    along = made["signal"].values
    assert np.abs(np.corrcoef(along, SWING)[0, 1]) > 1 - 1e-9


def test_without_names_the_column_that_rises_is_the_time(take):
    made = take(rows(SWING, np.cos(TIME), TIME))
    assert "`column 3` alone rises" in made.attrs["remarks"]
    assert made["time"].values == pytest.approx(TIME, abs=1e-6)
    with pytest.raises(
        InputError, match="name the column of the angle in the cell signal_column of the sheet: column 1"
    ):
        take(rows(TIME, 1 + 0 * TIME, SWING))


def test_positions_without_names_are_asked_about(take):
    """Their second column is no angle, and taken for one it would give a number."""
    noise = 0.002 * np.random.default_rng(4).standard_normal((2, TIME.size))
    text = rows(TIME, *(np.array(video()) + noise), separator="\t")
    with pytest.raises(InputError, match=r"column 2 and column 3.*on a circle.*`t x y`"):
        take(text)
    assert "as positions" in take("t\tx\ty\n" + text).attrs["taken"]
    assert "`column 3` as rad" in take(text, signal_column="column 3").attrs["taken"]


def test_of_columns_without_names_the_second_is_taken_and_that_told(take):
    made = take(rows(TIME, SWING, np.gradient(SWING, TIME), np.cos(TIME)))
    assert "the file has 4 columns and no names of them: `column 2` was taken" in made.attrs["remarks"]
    assert made["signal"].values == pytest.approx(SWING, abs=1e-6)
    assert "remarks" not in take(rows(TIME, SWING)).attrs


def test_a_header_with_more_names_than_columns_is_refused(take):
    text = rows(TIME, SWING, separator=" ")
    with pytest.raises(InputError, match=r"line 1: the header names 4 column\(s\) and the rows have 2 cells"):
        take("t theta omega alpha\n" + text)
    assert "`theta`" in take("t theta dt dtheta\n" + text).attrs["taken"]
    assert "no header" in take("my third swing, the best\n" + text).attrs["taken"]
    assert "`theta_rad`" in take("t_s,theta_rad,\n" + rows(TIME, SWING)).attrs["taken"]


def test_of_a_graphs_columns_y_is_taken_over_x(take):
    errors = 0.017 + 0 * TIME, 0.01 + 0 * TIME
    for header in ("x,y,dx,dy", "X,Y,X',Y'"):
        made = take(header + "\n" + rows(TIME, SWING, *errors))
        assert made["signal"].values == pytest.approx(SWING, abs=1e-6)


@pytest.mark.parametrize("digits", [1, 2, 3])
def test_stamps_with_too_few_digits_are_those_of_an_even_clock(take, digits):
    made = take("t_s,angle_rad\n" + rows(np.round(TIME, digits), SWING))
    assert np.std(made["time"].values - TIME) < 0.01 * 10**-digits
    assert f"an even clock, rounded to {10 ** (3 - digits)} ms" in made.attrs["remarks"]


def test_a_header_with_spaces_above_rows_with_tabs(take):
    made = take("t_s theta_deg\n" + rows(TIME, np.degrees(SWING), separator="\t"))
    assert "took `theta_deg` as degrees, `t_s` as s" in made.attrs["taken"]


def test_missing_samples_are_told_in_a_line(take):
    kept = np.flatnonzero((np.arange(TIME.size) != 150) & (np.arange(TIME.size) != 400))
    made = take("t_s,angle_rad\n" + rows(TIME[kept], SWING[kept]))
    assert "2 of 600 samples are missing, the longest hole 0.017 s" in made.attrs["remarks"]
    assert made["signal"].values == pytest.approx(SWING[kept], abs=1e-6)
    seldom = np.sort(np.random.default_rng(2).choice(TIME.size, 300, replace=False))
    made = take("t_s,angle_rad\n" + rows(TIME[seldom], SWING[seldom]))
    assert made["time"].values == pytest.approx(TIME[seldom], abs=1e-6)


def test_pictures_count_y_downwards(take):
    x, y = video()
    made = take("frame,t,x (px),y (px)\n" + rows(np.arange(600), TIME, 500 * x, 900 - 500 * y))
    assert made["signal"].values == pytest.approx(SWING, abs=1e-5)


def test_a_netcdf_whose_units_contradict_the_sheet_is_refused(take, tmp_path):
    import xarray as xr

    def write(unit, time="s"):
        xr.Dataset(
            {"theta": ("t", np.degrees(SWING), {"units": unit})}, {"t": ("t", TIME, {"units": time})}
        ).to_netcdf(tmp_path / "raw.nc")

    write("degrees")
    assert take(None, "raw.nc", time_column="t", signal_column="theta").signal.attrs["units"] == "deg"
    with pytest.raises(InputError, match=r"sheet says 'rad' and the file says 'degrees' of 'theta'"):
        take(None, "raw.nc", time_column="t", signal_column="theta", signal_unit="rad")
    write("m")
    with pytest.raises(InputError, match=r"sheet says 'rad' and the file says 'm'"):
        take(None, "raw.nc", time_column="t", signal_column="theta", signal_unit="rad")
    write("degrees", "milliseconds")
    with pytest.raises(InputError, match=r"sheet says 's' and the file says 'milliseconds'"):
        take(None, "raw.nc", time_column="t", signal_column="theta", time_unit="s")


def test_stamps_with_three_figures_are_those_of_an_even_clock(take):
    times = 2.0 + np.arange(8000) / 30
    kept = np.delete(np.arange(8000), [61, 1000, 5000])
    swing = 0.5 * np.exp(-times / 200) * np.cos(2 * np.pi * times / 1.3)
    text = "".join(f"{t:.2E},{angle:.6f}\n" for t, angle in zip(times[kept], swing[kept], strict=True))
    made = take("t_s,angle_rad\n" + text)
    assert "an even clock, written with 3 figures" in made.attrs["remarks"]
    late = made["time"].values - times[kept]
    assert np.abs(late[:900]).max() < 1e-3
    assert np.abs(late).max() < 0.5 / 30 + 1 / 30 * 2  # a lost frame is seen where a stamp tells it


def test_rows_after_the_clock_has_stopped_are_left_out(take):
    times = np.concatenate([TIME, np.full(400, TIME[-1])])
    swing = np.concatenate([SWING, np.cos(np.arange(400) / 9)])
    made = take("t_s,angle_rad\n" + rows(times, swing))
    assert "THE CLOCK STOPS" in made.attrs["remarks"] and "last 400 rows" in made.attrs["remarks"]
    assert made["signal"].values == pytest.approx(SWING, abs=1e-6)


def test_a_column_without_a_name_is_called_by_its_number(take):
    with pytest.raises(InputError) as refused:
        take(rows(TIME, np.ones(TIME.size)))
    assert "column 2" in str(refused.value) and "column column" not in str(refused.value)


def test_of_columns_without_names_one_that_swings_twice_a_period_is_asked_about(take):
    with pytest.raises(InputError, match="twice as fast as the second.*signal_column"):
        take(rows(TIME, 900 + 100 * SWING**2, 50 + 40 * SWING))
    assert "`column 2`" in take(rows(TIME, SWING, 900 + 100 * SWING**2)).attrs["taken"]
