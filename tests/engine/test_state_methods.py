"""How the engine finds each state is told from its formula, and where a formula may be narrow."""

import pytest

from swingdown.engine.state_methods import StateMethod, localisation, state_methods
from swingdown.pendulum.effect import Effect, Parameter, State
from swingdown.pendulum.formula import parse, symbol

NAMES = ("theta", "thetadot", "thetaddot", "t", "omega_n", "a", "b", "r", "z", "w")


@pytest.mark.parametrize(
    ("text", "where"),
    [
        ("a*theta**3 - b*sin(theta)*thetadot", 0), ("a*exp(-r)*theta", 0), ("r**2*t", 0), ("theta**2*thetadot", 0),
        ("exp(-(thetadot/a)**2)", 1), ("tanh(t/a)", 1), ("log(1 + thetadot**2)", 1), ("1/(1 + thetadot**2)", 1), ("sqrt(1 + t**2)", 1),
        ("exp(-(theta/a)**2)", 2), ("tan(theta)", 2), ("1/(a + theta)", 2), ("tanh(thetaddot)", 2), ("(1 + theta**2)**0.5", 2),
        ("exp(-t) + theta**2", 1), ("exp(-t)*tanh(theta)", 2),
    ],
)  # fmt: skip
def test_what_may_change_all_at_once_is_told_by_angle_or_by_velocity_and_time(text, where):
    assert localisation(parse(text, NAMES)) == where


def methods(term, *rates, acts_on="torque"):
    """Those of an effect with this term and states z and w of these rates."""
    states = tuple(State(name, "1", "0", rate) for name, rate in zip("zw", rates, strict=False))
    parameters = tuple(Parameter(name, name, "1") for name in ("a", "b", "r"))
    effect = Effect("one", term, parameters, "One.", "none", acts_on=acts_on, states=states)
    formulas = effect.expressions()
    return state_methods(formulas, list(formulas.rates), [symbol(one.symbol) for one in states], [])


def test_a_state_that_follows_without_a_feedback_is_a_lag():
    (found,) = methods("theta + z", "b*theta - r*z", acts_on="sensor")
    assert (found.kind, found.of) == ("LAG", 0)
    assert found.coefficients == (symbol("r"), 0, symbol("b"))
    (found,) = methods("theta + z", "sin(theta) - r*z", acts_on="sensor")
    assert found.coefficients == (symbol("r"), 0, 0)  # no constant gain


@pytest.mark.parametrize(
    ("term", "rate", "acts_on"),
    [
        ("-a*z", "b*theta - r*z", "torque"),  # what it does comes back to it
        ("theta + z", "b*theta - r*theta*z", "sensor"),  # its relaxation is no constant
        ("theta + z", "b*theta", "sensor"),  # it has none
        ("theta + z", "b*theta - r*z**2", "sensor"),
    ],
)
def test_any_other_state_is_collocated(term, rate, acts_on):
    assert methods(term, rate, acts_on=acts_on) == [StateMethod("COLLOCATED", 0)]


def test_a_state_that_moves_with_the_angle_alone_is_independent_of_the_rate():
    (found,) = methods("-a*z", "(b - r*z)*thetadot")
    assert (found.kind, found.of) == ("RATE_INDEPENDENT", 0)
    assert found.coefficients == (symbol("r"), symbol("b"), 0)
    assert methods("-a*z", "(b - r*z**2)*thetadot")[0].kind == "COLLOCATED"
    assert methods("-a*z", "(b*theta - r*z)*thetadot")[0].kind == "COLLOCATED"
    assert methods("-a*z", "b*thetadot")[0].kind == "COLLOCATED"  # nothing relaxes


def test_a_state_whose_rate_is_another_one_is_its_integral():
    of_position, moving = methods("-a*(z + w)", "w", "b*theta - r*w")
    assert (of_position.kind, of_position.of) == ("INTEGRATED", 1) and moving.kind == "COLLOCATED"
    read, _ = methods("theta + z", "w", "b*theta - r*w", acts_on="sensor")
    assert read.kind == "COLLOCATED"  # what is read has to be known at each sample


def test_a_state_in_the_rate_of_another_is_no_lag():
    first, second = methods("theta + z", "w*b - r*z", "a*theta - r*w", acts_on="sensor")
    assert first.kind == "COLLOCATED" and second.kind == "COLLOCATED"
