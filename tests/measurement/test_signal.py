"""What a column, or two, are read as: an angle by unit, scale, length or pivot, each against the swing that made it."""

import numpy as np
import pytest

from swingdown.engine.trajectory import simulate
from swingdown.errors import InputError
from swingdown.measurement.choice import Chosen
from swingdown.measurement.files.columns import meaning
from swingdown.measurement.sheet import COLUMNS
from swingdown.measurement.signal import signal_of
from swingdown.measurement.units import NO_SCALE
from swingdown.pendulum.model import Model

TIMES = np.arange(1200) / 40
LENGTH = 0.8  # m, and g / LENGTH is the square of the frequency
FREE = Model("viscous", {"natural_frequency": np.sqrt(9.81 / LENGTH), "viscous_ratio": 0.004})
ANGLE = simulate(FREE, TIMES, 0.5)
SMALL = simulate(FREE, TIMES, 0.05)


def read(columns, restoring="sine", third="", unit=None, **cells):
    """What signal_of makes of columns beside a time."""
    found = [meaning(name) for name in columns]
    chosen = Chosen(meaning("t (s)"), found[:2] if found[0].axis else found[:1], "s", found[0].unit if unit is None else unit)  # fmt: skip
    made = {**COLUMNS, "recording": "a", "file": "a.csv"} | cells
    return signal_of(made, "sheet.csv", chosen, TIMES, columns, restoring, third)


@pytest.mark.parametrize(
    ("name", "cells", "unit", "scale"),
    [
        ("angle (rad)", {}, "rad", 1),
        ("angle (deg)", {}, "deg", np.pi / 180),
        ("gyro x (deg/s)", {}, "deg/s", 0),
        ("n (counts)", {"counts_per_revolution": 4000.0}, "counts", 2 * np.pi / 4000),
        ("n (counts)", {"counts_per_revolution": np.nan}, "counts", np.nan),
        ("n (counts)", {"scale": "0.36", "counts_per_revolution": np.nan}, "counts", np.radians(0.36)),
        ("U (V)", {}, "V", 0),
        ("U (V)", {"scale": "20 deg/V"}, "V", np.radians(20)),
        ("U (V)", {"scale": "0.5 rad/V"}, "V", 0.5),
        ("U (V)", {"scale": "1=0,3.5=30"}, "V", np.radians(12)),
        ("U (V)", {"scale": "relative"}, "V", np.nan),
        ("value", {"scale": "-0.5"}, NO_SCALE, np.radians(-0.5)),
        ("value", {"scale": "relative"}, NO_SCALE, np.nan),
        ("adc", {}, NO_SCALE, np.nan),
        ("adc", {"signal_unit": "rad"}, "rad", 1),
    ],
)
def test_a_column_is_read_by_its_unit_or_the_scale_that_is_stated(name, cells, unit, scale):
    found = read({name: ANGLE}, unit=cells.get("signal_unit"), **cells)
    assert found.reading.unit == unit and found.reading.stated
    assert found.reading.scale == pytest.approx(scale, nan_ok=True)
    np.testing.assert_array_equal(found.signal, ANGLE)


def test_a_column_without_a_unit_is_rad_until_somebody_says_so():
    found = read({"value": ANGLE})
    assert found.reading.unit == "rad" and not found.reading.stated and found.reading.scale == 1


@pytest.mark.parametrize("scale", ["a lot", "0", "1=0", "5=1,5=2", "inf", "20 m/V"])
def test_what_is_no_scale_is_refused(scale):
    with pytest.raises(InputError, match="is no scale. Expected: degrees that one unit"):
        read({"U (V)": ANGLE}, scale=scale)


def test_a_scale_of_what_has_a_unit_is_refused():
    with pytest.raises(InputError, match="what one unit of the signal is worth, and that is in deg already"):
        read({"angle (deg)": ANGLE}, scale="2")
    assert read({"angle (deg)": ANGLE}, scale="relative").reading.unit == NO_SCALE


