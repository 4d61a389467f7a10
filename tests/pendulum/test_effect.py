"""What an entry says of itself: its size, what it takes from a swing at no speed, and which of its numbers are told or fitted."""

import numpy as np
import pytest

from swingdown.errors import InputError
from swingdown.pendulum.effect import NATURAL_FREQUENCY, Effect, Parameter, State


def effect(term="-c*thetadot", *parameters, **more):
    return Effect("one", term, parameters or (Parameter("size", "c", "1/s"),), "One.", "none", **more)


def test_a_parameter_is_open_to_either_side_where_nothing_is_said():
    plain = Parameter("a", "a", "1")
    assert (plain.lower, plain.upper, plain.typical, plain.role, plain.largest) == (
        -np.inf,
        np.inf,
        0.01,
        "size",
        np.inf,
    )
    assert plain.starts == () and not (plain.relative or plain.at_line or plain.each) and plain.drawn == ()
    assert (NATURAL_FREQUENCY.lower, NATURAL_FREQUENCY.upper, NATURAL_FREQUENCY.typical) == (0.0, np.inf, 7.0)


@pytest.mark.parametrize(("lower", "least"), [(0.0, -np.inf), (-1.0, -np.inf), (1e-3, 1e-3)])
def test_below_a_bound_above_nothing_there_is_no_effect(lower, least):
    assert Parameter("a", "a", "1", lower).least == least


def test_searches_start_where_the_entry_says_in_the_parameter_s_unit():
    assert Parameter("a", "a", "rad/s", starts=(0.5, 2.0), relative=True).starting_values(7.0) == [3.5, 14.0]
    assert Parameter("a", "a", "rad/s", starts=(0.5, 2.0)).starting_values(7.0) == [0.5, 2.0]


def test_the_size_is_the_first_and_is_told_where_nothing_else_is():
    shape, first, second = (
        Parameter("w", "w", "rad", role="shape"),
        Parameter("a", "a", "1"),
        Parameter("b", "b", "1"),
    )
    both = effect("-a*b*w", shape, first, second)
    assert both.size is first and both.told == ("a",) and both.with_role("size") == (first, second)
    assert effect("-w", shape).size is None and effect("-w", shape).told == ()
    assert effect("-a*b*w", shape, first, second, headline=("b", "w")).told == ("b", "w")


@pytest.mark.parametrize(("lower", "one_sided"), [(0.0, True), (-1.0, False), (-np.inf, False), (0.5, False)])
def test_a_size_that_begins_at_nothing_is_one_sided(lower, one_sided):
    assert effect("-c*thetadot", Parameter("size", "c", "1/s", lower)).one_sided is one_sided
    assert not effect("-c*thetadot", Parameter("w", "c", "1/s", lower, role="shape")).one_sided


@pytest.mark.parametrize(
    ("term", "more", "rubs"),
    [
        ("-c*sign(thetadot)", {}, True), ("-c*(1 + theta)*sign(thetadot)", {}, True), ("-c*tanh(thetadot/1e-310)", {}, True),
        ("-c*thetadot", {}, False), ("-c*thetadot*abs(thetadot)", {}, False), ("-c*theta", {}, False), ("-c*theta*sign(thetadot)", {}, False),
        ("-c*sign(thetadot)*input", {}, False), ("theta + c*sign(thetadot)", {"acts_on": "sensor"}, False),
        ("-c*sign(thetadot)", {"states": (State("z", "1", "0", "-z"),)}, False), ("-c*sin(theta)/theta", {}, False),
    ],
)  # fmt: skip
def test_a_friction_is_left_at_the_middle_as_the_speed_goes_to_nothing(term, more, rubs):
    assert effect(term, **more).rubs is rubs


def test_of_a_shape_the_first_start_decides_whether_it_rubs():
    width = Parameter("w", "w", "1", role="shape", starts=(0.0, 1.0))
    assert not effect("-c*w*sign(thetadot)", Parameter("size", "c", "1"), width).rubs
    assert effect("-c*w*sign(thetadot)", Parameter("size", "c", "1"), width._replace(starts=(1.0,))).rubs


def test_what_each_recording_has_is_told_by_name():
    one = effect("-a*cos(p)", Parameter("a", "a", "1"), Parameter("p", "p", "rad", role="phase", each=True))
    assert one.each == ("p",)
    late = effect("-a*input", Parameter("a", "a", "1"), Parameter("d", "d", "s", role="delay"))
    assert late.numerics[-1] == ("d",) and late.numerics[-3] == ("a", "d") and one.numerics[-1] == ()
    assert effect().numerics != effect("-2*c*thetadot").numerics


@pytest.mark.parametrize(
    ("term", "more", "takes"),
    [("-c*input", {}, True), ("-c*input_rate", {}, True), ("-c*input_curve", {}, True), ("-c*theta", {"inertia": "c*input"}, True),
     ("-c*z", {"states": (State("z", "1", "0", "input - z"),)}, True), ("-c*theta", {"inertia": "c"}, False), ("-c*inputs", {}, False)],
)  # fmt: skip
def test_a_formula_that_names_the_drive_takes_it(term, more, takes):
    assert effect(term, **more).takes_input is takes


def test_formulas_are_of_what_the_effect_acts_on():
    torque = effect(
        "-c*thetadot",
        inertia="c",
        states=(State("z", "1", "theta", "thetaddot - z"),),
        printed="-2*c*thetadot",
    )
    found = torque.expressions()
    assert {kind: str(one) for kind, one in found.motion.items()} == {"torque": "-c*thetadot", "inertia": "c"}
    assert str(torque.expressions("printed").motion["torque"]) == "-2*c*thetadot"
    assert ([str(one) for one in found.rates], [str(one) for one in found.initial]) == (
        ["thetaddot - z"],
        ["theta"],
    )
    assert found.reading is None
    for acts_on in ("sensor", "clock"):
        other = effect("c + t", acts_on=acts_on).expressions("printed")
        assert other.motion == {} and str(other.reading) == "c + t"
    play = effect("c", acts_on="play").expressions()
    assert play.motion == {} and play.reading is None


def test_a_formula_that_cannot_be_read_is_told_with_its_effect():
    with pytest.raises(InputError, match="effect one"):
        effect("-c*unknown").expressions()
    with pytest.raises(InputError, match="effect one"):
        effect("-c*thetaddot").expressions()  # in a state alone
