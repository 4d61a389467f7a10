"""Formulas of any form become C that computes them and their derivatives: against an integrator that knows the equations by hand."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from swingdown.engine import compiler
from swingdown.engine.trajectory import sensitivities, simulate
from swingdown.fitting.batch import Search, fit_batch
from swingdown.pendulum.catalogue import Catalogue
from swingdown.pendulum.effect import Effect, Parameter, State
from swingdown.pendulum.model import Model

OMEGA = 6.0
TIMES = np.linspace(0, 3, 61)


def effect(name, term, values, **more):
    parameters = tuple(Parameter(f"{name}_{one}", one, "1", typical=0.1) for one in values)
    return Effect(name, term, parameters, "One of these tests.", "none", **more)


# By name: the entry, its values, and of the motion (t, theta, thetadot, the state) by hand torque, inertia, the state's rate; then the reading.
ALL = {
    "powers": (effect("powers", "-a*thetadot - b*theta**3 - c*theta**(-2)*theta**5/8", {"a": 0.2, "b": 2.0, "c": 1.0}),
               {"a": 0.2, "b": 2.0, "c": 1.0}, lambda t, x, v, z: -0.2 * v - 2 * x**3 - x**3 / 8),  # fmt: skip
    "fraction": (effect("fraction", "-d*abs(thetadot)**n*sign(thetadot)", {"d": 0.1, "n": 1.5}), {"d": 0.1, "n": 1.5},
                 lambda t, x, v, z: -0.1 * np.abs(v) ** 1.5 * np.sign(v)),  # fmt: skip
    "one_side": (effect("one_side", "-k*(theta - e + abs(theta - e))/2", {"k": 20.0, "e": 0.2}), {"k": 20.0, "e": 0.2},
                 lambda t, x, v, z: -20 * max(x - 0.2, 0.0)),  # fmt: skip
    "narrow": (effect("narrow", "-m*theta*exp(-(theta/w)**2) - m*tanh(theta)/9", {"m": 4.0, "w": 0.3}), {"m": 4.0, "w": 0.3},
               lambda t, x, v, z: -4 * x * np.exp(-((x / 0.3) ** 2)) - 4 * np.tanh(x) / 9),  # fmt: skip
    "timed": (effect("timed", "f*cos(g*t + pi/3)*(1 + t/duration) - log(1 + f)*sin(theta)*omega_n**2/20", {"f": 0.5, "g": 4.0}), {"f": 0.5, "g": 4.0},
              lambda t, x, v, z: 0.5 * np.cos(4 * t + np.pi / 3) * (1 + t / 3) - np.log(1.5) * np.sin(x) * OMEGA**2 / 20),  # fmt: skip
    "constants": (effect("constants", "-k*sin(theta*pi/2) - k*exp(1)*sqrt(2)*theta", {"k": 0.5}), {"k": 0.5},
                  lambda t, x, v, z: -0.5 * np.sin(x * np.pi / 2) - 0.5 * np.e * np.sqrt(2) * x),  # fmt: skip
    "heavy": (effect("heavy", "0", {"h": 0.2}, inertia="h*cos(theta)**2"), {"h": 0.2}, lambda t, x, v, z: 0.0),
    "memory": (effect("memory", "-k*z", {"k": 3.0, "r": 2.0}, states=(State("z", "1", "theta/2", "r*(thetadot - z)"),)), {"k": 3.0, "r": 2.0},
               lambda t, x, v, z: -3 * z),  # fmt: skip
}  # fmt: skip
READ = {
    "curved": (effect("curved", "theta + q*theta**2 + s", {"q": 0.2, "s": 0.01}, acts_on="sensor"), {"q": 0.2, "s": 0.01},
               lambda t, x: x + 0.2 * x**2 + 0.01),
    "scaled": (effect("scaled", "(1 + q)*theta", {"q": 0.2}, acts_on="sensor"), {"q": 0.2}, lambda t, x: 1.2 * x),
    "late": (effect("late", "t*(1 + q)", {"q": 0.01}, acts_on="clock"), {"q": 0.01}, None),
}  # fmt: skip
FEW = Catalogue(tuple(one[0] for one in (*ALL.values(), *READ.values())))


@pytest.fixture(autouse=True)
def cache(tmp_path_factory, monkeypatch):
    """One for all tests here, whose engine knows these effects alone and compiles soon."""
    monkeypatch.setenv("SWINGDOWN_CACHE", str(tmp_path_factory.getbasetemp() / "few"))
    monkeypatch.setattr(compiler, "FLAGS", ("-O0", *compiler.FLAGS[1:]))


def model(name):
    entry, values, *_ = ALL.get(name) or READ[name]
    return Model(
        name,
        {"natural_frequency": OMEGA} | {f"{name}_{key}": value for key, value in values.items()},
        catalogue=FEW,
    )


def by_hand(name, release, velocity, times=TIMES):
    torque = ALL[name][2] if name in ALL else lambda *_: 0.0

    def moving(t, y):
        x, v, z = y
        inertia = 1 + 0.2 * np.cos(x) ** 2 if name == "heavy" else 1.0
        rate = 2.0 * (v - z) if name == "memory" else 0.0
        return [v, (-(OMEGA**2) * np.sin(x) + torque(t, x, v, z)) / inertia, rate]

    found = solve_ivp(
        moving,
        (0, times[-1]),
        [release, velocity, release / 2],
        "DOP853",
        times,
        rtol=1e-11,
        atol=1e-13,
        max_step=4e-3,
    )
    return found.y[0]


@pytest.mark.parametrize("name", ALL)
def test_a_formula_moves_the_pendulum_as_it_does_by_hand(name):
    for release, velocity in ((0.6, 0.0), (-0.3, 1.0)):
        found = simulate(model(name), TIMES, release, velocity)
        np.testing.assert_allclose(found, by_hand(name, release, velocity), atol=2e-7)


@pytest.mark.parametrize("name", READ)
def test_a_reading_is_made_of_the_angle_and_of_the_time(name):
    found = simulate(model(name), TIMES, 0.6, 0.3)
    late = TIMES * 1.01 if name == "late" else TIMES
    angle = by_hand(name, 0.6, 0.3, late)
    np.testing.assert_allclose(found, angle if name == "late" else READ[name][2](TIMES, angle), atol=2e-7)


@pytest.mark.parametrize("name", [*ALL, *READ])
def test_derivatives_are_what_differences_come_to(name):
    one = model(name)
    free = [*one.parameters, "release_angle", "release_velocity"]
    start = [0.6, 0.3]
    _, slopes = sensitivities(one, TIMES, *start, free)
    values = [*one.vector(), *start]
    for k, (which, slope) in enumerate(zip(free, slopes, strict=True)):
        step = 1e-4 * max(abs(values[k]), 0.1)
        ends = []
        for sign in (1, -1):
            at = list(values)
            at[k] += sign * step
            changed = one.with_values(dict(zip(one.parameters, map(float, at[:-2]), strict=True)))
            ends.append(simulate(changed, TIMES, *map(float, at[-2:])))
        difference = (ends[0] - ends[1]) / (2 * step)
        scale = np.abs(difference).max()
        assert scale > 1e-6, which
        # at a switch and at a reversal a difference has a little of both sides
        np.testing.assert_allclose(slope, difference, atol=2e-3 * scale, err_msg=which)


@pytest.mark.parametrize("name", ["powers", "fraction", "timed", "heavy", "scaled"])
def test_fits_side_by_side_come_back_to_the_values(name):
    """Those of a smooth torque have a motion of their own in C."""
    one = model(name)
    truth = simulate(one, TIMES, 0.6, 0.3)
    start = np.array([*one.vector(), 0.6, 0.3])
    near = start * (1 + 0.01 * np.random.default_rng(1).uniform(-1, 1, (6, start.size)))
    found = fit_batch(one, TIMES, np.tile(truth, (6, 1)), [0.6, 0.3], search=Search(starts=near))
    assert found.converged.all()
    left = np.sqrt(found.rss / TIMES.size)
    assert left.max() < 1e-6
