"""Fits that leave open what a calibration leaves open: the truth inside the intervals, and no sensor asserted."""

import numpy as np
import pandas as pd
import pytest

import swingdown
from swingdown.engine.trajectory import simulate
from swingdown.errors import InputError
from swingdown.fitting.least_squares import fit_jointly, fit_trajectory
from swingdown.fitting.slack import allowing
from swingdown.fitting.uncertainty import uncertainty
from swingdown.pendulum.model import Model
from swingdown.pendulum.slack import Slack, reading_slack, time_power

TIMES = np.arange(0, 20, 0.02)
LABEL = "quadratic_drag+load_coulomb"
TRUTH = Model(LABEL, {"natural_frequency": 7.25, "quadratic_coefficient": 0.0012, "load_friction": 0.0018})
SOURCES = {"sensor_gain": {"length": 0.005, "volt": -0.0049}, "sensor_zero": {"volt": 1e-3, "rest": 5e-4}}
SLACK = reading_slack(SOURCES, clock=0.0)


def swings(number, amplitudes, slack=SLACK):
    """Swings read by a sensor whose gain and zero are drawn from the slack."""
    rng = np.random.default_rng([3, number])
    gain, zero = np.r_[slack.contributions @ rng.standard_normal(len(slack.sources)), 0.0][:2]
    clean = [simulate(TRUTH, TIMES, amplitude) for amplitude in amplitudes]
    return [(TIMES, (1 + gain) * one + zero + 1e-3 * rng.standard_normal(TIMES.size)) for one in clean]


@pytest.mark.parametrize("amplitudes", [(0.5,), (0.3, 0.6)])
def test_the_truth_lies_within_the_intervals_of_most_calibrations(amplitudes):
    inside, without = [], []
    for number in range(60):
        own = swings(number, amplitudes)
        plain = fit_jointly(TRUTH, own, guess=TRUTH)
        fit = allowing(plain, own, SLACK)
        error = np.sqrt(np.diag(uncertainty(fit, own).covariance))
        for found, u, into in ((fit, error, inside), (plain, plain.standard_errors, without)):
            values = [abs(found.model.values[name] - TRUTH.values[name]) for name in TRUTH.parameters]
            into.append(values < 1.96 * u[: len(values)])
    assert np.mean(inside, axis=0).min() >= 0.85  # of 60: 95 % within three standard deviations
    assert np.mean(without, axis=0)[0] < 0.5  # the frequency of a fit that takes the calibration for exact


@pytest.mark.parametrize(("known", "done"), [(1.0, True), (3e-3, False)])
def test_a_zero_is_fitted_once_more_unless_the_data_make_nothing_of_what_was_known(known, done):
    own, slack = swings(0, (0.5,)), reading_slack({"sensor_zero": {"where it hangs": known}})
    begun = fit_jointly(TRUTH.with_slack(slack.weighed(0.0)), own, guess=TRUTH)
    assert (allowing(begun, own, slack) is begun) == done


def test_swings_of_several_amplitudes_tell_the_gain_that_the_calibration_left_open():
    own = swings(0, (0.3, 0.6))
    fit = allowing(fit_jointly(TRUTH, own, guess=TRUTH), own, SLACK)
    assert fit.model.standard_errors["sensor_gain"] < 0.2 * SLACK.deviations["sensor_gain"]
    assert fit.rms == pytest.approx(1e-3, rel=0.05)


def test_random_and_systematic_parts_are_those_of_repeated_measurements():
    narrow = reading_slack({"sensor_gain": {"length": 0.0015, "volt": -0.001}})
    found = []
    for number in range(150):
        own = swings(number, (0.5,), narrow)
        fit = allowing(fit_trajectory(TRUTH, *own[0], guess=TRUTH), own, narrow)
        known = uncertainty(fit, own)
        found.append([fit.model.values["natural_frequency"], known.random[0, 0], known.covariance[0, 0]])
    values, random, whole = np.array(found).T
    assert np.std(values, ddof=1) == pytest.approx(np.sqrt(np.mean(whole)), rel=0.2)  # 150 tell it to 6 %
    assert np.mean(random) < 0.8 * np.mean(whole)


