"""Where a search goes after its first way: the better of two ways, a simpler effect in the place of a richer one, what leans or idles."""

from dataclasses import replace
from functools import partial
from itertools import pairwise

import numpy as np
import pytest

from swingdown.discovery.budget import Budget
from swingdown.discovery.campaign import Noise, Swing, campaign
from swingdown.discovery.established import (
    Finding,
    _leaning,
    borrowed,
    established,
    rivals,
    still_so,
    unneeded,
)
from swingdown.discovery.evidence import Candidate, evidence
from swingdown.discovery.linear import frame
from swingdown.discovery.ranking import _no_worse, in_place_of
from swingdown.discovery.rounds import first_fit, look
from swingdown.discovery.search import _alike, _best, discover
from swingdown.discovery.simpler import _moves, leaner, restored, simplified
from swingdown.discovery.state import Search
from swingdown.engine.trajectory import simulate
from swingdown.fitting.least_squares import fit_jointly
from swingdown.pendulum.model import Model

TIMES = np.arange(501) / 50  # s
NOISE = 1e-3  # rad
TRUE = Model("viscous+quadratic_drag", {"natural_frequency": 7.0, "viscous_ratio": 0.006, "quadratic_coefficient": 0.004})  # fmt: skip


@pytest.fixture(scope="module")
def drag():
    """Swings of a pendulum with quadratic drag beside the base's viscous term."""
    draws = np.random.default_rng(6)
    swings = [
        Swing(f"{a}", TIMES, simulate(TRUE, TIMES, a) + NOISE * draws.standard_normal(TIMES.size))
        for a in (0.9, -0.7, 0.5, 0.3)
    ]
    return campaign("drag", swings)


def at(one, label, found, number=1):
    """The round at the fit of a model, the last of its way."""
    return look(number, one, first_fit(one, Model(label)), found, last=True)


@pytest.mark.parametrize(("torque", "doubted"), [(0.2, True), (0.5, False)])
def test_where_next_to_nothing_remains_an_effect_may_be_a_little_other_than_its_name(torque, doubted):
    """A sensor's zero does nearly all that a constant torque (rad/s^2) does; what it does not may be another effect, if it is much."""
    values = {"natural_frequency": 7.0, "viscous_ratio": 0.006, "constant_torque": torque}
    pulled, draws = Model("viscous+constant_torque", values), np.random.default_rng(7)
    swings = [
        Swing(f"{a}", TIMES, simulate(pulled, TIMES, a) + NOISE * draws.standard_normal(TIMES.size))
        for a in (0.9, -0.7, 0.5, 0.3)
    ]
    one = campaign("pulled", swings)
    state = at(one, "viscous+sensor_zero", ("sensor_zero",))
    assert state.missing
    doubt = established(state, one, ("viscous", "sensor_zero", "clock_drift"), Budget())["sensor_zero"].doubt
    assert ("its own failing" in doubt) == doubted
    assert bool(doubt) == doubted


def search(one, rounds=4, allowed=None):
    return Search(one, rounds, allowed, Budget())


def move(state, added, dropped=None):
    """A choice that leads to the model of a round."""
    return Candidate(added, dropped, state.fit, state.bic)


def test_a_simpler_effect_takes_the_place_of_one_that_contains_it_where_held_out_swings_do_not_mind(drag):
    rich = at(drag, "viscous+steady_wind", ("steady_wind",))
    states = simplified(search(drag), [rich])
    assert [state.fit.model.label for state in states] == ["viscous+steady_wind", "viscous+quadratic_drag"]
    assert states[0].chosen.move == "exchange steady_wind for quadratic_drag"
    assert states[1].found == ("quadratic_drag",)


def test_it_does_not_where_held_out_swings_mind_where_no_round_is_left_or_where_it_may_not(drag):
    rich = at(drag, "viscous+steady_wind", ("steady_wind",))
    assert simplified(search(drag, allowed=("viscous",)), [rich]) == [rich]
    assert simplified(search(drag, rounds=1), [rich]) == [rich]
    values = {"natural_frequency": 7.0, "viscous_ratio": 0.006, "wind_coefficient": 0.004, "wind_speed": 1.0}
    windy = Model("viscous+steady_wind", values)
    swings = [replace(one, angle=simulate(windy, TIMES, one.angle[0])) for one in (*drag.fit, *drag.holdout)]
    storm = campaign("storm", swings)
    fit = fit_jointly(windy, [one.pair for one in storm.fit], guess=windy, bounded=True)
    rich = look(1, storm, fit, ("steady_wind",), last=True)
    assert simplified(search(storm), [rich]) == [rich]


