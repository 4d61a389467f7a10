"""Means, standard deviations and lag-1 correlations against NIST's univariate reference sets, made to cancel digits.

Source: NIST StRD, univariate summary statistics, NumAcc1 to NumAcc4 (constructed by rule, certified values exact).
"""

import numpy as np
import pytest

from swingdown.measurement.uncertainty import mean_of_samples
from swingdown.studies.paper_tables import statistics


def alternating(first, low, high):
    return np.array([first, *[low, high] * 500])


# name: samples, mean, standard deviation, lag-1 autocorrelation
CASES = {
    "NumAcc1": (np.array([10000001.0, 10000003.0, 10000002.0]), 10000002.0, 1.0, -0.5),
    "NumAcc2": (alternating(1.2, 1.1, 1.3), 1.2, 0.1, -0.999),
    "NumAcc3": (alternating(1000000.2, 1000000.1, 1000000.3), 1000000.2, 0.1, -0.999),
    "NumAcc4": (alternating(10000000.2, 10000000.1, 10000000.3), 10000000.2, 0.1, -0.999),
}


def agreement(name):
    """Relative agreement that double precision allows: the data's own rounding, their size over their scatter."""
    return {"NumAcc3": 1e-9, "NumAcc4": 1e-8}.get(name, 1e-13)


@pytest.mark.parametrize("name", CASES)
def test_mean_and_standard_deviation_of_the_tables(name):
    samples, mean, deviation, _ = CASES[name]
    found = statistics(samples)
    assert found[0] == pytest.approx(mean, rel=1e-14)
    assert found[1] == pytest.approx(deviation, rel=agreement(name))
    assert found[2] == samples.size


@pytest.mark.parametrize("name", CASES)
def test_mean_of_a_static_record(name):
    samples, mean, deviation, correlation = CASES[name]
    found = mean_of_samples(samples)
    assert found.value == pytest.approx(mean, rel=1e-14)
    assert found.standard_deviation == pytest.approx(deviation, rel=agreement(name))
    assert found.lag_1 == pytest.approx(correlation, rel=10 * agreement(name))
    assert found.effective_samples <= samples.size  # anticorrelated samples are not counted for more
