"""The catalogue: every term has the units it claims, and an entry is all that an effect needs."""

from dataclasses import replace

import numpy as np
import pint
import pytest
import sympy
from scipy.integrate import solve_ivp

from swingdown.engine import compiler
from swingdown.engine.trajectory import simulate
from swingdown.errors import InputError
from swingdown.pendulum import formula
from swingdown.pendulum.catalogue import SHIPPED, Catalogue
from swingdown.pendulum.effect import TERM_UNITS, VARIABLES, Effect, Parameter, State
from swingdown.pendulum.model import Model
from swingdown.pendulum.own import own_effects
from swingdown_trials.torques import KNOWN

UNITS = pint.UnitRegistry()
ALL = [*SHIPPED.gravity.values(), *SHIPPED]
NAMED = {"ids": lambda effect: effect.name}


class Inconsistent(ValueError):
    """A formula whose units do not fit together."""


def units_of(expression, known):
    """The units of a sympy expression as a pint quantity; ``known`` gives those of each symbol."""
    if expression.is_number:
        return UNITS.Quantity(1.0)
    if expression.is_Symbol:
        return UNITS.Quantity(1.0, known[expression.name])
    parts = [units_of(part, known) for part in expression.args]
    if expression.is_Add:
        if any(part.dimensionality != parts[0].dimensionality for part in parts):
            raise Inconsistent(f"{expression} adds {', '.join(str(part.dimensionality) for part in parts)}")
        return parts[0]
    if expression.is_Mul:
        return _product(parts)
    if expression.is_Pow and expression.exp.is_number:
        return parts[0] ** float(expression.exp)
    if isinstance(expression, sympy.Abs):
        return parts[0]
    if isinstance(expression, sympy.sign):
        return UNITS.Quantity(1.0)
    if not all(
        part.dimensionless for part in parts
    ):  # sin, exp, ... and powers with an exponent of one's own
        raise Inconsistent(f"{expression} of something with a unit")
    return UNITS.Quantity(1.0)


def _product(parts):
    result = UNITS.Quantity(1.0)
    for part in parts:
        result = result * part
    return result


def assert_units(effect, form="consistent"):
    """Raise Inconsistent unless every formula of the effect has the unit of what it acts on."""
    known = dict(VARIABLES) | {"thetaddot": "1/s**2"}
    known |= {p.symbol: p.unit for p in effect.parameters} | {
        state.symbol: state.unit for state in effect.states
    }
    formulas = effect.expressions(form)
    second = UNITS.Quantity(1.0, "s")
    wanted = [
        (expression, "1/s**2" if kind == "torque" else "1") for kind, expression in formulas.motion.items()
    ]
    wanted += [
        (rate, UNITS.Quantity(1.0, state.unit) / second)
        for state, rate in zip(effect.states, formulas.rates, strict=True)
    ]
    wanted += [(first, state.unit) for state, first in zip(effect.states, formulas.initial, strict=True)]
    if formulas.reading is not None:
        wanted.append((formulas.reading, TERM_UNITS[effect.acts_on]))
    if effect.acts_on == "play":
        wanted.append((formula.parse(effect.term, known), TERM_UNITS["play"]))
    for expression, unit in wanted:
        if expression == 0:
            continue
        unit = unit if isinstance(unit, UNITS.Quantity) else UNITS.Quantity(1.0, unit)
        found = units_of(expression, known)
        if found.dimensionality != unit.dimensionality:
            raise Inconsistent(
                f"{effect.name}: {expression} is in {found.dimensionality}, not {unit.dimensionality}"
            )


@pytest.mark.parametrize("effect", [e for e in ALL if e.name != "power_law_drag"], **NAMED)
def test_units_are_consistent(effect):
    assert_units(effect)


