"""What a measurement leaves open of its readings."""

import numpy as np
import pytest

from swingdown.pendulum.slack import is_open, reading_slack, time_power


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


def test_what_joins_the_normal_matrix_is_the_inverse_covariance_in_units_of_the_noise():
    """A gain and a zero, which have one source in common and one of their own each."""
    known = {"sensor_gain": {"line": 3e-3, "cube": 1e-3}, "sensor_zero": {"line": 0.02, "rest": 0.05}}
    slack = reading_slack(known).weighed(0.01)
    covariance = [[1e-5, 6e-5], [6e-5, 2.9e-3]]
    np.testing.assert_allclose(slack.covariance, covariance)
    np.testing.assert_allclose(slack.precision, 1e-4 * np.linalg.inv(covariance), rtol=1e-6)
