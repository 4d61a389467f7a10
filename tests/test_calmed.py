"""A rate by polynomials through half a period about each sample."""

import numpy as np
import pytest

from swingdown.calmed import calmed


@pytest.mark.parametrize(("ends_quiet", "whole"), [(True, slice(53, -53)), (False, slice(None))])
def test_a_rate_keeps_its_swing_and_loses_most_of_its_noise(ends_quiet, whole):
    times = np.arange(2000) / 100
    true, noise = np.exp(-0.1 * times) * np.sin(6 * times), 0.05
    rate = true + np.random.default_rng(5).normal(0, noise, times.size)
    left = (calmed(times, rate, ends_quiet) - true)[whole]
    assert np.sqrt(np.mean(left**2)) < 0.35 * noise
    assert np.max(np.abs(left)) < 3 * noise


def test_what_has_few_samples_a_swing_is_left_as_it_is():
    times = np.arange(200) / 12
    rate = np.sin(6 * times)
    assert calmed(times, rate) is rate


@pytest.mark.parametrize("power", [1, 3, 4])
def test_what_a_quartic_follows_stays_as_it_is_even_between_uneven_samples(power):
    """A swing beside it tells how wide the polynomials are; that itself loses 0.04 % of its size."""
    draws = np.random.default_rng(2)
    times = np.sort(np.arange(2000) / 100 + 0.002 * draws.random(2000))
    swing = np.sin(6 * times)
    trend = 0.1 * ((times - 10) / 10) ** power
    left = calmed(times, swing + trend, ends_quiet=False) - calmed(times, swing, ends_quiet=False) - trend
    assert np.abs(left).max() < 1e-4


def test_noise_falls_to_what_a_quartic_through_half_a_period_leaves_in_its_middle():
    """Through 53 samples, by the weights of such a filter (Savitzky and Golay, 1964)."""
    times = np.arange(20_000) / 100
    noise = np.random.default_rng(5).standard_normal(times.size)
    swing = 100 * np.sin(2 * np.pi * times / 1.06)
    left = (calmed(times, swing + noise) - calmed(times, swing))[200:-200]
    place = np.arange(-26, 27)
    weights = np.linalg.pinv(np.vander(place / 26, 5, increasing=True))[0]
    assert np.std(left) == pytest.approx(np.sqrt(np.sum(weights**2)), rel=0.05)


def test_beyond_its_ends_a_swing_goes_on_as_half_a_period_away():
    times = np.arange(1060) / 100
    swing = np.sin(2 * np.pi * times / 1.06)
    np.testing.assert_allclose(calmed(times, swing), swing, atol=2e-3)
    np.testing.assert_allclose(calmed(times, 5 + swing), 5 + calmed(times, swing), atol=1e-6)
