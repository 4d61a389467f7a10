"""Stretches in which a hand holds, lifts or stops a pendulum are found where they are, and none where it swings by itself."""

import numpy as np
import pytest

from swingdown.engine.trajectory import simulate
from swingdown.measurement.swings.hand import held_still, stretches
from swingdown.pendulum.model import Model

RATE = 100
TIMES = np.arange(15 * RATE) / RATE
PENDULUM = Model("viscous", {"natural_frequency": 7.25, "viscous_ratio": 0.006})
FREE = simulate(PENDULUM, TIMES, 0.8)


def noisy(signal, seed=1, noise=0.002):
    return signal + noise * np.random.default_rng(seed).standard_normal(signal.size)


def held(seconds, before=()):
    """Held at its release for so long, after what was ``before``, and let go."""
    hand = np.full(round(seconds * RATE), 0.8)
    return np.concatenate([before, hand, FREE])[: TIMES.size]


def found(signal, scale=1.0, times=TIMES):
    return [tuple(one) for one in stretches(times[: signal.size], signal, scale)]


@pytest.mark.parametrize(("unit", "scale"), [(1.0, 1.0), (180 / np.pi, np.pi / 180), (500.0, 0.0)])
@pytest.mark.parametrize("zero", [0.0, 0.3])
def test_a_free_swing_has_none_in_any_unit(unit, scale, zero):
    """A wide one, whose weight is far from its angle, and friction that is none of those that are learned."""
    for model in (PENDULUM, Model("load_coulomb", {"natural_frequency": 7.25, "load_friction": 0.004})):
        for start in (0.2, 0.8, 2.5):
            assert found(unit * noisy(simulate(model, TIMES, start) + zero), scale) == []


@pytest.mark.parametrize(("unit", "scale"), [(1.0, 1.0), (180 / np.pi, np.pi / 180), (500.0, 0.0)])
@pytest.mark.parametrize("seconds", [0.5, 1.5, 4.0])
def test_a_bob_is_held_from_the_first_sample_to_its_release(unit, scale, seconds):
    ((start, stop),) = found(unit * noisy(held(seconds)), scale)
    assert start == 0 and stop == pytest.approx(seconds, abs=0.08)


def test_a_hand_within_has_both_its_ends_and_two_hands_are_two():
    """Caught where it turns after six seconds and a half, and held for a second and a half; then let go, and stopped again."""
    turn = int(np.argmax(FREE * (TIMES > 6) * (TIMES < 7)))
    once = noisy(held(1.5, FREE[:turn]))
    ((start, stop),) = found(once)
    assert start == pytest.approx(turn / RATE, abs=0.15)
    assert stop == pytest.approx(turn / RATE + 1.5, abs=0.1)
    twice = once.copy()
    twice[1300:] = twice[1300]
    (first, (again, end)) = found(noisy(twice, 2, 1e-3))
    assert first == pytest.approx((start, stop), abs=0.05)
    assert again == pytest.approx(13.0, abs=0.15) and end == TIMES[-1]


def test_a_spike_a_jump_and_strong_noise_are_no_hand():
    """A hand within a recording is there for longer than a window; noise as strong as the weight hides it."""
    spike, jump = noisy(FREE), noisy(FREE)
    spike[700] += 0.5
    jump[700:] += 0.05
    assert found(spike) == [] == found(jump)
    assert found(noisy(FREE, noise=0.2)) == []


def test_too_few_swings_or_samples_tell_of_none():
    signal = noisy(held(1.5))
    assert found(signal[:290]) == []  # four half-swings
    assert found(signal[::10], times=TIMES[::10]) == []  # nine samples a period
    assert found(signal[::6], times=TIMES[::6]) != []  # fourteen


def rates(angle):
    return noisy(np.gradient(angle, 1 / RATE), noise=0.02)


@pytest.mark.parametrize("seconds", [0.5, 1.5, 4.0])
def test_a_rate_is_nothing_while_the_bob_is_held(seconds):
    ((start, stop),) = held_still(TIMES, rates(held(seconds)))
    assert start < 0.1 and stop == pytest.approx(seconds, abs=0.06)


def test_a_rate_that_rests_is_held_only_where_it_swings_higher_afterwards():
    rate, hold = np.gradient(FREE, 1 / RATE), np.zeros(150)
    higher = np.concatenate([0.5 * rate[:650], hold, rate])[: TIMES.size]
    alike = np.concatenate([rate[:650], hold, rate[650:]])[: TIMES.size]
    rests = np.where(TIMES < 6.5, rate, 0)
    (one,) = held_still(TIMES, noisy(higher, noise=0.02))
    assert one.start == pytest.approx(6.5, abs=0.1) and one.stop == pytest.approx(8.0, abs=0.06)
    for other in (rate, alike, rests):
        assert held_still(TIMES, noisy(other, noise=0.02)) == []


def test_a_turning_point_is_no_hold_and_few_swings_tell_none():
    slow = rates(held(0.2))
    assert held_still(TIMES, slow) == []  # 0.23 of a period
    assert held_still(TIMES[:330], rates(held(1.5))[:330]) == []


@pytest.mark.parametrize("noise", [0.001, 0.002])
def test_a_knock_of_half_a_second_is_a_hand_within_the_swing(noise):
    """A bump of 0.15 rad on a swing of half a radian, from 9.6 to 10.1 s."""
    bump = 0.15 * np.sin(np.pi * (TIMES - 9.6) / 0.5) ** 2 * ((TIMES > 9.6) & (TIMES < 10.1))
    ((start, stop),) = found(noisy(FREE + bump, 1, noise))
    assert 9.3 < start < 9.8 and 9.9 < stop < 10.4
