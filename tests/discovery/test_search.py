"""A search where the first choice does not do: pairs, exchanges, shapes that say nothing, swings left out, and its end."""

from dataclasses import replace
from itertools import count, pairwise
from types import SimpleNamespace

import numpy as np
import pytest

from swingdown.discovery import search
from swingdown.discovery.criterion import Criterion
from swingdown.discovery.data.campaign import Swing, campaign
from swingdown.discovery.data.noise import Noise, coarse_noise
from swingdown.discovery.judge.findings import Finding
from swingdown.discovery.move import refit as guarded
from swingdown.discovery.move.admissible import inadmissible
from swingdown.discovery.move.candidates import without
from swingdown.discovery.move.pairs import starts_of_pairs
from swingdown.discovery.move.refit import refit, with_effect
from swingdown.discovery.rounds import first_fit
from swingdown.discovery.search import discover
from swingdown.discovery.see.linear import frame
from swingdown.discovery.tell.conclusion import _Told, concluded
from swingdown.discovery.tell.files import summary, write_rounds
from swingdown.discovery.tell.verdict import verdict
from swingdown.engine.trajectory import TrajectoryError, simulate
from swingdown.errors import InputError
from swingdown.fitting.least_squares import fit_jointly
from swingdown.pendulum.model import Model
from swingdown.sealed import read_json

TIMES = np.arange(601) / 50  # s
NOISE = 1e-3  # rad
FREQUENCY = 7.0  # rad/s


def swings(label, seed=3, releases=(0.9, -0.7, 0.5, 0.3), **values):
    """Swings of a pendulum with these effects, with white noise."""
    model, draws = Model(label, {"natural_frequency": FREQUENCY} | values), np.random.default_rng(seed)
    return [
        Swing(
            f"swing {k}", TIMES, simulate(model, TIMES, release) + NOISE * draws.standard_normal(TIMES.size)
        )
        for k, release in enumerate(releases)
    ]


@pytest.fixture(scope="module")
def two():
    """Quadratic drag and a softening spring beside the base's viscous term."""
    hidden = "viscous+quadratic_drag+quadratic_stiffness"
    return campaign("two", swings(hidden, viscous_ratio=0.006, quadratic_coefficient=0.004, quadratic_stiffness=-0.8))  # fmt: skip


@pytest.fixture(scope="module")
def notches():
    """Four notches a turn, the fewest there are."""
    hidden = swings("viscous+detent", viscous_ratio=0.006, detent_torque=0.04, detent_order=4.0, detent_phase=-1.0, seed=0)  # fmt: skip
    return campaign("notches", hidden)


def test_a_shape_that_ends_where_a_search_may_begin_is_told(notches):
    """At its bound it has no standard error."""
    states = discover(notches, "viscous", allowed=("detent", "sensor_zero"))
    assert states[-1].found == ("detent",)
    assert states[-1].fit.model.values["detent_order"] == 4.0


def test_what_is_looked_at_to_tell_is_told_where_it_is_more_probable(notches, monkeypatch):
    real, values = search.told_of, {"detent_torque": 0.04, "detent_order": 4.0, "detent_phase": -1.0}
    assert discover(notches, "viscous", rounds=1, allowed=["constant_torque"])[-1].found == ()

    def told_of(pool, best):
        pool.look(refit(with_effect(pool.first.fit.begin, "detent", values), notches.fit, ended=True))
        return real(pool, best)

    monkeypatch.setattr(search, "told_of", told_of)
    assert discover(notches, "viscous", rounds=1, allowed=["constant_torque"])[-1].found == ("detent",)


def test_of_what_is_told_it_is_asked_what_else_would_do(two, monkeypatch):
    """What takes away too little is left out to tell the rest: another structure than the most probable one."""
    doubt, asked = search._Search._doubt, []

    def told_of(pool, best):
        fewer = pool.lacking(best, ["quadratic_drag"])[0]
        return fewer, {"quadratic_stiffness": Finding(1.0)}

    monkeypatch.setattr(search, "told_of", told_of)
    monkeypatch.setattr(search._Search, "_doubt", lambda of, last: asked.append(last.key) or doubt(of, last))
    discover(two, "viscous", rounds=3, allowed=("quadratic_drag", "quadratic_stiffness"))
    assert asked.count(frozenset({"viscous", "quadratic_stiffness"})) == 1


