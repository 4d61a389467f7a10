"""Which of a file's columns is the swing, the time, a drive or an accelerometer: taken where the file says so, and asked about where not."""

import numpy as np
import pytest
from somebody import TIMES, TRUTH, holds_the_truth, swing, written

import swingdown
from swingdown.__main__ import main
from swingdown.engine.trajectory import simulate
from swingdown.errors import InputError
from swingdown.pendulum.model import Model
from swingdown.planning.own import Refused, take


def test_what_a_named_column_may_drive_is_asked_about(tmp_path, monkeypatch, capsys):
    """Even swings of one size have a motor's period; a file that holds the motor's voltage says so itself."""
    monkeypatch.chdir(tmp_path)
    times = np.arange(0, 30, 0.05)
    phase = 2 * np.pi * times / 2.7
    driven = 0.5 * np.sin(phase) + 0.03 * np.sin(3 * phase) + 0.08 * np.sin(2 * phase + 1)
    columns = times, driven, 2 + 0.5 * np.sin(phase + 1)
    alone = written(tmp_path / "alone.csv", "time (s),angle (rad)", *columns[:2])
    assert main([str(alone), "--quick", "--into", "one"]) == 0
    beside = written(tmp_path / "beside.csv", "time (s),angle (rad),Output Voltage (V)", *columns)
    with pytest.raises(SystemExit):
        main([str(beside), "--quick", "--into", "two"])
    told = capsys.readouterr().err
    assert "holds what may drive them: Output Voltage (V)" in told and "with --input" in told


@pytest.mark.parametrize("header", ["t,angle (rad)", "time,angle (rad)", ""])
def test_what_counts_the_rows_is_no_time(tmp_path, header):
    """Of ten samples a second it would tell a period ten times too long."""
    path = written(
        tmp_path / "a.csv",
        header,
        np.arange(400),
        simulate(Model("viscous", TRUTH), np.arange(400) / 10, 0.25),
    )
    with pytest.raises(InputError, match="it counts the rows, and no unit says") as caught:
        swingdown.read(path)
    assert "rate=" in caught.value.mend and "time_unit=" in caught.value.mend
    assert swingdown.read(path, time_unit="s").swings[0]["time"][-1] == 399


def test_a_number_of_the_sample_is_no_swing(tmp_path, first):
    """As a microcontroller logs it: a count, the time, the angle."""
    path = written(tmp_path / "a.csv", "n,t_ms,angle_deg", np.arange(900), 1e3 * TIMES, np.degrees(swing()))
    holds_the_truth(first(path))


def test_an_acceleration_swings_as_the_weight_on_its_spring_does(first, tmp_path):
    spring = Model("viscous", TRUTH, restoring="linear")
    seen = -9.81 - 0.5 * simulate(spring, TIMES, 1.0)
    path = written(tmp_path / "spring.csv", "Time (s),Ay (m/s²),F (N)", TIMES, seen, 0.2 * seen)
    with pytest.raises(InputError, match="name the column"):
        swingdown.read(path)
    for column in ("Ay (m/s²)", "F (N)"):
        row = first(path, "--restoring", "linear", "--column", column)
        assert row["period_s"] == pytest.approx(2 * np.pi / 6.2, rel=1e-4)


def test_a_refused_swing_of_several_columns_that_mean_the_same_names_them(tmp_path):
    draws = np.random.default_rng(4).standard_normal((2, TIMES.size))
    path = written(tmp_path / "two.csv", "time,theta0,theta1", TIMES, np.cumsum(draws[0]) / 40, swing())
    with pytest.raises(InputError, match="name the column .*theta0, theta1"):
        swingdown.read(path).fit()


