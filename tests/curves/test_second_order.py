"""What friction does beyond the first order of the loss, against springs whose half-swings are known in closed form."""

from types import SimpleNamespace

import numpy as np
import pytest

from swingdown.curves.second_order import Course, Early, Table, beyond_of, none_beyond
from swingdown.curves.torques import Ideal, friction

AMPLITUDES = np.geomspace(0.1, 1.0, 25)
IDEAL = Ideal("linear")


def beyond(power, size, amplitudes=AMPLITUDES):
    """The columns for a friction that is ``size`` times the speed to that power."""
    basis = friction(IDEAL, amplitudes)
    mean = np.zeros(3 + basis.nodes.size + 2)  # and two that are no friction's
    mean[power], mean[-2:] = size * basis.scale**power, 7.0
    return beyond_of(IDEAL, basis, SimpleNamespace(mean=mean), amplitudes)


def test_viscous_friction():
    """A half-swing takes π ζ / √(1 - ζ²) and lasts π / √(1 - ζ²); passages are late by asin ζ of a turn, and turning points as early."""
    ratio = 0.05
    own = np.sqrt(1 - ratio**2)
    late = (np.pi / 2 - np.arctan2(own, ratio)) / own
    loss, turning, passing, beside, early = beyond(1, 2 * ratio).at(AMPLITUDES).T
    assert loss == pytest.approx(np.pi * ratio * (1 / own - 1), rel=0.05)
    assert turning == pytest.approx(1 / own - 1, rel=1e-3) and passing == pytest.approx(1 / own - 1, rel=1e-2)
    assert beside == pytest.approx(late, rel=1e-3) and early == pytest.approx(late, rel=1e-3)


def test_dry_friction():
    """Each half-swing swings about where friction holds it: π long, from A to A - 2 c; at each turning point the torque steps by 2 c."""
    c, at = 0.004, slice(3, -3)
    loss, turning, passing, beside, early = beyond(0, c).at(AMPLITUDES)[at].T
    middle = AMPLITUDES[at]
    # from begun to reached, whose root of the product is the middle one
    begun = c + np.sqrt(c**2 + middle**2)
    assert loss == pytest.approx(np.log(begun / (begun - 2 * c)) - 2 * c / middle, abs=1e-6)
    assert turning == pytest.approx(0, abs=1e-6)
    assert beside == pytest.approx(np.arcsin(c / (begun - c)), rel=1e-3)
    before, after = np.arcsin(c / (middle + c)), np.arcsin(c / (middle - c))
    assert passing == pytest.approx((after - before) / np.pi, abs=2e-5)
    # less what a polynomial through the step turns too late
    assert early == pytest.approx((before + after) / 2 - 0.108 * 2 * c / middle, rel=2e-3)


def test_a_friction_that_stops_it_says_nothing_beyond():
    assert not beyond(0, 0.4).at(AMPLITUDES).any()
    assert none_beyond(AMPLITUDES).at(AMPLITUDES).shape == (25, 5)


def test_rows_are_summed_at_the_middle_of_each_half_swing_and_stay_beyond_the_ends():
    table = Table(AMPLITUDES, np.column_stack([np.log(AMPLITUDES), np.ones(25)]))
    course = Course(np.arange(3.0, 7.0), np.array([0.9, 0.7, 0.6, 0.2]))
    middles = np.sqrt(course.amplitude[1:] * course.amplitude[:-1])
    right = np.column_stack([np.r_[0, np.cumsum(np.log(middles))], np.arange(4)])
    assert table.summed(course) == pytest.approx(right, abs=1e-9)
    assert table.at(np.array([0.01, 5.0]))[:, 0] == pytest.approx(np.log([0.1, 1.0]))
    assert course.at(np.array([3.5, 6.0, 9.0])) == pytest.approx([np.sqrt(0.63), 0.2, 0.2])


def test_a_friction_that_turns_it_earlier_makes_its_period_longer_by_the_square():
    """What is missing of the torque is the difference of the squares, of what comes early and of what a friction of speed alone does."""
    loss, usual = np.array([0.01, 0.05]), np.array([0.003, 0.02])
    plain, u_plain = Early(0.0, 0.1).stiffer(loss, usual)
    assert not plain.any() and (u_plain > 0).all()
    for share in (-0.2, 0.3):
        more, u = Early(share, 0.1).stiffer(loss, usual)
        excess = share * loss * (1 + np.pi * 0.108 if share > 0 else 1)
        assert more / ((usual + excess) ** 2 - usual**2) == pytest.approx([1.25, 1.25])
        # its slope by the share times the share's error, the loss's own doubt, and a third of all of it
        slope = 2.5 * (usual + excess) * loss
        assert u == pytest.approx(np.hypot(slope * np.hypot(0.1, loss / 8), more / 3))
    nothing, u = Early(np.nan, np.nan).stiffer(loss, usual)
    assert not nothing.any() and u == pytest.approx(loss**2 / 3)