def test_of_two_ways_the_one_is_told_that_leaves_less_of_swings_left_out(drag):
    base = look(0, drag, first_fit(drag, Model("viscous")), last=True)
    right = at(drag, "viscous+quadratic_drag", ("quadratic_drag",))
    wrong = at(drag, "viscous+constant_torque", ("constant_torque",))
    ways = [[replace(base, chosen=move(one, *one.found)), one] for one in (wrong, right)]
    assert _best(search(drag), ways)[-1] is right
    assert _best(search(drag), ways[::-1])[-1] is right
    # a way that runs into another one's model says so
    into = [ways[1][0], replace(right, chosen=move(right, "viscous"))]
    ended = _best(search(drag), [ways[0], into])[-1]
    assert ended.chosen is None
    assert "another way" in ended.reason


def test_a_richer_form_of_the_first_choice_is_no_other_way(drag):
    state = at(drag, "viscous", ())
    state = replace(state, chosen=move(state, "quadratic_drag"))
    assert _alike(state, move(state, "power_law_drag"))
    assert _alike(state, move(state, "steady_wind"))
    assert not _alike(state, move(state, "cubic_stiffness"))


def test_what_leans_on_what_was_found_beside_it_is_not_established(drag):
    """Two springs bend one another's curve; a drag takes no part in it."""
    found = ("quadratic_drag", "quadratic_stiffness", "cubic_stiffness")
    state = at(drag, "viscous+" + "+".join(found), found)
    values = dict(state.fit.model.values) | {"quadratic_stiffness": -0.5, "cubic_stiffness": 0.8}
    fit = replace(state.fit, model=state.fit.model.with_values(values))
    state = replace(state, fit=fit)
    assert "depends on what stands beside it" in _leaning(state, drag, "quadratic_stiffness")
    assert _leaning(state, drag, "quadratic_drag") == ""


def test_an_exchange_is_held_against_the_term_that_it_took_the_place_of(drag, monkeypatch):
    """Viscous friction is there and was dropped for structural damping: without any friction much is left, with either little."""
    monkeypatch.setattr("swingdown.discovery.established.changing", lambda *_: "")
    monkeypatch.setattr("swingdown.discovery.established._leaning", lambda *_: "")
    model = Model("structural_damping+quadratic_drag")
    state = look(2, drag, first_fit(drag, model), ("structural_damping", "quadratic_drag"), last=True)
    alone, beside = (
        established(state, drag, (), Budget(), base)["structural_damping"] for base in ((), ("viscous",))
    )
    assert "viscous" not in alone.ties
    assert beside.ties == ("viscous",)
    assert beside.alone.doubt == "viscous does as well in its place"


def test_what_damps_is_held_against_all_that_damps_whatever_it_promises(drag, monkeypatch):
    monkeypatch.setattr("swingdown.discovery.established.in_place_of", partial(in_place_of, few=0))
    state = at(drag, "structural_damping+quadratic_drag", ("structural_damping", "quadratic_drag"))
    others = ("constant_torque", "cubic_stiffness", "viscous")
    assert "viscous" in rivals(state, drag, others, "structural_damping")
    true = at(drag, "viscous+quadratic_drag", ("viscous", "quadratic_drag"))
    assert rivals(true, drag, ("load_coulomb", "constant_torque"), "viscous") == []


def test_an_effect_of_the_base_comes_back_into_the_place_of_what_was_found_for_it(drag):
    """Structural damping took viscous drag's place, and quadratic drag was found after it; viscous drag was there all the time."""
    search = Search(drag, 4, None, Budget(), ("viscous",))
    ended = at(drag, "structural_damping+quadratic_drag", ("structural_damping", "quadratic_drag"))
    states = restored(search, [ended])
    assert states[-1].fit.model.label == "viscous+quadratic_drag"
    assert states[-1].found == ("quadratic_drag",)  # what the base had is not found
    assert states[-2].chosen.dropped == "structural_damping"


