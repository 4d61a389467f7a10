"""An effect whose size changes with side, speed or time is not what it is called; the swings are made by scipy, not by the engine."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from swingdown.discovery.campaign import Noise, Swing, campaign
from swingdown.discovery.constancy import by_changing, changes, forms, torques_along
from swingdown.discovery.established import changing
from swingdown.discovery.green import motions_of, responses
from swingdown.discovery.linear import frame
from swingdown.discovery.ranking import ranking, told_from_changes
from swingdown.discovery.rounds import first_fit, look
from swingdown.discovery.search import discover
from swingdown.discovery.verdict import GUARD
from swingdown.engine.trajectory import TrajectoryError
from swingdown.pendulum.model import Model

TIMES = np.arange(801) / 50  # s
NOISE = 5e-4  # rad
FREQUENCY = 7.0  # rad/s


def swings(drag, seed=4):
    """Four swings with viscous damping and this drag (rad/s^2, a function of angle and velocity), with white noise."""
    draws = np.random.default_rng(seed)

    def motion(t, state):
        angle, velocity = state
        return velocity, -(FREQUENCY**2) * np.sin(angle) - 0.08 * velocity - drag(angle, velocity)

    found = []
    for k, release in enumerate((0.9, -0.7, 0.5, 0.3)):
        angle = solve_ivp(motion, (0, TIMES[-1]), (release, 0.0), "DOP853", TIMES, rtol=1e-10, atol=1e-12, max_step=0.02).y[0]  # fmt: skip
        found.append(Swing(f"swing {k}", TIMES, angle + NOISE * draws.standard_normal(TIMES.size)))
    return campaign("changing", found)


def one_sided(angle, velocity):
    return 0.06 * velocity * abs(velocity) * (angle > 0)


def windy(angle, velocity):
    return 0.03 * (velocity - 0.5) * abs(velocity - 0.5)


def on_a_patch(angle, velocity):
    return 0.03 * velocity * abs(velocity) + 0.1 * np.sign(velocity) * (0.1 < angle < 0.3)


def both_sides(angle, velocity):
    return 0.03 * velocity * abs(velocity)


def power_law(angle, velocity):
    return 0.01 * abs(velocity) ** 2.7 * np.sign(velocity)


def seen(drag):
    """The frame of a fit with quadratic drag, and that effect."""
    one = swings(drag)
    fit = first_fit(one, Model("viscous+quadratic_drag"))
    return frame(fit, one.fit), fit.model.catalogue["quadratic_drag"]


def test_a_torque_along_the_motion_moves_the_angle_as_the_engine_has_it():
    here, drag = seen(both_sides)
    value = here.fit.model.values["quadratic_coefficient"]
    exact = here.slopes[:, here.names.index("quadratic_coefficient")] * value
    motions = motions_of(here)
    torques = [one[:, np.newaxis] for one in torques_along(here, motions, drag)]
    found = responses(motions, torques)[:, 0]
    assert np.linalg.norm(found - exact) < 1e-3 * np.linalg.norm(exact)


def test_drag_on_one_side_changes_with_the_side_and_drag_on_both_does_not():
    noise = Noise(NOISE)
    here, drag = seen(one_sided)
    first = changes(here, drag, noise)[0]
    assert "side" in first.of
    assert 0.5 < first.change < 1.2  # all on one side, nothing on the other
    assert first.change > 10 * first.error
    here, drag = seen(both_sides)
    assert all(one.change < 5 * one.error for one in changes(here, drag, noise))


def test_drag_in_a_wind_changes_with_the_direction():
    here, drag = seen(windy)
    first = changes(here, drag, Noise(NOISE))[0]
    assert "direction" in first.of
    assert first.change > 10 * first.error


def test_friction_from_place_to_place_is_seen_beside_a_drag_and_nothing_where_nothing_is():
    here, drag = seen(on_a_patch)
    rest = float(np.sum(here.residual**2)) - here.samples * NOISE**2
    found = {one.over: one for one in forms(here, drag)}
    assert set(found) == {
        "the speed",
        "the place, as friction",
        "the place, as drag",
    }  # it depends on the speed
    assert found["the place, as friction"].squares > 0.5 * rest
    assert found["the place, as friction"].size > 0.3
    here, drag = seen(both_sides)
    assert all(one.size < 0.3 for one in forms(here, drag))


def test_an_effect_with_a_memory_is_not_asked_whether_it_changes():
    here, _ = seen(both_sides)
    known = here.fit.model.catalogue
    assert changes(here, known["presliding"], Noise(NOISE)) == []
    assert changes(here, known["added_mass"], Noise(NOISE)) == []
    assert forms(here, known["presliding"]) == []


def test_what_a_change_of_the_first_does_as_well_is_not_believed_beside_it():
    here, _ = seen(power_law)
    noise = Noise(NOISE)
    ranked = ranking(here, noise, ("eddy_brake", "constant_torque"))
    assert not ranked[0].refused
    assert ranked[0].added == "eddy_brake"
    assert by_changing(here, noise, ["quadratic_drag"]) > GUARD["worth_bic"]
    told = {one.added: one.refused for one in told_from_changes(ranked, here, noise, ["quadratic_drag"])}
    assert "a change of what was added before" in told["eddy_brake"]
    assert told_from_changes(ranked, here, noise, []) == ranked  # nothing was added before


@pytest.mark.parametrize("drag", [one_sided, power_law])
def test_nothing_is_asserted_of_a_drag_that_no_effect_is(drag):
    allowed = ("quadratic_drag", "eddy_brake", "constant_torque", "structural_damping", "quadratic_stiffness")
    states = discover(swings(drag), "viscous", rounds=2, allowed=allowed)
    last = states[-1]
    assert states[0].chosen.added == "quadratic_drag"  # the nearest to it
    assert last.established
    assert not any(one.sure for one in last.established.values())


def test_a_motion_that_cannot_be_followed_more_finely_ends_no_search_and_establishes_nothing(monkeypatch):
    def lost(frame):
        raise TrajectoryError("it cannot be followed")

    monkeypatch.setattr("swingdown.discovery.constancy.motions_of", lost)
    one = swings(both_sides)
    fit = first_fit(one, Model("viscous+quadratic_drag"))
    state = look(1, one, fit, ("quadratic_drag",), last=True)
    assert "could not be seen" in changing(state, one, "quadratic_drag")
    here = frame(fit, one.fit)
    ranked = ranking(here, Noise(NOISE), ("eddy_brake",))
    assert [c.added for c in told_from_changes(ranked, here, Noise(NOISE), ["quadratic_drag"])] == [
        c.added for c in ranked
    ]
