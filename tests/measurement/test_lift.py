"""Until when a hand is at a pendulum before its first passage is told by what weight and drag make of the later swing."""

import numpy as np
import pytest

from swingdown.engine.trajectory import simulate
from swingdown.measurement.swings.lift import lifted_until
from swingdown.pendulum.model import Model

RATE = 200
TIMES = np.arange(10 * RATE) / RATE
PERIOD = 2 * np.pi / 6.3


def free(start, model="viscous", **values):
    named = {"natural_frequency": 6.3} | (values or {"viscous_ratio": 0.01})
    return simulate(Model(model, named), TIMES, start)


def noisy(angle, seed=1):
    return angle + 5e-4 * np.random.default_rng(seed).standard_normal(angle.size)


def lifted(start, seconds):
    """Lifted with the pace of a swing, and let go at ``start`` after so many seconds."""
    hand = np.arange(round(seconds * RATE)) / RATE
    lift = start * (0.75 + 0.25 * np.sin(np.pi / 2 * hand / seconds))
    return np.concatenate([lift, free(start)])[: TIMES.size]


@pytest.mark.parametrize("start", [0.3, 1.2, 2.6])
@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("zero", [0.0, 0.2])
def test_a_free_swing_was_never_in_a_hand(start, sign, zero):
    for angle in (free(start), free(start, "quadratic_drag", quadratic_coefficient=0.05)):
        assert lifted_until(TIMES, zero + sign * noisy(angle)) is None


@pytest.mark.parametrize("start", [0.3, 1.2])
@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("seconds", [0.15, 0.4, 1.0])
def test_a_lift_ends_where_the_free_swing_begins(start, sign, seconds):
    """Told to within what the pendulum needs to fall by some hundredths of the swing."""
    found = lifted_until(TIMES, sign * noisy(lifted(start, seconds)))
    assert found == pytest.approx(seconds, abs=0.12 * PERIOD)


def test_a_hand_of_a_moment_is_none():
    """Three hundredths of a period: friction of another kind leaves as much."""
    angle = noisy(free(0.8))
    brief = angle.copy()
    brief[:5] -= 0.1
    assert lifted_until(TIMES, brief) is None
    longer = angle.copy()
    longer[:9] -= 0.1
    assert lifted_until(TIMES, longer) == pytest.approx(0.04, abs=0.02)


def test_fewer_than_four_half_swings_after_it_tell_nothing():
    angle = noisy(lifted(0.8, 0.4))
    for halves, told in ((3.6, False), (5.9, True)):
        size = round((0.4 + halves * PERIOD / 2) * RATE)
        assert (lifted_until(TIMES[:size], angle[:size]) is not None) == told


def test_coulomb_friction_is_no_hand():
    assert lifted_until(TIMES, noisy(free(0.8, "load_coulomb", load_friction=0.01))) is None