def test_it_comes_back_though_all_rounds_are_used_up(drag):
    found = ("structural_damping", "quadratic_drag")
    begun, ended = at(drag, "viscous", (), number=0), at(drag, "+".join(found), found, number=1)
    states = restored(Search(drag, 1, None, Budget(), ("viscous",)), [begun, ended])
    assert [state.fit.model.label for state in states] == ["viscous", "viscous+quadratic_drag"]
    assert leads_on(drag, states)


def test_what_is_there_is_not_exchanged_for_what_the_base_had(drag):
    search = Search(drag, 4, None, Budget(), ("structural_damping",))
    ended = at(drag, "viscous+quadratic_drag", ("viscous", "quadratic_drag"))
    assert restored(search, [ended])[-1] is ended


def test_an_effect_more_does_no_worse_than_the_exchange_that_beat_it(drag):
    begun, alone = (first_fit(drag, Model(label)) for label in ("viscous", "quadratic_drag"))
    here, noise = frame(begun, drag.fit), Noise(NOISE)
    assert alone.rss < begun.rss
    exchange = Candidate("quadratic_drag", "viscous", alone, evidence(alone, noise))
    stuck = Candidate("quadratic_drag", None, begun, evidence(begun, noise))  # in a false minimum, say
    best = _no_worse([exchange, stuck], here, noise)[0]
    assert best.dropped is None
    assert best.fit.rms == pytest.approx(NOISE, rel=0.05)


def test_two_large_effects_that_nearly_cancel_are_not_believed():
    """A bent sensor, without that in the catalogue: a zero and an eccentricity of many times its size do its work."""
    values = {"natural_frequency": 7.0, "viscous_ratio": 0.006, "sensor_curvature": 0.012}
    bent, draws = Model("viscous+sensor_curvature", values), np.random.default_rng(7)
    swings = [
        Swing(f"{a}", TIMES, simulate(bent, TIMES, a) + NOISE * draws.standard_normal(TIMES.size))
        for a in (0.9, -0.7, 0.5, 0.3)
    ]
    allowed = ("viscous", "constant_torque", "sensor_zero", "eccentricity", "quadratic_stiffness")
    last = discover(campaign("bent", swings), "viscous", allowed=allowed)[-1]
    assert not last.missing
    assert set(last.found) == {"sensor_zero", "eccentricity"}
    assert not any(one.sure for one in last.established.values())


def test_two_effects_of_which_each_does_its_own_work_are_believed(drag):
    state = at(drag, "viscous+quadratic_drag+constant_torque", ("quadratic_drag", "constant_torque"))
    assert not borrowed(state, drag)


def test_what_has_another_value_in_the_end_than_when_it_was_established_is_doubted(drag):
    fit = at(drag, "viscous+quadratic_drag", ("quadratic_drag",)).fit
    effect, sure = fit.model.catalogue["quadratic_drag"], Finding("")
    values = fit.model.values

    def ended(factor):
        changed = values | {"quadratic_coefficient": factor * values["quadratic_coefficient"]}
        return replace(fit, model=fit.model.with_values(changed))

    assert still_so(sure, effect, fit, ended(1.1)).sure
    for factor in (0.2, 1.5):
        doubted = still_so(sure, effect, fit, ended(factor))
        assert doubted.doubt == "quadratic_coefficient depends on what stands beside it"
    assert still_so(Finding("no reason"), effect, fit, ended(0.2)).doubt == "no reason"


