"""How sure a verdict is of each effect: on swings that the second pendulum makes."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from swingdown.discovery.campaign import Noise, Swing, campaign
from swingdown.discovery.files import summary
from swingdown.discovery.posterior import Structure, probabilities, structures, weights
from swingdown.discovery.rounds import look
from swingdown.discovery.search import discover
from swingdown.discovery.verdict import verdict
from swingdown.fitting.least_squares import fit_jointly
from swingdown.pendulum.model import Model
from swingdown.trials.reliability import reliability
from swingdown.trials.second_pendulum import trajectory

TIMES = np.arange(0, 12, 0.02)  # s
NOISE = Noise(1e-3)  # rad
VALUES = {"natural_frequency": 7.0, "viscous_ratio": 0.008}


def swings(releases, seed=1, times=TIMES, **values):
    """A campaign with a spring that stiffens with the square of the angle."""
    rng, effects = np.random.default_rng(seed), ("viscous", "cubic_stiffness")
    made = []
    for angle in releases:
        reading = trajectory(effects, VALUES | values, times, angle).reading
        made.append(Swing(f"{angle}", times, reading + NOISE.deviation * rng.standard_normal(times.size)))
    return campaign("springs", made)


@pytest.fixture(scope="module")
def tied():
    """Small swings, on which two springs cannot be told apart, and the fits with either."""
    one = swings((0.3, -0.25, 0.2), cubic_stiffness=1.5)
    return one, [
        fit_jointly(Model(f"viscous+{name}"), [swing.pair for swing in one.fit], bounded=True)
        for name in ("cubic_stiffness", "quadratic_stiffness")
    ]


def test_a_plain_case_is_sure_and_a_tie_is_shared_out(tied):
    one, fits = tied
    base = fit_jointly(Model("viscous"), [swing.pair for swing in one.fit], bounded=True)
    found = [Structure(frozenset(fit.model.names), fit) for fit in (base, *fits)]
    shares = weights(found, ("viscous",), one, NOISE)
    assert sum(shares) == pytest.approx(1)
    assert shares[0] < 0.01  # without a spring
    assert 0.05 < shares[1] < 0.95  # which spring it is
    told = probabilities(zip(shares, found, strict=True), ("viscous",))
    assert set(told) == {"cubic_stiffness", "quadratic_stiffness"}
    assert sum(told.values()) == pytest.approx(1, abs=0.01)


def test_one_structure_counts_once_and_a_refused_one_not_at_all():
    one = swings((0.9, -0.7, 0.5), cubic_stiffness=1.5)
    fit = fit_jointly(Model("viscous"), [swing.pair for swing in one.fit], bounded=True)
    state = look(0, one, fit, (), ("cubic_stiffness", "quadratic_stiffness", "load_coulomb"))
    found = structures([state, state])
    assert len({one.names for one in found}) == len(found) > 2
    assert frozenset(("viscous", "quadratic_stiffness")) in {one.names for one in found}
    refused = [replace(one, refused="at a bound" if one.added == "quadratic_stiffness" else "") for one in state.ranked]  # fmt: skip
    left = structures([replace(state, ranked=tuple(refused))])
    assert frozenset(("viscous", "quadratic_stiffness")) not in {one.names for one in left}
    assert frozenset(("viscous", "cubic_stiffness")) in {one.names for one in left}


def test_a_verdict_tells_how_sure_it_is_of_each_effect():
    one = swings((0.9, -0.7, 0.5, 0.3), cubic_stiffness=1.5)
    states = discover(one, "viscous", allowed=("cubic_stiffness", "quadratic_stiffness", "constant_torque"))
    found = verdict([summary(state, one) for state in states])
    (spring,) = found["effects"]
    assert spring["name"] == "cubic_stiffness"
    assert spring["probability"] > 0.99
    assert found["probabilities"]["cubic_stiffness"] == spring["probability"]
    assert found["next_swing"] is None  # nothing is left to ask
    assert found["next_measurement"] is None


def test_the_reliability_table_counts_what_was_told_and_what_was_there():
    def trial(kind, hidden, **told):
        return {"kind": kind, "hidden": hidden}, {"verdict": {"probabilities": told}}

    table = reliability(
        [
            trial("single", ("viscous",), viscous=0.95, stribeck=0.05),
            trial("single", ("viscous",), stribeck=0.95, viscous=0.04),
            trial("null", ()),
            trial("removed", ("viscous",), stribeck=1.0, viscous=0.001),
        ]
    )
    assert isinstance(table, pd.DataFrame)
    known = table[table["hidden"] == "one in the catalogue"].set_index("from")
    assert known.loc[0.9, ["n", "there"]].tolist() == [2, 0.5]
    assert known.loc[0.01, ["n", "there"]].tolist() == [2, 0.5]
    assert known.loc[0.9, "told"] == pytest.approx(0.95)
    lacking = table[table["hidden"] == "one that it lacks"]
    assert lacking[["from", "n", "there"]].to_numpy().tolist() == [[0.99, 1, 0.0]]
