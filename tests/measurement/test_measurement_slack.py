"""What stays open of a reading and a clock: the limits that are stated, those that are usual, and which of several hold."""

from math import sqrt

import numpy as np
import pytest
import xarray as xr

from swingdown.measurement.slack import (
    as_variables,
    of_angles,
    of_calibration,
    of_tolerances,
    tolerances,
    with_rate,
)
from swingdown.pendulum.slack import Slack, reading_slack

QUARTZ = 5e-5


def recording(unit="rad", **attrs):
    return xr.Dataset({"signal": ("time", [0.0, 1.0], {"units": unit})}, attrs=attrs)


def angle(slack, **attrs):
    """A dataset of angles as it keeps a slack."""
    variables, coords = as_variables(slack)
    return xr.Dataset(variables, coords, attrs)


def calibration(kind="random"):
    """A line of 0.5 rad/V about a rest of 2 V, of two sources; the encoder ends 6 V from there."""
    return xr.Dataset(
        {
            "line": (("mode", "coefficient"), [[-1.0, 0.5], [9.0, 9.0]]),
            "rest_voltage": ("mode", [2.0, 9.0]),
            "encoder_up_to": ("range", [1.0, 8.0]),
            "encoder_limit": ("range", [0.01, 0.03]),
            "contribution": (("quantity", "source"), [[7.0, 7.0], [0.01, 0.02], [0.004, 0.0]]),
        },
        {
            "mode": ["gum", "paper"], "coefficient": ["intercept", "slope"], "source": ["arm", "meter"],
            "quantity": ["intercept", "slope", "rest_voltage"],
        },
        {"encoder_kind": kind},
    )  # fmt: skip


def test_an_angle_s_gain_and_zero_are_right_unless_the_sheet_says_so_and_a_gyroscope_s_never():
    assert tolerances({}, "rad") == {
        "gain_tolerance": 0.0,
        "zero_tolerance_rad": 0.0,
        "clock_tolerance": QUARTZ,
    }
    rates = {"gain_tolerance": 0.03, "zero_tolerance_rad_per_s": 0.35, "clock_tolerance": QUARTZ}
    assert tolerances({}, "rad/s") == tolerances({}, "deg/s") == rates
    said = {"gain_tolerance": "0.01", "clock_tolerance": 0.0, "zero_tolerance_rad": np.nan}
    assert tolerances(said, "rad") == {
        "gain_tolerance": 0.01,
        "zero_tolerance_rad": 0.0,
        "clock_tolerance": 0.0,
    }


def test_where_nobody_knows_which_way_is_down_the_zero_is_open_to_a_tenth_of_a_radian_or_more():
    assert tolerances({}, "rad", upright=False)["zero_tolerance_rad"] == 0.1
    assert tolerances({"zero_tolerance_rad": 0.2}, "rad", upright=False)["zero_tolerance_rad"] == 0.2


def test_scattered_stamps_widen_the_clock_and_are_no_limit_of_error():
    known = with_rate({"clock_tolerance": 3e-4}, 4e-4 / sqrt(3))
    assert known == pytest.approx({"clock_tolerance": 5e-4, "clock_rate": 4e-4 / sqrt(3)})
    assert with_rate({"clock_tolerance": 3e-4}, 0.0) == {"clock_tolerance": 3e-4}
    found = of_tolerances(recording(**known))
    assert found.clock == pytest.approx(5e-4 / sqrt(3))
    assert found.limited == pytest.approx(0.6)  # of five parts three are the limit's
    assert of_tolerances(recording(clock_tolerance=3e-4)).limited == 1.0
    assert of_tolerances(recording(clock_tolerance=3e-4, clock_rate=1.0)).limited == 0.0


def test_limits_of_error_are_those_of_uniform_distributions():
    found = of_tolerances(recording(gain_tolerance=0.01, zero_tolerance_rad=0.002))
    assert found.deviations == pytest.approx({"sensor_gain": 0.01 / sqrt(3), "sensor_zero": 0.002 / sqrt(3)})
    assert found.clock == pytest.approx(QUARTZ / sqrt(3))
    turning = of_tolerances(recording("rad/s"))
    assert turning.deviations == pytest.approx({"sensor_gain": 0.03 / sqrt(3), "sensor_zero": 0.35 / sqrt(3)})


def test_an_error_of_the_slope_is_a_gain_and_one_of_the_rest_voltage_a_zero():
    found = of_calibration(calibration(), Slack(clock=1e-4, limited=0.5))
    assert found.names == ("sensor_gain", "sensor_zero") and found.sources == ("arm", "meter")
    np.testing.assert_allclose(found.contributions, [[-0.02, -0.04], [0.002, 0.0]])
    assert (found.clock, found.limited) == (1e-4, 0.5)


def test_a_systematic_encoder_may_be_bent_as_far_as_its_limit_at_the_end_of_its_range():
    found = of_calibration(calibration("systematic"), Slack())
    assert found.names[2] == "sensor_curvature" and found.sources[2] == "encoder_curvature"
    # 6 V from its rest, 3 rad
    np.testing.assert_allclose(found.contributions[2], [0, 0, 0.5 * 0.03 / sqrt(3) / 3.0**2])


def test_what_is_stated_joins_what_the_calibration_leaves_open():
    stated = reading_slack({"sensor_gain": {"gain_tolerance": 0.1}, "sensor_zero": {"zero_tolerance": 0.2}})
    found = of_calibration(calibration(), stated)
    assert found.sources == ("arm", "meter", "gain_tolerance", "zero_tolerance")
    np.testing.assert_allclose(found.contributions, [[-0.02, -0.04, 0.1, 0], [0.002, 0, 0, 0.2]])


def test_a_slack_is_kept_with_the_angles():
    slack = reading_slack({"sensor_gain": {"a": 0.1, "b": 0.2}, "sensor_zero": {"b": 0.3}})
    found = of_angles([angle(slack, clock_uncertainty=2e-5, clock_limited=0.25)])
    assert (found.names, found.sources) == (slack.names, slack.sources)
    np.testing.assert_array_equal(found.contributions, slack.contributions)
    assert (found.clock, found.limited) == (2e-5, 0.25)
    assert as_variables(Slack()) == ({}, {})
    bare = of_angles([angle(Slack())])
    assert bare.names == () and (bare.clock, bare.limited) == (0.0, 1.0)


def test_of_swings_that_state_different_ones_the_widest_and_the_worst_clock_hold():
    gain = reading_slack({"sensor_gain": {"a": 0.1}})
    wide = reading_slack({"sensor_gain": {"a": 0.2}})
    both = reading_slack({"sensor_gain": {"a": 0.01}, "sensor_zero": {"a": 0.01}})
    clocks = [
        {"clock_uncertainty": 1e-4},
        {"clock_uncertainty": 3e-4, "clock_limited": 0.5},
        {"clock_uncertainty": 2e-4},
    ]
    found = of_angles([angle(s, **c) for s, c in zip([gain, wide, gain], clocks, strict=True)])
    assert found.deviations == pytest.approx({"sensor_gain": 0.2})
    assert (found.clock, found.limited) == (3e-4, 0.5)
    assert of_angles([angle(wide), angle(both)]).names == both.names
    assert of_angles([]).names == ()
