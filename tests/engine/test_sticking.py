"""Friction that holds the pendulum, and what frees it again: where and when, as the second pendulum says."""

import numpy as np
import pytest
from cases import TIMES, friction

from swingdown.engine.trajectory import effort, sensitivities, simulate
from swingdown.pendulum.model import Model
from swingdown_trials import second_pendulum as oracle


@pytest.mark.parametrize("release", [0.3, 0.7, 1.0])
def test_sticking_inside_the_record(release):
    model = friction(3.0)
    seen = oracle.trajectory(model.names, model.values, TIMES, release)
    read = simulate(model, TIMES, release)
    assert seen.stuck_after < 4.0
    assert np.abs(read - seen.reading).max() < 1e-9
    assert effort(model, TIMES, release).stuck_after == pytest.approx(seen.stuck_after, abs=1e-8)
    assert np.ptp(read[seen.stuck_after < TIMES]) == 0.0
    assert 49 * np.sin(abs(read[-1])) <= 3.0, "held where friction can hold it"


@pytest.mark.parametrize("release", [0.0, 0.05, -0.06])
def test_a_release_that_friction_holds_stays(release):
    assert np.all(simulate(friction(3.0), TIMES, release) == release)
    assert effort(friction(3.0), TIMES, release).stuck_after == 0.0


def test_a_push_frees_what_friction_holds():
    model = friction(3.0)
    seen = oracle.trajectory(model.names, model.values, TIMES, 0.05, 0.4)
    assert np.abs(simulate(model, TIMES, 0.05, 0.4) - seen.reading).max() < 1e-9
    assert simulate(model, TIMES, 0.05, 0.4).max() > 0.06


def test_a_shaken_pendulum_sticks_and_breaks_away_again():
    values = {
        "natural_frequency": 7.0, "constant_friction": 2.0, "vibration_acceleration": 2.6, "vibration_frequency": 0.4,
        "vibration_phase": 1.0,
    }  # fmt: skip
    model = Model("constant_coulomb+base_vibration", values)
    times = np.linspace(0, 10, 800)
    seen = oracle.trajectory(model.names, values, times, 0.2)
    read = simulate(model, times, 0.2)
    assert np.abs(read - seen.reading).max() < 1e-8
    held = np.diff(read) == 0
    assert np.count_nonzero(np.diff(held.astype(int)) == -1) > 2, "held and freed several times"


def test_a_moment_of_turning_back_between_two_nodes_is_seen():
    """The stand shakes so fast that near a turning point the pendulum turns back for 1.4 ms: six reversals, not four."""
    values = {
        "natural_frequency": 2.4290, "stribeck_friction": 0.00601, "stribeck_velocity": 0.0612, "vibration_acceleration": 1.3787,
        "vibration_frequency": 29.93, "vibration_phase": 3.1605,
    }  # fmt: skip
    model = Model("stribeck+base_vibration", values, restoring="linear")
    times = np.linspace(0, 7, 561)
    seen = oracle.trajectory(model.names, values, times, 0.0, -0.4372, "linear")
    assert min(np.diff(seen.reversals)) < 0.002
    assert np.abs(simulate(model, times, 0.0, -0.4372) - seen.reading).max() < 1e-9
    assert effort(model, times, 0.0, -0.4372).reversals == len(seen.reversals)


@pytest.mark.parametrize(("frequency", "acceleration"), [(0.4, 2.05), (29.93, 2.05)])
def test_a_short_shake_frees_a_pendulum_that_is_held(frequency, acceleration):
    """Friction of 2 rad/s^2 holds against all but the crests of the shake, which are shorter than the nodes are apart."""
    values = {
        "natural_frequency": 2.429, "constant_friction": 2.0, "vibration_acceleration": acceleration,
        "vibration_frequency": frequency, "vibration_phase": 1.0,
    }  # fmt: skip
    model, times = Model("constant_coulomb+base_vibration", values), np.linspace(0, 3, 301)
    seen = oracle.trajectory(model.names, values, times, 0.1)
    assert np.ptp(seen.reading) > 1e-3
    assert np.abs(simulate(model, times, 0.1) - seen.reading).max() < 1e-9
    assert effort(model, times, 0.1).reversals == len(seen.reversals)


@pytest.mark.parametrize(
    ("label", "friction", "release"),
    [
        ("constant_coulomb+presliding", {"constant_friction": 0.5}, 0.001),
        ("load_coulomb+presliding", {"load_friction": 0.01}, 0.005),
    ],
)
def test_friction_that_winds_up_beside_friction_that_holds(label, friction, release):
    """Released where it is held, it stays, and only the release angle changes where; further out it swings."""
    values = {"natural_frequency": 7.0, "presliding_friction": 0.2, "presliding_angle": 0.01} | friction
    model = Model(label, values)
    angle, slopes = sensitivities(model, TIMES, release)
    assert np.all(angle == release)
    assert effort(model, TIMES, release).stuck_after == 0.0
    for name, row in zip((*model.parameters, "release_angle", "release_velocity"), slopes, strict=True):
        assert np.all(row == (name == "release_angle")), name
    seen = oracle.trajectory(model.names, values, TIMES, 0.3)
    assert np.abs(simulate(model, TIMES, 0.3) - seen.reading).max() < 1e-8


def test_a_stuck_pendulum_on_a_ringing_support():
    values = {
        "natural_frequency": 7.0, "constant_friction": 3.0, "pivot_mass_ratio": 0.3, "pivot_frequency": 15.0, "pivot_damping_ratio": 0.01,
    }  # fmt: skip
    model = Model("constant_coulomb+flexible_pivot", values)
    seen = oracle.trajectory(model.names, values, TIMES, 0.5)
    assert np.abs(simulate(model, TIMES, 0.5) - seen.reading).max() < 1e-9
    assert seen.stuck_after is not None