def test_two_effects_without_a_shape_are_named_before_one_with_a_shape(two):
    allowed = ("quadratic_drag", "quadratic_stiffness", "constant_torque", "presliding", "detent")
    states = discover(two, "viscous", rounds=3, allowed=allowed)
    assert set(states[-1].found) == {"quadratic_drag", "quadratic_stiffness"}
    assert not states[-1].missing
    assert states[-1].fit.model.values["quadratic_stiffness"] == pytest.approx(-0.8, rel=0.05)


def test_two_effects_are_named_though_something_unnamed_does_as_well_in_the_place_of_each_alone():
    hidden = "viscous+load_coulomb+stribeck+cubic_stiffness"
    one = campaign("two", swings(hidden, viscous_ratio=0.006, load_friction=0.002, stribeck_friction=0.06, stribeck_velocity=0.3, cubic_stiffness=0.05))  # fmt: skip
    allowed = ("quadratic_drag", "steady_wind", "stribeck", "presliding", "cubic_stiffness", "constant_torque", "detent")  # fmt: skip
    last = discover(one, "viscous+load_coulomb", rounds=3, allowed=allowed)[-1]
    assert set(last.found) == {"stribeck", "cubic_stiffness"} and not last.missing


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


def test_a_slow_machine_gives_the_same_verdict(two, monkeypatch):
    """What is spent is counted in the work of the fits: a clock that races ends nothing."""
    passed = count(step=1000)
    monkeypatch.setattr("time.process_time", lambda: float(next(passed)))
    allowed = ("quadratic_drag", "quadratic_stiffness")
    state = discover(two, "viscous", rounds=3, allowed=allowed, budget_s=100)[-1]
    assert set(state.found) == set(allowed)
    assert not state.spent


def test_an_effect_that_is_not_there_and_one_of_the_base_that_idles_are_not_in_the_model(two):
    allowed = ("quadratic_drag", "quadratic_stiffness", "clock_drift")
    states = discover(two, "viscous+structural_damping", rounds=3, allowed=allowed)
    assert states[-1].fit.model.names == ("viscous", "quadratic_drag", "quadratic_stiffness")
    found = verdict([summary(state, two) for state in states])
    assert found["removed"] == ["structural_damping"]
    assert found["probabilities"].get("clock_drift", 0.0) < 0.05


def test_another_criterion_tells_what_is_asserted_and_stands_in_the_verdict(two):
    allowed, strict = ("quadratic_drag", "quadratic_stiffness"), Criterion(share=1e-9)

    def told(**options):
        states = discover(two, "viscous", allowed=allowed, **options)
        return verdict([summary(state, two) for state in states])

    usual, found = told(), told(criterion=strict)
    names = [{one["name"] for one in each["effects"]} for each in (usual, found)]
    assert names[0] == set(allowed) and "quadratic_stiffness" not in names[1]
    assert (usual["guard"]["share"], found["guard"]["share"]) == (0.2, 1e-9)
    assert "false_alarms" in usual["guard"] and "false_alarms" not in found["guard"]


def test_the_rounds_lead_on_from_one_another_and_the_last_is_judged(two):
    states = discover(two, "viscous", rounds=4)
    assert [state.number for state in states] == list(range(len(states)))
    for before, after in pairwise(states):
        assert before.chosen.fit.model.label == after.fit.model.label
        assert not before.findings
    for one in states:
        moves = [candidate.move for candidate in one.ranked]
        assert len(set(moves)) == len(moves)  # whichever way led to it
    assert states[-1].chosen is None
    assert set(states[-1].findings) == set(states[-1].found)
    assert all(one.sure for one in states[-1].findings.values())
    assert states[-1].findings["quadratic_drag"].probability > 0.99
    assert states[-1].probabilities["quadratic_drag"] > 0.9


