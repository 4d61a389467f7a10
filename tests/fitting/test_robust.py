"""Standard errors for autocorrelated residuals, held to the scatter of fits to many noisy copies."""

import numpy as np
import pytest
from scipy.signal import lfilter

from swingdown.engine.trajectory import simulate
from swingdown.fitting import robust
from swingdown.fitting.least_squares import fit_jointly, fit_trajectory
from swingdown.fitting.robust import _bartlett, robust_covariance, variance_inflation
from swingdown.pendulum.model import Model

TIMES = np.arange(1000) / 50
CLEAN = simulate(Model("viscous", {"natural_frequency": 6.0, "viscous_ratio": 0.01}), TIMES, 0.3)


def noise(number, memory):
    rng = np.random.default_rng([5, number])
    white = rng.standard_normal(TIMES.size + 200)
    return 1e-3 * lfilter([np.sqrt(1 - memory**2)], [1, -memory], white)[200:]


@pytest.mark.parametrize(("memory", "ordinary_is_good"), [(0.0, True), (0.95, False)])
def test_errors_are_those_of_repeated_fits(memory, ordinary_is_good):
    swings = [(TIMES, CLEAN + noise(number, memory)) for number in range(200)]
    fits = [fit_trajectory("viscous", *swing) for swing in swings]
    scatter = np.std([fit.values for fit in fits], axis=0, ddof=1)
    found = [np.diag(robust_covariance(fit, [swing])) for fit, swing in zip(fits, swings, strict=True)]
    ordinary = np.sqrt(np.mean([np.diag(fit.covariance) for fit in fits], axis=0))
    # Bartlett's weights and the fitted values themselves take some of the spectrum away: 25 % is what is promised
    assert np.sqrt(np.mean(found, axis=0)) == pytest.approx(scatter, rel=0.25)
    assert (np.abs(ordinary / scatter - 1) < 0.25).all() == ordinary_is_good


def test_inflation_tells_white_from_coloured_residuals():
    inflation = {}
    for memory in (0.0, 0.9):
        swing = (TIMES, CLEAN + noise(0, memory))
        fit = fit_trajectory("viscous", *swing)
        inflation[memory] = variance_inflation(fit, robust_covariance(fit, [swing]))
    assert 1 <= inflation[0.0] < 1.5
    assert inflation[0.9] > 2


def test_two_swings_alike_halve_the_variance_of_one():
    swing = (TIMES, CLEAN + noise(1, 0.9))
    one, two = fit_trajectory("viscous", *swing), fit_jointly("viscous", [swing, swing])
    alone, both = robust_covariance(one, [swing]), robust_covariance(two, [swing, swing])
    assert np.sqrt(np.diag(both)[:2]) == pytest.approx(np.sqrt(np.diag(alone)[:2] / 2), rel=0.01)
    assert np.sqrt(np.diag(both)[2:]) == pytest.approx(np.sqrt([*np.diag(alone)[2:]] * 2), rel=0.5)


def test_sum_over_windows_is_bartletts_weighted_sum():
    scores = np.random.default_rng(3).standard_normal((2, 40))
    lag = 7
    expected = scores @ scores.T
    for k in range(1, lag + 1):
        product = scores[:, k:] @ scores[:, :-k].T
        expected = expected + (1 - k / (lag + 1)) * (product + product.T)
    assert _bartlett(scores, lag) == pytest.approx(expected)


@pytest.mark.parametrize(("samples", "lag"), [(1000, 100), (200, 53)])
def test_memory_is_a_tenth_of_the_record_and_no_less_than_a_period(samples, lag, monkeypatch):
    seen = []
    monkeypatch.setattr(robust, "_bartlett", lambda scores, lag: seen.append(lag) or _bartlett(scores, lag))
    swing = (TIMES[:samples], (CLEAN + noise(0, 0.0))[:samples])  # a period takes 2 pi / 6 s, 52.4 samples
    robust_covariance(fit_trajectory("viscous", *swing), [swing])
    assert seen == [lag]
