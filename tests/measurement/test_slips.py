"""What is made of a swing that is out of step with itself: the part that is in step is used, and it is told."""

import numpy as np
import pytest
from scipy.signal import savgol_filter

from swingdown.errors import InputError, as_told
from swingdown.measurement.judge import Reading, check_used, judge, used_part
from swingdown.measurement.swings.release import within
from swingdown.measurement.swings.slips import out_of_step

TIMES = np.arange(0.0, 60.0, 1 / 30)
RAD = Reading("rad", True, 1.0)


def swing(times):
    return 0.3 * np.exp(-times / 40) * np.cos(2 * np.pi * times / 1.5)


def used(signal, by_hand=(False, False)):
    judged = judge(TIMES, signal, RAD, "here")
    window, told, _ = used_part(judged.windows, by_hand)
    return window, as_told(" ".join(told))


def noisy(signal):
    return signal + np.random.default_rng(3).normal(0, 1e-3, signal.size)


def test_samples_lost_in_the_middle_leave_the_longer_part():
    window, told = used(noisy(swing(TIMES + 0.5 * (TIMES > 40))))
    assert "OUT OF STEP" in told and "start_s and stop_s" in told
    assert np.isnan(window.begins) and 38 < window.ends < 40.1


def test_where_no_part_in_step_is_long_enough_the_mend_names_nothing_that_was_not_stated():
    """As of a double pendulum, which swings in two ways at once: nobody stated a part that could be widened."""
    both = noisy(0.3 * np.exp(-TIMES / 100) * (np.cos(4 * TIMES) + 0.6 * np.cos(9.66 * TIMES + 1)))
    judged = judge(TIMES, both, RAD, "here")
    window, _, _ = used_part(judged.windows)
    with pytest.raises(InputError, match="OUT OF STEP.*passes its middle [0-3] times") as caught:
        check_used(TIMES, judged, within(window, TIMES), "here")
    assert "in one way alone" in caught.value.mend and "start" not in caught.value.mend
    window, _, _ = used_part(judged.windows, (True, True))
    check_used(TIMES, judged, within(window, TIMES), "here")


def test_what_is_in_step_is_used_whole():
    window, told = used(noisy(swing(TIMES)))
    assert not told and np.isnan(window.begins) and np.isnan(window.ends)


def test_stated_ends_are_the_last_word():
    _, told = used(noisy(swing(TIMES + 0.5 * (TIMES > 40))), (True, True))
    assert "OUT OF STEP" not in told


@pytest.mark.parametrize("seed", range(20))
def test_missing_samples_and_stamps_that_scatter_are_no_slip(seed):
    rng = np.random.default_rng(seed)
    kept = np.sort(rng.permutation(TIMES.size)[: int(0.8 * TIMES.size)])
    times = TIMES[kept] + rng.uniform(-0.3, 0.3, kept.size) / 30
    judged = judge(times, swing(times) + rng.normal(0, 2e-3, kept.size), RAD, "here")
    assert not any(one.why for one in judged.windows)


def test_a_tracker_that_loses_the_bob_at_the_end():
    late = TIMES > 57.4
    window, told = used(noisy(np.where(late, np.where(TIMES < 58.1, 0.05, -0.05), swing(TIMES))))
    assert "is used until" in told and 55 < window.ends < 58


@pytest.mark.parametrize("length", [0.2, 0.5, 0.9, 1.6, 4.3])
def test_holes_that_the_times_tell_are_no_slip(length):
    rng = np.random.default_rng(1)
    for start in rng.uniform(5, 50, 12):
        kept = np.flatnonzero(np.abs(TIMES - start - length / 2) > length / 2)
        kept = kept[rng.random(kept.size) > 0.05]
        judged = judge(TIMES[kept], noisy(swing(TIMES))[kept], RAD, "here")
        assert not any(one.why for one in judged.windows)


@pytest.mark.parametrize("seed", range(20))
def test_a_telephone_that_a_hand_takes_before_the_end(seed):
    rng = np.random.default_rng(seed)
    beats = rng.uniform(0.3, 2.0, 6) * 2 * np.pi
    hand = 0.04 * np.sin(np.outer(TIMES, beats) + rng.uniform(0, 6, 6)).sum(axis=1)
    rate = noisy(np.where(TIMES < 50, swing(TIMES), hand))
    window, told, _ = used_part(judge(TIMES, rate, Reading("rad/s", True), "here").windows)
    assert "OUT OF STEP" in told[0] and np.isnan(window.begins) and 47.5 < window.ends < 52


@pytest.mark.parametrize(
    "scatter, late, told", [(0.0, 0.07, True), (0.0, 0.04, False), (0.01, 0.1, True), (0.01, 0.06, False)]
)
def test_a_period_is_odd_beyond_a_twentieth_and_five_times_what_periods_scatter(scatter, late, told):
    """Two longer and two shorter ones take turns, so that what they scatter (1.48 times 1 %) is no matter of chance."""
    periods = 1.5 * (1 + scatter * np.resize([1, 1, -1, -1], 60))
    periods[30] = 1.5 * (1 + late)
    ends = np.concatenate([[0.0], np.cumsum(periods)])
    turns = np.interp(TIMES, ends, np.arange(ends.size))
    found = out_of_step(TIMES, 0.3 * np.exp(-TIMES / 40) * np.cos(2 * np.pi * turns))
    assert any(start - 1.5 < ends[30] < stop for start, stop in found) is told


DERIVED = {
    "differences": lambda angle, rate: np.append(np.diff(angle), 0.0) * rate,
    "central differences": lambda angle, rate: np.gradient(angle, 1 / rate),
    "Savitzky-Golay": lambda angle, rate: savgol_filter(angle, 11, 3, deriv=1, delta=1 / rate),
}


@pytest.mark.parametrize("lost", [0.0, 0.5])
@pytest.mark.parametrize("rate", [30, 60, 100])
@pytest.mark.parametrize("derived", DERIVED)
def test_rates_that_somebody_computed_from_angles_slip_where_the_swing_does(derived, rate, lost):
    """Their noise is that of two angles over an interval: up to a third of the largest rate, many times a passage's own."""
    times = np.arange(0.0, 60.0, 1 / rate)
    for seed in range(5):
        noise = np.random.default_rng(seed).normal(0, 3e-3, times.size)
        signal = DERIVED[derived](swing(times + lost * (times > 30)) + noise, rate)
        window, told, _ = used_part(judge(times, signal, Reading("rad/s", True), "here").windows)
        if lost:
            assert "OUT OF STEP" in told[0]
            ends = (window.begins, window.ends)
            assert any(27 < end < 33 for end in ends) and np.isnan(ends).any()
        else:
            assert not told


@pytest.mark.parametrize("derived", DERIVED)
def test_rates_that_die_into_their_noise_are_let_go_by_no_hand(derived):
    times = np.arange(0.0, 60.0, 1 / 60)
    for seed in range(5):
        angle = 0.3 * np.exp(-times / 15) * np.cos(2 * np.pi * times / 1.5)
        angle += np.random.default_rng(seed).normal(0, 1e-3, times.size)
        judged = judge(times, DERIVED[derived](angle, 60), Reading("rad/s", True), "here")
        assert len(judged.windows) == 1 and not used_part(judged.windows)[1]