def test_units_of_a_free_exponent():
    """A power of its own takes the velocity in units of 1 rad/s, as its coefficient's text says; all else fits."""
    drag = SHIPPED["power_law_drag"]
    with pytest.raises(Inconsistent):
        assert_units(drag)
    assert "at 1 rad/s" in drag.parameters[0].text
    assert_units(
        replace(
            drag,
            term="-d*abs(thetadot/one)**n*sign(thetadot)",
            parameters=(*drag.parameters, Parameter("one", "one", "rad/s")),
        )
    )


def test_the_printed_coulomb_term_is_not_consistent():
    """The paper adds a squared velocity to a cosine; that is why the consistent form is the default."""
    with pytest.raises(Inconsistent, match="adds"):
        assert_units(SHIPPED["load_coulomb"], form="printed")
    assert_units(SHIPPED["load_coulomb"])
    assert [effect.name for effect in ALL if effect.printed] == ["load_coulomb"]


@pytest.mark.parametrize("effect", [e for e in SHIPPED if e.name != "power_law_drag"], **NAMED)
def test_a_wrong_unit_would_be_seen(effect):
    """For each parameter and each state in turn: one more second in its unit and the test above fails."""
    for k, parameter in enumerate(effect.parameters):
        wrong = list(effect.parameters)
        wrong[k] = parameter._replace(unit=f"({parameter.unit})*s")
        with pytest.raises(Inconsistent):
            assert_units(replace(effect, parameters=tuple(wrong)))
    for k, state in enumerate(effect.states):
        wrong = list(effect.states)
        wrong[k] = state._replace(unit=f"({state.unit})*s")
        with pytest.raises(Inconsistent):
            assert_units(replace(effect, states=tuple(wrong)))


def test_names_and_bounds():
    names = [parameter.name for effect in SHIPPED for parameter in effect.parameters]
    assert len(set(names)) == len(names), "a parameter file goes by name alone"
    assert "natural_frequency" not in names
    for effect in SHIPPED:
        assert effect.explanation.endswith(".") and effect.reference
        assert effect.acts_on in TERM_UNITS
        symbols = [parameter.symbol for parameter in effect.parameters] + [
            state.symbol for state in effect.states
        ]
        assert len({*symbols, *VARIABLES}) == len(symbols) + len(VARIABLES)
        for parameter in effect.parameters:
            assert parameter.lower < parameter.upper
            assert parameter.lower <= parameter.typical <= parameter.upper
            if parameter.lower < 0:  # what may have either sign may be as large to either side
                assert parameter.lower == -parameter.upper
            if parameter.role == "phase":  # a fit may go once round, either way
                assert (parameter.lower, parameter.upper) == pytest.approx((-2 * np.pi, 2 * np.pi))
            UNITS.parse_units(parameter.unit)


def test_the_experimenters_effects_are_there():
    """The list that experimenters would expect, each under its name."""
    expected = {
        "viscous", "quadratic_drag", "constant_coulomb", "load_coulomb", "stribeck", "presliding", "power_law_drag",
        "structural_damping", "added_mass", "eddy_brake", "constant_torque", "torsion_spring", "quadratic_stiffness", "cubic_stiffness", "detent",
        "flexible_pivot", "base_vibration", "damping_drift", "steady_wind", "finite_amplitude", "sensor_zero", "sensor_gain", "sensor_curvature",
        "eccentricity", "sensor_lag", "clock_drift", "backlash",
    }  # fmt: skip
    assert expected <= set(SHIPPED.names)


def test_an_unknown_effect_is_told_with_the_known_ones():
    with pytest.raises(InputError, match="viscous, quadratic_drag, load_coulomb"):
        SHIPPED["viscosity"]


