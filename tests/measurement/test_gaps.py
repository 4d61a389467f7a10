"""What is said of samples that are missing, and whether the swings that a hole hides can be counted."""

import numpy as np
import pytest

from swingdown.errors import InputError
from swingdown.measurement.swings.even import evenly
from swingdown.measurement.swings.gaps import check_countable, missing_samples, uncounted

PERIOD = 1.3
TIMES = np.arange(6000) / 100


def swing(times, period=PERIOD):
    return np.exp(-times / 200) * np.cos(2 * np.pi * times / period)


def without(*holes):
    """The times less those in some (from, to) stretches, in s."""
    there = np.ones(TIMES.size, dtype=bool)
    for start, stop in holes:
        there &= (start >= TIMES) | (stop <= TIMES)
    return TIMES[there]


def remark(times):
    return missing_samples(evenly(times, swing(times)), times)


def test_of_a_recording_without_holes_nothing_is_said():
    assert remark(TIMES) == []


def test_missing_samples_are_counted_and_the_longest_hole_measured():
    (said,) = remark(without((10.0, 10.02), (20.0, 20.1)))
    assert said.startswith("10 of 6000 samples are missing, the longest hole 0.09 s")


def test_times_without_a_rate_are_told_with_their_scatter():
    times = np.sort(np.random.default_rng(1).uniform(0, 60, 6000))
    (said,) = remark(times)
    steps = np.diff(times)
    assert f"varies by {np.std(steps) / np.median(steps):.2g} of {np.median(steps):.4g} s" in said


@pytest.mark.parametrize("holes", [[], [(20.0, 20.4)], [(20.0, 26.0)], [(10.0, 14.0), (30.0, 33.0)]])
def test_the_swings_in_a_hole_are_counted_from_those_beside_it(holes):
    times = without(*holes)
    assert uncounted(times, swing(times)) is None
    check_countable(times, swing(times), "swing.csv")


def test_a_hole_beside_swings_of_another_period_hides_how_many_there_were():
    times = without((20.0, 30.0))
    signal = np.where(times < 25, swing(times), swing(times, 1.4))
    hidden = uncounted(times, signal)
    assert (hidden.start, hidden.stop) == pytest.approx((20.0, 30.0))
    assert hidden.swings == pytest.approx(10 / 1.35, rel=0.06)
    assert hidden.part == pytest.approx((30.0, 59.99))  # the longer one
    assert (
        hidden.words()
        == f"a hole of 10 s hides about {hidden.swings:.0f} swings; how many exactly is not known"
    )
    with pytest.raises(InputError, match="use a part: from 30 to 59.99 s") as refused:
        check_countable(times, signal, "swing.csv")
    assert "swing.csv, 20 s" in str(refused.value) and "start_s" in str(refused.value)


def test_a_period_that_differs_by_less_than_a_quarter_of_a_swing_in_all_is_counted():
    times = without((20.0, 24.0))  # three swings
    for period, counted in ((1.31, True), (1.5, False)):
        signal = np.where(times < 22, swing(times), swing(times, period))
        assert (uncounted(times, signal) is None) == counted


def test_the_longest_part_lies_between_the_holes():
    times = without((5.0, 8.0), (50.0, 58.0))
    hidden = uncounted(times, np.where(times < 6, swing(times), swing(times, 1.5)))
    assert hidden.start == pytest.approx(5.0) and hidden.part == pytest.approx((8.0, 50.0))


def test_a_hole_shorter_than_half_a_swing_hides_none():
    for end, hides in ((20.6, False), (21.0, True)):
        times = without((20.0, end))
        signal = np.where(times < 20.3, swing(times), swing(times, 4.0))
        assert (uncounted(times, signal) is not None) == hides
