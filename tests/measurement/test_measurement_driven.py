"""What is stated of a measured drive: its kind, its unit and its worth, and what of its sensor is to be found."""

from math import pi

import numpy as np
import pytest
import xarray as xr

from swingdown.errors import InputError
from swingdown.measurement.driven import Stated, as_variables, carried, check_free, drive_of, driven, stated

TIMES = np.arange(20) / 10
VALUES = np.sin(TIMES)


def recording(kind="pivot_position", campaign="bench", unit="", values=VALUES):
    return xr.Dataset(as_variables(TIMES, values, Stated(kind, unit), "r.csv"), attrs={"campaign": campaign})


@pytest.mark.parametrize(
    ("kind", "unit", "factor", "words"),
    [
        ("torque", "", 1.0, "a torque in a unit of its own"),
        ("torque", "V", 1.0, "a torque in V"),
        ("torque", "deg/s^2", pi / 180, "a torque in deg/s^2"),
        ("pivot_acceleration", "", 1 / 9.80665, "a pivot acceleration in m/s^2 (no unit is stated)"),
        ("pivot_acceleration", "g", 1.0, "a pivot acceleration in g"),
        ("pivot_position", "", 1.0, "a pivot position in m (no unit is stated)"),
        ("pivot_position", "cm", 0.01, "a pivot position in cm"),
        ("pivot_position", "mm", 0.001, "a pivot position in mm"),
        ("pivot_angle", "deg", pi / 180, "a pivot angle in deg"),
    ],
)
def test_an_input_is_worth_its_unit(kind, unit, factor, words):
    said = stated({"input_kind": kind, "input_unit": unit}, "row 2")
    assert said.factor == pytest.approx(factor, rel=1e-12) and str(said) == words
    assert said.between == "curve"


def test_the_gain_is_found_of_a_torque_in_a_unit_of_its_own_and_what_is_asked_of_others():
    def free(**given):
        return stated(given, "row 2").free

    assert free(input_kind="torque") == free(input_kind="torque", input_unit="V") == ("gain",)
    assert free(input_kind="torque", input_unit="rad/s^2") == free(input_kind="pivot_angle") == ()
    assert free(input_kind="torque", input_free="delay") == ("delay",)
    assert free(input_kind="torque", input_free="nothing") == ()
    assert free(input_kind="pivot_angle", input_free="delay, gain") == ("gain", "delay")
    assert free(input_kind="pivot_angle", input_free=["gain"]) == ("gain",)


@pytest.mark.parametrize(
    ("given", "where", "expected"),
    [
        ({}, "row 2, input_kind", "torque or pivot_acceleration or pivot_position or pivot_angle"),
        ({"input_kind": "push"}, "row 2, input_kind", "torque or"),
        ({"input_kind": "torque", "input_between": "jump"}, "row 2, input_between", "curve or line or hold"),
        ({"input_kind": "pivot_position", "input_unit": "V"}, "row 2, input_unit", "m or cm or mm"),
        ({"input_kind": "torque", "input_free": "zero"}, "row 2, input_free", "gain or delay or nothing"),
    ],
)  # fmt: skip
def test_a_word_that_is_not_known_is_refused_by_its_cell(given, where, expected):
    with pytest.raises(InputError) as refused:
        stated(given, "row 2")
    assert refused.value.where == where and refused.value.expected.startswith(expected)


def test_an_input_is_kept_in_the_unit_of_its_kind_and_read_again():
    kept = recording(unit="cm")
    assert kept["input"].attrs["units"] == "m"
    np.testing.assert_allclose(kept["input"], 0.01 * VALUES)
    found = drive_of(kept)
    assert found.kind == "pivot_position" and found.free == ()
    np.testing.assert_allclose(found.at(TIMES), 0.01 * VALUES, atol=1e-12)
    assert drive_of(xr.Dataset(carried(kept))) is found  # the same samples
    assert drive_of(xr.Dataset()) is None and carried(xr.Dataset()) == {}
    assert recording("torque", unit="V")["input"].attrs["units"] == "V"
    assert recording("torque")["input"].attrs["units"] == "as given"
    assert recording("torque", unit="deg/s^2")["input"].attrs["units"] == "rad/s^2"


def test_a_bad_input_is_refused_by_its_file():
    with pytest.raises(InputError) as refused:
        recording(values=np.full(TIMES.size, np.nan))
    assert refused.value.where.startswith("r.csv, ")


def test_recordings_of_one_pendulum_have_one_kind_of_input_or_none():
    free = xr.Dataset(attrs={"campaign": "bench"})
    first, second = recording(), recording(values=2 * VALUES)
    assert driven([first, second]) is drive_of(first) and driven([free, free]) is None
    for mixed in ([first, free], [first, recording("pivot_angle")]):
        with pytest.raises(InputError, match="campaign bench: its recordings have different drives"):
            driven(mixed)


def test_what_asks_for_a_free_swing_is_refused_of_a_driven_one():
    free = xr.Dataset(attrs={"campaign": "bench"})
    check_free([free], "laws are compared by free swings")
    with pytest.raises(
        InputError, match="campaign bench: it is driven, and laws are compared by free swings"
    ):
        check_free([free, recording()], "laws are compared by free swings")
