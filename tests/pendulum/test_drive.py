"""A measured drive: what it is at its samples, between them and beyond them."""

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from swingdown.errors import InputError
from swingdown.pendulum.drive import drive

TIMES = np.array([0.0, 0.8, 2.0, 4.0, 4.5])
VALUES = np.array([1.0, 3.0, 2.0, 2.0, 0.0])


@pytest.mark.parametrize("between", ["curve", "line", "hold"])
def test_it_goes_through_its_samples(between):
    assert drive(TIMES, VALUES, "torque", between, []).at(TIMES) == pytest.approx(VALUES)


def test_between_samples_it_keeps_goes_straight_or_curves():
    at = np.array([0.5, 1.999, 3.0])
    assert drive(TIMES, VALUES, "torque", "hold").at(at) == pytest.approx([1, 3, 2])
    line = drive(TIMES, VALUES, "torque", "line")
    assert line.at(at) == pytest.approx([2.25, 2 + 0.001 / 1.2, 2])
    assert line.derivatives(at)[1] == pytest.approx([2.5, -1 / 1.2, 0]) and not line.derivatives(at)[2].any()


def test_a_curve_is_that_of_a_cubic_with_its_derivatives_and_straight_at_its_ends():
    times = np.linspace(0, 3, 301)
    curve = drive(times, np.sin(times), "torque")
    at = np.array([1.234, 2.0])
    value, rate, bend = curve.derivatives(at)
    assert value == pytest.approx(np.sin(at), abs=1e-9)
    assert rate == pytest.approx(np.cos(at), abs=1e-6) and bend == pytest.approx(-np.sin(at), abs=1e-3)
    assert drive(TIMES, VALUES, "torque").derivatives(TIMES[[0, -1]])[2] == pytest.approx([0, 0], abs=1e-12)


def test_beyond_its_samples_a_curve_goes_on_straight_and_all_else_stays_as_it_was():
    curve = drive(TIMES, VALUES, "torque")
    for edge, away in ((0.0, -1.0), (4.5, 1.0)):
        value, rate, _ = (float(one) for one in curve.derivatives(edge))
        for far in (0.2, 0.5, 1.5, 3.0):
            assert float(curve.at(edge + far * away)) == pytest.approx(value + rate * far * away)
    for between in ("line", "hold"):
        assert drive(TIMES, VALUES, "torque", between).at([-3.0, 9.0]) == pytest.approx([1, 0])


def test_a_torque_has_a_gain_to_be_found_and_no_other_kind_has_unless_asked():
    assert drive(TIMES, VALUES, "torque").effect == "torque_input_gain"
    assert drive(TIMES, VALUES, "torque", free=[]).effect == "torque_input"
    assert drive(TIMES, VALUES, "pivot_angle").effect == "pivot_angle_input"
    assert (
        drive(TIMES, VALUES, "pivot_position", free=["delay", "gain"]).effect
        == "pivot_position_input_gain_delay"
    )


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"kind": "wind"}, "unknown input_kind 'wind'"),
        ({"between": "steps"}, "unknown input_between 'steps'"),
        ({"free": ["phase"]}, "unknown 'phase'"),
        ({"between": "hold", "free": ["delay"]}, "no delay that a fit could find"),
        ({"values": VALUES[:4]}, "4 values for 5 times"),
        ({"times": TIMES[:3], "values": VALUES[:3]}, "3 values for 3 times"),
        ({"times": TIMES[[0, 1, 1, 3, 4]]}, "its times do not increase"),
        ({"values": np.where(TIMES == 2, np.nan, VALUES)}, "no number at 2 s"),
    ],
)
def test_what_is_no_drive_is_refused_with_the_reason(changed, words):
    given = {"times": TIMES, "values": VALUES, "kind": "torque"} | changed
    with pytest.raises(InputError, match=words):
        drive(**given)


def test_four_samples_are_enough():
    assert drive(TIMES[:4], VALUES[:4], "torque").at(0.8) == pytest.approx(3.0)


def test_a_curve_is_the_natural_spline_with_its_slopes():
    """Between samples of any spacing, and with knots that rise one step beyond them."""
    found, right = drive(TIMES, VALUES, "torque"), CubicSpline(TIMES, VALUES, bc_type="natural")
    at = np.linspace(0, 4.5, 46)
    for order, values in enumerate(found.derivatives(at)):
        assert values == pytest.approx(right(at, order), abs=1e-12)
    assert found.knots == pytest.approx([-0.8, *TIMES, 5.0])
    assert found.at(-0.8) == pytest.approx(1 - 0.8 * right(0.0, 1))
