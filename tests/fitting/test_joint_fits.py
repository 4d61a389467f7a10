"""Fits of several swings at once: what they share, what each has for itself, and what drifts over the longest of them."""

import numpy as np
import pytest
from swings import CASES, TIMES

from swingdown.engine.trajectory import simulate
from swingdown.errors import InputError
from swingdown.fitting.least_squares import fit_jointly, fit_trajectory
from swingdown.pendulum.model import Model
from swingdown_trials.second_pendulum import trajectory

SHORT = TIMES[:501]


def test_joint_fits_share_parameters_and_not_releases():
    values = {"natural_frequency": 7.25, "viscous_ratio": 0.03, "load_friction": 0.012}
    model = Model("viscous+load_coulomb", values)
    times = (TIMES[:301], TIMES[:250], TIMES[:301] + 5.0)
    rng = np.random.default_rng(9)
    releases = [(0.35, 0.0), (0.6, -0.5), (-0.8, 0.3)]
    swings = []
    for at, release in zip(times, releases, strict=True):
        swings.append((at, simulate(model, at, *release) + 0.002 * rng.standard_normal(at.size)))
    joint = fit_jointly(model.label, swings)
    assert joint.converged
    assert joint.free == (*model.parameters, *("release_angle", "release_velocity") * 3)
    found = np.array([[swing.release_angle, swing.release_velocity] for swing in joint.swings])
    assert found == pytest.approx(np.array(releases), abs=0.01)
    truth = np.array([*model.vector(), *np.ravel(releases)])
    assert np.abs((joint.values - truth) / joint.standard_errors).max() < 4
    single = [fit_trajectory(model.label, *swing) for swing in swings]
    for name in model.parameters:
        assert joint.model.standard_errors[name] < min(fit.model.standard_errors[name] for fit in single)
    assert joint.rss >= sum(fit.rss for fit in single) * (1 - 1e-9)
    assert joint.n == sum(at.size for at in times)
    assert [swing.rms for swing in joint.swings] == pytest.approx([0.002] * 3, rel=0.15)
    for (at, _), one in zip(swings, joint.swings, strict=True):
        assert np.array_equal(one.angle, simulate(one.model, at, one.release_angle, one.release_velocity))
    with pytest.raises(ValueError):
        joint.only  # noqa: B018


def test_joint_fits_of_one_swing_are_the_single_fit():
    angle, _ = CASES["five"].noisy(10)
    one, joint = fit_trajectory("viscous", TIMES, angle), fit_jointly("viscous", [(TIMES, angle)])
    assert np.array_equal(one.values, joint.values) and joint.only.release_angle == one.only.release_angle


def test_parameters_of_a_swings_own_and_fixed_ones():
    rng = np.random.default_rng(11)
    frequencies = (7.1, 7.3)
    swings = []
    for frequency in frequencies:
        model = Model("viscous", {"natural_frequency": frequency, "viscous_ratio": 0.02})
        swings.append((SHORT, simulate(model, SHORT, 0.4) + 1e-3 * rng.standard_normal(SHORT.size)))
    fit = fit_jointly("viscous", swings, own=("natural_frequency",))
    assert [swing.own["natural_frequency"] for swing in fit.swings] == pytest.approx(frequencies, abs=0.01)
    assert fit.model.values["viscous_ratio"] == pytest.approx(0.02, abs=1e-3)
    fixed = fit_trajectory("viscous", *swings[0], fixed={"viscous_ratio": 0.03})
    assert fixed.model.values["viscous_ratio"] == 0.03 and "viscous_ratio" not in fixed.free
    with pytest.raises(InputError, match="gamma"):
        fit_trajectory("viscous", *swings[0], fixed={"gamma": 0.03})


@pytest.mark.parametrize(("effect", "value"), [("clock_drift", -0.013), ("damping_drift", 0.02)])
def test_what_drifts_does_so_in_time_however_long_a_swing_was_recorded(effect, value):
    truth = Model(
        ("viscous", effect), {"natural_frequency": 7.25, "viscous_ratio": 0.01, effect: value}, record=20.0
    )
    rng, swings = np.random.default_rng(8), []
    for last, angle in ((20.0, 0.6), (11.0, 0.3)):
        times = np.linspace(0, last, round(100 * last) + 1)
        swings.append((times, simulate(truth, times, angle) + 1e-3 * rng.standard_normal(times.size)))
    fit = fit_jointly(truth.label, swings)
    error = fit.standard_errors[fit.free.index(effect)]
    assert fit.rms == pytest.approx(1e-3, rel=0.05)
    assert abs(fit.model.values[effect] - value) < 4 * error
    # and goes on to do so where the fit is asked about another recording
    assert fit.model.record == 20.0


def test_rough_fits_leave_what_exact_ones_leave():
    """Fits that are only compared follow their trajectories less closely: what they leave is told to a few millionths."""
    times, draws = np.arange(1001) / 50, np.random.default_rng(4)
    values = {"natural_frequency": 7.2, "power_law_coefficient": 0.05, "power_law_exponent": 1.4}
    model = Model("power_law_drag", values)
    swings = [
        (times, simulate(model, times, a) + 1e-3 * draws.standard_normal(times.size)) for a in (0.7, 0.4)
    ]
    rough, exact = (fit_jointly(model, swings, guess=model, rough=rough) for rough in (True, False))
    assert rough.rss != exact.rss
    assert rough.rss == pytest.approx(exact.rss, rel=3e-6)
    for name, value in exact.model.values.items():
        assert abs(rough.model.values[name] - value) < 0.02 * exact.model.standard_errors[name]


def test_a_slow_sensor_is_not_steady_a_quarter_of_a_swing_after_the_release():
    """Cut in the middle of the first half-swing, where the reading has neither settled nor follows steadily."""
    values = {"natural_frequency": 5.0, "viscous_ratio": 0.01, "lag_time": 0.12}
    times = np.arange(1001) / 100
    rng, swings = np.random.default_rng(3), []
    for release in (0.5, -0.6):
        reading = trajectory(["viscous", "sensor_lag"], values, times, release).reading
        swings.append((times[31:], (reading + 1e-4 * rng.standard_normal(times.size))[31:]))
    fit = fit_jointly("viscous+sensor_lag", swings, bounded=True)
    assert [swing.rms for swing in fit.swings] == pytest.approx([1e-4] * 2, rel=0.15)
    error = fit.model.standard_errors["lag_time"]
    assert fit.model.values["lag_time"] == pytest.approx(values["lag_time"], abs=4 * error)
    assert fit.model.values["lag_start"] == pytest.approx(1, abs=0.5)
