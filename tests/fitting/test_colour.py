"""Standard errors for autocorrelated residuals, held to the scatter of fits to many noisy copies."""

import numpy as np
import pytest
from scipy.signal import lfilter

from swingdown.engine.trajectory import simulate
from swingdown.fitting.colour import autoregression, uncertainty
from swingdown.fitting.least_squares import fit_jointly, fit_trajectory
from swingdown.pendulum.model import Model

TIMES = np.arange(1000) / 50
CLEAN = simulate(Model("viscous", {"natural_frequency": 6.0, "viscous_ratio": 0.01}), TIMES, 0.3)


def noise(number, memory):
    rng = np.random.default_rng([5, number])
    white = rng.standard_normal(TIMES.size + 200)
    return 1e-3 * lfilter([np.sqrt(1 - memory**2)], [1, -memory], white)[200:]


@pytest.mark.parametrize(("memory", "ordinary_is_good"), [(0.0, True), (0.5, False), (0.95, False)])
def test_errors_are_those_of_repeated_fits(memory, ordinary_is_good):
    swings = [(TIMES, CLEAN + noise(number, memory)) for number in range(300)]
    fits = [fit_trajectory("viscous", *swing) for swing in swings]
    scatter = np.std([fit.values for fit in fits], axis=0, ddof=1)
    found = [np.diag(uncertainty(fit, [swing]).random) for fit, swing in zip(fits, swings, strict=True)]
    ordinary = np.sqrt(np.mean([np.diag(fit.covariance) for fit in fits], axis=0))
    # 300 copies tell a scatter to 4 %
    assert np.sqrt(np.mean(found, axis=0)) == pytest.approx(scatter, rel=0.15)
    assert (np.abs(ordinary / scatter - 1) < 0.15).all() == ordinary_is_good


def test_a_model_that_misses_something_is_not_called_sure():
    wrong = fit_trajectory("viscous", TIMES, (angle := _with_friction()) + noise(0, 0.0))
    right = fit_trajectory("viscous+constant_coulomb", TIMES, angle + noise(0, 0.0))
    sure, unsure = (uncertainty(fit, [(TIMES, angle + noise(0, 0.0))]) for fit in (right, wrong))
    assert 0.5 < sure.inflation < 1.6
    assert unsure.inflation > 10
    # the wrong model's frequency is off by many of its ordinary errors, and not by many of these
    off = abs(wrong.values[0] - 6.0)
    assert off < 3 * np.sqrt(unsure.random[0, 0])


def _with_friction():
    values = {"natural_frequency": 6.0, "viscous_ratio": 0.01, "constant_friction": 0.02}
    return simulate(Model("viscous+constant_coulomb", values), TIMES, 0.3)


def test_two_swings_alike_halve_the_variance_of_one():
    swing = (TIMES, CLEAN + noise(1, 0.9))
    one, two = fit_trajectory("viscous", *swing), fit_jointly("viscous", [swing, swing])
    alone, both = uncertainty(one, [swing]).random, uncertainty(two, [swing, swing]).random
    # the same residuals twice: the same colour but for the order, which twice as many samples may raise
    assert np.sqrt(np.diag(both)[:2]) == pytest.approx(np.sqrt(np.diag(alone)[:2] / 2), rel=0.1)


@pytest.mark.parametrize("coefficients", [[], [0.7], [1.2, -0.6]])
def test_burg_finds_the_coefficients_and_the_order(coefficients):
    rng = np.random.default_rng(8)
    series = [lfilter([1.0], [1.0, *(-c for c in coefficients)], rng.standard_normal(3000)) for _ in range(4)]
    found = autoregression(series)
    assert found.coefficients == pytest.approx(coefficients, abs=0.03)
    assert found.variance == pytest.approx(1.0, rel=0.05)


def test_the_spectrum_is_that_of_the_process():
    series = np.random.default_rng(9).standard_normal((40, 4000))
    coloured = lfilter([1.0], [1.0, -0.8], series)
    power = np.mean(np.abs(np.fft.rfft(coloured)) ** 2, axis=0) / 4000
    found = autoregression(list(coloured)).spectrum(4000)
    ratio = power / found
    assert [part.mean() for part in np.array_split(ratio, 8)] == pytest.approx([1.0] * 8, rel=0.1)
