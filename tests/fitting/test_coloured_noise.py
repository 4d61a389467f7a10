"""The colour of residuals and the lines in their spectrum."""

import numpy as np
import pytest
from noisy import HUMMED, lost, noise, with_hum
from scipy.linalg import toeplitz
from scipy.signal import lfilter

from swingdown.fitting.coloured_noise import autoregression, lines_of, weighted
from swingdown.fitting.least_squares import fit_trajectory


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


@pytest.mark.parametrize(
    ("rate", "above", "found"), [(200, 0.06, [0.25]), (120, 0.1, [50 / 120]), (200, 0.3, [])]
)
def test_lines_are_found_beyond_a_frequency_with_their_size(rate, above, found):
    times, angle = with_hum(rate, 1)
    residual = angle - fit_trajectory(HUMMED.label, times, angle).angle
    lines = list(lines_of(residual, above))
    assert [line.amplitude for line in lines] == pytest.approx([7e-4] * len(found), rel=0.02)
    for line, frequency in zip(lines, found, strict=True):
        peak = np.argmax(np.abs(np.fft.rfft(line.fitted))) / line.fitted.size
        assert peak == pytest.approx(frequency, abs=1 / line.fitted.size)
    assert np.std(residual - sum(line.fitted for line in lines)) < (1.1e-4 if found else 6e-4)


def test_white_noise_has_no_line():
    counted = [len(list(lines_of(noise(number, 0.0), 0.1))) for number in range(200)]
    assert sum(counted) <= 2


@pytest.mark.parametrize("how", ["at random", "in bursts", "every third"])
def test_a_line_is_found_across_holes_and_a_slow_wave_is_none(how):
    times, angle = with_hum(200, 1)
    residual = angle - fit_trajectory(HUMMED.label, times, angle).angle
    kept = lost(how, times.size, np.random.default_rng(4))
    at = np.flatnonzero(kept).astype(float)
    (line,) = lines_of(residual[kept], 0.06, at)
    assert line.amplitude == pytest.approx(7e-4, rel=0.03)
    assert np.std(residual[kept] - line.fitted) < 1.2e-4
    slow = 1e-3 * np.sin(7 * times) + 1e-4 * np.random.default_rng(2).standard_normal(times.size)
    assert sum(one.amplitude for one in lines_of(slow[kept], 0.06, at)) < 1e-4


@pytest.mark.filterwarnings("error::RuntimeWarning")
def test_a_series_that_is_foretold_to_rounding_has_a_colour_in_numbers():
    """A reflection is then 1, or by rounding more: what it leaves has no logarithm."""
    rates = [0.0, *np.random.default_rng(1).uniform(0, 1e-3, 200)]
    found = [autoregression([1e-9 * np.cos(rate * np.arange(300))]) for rate in rates]
    assert all(one.variance >= 0 and np.isfinite(one.coefficients).all() for one in found)


def autocovariance(colour, size):
    """Of the first ``size`` delays, by how the process rings on."""
    ringing = lfilter([1.0], np.append(1.0, -colour.coefficients), np.eye(1, 4 * size)[0])
    return np.array([colour.variance * ringing[k:] @ ringing[: ringing.size - k] for k in range(size)])


@pytest.mark.parametrize("size", [60, 61])
def test_slopes_meet_the_noise_as_its_whole_covariance_says(size):
    slopes = np.random.default_rng(2).standard_normal((3, size))
    colour = autoregression([noise(2, 0.6), noise(3, 0.6)])
    assert colour.coefficients.size > 0
    whole = toeplitz(autocovariance(colour, size))
    assert weighted(slopes, colour) == pytest.approx(slopes @ whole @ slopes.T, rel=1e-6)


def test_the_order_is_the_one_that_the_criterion_prefers():
    """BIC by hand of each order up to the highest, which is asked for with an ample number of samples alone."""
    series = lfilter([1.0], [1.0, -0.5, 0.0, 0.3], np.random.default_rng(4).standard_normal(400))
    orders = []
    for order in range(13):
        # Burg's errors of prediction both ways, of the coefficients found so far
        ahead, behind, left = series, series, series @ series / 400
        for _ in range(order):
            one, other = ahead[1:], behind[:-1]
            share = 2 * (one @ other) / (one @ one + other @ other)
            ahead, behind, left = one - share * other, other - share * one, left * (1 - share**2)
        orders.append(400 * np.log(left) + order * np.log(400))
    assert autoregression([series]).coefficients.size == np.argmin(orders) == 3
    assert autoregression([series[:59]]).coefficients.size <= 2
