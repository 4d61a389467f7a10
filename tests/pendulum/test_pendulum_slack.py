"""What a measurement leaves open of its readings."""

import pytest

from swingdown.pendulum.slack import is_open, time_power


@pytest.mark.parametrize(
    "value, error, told",
    [(3.1, 1.0, True), (-3.1, 1.0, True), (2.9, 1.0, False), (3.1, None, False), (3.1, 0.0, False)],
)
def test_a_value_is_told_beyond_three_standard_errors_that_are_known(value, error, told):
    assert is_open(value, error) is told


@pytest.mark.parametrize(
    "unit, power", [("rad/s^2", -2), ("s", 1), ("1/s", -1), ("Hz", -1), ("rad", 0), ("rad*s^2", 2)]
)
def test_the_power_of_the_second_is_read_from_a_unit(unit, power):
    assert time_power(unit) == power