def test_an_effect_is_one_entry(monkeypatch, tmp_path):
    """A new torque with a state and a kink of its own needs its formulas and nothing else."""
    mine = Effect(
        "stopper",
        "-k_s*(theta - a_s + abs(theta - a_s))/2 - g_s*w_f",
        (Parameter("stop_stiffness", "k_s", "1/s^2"), Parameter("stop_angle", "a_s", "rad"), Parameter("stop_follow", "g_s", "1/s"),
         Parameter("stop_rate", "r_s", "1/s")),  # fmt: skip
        "A soft stop on one side, and a follower.",
        "none",
        states=(State("w_f", "1/s", "0", "r_s*(thetadot - w_f)"),),
    )  # fmt: skip
    few = Catalogue((SHIPPED["viscous"], mine))  # to compile soon
    monkeypatch.setenv("SWINGDOWN_CACHE", str(tmp_path))
    monkeypatch.setattr(compiler, "FLAGS", ("-O0", *compiler.FLAGS[1:]))  # half as long
    assert_units(mine)
    values = {
        "natural_frequency": 6.0,
        "viscous_ratio": 0.02,
        "stop_stiffness": 60.0,
        "stop_angle": 0.3,
        "stop_follow": 0.5,
        "stop_rate": 4.0,
    }
    times = np.linspace(0, 4, 101)
    read = simulate(Model("viscous+stopper", values, catalogue=few), times, 0.6)

    def moving(t, y):
        stop = -60.0 * max(y[0] - 0.3, 0.0)
        return [y[1], -36 * np.sin(y[0]) - 2 * 0.02 * 6 * y[1] + stop - 0.5 * y[2], 4.0 * (y[1] - y[2])]

    expected = solve_ivp(
        moving, (0, 4), [0.6, 0.0, 0.0], method="DOP853", rtol=1e-12, atol=1e-14, t_eval=times, max_step=4e-3
    ).y[0]
    assert np.abs(read - expected).max() < 1e-8


def test_states_may_follow_from_one_another(monkeypatch, tmp_path):
    """A state that is the integral of an integral: the distance of a mass whose velocity follows the pendulum's."""
    mine = Effect(
        "trailer",
        "-k_f*(x_f + w_f)",
        (Parameter("trail_stiffness", "k_f", "1/s^2"), Parameter("trail_rate", "r_f", "1/s")),
        "A mass drags behind, and pulls back by how far it has come, and by how far on average.",
        "none",
        states=(
            State("x_f", "rad", "0.1", "w_f"),
            State("w_f", "rad", "0", "v_f"),
            State("v_f", "rad", "0", "r_f*(theta - v_f)"),
        ),
    )
    monkeypatch.setenv("SWINGDOWN_CACHE", str(tmp_path))
    monkeypatch.setattr(compiler, "FLAGS", ("-O0", *compiler.FLAGS[1:]))  # half as long
    values = {"natural_frequency": 6.0, "trail_stiffness": 2.0, "trail_rate": 3.0}
    times = np.linspace(0, 4, 101)
    read = simulate(Model("trailer", values, catalogue=Catalogue((mine,))), times, 0.6)

    def moving(t, y):
        return [y[1], -36 * np.sin(y[0]) - 2.0 * (y[2] + y[3]), y[3], y[4], 3.0 * (y[0] - y[4])]

    start = [0.6, 0.0, 0.1, 0.0, 0.0]
    expected = solve_ivp(moving, (0, 4), start, method="DOP853", rtol=1e-12, atol=1e-14, t_eval=times).y[0]
    assert np.abs(read - expected).max() < 1e-8


def test_a_catalogue_never_changes():
    wider = SHIPPED.with_effects(
        Effect("own", "-k_o*theta", (Parameter("own_k", "k_o", "1/s^2"),), "A.", "none")
    )
    assert "own" in wider.names and "own" not in SHIPPED
    assert SHIPPED.without("viscous").names == SHIPPED.names[1:]
    with pytest.raises(TypeError):
        SHIPPED.parameters["own_k"] = None


@pytest.mark.parametrize("effect", SHIPPED, **NAMED)
def test_what_an_entry_says_of_others_is_about_effects_that_there_are(effect):
    others = [
        *(one.name for one in effect.contains),
        *(one.name for one in effect.replaces),
        *effect.told_apart,
    ]
    assert set(others) <= set(SHIPPED.names) - {effect.name}
    own = {parameter.name for parameter in effect.parameters}
    assert set(effect.told) <= own
    assert all(set(one.at) <= own for one in effect.contains)
    for one in effect.replaces:
        known = {p.symbol: 1.5 for p in SHIPPED[one.name].parameters} | {"omega_n": 7.0}
        for values in one.values:
            assert set(values) == own
            assert all(np.isfinite(formula.evaluate(text, **known)) for text in values.values())