def test_where_doubt_leads_back_to_the_base_the_rounds_begin_there(two, monkeypatch):
    def doubted(search, last):
        search.pool.known[search.pool.base] = replace(search.pool.first, unnamed=1e9)

    monkeypatch.setattr("swingdown.discovery.search._Search._doubt", doubted)
    allowed = ("quadratic_drag", "quadratic_stiffness")
    states = discover(two, "viscous", rounds=3, allowed=allowed)
    assert states[0].found == ()
    assert (
        verdict([summary(state, two) for state in states], states[0].model.catalogue)["status"] == "unknown"
    )


def test_swings_that_are_held_out_choose_nothing(two):
    """What they hold is asked once, at the end: with other ones the way is the same."""
    first, second = two.holdout[0], replace(two.holdout[0], angle=two.holdout[0].angle[::-1].copy())
    ways = []
    for swing in (first, second):
        states = discover(replace(two, holdout=(swing,)), "viscous", rounds=3)
        ways.append([state.fit.model.label for state in states])
    assert ways[0] == ways[1]


def fitted_with(name, **values):
    """A fit whose model has an effect at these values, its standard errors as given under ``errors``."""
    errors = values.pop("errors", {})
    one = campaign("shape", swings("viscous", releases=(0.6, 0.4), viscous_ratio=0.006))
    fit = first_fit(one, Model("viscous"))
    model = fit.model.with_effects(("viscous", name), fit.model.values | values)
    model = model.with_values(model.values, errors)
    return replace(fit, model=model, swings=tuple(replace(s, model=model) for s in fit.swings))


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
    far = Noise(20 * NOISE)
    found = coarse_noise(far, [Swing("one", times, angle)], 1 / 0.9)
    if told:
        assert found.deviation == pytest.approx(NOISE, rel=0.1)
        assert found.correlation == 0
    else:
        assert found == far


def test_a_value_knows_of_the_laws_that_the_data_leave(two):
    state = discover(two, "viscous", rounds=3, allowed=("quadratic_drag", "quadratic_stiffness"))[-1]
    law = refit(without(state.fit, "quadratic_drag"), two.fit)
    apart = abs(law.model.values["viscous_ratio"] - state.fit.model.values["viscous_ratio"])

    def error(counting):
        told = concluded([replace(state, counting=counting)], two)[-1].concluded["values"]["viscous_ratio"]
        return told["standard_error"]

    assert error(((0.5, state.fit), (0.5, law))) > 0.6 * apart > 3 * error(((1.0, state.fit),))


def test_a_search_that_breaks_off_ends_as_unknown_with_its_reason(two, monkeypatch):
    def breaks(*arguments, **options):
        raise ZeroDivisionError("float division by zero")

    monkeypatch.setattr("swingdown.discovery.search.ranking", breaks)
    states = concluded(discover(two, "viscous", rounds=2), two)
    found = verdict([summary(state, two) for state in states])
    assert found["status"] == "unknown" and not found["effects"]
    assert "the search broke off (float division by zero)" in found["sentence"]


def test_what_held_out_swings_alone_show_is_missing():
    """The smaller of two swings dies away faster than the larger one, which alone is fitted."""
    (large,) = swings("viscous", releases=(0.9,), viscous_ratio=0.004)
    (small,) = swings("viscous", releases=(0.5,), viscous_ratio=0.006, seed=4)
    one = campaign("a", [replace(large, name="large"), replace(small, name="small")])
    found = verdict([summary(state, one) for state in discover(one, "viscous", allowed=[])])
    assert found["status"] == "unknown" and "has no name" in found["sentence"]
    assert (
        "mostly" not in found["sentence"]
        and f"{found['gap']['holdout'][-1]:.3g} times the noise" in found["sentence"]
    )
    (alike,) = swings("viscous", releases=(0.5,), viscous_ratio=0.004, seed=4)
    one = campaign("a", [replace(large, name="large"), replace(alike, name="small")])
    found = verdict([summary(state, one) for state in discover(one, "viscous", allowed=[])])
    assert found["status"] == "consistent"


def test_a_model_that_cannot_follow_the_held_out_swings_is_no_better_than_the_base(two, monkeypatch):
    from swingdown.discovery.judge import confirm, structures

    def follows(fit, swings):
        if fit.model.names != ("viscous",):
            raise TrajectoryError("no start gives a trajectory")
        return confirm.predict(fit, swings)

    monkeypatch.setattr(structures, "predict", follows)
    states = concluded(discover(two, "viscous", rounds=2), two)
    found = verdict([summary(state, two) for state in states])
    assert found["status"] == "unknown" and not found["failed"]
    assert [state.fit.model.names for state in states] == [("viscous",)]


