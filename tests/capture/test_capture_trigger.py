"""Waiting until the bob is still, noticing that it leaves, and going back to where it left."""

from types import SimpleNamespace

import numpy as np
import pytest

from swingdown.capture.trigger import CONFIRM, Watch, noise, release

RATE, STILL, THRESHOLD = 100, 0.5, 0.02


def fed(values, scale=1.0):
    """A Watch fed with values: when it armed (index), and the index of the row that began a release."""
    watch = Watch({"threshold": THRESHOLD, "pre_s": STILL}, RATE, scale)
    armed = began = None
    for k, value in enumerate(values):
        found = watch.take(SimpleNamespace(value=value, index=k))
        armed = k if armed is None and watch.armed else armed
        if found:
            began = found.index
            break
    return watch, armed, began


def test_it_arms_once_the_bob_was_still_for_as_long_as_asked():
    moving = 0.3 * np.sin(np.arange(200) / 10)
    watch, armed, _ = fed([*moving, *np.zeros(200)])
    assert 200 + STILL * RATE - 3 <= armed <= 200 + STILL * RATE + 3
    assert watch.spread == 0 and watch.needed == 2 * STILL * RATE
    assert fed(moving)[1] is None and fed(moving)[0].spread > THRESHOLD
    assert fed(np.zeros(int(STILL * RATE) - 1))[1] is None  # not yet


def test_a_bob_that_moves_by_just_the_threshold_is_still_and_by_more_is_not():
    sway = np.resize([0.0, 1.0], 200)
    assert fed(THRESHOLD * sway)[1] is not None
    assert fed(1.01 * THRESHOLD * sway)[1] is None


@pytest.mark.parametrize("side", [1, -1])
def test_the_first_of_three_rows_beyond_the_threshold_is_the_release(side):
    still, gone = np.full(100, 0.7), 0.7 + side * 2 * THRESHOLD
    assert fed([*still, *[gone] * CONFIRM])[2] == 100
    assert fed([*still, *[gone] * (CONFIRM - 1), *still])[2] is None  # a spike
    assert fed([*still, gone, gone, 0.7, *[gone] * CONFIRM])[2] == 103
    assert fed([*still, *[0.7 + side * 0.9 * THRESHOLD] * 50])[2] is None


def test_what_is_sent_is_looked_at_in_the_signals_unit():
    still = np.full(100, 700)
    assert fed([*still, *[730] * CONFIRM], scale=1e-3)[2] == 100
    assert fed([*still, *[715] * 20], scale=1e-3)[2] is None


def test_it_compares_with_the_level_of_late_and_not_of_long_ago():
    drift = np.linspace(
        0, 10 * THRESHOLD, 2000
    )  # slow: a hundredth of the threshold in the time that it must be still
    _, armed, began = fed([*np.zeros(100), *drift])
    assert armed is not None and began is None


@pytest.mark.parametrize("power", [2, 1])
def test_the_release_is_found_before_it_was_noticed(power):
    """An angle leaves with the square of the time, an angular rate with the time; the sample at which it was free is asked for."""
    times, free = np.arange(120) / RATE, 0.6
    rng = np.random.default_rng(3)
    values = 0.3 + np.maximum(times - free, 0) ** power * (-2.0 if power == 2 else -0.5)
    values = values + 2e-4 * rng.standard_normal(times.size)
    at = int(np.flatnonzero(np.abs(values - 0.3) > THRESHOLD)[0])
    assert at - free * RATE > 2
    assert release(times, values, at, THRESHOLD, power) == pytest.approx(free, abs=0.021)


def test_noise_is_told_beneath_a_slow_motion():
    rng = np.random.default_rng(4)
    slow = np.sin(2 * np.pi * np.arange(4000) / 200)
    assert noise(slow + 0.01 * rng.standard_normal(4000)) == pytest.approx(0.01, rel=0.05)
    assert noise(np.ones(7)) == 0.0 and noise([0, 1, 0, 1, 0, 1, 0, 1]) > 0
