"""Tops that a rail cuts off, beside a bob that is held before its release; and a signal that does not move."""

import numpy as np
import pytest

from swingdown.errors import InputError
from swingdown.measurement.swings.quality import check_signal, saturated_runs

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


@pytest.mark.parametrize(("word", "sign"), [("highest", 1), ("lowest", -1)])
def test_a_rail_is_told_with_its_side_its_first_sample_and_how_often(word, sign):
    """A swing of half a radian is above 0.4 in seven swings of a decay of 0.02 a second."""
    swing = 0.5 * np.exp(-0.02 * TIMES) * np.sin(6 * TIMES)
    cut = sign * seen(np.minimum(swing, 0.4))
    over = np.flatnonzero(seen(swing) >= 0.4)
    tops = np.split(over, np.flatnonzero(np.diff(over) > 1) + 1)
    with pytest.raises(InputError) as caught:
        check_signal(TIMES, cut, "a.csv")
    told = f"{len(tops[0])} samples at its {word} value {0.4 * sign:g} ({len(tops)} such tops)"
    assert told in caught.value.problem and caught.value.where == f"a.csv, {TIMES[tops[0][0]]:g} s"
    check_signal(TIMES, cut, "a.csv", computed=True)
    check_signal(TIMES, sign * seen(swing), "a.csv")
    noisy = sign * seen(np.minimum(swing + 0.01 * np.random.default_rng(1).standard_normal(TIMES.size), 0.4))
    with pytest.raises(InputError, match=f"at its {word} value"):
        check_signal(TIMES, noisy, "a.csv")


def test_a_signal_that_does_not_move_is_no_swing():
    for computed in (False, True):
        with pytest.raises(InputError, match=r"constant \(0.25\)"):
            check_signal(TIMES, np.full(TIMES.size, 0.25), "a.csv", computed)


def test_a_short_flat_top_is_no_rail():
    """Three samples at the highest value are what a rounded top shows in coarse samples; four are looked at."""
    swing = 100 * np.cos(2 * np.pi * np.arange(400) / 40)
    for level, told in ((95, True), (97, False)):
        assert bool(saturated_runs(np.minimum(swing, level))) is told
