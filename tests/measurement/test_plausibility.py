"""What a pendulum can be in its units is told by its own swings: in step, dying, about where it hangs, once a period."""

import numpy as np
import pytest

from swingdown.errors import InputError
from swingdown.measurement.plausibility import (
    check_once,
    check_shrinks,
    drift,
    evenness,
    free_part,
    hanging,
    in_a_row,
    in_step_and_dying,
    in_step_and_steady,
    late_stamps,
    narrowing,
)

RATE = 100
TIMES = np.arange(30 * RATE) / RATE
PERIOD = 1.25  # s: 24 in the whole


def swing(decay=0.03, size=0.5, noise=1e-3, seed=1, times=TIMES, period=PERIOD):
    clean = size * np.exp(-decay * times) * np.cos(2 * np.pi * times / period)
    return clean + noise * np.random.default_rng(seed).standard_normal(times.size)


def kicked(at=20.0, factor=2.0):
    """A swing that something makes wider at a time, when it passes its middle."""
    return np.where(at > TIMES, 1, factor) * swing()


def test_half_swings_in_a_row_end_where_they_grow_or_lose_step():
    """A kick after 20 s: 32 half-swings of 0.625 s before it, 16 after it, but for the one it is in and the first and last."""
    assert in_a_row(TIMES, swing()) == pytest.approx(46, abs=1)
    assert in_a_row(TIMES, kicked()) == pytest.approx(31, abs=1)
    assert in_a_row(TIMES, kicked(factor=1.1)) == pytest.approx(46, abs=1)
    late = np.where(TIMES < 10, swing(), swing(times=TIMES - 0.55))  # nearly half a period passes beside
    assert in_a_row(TIMES, late) == pytest.approx(31, abs=1)


def test_the_free_part_is_the_longest_in_step_where_there_is_another():
    assert free_part(TIMES, swing()) is None
    begins, ends = free_part(TIMES, kicked())
    assert begins < 1.3 and ends == pytest.approx(19.4, abs=0.7)  # but for the half-swing beside the kick
    begins, ends = free_part(TIMES, kicked(5.0))
    assert begins == pytest.approx(5, abs=0.7) and ends > 28.7
    brief = TIMES < 8
    assert free_part(TIMES[brief], kicked(4.0)[brief]) is None  # six half-swings are too few


@pytest.mark.parametrize("decay", [0.0, 0.01, 0.03, 0.06])
def test_the_last_third_of_the_swings_over_the_first(decay):
    """The middles of both lie two thirds of 23 periods apart."""
    assert narrowing(swing(decay, noise=0)) == pytest.approx(np.exp(-decay * 2 / 3 * 23 * PERIOD), rel=0.02)


def test_too_few_half_swings_have_no_thirds():
    assert np.isnan(narrowing(swing(noise=0)[: round(2.2 * PERIOD * RATE)]))


@pytest.mark.parametrize(
    ("signal", "dies", "steady"),
    [
        (swing(), True, False),
        (swing(0.002), True, False),  # to 96 %, and surely
        (swing(0.0005), False, True),  # to 99 %
        (swing(-0.02), False, False),
        (
            np.where(TIMES % 15 < 2.5, 1.4, 1) * swing(0.0),
            False,
            False,
        ),  # as wide on the whole, and not each time
        (swing(0.0, noise=0.01), False, True),
        (swing(0.03) + 0.2 * swing(0.0, period=2 * PERIOD), False, False),  # it takes longer on one side
        (np.random.default_rng(1).standard_normal(3000), False, False),
        (swing()[: round(3.6 * PERIOD * RATE)], False, False),  # seven passages
    ],
)
def test_what_is_in_step_and_dies_or_stays_as_wide(signal, dies, steady):
    times = TIMES[: signal.size]
    assert in_step_and_dying(times, signal) is dies and in_step_and_steady(times, signal) is steady


@pytest.mark.parametrize(("decay", "late", "told"), [(0.03, 0.05, True), (0.03, 0.002, False), (0.0, 0.05, False)])  # fmt: skip
def test_stamps_that_are_late_scatter_the_periods_of_an_even_swing(decay, late, told):
    """By about as much as they are late; of a swing that does not die nothing is said."""
    stamps = TIMES + late * np.repeat(np.random.default_rng(2).standard_normal(150), 20)
    found = late_stamps(np.sort(stamps), swing(decay, noise=1e-4))
    assert found == 0 if not told else 0.05 < found < 0.3


