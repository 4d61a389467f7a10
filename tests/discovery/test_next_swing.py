"""The next experiment: it tells a tie apart where one does, and says so where none does; on swings that the second pendulum makes."""

import json
from dataclasses import replace

import numpy as np
import pytest

from swingdown.discovery.data.campaign import Swing, campaign
from swingdown.discovery.data.noise import Noise
from swingdown.discovery.next.duel import Duel, misfit
from swingdown.discovery.next.experiments import PROTRACTOR, Held, LetGo, menu
from swingdown.discovery.next.proposal import APART, next_swing
from swingdown.discovery.search import discover
from swingdown.discovery.tell.files import summary
from swingdown.discovery.tell.verdict import verdict
from swingdown.engine.trajectory import simulate
from swingdown.fitting.least_squares import fit_jointly
from swingdown.pendulum.model import Model
from swingdown_trials.second_pendulum import trajectory

TIMES = np.arange(0, 12, 0.02)  # s
NOISE = Noise(1e-3)  # rad
VALUES = {"natural_frequency": 7.0, "viscous_ratio": 0.008, "load_friction": 0.002}
BASE = ("viscous", "load_coulomb")


def swing(rng, effects, values, angle, times=TIMES):
    """A swing of the second pendulum."""
    reading = trajectory(effects, VALUES | values, times, angle).reading
    return Swing(f"{angle:.3g}", times, reading + NOISE.deviation * rng.standard_normal(times.size))


def tie(hidden, rival, releases=(0.3, -0.25, 0.2), **values):
    """A campaign with a hidden effect, and the fits with it and with its rival."""
    rng = np.random.default_rng(1)
    one = campaign("tie", [swing(rng, (*BASE, hidden), values, angle) for angle in releases])
    pairs = [each.pair for each in one.fit]
    return one, [fit_jointly(Model((*BASE, name)), pairs, bounded=True) for name in (hidden, rival)]


@pytest.fixture(scope="module")
def springs():
    """Small swings, on which two springs cannot be told apart."""
    return tie("cubic_stiffness", "quadratic_stiffness", cubic_stiffness=1.5)


@pytest.fixture(scope="module")
def gain():
    """Large swings, on which a sensor's gain and a spring differ little."""
    return tie("sensor_gain", "cubic_stiffness", (1.2, -1.0, 0.8), sensor_gain=0.006)


@pytest.fixture(scope="module")
def zero():
    """Small swings, on which a sensor's zero and a torque cannot be told apart."""
    return tie("sensor_zero", "constant_torque", sensor_zero=0.004)


def test_the_swing_that_is_asked_for_tells_the_tie_apart(springs):
    one, fits = springs
    asked = next_swing(*fits, one, NOISE)
    assert asked.kind == "release"
    assert abs(asked.release_angle) > 0.3  # springs differ where swings are large
    small = Duel(*fits, LetGo(0.2, 0.0, TIMES[-1], 0.02), NOISE).close()
    assert asked.separation > max(5, 3 * small)
    assert f"{np.degrees(abs(asked.release_angle)):.2g}°" in str(asked)
    assert "cubic stiffness and quadratic stiffness then differ" in str(asked)
    rng, times = np.random.default_rng(2), np.arange(0, asked.duration, 0.02)
    more = [
        swing(rng, fits[0].model.names, {"cubic_stiffness": 1.5}, asked.release_angle, times)
        for _ in range(asked.times)
    ]
    pairs = [each.pair for each in (*one.fit, *more)]
    true, other = (fit_jointly(Model(fit.model.names), pairs, bounded=True) for fit in fits)
    assert (other.rss - true.rss) / NOISE.deviation**2 > 0.5 * asked.separation**2


def test_fits_of_one_model_are_told_apart_by_nothing_and_that_is_told(springs):
    one, fits = springs
    asked = next_swing(fits[0], fits[0], one, NOISE)
    assert asked.separation < 1e-3
    assert str(asked).startswith("None of the swings and readings")


def test_no_swing_is_promised_more_than_it_tells(zero, springs):
    _, fits = zero
    # released as the reading says, either pendulum stops after as many swings
    assert Duel(*fits, LetGo(0.03, 0.0, TIMES[-1], 0.02), NOISE).separation() < 1
    _, fits = springs
    # springs that small swings hardly know give way to each other far off
    far = Duel(*fits, LetGo(1.3, 0.0, TIMES[-1], 0.02), NOISE)
    assert far.close() < 0.8 * far.separation()


def test_a_sensors_gain_is_told_from_a_spring_by_holding_the_pendulum_at_known_angles(gain):
    one, fits = gain
    asked = next_swing(*fits, one, NOISE)
    assert (asked.kind, asked.limit) == ("held", pytest.approx(PROTRACTOR[1]))
    wrong, right = map(np.array, asked.predicted)
    assert right == pytest.approx(asked.angles, abs=1e-9)
    assert wrong == pytest.approx(
        np.array(asked.angles) * (1 + fits[0].model.values["sensor_gain"]), abs=1e-9
    )
    assert "Hold it still at 0°" in str(asked)
    assert "digital level or a protractor" in str(asked)
    angle = np.degrees(max(asked.angles))
    assert f"{angle * (1 + fits[0].model.values['sensor_gain']):.4g}° or {angle:.4g}°" in str(asked)


