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
