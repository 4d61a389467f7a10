"""A study's own effects: formulas in the settings become part of the catalogue, and nothing else of them ever runs."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from swingdown.discovery.data.campaign import Swing, campaign
from swingdown.discovery.search import discover
from swingdown.errors import InputError
from swingdown.pendulum.catalogue import SHIPPED, catalogue
from swingdown.pendulum.model import Model, models

COGGING = {
    "torque": "-k*sin(5*theta + phi)",
    "parameters": {
        "k": {"unit": "rad/s^2", "typical": 0.2},
        "phi": {"unit": "rad", "start": [0.0, 0.8, 1.6, 2.4]},
    },
}


def cogged(k, phi):
    """Swings (times, angles) of a viscous pendulum with a cogging torque, with noise of 1 mrad."""
    times, rng = np.arange(1001) / 100, np.random.default_rng(3)
    for number, release in enumerate((0.3, -0.5, 0.7, 0.9)):

        def motion(t, state):
            angle, velocity = state
            return velocity, -(7.0**2) * np.sin(angle) - 0.14 * velocity - k * np.sin(5 * angle + phi)

        found = solve_ivp(motion, (0, times[-1]), (release, 0.0), "DOP853", times, rtol=1e-10, atol=1e-12).y[
            0
        ]
        yield Swing(f"swing {number}", times, found + 1e-3 * rng.standard_normal(times.size))


@pytest.mark.parametrize("symbol", ["k", "range"])
def test_an_own_effect_is_found_like_one_of_the_catalogue(symbol):
    """Whatever its parameters are called: those of the free forms that are given and not fitted are known by their role."""
    parameters = {symbol: COGGING["parameters"]["k"], "phi": COGGING["parameters"]["phi"]}
    own = {"five_teeth": {"torque": f"-{symbol}*sin(5*theta + phi)", "parameters": parameters}}
    states = discover(
        campaign("cogged", list(cogged(0.15, 0.6))),
        Model("viscous", catalogue=catalogue(own)),
        rounds=2,
        allowed=("five_teeth", "quadratic_drag", "constant_torque"),
    )
    assert states[-1].found == ("five_teeth",)
    assert not states[-1].missing
    assert states[-1].fit.model.values[f"five_teeth_{symbol}"] == pytest.approx(0.15, abs=0.01)
    assert states[-1].fit.model.values["five_teeth_phi"] == pytest.approx(0.6, abs=0.1)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"torque": "__import__('os').system('true')"}, "not allowed"),
        ({"torque": "-k*sin(5*theta + phi + psi)"}, "psi"),
        ({"torque": "-k*sin(5*theta)"}, "does not use it"),
        ({"parameters": {"k": {"start": [0.1]}, "phi": {"start": [0.0]}}}, "linear"),
        ({"parameters": {"k": {}, "phi": {}}}, "start"),
        ({"parameters": {"k": {"lower": 1.0, "upper": 0.0}, "phi": {"start": [0.0]}}}, "between"),
        ({"parameters": {"theta": {}, "phi": {"start": [0.0]}}}, "'theta' is a variable of every formula"),
        ({"parameters": {"1k": {}, "phi": {"start": [0.0]}}}, "'1k' is no symbol"),
        (
            {"parameters": {"k": {"lower": 1.0, "upper": 1.0}, "phi": {"start": [0.0]}}},
            "leave nothing between",
        ),
        (
            {"parameters": {"k": {}, "phi": {"lower": 1.0, "start": [1.0, 0.9]}}},
            "start: 0.9 is outside the bounds",
        ),
        (
            {"parameters": {"k": {}, "phi": {"upper": 1.0, "start": [1.0, 1.1]}}},
            "start: 1.1 is outside the bounds",
        ),
    ],
)
def test_what_cannot_be_an_effect_is_refused(changes, words):
    with pytest.raises(InputError, match=words):
        catalogue({"five_teeth": COGGING | changes})


@pytest.mark.parametrize(
    ("stated", "typical"),
    [({"start": [-0.3, 2.0]}, 0.3), ({"start": [0.0, 2.0]}, 1.0), ({"start": [2.0], "typical": 0.5}, 0.5)],
)
def test_a_typical_size_that_is_not_stated_is_that_of_the_first_start(stated, typical):
    """Searches set out with steps of that size; of none they would not move."""
    parameters = {"k": {"unit": "rad/s^2"}, "phi": {"unit": "rad"} | stated}
    own = catalogue({"five_teeth": {"torque": COGGING["torque"], "parameters": parameters}})
    sizes = {one.symbol: one.typical for one in own["five_teeth"].parameters}
    assert sizes == {"k": 1.0, "phi": typical}


@pytest.mark.parametrize("name", ["viscous", "torque_input", "gravity", "gravity_linear"])
def test_the_catalogues_names_are_taken(name):
    with pytest.raises(InputError, match="catalogue has an effect"):
        catalogue({name: COGGING})


def test_the_names_of_the_catalogues_parameters_are_taken():
    """Files go by a parameter's name alone."""
    brake = {
        "torque": "-b*exp(-(theta/width)**2)*thetadot",
        "parameters": {"b": {}, "width": {"start": [0.1]}},
    }
    assert "eddy_width" in SHIPPED.parameters
    with pytest.raises(InputError, match="a parameter 'eddy_width'"):
        catalogue({"eddy": brake})


def test_one_studys_effects_are_no_other_ones():
    own = catalogue({"five_teeth": COGGING})
    assert own.names == (*SHIPPED.names, "five_teeth")
    assert own is catalogue({"five_teeth": COGGING}), "the same settings, the same compiled engine"
    assert "five_teeth" not in SHIPPED and "five_teeth" not in catalogue({})
    with pytest.raises(InputError, match="no such effect"):
        models(["viscous+five_teeth"])


@pytest.mark.parametrize(
    ("entry", "words"),
    [
        ({"lower": "0"}, "parameters.k.lower: '0' is text"),
        ({"unit": 1}, "parameters.k.unit: 1 does not fit"),
        ({"start": 0.1}, "parameters.k.start: 0.1 does not fit"),
        ({"low": 0}, "parameters.k.low: unknown key.*write 'lower'"),
        ({"upper": float("nan")}, "parameters.k.upper: nan is not a finite number"),
    ],
)
def test_what_a_notebook_states_is_held_to_the_settings_rules(entry, words):
    parameters = {"k": entry, "phi": {"start": [0.0]}}
    with pytest.raises(InputError, match=words):
        catalogue({"five_teeth": COGGING | {"parameters": parameters}})


def test_numbers_and_arrays_of_numpy_are_numbers():
    parameters = {"k": {"lower": np.int64(0), "typical": np.float32(0.5)}, "phi": {"start": np.array([0, 1])}}
    own = catalogue({"five_teeth": COGGING | {"parameters": parameters}})["five_teeth"]
    assert own.size.lower == 0.0 and own.size.typical == 0.5 and own.parameters[1].starts == (0.0, 1.0)
