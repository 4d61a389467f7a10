"""Effects without a name are sums of pieces that are linear in their coefficients, and smooth."""

import numpy as np
import pytest

from swingdown.pendulum.formula import evaluate
from swingdown.pendulum.free_form import FREE_FORMS

BY_OVER = {one.over: one for one in FREE_FORMS}
AT = {"theta": np.linspace(-0.6, 0.6, 9), "thetadot": np.linspace(-3, 3, 9), "t": np.linspace(0, 8, 9)}


def piece(over, k):
    """What the k-th coefficient of 1 alone is, with a range of 0.6 or 3."""
    one = BY_OVER[over]
    known = {parameter.symbol: 0.0 for parameter in one.parameters}
    known |= {f"c_{k}": 1.0, "s_u": 0.6 if over == "position" else 3.0}
    if over == "time":
        known.pop("s_u")
    return evaluate(one.term, **AT, duration=8.0, omega_n=5.0, **known) * np.ones(9)


def test_there_is_one_for_place_speed_and_time():
    assert [one.over for one in FREE_FORMS] == ["position", "velocity", "time"]
    assert [len(one.coefficients) for one in FREE_FORMS] == [7, 7, 9]
    for one in FREE_FORMS:
        assert one.name == f"unnamed_{one.over}" and not one.rubs or one.over == "velocity"
        assert all(
            parameter.typical == 0.1 and parameter.unit == "rad/s^2" for parameter in one.with_role("size")
        )
    assert BY_OVER["time"].parts == ("drag", "stiffness", "push") and BY_OVER["position"].parts == ("torque",)


@pytest.mark.parametrize(("over", "unit"), [("position", "rad"), ("velocity", "rad/s")])
def test_what_it_acts_over_is_given(over, unit):
    (given,) = BY_OVER[over].with_role("range")
    assert (given.name, given.unit, given.lower, given.typical) == (f"unnamed_{over}_range", unit, 1e-6, 1.0)
    assert BY_OVER["time"].ranges == ()


def test_over_the_place_it_is_a_polynomial_without_the_term_that_a_spring_is():
    x = AT["theta"] / 0.6
    for k, power in enumerate((0, 2, 3, 4, 5, 6, 7)):
        np.testing.assert_allclose(piece("position", k), x**power, atol=1e-12)


def test_over_the_speed_it_is_bumps_side_by_side_against_the_motion():
    v = AT["thetadot"] / 3
    for k in range(7):
        np.testing.assert_allclose(
            piece("velocity", k), np.sign(v) * np.exp(-((6 * np.abs(v) - k) ** 2)), atol=1e-12
        )


def test_over_the_time_drag_stiffness_and_a_push_change_by_polynomials():
    share = AT["t"] / 8
    for k in range(9):
        of = (AT["thetadot"] / 5, AT["theta"], 1.0)[k // 3]
        np.testing.assert_allclose(piece("time", k), of * share ** (k % 3 + 1), atol=1e-12)
