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


TIME = np.arange(400) / 100


def fine(signal, time=TIME):
    """It is not refused on either side."""
    check_signal(time, signal, "a.csv")
    check_signal(time, -signal, "a.csv")


def test_a_bob_that_is_held_for_a_second_and_let_go_is_at_no_rail_whatever_its_steps():
    signal = 0.4 * np.cos(7 * np.maximum(TIME - 1, 0))
    fine(signal)
    for step in (1e-4, 1e-3, 3e-3, 1e-2):
        fine(step * np.round(signal / step))


@pytest.mark.parametrize("seconds", [0.05, 0.2, 0.6])
@pytest.mark.parametrize("step", [1e-4, 1e-3])
def test_a_bob_that_is_caught_held_and_let_go_again_is_at_no_rail(seconds, step):
    """It comes to the highest place in the whole of a hand's own pace, and leaves it from rest."""
    lift = 0.4 * np.sin(np.pi / 2 * np.arange(80) / 80)
    hold = np.full(round(100 * seconds), 0.4)
    signal = np.concatenate([0.3 * np.cos(7 * TIME), lift, hold, 0.4 * np.cos(7 * TIME)])
    fine(step * np.round(signal / step), np.arange(signal.size) / 100)


@pytest.mark.parametrize("rate", [100, 1000])
@pytest.mark.parametrize("steps", [20, 200, 4000, 40000])
def test_coarse_encoders_are_at_no_rail(rate, steps):
    time = np.arange(4 * rate) / rate
    angle = 0.4 * np.cos(7 * time) * np.exp(-0.01 * time)
    fine(np.round(angle * steps / (2 * np.pi)) * 2 * np.pi / steps, time)


def test_a_top_just_short_of_the_next_step_is_at_no_rail():
    """The flattest top a rounded signal can have, at every turning point: nothing is lost to damping."""
    time = np.arange(4000) / 1000
    fine(np.round(100.49 * np.cos(7 * time)) * 1e-3, time)


def test_noisy_steps_at_a_release_from_rest_are_at_no_rail():
    """Half a top, at the first sample, in steps about as large as the noise: a few samples are alike by chance."""
    time, step, draws = np.arange(2001) / 100, 0.00416, np.random.default_rng(6)
    for _ in range(3000):
        velocity = draws.normal(0, 0.07)
        clean = (
            -draws.uniform(0.3, 0.6) * np.cos(6.5 * time) + velocity / 6.5 * np.sin(6.5 * time)
        ) * np.exp(-0.06 * time)
        signal = step * np.round((clean + 0.4 * step * draws.standard_normal(time.size)) / step)
        check_signal(time, signal, "swing.csv")


@pytest.mark.parametrize("noise", [0.0, 0.002])
@pytest.mark.parametrize("rail", [0.39, 0.3, 0.1])
@pytest.mark.parametrize("sides", ["both", "upper", "lower"])
def test_a_signal_is_cut_off_at_either_rail_or_both(noise, rail, sides):
    time = np.arange(4000) / 1000
    signal = 0.4 * np.cos(7 * time) + noise * np.random.default_rng(1).standard_normal(4000)
    signal = np.clip(signal, -rail if sides != "upper" else None, rail if sides != "lower" else None)
    with pytest.raises(InputError, match="saturated"):
        check_signal(time, np.round(signal, 4), "a.csv")


@pytest.mark.parametrize("rate", [100, 1000])
@pytest.mark.parametrize("rail", [0.22, 0.3])
def test_one_swing_that_reaches_the_rail_is_told_by_its_corners(rate, rail):
    """The first top alone is cut; the second is lower than the rail."""
    time = np.arange(4 * rate) / rate
    signal = np.minimum(0.4 * np.sin(7 * time) * np.exp(-0.8 * time), rail)
    ((first, count),) = saturated_runs(np.round(signal, 4))
    assert first / rate < 0.2 and signal[first : first + count].min() > rail - 1e-4
