"""Units that nobody states are those that only one reading allows; what more than one allows is asked."""

import re

import numpy as np
import pytest

from swingdown.errors import InputError
from swingdown.measurement.units import (
    NO_SCALE,
    angle_unit,
    check_steps,
    in_rad,
    time_factor,
    turns_counted,
    unwrapped,
)

SAMPLES = np.arange(2000)
SWING = 0.3 * np.exp(-SAMPLES / 4000) * np.cos(2 * np.pi * SAMPLES / 100)  # a period of 100 samples


def factor(period, told=False, start=0.0, **more):
    """What the times of a swing of this period are multiplied by, and what is told of it."""
    return time_factor(start + period / 100 * SAMPLES, SWING, told, "a.csv", **more)


@pytest.mark.parametrize(
    ("period", "found"),
    [(0.019, None), (0.021, 1.0), (1.3, 1.0), (59.0, 1.0), (1_000.0, 1e-3), (19_000.0, 1e-3), (21_000.0, None), (59_000.0, None), (61_000.0, 1e-6), (1.3e6, 1e-6), (59e6, 1e-6), (61e6, None)],
)  # fmt: skip
def test_times_are_in_the_one_unit_in_which_a_pendulum_s_period_is_possible(period, found):
    if found is None:
        with pytest.raises(InputError, match=re.escape(f"a period of {period:.3g} s is too long")) as told:
            factor(period)
        assert told.value.expected == "a period between 0.02 and 60 s" and "time_unit" in told.value.mend
    elif found == 1.0 and period > 4:
        assert factor(period)[0] == 1.0 and "NO UNIT OF THE TIME" in factor(period)[1][0]
    elif found == 1.0:
        assert factor(period) == (1.0, [])
    else:
        unit = {1e-3: "ms", 1e-6: "us"}[found]
        (remark,) = factor(period)[1]
        assert factor(period)[0] == found
        assert f"TAKEN AS {unit}, a period of {found * period:.4g} s" in remark


@pytest.mark.parametrize(("period", "remarks"), [(3.9, 0), (4.1, 1)])
def test_of_a_long_pendulum_its_length_is_told(period, remarks):
    value, told = factor(period)
    assert value == 1.0 and len(told) == remarks
    assert all(f"{9.81 * (period / 2 / np.pi) ** 2:.2g} m long" in one for one in told)
    assert factor(period, told=True) == (1.0, [])


@pytest.mark.parametrize("period", [61.0, 690.0])
def test_between_ms_and_a_torsion_balance_it_is_asked(period):
    with pytest.raises(InputError, match="in s it would suit a torsion balance, in ms a pendulum") as told:
        factor(period)
    assert "write ms or s" in told.value.mend
    value, (remark,) = factor(period, ticks="taken")
    assert value == 1e-3 and f"TAKEN AS ms, a period of {period / 1e3:.4g} s" in remark
    with pytest.raises(InputError, match="seem to be ms") as told:
        factor(period, ticks="asked")
    assert "signal_column" in told.value.mend


def test_beyond_a_torsion_balance_it_is_ms():
    assert factor(710.0)[0] == 1e-3


@pytest.mark.parametrize("period", [0.019, 61.0, 1e4])
def test_a_unit_that_is_stated_stands_and_an_odd_period_is_told(period):
    value, (remark,) = factor(period, told=True)
    assert value == 1.0 and f"a period of {period:.3g} s is none of a pendulum on a bench" in remark


@pytest.mark.parametrize(("size", "unit"), [(1e-3, "ms"), (1e-6, "us"), (1e-9, "ns")])
def test_a_computer_s_clock_is_known_by_its_years(size, unit):
    since, remarks = factor(1.3 / size, start=1.7e9 / size)
    assert since == size and remarks == [f"its times are {unit} since 1970, as a computer counts them"]
    assert factor(1.3 / size, start=1.7e9 / size, told=True)[0] == 1.0


def test_a_spreadsheet_s_clock_is_known_by_its_days():
    days, (remark,) = factor(1.3 / 86_400, start=45_000.0)
    assert days == 86_400 and "days since 1900" in remark and "a period of 1.3 s" in remark
    for start in (35_700.0, 71_700.0):
        with pytest.raises(InputError, match="too long or too short"):
            factor(1.3 / 86_400, start=start)


def test_of_what_shows_no_period_the_samples_are_told():
    still = np.zeros(SAMPLES.size)
    assert time_factor(SAMPLES * 0.9, still, False, "a.csv") == (1.0, [])
    with pytest.raises(InputError, match="a sample every 20 s is too long or too short"):
        time_factor(SAMPLES * 20.0, still, False, "a.csv")


@pytest.mark.parametrize(("unit", "turn"), [("rad", 2 * np.pi), ("deg", 360.0), ("", 360.0), ("", 2 * np.pi)])
def test_a_sensor_that_begins_a_turn_anew_runs_on(unit, turn):
    whole = SWING / 0.3 * turn / 8
    found, (told,) = unwrapped(whole % turn, unit)
    np.testing.assert_allclose(found, whole, atol=1e-9 * turn)
    jumps = np.count_nonzero(np.abs(np.diff(whole % turn)) > turn / 2)
    assert f"jumps by a whole turn {jumps} times" in told
    same, nothing = unwrapped(whole, unit)
    assert nothing == [] and same is whole


