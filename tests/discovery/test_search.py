"""A search where the first choice does not do: pairs, exchanges, shapes that say nothing, swings left out, and its end."""

from dataclasses import replace

import numpy as np
import pytest

from swingdown.discovery.admissible import inadmissible
from swingdown.discovery.budget import Budget
from swingdown.discovery.campaign import Noise, Swing, campaign
from swingdown.discovery.differences import coarse_noise
from swingdown.discovery.established import Finding, established, unneeded
from swingdown.discovery.folds import Turns, folds, in_turn
from swingdown.discovery.linear import frame
from swingdown.discovery.pairs import starts_of_pairs
from swingdown.discovery.rounds import first_fit, look
from swingdown.discovery.search import discover
from swingdown.engine.trajectory import simulate
from swingdown.pendulum.catalogue import SHIPPED
from swingdown.pendulum.model import Model

TIMES = np.arange(601) / 50  # s
NOISE = 1e-3  # rad
FREQUENCY = 7.0  # rad/s


def swings(label, seed=3, releases=(0.9, -0.7, 0.5, 0.3), **values):
    """Swings of a pendulum with these effects, with white noise."""
    model, draws = Model(label, {"natural_frequency": FREQUENCY} | values), np.random.default_rng(seed)
    return [
        Swing(
            f"swing {k}",
            TIMES,
            simulate(model, TIMES, release) + NOISE * draws.standard_normal(TIMES.size),
        )
        for k, release in enumerate(releases)
    ]


@pytest.fixture(scope="module")
def two():
    """Quadratic drag and a softening spring beside the base's viscous term."""
    hidden = "viscous+quadratic_drag+quadratic_stiffness"
    return campaign("two", swings(hidden, viscous_ratio=0.006, quadratic_coefficient=0.004, quadratic_stiffness=-0.8))  # fmt: skip


def test_two_effects_without_a_shape_are_named_before_one_with_a_shape(two):
    allowed = ("quadratic_drag", "quadratic_stiffness", "constant_torque", "presliding", "detent")
    states = discover(two, "viscous", rounds=3, allowed=allowed)
    assert set(states[-1].found) == {"quadratic_drag", "quadratic_stiffness"}
    assert not states[-1].missing
    assert states[-1].fit.model.values["quadratic_stiffness"] == pytest.approx(-0.8, rel=0.05)


def test_the_pair_that_is_there_promises_most(two):
    fit = first_fit(two, Model("viscous"))
    here = frame(fit, two.fit)
    excess = fit.rss - fit.n * NOISE**2
    best, *_ = starts_of_pairs(here, least=0.9 * excess)
    assert {best[0].added, *best[0].also} == {"quadratic_drag", "quadratic_stiffness"}
    assert best[0].move.startswith("add ")
    begun = best[0].begin.swings[0].values
    assert begun["quadratic_coefficient"] >= 0 > begun["quadratic_stiffness"]
    assert starts_of_pairs(here, allowed=("constant_torque", "clock_drift"), least=0.9 * excess) == []


def test_an_effect_that_leaves_nothing_of_the_model_s_own_is_an_exchange():
    one = campaign(
        "exchange", swings("viscous+constant_coulomb", viscous_ratio=0.004, constant_friction=0.15)
    )
    states = discover(
        one, "viscous+load_coulomb", rounds=3, allowed=("constant_coulomb", "structural_damping")
    )
    assert states[-1].fit.model.label == "viscous+constant_coulomb"
    assert states[-1].found == ("constant_coulomb",)


def test_a_search_without_time_looks_and_says_that_it_stopped(two):
    states = discover(two, "viscous", rounds=3, budget_s=1e-9)
    assert [state.spent for state in states] == [True]
    assert states[0].missing
    assert states[0].reason == "the search's time is spent"
    assert discover(two, "viscous", rounds=0)[-1].spent is False


def test_each_swing_is_left_out_once_and_what_is_not_there_is_not_missed(two):
    assert sorted(k for part in folds(two) for k in part) == [0, 1, 2, 3]
    true = first_fit(two, Model("viscous+quadratic_drag+quadratic_stiffness"))
    short = first_fit(two, Model("viscous+quadratic_drag"))
    long = first_fit(two, Model("viscous+quadratic_drag+quadratic_stiffness+clock_drift"))
    turns = [in_turn(one, two) for one in (true, short, long)]
    assert turns[0].left == pytest.approx([NOISE] * 4, rel=0.1)
    assert turns[0].gain(turns[1]) > 0.3
    assert turns[0].better(turns[1]) == 1
    assert abs(turns[0].gain(turns[2])) < 0.02
    error = true.model.standard_errors["quadratic_stiffness"]
    assert 0.3 * error < turns[0].spread("quadratic_stiffness") < 3 * error