def test_where_the_best_model_cannot_follow_the_held_out_swings_the_next_is_told(two, monkeypatch):
    from swingdown.discovery.judge import confirm, structures

    def follows(fit, swings):
        if "quadratic_stiffness" in fit.model.names:
            raise TrajectoryError("no start gives a trajectory")
        return confirm.predict(fit, swings)

    monkeypatch.setattr(structures, "predict", follows)
    states = discover(two, "viscous", rounds=2)
    assert "quadratic_drag" in states[-1].found and "quadratic_stiffness" not in states[-1].found
    assert not states[-1].failed


def test_a_search_that_cannot_begin_ends_so_too(two, monkeypatch, tmp_path):
    def breaks(*arguments, **options):
        raise np.linalg.LinAlgError("Singular matrix")

    monkeypatch.setattr("swingdown.discovery.rounds.groups", breaks)
    states = concluded(discover(two, "viscous", rounds=2), two)
    write_rounds(states, two, tmp_path, emulated=True)
    found = verdict(read_json(tmp_path / "rounds.json"))
    assert found["status"] == "unknown" and "broke off (Singular matrix)" in found["sentence"]


@pytest.mark.parametrize(
    "problem", [ZeroDivisionError("float division by zero"), np.linalg.LinAlgError("Singular matrix")]
)
def test_a_candidate_that_fails_is_passed_over(two, monkeypatch, problem):
    """Whatever goes wrong in the fits of one effect, the search goes on to the others."""
    fitted = guarded.fit_jointly

    def fails(model, *arguments, **options):
        if "constant_torque" in model.names:
            raise problem
        return fitted(model, *arguments, **options)

    monkeypatch.setattr(guarded, "fit_jointly", fails)
    states = discover(
        two, "viscous", rounds=2, allowed=("quadratic_drag", "quadratic_stiffness", "constant_torque")
    )
    assert set(states[-1].found) == {"quadratic_drag", "quadratic_stiffness"}


def test_a_value_that_a_model_cannot_have_is_an_input_to_mend_and_no_trajectory():
    model = Model("magnet", {"natural_frequency": 7.0, "magnet_depth": 0.1, "magnet_width": -16.9})
    for kind in (InputError, TrajectoryError):
        with pytest.raises(kind, match="magnet_width: -16.9 rad"):
            simulate(model, TIMES, 0.3)


def test_a_value_that_a_bound_held_in_the_search_has_its_uncertainty_from_the_whole():
    (swing,) = swings("viscous", releases=(0.3,), viscous_ratio=0.004)
    found = _Told(fit_jointly("viscous", [swing.pair]), [swing])

    def told(searched, wider):
        held = SimpleNamespace(model=SimpleNamespace(standard_errors={"viscous_ratio": searched}), widened={"viscous_ratio": wider})  # fmt: skip
        return found.values(held)["viscous_ratio"].uncertainty

    own = told(np.nan, 1.0)
    assert 0 < own == told(own, 1.0) and told(np.nan, 2.0) == pytest.approx(2 * own)


@pytest.mark.parametrize("seed", [0, 1])
def test_what_is_idle_in_the_base_speaks_for_no_other_effect(seed):
    """Friction that gives way before it slips takes all energy: the base's drags do nothing beside it, and what each costs is no evidence."""
    values = {"natural_frequency": 5.306, "presliding_friction": 0.007175, "presliding_angle": 0.01918}
    times = np.arange(0, 67, 0.02)
    noise = 5e-4 * np.random.default_rng(seed).standard_normal(times.size)
    swing = Swing("a", times, simulate(Model("presliding", values), times, 0.06) + noise)
    base = Model("viscous+quadratic_drag")
    one = campaign("one", [swing])
    found = verdict([summary(state, one) for state in discover(one, base)], base.catalogue)
    assert (found["status"], [one["name"] for one in found["effects"]]) == ("named", ["presliding"])
    assert not found["effects"][0]["tied_with"]