def test_readings_at_known_angles_are_worth_what_tells_the_angles_allows(gain):
    _, fits = gain
    angles = (0.0, 0.5, -0.5, 1.0, -1.0)

    def worth(limit, step=0.0):
        return Duel(*fits, Held(angles, "", limit, 500, 0.02, step), NOISE).separation()

    assert worth(2e-3) > 1.5 * worth(6e-3) > 2 * worth(3e-2)
    assert worth(1e-4) > 2 * worth(1e-4, step=0.02)  # steps are not averaged


def test_a_sensor_with_play_may_read_anywhere_in_it(gain):
    one, fits = gain
    model = Model((*BASE, "backlash"), VALUES | {"backlash_width": 0.02})

    def best(other):
        held = [each for each in menu(one, fits[0].model, other) if each.kind == "held"]
        return max(Duel(*fits, each, NOISE).separation() for each in held)

    assert best(model) < 0.5 * best(fits[1].model)


def test_readings_at_known_angles_decide(gain):
    _, fits = gain
    known = Held((0.0, 0.6, -0.6, 1.2, -1.2), "", 1e-3, 500, 0.02)
    rng = np.random.default_rng(3)
    held = np.array(known.angles) + 5e-4 * rng.uniform(-1, 1, 5)
    readings = np.array(
        [
            trajectory((*BASE, "sensor_gain"), VALUES | {"sensor_gain": 0.006}, [0, 0.02], angle).reading[0]
            for angle in held
        ]
    )
    true, other = (misfit(fit, known, readings, NOISE) for fit in fits)
    assert true < 15  # of five readings
    assert other > true + 30


def test_a_weak_tie_asks_for_the_swing_as_often_as_is_needed():
    one, fits = tie("sensor_zero", "constant_torque", (1.4, -1.2, 1.0), sensor_zero=0.0005)
    asked = next_swing(*fits, one, NOISE)
    assert 1 < asked.times <= 9
    assert asked.separation >= APART
    assert f", {asked.times} times: " in str(asked)
    duel = Duel(*fits, LetGo(asked.release_angle, 0.0, asked.duration, 0.02), NOISE)
    assert duel.close() < APART <= duel.close(asked.times)


def test_what_both_fits_leave_beyond_the_noise_counts_as_noise(springs):
    one, fits = springs
    misfit = [replace(fit, rss=fit.rss * 36) for fit in fits]
    loud, quiet = next_swing(*misfit, one, NOISE), next_swing(*misfit, one, Noise(6 * fits[0].rms))
    assert loud == quiet


def test_a_search_tells_the_experiment_and_what_either_structure_says_of_it(gain):
    one, _ = gain
    states = discover(one, "viscous+load_coulomb", rounds=1, allowed=("sensor_gain", "cubic_stiffness"))
    found = verdict(json.loads(json.dumps([summary(state, one) for state in states])))
    asked = found["next_swing"]
    assert asked["kind"] == "held"
    assert found["next_measurement"] == asked["text"]
    assert asked["text"].startswith(asked["do"])
    assert len(asked["angles"]) == len(asked["predicted"][0]) == 5
    assert asked["release_angle"] == max(asked["angles"])


def test_a_push_swings_out_as_far_as_is_said(springs):
    one, fits = springs
    model = fits[0].model
    largest = np.degrees(max(abs(each.angle) for each in menu(one, model) if each.kind == "release"))
    pushes = [each for each in menu(one, model) if each.kind == "push"]
    assert {np.sign(each.velocity) for each in pushes} == {1, -1}
    free = Model("viscous", {"natural_frequency": 7.0, "viscous_ratio": 0.0})
    for push in pushes:
        out = np.degrees(np.max(np.abs(simulate(free, TIMES, 0.0, push.velocity))))
        told = float(push.words(1, model).split("about ")[1].split("°")[0])
        assert told == pytest.approx(out, rel=0.06)
        assert told == pytest.approx(largest, rel=0.06)


def test_no_swing_is_asked_for_that_takes_long_to_follow(springs):
    _, fits = springs
    times = np.arange(0, 200, 0.05)
    long = campaign(
        "long", [Swing("a", times, 0.3 * np.cos(7 * times)), Swing("b", times, 0.2 * np.cos(7 * times))]
    )
    swings = [each for each in menu(long, fits[0].model) if each.kind == "release"]
    (duration,) = {each.duration for each in swings}
    assert duration == pytest.approx(100 * 2 * np.pi / 7.0, rel=1e-3)
    assert len({(each.angle, each.duration) for each in swings}) == len(swings)


def test_a_gyroscope_is_only_read_at_rest(springs):
    one, _ = springs
    names = ("viscous", "load_coulomb", "sensor_zero")
    model = Model(names, VALUES | {"sensor_zero": 0.02}).of("rate")
    (held,) = [each for each in menu(one, model) if each.kind == "held"]
    said = held.predicted(model, ["sensor_zero"], {})
    assert said.readings == pytest.approx([0.02])
    assert said.shared == pytest.approx(1.0)
    assert held.words(1, model) == "Let it hang at rest and read the sensor for 10 s"
