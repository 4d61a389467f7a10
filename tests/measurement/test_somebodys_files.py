"""Files as other programs export them, named in a sheet of two columns: read as they are meant, or refused with the mend."""

import numpy as np
import pytest
from exports import EXPORTS, SWING, TIME, rows, video

from swingdown.errors import InputError


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
    ("header", "told"),
    [
        (
            "Time (s),Gyroscope z (1/s)",
            [
                "Gyroscope z (1/s)",
                "an angular rate in '1/s' is no angle and no rate in a unit known here",
                "deg/s",
            ],
        ),
        ("Time (s),Temperature (°C)", ["'°C'", "is no angle"]),
        (
            "Time (s),Linear Acceleration x (m/s^2)",
            ["an acceleration in 'm/s^2' is no angle", "record the gyroscope"],
        ),
        ("t (s),U (V)", ["recordings in volts need one", "docs/calibrate.md"]),
        ("t (s),lap (s)", ["lap (s)", "a time in 's' is no angle"]),
        ("t (s),phi (grad)", ["'grad'", "convert it to rad or deg"]),
        ("x (m),phi (rad)", ["cannot be the time"]),
    ],
)
def test_what_cannot_be_an_angle_is_refused_by_name(take, header, told):
    with pytest.raises(InputError) as caught:
        take(header + "\n" + rows(TIME, SWING))
    for part in (*told, "swing.csv", "Expected:", "Mend:"):
        assert part in str(caught.value), str(caught.value)


def test_an_encoder_that_writes_each_change_of_its_count_keeps_its_times(take):
    """Over even times the counts of a swing are straight lines, smoother than any swing."""
    fine = np.arange(0, 60, 1e-4)
    counts = np.round(100 * np.exp(-2e-4 * fine) * np.cos(2 * fine))
    at = np.flatnonzero(np.diff(counts)) + 1
    late = np.random.default_rng(1).normal(0, 2, at.size)  # its slits are uneven
    stamps = np.sort(np.round(1000 * fine[at] + late))
    made = take("n,msec,pos\n" + rows(np.arange(at.size), stamps, counts[at]))
    apart = 1000 * (made["time"].values[:, np.newaxis] - stamps[::50] / 1000)
    assert np.median(np.abs(apart).min(axis=0)) <= 1  # ms


def test_a_line_without_end_is_no_table(take):
    with pytest.raises(InputError, match="no table"):
        take("1," * 100_000)


def test_without_names_the_column_that_rises_is_the_time(take):
    made = take(rows(SWING, np.cos(TIME), TIME))
    assert "`column 3` alone rises" in made.attrs["remarks"]
    assert made["time"].values == pytest.approx(TIME, abs=1e-6)
    with pytest.raises(
        InputError, match="name the column of the angle in the cell signal_column of the sheet: column 1"
    ):
        take(rows(TIME, np.sqrt(TIME), SWING))


def test_of_columns_without_names_the_second_is_taken_and_that_told(take):
    made = take(rows(TIME, SWING, np.gradient(SWING, TIME), np.cos(TIME)))
    assert "the file has 4 columns and no names of them: `column 2` was taken" in made.attrs["remarks"]
    assert made["signal"].values == pytest.approx(SWING, abs=1e-6)
    assert "columns" not in take(rows(TIME, SWING)).attrs.get("remarks", "")


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
    with pytest.raises(InputError, match="twice as fast as an angle.*signal_column"):
        take(rows(TIME, 900 + 100 * SWING**2, 50 + 40 * SWING))
    assert "`column 2`" in take(rows(TIME, SWING, 900 + 100 * SWING**2)).attrs["taken"]


@pytest.mark.parametrize(("factor", "unit"), [(1, "rad/s"), (180 / np.pi, "deg/s")])
def test_of_a_rate_without_a_unit_it_is_the_one_that_a_pendulum_can_turn_in(take, factor, unit):
    made = take("time,angular_velocity\n" + rows(TIME, factor * np.gradient(SWING, TIME)))
    assert made["signal"].attrs["units"] == unit
    assert "angular_velocity" in made.attrs["taken"] and "no unit is stated" in made.attrs["taken"]


def test_where_no_column_rises_the_samples_a_second_are_asked_for(take):
    text = "x,y\n" + rows(SWING, 0.1 * np.cos(7 * TIME))
    with pytest.raises(InputError, match="none rises from row to row.*rate_hz"):
        take(text)
    assert take(text, rate_hz=60)["time"].values == pytest.approx(TIME)


