"""Series that bring a unit, a mask or gaps along."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import xarray as xr

import swingdown
from swingdown.answer.array_units import angles, numbers, times, value
from swingdown.errors import InputError


class Quantity:
    """As a quantity of pint: a magnitude with a unit that it can be told in another of the same kind."""

    FACTORS = {
        ("ms", "s"): 1e-3,
        ("s", "s"): 1.0,
        ("deg", "deg"): 1.0,
        ("turn", "deg"): 360.0,
        ("dimensionless", ""): 1.0,
    }

    def __init__(self, magnitude, units):
        self.magnitude, self.units = magnitude, units

    def to(self, unit):
        return Quantity(np.asarray(self.magnitude) * self.FACTORS[(self.units, unit)], unit)

    @classmethod
    def from_list(cls, given):
        return cls([one.magnitude for one in given], given[0].units)


@pytest.mark.parametrize("given", [[0.002], [Quantity(2.0, "ms")]])
def test_a_list_of_one_is_as_one_of_many(given):
    assert times(given) == pytest.approx([0.002])


@pytest.mark.parametrize(
    ("given", "unit"),
    [
        ([1.0, 2.0], ""),
        (pd.Series([1.0, 2.0], name="theta_deg"), "deg"),
        (xr.DataArray([1.0, 2.0], attrs={"units": "rad/s"}), "rad/s"),
        (xr.DataArray([1.0, 2.0], attrs={"units": "degrees"}), "deg"),
        (Quantity([1.0, 2.0], "deg"), "deg"),
        (Quantity([1 / 360, 2 / 360], "turn"), "deg"),
        (Quantity([1.0, 2.0], "dimensionless"), ""),
        (xr.DataArray([1.0, 2.0], attrs={"units": "V"}), "V"),
        (xr.DataArray([1e3, 2e3], attrs={"units": "mrad"}), "rad"),
        (pd.Series([1e3, 2e3], name="theta (mrad)"), "rad"),
        (pd.Series([0.5 / np.pi, 1 / np.pi], name="theta (turns)"), "rad"),
        (pd.Series([200 / np.pi, 400 / np.pi], name="theta (gon)"), "rad"),
        (pd.Series([1e3, 2e3], name="reading (mV)"), "V"),
    ],
)
def test_angles_have_the_unit_that_they_state(given, unit):
    values, stated = angles(given)
    assert stated == unit and values == pytest.approx([1.0, 2.0])


@pytest.mark.parametrize(
    ("given", "unit"),
    [
        (xr.DataArray([1.0], attrs={"units": "Pa"}), "Pa"),
        (pd.Series([1.0], name="angle (grad)"), "grad"),
        (Quantity([1.0], "m"), "m"),
    ],
)
def test_a_unit_of_something_else_is_no_angle_and_is_named_as_it_is_stated(given, unit):
    with pytest.raises(InputError, match=f"the angles: their unit is '{unit}'"):
        angles(given)


@pytest.mark.parametrize(
    "given",
    [
        [0.0, 0.5],
        xr.DataArray([0.0, 500.0], attrs={"units": "ms"}),
        pd.Series([0.0, 5e5], name="time_us"),
        xr.DataArray([0.0, 0.5 / 60], attrs={"units": "min"}),
        np.array(["2026-01-01T12:00:00.0", "2026-01-01T12:00:00.5"], dtype="datetime64[ns]"),
        np.array([100, 600], dtype="timedelta64[ms]"),
        Quantity([0.0, 500.0], "ms"),
    ],
)
def test_times_are_told_in_seconds(given):
    assert times(given) == pytest.approx([0.0, 0.5])


def test_of_dates_the_first_that_is_known_is_the_zero():
    dates = np.array(["NaT", "2026-01-01T12:00", "2026-01-01T12:01"], dtype="datetime64[s]")
    found = times(dates)
    assert np.isnan(found[0]) and found[1:] == pytest.approx([0.0, 60.0])


TIMES = np.arange(1001) / 100
ANGLE = 0.3 * np.exp(-0.05 * TIMES) * np.cos(6 * TIMES) + np.random.default_rng(2).normal(0, 1e-3, 1001)


def period(*given, **told):
    return swingdown.fit(*given, fitted="viscous", restoring="linear", **told)["period"].value


@pytest.mark.parametrize(("unit", "worth"), [("mrad", 1e-3), ("gon", np.pi / 200), ("turns", 2 * np.pi), ("degrees", np.pi / 180)])  # fmt: skip
def test_a_table_and_a_call_may_have_the_units_of_a_file(unit, worth, tmp_path):
    expected = period(TIMES, ANGLE, unit="rad")
    table = pd.DataFrame({"t (min)": TIMES / 60, f"theta ({unit})": ANGLE / worth})
    assert period(table) == pytest.approx(expected, rel=1e-9)
    assert period(TIMES, ANGLE / worth, unit=unit) == pytest.approx(expected, rel=1e-9)
    if unit == "degrees":
        np.savetxt(tmp_path / "a.txt", np.column_stack([TIMES, ANGLE / worth]))
        assert period(tmp_path / "a.txt", unit=unit) == pytest.approx(expected, rel=1e-6)
    with pytest.raises(InputError, match="the angles themselves say"):
        swingdown.fit(pd.Series(ANGLE, TIMES, name="theta (rad)"), unit=unit)


def test_an_unknown_unit_is_told_with_those_that_there_are():
    with pytest.raises(InputError, match="unknown unit 'degre'.*rad or deg"):
        swingdown.fit(TIMES, ANGLE, unit="degre")


def test_times_in_degrees_are_none():
    with pytest.raises(InputError, match="the times: their unit is 'deg'"):
        times(xr.DataArray([0.0], attrs={"units": "deg"}))


def test_what_is_masked_or_missing_is_nan():
    for given in (
        np.ma.masked_array([1, 2], [False, True]),
        pd.Series([1, pd.NA], dtype="Int64"),
        [1.0, np.nan],
    ):
        found = numbers(given, "the angles")
        assert found[0] == 1.0 and np.isnan(found[1]) and found.dtype == float


def test_numbers_are_a_copy():
    given = np.array([1.0, 2.0])
    numbers(given, "the angles")[0] = 9.0
    assert given[0] == 1.0


@pytest.mark.parametrize("given", ["anna.csv", Path("anna.csv"), b"1"])
def test_a_text_is_to_be_read_as_a_file(given):
    with pytest.raises(InputError, match="is text"):
        numbers(given, "the times")


@pytest.mark.parametrize("given", [[1.0, "two"], np.array([1j]), [[1.0], [1.0, 2.0]]])
def test_what_holds_no_numbers_is_refused(given):
    with pytest.raises(InputError, match="they are no numbers"):
        numbers(given, "the angles")


def test_one_value_may_bring_its_unit():
    assert value(2, "rad/s", "velocity") == 2.0
    assert value(Quantity(500.0, "ms"), "s", "delay") == pytest.approx(0.5)
    assert value(Quantity(0.5, "dimensionless"), "1", "gain") == 0.5
    for given in (Quantity(1.0, "deg"), "much", None):
        with pytest.raises(InputError, match="delay"):
            value(given, "s", "delay")


def test_milliseconds_that_nobody_states_are_asked_about():
    swing = swingdown.simulate("viscous", np.arange(0, 12, 0.01), 0.35, noise=0.002, seed=1, natural_frequency=7.25, viscous_ratio=0.01)  # fmt: skip
    for clock, told in ((swing["time"] * 1e3, True), (swing["time"], False)):
        answer = swingdown.fit(clock.values, swing.values, fitted=["viscous"])
        assert any("is the unit of the time right?" in one for one in answer.remarks) == told