def torque(effect, **values):
    """The torque (rad/s^2) of an effect without states over a grid of angles and velocities, within a fraction of a radian."""
    theta, velocity = np.meshgrid(np.linspace(-0.05, 0.05, 21), np.linspace(-0.4, 0.4, 20))
    known = {p.symbol: values.get(p.name, 1.0) for p in effect.parameters}
    at = {"theta": theta, "thetadot": velocity, "t": 0.0, "duration": 1.0, "omega_n": 7.0}
    return np.ravel(formula.evaluate(effect.term, **at, **known) * np.ones_like(theta))


@pytest.mark.parametrize("effect", [e for e in SHIPPED if e.contains and not e.states], **NAMED)
def test_a_richer_effect_is_the_simpler_one_where_its_entry_says(effect):
    """Of a cubic spring to the linear one that the natural frequency takes up; limits are taken near enough."""
    for one in effect.contains:
        near = {name: float(np.clip(value, 1e-9, 1e9)) for name, value in one.at.items()}
        columns = [torque(SHIPPED[one.name])]
        if effect.acts_on == "sensor":
            columns.append(torque(SHIPPED["sensor_gain"], sensor_gain=0.0))
        if one.name == "cubic_stiffness":
            columns.append(torque(SHIPPED["torsion_spring"]))
        found = torque(effect, **near)
        if effect.name == "steady_wind":
            found = found - found.mean()  # the storm's steady push
        left = found - np.column_stack(columns) @ np.linalg.lstsq(np.column_stack(columns), found)[0]
        assert np.linalg.norm(left) < 0.05 * np.linalg.norm(found), one


def test_the_second_pendulum_knows_every_effect():
    """An effect that trials cannot hide has no measured score: whoever adds one adds its twin."""
    assert set(SHIPPED.names) <= KNOWN | {effect.name for effect in SHIPPED if effect.twin}


@pytest.mark.parametrize("effect", SHIPPED, **NAMED)
def test_a_typical_value_is_one_that_the_effect_may_have_and_that_trials_draw(effect):
    """A search measures its steps by it."""
    for one in effect.parameters:
        assert one.lower <= one.typical <= min(one.upper, one.largest), one.name
        ranges = [part for part in one.drawn if isinstance(part, tuple)] or [one.drawn]
        pairs = [part for part in ranges if len(part) == 2]
        assert not pairs or any(low <= one.typical <= high for low, high in pairs), one.name


def test_a_friction_is_what_is_left_at_no_speed():
    """Whatever its formula: structural damping is left where a swing turns, and nothing of it at the middle; a memory has what it becomes."""
    own = own_effects(
        {
            "felt": {
                "torque": "-c*(1 + 0.3*cos(theta))*sign(thetadot)",
                "parameters": {"c": {"unit": "rad/s^2"}},
            },
            "comb": {"torque": "-c*sin(theta)/theta", "parameters": {"c": {"unit": "rad/s^2"}}},
        }
    )
    known = SHIPPED.with_effects(*own)
    assert [name for name in known.names if known.rubs(name)] == [
        "load_coulomb", "constant_coulomb", "stribeck", "presliding", "felt",
    ]  # fmt: skip


def test_a_shape_that_trials_draw_from_a_list_is_one_that_a_search_starts_from():
    """Between whole teeth a fit finds no way: the number of them that is not tried is not found."""
    listed = [one for one in SHIPPED.parameters.values() if one.drawn and len(one.drawn) > 2]
    assert listed
    for one in listed:
        assert set(one.drawn) <= set(one.starts) and list(one.starts) == sorted({*one.starts})
        assert list(one.drawn) == sorted({*one.drawn})