@pytest.mark.parametrize(
    ("header", "rest", "widest", "words"),
    [
        ("t,a", 1.0, 0.3, "along the string reads in g"),
        ("", -1000.0, 0.3, "along the string reads in mg"),
        ("t,y", 1000.0, 0.3, "along the string reads in mg"),
        ("t,a", -1000.0, 1.0, "along the string reads in mg"),
        ("t,accel", 0.0, 0.3, "an acceleration is no angle"),
        ("t,acc_x", 0.0, 0.3, "an acceleration is no angle"),
        ("t,ax", 0.0, 0.3, "an acceleration is no angle"),
        ("t,gFx", 1.0, 0.3, "an acceleration is no angle"),
    ],
)
def test_an_accelerometer_along_the_string_is_asked_about(tmp_path, header, rest, widest, words):
    """It goes up and down twice a period: half of that would be told. A wide swing pulls by more than the weight in the middle."""
    angle = simulate(Model("viscous", TRUTH), TIMES, widest)
    rate = np.gradient(angle, TIMES)
    pull = np.cos(angle) + rate**2 / TRUTH["natural_frequency"] ** 2 + 1e-3 * np.sin(997 * TIMES)
    readings = pull * rest if rest else 9.81 * (pull - 1)
    with pytest.raises(InputError, match=words):
        swingdown.read(written(tmp_path / "a.csv", header, TIMES, readings))


def test_a_gyroscope_beside_an_accelerometer_is_the_swing(tmp_path, first):
    """A telephone's sensor suite writes the forces first, then the accelerations and the rates, none with a unit."""
    angle = swing()
    rate, still = np.gradient(angle, TIMES), 0.01 * np.cos(991 * TIMES)
    path = written(
        tmp_path / "a.csv", "time,gFx,ax,wx", TIMES, np.cos(angle), -9.81 * np.sin(angle) + still, rate
    )
    assert first(path)["natural_frequency_rad_per_s"] == pytest.approx(TRUTH["natural_frequency"], rel=0.005)


def test_three_axes_without_a_unit_are_asked_about(tmp_path):
    """What weight an accelerometer reads turns on a circle, as a bob does about its pivot."""
    angle = swing()
    columns = TIMES, np.sin(angle), -np.cos(angle), 0.01 * np.cos(991 * TIMES)
    with pytest.raises(InputError, match="positions of a bob, its acceleration, or rates"):
        swingdown.read(written(tmp_path / "a.csv", "time,x,y,z", *columns))
    stated = written(tmp_path / "b.csv", "time,x (m),y (m),z (m)", *columns)
    assert np.ptp(swingdown.read(stated).swings[0]["angle"].values) == pytest.approx(np.ptp(angle), rel=0.01)


def test_a_swing_about_one_degree_is_no_accelerometer(tmp_path, first):
    path = written(tmp_path / "a.csv", "t,a", TIMES, 1.0 + np.degrees(swing()))
    assert first(path)["natural_frequency_rad_per_s"] == pytest.approx(TRUTH["natural_frequency"], abs=0.01)


def test_where_one_part_of_a_file_asks_which_column_swings_none_is_taken_without(tmp_path):
    """An acceleration along the string, twice a swing, and one across it, which is clipped until the clock begins anew."""
    parts = []
    for stamps, size in ((np.arange(0, 1.5, 0.036), 0), (np.arange(0, 14.6, 0.036), 300)):
        noise, turned = (
            4 * np.random.default_rng(1).standard_normal((2, stamps.size)),
            2 * np.pi / 1.45 * stamps,
        )
        along, across = 900 + 80 * np.cos(2 * turned) + noise[0], size * np.sin(turned) + noise[1]
        parts += zip(stamps, along, across, strict=True)
    rows = "\n".join(f"{t:.3f},{along:.0f},{across:.0f},-80" for t, along, across in parts)
    (tmp_path / "board.csv").write_text(rows + "\n")
    row = {"recording": "board", "campaign": "board", "file": "board.csv"}
    found = take(row, tmp_path / "board.csv")
    assert len(found) == 2
    assert all(isinstance(one, Refused) and "twice as fast" in one.problem for one in found)
