"""A recording on an even grid: holes are found, and the swing beside them says what was there."""

import numpy as np
import pytest

from swingdown.measurement.swings.even import evenly

TIMES = np.arange(400) / 100


def swing(times):
    return np.cos(2 * np.pi * times / 1.3)


def without(*holes):
    """The times less those in some (first, after the last) stretches of samples."""
    return np.delete(TIMES, np.concatenate([np.arange(*hole) for hole in holes]))


def test_even_samples_stay_as_they_are():
    signal = swing(TIMES)
    found = evenly(TIMES, signal)
    assert found.times is TIMES and found.signal is signal
    assert found.kept and found.holes() == [] and found.deep(1.3) == []
    assert found.interval == pytest.approx(0.01)


@pytest.mark.parametrize(("count", "is_given"), [(3, True), (4, False)])
def test_three_samples_have_no_hole_and_four_may(count, is_given):
    times = np.array([0.0, 0.1, 0.2, 0.5])[-count:]
    found = evenly(times, np.zeros(count))
    assert (found.times is times) == is_given
    assert found.kept and found.missing.sum() == (0 if is_given else 2)


def test_a_missing_sample_is_filled_by_a_cubic():
    there = without((100, 101), (200, 203))
    found = evenly(there, swing(there))
    np.testing.assert_allclose(found.times, TIMES, atol=1e-12)
    assert found.kept and found.holes() == [(100, 101), (200, 203)]
    np.testing.assert_array_equal(found.times[found.place], there)
    np.testing.assert_array_equal(found.signal[found.place], swing(there))
    np.testing.assert_allclose(found.signal, swing(TIMES), atol=1e-4)
    cubic = evenly(there, there**3)
    np.testing.assert_allclose(cubic.signal, TIMES**3, atol=1e-9)


def test_a_hole_of_half_an_interval_is_one_and_a_smaller_is_jitter():
    late = TIMES.copy()
    late[200:] += 0.006  # a step of 1.6 intervals counts as two
    assert evenly(late, swing(late)).holes() == [(200, 201)]
    late[200:] -= 0.002  # of 1.4 as one
    assert evenly(late, swing(late)).holes() == []


def test_across_a_quarter_of_a_period_a_swing_is_not_followed():
    there = without((100, 120), (200, 240))
    found = evenly(there, swing(there))
    ((begin, end),) = found.deep(1.3)  # holes of 0.21 s and 0.41 s
    assert (begin, end) == pytest.approx((1.99, 2.4))
    assert len(found.deep(0.8)) == 2 and found.deep(1.7) == []
    assert np.abs(found.signal).max() < 3  # nor does a cubic run away there


def test_what_fills_a_long_hole_stays_near_the_samples_beside_it():
    times = np.array([0.0, 1.0, 2.0, 12.0, 13.0, 14.0])
    found = evenly(times, np.array([0.0, 10.0, 0.0, 1.0, -9.0, 0.0]))
    inside = found.signal[found.missing]
    assert inside.size == 9 and inside.min() >= -1 and inside.max() == pytest.approx(2.0)


def test_samples_without_a_rate_are_read_between_their_neighbours():
    times = np.sort(np.random.default_rng(3).uniform(0, 4, 800))
    found = evenly(times, swing(times))
    assert not found.kept
    np.testing.assert_allclose(np.diff(found.times), found.interval)
    assert (found.times[0], found.times[-1]) == (times[0], times[-1])
    usual = np.median(np.diff(times))
    assert abs(np.ptp(times) - (found.times.size - 1) * usual) <= usual / 2
    np.testing.assert_allclose(found.signal, swing(found.times), atol=1e-3)
    assert found.place.size == 800 and found.place.max() == found.times.size - 1
