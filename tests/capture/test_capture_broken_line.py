"""A broken line through points, with as many breaks as their scatter establishes."""

import numpy as np
import pytest

from swingdown.capture.broken_line import Breaks, BrokenLine, band, break_price, breaks, part, parts, sure

TIMES = np.arange(0.0, 40.0, 0.5)
SCATTER = 0.01


def noisy(values, seed=1):
    return values + SCATTER * np.random.default_rng(seed).standard_normal(TIMES.size)


def broken(values, least=0.05):
    found = parts(TIMES, values, SCATTER)
    return found, breaks(found, TIMES, SCATTER, least)


def test_a_straight_line_stays_whole():
    found, what = broken(noisy(0.3 + 0.02 * TIMES))
    assert [(one.first, one.end) for one in found] == [(0, TIMES.size)] and what == Breaks()
    assert found[0].slope == pytest.approx(0.02, abs=5 * SCATTER / np.sqrt(found[0].spread))
    assert found[0].at(10.0) == pytest.approx(0.5, abs=5 * SCATTER * np.sqrt(found[0].variance(10.0)))


def test_a_bend_is_found_where_it_is():
    found, what = broken(noisy(0.02 * TIMES + 0.05 * np.maximum(TIMES - 15.2, 0)))
    assert len(found) == 2 and what.jumps == what.small == ()
    assert what.bends[0] == pytest.approx(15.2, abs=0.3)


def test_a_jump_is_found_between_its_points_and_a_bend_with_it_too():
    found, what = broken(noisy(0.02 * TIMES + 0.4 * (TIMES > 20.1)))
    assert what.jumps == (20.25,) and what.bends == ()
    _, both = broken(noisy(0.02 * TIMES + 0.4 * (TIMES > 20.1) + 0.05 * np.maximum(TIMES - 20.1, 0)))
    assert both.jumps == both.bends == (20.25,)


def test_a_jump_that_is_too_small_is_told_and_not_taken():
    _, what = broken(noisy(0.02 * TIMES + 0.1 * (TIMES > 20.1)), least=0.5)
    assert what.jumps == what.bends == () and what.small[0] == pytest.approx(0.1, abs=0.03)


def test_lines_that_all_but_meet_and_turn_far_are_a_bend():
    values = 0.02 * TIMES + 0.05 * np.where(TIMES > 20.1, TIMES - 18.0, 0)  # they would meet at 18 s
    what = breaks([part(TIMES, values, 0, 41), part(TIMES, values, 41, TIMES.size)], TIMES, SCATTER, 0.2)
    assert what == Breaks(bends=(20.25,))


def test_the_line_follows_its_breaks_and_tells_jumps_and_slopes():
    values = 1 + 0.1 * (TIMES - 0.0) + 0.2 * np.maximum(TIMES - 10, 0) - 0.5 * (TIMES >= 20)
    line = BrokenLine(TIMES, values, SCATTER, Breaks((10.0,), (20.0,)))
    assert line.at(TIMES) == pytest.approx(values)
    assert line.at(20.0, before=True) - line.at(20.0) == pytest.approx([0.5])
    assert line.jumped() == pytest.approx((-0.5,))
    (first, until, slow), (since, last, fast) = line.slopes()
    assert (first, until, since, last) == (0.0, 10.0, 10.0, 39.5)
    assert (slow, fast) == pytest.approx((0.1, 0.3))


def test_its_uncertainty_is_that_of_repeated_noise():
    straight = 0.02 * TIMES
    ends = [
        float((one := BrokenLine(TIMES, noisy(straight, seed), SCATTER)).at(39.5)[0] - one.at(0.0)[0])
        for seed in range(400)
    ]
    told = float(BrokenLine(TIMES, straight, SCATTER).uncertainty(39.5, 0.0)[0])
    assert np.std(ends) == pytest.approx(told, rel=0.1)
    assert BrokenLine(TIMES, straight, SCATTER).uncertainty(0.0, 0.0) == pytest.approx(0.0)


def test_a_straight_line_is_seldom_taken_for_a_broken_one():
    rng = np.random.default_rng(2)
    found = [len(parts(TIMES, SCATTER * rng.standard_normal(TIMES.size), SCATTER)) for _ in range(300)]
    assert sum(count > 1 for count in found) <= 3
    assert (
        sure(100) > sure(1) > 3 and break_price(100) > break_price(10) > 16
    )  # of one look 3.3, of a break chi² at ALPHA


def test_a_part_is_the_line_of_least_squares():
    values = noisy(0.3 + 0.02 * TIMES)
    one = part(TIMES, values, 10, 40)
    slope, level = np.polyfit(TIMES[10:40], values[10:40], 1)
    assert (one.slope, one.at(0.0)) == pytest.approx((slope, level))
    assert one.variance(one.middle) == pytest.approx(1 / 30)


def test_a_band_is_as_narrow_as_the_points_let_it():
    assert band(TIMES, 0.3 * TIMES + 0.1 * (-1.0) ** np.arange(TIMES.size)) == pytest.approx(0.2, rel=0.03)
    assert band(TIMES, 0.3 * TIMES) == pytest.approx(0.0, abs=1e-5)
