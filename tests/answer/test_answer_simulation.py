"""The swing of a model with values of one's own."""

import numpy as np
import pytest

from swingdown.answer.simulation import simulate
from swingdown.engine.trajectory import simulate as trajectory
from swingdown.errors import InputError
from swingdown.pendulum.model import Model

TIMES = np.arange(500) / 50
VALUES = {"natural_frequency": 7.25, "viscous_ratio": 0.01}
MODEL = Model("viscous", VALUES)


def test_a_label_or_its_effects_with_values_are_the_model():
    expected = trajectory(MODEL, TIMES, 0.35)
    for model in ("viscous", ["viscous"]):
        assert np.array_equal(simulate(model, TIMES, 0.35, **VALUES).values, expected)
    found = simulate(MODEL, TIMES, 0.35)
    assert np.array_equal(found.values, expected) and np.array_equal(found["time"].values, TIMES)
    assert (found.name, found.attrs["units"], found.attrs["emulated"], found["time"].attrs["units"]) == (
        "angle",
        "rad",
        "yes",
        "s",
    )


def test_values_given_replace_those_of_the_model_and_it_may_begin_in_motion():
    other = trajectory(MODEL.with_values(VALUES | {"viscous_ratio": 0.02}), TIMES, 0.35, 1.5)
    assert np.array_equal(simulate(MODEL, TIMES, 0.35, velocity=1.5, viscous_ratio=0.02).values, other)


def test_a_wheel_swings_further_than_half_a_turn_and_a_pendulum_does_not():
    assert simulate("viscous", TIMES, 4.0, restoring="linear", **VALUES).values[0] == pytest.approx(4.0)
    for angle in (np.pi, -4.0, 20):
        with pytest.raises(InputError, match="more than half a turn"):
            simulate("viscous", TIMES, angle, **VALUES)
    assert simulate("viscous", TIMES, -3.0, **VALUES).values[0] == pytest.approx(-3.0)


def test_noise_is_as_large_as_asked_and_the_same_for_one_seed():
    clean = simulate(MODEL, TIMES, 0.35)
    noisy = [simulate(MODEL, TIMES, 0.35, noise=0.01, seed=seed).values for seed in (3, 3, 4)]
    assert np.array_equal(noisy[0], noisy[1]) and not np.array_equal(noisy[0], noisy[2])
    assert np.std(noisy[0] - clean.values) == pytest.approx(0.01, rel=0.1)
    for bad in (-0.01, np.nan):
        with pytest.raises(InputError, match="0 or more"):
            simulate(MODEL, TIMES, 0.35, noise=bad)


def test_of_a_rate_the_swing_is_one_of_rates():
    found = simulate(MODEL.of("rate"), TIMES, 0.35)
    assert (found.name, found.attrs["units"]) == ("rate", "rad/s") and found.values[0] == pytest.approx(0.0)


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"viscous_ratio": np.nan}, "not finite"),
        ({"viscosity": 1.0}, "viscosity"),
        *(({"natural_frequency": one}, "rad/s above 0") for one in (-7.25, 0.0, np.nan)),
        ({"input": np.ones(500), "input_kind": "wind"}, "wind"),
    ],
)
def test_what_no_pendulum_has_is_refused(changed, words):
    with pytest.raises(InputError, match=words):
        simulate(MODEL, TIMES, 0.35, **changed)


def test_a_frequency_of_an_effect_is_above_0_too():
    values = VALUES | {"vibration_acceleration": 0.1, "vibration_phase": 0.0, "vibration_frequency": -3.0}
    with pytest.raises(InputError, match="vibration_frequency: it is -3. Expected: a number of Hz above 0"):
        simulate("viscous+base_vibration", TIMES, 0.35, **values)


def test_a_measured_drive_acts_and_its_gain_is_a_value_like_others():
    force = 0.5 * np.sin(7 * TIMES)
    under = {"input": force, "input_kind": "torque", "restoring": "linear"}
    once = simulate("viscous", TIMES, 0.0, **VALUES, **under, input_unit="rad/s^2").values
    twice = simulate("viscous", TIMES, 0.0, **VALUES, **under, input_free="gain", torque_gain=2.0).values
    assert np.abs(once).max() > 0.05 and twice == pytest.approx(2 * once, abs=1e-9)
    with pytest.raises(InputError, match="values of the drive"):
        simulate("viscous", TIMES, 0.0, **VALUES, input_kind="torque")
