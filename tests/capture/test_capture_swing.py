"""A swing in numbers while it goes on: amplitude, period, and what each swing loses."""

import numpy as np
import pytest

from swingdown.capture.live import MANY, measure

PERIOD, RATE = 1.3, 100


def swing(swings, loss=0.02, amplitude=0.4, offset=0.0):
    """Times and a swing that begins at its highest and loses a share in each period."""
    times = np.arange(int(swings * PERIOD * RATE)) / RATE
    return times, offset + amplitude * (1 - loss) ** (times / PERIOD) * np.cos(2 * np.pi * times / PERIOD)


def test_period_amplitude_and_loss_are_those_of_the_swing_wherever_its_middle_lies():
    for offset in (0.0, 2.0):
        found = measure(*swing(15.0, offset=offset))
        assert found.swings == 14
        assert found.period == pytest.approx(PERIOD, rel=2e-4)
        assert found.amplitude == pytest.approx(0.4 * 0.98**14, rel=0.02)
        assert found.loss == pytest.approx(0.02, rel=0.02)


def test_the_period_is_the_mean_of_the_last_ten():
    times, values = swing(40.0, loss=0.0)
    slow = np.where(times < 20 * PERIOD, times / 2, times - 10 * PERIOD)  # the first ones take twice as long
    assert measure(times, np.cos(2 * np.pi * slow / PERIOD)).period == pytest.approx(PERIOD, rel=1e-3)
    assert measure(times, values).period == pytest.approx(PERIOD, rel=1e-4)


def test_before_ten_swings_no_loss_is_told_and_of_the_eleventh_on_it_is():
    assert measure(*swing(MANY + 0.9)).loss is None
    assert measure(*swing(MANY + 1.9)).loss == pytest.approx(0.02, rel=0.05)


def test_noise_alone_is_no_swing_and_noise_on_one_counts_no_swing_twice():
    rng = np.random.default_rng(5)
    times, values = swing(12.0)
    noise = 0.01 * rng.standard_normal(times.size)
    assert measure(times, noise, 0.01) is None
    assert measure(times, noise + 0.02 * np.cos(2 * np.pi * times / PERIOD), 0.01) is None
    assert measure(times, values + noise, 0.01).swings == 11
    assert measure(times, values + noise, 0.01).period == pytest.approx(PERIOD, rel=5e-3)


def test_a_signal_that_stands_still_or_has_hardly_begun_is_none():
    assert measure(np.arange(50) / RATE, np.zeros(50)) is None
    times, values = swing(12.0)
    assert measure(times[:7], values[:7]) is None
    assert measure(*swing(1.2)) is None  # two passages: no whole swing yet
    assert measure(*swing(1.3)).swings == 1
