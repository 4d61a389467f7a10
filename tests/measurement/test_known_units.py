"""Columns in units that are a known number of another one are read in it, and that is told."""

import numpy as np
import pytest

from swingdown.errors import InputError
from swingdown.measurement.recording import ingest
from swingdown.measurement.sheet import COLUMNS

TIMES = np.arange(1000) / 50
SWING = 0.3 * np.exp(-TIMES / 20) * np.cos(4.8 * TIMES)


def read(folder, time, signal, per_s=1.0, per_unit=1.0, **cells):
    path = folder / "a.csv"
    rows = [f"{per_s * t:.9g},{per_unit * x:.9g}" for t, x in zip(TIMES, SWING, strict=True)]
    path.write_text("\n".join([f'"{time}","{signal}"', *rows, ""]), encoding="utf-8")
    return ingest({**COLUMNS, "recording": "a", "file": str(path), **cells})


@pytest.mark.parametrize(
    ("unit", "per_s"),
    [("min", 1 / 60), ("minutes", 1 / 60), ("h", 1 / 3600), ("hours", 1 / 3600), ("1/10 s", 10), ("0.1 s", 10), ("1/100 s", 100), ("0.01 s", 100)],
)  # fmt: skip
def test_times_are_read_in_s(tmp_path, unit, per_s):
    found = read(tmp_path, f"t ({unit})", "angle (rad)", per_s)
    np.testing.assert_allclose(found["time"].values, TIMES, rtol=1e-6, atol=1e-6)
    assert f"`t ({unit})` is read in s, {1 / per_s:.6g} for one of its unit" in found.attrs["remarks"]


@pytest.mark.parametrize(
    ("name", "unit", "worth"),
    [
        ("angle (mrad)", "rad", 1e-3), ("angle (gon)", "rad", np.pi / 200), ("angle (arcmin)", "rad", np.pi / 180 / 60),
        ("angle (arcsec)", "rad", np.pi / 180 / 3600), ("angle (rev)", "rad", 2 * np.pi), ("angle (turns)", "rad", 2 * np.pi),
        ("angular velocity (rpm)", "rad/s", 2 * np.pi / 60),
        ("angular velocity (mdps)", "rad/s", np.pi / 180 / 1000),
    ],
)  # fmt: skip
def test_readings_are_read_in_the_unit_that_theirs_is_a_number_of(tmp_path, name, unit, worth):
    found = read(tmp_path, "t (s)", name, per_unit=1 / worth)
    assert found["signal"].attrs["units"] == unit
    np.testing.assert_allclose(found["signal"].values, SWING, rtol=1e-6, atol=1e-7)
    assert f"`{name}` is read in {unit}, {worth:.6g} for one of its unit" in found.attrs["remarks"]


def test_where_the_sheet_states_a_unit_it_stands(tmp_path):
    found = read(tmp_path, "t (s)", "angle (mrad)", signal_unit="rad")
    np.testing.assert_allclose(found["signal"].values, SWING, rtol=1e-6, atol=1e-7)
    assert "is read in" not in found.attrs.get("remarks", "")


def test_a_stated_length_is_the_unit_of_positions(tmp_path):
    """As if the header had it: of a small swing the angle is the share of the length of its period."""
    found = read(tmp_path, "t (s)", "x", per_unit=250.0, signal_unit="mm", length="58cm")
    told = read(tmp_path, "t (s)", "x (mm)", per_unit=250.0, length="58cm")
    np.testing.assert_array_equal(found["signal"].values, told["signal"].values)
    assert np.ptp(found["signal"].values[:50]) == pytest.approx(250 / 580 * np.ptp(SWING[:50]), rel=0.02)
    assert (
        read(tmp_path, "time", "reading", signal_unit="cm", length="58cm")["signal"].attrs["units"] == "rad"
    )


@pytest.mark.parametrize("name", ["x (m)", "angle (rad)"])
def test_a_stated_length_is_no_unit_of_a_column_that_states_its_own(tmp_path, name):
    with pytest.raises(InputError, match="mm is the unit of a position, and no column without a unit is one"):
        read(tmp_path, "t (s)", name, signal_unit="mm")
