"""What a model lacks without a name: where it acts, how large each kind of it is, and when it acts."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from swingdown.discovery.data.campaign import Swing
from swingdown.discovery.data.noise import Noise
from swingdown.discovery.see.course import course
from swingdown.discovery.see.discrepancy import Unnamed
from swingdown.discovery.see.green import motion, response
from swingdown.discovery.see.linear import frame
from swingdown.discovery.see.torques import torques
from swingdown.engine.trajectory import sensitivities, simulate
from swingdown.fitting.least_squares import fit_jointly
from swingdown.pendulum.model import Model

TIMES = np.arange(2000) / 100
BASE = Model(
    ("viscous", "load_coulomb"), {"natural_frequency": 7.25, "viscous_ratio": 0.004, "load_friction": 0.003}
)
NOISE = 2e-3


def with_detent(torque):
    values = BASE.values | {"detent_torque": torque, "detent_order": 6, "detent_phase": 0.4}
    return BASE.with_effects((*BASE.names, "detent"), values)


def seen(model, series, noise=NOISE):
    """(frame, noise, discrepancy) of a joint fit to swings with noise."""
    rng = np.random.default_rng(4)
    swings = [
        Swing(f"s{k}", TIMES, one + noise * rng.standard_normal(TIMES.size)) for k, one in enumerate(series)
    ]
    fit = fit_jointly(model, [swing.pair for swing in swings])
    return frame(fit, swings), Noise(noise), Unnamed(fit, swings, 2 * np.pi / 7.25, Noise(noise))


def swung(amplitude, more):
    """A swing with more torque (rad/s^2, of time, angle and speed) than its viscous drag."""

    def rate(time, state):
        return [state[1], -(7.25**2) * np.sin(state[0]) - 2 * 0.004 * 7.25 * state[1] + more(time, *state)]

    return solve_ivp(rate, (0, 20), [amplitude, 0], t_eval=TIMES, rtol=1e-9, atol=1e-11, max_step=0.02).y[0]


def test_what_a_torque_does_is_what_the_engine_says():
    expected = sensitivities(with_detent(0.0), TIMES, 0.6, 0.0, free=["detent_torque"])[1][0]
    one = motion(BASE, Swing("a", TIMES, np.zeros_like(TIMES)), 0.6, 0.0)
    found = response(one, np.sin(6 * one.angle + 0.4)[:, np.newaxis])[:, 0]
    assert found == pytest.approx(expected, abs=2e-3 * np.max(np.abs(expected)))


def test_a_torque_over_the_angle_is_seen_on_the_map():
    here, _, unnamed = seen(BASE, [simulate(with_detent(0.05), TIMES, a) for a in (0.3, 0.45, 0.6, 0.7)])
    table = torques(unnamed, here)
    assert table["seen"].sum() == pytest.approx(1)
    truth = 0.05 * np.sin(6 * table["angle_rad"] + 0.4)
    assert ((table["torque"] - truth).abs() < 3 * table["band"]).mean() > 0.95
    table = table[table["known"] > 0.5]
    truth = 0.05 * np.sin(6 * table["angle_rad"] + 0.4)
    assert len(table) > 100
    assert np.corrcoef(truth, table["torque"])[0, 1] > 0.9
    assert (table["torque"].abs() > 2 * table["band"]).mean() > 0.5
    sizes = unnamed.beside(here).sizes
    assert max(sizes, key=sizes.get) == "restoring"


def test_a_stop_on_one_side_is_where_it_is():
    """Its torque pushes back beyond 0.4 rad, and nothing does at the other end."""
    stopped = [swung(a, lambda _, angle, speed: -1.5 * max(angle - 0.4, 0.0)) for a in (0.3, 0.5, 0.7)]
    here, _, unnamed = seen(Model("viscous"), stopped, noise=1e-3)
    table = torques(unnamed, here)
    largest = table["angle_rad"].max()
    ends = [table[(table["angle_rad"] == end) & (table["known"] > 0.3)] for end in (largest, -largest)]
    beyond, other = ends
    assert len(beyond) and (beyond["torque"] < -3 * beyond["band"]).all()
    assert (other["torque"].abs() < 3 * other["band"]).all()


def test_friction_is_against_the_motion_in_either_direction():
    rubbed = [swung(a, lambda _, angle, speed: -0.05 * np.tanh(speed / 0.01)) for a in (0.3, 0.5)]
    here, _, unnamed = seen(Model("viscous"), rubbed, noise=1e-3)
    table = torques(unnamed, here)
    slow = table[(table["angle_rad"].abs() < 0.2) & (table["speed_rad_per_s"].abs() < 1)]
    against = np.where(np.signbit(slow["speed_rad_per_s"]), 1.0, -1.0)
    assert len(slow) > 8 and set(against) == {1.0, -1.0}
    assert ((slow["torque"] * against) > 3 * slow["band"]).all()
    assert slow["torque"].abs().max() == pytest.approx(0.05, rel=0.2)


def test_what_the_fits_own_drag_imitates_is_open():
    """A drag to one side is half of it one to both sides, which the fit has."""
    braked = [swung(a, lambda _, angle, speed: -0.2 * speed * (speed > 0)) for a in (0.3, 0.5)]
    here, _, unnamed = seen(Model("viscous"), braked, noise=1e-3)
    table = torques(unnamed, here)
    middle = table[(table["angle_rad"] == 0) & (table["speed_rad_per_s"].abs() > 1)]
    truth = -0.1 * middle["speed_rad_per_s"].abs()
    assert len(middle) == 8
    assert ((middle["torque"] - truth).abs() < 3 * middle["band"]).all()
    assert (middle["torque"] < 0).all()


def test_a_brake_that_is_on_for_a_second_is_seen_in_time():
    braked = [swung(a, lambda time, _, speed: -0.6 * speed * (6 < time < 7)) for a in (0.3, 0.6)]
    here, noise, _ = seen(Model("viscous"), braked, noise=1e-3)
    found = course(here, noise)
    one = found.table[found.table["swing"] == "s1"]
    inside = one["time_s"].between(5.9, 7.1)
    size = (one["torque"] / one["band"]).abs()
    assert size[inside].max() > 8
    assert (size[~inside] < 3).mean() > 0.99
    assert found.gain > 100


def test_nothing_is_seen_where_nothing_is_missing():
    here, noise, unnamed = seen(BASE, [simulate(BASE, TIMES, a) for a in (0.3, 0.45, 0.6, 0.7)])
    assert course(here, noise).gain < 8
    table = torques(unnamed, here)
    assert (table["torque"].abs() <= 3 * table["band"]).mean() > 0.95


def test_what_is_no_swing_has_a_course_in_time_too():
    swings = [Swing("s0", TIMES, np.random.default_rng(2).standard_normal(TIMES.size))]
    fit = fit_jointly(Model("viscous"), [one.pair for one in swings], fixed={"natural_frequency": 0.01})
    assert np.isfinite(course(frame(fit, swings), Noise(0.1)).size)