def test_a_hand_that_scatters_the_turning_points_as_well_is_no_late_stamp():
    sizes = np.repeat(np.random.default_rng(3).uniform(0.8, 1.2, 48), 63)[:3000]
    stamps = np.sort(TIMES + 0.05 * np.repeat(np.random.default_rng(2).standard_normal(150), 20))
    assert late_stamps(stamps, sizes * swing(noise=1e-4)) == 0
    assert late_stamps(stamps[:900], swing(noise=1e-4)[:900]) == 0  # too few


def test_a_bob_s_height_keeps_one_side_and_a_swing_none():
    angle = swing(noise=0)
    assert evenness(angle) == pytest.approx(1, abs=0.1)
    assert evenness(1 - np.cos(angle)) < 0.05
    assert np.isnan(evenness(swing(0.0, noise=0))) and np.isnan(evenness(angle[:400]))


@pytest.mark.parametrize(("unit", "weight"), [("m/s²", 9.81), ("g", 1.0), ("mg", 1000.0)])
def test_the_pull_of_a_string_is_known_by_what_it_reads_at_rest(unit, weight):
    """Over the weight it is 3 cos a - 2 cos A, of a swing out to A."""
    pull = 3 * np.cos(swing(noise=0)) - 2 * np.cos(0.5 * np.exp(-0.03 * TIMES))
    for sign in (1, -1):
        with pytest.raises(InputError, match="goes up and down twice a period") as told:
            check_once(sign * weight * pull + 1e-4 * weight * swing(noise=1, size=0), "a.csv")
        assert f"as what an accelerometer along the string reads in {unit}" in told.value.problem
    check_once(1.2 * weight * pull if unit == "g" else weight * (0.2 + pull) * 1.15, "a.csv")
    check_once(weight + 3 * weight * swing(), "a.csv")  # a string that would push


def test_a_height_is_refused_and_an_angle_is_not():
    angle = swing(noise=1e-4)
    with pytest.raises(InputError, match="turning points of one side stay where they are"):
        check_once(1 - np.cos(angle), "a.csv")
    for fine in (angle, 300 + 100 * angle):
        check_once(fine, "a.csv")


@pytest.mark.parametrize(
    ("decay", "told"), [(0.03, ""), (0.0, "do not shrink (the last third to 100.0 %"), (0.0002, ""), (0.00005, "do not shrink (the last third to 99.9 %"), (-0.005, "do not shrink (the last third to 110")]
)  # fmt: skip
def test_what_does_not_shrink_is_told_and_may_be_a_motor_s(decay, told):
    found = check_shrinks(swing(decay, noise=0), "a.csv")
    assert bool(found) is bool(told) and all(told in one for one in found)


def test_what_grows_is_refused_with_how_much():
    """31 half-swings later by 2 % a second: exp(0.02 * 31 * 0.625) = 1.47."""
    with pytest.raises(InputError, match="in the last third of the recording they are 1.47 times as wide"):
        check_shrinks(swing(-0.02, noise=0), "a.csv")
    assert (
        check_shrinks(swing(-0.02, noise=0)[: round(5.2 * PERIOD * RATE)], "a.csv") == []
    )  # nine of eleven whole


@pytest.mark.parametrize(
    ("middle", "turns", "zero"),
    [(0.05, True, None), (0.3, True, 0.3), (-0.3, True, -0.3), (np.pi, True, np.pi), (2 * np.pi + 0.05, True, None), (2 * np.pi + 0.3, True, 2 * np.pi + 0.3), (2 * np.pi + 0.05, False, 2 * np.pi + 0.05)],
)  # fmt: skip
def test_a_middle_that_is_no_zero_is_taken_away_and_told_in_both_units(middle, turns, zero):
    found, told = hanging(np.degrees(middle + swing(noise=0)), np.pi / 180, turns)
    if zero is None:
        assert (found, told) == (0, [])
    else:
        assert found == pytest.approx(zero, abs=1e-3)
        assert told[0].startswith(f"it swings about {found:.3g} rad ({np.degrees(found):.3g}°)")


def test_too_few_swings_have_no_middle():
    assert hanging(0.3 + swing()[:120], 1.0) == (0, [])


@pytest.mark.parametrize(("moved", "told"), [(0.03, False), (0.1, True), (-0.1, True)])
def test_a_middle_that_drifts_is_told_with_how_far(moved, told):
    """From the middle of the first quarter of the swings to that of the last: three quarters of the way."""
    found = drift(swing(noise=0) + moved / 0.75 * TIMES / 30)
    assert bool(found) is told
    if told:
        assert float(found[0].split()[4]) == pytest.approx(moved, rel=0.1)
    assert drift(swing(noise=0)[: round(3.8 * PERIOD * RATE)] + TIMES[: round(3.8 * PERIOD * RATE)]) == []
