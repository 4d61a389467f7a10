"""Swings given as arrays are the same swing in every form, and what is wrong with them is told by their names."""

import numpy as np
import pandas as pd
import pytest
import xarray as xr

from swingdown.answer.given import asked, drive_over, swings
from swingdown.errors import InputError
from swingdown.measurement.points.points_recording import are_points

TIMES = np.arange(900) / 60
ANGLES = 0.4 * np.exp(-0.03 * TIMES) * np.cos(4.4 * TIMES)
ANGLES += 1e-3 * np.random.default_rng(1).standard_normal(TIMES.size)


def same(found, angles=ANGLES, times=TIMES):
    (one,) = found
    np.testing.assert_allclose(one["angle"], angles, atol=1e-12)
    np.testing.assert_allclose(one["time"], times, atol=1e-12)
    assert one["angle"].attrs["units"] == "rad" and one.attrs["source"] == "given as arrays"
    return one


@pytest.mark.parametrize(
    "given",
    [
        (TIMES, ANGLES),
        (np.stack([TIMES, ANGLES]), None),
        (np.column_stack([TIMES, ANGLES]), None),
        (pd.Series(ANGLES, TIMES), None),
        (pd.DataFrame({"x": ANGLES}, TIMES), None),
        (pd.DataFrame({"angle": ANGLES, "t": TIMES}), None),
        (xr.DataArray(ANGLES, {"time": TIMES}, ["time"]), None),
        (xr.Dataset({"force": ("time", TIMES), "theta": ("time", ANGLES)}, {"time": TIMES}), None),
        (xr.Dataset({"theta": ("time", TIMES), "angle": ("time", ANGLES)}, {"time": TIMES}), None),
        ([(TIMES, ANGLES)], None),
        (TIMES, [ANGLES]),
        ([TIMES], [ANGLES]),
    ],
)
def test_a_swing_in_any_form_is_the_same_swing(given):
    assert same(swings(*given, unit="rad")).attrs["recording"] == "swing"


@pytest.mark.parametrize("unit", [None, "deg"])
def test_degrees_are_degrees_by_the_argument_or_by_their_own_word(unit):
    degrees = np.degrees(ANGLES)
    given = degrees if unit else xr.DataArray(degrees, attrs={"units": "deg"})
    found = swings(TIMES, given, unit)
    same(found)
    with pytest.raises(InputError, match="the argument unit says rad, but the angles themselves say deg"):
        swings(TIMES, xr.DataArray(degrees, attrs={"units": "deg"}), "rad")


def test_several_swings_have_their_own_names_times_and_count():
    later = TIMES + 5
    found = swings([TIMES, later], [ANGLES, 0.5 * ANGLES], "rad")
    assert [one.attrs["recording"] for one in found] == ["swing 1", "swing 2"]
    same(found[1:], 0.5 * ANGLES, later)
    named = swings(TIMES, [ANGLES, 0.5 * ANGLES], "rad", names=["a", "b"])
    assert [one.attrs["recording"] for one in named] == ["a", "b"]
    same(named[1:], 0.5 * ANGLES)
    for names in (["a"], ["a", "a"], ["a", "b", "c"]):
        told = "the name 'a' is there twice" if len(names) == 2 else f"names given: {len(names)}, swings: 2"
        with pytest.raises(InputError, match=told):
            swings(TIMES, [ANGLES, ANGLES], "rad", names=names)
    with pytest.raises(InputError, match="2 series of times for 1 of angles"):
        swings([TIMES, TIMES], [ANGLES], "rad")


def test_missing_samples_are_left_out_and_told_up_to_a_half():
    angles = ANGLES.copy()
    angles[[100, 200, 201]] = np.nan, np.inf, np.nan
    one = same(
        swings(TIMES, angles, "rad"), np.delete(ANGLES, [100, 200, 201]), np.delete(TIMES, [100, 200, 201])
    )
    assert one.attrs["remarks"] == "3 of 900 samples hold no number: missing"
    angles[450:] = np.nan
    with pytest.raises(InputError, match=r"swing, sample 100: not a finite number \(453 of 900 samples\)"):
        swings(TIMES, angles, "rad")


def test_too_few_samples_and_lengths_that_differ_are_refused():
    with pytest.raises(InputError, match="swing: 9 samples. Expected: at least 10"):
        swings(TIMES[:9], ANGLES[:9], "rad", kind="swing")
    with pytest.raises(InputError, match="899 angles for 900 times"):
        swings(TIMES, ANGLES[:-1], "rad")
    with pytest.raises(InputError, match="swing: it is empty"):
        swings(TIMES[:0], ANGLES[:0], "rad", kind="swing")


@pytest.mark.parametrize(
    ("words", "told"), [({"unit": "grad"}, "unknown unit 'grad'"), ({"kind": "saw"}, "unknown kind 'saw'")]
)
def test_an_unknown_word_is_refused_with_the_known_ones(words, told):
    with pytest.raises(InputError, match=told):
        swings(TIMES, ANGLES, **words)


@pytest.mark.parametrize(("restoring", "own"), [("sine", None), ("linear", "V")])
def test_volts_have_no_scale_and_on_a_spring_a_unit_of_their_own(restoring, own):
    (one,) = swings(TIMES, 2 + 3 * ANGLES, "V", restoring=restoring)
    assert one.attrs.get("own_unit") == own
    slope, middle = np.polyfit(ANGLES, one["angle"].values, 1)
    np.testing.assert_allclose(one["angle"], slope * ANGLES + middle, atol=1e-9)
    assert abs(middle) < 0.05 * slope  # what it hangs at is taken away
    if own:
        assert one.attrs["own_step"] * slope == pytest.approx(3)  # V for a rad


