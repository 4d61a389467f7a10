"""Half-swings between turning points are counted where times are multiples of one interval, and nowhere else."""

import numpy as np
import pytest

from swingdown.measurement.points.swing_counts import counts
from swingdown.pendulum.half_swings import lengthening


def found(times, sizes=None):
    """The numbers of the points that are counted, and the first and last of these."""
    told = counts(times, np.zeros(times.size) if sizes is None else sizes)
    return told and (list(told[0]), told[1].start, told[1].stop)


@pytest.mark.parametrize(
    "number", [range(6), [0, 1, 2, 3, 5, 6, 9], [0, 2, 3, 4, 5, 6], [0, 1, 4, 5, 6, 7, 8, 20, 21, 22, 23]]
)
def test_points_that_were_left_out_are_counted(number):
    times = 3.0 + 0.7 * np.array(number)
    assert found(times) == (list(number), 0, len(number))
    noisy = times + 0.01 * np.random.default_rng(1).standard_normal(times.size)
    assert found(noisy) == (list(number), 0, len(number))


def test_of_five_points_nothing_is_told():
    assert found(0.7 * np.arange(5)) is None


def test_times_that_have_no_interval_in_common_are_not_counted():
    assert found(np.cumsum(np.random.default_rng(5).uniform(1, 2, 20))) is None


def test_the_largest_interval_is_taken_of_which_all_gaps_are_multiples():
    """Gaps of 2 and 3 intervals, of which none follow each other."""
    number = np.cumsum([0, 2, 3, 2, 2, 3, 3, 2, 3, 2])
    assert found(1.1 * number) == (list(number), 0, 10)
    assert found(2.2 * np.arange(10)) == (list(range(10)), 0, 10)


def test_the_longest_part_that_can_be_counted_is_used():
    early = 0.7 * np.arange(12)
    late = early[-1] + np.cumsum(np.random.default_rng(5).uniform(3, 5, 5))
    numbers, start, stop = found(np.append(early, late))
    assert start == 0 and stop >= 12 and numbers[:12] == list(range(12))
    assert found(np.append(early, late - 1.234))[2] < 17
    numbers, start, stop = found(np.append(-late[::-1], early - early[0]))
    assert stop == 17 and numbers[-12:] == list(range(numbers[-12], numbers[-12] + 12))


def test_large_swings_take_longer_as_their_sizes_tell():
    """From 2.6 rad down a half-swing becomes shorter by a third, which is no point left out."""
    sizes = 2.6 * np.exp(-np.arange(30) / 8)
    gaps = 0.7 * lengthening((sizes[1:] + sizes[:-1]) / 2)
    times = np.append(0.0, np.cumsum(gaps))
    assert np.ptp(gaps) > 0.3 * gaps.min()
    assert found(times, sizes) == (list(range(30)), 0, 30)
    kept = np.delete(np.arange(30), [5, 6, 14])
    assert found(times[kept], sizes[kept]) == (list(kept), 0, 27)


def test_sizes_that_are_no_angles_are_not_heeded():
    """Readings taken for large angles would have intervals of their own."""
    times, sizes = 0.7 * np.arange(20), np.linspace(3.0, 0.5, 20)
    assert found(times, sizes) == (list(range(20)), 0, 20)


@pytest.mark.parametrize(("scatter", "counted"), [(0.05, True), (0.3, False)])
def test_times_may_scatter_by_little_of_the_interval(scatter, counted):
    times = np.arange(40) + scatter * np.random.default_rng(4).uniform(-1, 1, 40)
    assert (found(times) is not None) is counted
