"""A study's own effects: formulas in the settings become part of the catalogue, and nothing else of them ever runs."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from swingdown.discovery.campaign import Swing, campaign
from swingdown.discovery.rounds import discover
from swingdown.errors import InputError
from swingdown.pendulum import catalogue as effects
from swingdown.pendulum import own as own_effects

COGGING = {
    "torque": "-k*sin(5*theta + phi)",
    "parameters": {
        "k": {"unit": "rad/s^2", "typical": 0.2},
        "phi": {"unit": "rad", "start": [0.0, 0.8, 1.6, 2.4]},
    },
}


@pytest.fixture(autouse=True)
def catalogue_as_it_was():
    yield
    own_effects.use({})


def test_an_own_effect_is_found_like_one_of_the_catalogue():
    own_effects.use({"five_teeth": COGGING})
    times, rng, swings = np.arange(1001) / 100, np.random.default_rng(3), []
    for k, release in enumerate((0.3, -0.5, 0.7, 0.9)):

        def motion(t, state):
            angle, velocity = state
            return velocity, -(7.0**2) * np.sin(angle) - 0.14 * velocity - 0.15 * np.sin(5 * angle + 0.6)

        angle = solve_ivp(motion, (0, times[-1]), (release, 0.0), "DOP853", times, rtol=1e-10, atol=1e-12).y[
            0
        ]
        swings.append(Swing(f"swing {k}", times, angle + 1e-3 * rng.standard_normal(times.size)))
    states = discover(
        campaign("cogged", swings),
        "viscous",
        rounds=2,
        allowed=("five_teeth", "quadratic_drag", "constant_torque"),
    )
    assert states[-1].found == ("five_teeth",)
    assert not states[-1].missing
    assert states[-1].fit.model.values["five_teeth_k"] == pytest.approx(0.15, abs=0.01)
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
        ({"parameters": {"theta": {}, "phi": {"start": [0.0]}}}, "variable"),
    ],
)
def test_what_cannot_be_an_effect_is_refused(changes, words):
    with pytest.raises(InputError, match=words):
        own_effects.use({"five_teeth": COGGING | changes})
    assert "five_teeth" not in effects.known()


def test_the_catalogues_names_are_taken():
    with pytest.raises(InputError, match="catalogue has"):
        own_effects.use({"viscous": COGGING})