@pytest.mark.parametrize(("bits", "known"), [(7, False), (8, True), (12, True), (16, True)])
def test_a_counter_begins_anew_at_a_power_of_two(bits, known):
    turn = 2.0**bits
    whole = np.round(SWING / 0.3 * turn / 8)
    found, told = unwrapped(whole % turn, "counts")
    assert bool(told) is known
    if known:
        np.testing.assert_array_equal(found, whole)
    stated, told = unwrapped(whole % turn, "counts", steps=turn)
    assert told and np.array_equal(stated, whole)
    assert unwrapped(whole % turn + 0.5, "counts")[1] == []  # no whole numbers
    assert unwrapped(whole % turn - turn, "counts")[1] == []  # below 0


def test_on_and_off_is_no_counter():
    gate = np.where(np.cos(2 * np.pi * SAMPLES / 100) > 0, 255.0, 0.0)
    assert unwrapped(gate, "") == (gate, [])


@pytest.mark.parametrize("share", [0.85, 1.15])
def test_a_jump_that_is_no_whole_turn_is_none_of_a_sensor(share):
    jumping = np.where(SAMPLES < 1000, 0.0, share * 360.0)
    assert unwrapped(jumping, "deg")[1] == []


def turning(half_widths):
    """A cosine that swings to either side by so much."""
    return half_widths * np.cos(2 * np.pi * SAMPLES / 100)


@pytest.mark.parametrize(("wide", "unit"), [(3.1, "rad"), (3.3, "deg"), (182.0, "deg"), (185.0, NO_SCALE)])
def test_an_angle_is_in_the_unit_in_which_weight_swings_it_back(wide, unit):
    found, told = angle_unit(turning(wide), "", "sine", "a.csv")
    assert found == unit and bool(told) is (unit != "rad")
    if unit == "deg":
        assert (
            f"in rad it would swing back and forth by {2 * wide / 2 / np.pi:.3g} turns: TAKEN AS DEGREES"
            in told[0]
        )
    if unit == NO_SCALE:
        assert f"in degrees by {2 * wide / 360:.3g}: TAKEN AS A READING OF UNKNOWN SCALE" in told[0]
        assert "state the degrees that one unit is worth" in told[0]


@pytest.mark.parametrize(("about", "unit"), [(350.0, "deg"), (370.0, NO_SCALE), (-370.0, NO_SCALE)])
def test_no_pendulum_hangs_more_than_a_turn_aside(about, unit):
    found, (told,) = angle_unit(about + turning(20.0), "", "sine", "a.csv")
    assert found == unit and ("as no pendulum hangs" in told) is (unit == NO_SCALE)


@pytest.mark.parametrize(("wide", "unit"), [(9.0, NO_SCALE), (9.8, "deg")])
def test_a_wheel_on_a_spring_may_turn_further(wide, unit):
    found, (told,) = angle_unit(turning(wide), "", "linear", "a.csv")
    assert found == unit and ("write rad or deg" in told) is (unit == NO_SCALE)


@pytest.mark.parametrize(
    ("unit", "wide", "mend"), [("rad", 3.3, "if these are degrees"), ("deg", 185.0, ""), ("rad", 185.0, "")]
)
def test_a_stated_unit_in_which_it_swings_too_far_is_refused(unit, wide, mend):
    with pytest.raises(InputError, match=f"in {unit}, as stated, it swings back and forth by") as told:
        angle_unit(turning(wide), unit, "sine", "a.csv")
    assert "restoring" in told.value.mend and ("if these are degrees" in told.value.mend) is bool(mend)
    assert angle_unit(turning(wide), unit, "linear", "a.csv") == (unit, [])
    assert angle_unit(turning(wide), "V", "sine", "a.csv") == ("V", [])


def test_what_swings_over_the_top_and_back_in_degrees_is_no_angle():
    """A bob that drag soon slows down, in pixels: two half-swings of more than a turn."""
    times = np.arange(0, 20, 0.03)
    pixels = 214 * np.exp(-0.15 * times) * np.cos(6.3 * times)
    assert angle_unit(pixels, "", "sine", "")[0] == NO_SCALE
    assert angle_unit(0.8 * pixels, "", "sine", "")[0] == "deg"


def test_one_push_over_the_top_is_no_swing():
    signal = turning(1.0)
    signal[1000:] += 2 * np.pi
    assert angle_unit(signal, "rad", "sine", "a.csv") == ("rad", [])


def test_between_two_samples_an_angle_moves_by_less_than_half_a_turn():
    times, angle = np.arange(6) / 10, np.array([0, 3.1, 0, 0, 3.2, 3.2])
    with pytest.raises(
        InputError, match=r"a\.csv, 0\.4 s: the angle changes by 0\.509 turns between two samples"
    ):
        check_steps(times, angle, "a.csv")
    assert check_steps(times[:4], angle[:4], "a.csv") is None
    assert check_steps(times + [0, 0, 0, 0, 0.1, 0.1], angle, "a.csv") is None  # across a hole


@pytest.mark.parametrize(
    ("largest", "told"), [(6.2, []), (-12.6, ["it reaches 2.01 turns, which are taken for counted turns"])]
)
def test_more_than_a_turn_is_told(largest, told):
    assert turns_counted(np.array([0.0, largest])) == told


def test_what_is_no_angle_has_no_rad():
    assert in_rad("deg") == pytest.approx(np.pi / 180) and in_rad("rad") == 1 and in_rad("V") == 0
