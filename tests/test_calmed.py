"""A rate by polynomials through half a period about each sample."""

import numpy as np
import pytest
from scipy.signal import savgol_filter

from swingdown.calmed import DEGREE, calmed


@pytest.mark.parametrize(("ends_quiet", "whole"), [(True, slice(53, -53)), (False, slice(None))])
def test_a_rate_is_smoothed_as_another_library_smooths_it(ends_quiet, whole):
    times = np.arange(2000) / 100
    rate = np.exp(-0.1 * times) * np.sin(6 * times) + np.random.default_rng(5).normal(0, 0.05, times.size)
    smooth = savgol_filter(rate, 53, DEGREE)  # half of a period
    assert np.allclose(calmed(times, rate, ends_quiet)[whole], smooth[whole], atol=1e-9)