def test_a_zero_is_open_unless_its_limit_is_given():
    """Nobody states it: a tenth of a radian; of a uniform distribution the standard uncertainty is that over the root of 3."""

    def zero(one):
        slack = one["reading_slack"].values if "reading_slack" in one else np.zeros((1, 1))
        return float(np.abs(slack).max())

    assert zero(swings(TIMES, ANGLES, "rad")[0]) == pytest.approx(0.1 / np.sqrt(3))
    for limit in (0.03, 0.0):
        found = zero(swings(TIMES, ANGLES, "rad", said={"zero_tolerance": limit})[0])
        assert found == pytest.approx(limit / np.sqrt(3))


def test_several_releases_in_one_array_are_a_swing_each():
    hold = np.full(90, 0.4)
    angles = np.concatenate([ANGLES, hold, ANGLES])
    times = np.arange(angles.size) / 60
    found = swings(times, angles + 1e-4 * np.random.default_rng(2).standard_normal(angles.size), "rad")
    assert [one.attrs["recording"] for one in found] == ["swing, release 1", "swing, release 2"]
    assert float(found[0]["time"][-1]) < 16 < float(found[1]["time"][0]) < 17.2


def test_a_clock_that_counts_anew_parts_the_array():
    found = swings(np.tile(TIMES, 2), np.concatenate([ANGLES, 0.5 * ANGLES]), "rad")
    assert [one.attrs["recording"] for one in found] == ["swing, part 1", "swing, part 2"]
    same(found[1:], 0.5 * ANGLES)


def test_turning_points_and_passages_are_told_from_samples():
    halves = np.arange(30)
    points = 0.7 * halves + 0.003 * np.random.default_rng(1).standard_normal(30)
    (one,) = swings(points, 0.3 * 0.97**halves * (-1.0) ** halves, "rad")
    assert are_points(one) and list(one["half_swings"].values) == list(halves)
    assert one.attrs["remarks"].startswith("taken as turning points, each half-swing")
    (gate,) = swings(np.sort(points), kind="passages")
    assert are_points(gate) and gate.sizes["time"] == 30
    with pytest.raises(InputError, match="30 times and 29 speeds"):
        swings(np.sort(points), np.ones(29), kind="passages")
    with pytest.raises(InputError, match="increasing times"):
        swings(points[::-1], kind="passages")


def test_an_input_is_a_s_at_the_swing_s_times_or_at_its_own():
    drive = 0.1 * np.sin(3 * TIMES)
    said = {"input": drive, "input_kind": "pivot_angle"}
    (one,) = swings(TIMES, ANGLES, "rad", said=said)
    np.testing.assert_array_equal(one["input"], drive)
    (own,) = swings(
        TIMES, ANGLES, "rad", said=said | {"input": (2 * TIMES[:100], drive[:100]), "input_unit": "deg"}
    )
    np.testing.assert_allclose(own["input"], np.radians(drive[:100]))
    np.testing.assert_array_equal(own["input_time"], 2 * TIMES[:100])
    both = swings(TIMES, [ANGLES, ANGLES], "rad", said=said | {"input": [drive, 2 * drive]})
    np.testing.assert_array_equal(both[1]["input"], 2 * drive)
    shared = swings(TIMES, [ANGLES, ANGLES], "rad", said=said)
    np.testing.assert_array_equal(shared[1]["input"], drive)
    with pytest.raises(InputError, match="3 inputs for 2 swings"):
        swings(TIMES, [ANGLES, ANGLES], "rad", said=said | {"input": [drive, drive, drive]})
    with pytest.raises(InputError, match="899 values for 900 times"):
        swings(TIMES, ANGLES, "rad", said=said | {"input": drive[:-1]})
    few = said | {"input": (TIMES, drive)}
    with pytest.raises(InputError, match="swing: 9 samples"):
        swings(TIMES[:9], ANGLES[:9], "rad", said=few)
    found = drive_over(TIMES, said | {"input_unit": "deg", "input_between": "line"})
    np.testing.assert_allclose(found.at(TIMES[5:20]), np.radians(drive[5:20]))


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ({"speed": 1}, "argument speed: there is no such argument"),
        ({"zero_tolerance": "a bit"}, "it is 'a bit'"),
        ({"input_kind": "torque"}, "argument input_kind: the drive is described, but its values are missing"),
    ],
)
def test_what_a_call_cannot_say_is_refused(given, told):
    with pytest.raises(InputError, match=told):
        asked(given)
    assert asked({"zero_tolerance": None, "input": None}) == {}
    assert asked({"zero_tolerance": 0.1}) == {"zero_tolerance": 0.1}


@pytest.mark.parametrize(
    ("given", "told"),
    [
        (xr.Dataset({"force": ("time", TIMES)}), "no angle among force"),
        (xr.DataArray(np.zeros((3, 4)), dims=("a", "b")), "its dimensions are"),
        (xr.DataArray(ANGLES, dims=["time"]), "its dimensions are"),
        (pd.DataFrame({"t": TIMES, "x (m)": ANGLES, "y (m)": ANGLES}), "column 'x .m.' holds no angle"),
    ],
)
def test_what_holds_no_swing_is_refused(given, told):
    with pytest.raises(InputError, match=told):
        swings(given)
