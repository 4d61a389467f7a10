"""Times of passages alone: the period, the first one, and how it changes."""

import numpy as np
import pytest
from scipy.special import ellipk

from swingdown.errors import InputError
from swingdown.fitting.passages import both_ways, pace

HALVES = np.arange(81)


def passed(change, noise=0.0, seed=1):
    """Passages of a pendulum whose period falls evenly from 2 s by ``change`` over 40 periods."""
    swings = HALVES / 2
    times = 2.0 * swings + change * swings**2 / 80
    return times + noise * np.random.default_rng(seed).standard_normal(HALVES.size)


def test_a_steady_pendulum_has_one_period():
    found = pace(passed(0.0, 1e-3), HALVES)
    assert found.period == pytest.approx(2.0, abs=4 * found.u_period) and 0 < found.u_period < 1e-3
    assert found.change == pytest.approx(0.0, abs=4 * found.u_change)
    assert found.scatter == pytest.approx(1e-3, rel=0.25) and found.residuals.std() == pytest.approx(
        1e-3, rel=0.25
    )


def test_a_period_that_falls_has_its_first_its_middle_and_its_change():
    """Of 40 periods the first is half a swing from the start, the last as much from the end."""
    found = pace(passed(-0.04), HALVES)
    assert found.first == pytest.approx(2.0 - 0.04 * 0.5 / 40, abs=1e-9)
    assert found.period == pytest.approx(1.98, abs=1e-9)
    assert found.change == pytest.approx(-0.04 * 39 / 40, abs=1e-9)


def test_the_truth_lies_within_two_uncertainties_as_often_as_it_should():
    truth = {"first": 2.0 - 0.04 * 0.5 / 40, "period": 1.98, "change": -0.04 * 39 / 40}
    many = [pace(passed(-0.04, 1e-3, seed), HALVES) for seed in range(300)]
    for name, value in truth.items():
        away = [(getattr(one, name) - value) / getattr(one, f"u_{name}") for one in many]
        assert 0.9 < np.mean(np.abs(away) < 1.96) < 0.99, name


def test_a_clock_and_its_steps_make_it_less_sure():
    exact = pace(passed(-0.04), HALVES)
    assert exact.u_period < 1e-6
    clocked = pace(passed(-0.04), HALVES, clock=1e-3)
    assert clocked.u_period == pytest.approx(1e-3 * clocked.period, rel=1e-3)
    assert clocked.u_change == pytest.approx(1e-3 * abs(clocked.change), rel=1e-3)
    stepped = pace(np.round(passed(-0.04), 2), HALVES, step=0.01)
    assert stepped.scatter >= 0.01 / np.sqrt(12)


def test_exact_times_take_no_more_terms_than_they_need():
    """A bend of some picoseconds in 80 s is rounding: terms that follow it would make the ends less sure."""
    rounding = 2e-12 * np.cos(6 * np.arccos(HALVES / 40 - 1))
    found, straight = pace(passed(0.0) + rounding, HALVES), pace(passed(0.0), HALVES)
    assert found.u_first / found.u_period == pytest.approx(straight.u_first / straight.u_period, rel=0.1)
    assert found.residuals == pytest.approx(rounding, abs=1e-12)


def test_a_course_of_a_tenth_of_a_microsecond_is_followed():
    """Of exact times, as a simulation has them: its fourth power is not rounding."""
    at = HALVES / 40 - 1
    found = pace(passed(0.0) + 1e-7 * at**4, HALVES)
    assert np.abs(found.residuals).max() < 1e-11


def test_passages_that_are_missing_are_counted_over():
    there = np.delete(np.arange(81), [7, 30, 31, 32])
    assert pace(passed(-0.04)[there], HALVES[there]).first == pytest.approx(1.9995, abs=1e-9)


def test_too_few_passages_are_refused_and_five_are_enough():
    with pytest.raises(InputError, match="there are 4 of them"):
        pace(passed(0.0)[:4], HALVES[:4])
    assert pace(passed(0.0)[:5], HALVES[:5]).period == pytest.approx(2.0)


def test_a_gate_beside_the_middle_is_taken_off():
    """Passed one way the pendulum is late and the other way early, the more the smaller it swings."""
    late = 0.01 * np.exp(HALVES / 80) * (-1.0) ** HALVES
    assert both_ways(passed(0.0) + late, HALVES) == pytest.approx(passed(0.0), abs=2e-5)
    assert both_ways(passed(-0.04), HALVES) == pytest.approx(passed(-0.04), abs=1e-9)
    one_way = HALVES[::2]
    assert both_ways(passed(0.0)[::2] + 0.01, one_way) == pytest.approx(passed(0.0)[::2] + 0.01)


def test_of_fewer_than_six_passages_one_way_nothing_is_taken_off():
    for count, taken in ((11, False), (12, True)):  # five and six of those the other way
        halves = HALVES[:count]
        beside = passed(0.0)[:count] + 0.01 * (-1.0) ** halves
        assert np.array_equal(both_ways(beside, halves), beside) != taken
    assert both_ways(beside, halves) == pytest.approx(passed(0.0)[:12], abs=1e-9)


def test_counts_may_begin_anywhere():
    late = passed(-0.04) + 0.01 * np.exp(HALVES / 80) * (-1.0) ** HALVES
    assert both_ways(late, HALVES + 6) == pytest.approx(both_ways(late, HALVES), abs=1e-9)
    there, elsewhere = (pace(passed(-0.04, 1e-3), halves) for halves in (HALVES, HALVES + 7))
    assert elsewhere[:-1] == pytest.approx(there[:-1])


def test_periods_and_their_uncertainties_are_those_of_a_fitted_parabola():
    """By a parabola through the times over the swings, whose slope is the period; noise that takes back each time what it added has no colour."""
    white = np.random.default_rng(1).standard_normal(82)
    times, swings = passed(-0.04) + 1e-3 * np.diff(white), HALVES / 2
    found = pace(times, HALVES)
    course, covariance = np.polyfit(swings, times, 2, cov=True)
    slopes = {"first": [1.0, 1, 0], "period": [40.0, 1, 0], "change": [2 * 39.0, 0, 0]}
    for name, slope in slopes.items():
        assert getattr(found, name) == pytest.approx(np.dot(slope, course), rel=1e-9)
        u = np.sqrt(np.dot(slope, covariance @ slope))
        assert getattr(found, f"u_{name}") == pytest.approx(u, rel=1e-6)
    left = times - np.polyval(course, swings)
    assert found.residuals == pytest.approx(left) and found.scatter == pytest.approx(
        np.sqrt(left @ left / 78)
    )


@pytest.mark.parametrize("swings", [8, 12, 16, 25, 60])
def test_one_passage_a_period_of_a_swing_that_falls_fast_tells_the_period_in_its_middle(swings):
    """Of a pendulum from 0.5 rad whose amplitude falls by 6 % a swing: the ideal period at each amplitude, timed to 0.3 ms."""

    def period(at):
        return 1.55 * 2 / np.pi * ellipk(np.sin(0.25 * np.exp(-0.04 * at)) ** 2)

    times = [0.0]
    for _ in range(swings):
        times.append(times[-1] + period(times[-1] + 0.78))
    truth, pulls = period(times[-1] / 2), []
    for seed in range(40):
        noise = 3e-4 * np.random.default_rng(seed).standard_normal(swings + 1)
        found = pace(np.array(times) + noise, 2 * np.arange(swings + 1))
        pulls.append((found.period - truth) / found.u_period)
    assert np.sqrt(np.mean(np.square(pulls))) < 2.5
