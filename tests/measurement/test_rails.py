"""A single top that a rail cuts off, beside a bob that is held before its release."""

import numpy as np

from swingdown.measurement.swings.quality import saturated_runs

TIMES = np.arange(0, 10, 0.01)
STEP = 1e-3  # rad, of the sensor


def seen(angle):
    return STEP * np.round(angle / STEP)


def test_a_single_top_at_a_rail_is_told():
    swing = 0.5 * np.exp(-0.1 * TIMES) * np.sin(6 * TIMES)
    assert saturated_runs(seen(swing)) == []
    ((first, count),) = saturated_runs(seen(np.minimum(swing, 0.455)))
    assert swing[first : first + count].min() + STEP >= 0.455 and count > 5


def test_a_bob_that_is_held_and_let_go_is_at_no_rail():
    held = np.where(TIMES < 1, 0.5, 0.5 * np.exp(-0.1 * (TIMES - 1)) * np.cos(6 * (TIMES - 1)))
    assert saturated_runs(seen(held)) == []


def test_a_level_before_the_swing_is_no_top():
    """A memory that holds something else before a device is triggered."""
    swing = 0.5 * np.exp(-0.1 * TIMES) * np.sin(6 * TIMES)
    level = np.full(80, -5.0)
    assert saturated_runs(-seen(np.concatenate([level, swing]))) == []
    assert saturated_runs(-seen(np.concatenate([swing, level]))) == []


def test_a_swing_of_fewer_than_36_steps_is_too_coarse_to_tell_a_rail_from_a_step():
    for lowest, told in ((29, True), (28, False)):
        signal = np.round(np.minimum(lowest * np.cos(6 * TIMES), 7))
        assert bool(saturated_runs(signal)) is told, lowest
