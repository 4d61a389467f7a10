"""The inverse of J'J that a fit's covariance is made of."""

from types import SimpleNamespace

import numpy as np
import pytest
from swings import CASES, SHORT, TIMES

from swingdown.engine.trajectory import sensitivities, simulate
from swingdown.fitting.batch import fit_batch
from swingdown.fitting.covariance import covariance_of, inverse_of
from swingdown.fitting.least_squares import fit_trajectory
from swingdown.pendulum.model import Model
from swingdown.pendulum.slack import reading_slack


def problem(size, upper=np.inf):
    """What ``inverse_of`` needs of a fit's problem: so many variables below a bound."""
    return SimpleNamespace(lower=np.full(size, -np.inf), upper=np.full(size, float(upper)))


def normal(size, spread=1e4):
    """J'J of columns whose sizes are a factor ``spread`` apart, and which are correlated."""
    slopes = np.random.default_rng(size).standard_normal((3 * size, size))
    slopes[:, -1] += 3 * slopes[:, 0]
    slopes *= np.geomspace(1, spread, size)
    return slopes.T @ slopes


@pytest.mark.parametrize(
    "given",
    [np.diag([1.0, 0.0]), np.diag([1.0, 1e-310]), np.ones((2, 2)), np.full((2, 2), np.nan), np.array([[1.0, np.nan], [np.nan, 1.0]]), np.diag([1.0, np.inf])],
)  # fmt: skip
def test_nothing_is_known_of_what_the_data_leave_open(given):
    """Also where a search ran away to where slopes are no numbers any more."""
    with np.errstate(invalid="ignore"):
        found = inverse_of(problem(2), given, np.zeros(2))
    assert np.isnan(found[1, 1]) and np.isnan(found[0, 1])


def test_what_a_bound_holds_is_taken_for_known():
    matrix, at = normal(3), np.array([0.0, 1.0, 0.0])
    found = inverse_of(problem(3, upper=1.0), matrix, at)
    kept = np.ix_([0, 2], [0, 2])
    assert found[kept] == pytest.approx(np.linalg.inv(matrix[kept]), rel=1e-9)
    assert np.isnan(found[1]).all() and np.isnan(found[:, 1]).all()


def test_covariance_is_that_of_the_slopes_at_the_optimum():
    angle, _ = CASES["seven"].noisy(21)
    fit = fit_trajectory(CASES["seven"].model.label, TIMES, angle)
    _, slopes = sensitivities(fit.model, TIMES, fit.only.release_angle, fit.only.release_velocity)
    variance = fit.rss / (TIMES.size - len(fit.free))
    assert fit.covariance == pytest.approx(variance * np.linalg.inv(slopes @ slopes.T), rel=1e-6)


def test_the_covariance_is_the_scatter_of_many_fits():
    """Standard errors and correlations against 2000 noise realisations: 2000 know a standard deviation to 1.6 %."""
    case = CASES["seven"]
    _, noise = case.noisy(0)
    series = case.clean() + noise * np.random.default_rng(12).standard_normal((2000, TIMES.size))
    many = fit_batch(case.model, TIMES, series, (case.release_angle, case.release_velocity))
    assert many.converged.all()
    fit = fit_trajectory(case.model.label, TIMES, series[0])
    assert many.values.std(axis=0, ddof=1) == pytest.approx(fit.standard_errors, rel=0.1)
    assert np.corrcoef(many.values.T) == pytest.approx(fit.correlation, abs=0.07)
    truth = np.array([*case.model.vector(), case.release_angle, case.release_velocity])
    bias = (many.values.mean(axis=0) - truth) / (fit.standard_errors / np.sqrt(2000))
    assert np.abs(bias).max() < 4


def test_what_the_data_do_not_tell_has_no_standard_error():
    """A constant torque and a linear sensor's zero cannot be told apart with a linear pendulum."""
    model = Model(
        "viscous+constant_torque+sensor_zero",
        {"natural_frequency": 7.0, "viscous_ratio": 0.02, "constant_torque": 0.0, "sensor_zero": 0.01},
        restoring="linear",
    )
    angle = simulate(model, SHORT, 0.3) + 1e-3 * np.random.default_rng(15).standard_normal(SHORT.size)
    fit = fit_trajectory(Model(model.label, restoring="linear"), SHORT, angle)
    errors = fit.model.standard_errors
    assert not errors["constant_torque"] < 100 and not errors["sensor_zero"] < 100
    assert fit.rms == pytest.approx(1e-3, rel=0.1)


def test_what_is_known_beforehand_moves_the_values_as_far_as_the_data_let_it():
    """By the normal equations: noise acts through the data alone, an error of a source through its weight beside them, the clock by units."""
    free = ["natural_frequency", "viscous_ratio", "sensor_gain", "release_angle", "release_velocity"]
    sources = {"sensor_gain": {"length": 0.005, "volt": -0.003}}
    model = Model("viscous").with_slack(reading_slack(sources, clock=1e-4).weighed(0.01))
    at, precision = np.array([7.0, 0.01, 0.02, 0.3, -0.5]), np.zeros((5, 5))
    precision[2, 2] = 0.01**2 / (0.005**2 + 0.003**2)
    slopes = np.random.default_rng(1).standard_normal((200, 5))
    slopes[:, 3] += 2 * slopes[:, 2]
    given = SimpleNamespace(
        **vars(problem(5)), n=200, free=free, model=model, known=SimpleNamespace(precision=precision)
    )
    hessian = slopes.T @ slopes + precision
    covariance, systematic = covariance_of(given, hessian, 3.0, at)
    inverse = np.linalg.inv(hessian)
    pulled = inverse[:, 2] * precision[2, 2]
    clock = 1e-4 * np.array([-7.0, 0, 0, 0, 0.5])
    assert systematic == pytest.approx(np.column_stack([pulled * 0.005, -pulled * 0.003, clock]))
    random = 3.0 / 195 * inverse @ slopes.T @ slopes @ inverse
    assert covariance == pytest.approx(random + systematic @ systematic.T)
    held = SimpleNamespace(**vars(given) | {"upper": np.array([np.inf, 0.01, *[np.inf] * 3])})
    covariance, systematic = covariance_of(held, hessian, 3.0, at)
    assert np.isnan(systematic[1, :2]).all() and np.isnan(covariance[1]).all()
    kept = np.ix_([0, 2, 3, 4], [0, 2, 3, 4])
    pulled = np.linalg.inv(hessian[kept])[:, 1] * precision[2, 2]
    assert systematic[[0, 2, 3, 4], 0] == pytest.approx(pulled * 0.005)
    assert np.isfinite(covariance[kept]).all()