@pytest.mark.parametrize(
    ("name", "own"), [("angle (rad)", "rad"), ("U (V)", "V"), ("n (counts)", "counts"), ("a (m/s^2)", "m/s^2"), ("F (N)", ""), ("gyro x (deg/s)", "")]
)  # fmt: skip
def test_on_a_spring_sizes_are_in_the_unit_of_what_moves_as_it_does(name, own):
    found = read({name: ANGLE}, "linear")
    assert found.reading.own == own and read({name: ANGLE}).reading.own == ""
    assert any("taken as the place of a mass on a spring" in one for one in found.remarks) is (
        "m/s^2" in name
    )


@pytest.mark.parametrize(("unit", "factor"), [("m", 1), ("cm", 100), ("mm", 1000), ("px", 450)])
@pytest.mark.parametrize("names", [("x", "y"), ("y", "x")])
def test_positions_give_the_angle_about_their_pivot_in_any_unit(unit, factor, names):
    place = {"x": factor * (0.3 + LENGTH * np.sin(ANGLE)), "y": factor * (0.9 - LENGTH * np.cos(ANGLE))}
    found = read({f"{name} ({unit})": place[name] for name in ("x", "y")})
    swing = found.signal - found.signal.mean()
    assert np.abs(np.abs(swing) - np.abs(ANGLE - ANGLE.mean())).max() < 1e-6
    assert found.reading.unit == "rad" and found.reading.computed and found.reading.scale == 1
    assert found.about["pivot_radius"] == pytest.approx(factor * LENGTH)
    assert (
        found.about["pivot_x"] == pytest.approx(0.3 * factor)
        and f"{unit} (RMS) from the circle" in found.remarks[0]
    )


@pytest.mark.parametrize("place", [(0.05, 1.5), (2.0, -3.0), (-0.6, -1.6), (0.4, -1.2)])
@pytest.mark.parametrize("count", [6, 60, 200])
def test_positions_that_a_tracker_lost_are_left_out(place, count):
    """Wherever it looked at meanwhile: a few far off draw no circle to themselves."""
    x, y = LENGTH * np.sin(ANGLE), -LENGTH * np.cos(ANGLE)
    lost = np.arange(100, 100 + count)
    x[lost], y[lost] = place
    found = read({"x (m)": x, "y (m)": y})
    np.testing.assert_array_equal(found.times, np.delete(TIMES, lost))
    assert found.about["pivot_radius"] == pytest.approx(LENGTH)
    assert found.remarks[-1].startswith(
        f"{count} of 1200 positions lie off the circle, as where a tracker lost the bob"
    )


def test_more_than_a_fifth_of_lost_positions_are_refused():
    x, y = LENGTH * np.sin(ANGLE), -LENGTH * np.cos(ANGLE)
    x[100:400], y[100:400] = 2.0, -3.0
    with pytest.raises(InputError, match=r"2\d % of the positions lie off the circle of the others"):
        read({"x (m)": x, "y (m)": y})


def test_a_tracker_that_scatters_by_a_tenth_of_the_swing_is_told():
    draws = np.random.default_rng(1)
    for scatter, told in ((0.001, False), (0.01, True)):  # of a swing of 0.04 m
        x, y = LENGTH * np.sin(SMALL), -LENGTH * np.cos(SMALL)
        found = read({"x (m)": x + scatter * draws.standard_normal(1200), "y (m)": y + scatter * draws.standard_normal(1200)})  # fmt: skip
        assert any("THE TRACKER SCATTERS by" in one for one in found.remarks) is told


def test_positions_on_a_line_are_one_coordinate_along_it():
    found = read({"x (cm)": 80 * SMALL * 0.6, "y (cm)": 3 + 80 * SMALL * 0.8})
    assert "the positions lie on a line" in found.remarks[0] and found.reading.computed
    ratio = np.polyfit(SMALL, found.signal, 1)
    np.testing.assert_allclose(found.signal, np.polyval(ratio, SMALL), atol=1e-3 * np.ptp(found.signal))