def test_arbitrary_units_are_of_no_known_scale(take):
    made = take("Time (s),Angle Sensor (au)\n" + rows(TIME, 512 + 300 * SWING))
    assert (
        made["signal"].attrs["units"]
        == take("t,adc\n" + rows(TIME, 512 + 300 * SWING))["signal"].attrs["units"]
    )


def test_where_no_name_says_what_swings_a_refusal_names_the_other_columns(take):
    with pytest.raises(
        InputError,
        match="or name the column of the angle in the cell signal_column of the sheet: t, cart, bob",
    ):
        take("t,cart,bob\n" + rows(TIME, np.sqrt(TIME), SWING))


def test_cells_that_hold_a_pair_of_numbers_are_two_coordinates(take):
    pairs = [f'{t:.5f},"({x:.5f}, {y:.5f})",40\n' for t, x, y in zip(TIME, *video(), strict=True)]
    for cells in ({}, {"signal_column": "bob"}):
        made = take("t_s,bob,frame\n" + "".join(pairs), **cells)
        assert made["signal"].values == pytest.approx(SWING, abs=1e-3)
        assert "`bob x` and `bob y`" in made.attrs["taken"]


SHORT = "t (s);angle (rad)\n" + rows(TIME, SWING, 0.01 * SWING, separator=";")
LONG = "t (s),angle (rad),note,by whom\n" + rows(TIME, SWING)
NUMBERED = '"t","angle"\n' + "".join(
    f'"{k}",{t},{x}\n' for k, (t, x) in enumerate(zip(TIME, SWING, strict=True), 1)
)


@pytest.mark.parametrize(
    "text", [SHORT, LONG, NUMBERED], ids=["shorter", "longer", "without its row numbers"]
)
def test_a_header_of_another_size_names_the_columns_below_it(take, text):
    made = take(text)
    assert made["time"].values == pytest.approx(TIME, abs=2e-6)
    assert made["signal"].values == pytest.approx(SWING, abs=2e-6)
    with pytest.raises(InputError, match="the header names 2"):  # a decimal comma may be the separator
        take("t (s),angle (rad)\n" + rows(TIME, SWING).replace(".", ","))


@pytest.mark.parametrize("mark", [",", ".", " ", "'", "\u202f"])
def test_groups_of_three_digits_are_one_number(take, mark):
    """A clock in ms that passes 1000, as a spreadsheet shows it."""
    comma = mark == "."

    def cell(number, places):
        text = f"{number:,.{places}f}".replace(",", "_")
        return (text.replace(".", ",") if comma else text).replace("_", mark)

    lines = [f"{cell(1000 * t, 0)}\t{cell(1e5 * x, 2)}" for t, x in zip(TIME, SWING, strict=True)]
    made = take("t (ms)\treading\n" + "\n".join(lines) + "\n")
    assert "groups of digits" in made.attrs["taken"] and made.sizes["time"] == len(TIME)
    assert made["time"].values == pytest.approx(TIME, abs=1e-3)
    assert np.corrcoef(made["signal"].values, SWING)[0, 1] == pytest.approx(1, abs=1e-6)


def test_a_number_with_three_decimals_after_a_comma_is_no_thousand(take):
    """All of one column are 1 and more: are they 1.234 or 1234? The point in the other column says neither."""
    lines = [f"{t:.2f};" + f"{2 + x:.3f}".replace(".", ",") for t, x in zip(TIME, SWING, strict=True)]
    with pytest.raises(InputError, match="some numbers have a decimal point and others a decimal comma"):
        take("t;angle\n" + "\n".join(lines) + "\n")


def test_each_column_may_have_its_own_decimal_sign(take):
    """A script that read a phone's export wrote its times anew."""
    lines = [
        f"{t:.6f};{x:.6f};{2 * x:.4f}".replace(".", ",").replace(",", ".", 1)
        for t, x in zip(TIME, SWING, strict=True)
    ]
    made = take("time;angle (rad);twice\n" + "\n".join(lines) + "\n")
    assert "decimal comma in some columns" in made.attrs["taken"] and made.sizes["time"] == len(TIME)
    assert made["signal"].values == pytest.approx(SWING, abs=1e-6)
    lines[5] = lines[5].replace(",", ".")
    with pytest.raises(InputError, match="some numbers have a decimal point and others a decimal comma"):
        take("time;angle (rad);twice\n" + "\n".join(lines) + "\n")


