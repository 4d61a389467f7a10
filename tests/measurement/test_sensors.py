"""Files whose rows are of several sensors, each with the number of its pin: which sensor is taken, and what is asked."""

import numpy as np
import pytest

from swingdown.errors import InputError
from swingdown.measurement.files.runs import SeveralRuns
from swingdown.measurement.recording import ingest
from swingdown.measurement.sheet import COLUMNS

TIMES = 0.025 * np.arange(1600)
SWING = 500 + 140 * np.exp(-0.02 * TIMES) * np.cos(2 * np.pi * TIMES / 1.4)
REST = 461 + np.random.default_rng(3).integers(-1, 2, TIMES.size)


def taken(folder, head, *sensors, **cells):
    """The recording of a file in which sensors take turns, as a board writes its pins."""
    pins = 4 + np.arange(TIMES.size) % len(sensors)
    rows = [f"{pin}, {t:.3f}, {sensors[pin - 4][k]:.0f}" for k, (pin, t) in enumerate(zip(pins, TIMES, strict=True))]  # fmt: skip
    path = folder / "pins.csv"
    path.write_text("\n".join([f"# {head}", *rows, ""]))
    return ingest({**COLUMNS, "recording": "pins", "file": str(path), **cells})


@pytest.mark.parametrize("head", ["Pin number", "Sensor ID", "channel_no"])
def test_of_two_sensors_the_one_that_swings_is_taken(tmp_path, head):
    found = taken(tmp_path, f"{head}, Time [s], Position [a. u.]", SWING, REST)
    assert "`Position [a. u.]` as READINGS OF UNKNOWN SCALE" in found.attrs["taken"]
    assert f"`{head} 4` was taken of its sensors, as no other swings" in found.attrs["remarks"]
    assert found.sizes["time"] == TIMES.size / 2
    assert found["signal"].values[:3] == pytest.approx(SWING[:6:2], abs=0.6)


def test_two_sensors_that_swing_ask_which(tmp_path):
    head, other = "Pin number, Time [s], Position [a. u.]", 300 + 0.5 * (SWING - 500)
    with pytest.raises(SeveralRuns, match="its rows are of 2 sensors") as asked:
        taken(tmp_path, head, SWING, other)
    assert asked.value.names == ("Pin number 4", "Pin number 5")
    found = taken(tmp_path, head, SWING, other, run="pin number 5")
    assert found["signal"].values[:3] == pytest.approx(other[1:6:2], abs=0.6)
    with pytest.raises(InputError, match="there is no run 'pin 6'"):
        taken(tmp_path, head, SWING, other, run="pin 6")


def test_the_number_of_one_sensor_is_no_swing(tmp_path):
    found = taken(tmp_path, "Pin number, Time [s], Position [a. u.]", SWING)
    assert "`Position [a. u.]`" in found.attrs["taken"] and found.sizes["time"] == TIMES.size
    assert "sensors" not in found.attrs.get("remarks", "")


def test_the_readings_of_a_sensor_are_no_number_of_it(tmp_path):
    path = tmp_path / "readings.csv"
    path.write_text("\n".join(["t (s),sensor 1", *(f"{t:.3f},{one:.0f}" for t, one in zip(TIMES, SWING, strict=True)), ""]))  # fmt: skip
    found = ingest({**COLUMNS, "recording": "a", "file": str(path)})
    assert found["signal"].values[:3] == pytest.approx(SWING[:3], abs=0.6)


@pytest.mark.parametrize(("other", "told"), [(0.05, ""), (0.75, "75 % as much"), (0.75, "by about 20.0 %")])
def test_an_axis_beside_the_one_that_turns_most_tells_how_far_askew_it_lies(tmp_path, other, told):
    """By Pythagoras: 1 - 1 / sqrt(1 + 0.75^2) is a fifth."""
    rate = (SWING - 500) / 140
    path = tmp_path / "phone.csv"
    rows = [f"{t:.3f},{other * one:.5f},{one:.5f}" for t, one in zip(TIMES, rate, strict=True)]
    path.write_text("\n".join(["t (s),Gyroscope x (rad/s),Gyroscope y (rad/s)", *rows, ""]))
    remarks = ingest({**COLUMNS, "recording": "a", "file": str(path)}).attrs["remarks"]
    assert "`Gyroscope y (rad/s)` turns most" in remarks
    assert told in remarks if told else "askew" not in remarks


def in_turns(folder, labels, head="sensor", columns=(SWING, 300 + 0.5 * (SWING - 500)), **cells):
    """The recording of a file that has a row for each sensor at each time."""
    names = np.tile(labels, TIMES.size)
    readings = np.column_stack(columns).ravel()
    first = [f"{name}," for name in names] if head else [""] * names.size
    path = folder / "long.csv"
    rows = [f"{a}{t:.3f},{b:.1f}" for a, t, b in zip(first, np.repeat(TIMES, 2), readings, strict=True)]
    path.write_text("\n".join([f"{head + ',' if head else ''}t (s),reading", *rows, ""]))
    return ingest({**COLUMNS, "recording": "long", "file": str(path), **cells})


@pytest.mark.parametrize(
    ("labels", "head"), [((1, 2), "sensor"), (("left", "right"), "object"), (("a1", "b 2"), "who")]
)
def test_sensors_that_take_turns_are_told_apart_whatever_they_are_called(tmp_path, labels, head):
    with pytest.raises(SeveralRuns, match="its rows are of 2 sensors") as asked:
        in_turns(tmp_path, labels, head)
    assert asked.value.names == tuple(f"{head} {one}" for one in labels)
    found = in_turns(tmp_path, labels, head, run=f"{head} {labels[1]}")
    assert found["signal"].values[:3] == pytest.approx(300 + 0.5 * (SWING[:3] - 500), abs=0.1)
    assert found["time"].values[:3] == pytest.approx(TIMES[:3])


def test_of_two_in_turns_the_one_that_swings_is_taken(tmp_path):
    found = in_turns(tmp_path, ("imu", "temp"), columns=(SWING, REST))
    assert "`sensor imu` was taken of its sensors, as no other swings" in found.attrs["remarks"]
    assert found.sizes["time"] == TIMES.size


def test_series_in_turns_that_nothing_tells_apart_are_refused(tmp_path):
    with pytest.raises(InputError, match="2 series take turns in it, row by row"):
        in_turns(tmp_path, ("", ""), head="")
