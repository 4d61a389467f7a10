"""What a model lacks without a name: where it acts, of what it is a function, and when."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from swingdown.discovery.data.campaign import Swing
from swingdown.discovery.data.noise import Noise
from swingdown.discovery.see.green import motion, response
from swingdown.discovery.see.linear import frame
from swingdown.discovery.see.remainder import _smooth, remainder
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


def left(model, series, noise=NOISE):
    """The ``Remainder`` of a joint fit to swings with noise."""
    rng = np.random.default_rng(4)
    swings = [
        Swing(f"s{k}", TIMES, one + noise * rng.standard_normal(TIMES.size)) for k, one in enumerate(series)
    ]
    fit = fit_jointly(model, [swing.pair for swing in swings])
    return remainder(frame(fit, swings), Noise(noise))


def test_what_a_torque_does_is_what_the_engine_says():
    expected = sensitivities(with_detent(0.0), TIMES, 0.6, 0.0, free=["detent_torque"])[1][0]
    one = motion(BASE, Swing("a", TIMES, np.zeros_like(TIMES)), 0.6, 0.0)
    found = response(one, np.sin(6 * one.angle + 0.4)[:, np.newaxis])[:, 0]
    assert found == pytest.approx(expected, abs=2e-3 * np.max(np.abs(expected)))


def test_a_torque_over_the_angle_is_seen_on_the_map():
    found = left(BASE, [simulate(with_detent(0.05), TIMES, a) for a in (0.3, 0.45, 0.6, 0.7)])
    table = found.map[found.map["known"] > 0.5]
    truth = 0.05 * np.sin(6 * table["angle_rad"] + 0.4)
    assert len(table) > 20
    assert np.corrcoef(truth, table["torque"])[0, 1] > 0.9
    assert found.shares["position"] > 0.9
    assert found.shares["velocity"] < 0.9 * found.shares["position"]
    strong = table[np.abs(truth) > 0.04]
    assert (strong["torque"].abs() > 2 * strong["band"]).mean() > 0.9


def test_a_brake_that_is_on_for_a_second_is_seen_in_time():
    def swing(amplitude):
        def rate(time, state):
            brake = 0.6 * state[1] if 6 < time < 7 else 0.0
            return [state[1], -(7.25**2) * np.sin(state[0]) - 2 * 0.004 * 7.25 * state[1] - brake]

        return solve_ivp(rate, (0, 20), [amplitude, 0], t_eval=TIMES, rtol=1e-9, atol=1e-11, max_step=0.02).y[
            0
        ]

    found = left(Model("viscous"), [swing(0.3), swing(0.6)], noise=1e-3)
    course = found.course[found.course["swing"] == "s1"]
    inside = course["time_s"].between(5.9, 7.1)
    size = (course["torque"] / course["band"]).abs()
    assert size[inside].max() > 8
    assert (size[~inside] < 3).mean() > 0.99
    assert found.gain > 100
    assert found.shares["map"] < 0.5  # it is no function of angle and speed


def test_nothing_is_seen_where_nothing_is_missing():
    found = left(BASE, [simulate(BASE, TIMES, a) for a in (0.3, 0.45, 0.6, 0.7)])
    assert found.gain < 8
    assert (found.map["torque"].abs() < 3 * found.map["band"]).mean() > 0.95


def test_a_shape_that_the_fit_could_imitate_altogether_tells_nothing():
    columns, near = np.diag([1.0, 2.0]), np.eye(2)
    told = _smooth((1e-9 * columns, columns), np.ones(2), near, 1e-4, 2.0, 100)
    assert not told.value.any() and not told.known.any() and told.left == 2.0


def test_what_is_no_swing_has_a_course_in_time_too():
    swings = [Swing("s0", TIMES, np.random.default_rng(2).standard_normal(TIMES.size))]
    fit = fit_jointly(Model("viscous"), [one.pair for one in swings], fixed={"natural_frequency": 0.01})
    assert np.isfinite(remainder(frame(fit, swings), Noise(0.1)).torque)
