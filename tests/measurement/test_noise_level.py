"""A recording's noise is told from its spectrum, its colour by the likelihood, and from what smooth pieces of the swing leave."""

import numpy as np
import pytest
from scipy.linalg import toeplitz
from scipy.signal import lfilter
from scipy.stats import multivariate_normal

from swingdown.errors import InputError
from swingdown.measurement.swings.noise_level import (
    noise_by_times,
    noise_level,
    noise_of,
    scatter,
    too_quiet,
    whittle,
    whittle_cost,
)


def swing(times):
    return 0.5 * np.exp(-0.02 * times) * np.cos(7.25 * times)


def noise(size, seed=1, correlation=0.0):
    """Noise of deviation 1."""
    white = np.random.default_rng(seed).standard_normal(size + 300)
    return lfilter([np.sqrt(1 - correlation**2)], [1, -correlation], white)[300:]


@pytest.mark.parametrize("rate", [20, 40, 100, 1000])
def test_the_level_of_white_noise_is_told_at_any_rate(rate):
    times = np.arange(6000) / rate
    for unit in (1.0, 1000.0):
        level = noise_level(times, unit * (swing(times) + 2e-3 * noise(times.size)))
        assert level == pytest.approx(unit * 2e-3, rel=0.12)


def test_the_level_is_that_between_15_and_50_hz():
    """Twice as much noise above, and a strong line within, change nothing."""
    times = np.arange(20_000) / 500
    spectrum = np.fft.rfft(noise(times.size))
    frequency = np.fft.rfftfreq(times.size, 1 / 500)
    for low, high in ((0, 15), (50, 250)):
        louder = np.where((frequency > low) & (frequency < high), 4, 1) * spectrum
        read = swing(times) + 2e-3 * np.fft.irfft(louder) + 0.1 * np.cos(2 * np.pi * 30 * times)
        assert noise_level(times, read) == pytest.approx(2e-3, rel=0.1)
    louder = np.where((frequency > 15) & (frequency < 50), 4, 1) * spectrum
    assert noise_level(times, swing(times) + 2e-3 * np.fft.irfft(louder)) == pytest.approx(8e-3, rel=0.1)


def test_too_few_samples_for_a_spectrum_are_refused():
    times = np.arange(63) / 20
    with pytest.raises(InputError, match="63 samples"):
        noise_level(times, swing(times))
    assert noise_level(np.arange(64) / 20, noise(64)) > 0
    assert not too_quiet(times, swing(times))


@pytest.mark.parametrize("size", [0.0, 1e-8, 3e-6])
def test_a_swing_that_was_computed_is_quieter_than_any_sensor(size):
    """Than a millionth of the swing's size, 0.5."""
    times = np.arange(3000) / 100
    assert too_quiet(times, swing(times) + size * noise(3000)) == (size < 5e-7)


@pytest.mark.parametrize("correlation", [-0.5, 0.3, 0.9])
def test_the_likelihood_of_a_colour_is_that_of_its_spectrum(correlation):
    """At the spectrum itself no other colour is likelier, and the innovations have the variance that made it."""
    cosine = np.cos(np.pi * (np.arange(4000) + 0.5) / 4000)
    power = 0.04 / (1 + correlation**2 - 2 * correlation * cosine)
    found = whittle(cosine, power)
    assert found.correlation == pytest.approx(correlation, abs=1e-3)
    assert found.deviation == pytest.approx(0.2 / np.sqrt(1 - correlation**2), rel=1e-3)
    assert found.known == pytest.approx(1 / np.sqrt(4000))
    assert whittle(cosine, power, independent=0.25).known == pytest.approx(1 / np.sqrt(1000))
    assert whittle_cost(correlation, cosine, power)[1] == pytest.approx(0.04)


def test_whittle_s_likelihood_goes_as_that_of_the_samples():
    """Of 256 samples the exact likelihood, of their covariance, differs between two colours by as much."""
    samples = noise(256, correlation=0.4)
    frequency = 2 * np.pi * np.arange(1, 128) / 256
    power = np.abs(np.fft.rfft(samples)[1:128]) ** 2 / 256

    def exact(correlation):
        variance = whittle_cost(correlation, np.cos(frequency), power)[1]
        covariance = toeplitz(variance * correlation ** np.arange(256) / (1 - correlation**2))
        return -multivariate_normal.logpdf(samples, cov=covariance)

    for other in (0.2, 0.6):
        whittles = [whittle_cost(one, np.cos(frequency), power)[0] for one in (other, 0.4)]
        assert whittles[0] - whittles[1] == pytest.approx(exact(other) - exact(0.4), abs=1.0)


def test_white_noise_is_white_and_a_colour_that_few_samples_do_not_show_is_none():
    cosine = np.cos(np.pi * (np.arange(2000) + 0.5) / 2000)
    power = np.random.default_rng(2).exponential(0.04, 2000)
    found = whittle(cosine, power)
    assert found.correlation == 0 and found.deviation == pytest.approx(0.2, rel=0.05)
    weak = 0.04 / (1 + 0.1**2 - 2 * 0.1 * cosine)  # 2000 * 0.01 / 2 = 10 above BIC's ln(2000) / 2 = 3.8
    assert whittle(cosine, weak).correlation > 0
    assert whittle(cosine[::10], weak[::10]).correlation == 0


def test_coloured_noise_beside_a_swing_keeps_its_size_and_white_noise_its_level():
    times = np.arange(12_000) / 100
    found = noise_of(times, swing(times) + 2e-3 * noise(times.size, 3, 0.6))
    assert found.correlation == pytest.approx(0.6, abs=0.1) and found.deviation == pytest.approx(
        2e-3, rel=0.15
    )
    white = swing(times) + 2e-3 * noise(times.size, 3)
    assert noise_of(times, white) == (noise_level(times, white), 0, 0)


def test_pieces_of_any_times_leave_what_a_polynomial_through_each_leaves():
    """As numpy's least squares have it, with 8 - 3 - 1 degrees of freedom."""
    times = np.sort(np.random.default_rng(4).uniform(0, 3, 42))
    read = swing(times) + 0.01 * noise(42)
    expected = []
    for k in range(0, 40, 8):
        part = slice(k, k + 8)
        left = read[part] - np.polyval(np.polyfit(times[part], read[part], 3), times[part])
        expected.append(np.sum(left**2) / 4)
    np.testing.assert_allclose(scatter(times, read, 8, 3), expected, rtol=1e-6)


@pytest.mark.parametrize(("rate", "period"), [(100, 0.8667), (12, 0.8667), (60, np.nan)])
def test_noise_of_samples_that_keep_no_rate(rate, period):
    """Fitted over less than half a period; where none is told the samples are few, and no curve is left out."""
    size = 4000 if period == period else 24
    times = np.sort(np.random.default_rng(5).uniform(0, size / rate, size))
    found = [noise_by_times(times, swing(times) + 0.01 * noise(size, seed), period) for seed in range(9)]
    assert np.median(found) == pytest.approx(0.01, rel=0.08 if period == period else 0.3)