@pytest.mark.parametrize("end", ["", "'"])
def test_a_spreadsheets_mark_for_text_is_no_part_of_a_number(take, end):
    lines = [f"'0:{int(t // 60)}:{t % 60:.9g}{end},'{x:.7f}{end}" for t, x in zip(TIME, SWING, strict=True)]
    made = take("time,angle_rad\n" + "\n".join(lines) + "\n")
    assert made["time"].values == pytest.approx(TIME, abs=2e-6)
    assert made["signal"].values == pytest.approx(SWING, abs=2e-6)


def test_of_two_columns_that_mean_the_same_a_refusal_names_both(take):
    text = "time,joint0/effort,joint0/position,joint1/position\n" + rows(TIME, 0 * TIME, 0.001 * TIME, SWING)
    with pytest.raises(InputError, match="name the column .*, joint0/position, joint1/position"):
        take(text)
    made = take(text, signal_column="joint1/position")
    assert made["signal"].values == pytest.approx(SWING, abs=2e-6)


def test_one_that_swings_and_was_passed_over_may_be_the_pendulum(take):
    both = rows(TIME, 3 + 40 * SWING, np.degrees(SWING))
    with pytest.raises(InputError, match="2 of its columns swing.*: x2, x"):
        take("t,x,x2\n" + both)
    made = take("t,x,x2\n" + both, signal_column="x2")
    assert made["signal"].values == pytest.approx(np.degrees(SWING), abs=1e-5)
    still = 5 + 1e-3 * np.random.default_rng(31).standard_normal(TIME.size)
    assert "`x2`" in take("t,x,x2\n" + rows(TIME, still, np.degrees(SWING))).attrs["taken"]
    assert "`x2`" in take("t,x2,x\n" + rows(TIME, np.degrees(SWING), 3 + 40 * SWING)).attrs["taken"]


def test_a_setting_in_a_comment_names_no_columns(take):
    error = np.full(TIME.size, 0.001)
    text = "# TAG = Amplitude_decay\n" + rows(TIME, SWING, error).replace(",", " ")
    assert "TAG" not in take(text).attrs["taken"] and "=" not in take(text).attrs["taken"]


def test_a_spreadsheets_days_are_seconds(take):
    made = take("time,angle (rad)\n" + rows(45_123.52 + TIME / 86_400, SWING, digits=11))
    assert np.ptp(made["time"].values) == pytest.approx(np.ptp(TIME), abs=1e-3)
    assert "days since 1900" in made.attrs["remarks"] and "`time` as DAYS" in made.attrs["taken"]
    with pytest.raises(InputError, match="no unit of the time is stated"):
        take("time,angle (rad)\n" + rows(0.52 + TIME / 86_400, SWING, digits=11))


def test_rounded_stamps_in_no_stated_unit_are_told_in_that_which_they_have(take):
    told = take("time,angle (rad)\n" + rows(np.round(1e3 * TIME), SWING)).attrs["remarks"]
    assert "rounded to 1 ms" in told and "TAKEN AS ms" in told


def test_of_a_bodys_angles_the_one_that_swings_is_taken(take):
    noise = 0.01 * np.random.default_rng(24).standard_normal((2, TIME.size))
    made = take("time,roll,pitch,yaw\n" + rows(TIME, noise[0], SWING, 3 + 0.2 * TIME + noise[1]))
    assert made["signal"].values == pytest.approx(SWING, abs=1e-6)
    assert "`roll` holds noise alone: left out; of 2 angles `pitch` swings" in made.attrs["remarks"]
    with pytest.raises(InputError, match="2 of its columns swing.*: roll, pitch"):
        take("time,roll,pitch,yaw\n" + rows(TIME, 0.3 * SWING, SWING, noise[1]))


@pytest.mark.parametrize(("factor", "warned"), [(1, False), (10, True)])
def test_a_period_of_no_room_is_told_where_nobody_states_the_unit_of_the_time(take, factor, warned):
    text = "time,angle (rad)\n" + rows(factor * TIME, SWING)
    assert ("NO UNIT OF THE TIME" in take(text).attrs.get("remarks", "")) == warned
    assert "NO UNIT OF THE TIME" not in take(text.replace("time", "time (s)")).attrs.get("remarks", "")


@pytest.mark.parametrize("rate", [47.3, 30.0, 61.7])
def test_stamps_of_a_clock_that_no_digit_divides_lose_no_sample_by_their_rounding(take, rate):
    times = np.arange(0, 40, 1 / rate)
    made = take("t_s,angle_rad\n" + rows(np.round(times, 2), 0.5 * np.exp(-times / 40) * np.cos(4.2 * times)))
    assert "rounded to 10 ms" in made.attrs["remarks"] and "samples" not in made.attrs["remarks"]
    assert np.std(made["time"].values - times) < 1e-4
