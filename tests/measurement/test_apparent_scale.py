"""Readings without a scale are worth as many rad as their period says: the longer, the wider the swing."""

import numpy as np
import pytest

from swingdown.engine.trajectory import simulate
from swingdown.measurement.apparent_scale import ON_A_SPRING, RELATIVE, apparent_scale
from swingdown.pendulum.model import Model

TIMES = np.arange(6000) / 100  # s


def read(start, per_rad, noise=0.0, damping=0.004):
    """A pendulum let go at ``start`` rad, in a unit of which so many are one rad."""
    clean = simulate(Model("viscous", {"natural_frequency": 4.4, "viscous_ratio": damping}), TIMES, start)
    return per_rad * (clean + noise * np.random.default_rng(1).standard_normal(TIMES.size))


def small(signal, size=RELATIVE):
    return pytest.approx(2 * size / np.ptp(signal))


@pytest.mark.parametrize("start", [0.6, 1.2, 2.4])
@pytest.mark.parametrize("per_rad", [600, 0.02])
@pytest.mark.parametrize("noise", [0.0, 0.002])
def test_a_wide_swing_tells_its_scale(start, per_rad, noise):
    assert apparent_scale(TIMES, read(start, per_rad, noise)) == pytest.approx(1 / per_rad, rel=0.03)


def test_a_swing_that_noise_hides_or_that_stays_as_wide_tells_none():
    """Its largest swing is then taken for a hundredth of a radian."""
    for signal in (read(0.02, 600, 1e-4), read(0.6, 1, damping=0.0), read(0.1, 1, 0.02)):
        assert apparent_scale(TIMES, signal) == small(signal)


def test_a_period_that_falls_as_the_swing_grows_is_no_pendulum_s():
    """As that of a spring that hardens."""
    size = 100 * np.exp(-TIMES / 40)
    rate = 4.4 * (1 + 0.05 * (size / 100) ** 2)
    phase = np.concatenate([[0], np.cumsum((rate[1:] + rate[:-1]) / 2 * np.diff(TIMES))])
    signal = size * np.cos(phase)
    assert apparent_scale(TIMES, signal) == small(signal)


def test_on_a_spring_every_swing_takes_as_long():
    signal = read(0.6, 600)
    assert apparent_scale(TIMES, signal, "linear") == small(signal, ON_A_SPRING)


def test_a_few_swings_tell_none():
    signal = read(1.2, 1)[:450]
    assert apparent_scale(TIMES[:450], signal) == small(signal)


def test_a_reading_that_is_off_its_zero_has_the_same_scale():
    signal = read(1.2, 600)
    assert apparent_scale(TIMES, signal + 5000) == pytest.approx(apparent_scale(TIMES, signal), rel=1e-3)
