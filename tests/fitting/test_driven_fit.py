"""Fits of driven swings: parameters come back within their errors, the input sensor's gain and delay among them."""

import numpy as np
import pytest

from swingdown.arrays import swing_under
from swingdown.engine.trajectory import simulate
from swingdown.errors import InputError
from swingdown.fitting.batch import fit_batch
from swingdown.fitting.driven import driven_guesses
from swingdown.fitting.least_squares import fit_jointly
from swingdown.pendulum.drive import drive
from swingdown.pendulum.model import Model

TIMES = 5.0 + 0.02 * np.arange(1500)
FORCE = np.sin(2 * np.pi * 0.7 * TIMES) + 0.8 * np.sin(2 * np.pi * 1.13 * TIMES + 1.0)
NOISE = 1e-3  # rad
CASES = {
    "torque": ("viscous+quadratic_drag", "sine", 2.0),
    "pivot_acceleration": ("viscous+quadratic_drag", "sine", 0.05),
    "pivot_position": ("viscous", "sine", 0.02),
    "pivot_angle": ("viscous+constant_coulomb", "linear", 0.05),
}
VALUES = {
    "natural_frequency": 7.0, "viscous_ratio": 0.02, "quadratic_coefficient": 0.05, "constant_friction": 0.1, "input_delay": 0.013,
}  # fmt: skip


def made(kind):
    effects, restoring, gain = CASES[kind]
    under = drive(TIMES, FORCE, kind, free=("gain", "delay"))
    model = Model(f"{effects}+{under.effect}", restoring=restoring, drive=under)
    known = VALUES | {f"{kind}_gain": gain}
    return model.with_values({name: known[name] for name in model.parameters})


def recorded(model, seed, times=TIMES):
    return simulate(model, times, 0.3, 0.1) + NOISE * np.random.default_rng(seed).standard_normal(times.size)


@pytest.mark.parametrize("kind", CASES)
def test_pulls_are_those_of_the_stated_errors(kind):
    """Thirty swings: a pull is what a value is off by, over its error; together they scatter by 1."""
    model, pulls = made(kind), []
    truth = model.values | {"release_angle": 0.3, "release_velocity": 0.1}
    for seed in range(30):
        fit = fit_jointly(model.with_values({}), [swing_under(model.drive, TIMES, recorded(model, seed))])
        assert fit.converged and fit.rms == pytest.approx(NOISE, rel=0.1)
        pulls.append((fit.values - [truth[name] for name in fit.free]) / fit.standard_errors)
    scatter = np.sqrt(np.mean(np.square(pulls)))
    assert scatter == pytest.approx(
        1.0, abs=4 / np.sqrt(2 * np.size(pulls) / 3)
    )  # values of a fit are not independent


def test_several_swings_share_their_values_and_have_each_its_drive():
    model = made("torque")
    other = drive(TIMES, np.cos(2 * np.pi * 0.9 * TIMES), "torque", free=("gain", "delay"))
    swings = [
        swing_under(one, TIMES, recorded(model.driven_by(one), seed))
        for seed, one in enumerate((model.drive, other))
    ]
    fit = fit_jointly(model.with_values({}), swings)
    assert fit.rms == pytest.approx(NOISE, rel=0.1)
    assert [one.model.drive for one in fit.swings] == [model.drive, other]
    assert fit.model.values["torque_gain"] == pytest.approx(2.0, rel=0.01)


def test_many_at_once_are_driven_by_the_clock_of_the_drive():
    """Theirs begins at 5 s; a delay would hide another beginning."""
    model = made("torque")
    under = drive(TIMES, FORCE, "torque", free=("gain",))
    values = {name: value for name, value in model.values.items() if name != "input_delay"}
    model = Model(f"viscous+quadratic_drag+{under.effect}", values, drive=under)
    found = fit_batch(model, TIMES, np.stack([recorded(model, seed) for seed in (1, 2)]), (0.3, 0.1))
    assert found.rss == pytest.approx(TIMES.size * NOISE**2, rel=0.2)


def test_a_guess_needs_no_peaks():
    """Of a drive far from resonance, with the swing's own crossings uneven, the equation of motion tells the frequency."""
    model = made("torque")
    seen = driven_guesses(model, TIMES, recorded(model, 1), model.drive)
    assert min(abs(one["natural_frequency"] - 7.0) for one in seen) < 0.1
    assert min(abs(one["torque_gain"] - 2.0) for one in seen) < 0.05


def test_a_drive_acts_on_angles_alone():
    model = made("torque")
    rates = recorded(model.of("rate"), 1)
    with pytest.raises(InputError, match="angular rates do not show the angle"):
        fit_jointly(model.of("rate").with_values({}), [swing_under(model.drive, TIMES, rates)])