def test_another_spring_is_tried_beside_the_friction_that_has_nothing_to_do_without_one():
    """Without any spring Stribeck friction goes to nothing; beside it the cubic one does better than the torsion spring."""
    values = {"natural_frequency": 7.4937, "viscous_ratio": 0.0097, "load_friction": 0.002}
    values |= {"stribeck_friction": 0.39, "stribeck_velocity": 0.31}
    true = Model("viscous+load_coulomb+stribeck+cubic_stiffness", values | {"cubic_stiffness": 1.9})
    times, draws, noise = np.arange(1001) / 50, np.random.default_rng(3), 2.8e-3
    swings = [
        Swing(f"{a}", times, simulate(true, times, a) + noise * draws.standard_normal(times.size))
        for a in (0.29, -0.43, 0.54, -0.62, 0.72, -0.89)
    ]
    one = campaign("springs", swings)
    values |= {"natural_frequency": 6.678, "torsion_stiffness": 11.56}
    begun = Model("viscous+load_coulomb+stribeck+torsion_spring", values)
    fit = fit_jointly(begun, [swing.pair for swing in one.fit], guess=begun, bounded=True)
    assert fit.rms < 1.05 * noise
    best = in_place_of(frame(fit, one.fit), Noise(noise), "torsion_spring", ["cubic_stiffness"], beside=True)[
        0
    ]
    assert best.added == "cubic_stiffness"
    assert best.fit.model.values["stribeck_friction"] == pytest.approx(0.39, rel=0.1)
    assert best.fit.rms < fit.rms


def leads_on(one, states):
    """Whether each round's move leads to the next one's model, and the rounds are counted."""
    for before, after in pairwise(states):
        found = search(one).after(before.found, before.chosen)
        assert found == after.found
        assert after.number == before.number + 1
        gone = set(before.fit.model.names) - {before.chosen.dropped}
        assert set(after.fit.model.names) == gone | set(before.chosen.names)
    return True


def test_idle_effects_are_left_out_though_all_rounds_are_used_up(drag):
    found = ("cubic_stiffness", "constant_torque", "quadratic_drag")
    states = [at(drag, "viscous", (), number=0)]
    for k in (1, 2, 3):
        states.append(at(drag, "+".join(("viscous", *found[:k])), found[:k], number=k))
        states[-2] = replace(states[-2], chosen=move(states[-1], found[k - 1]))
    assert not states[-1].missing
    fewer = leaner(search(drag, rounds=3), states)
    assert leads_on(drag, fewer)
    assert len(fewer[-1].found) == 2
    assert "quadratic_drag" in fewer[-1].found
    assert fewer[-1].fit.rms == pytest.approx(NOISE, rel=0.05)


def test_one_effect_takes_the_place_of_two_that_did_its_work():
    """A quadratic spring and a sensor's gain bend into a cubic spring, and neither is idle without it."""
    values = {
        "natural_frequency": 7.0,
        "viscous_ratio": 0.006,
        "cubic_stiffness": 2.0,
        "constant_torque": 0.3,
    }
    true, draws = Model("viscous+cubic_stiffness+constant_torque", values), np.random.default_rng(8)
    swings = [
        Swing(f"{a}", TIMES, simulate(true, TIMES, a) + NOISE * draws.standard_normal(TIMES.size))
        for a in (0.8, -0.7, 0.6, 0.4)
    ]
    one = campaign("bent", swings)
    found = ("constant_torque", "quadratic_stiffness", "sensor_gain")
    states = [at(one, "viscous", (), number=0)]
    for k in (1, 2, 3):
        states.append(at(one, "+".join(("viscous", *found[:k])), found[:k], number=k))
        states[-2] = replace(states[-2], chosen=move(states[-1], found[k - 1]))
    assert unneeded(states[-1], one) is None
    fewer = leaner(search(one, rounds=3, allowed=("viscous", "cubic_stiffness", *found)), states)
    assert leads_on(one, fewer)
    assert set(fewer[-1].found) == {"constant_torque", "cubic_stiffness"}
    assert leaner(search(one, rounds=3, allowed=("viscous", *found)), states) is states


def test_what_the_base_had_goes_where_what_damps_comes(drag):
    last = at(drag, "quadratic_drag+constant_torque", ("quadratic_drag", "constant_torque"), number=2)
    assert _moves(Model("viscous"), last) == [("quadratic_drag", "viscous"), ("constant_torque", None)]
    last = at(drag, "constant_torque+quadratic_drag", ("constant_torque",), number=2)
    base = Model("viscous+quadratic_drag+load_coulomb")
    assert _moves(base, last) == [("constant_torque", "viscous"), (None, "load_coulomb")]


def test_an_effect_that_is_put_back_is_found_once(drag):
    state = at(drag, "viscous+quadratic_drag", ("quadratic_drag", "constant_torque"))
    back = move(state, "quadratic_drag", "constant_torque")
    assert search(drag).after(state.found, back) == ("quadratic_drag",)