def test_the_nuisance_effects_are_no_part_of_the_model_s_name():
    own = swings(1, (0.5,))
    fit = allowing(fit_trajectory(TRUTH, *own[0], guess=TRUTH), own, SLACK)
    assert fit.model.label == LABEL and fit.model.names == TRUTH.names
    assert {"sensor_gain", "sensor_zero"} < set(fit.model.values)


def test_a_value_that_a_bound_holds_leaves_the_others_their_standard_errors():
    model = Model(f"viscous+{LABEL}", TRUTH.values | {"viscous_ratio": -5e-4}).with_slack(SLACK.weighed(1e-3))
    angle = simulate(model.motion, TIMES, 0.5) + 1e-3 * np.random.default_rng(4).standard_normal(TIMES.size)
    fit = fit_jointly(model, [(TIMES, angle)], guess=TRUTH, bounded=True)
    errors = fit.model.standard_errors
    assert fit.model.values["viscous_ratio"] == 0 and np.isnan(errors.pop("viscous_ratio"))
    assert np.isfinite(list(errors.values())).all()


def test_an_effect_of_the_model_s_own_is_not_held_to_what_is_known():
    model = Model(f"{LABEL}+sensor_gain").with_slack(SLACK.weighed(1e-3))
    assert model.slack.names == ("sensor_zero",)
    gain = 0.1  # fourteen times what the calibration leaves open
    angle = 1.1 * simulate(TRUTH, TIMES, 0.5) + 1e-4 * np.random.default_rng(0).standard_normal(TIMES.size)
    fit = fit_trajectory(model, TIMES, angle)
    assert fit.model.values["sensor_gain"] == pytest.approx(gain, abs=0.002)


def test_a_clock_s_tolerance_is_the_frequency_s():
    own = swings(2, (0.5,))
    plain = fit_trajectory(TRUTH, *own[0], guess=TRUTH)
    fit = allowing(plain, own, Slack(clock=1e-3))
    assert fit.values == pytest.approx(plain.values, rel=1e-6)
    known = uncertainty(fit, own)
    at = fit.sources.index("clock")
    assert known.systematic[0, at] == pytest.approx(-7.25e-3, rel=1e-3)  # rad/s
    assert known.systematic[1, at] == pytest.approx(
        1e-3 * fit.values[1], rel=1e-6
    )  # a drag's coefficient, in s
    assert known.systematic[2, at] == 0  # a number


@pytest.mark.parametrize(
    ("unit", "power"),
    [("rad/s", -1), ("rad/s^2", -2), ("1/s^2", -2), ("s", 1), ("1", 0), ("Hz", -1), ("rad", 0)],
)
def test_the_power_of_time_in_a_unit(unit, power):
    assert time_power(unit) == power


def test_sources_that_say_nothing_are_left_out():
    slack = reading_slack({"sensor_gain": {"stated": 0.0}, "sensor_zero": {"stated": 1e-3}})
    assert slack.names == ("sensor_zero",)
    assert slack.deviations == {"sensor_zero": 1e-3}


def test_what_is_known_has_to_be_weighed():
    own = swings(3, (0.5,))
    with pytest.raises(InputError, match="not weighed"):
        fit_trajectory(TRUTH.with_slack(SLACK), *own[0])


def test_rates_without_any_noise_leave_their_own_law():
    """Exact rates of a spring: the gain is known beforehand alone, and weighs next to nothing beside residuals of nothing."""
    times = np.arange(0, 9.5, 0.01)
    rates = pd.DataFrame(
        {"t (s)": times, "gyro (rad/s)": -1.8 * np.exp(-0.02 * times) * np.sin(6 * times + 3)}
    )
    answer = swingdown.fit(rates, restoring="linear")
    assert answer.model.label == "viscous"
    assert answer["quality"].value == pytest.approx(150, rel=1e-6)