@pytest.mark.parametrize(("unit", "factor"), [("m", 1), ("cm", 100), ("px", 450)])
def test_a_coordinate_and_a_length_give_the_angle(unit, factor):
    found = read({f"x ({unit})": factor * (0.2 + LENGTH * np.sin(ANGLE))}, length=f"{factor * LENGTH}{unit}")
    np.testing.assert_allclose(found.signal - found.signal.mean(), ANGLE - ANGLE.mean(), atol=0.01)
    assert found.remarks == [
        f"one coordinate: the angle is its arcsine over the length, {factor * LENGTH}{unit}"
    ]


def test_a_small_coordinate_tells_its_length_by_the_period_and_a_wide_one_asks_for_it():
    """9.81 m/s² over the square of the frequency; of pixels nothing tells how far they swing."""
    found = read({"x (m)": LENGTH * np.sin(SMALL)})
    np.testing.assert_allclose(found.signal - found.signal.mean(), SMALL - SMALL.mean(), atol=1e-3)
    with pytest.raises(InputError, match="its period falls as its swings shrink.*length"):
        read({"x (px)": 450 * np.sin(simulate(FREE, TIMES, 1.0))})
    alone = read({"x (px)": 450 * np.sin(SMALL)})
    assert alone.reading.unit == NO_SCALE and "one coordinate without a length" in alone.remarks[0]
    scaled = read({"x (px)": 450 * np.sin(ANGLE)}, scale="0.13")
    assert scaled.reading.scale == pytest.approx(np.radians(0.13)) and scaled.remarks == []


def test_a_height_is_refused_but_on_a_spring_and_a_speed_is_taken_as_it_swings():
    with pytest.raises(InputError, match="the height of a bob without its partner x"):
        read({"y (m)": 1 - LENGTH * np.cos(ANGLE)})
    with pytest.raises(InputError, match="turning points of one side stay where they are"):
        read({"x (m)": 1 - LENGTH * np.cos(ANGLE)})
    bob = read({"y (m)": SMALL}, "linear")
    assert (
        "the height of a bob whose tops fall as its bottoms rise" in bob.remarks[0] and bob.reading.own == "m"
    )
    with pytest.raises(InputError, match="the height of a bob"):
        read({"y (m)": SMALL}, length="0.8m")
    speed = read({"v (m/s)": np.gradient(ANGLE, TIMES)})
    assert speed.remarks == ["the speed of a bob: taken as it swings"] and speed.reading.unit == NO_SCALE
    assert read({"v (m/s)": np.gradient(ANGLE, TIMES)}, "linear").reading.own == ""  # no deflection


def test_a_third_axis_without_a_unit_is_asked_about():
    columns = {"x": np.sin(ANGLE), "y": np.cos(ANGLE)}
    with pytest.raises(InputError, match="are they positions of a bob, its acceleration, or rates"):
        read(columns, third="z")
    assert read({f"{name} (m)": one for name, one in columns.items()}, third="z").reading.unit == "rad"


def test_how_it_was_read_is_told_in_words():
    found = read({"U (V)": ANGLE}, scale="20")._replace(read=("`U (V)`", "", "`t (s)` as s"))
    assert found.taken(found.reading) == "took `U (V)` as volts, `t (s)` as s"
    scaled = read({"value": ANGLE}, scale="20")._replace(read=("`value`", "", "`t (s)` as s"))
    assert scaled.taken(scaled.reading) == "took `value` as readings of 20° each, `t (s)` as s"
    bare = read({"value": ANGLE})._replace(read=("`value`", "", "`t (s)` as s"))
    assert bare.taken(bare.reading) == "took `value` as rad (no unit is stated), `t (s)` as s"


def test_of_a_body_s_angles_the_one_that_swings_is_taken_and_of_its_rates_the_one_that_turns_most():
    wander = np.cumsum(np.random.default_rng(1).standard_normal(1200))
    angles = read({"roll (deg)": 50 * wander, "pitch (deg)": 30 * ANGLE})
    assert (
        angles.column == "pitch (deg)"
        and "of 2 angles `pitch (deg)` swings and was taken" in angles.remarks[0]
    )
    rates = read({"gyro x (deg/s)": 0.05 * ANGLE, "gyro y (deg/s)": 30 * ANGLE})
    assert rates.column == "gyro y (deg/s)"
    np.testing.assert_array_equal(rates.signal, 30 * ANGLE)
