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


def test_what_is_known_sits_where_its_value_is_and_counts_only_where_all_of_it_is_free():
    slack = reading_slack({"sensor_gain": {"line": 3e-3}, "sensor_zero": {"rest": 0.05}}).weighed(0.01)
    found = slack.precision_among(["sensor_zero", "natural_frequency", "sensor_gain"])
    right = np.diag([(0.01 / 0.05) ** 2, 0, (0.01 / 3e-3) ** 2])
    np.testing.assert_allclose(found, right, rtol=1e-6)
    assert not slack.precision_among(["natural_frequency", "sensor_gain"]).any()
    assert not reading_slack({}).precision_among(["natural_frequency"]).any()


def test_nothing_is_known_of_a_clock_that_nobody_told_of():
    slack = reading_slack({"sensor_gain": {"line": 3e-3}})
    assert slack.clock == 0.0 and reading_slack({}, clock=1e-4).clock == 1e-4
    assert not slack.without(["sensor_gain"]).names and slack.without(["sensor_zero"]).names == (
        "sensor_gain",
    )
