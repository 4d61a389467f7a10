"""Half-swings of a signal: where they begin, how far they go, when they pass their middle; and how long the ideal pendulum takes."""

import numpy as np
import pytest
from scipy.integrate import quad

from swingdown.pendulum.half_swings import (
    LARGEST,
    Swings,
    half_swings,
    lengthening,
    middle_crossings,
    middles,
    passages,
    reached,
)

TIMES = np.arange(1001) / 100
PERIOD = 1.3
SWING = np.cos(2 * np.pi * TIMES / PERIOD)


def test_a_swing_has_a_turning_point_between_every_two_passages():
    found = half_swings(SWING, middle=0.0)
    assert len(found.starts) == 16  # of 10 s at 1.3 s, the first and the last one cut
    np.testing.assert_allclose(found.turns, [1, -1] * 8, atol=2e-3)
    assert found.period(TIMES) == pytest.approx(PERIOD, abs=0.01)
    assert found.centre() == pytest.approx(0, abs=1e-3)


def test_half_swings_begin_beyond_a_twentieth_of_the_range():
    begin = half_swings(SWING, middle=0.0).starts
    assert begin[0] == 0 and np.all(np.abs(SWING[begin]) > 0.1 * 0.99)
    assert np.all(np.abs(SWING[begin[1:] - 1]) < 0.1)
    rippled = SWING + 0.03 * np.cos(2 * np.pi * 20 * TIMES)  # passes the middle many times, within the zone
    assert len(half_swings(rippled, middle=0.0).starts) == len(begin)


def test_the_middle_is_that_of_the_later_half_for_the_first_may_be_held():
    held = np.concatenate([np.full(300, 5.0), SWING])
    assert half_swings(held).turns[-1] == pytest.approx(half_swings(SWING).turns[-1])
    about = half_swings(SWING + 3.0, middle=3.0)
    np.testing.assert_array_equal(about.starts, half_swings(SWING, middle=0.0).starts)
    np.testing.assert_allclose(about.turns, half_swings(SWING, middle=0.0).turns + 3.0)


def test_a_spike_makes_no_swing_of_the_others_nothing():
    spiked = SWING.copy()
    spiked[500] = 1000.0
    assert abs(len(half_swings(spiked, 0.0).starts) - 16) <= 2


def test_where_nothing_swings_there_is_no_half_swing():
    still = half_swings(np.full(50, 2.0))
    assert len(still.starts) == 0 and len(still.turns) == 0
    assert np.isnan(still.period(TIMES[:50])) and np.isnan(still.centre())


def test_a_period_needs_three_passages():
    times = np.arange(5.0)
    assert np.isnan(Swings(np.array([0, 2]), np.array([1.0, -1.0])).period(times))
    assert Swings(np.array([0, 2, 4]), np.array([1.0, -1.0, 1.0])).period(times) == 4.0


def test_the_middle_of_three_turns_is_left_alone_by_decay():
    np.testing.assert_allclose(middles(np.array([4.0, -2.0, 2.0, 0.0])), [0.5, 0.5])
    assert middles(np.array([4.0, -2.0])).size == 0 and middles(np.array([4.0, -2.0, 2.0])).size == 1
    cut = Swings(np.arange(5), np.array([9.0, -2.0, 2.0, -2.0, 9.0]))
    np.testing.assert_allclose(cut.centres(), [0.0])  # the first and the last may be cut
    assert cut.centre() == 0.0
    assert np.isnan(Swings(np.arange(4), np.array([9.0, -2.0, 2.0, -2.0])).centre())


def test_the_middle_is_passed_between_two_samples():
    slow = TIMES[::10]
    found = passages(slow, np.cos(2 * np.pi * slow / PERIOD), 0.0)
    np.testing.assert_allclose(found, PERIOD * (0.25 + 0.5 * np.arange(len(found))), atol=0.003)
    assert len(found) == 15
    beside = passages(TIMES, SWING, 0.5)  # passed at a sixth of a period from each top
    np.testing.assert_allclose(beside[:3], [PERIOD / 6, PERIOD * 5 / 6, PERIOD * 7 / 6], atol=1e-3)


def test_of_a_middle_that_is_passed_back_and_forth_the_last_time_counts():
    times = np.arange(8.0)
    found = passages(times, np.array([10.0, 0.4, -0.4, 0.4, -0.4, -10.0, -10.0, 10.0]), 0.0)
    np.testing.assert_allclose(found, [3.5, 6.5])


def test_a_noisy_swing_crosses_its_middle_once_a_half_swing_and_turns_between():
    noise = 0.02 * np.random.default_rng(4).standard_normal(TIMES.size)
    crossings, extremes = middle_crossings(TIMES, np.exp(-0.05 * TIMES) * SWING + noise)
    expected = PERIOD * (np.arange(15) + 0.5) / 2
    np.testing.assert_allclose(crossings, expected, atol=0.01)
    np.testing.assert_allclose(extremes, np.exp(-0.05 * (expected[:-1] + PERIOD / 4)), atol=0.06)


def by_quadrature(amplitude):
    """The same by the time from the middle to the turn, with sin(angle / 2) = sin(amplitude / 2) sin(phase)."""
    share = np.sin(amplitude / 2)
    return quad(lambda phase: 1 / np.sqrt(1 - (share * np.sin(phase)) ** 2), 0, np.pi / 2)[0] * 2 / np.pi


def test_it_is_the_period_of_the_undamped_pendulum_whichever_side_it_swings_to():
    amplitudes = np.array([0.0, 0.1, -0.1, 1.0, np.pi / 2, 2.9])
    found = lengthening(amplitudes)
    assert found == pytest.approx([by_quadrature(one) for one in amplitudes], rel=1e-10)
    assert found[0] == 1 and found[4] == pytest.approx(1.18034, rel=1e-5)


def test_near_the_top_it_stays_finite():
    assert lengthening(np.pi) == lengthening(LARGEST) == pytest.approx(by_quadrature(3.0), rel=1e-9)


def test_a_pendulum_that_is_so_fast_where_it_hangs_turns_where_its_energy_is_used_up():
    angle = np.array([-2.5, -0.3, 0.0, 0.3, 2.5])
    fast = np.sign(angle) * np.sqrt(2 * (1 - np.cos(angle)))
    assert reached(fast) == pytest.approx(angle)
    assert reached(np.array([2.5, -2.5])) == pytest.approx([np.pi, -np.pi])  # it goes over
    assert reached(fast, "linear") == pytest.approx(fast)
