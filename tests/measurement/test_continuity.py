"""Whether a recording runs on: where it jumps, stumbles, is out of step or dies is told, with the time, and nothing else is."""

import numpy as np
import pytest

from swingdown.errors import InputError
from swingdown.measurement.swings.continuity import check_alive, check_continuous, check_one_series
from swingdown.measurement.swings.spikes import find_spikes

RATE = 100
TIMES = np.arange(30 * RATE) / RATE
PERIOD = 2 * np.pi / 7.25  # s


def swing(times=TIMES, noise=0.001, seed=1):
    clean = 0.5 * np.exp(-0.03 * times) * np.cos(7.25 * times)
    return clean + noise * np.random.default_rng(seed).standard_normal(times.size)


def told(signal, times=TIMES):
    return check_continuous(times, signal, find_spikes(times, signal))


def test_nothing_is_told_of_a_swing_that_runs_on():
    for seed in range(10):
        assert told(swing(seed=seed)) == [] == told(np.round(swing(seed=seed), 2))


def test_missing_samples_are_counted_and_are_no_jumps():
    here = np.delete(np.arange(TIMES.size), [*range(500, 508), 1200])
    (found,) = told(swing()[here], TIMES[here])
    assert found.startswith("9 of 3000 samples are missing, the longest hole 0.08 s")


def test_spikes_left_out_are_counted_by_their_places_and_samples():
    signal = swing()
    signal[[700, 1500, 1501]] += 0.1
    assert told(signal) == ["a spike at 7 s and once more, left out as missing: 3 of 3000 samples"]


def test_spikes_that_are_too_many_stay_and_so_do_those_that_were_left():
    signal = swing()
    places = np.arange(60, 2960, 60)
    signal[places] += 0.1
    assert told(signal) == ["a spike at 0.6 s and 48 times more, too many to be left out"]
    few = swing()
    few[[700, 1500]] += 0.1
    kept = find_spikes(TIMES, swing())
    assert check_continuous(TIMES, few, kept._replace(healed=few)) == ["a spike at 7 s and once more, not left out"]  # fmt: skip


@pytest.mark.parametrize("at", [1010, 2005])
def test_a_jump_is_told_at_its_sample(at):
    """Five samples lost on the way through the middle, and all numbered on."""
    long = np.arange(3005) / RATE
    top = at + int(np.argmin(np.abs(swing(long, noise=0)[at : at + 40])))
    (found,) = told(np.delete(swing(long), range(top - 2, top + 3)))
    assert found.startswith("the signal jumps") and "more" not in found
    assert float(found.partition(" at ")[2].removesuffix(" s")) == pytest.approx(top / RATE, abs=0.03)


def test_samples_lost_at_a_turning_point_put_the_swing_out_of_step():
    long = np.arange(3015) / RATE
    top = 1000 + int(np.argmax(swing(long, noise=0)[1000:1087]))
    (found,) = told(np.delete(swing(long, noise=0.01), range(top - 6, top + 6))[: TIMES.size])
    assert found.startswith("the pendulum is out of step with the clock")
    assert float(found.partition(" at ")[2].removesuffix(" s")) == pytest.approx(top / RATE, abs=0.1)


@pytest.mark.parametrize(("share", "seen"), [(0.15, False), (0.25, True), (0.4, True), (0.75, True), (0.9, False)])  # fmt: skip
def test_a_clock_stumbles_that_is_off_by_more_than_a_fifth_of_a_step(share, seen):
    times = TIMES + np.where(np.arange(TIMES.size) >= 1200, share / RATE, 0)
    found = [one for one in told(swing(), times) if "stumbles" in one]
    assert found == ([f"the clock stumbles at {times[1200]:.6g} s"] if seen else [])


def test_samples_that_keep_no_rate_are_told_as_that_alone():
    times = np.sort(np.random.default_rng(1).uniform(0, 30, 3000))
    signal = swing(times)
    signal[[700, 1500]] += 0.3
    (found,) = told(signal, times)
    assert found.startswith("the time between samples varies")


@pytest.mark.parametrize("at", [1000, 1003, 1010, 1022, 1030])
def test_a_sensor_that_stays_while_the_pendulum_swings_is_dead_from_there_on(at):
    signal = np.round(swing(), 4)
    signal[at:] = signal[at]
    with pytest.raises(InputError) as caught:
        check_alive(TIMES, signal, "a.csv")
    assert (
        caught.value.where == f"a.csv, {at / RATE:g} s" and f"stays at {signal[at]:g}" in caught.value.problem
    )
    assert f"stop_s: {(at - 1) / RATE:g}," in caught.value.mend


def test_what_came_to_rest_or_stays_for_a_moment_is_not_dead():
    """A swing that fell by a fifth or more in its last period was coming to rest; half a period is needed to tell a stay."""
    stops = np.maximum(1 - TIMES / 12, 0) ** 2 * np.cos(7.25 * TIMES)
    check_alive(TIMES, np.round(stops, 3), "a.csv")
    ends = np.round(swing(), 4)[:1043]
    check_alive(TIMES[:1043], np.append(ends[:1003], np.full(40, ends[1003])), "a.csv")
    check_alive(TIMES, swing(), "a.csv")
    coarse = 0.1 * np.round(swing() / 0.1)  # a step is a fifth of the swing: rest may hide in it
    coarse[1003:] = coarse[1003]
    check_alive(TIMES, coarse, "a.csv")


def in_turns(*series):
    return np.column_stack(series).ravel()


@pytest.mark.parametrize("count", [2, 3, 4])
def test_series_that_take_turns_are_refused_with_their_number(count):
    times = np.arange(400) / 20
    series = [150 * k + (100 - 10 * k) * np.cos((4.5 + 0.05 * k) * times) for k in range(count)]
    rows = in_turns(*series)
    with pytest.raises(InputError, match=f"{count} series take turns in it, row by row"):
        check_one_series(np.arange(rows.size) / (20 * count), rows, "a.csv")
    few = rows[: 16 * count - 1]  # fewer rows of each than twice the eight half-swings that would tell
    check_one_series(np.arange(few.size) / (20 * count), few, "a.csv")


def test_levels_that_take_turns_and_do_not_swing_are_no_series():
    still = in_turns(np.zeros(400), np.full(400, 300.0)) + np.random.default_rng(1).standard_normal(800)
    check_one_series(np.arange(800) / 40, still, "a.csv")


ROWS = 0.025 * np.arange(1600)


@pytest.mark.parametrize("signal", [
    140 * np.cos(2 * np.pi * np.arange(ROWS.size) / 260) + 10.0 * (-1) ** np.arange(ROWS.size),  # a converter's two halves differ
    500 + 140 * np.exp(-0.002 * ROWS) * np.cos(0.97 * np.pi * np.arange(ROWS.size)),  # read about twice a swing
    500 + 140 * np.exp(-0.002 * ROWS) * np.cos(0.66 * np.pi * np.arange(ROWS.size)),  # three times
])  # fmt: skip
def test_one_series_is_one(signal):
    check_one_series(ROWS, signal, "a.csv")
