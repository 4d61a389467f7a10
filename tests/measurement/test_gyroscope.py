"""What is known of a gyroscope's readings: their unit, which axis turns, and what no pendulum does."""

import numpy as np
import pytest

from swingdown.errors import InputError
from swingdown.measurement.gyroscope import check_rate, rate_unit, turning_most

TIMES = np.arange(1000) / 50
RATE = np.cos(2 * np.pi * TIMES / 1.28)  # rad/s


def fastest_allowed(period=1.28):
    """In rad/s: six times 2 pi in a period."""
    return 12 * np.pi / period


@pytest.mark.parametrize(("share", "unit"), [(0.98, "rad/s"), (1.02, "deg/s")])
def test_a_rate_that_no_pendulum_reaches_in_rad_is_one_in_degrees(share, unit):
    assert rate_unit(TIMES, share * fastest_allowed() * RATE) == unit
    assert rate_unit(TIMES, -share * fastest_allowed() * RATE) == unit


@pytest.mark.parametrize(("unit", "size"), [("rad/s", 1.0), ("deg/s", 180 / np.pi)])
def test_a_rate_that_no_pendulum_reaches_is_refused_with_the_largest_that_can_be(unit, size):
    assert check_rate(TIMES, 0.98 * fastest_allowed() * size * RATE, unit, "a.csv") == []
    with pytest.raises(
        InputError, match=f"taken for {unit} it reaches 32.4 rad/s with a period of 1.28 s"
    ) as told:
        check_rate(TIMES, 1.1 * fastest_allowed() * size * RATE, unit, "a.csv")
    assert told.value.expected == "at most 29.5 rad/s" and "write deg/s" in told.value.mend


@pytest.mark.parametrize(("unit", "size"), [("rad/s", 1.0), ("deg/s", 180 / np.pi)])
def test_what_is_read_at_rest_is_told_beyond_the_makers_limit(unit, size):
    assert check_rate(TIMES, (RATE + 0.34) * size, unit, "a.csv") == []
    for sign in (1, -1):
        (told,) = check_rate(TIMES, (RATE + sign * 0.36) * size, unit, "a.csv")
        assert f"about {sign * 0.36:.2g} rad/s at rest" in told and "zero_tolerance_rad_per_s" in told


@pytest.mark.parametrize("sign", [1, -1])
def test_what_turns_one_way_all_the_time_is_another_axis(sign):
    """Beside a middle of 0.6 a cosine is on that side for 0.7 of the time, beside one of 0.8 for 0.8 of it."""
    assert len(check_rate(TIMES, sign * (RATE + 0.6), "rad/s", "a.csv")) == 1
    with pytest.raises(InputError, match=f"one way all the time, at about {sign * 0.8:.2g} rad/s"):
        check_rate(TIMES, sign * (RATE + 0.8), "rad/s", "a.csv")


def test_a_slow_drift_to_one_side_is_within_the_makers_limit():
    assert check_rate(TIMES, 0.2 * RATE + 0.3, "rad/s", "a.csv") == []


def test_the_axis_that_turns_most_is_taken_and_how_far_askew_it_lies_is_told():
    names = ["x", "y", "z"]
    place, (told,) = turning_most(names, [0.05 * RATE, RATE, 0.09 * RATE])
    assert place == 1 and "of 3 axes `y` turns most" in told
    place, told = turning_most(names, [0.75 * RATE, 0.2 * RATE, -RATE])
    assert place == 2 and "75 % as much" in told[1] and "by about 20.0 %" in told[1]


def test_of_one_axis_or_of_axes_at_rest_nothing_is_told():
    assert turning_most(["x"], [RATE]) == (0, [])
    still = np.zeros(TIMES.size)
    assert turning_most(["x", "y"], [still, still])[1] == [
        "of 2 axes `x` turns most and was taken (⟨signal_column⟩ says otherwise)"
    ]
