"""Turning points as recorded, and as angles: units, scale, steps and uncertainties follow from the readings as worked out by hand."""

import numpy as np
import pytest

from swingdown.measurement.points.points_recording import COUNTED, PASSED, are_points, as_recording, to_angle
from swingdown.measurement.points.turning_points import points_in
from swingdown.measurement.recording import ingest
from swingdown.measurement.sheet import COLUMNS

HALVES = np.arange(24)
TIMES = np.round(0.7 * HALVES + 1, 2)  # s, to 10 ms
DEGREES = (-1) ** HALVES * np.repeat(
    np.arange(24, 12, -1) / 2, 2
)  # in steps of half a degree, each side read once


def recording(tmp_path, times=TIMES, readings=DEGREES, header="t (s),angle (deg)", more="", **cells):
    path = tmp_path / "points.csv"
    rows = [f"{t:.6g},{x:.6g}{more}" for t, x in zip(times, readings, strict=True)]
    path.write_text("\n".join([header, *rows, ""]))
    return ingest({**COLUMNS, "recording": "p", "campaign": "c", "file": str(path), **cells})


def test_degrees_become_rad_with_their_step_and_uncertainties(tmp_path):
    """A step of 0.5 degrees is pi / 360, a clock of 10 ms one of 0.01 s; half a percent within bounds is 0.5 % / sqrt(3)."""
    stated = {"clock_tolerance": 0.005}
    header = "t (s),angle (deg),error of t,error of angle"
    found = to_angle(recording(tmp_path, header=header, more=",0.02,0.25", **stated))
    np.testing.assert_allclose(found["angle"], DEGREES * np.pi / 180)
    np.testing.assert_array_equal(found["half_swings"], HALVES)
    np.testing.assert_allclose(found["time"], TIMES)
    about = found.attrs
    assert about["angle_step"] == pytest.approx(np.pi / 360)
    assert about["u_times"] == pytest.approx(0.02) and about["u_angles"] == pytest.approx(0.25 * np.pi / 180)
    assert about["clock_uncertainty"] == pytest.approx(0.005 / np.sqrt(3))
    assert about["points_unit"] == "rad" and about["points_scale"] == pytest.approx(180 / np.pi)
    assert about["recording"] == "p" and about["expected_samples"] == 24 and are_points(found)


def test_rad_stay_and_what_nobody_stated_is_no_number(tmp_path):
    found = to_angle(recording(tmp_path, readings=DEGREES / 50, header="t (s),angle (rad)"))
    np.testing.assert_allclose(found["angle"], DEGREES / 50)
    assert found.attrs["points_scale"] == 1 and found.attrs["angle_step"] == pytest.approx(0.01)
    assert np.isnan(found.attrs["u_times"]) and np.isnan(found.attrs["u_angles"])


def test_readings_of_a_length_are_made_small_and_the_scale_leads_back(tmp_path):
    """The largest becomes 0.01 rad, where weight pulls in proportion."""
    found = to_angle(recording(tmp_path, header="t (s),amplitude (cm)"))
    assert np.abs(found["angle"]).max() == pytest.approx(0.01) and found.attrs["points_unit"] == "cm"
    np.testing.assert_allclose(found["angle"] * found.attrs["points_scale"], DEGREES)
    assert found.attrs["angle_step"] * found.attrs["points_scale"] == pytest.approx(0.5)
    assert "an amplitude in cm is no angle" in found.attrs["remarks"]


def test_uneven_times_in_steps_have_the_clock_s_step(tmp_path):
    times = TIMES + 0.01 * np.resize([0, 1, 0, 2, 1], 24)
    found = recording(tmp_path, times)
    assert to_angle(found).attrs["time_step"] == pytest.approx(0.01)
    assert found["time"].attrs["units"] == "s"


def test_the_number_of_the_swing_is_no_time(tmp_path):
    found = recording(tmp_path, np.arange(24), np.abs(DEGREES), "n,amplitude (deg)")
    assert found.attrs["points"] == COUNTED and found["time"].attrs == {
        "units": "1",
        "long_name": "number of the swing",
    }
    assert to_angle(found).attrs["time_step"] == 0


def test_passages_without_speeds_have_no_reading_to_be_scaled():
    points = points_in(TIMES, DEGREES, "here", stated="")
    found = as_recording(points, "s", {"recording": "p"}).assign_attrs(points=PASSED)
    angle = to_angle(found)
    np.testing.assert_array_equal(angle["angle"], found["signal"])
    assert angle.attrs["angle_step"] == 0 and angle.attrs["points_scale"] == 1


@pytest.mark.parametrize(
    ("said", "emulated"), [("yes", "yes"), ("True", "yes"), ("1", "yes"), ("no", "no"), ("", "no")]
)
def test_a_file_that_says_so_is_of_an_emulated_pendulum(tmp_path, said, emulated):
    path = tmp_path / "points.csv"
    rows = "".join(f"{t},{x}\n" for t, x in zip(TIMES, DEGREES, strict=True))
    about = f"# emulated: {said}\n# source: the bench\n" if said else ""
    path.write_text(f"{about}t (s),angle (deg)\n{rows}")
    found = ingest({**COLUMNS, "recording": "p", "file": str(path), "label": "the long one"})
    assert found.attrs["emulated"] == emulated and found.attrs["label"] == "the long one"
    assert found.attrs["source"] == ("the bench" if said else "as recorded by its owner")