def test_what_swings_left_out_miss_is_established_and_what_they_do_not_is_not(two):
    model = Model("viscous+quadratic_drag+quadratic_stiffness+clock_drift")
    found = ("quadratic_drag", "quadratic_stiffness", "clock_drift")
    state = look(1, two, first_fit(two, model), found, last=True)
    allowed = (*found, "structural_damping", "cubic_stiffness")
    sure = established(state, two, allowed, Budget())
    assert sure["quadratic_drag"].sure and sure["quadratic_stiffness"].sure
    assert sure["quadratic_drag"].errors["quadratic_coefficient"] > 0
    assert (
        "clock_drift" in sure["clock_drift"].doubt
    )  # is as far from nothing as it differs, or is not determined
    idle = unneeded(state, two)
    assert idle.dropped == "clock_drift"
    unasked = established(state, two, allowed, Budget(1e-9))
    assert not any(one.sure for one in unasked.values())


def test_a_tie_is_told_of_effects_that_a_known_measurement_tells_apart_and_a_doubt_of_others():
    sure = Finding("")
    tied = sure.beside(["structural_damping"], "viscous", SHIPPED)
    assert tied.sure and tied.ties == ("structural_damping",)
    assert "structural_damping does as well" in tied.alone.doubt
    assert "stribeck does as well" in sure.beside(["stribeck"], "viscous", SHIPPED).doubt
    assert sure.beside([], "viscous", SHIPPED) == sure
    assert "not held against" in sure.beside(None, "viscous", SHIPPED).doubt


def test_the_jackknife_is_the_standard_error_of_a_mean():
    draws = np.random.default_rng(1).standard_normal(5)
    without = [{"x": float(np.delete(draws, k).mean())} for k in range(5)]
    turns = Turns(np.ones(5), tuple(without))
    assert turns.spread("x") == pytest.approx(draws.std(ddof=1) / np.sqrt(5))


def fitted_with(name, **values):
    """A fit whose model has an effect at these values, its standard errors as given under ``errors``."""
    errors = values.pop("errors", {})
    one = campaign("shape", swings("viscous", releases=(0.6, 0.4), viscous_ratio=0.006))
    fit = first_fit(one, Model("viscous"))
    model = fit.model.with_effects(("viscous", name), fit.model.values | values)
    model = model.with_values(model.values, errors)
    return replace(fit, model=model, swings=tuple(replace(s, model=model) for s in fit.swings))


def test_friction_that_winds_up_over_less_than_the_noise_is_constant_friction_where_something_is_left():
    fit = fitted_with("presliding", presliding_friction=0.2, presliding_angle=0.5e-3)
    assert "constant_coulomb is all that is seen" in inadmissible(fit, "presliding", Noise(0.8 * NOISE))
    assert inadmissible(fit, "presliding", Noise(NOISE)) == ""
    wide = fitted_with("presliding", presliding_friction=0.2, presliding_angle=5e-3)
    assert inadmissible(wide, "presliding", Noise(0.8 * NOISE)) == ""


@pytest.mark.parametrize(("error", "why"), [(0.07, "not determined"), (0.00001, "")])
def test_a_shape_that_the_data_do_not_determine_is_no_name(error, why):
    values = {"stribeck_friction": 0.2, "stribeck_velocity": 0.03}
    fit = fitted_with("stribeck", **values, errors={"stribeck_friction": 0.01, "stribeck_velocity": error})
    assert why in inadmissible(fit, "stribeck", Noise(NOISE))
    assert bool(why) == bool(inadmissible(fit, "stribeck", Noise(NOISE)))


def test_a_size_at_its_upper_bound_is_no_name():
    fit = fitted_with("sensor_gain", sensor_gain=0.5)
    assert "runs to its bound 0.5" in inadmissible(fit, "sensor_gain", Noise(NOISE))
    assert inadmissible(fitted_with("sensor_gain", sensor_gain=0.4), "sensor_gain", Noise(NOISE)) == ""


@pytest.mark.parametrize(("every", "told"), [(2, True), (1, False)])
def test_of_coarse_samples_neighbours_tell_the_noise(every, told):
    """18 samples a period have no band that is free of what a wrong model leaves; 36 have."""
    draws, times = np.random.default_rng(8), np.arange(0, 60, 0.025 * every)
    angle = 0.8 * np.sin(2 * np.pi / 0.9 * times) + NOISE * draws.standard_normal(times.size)
    far = Noise(20 * NOISE, 0.9)
    found = coarse_noise(far, [Swing("one", times, angle)], 1 / 0.9)
    if told:
        assert found.deviation == pytest.approx(NOISE, rel=0.1)
        assert found.correlation == 0
    else:
        assert found == far
