"""Fits of turning points alone, held against pendulums whose law is known."""

import numpy as np
import pytest
from turning import drawn, turning_points

from swingdown.errors import InputError
from swingdown.fitting.turning_points import Turns, fit_turns, middle
from swingdown.pendulum.model import Model
from swingdown.quantisation import rounding

EFFECTS = {
    "viscous_ratio": "viscous",
    "quadratic_coefficient": "quadratic_drag",
    "load_friction": "load_coulomb",
}


def model_of(values):
    """The model with the effects that these values are of."""
    return Model(tuple(EFFECTS[name] for name in values if name in EFFECTS))


def read(times, angles, draws, deviations, both):
    """Turning points as somebody reads them: with scatter, of one side or both, which begin at any time."""
    halves = np.arange(times.size)[:: 1 if both else 2]
    times = times[halves] + 5 + deviations[0] * draws.standard_normal(halves.size)
    return Turns(
        times, halves, angles[halves] + deviations[1] * draws.standard_normal(halves.size), True, both
    )


@pytest.mark.parametrize("restoring", ["sine", "linear"])
def test_without_scatter_the_values_come_back(restoring):
    if restoring == "linear":  # known in closed form
        halves = np.arange(30)
        times, angles = halves * np.pi / (5 * np.sqrt(1 - 0.01**2)), 0.4 * (-1.0) ** halves
        angles *= np.exp(-0.01 * 5 * times)
        values = {"natural_frequency": 5.0, "viscous_ratio": 0.01}
    else:
        values = {"natural_frequency": 5.0, "viscous_ratio": 0.004, "load_friction": 0.002}
        times, angles = turning_points(values, 1.0, 30)
    model = Model(model_of(values).names, restoring=restoring)
    fit = fit_turns(model, Turns(times, np.arange(30), angles, True, True))
    found = dict(zip(fit.free, fit.values, strict=True))
    for name, value in values.items():
        assert found[name] == pytest.approx(value, rel=1e-5)
    assert found["zero"] == pytest.approx(0, abs=1e-7)
    assert found["first"] == pytest.approx(0, abs=1e-6)


def test_a_pendulum_that_is_counted_has_its_damping_and_no_frequency():
    values = {"natural_frequency": 2 * np.pi, "load_friction": 0.003}
    _, angles = turning_points(values, 0.5, 40)
    halves = np.arange(40)
    fit = fit_turns(Model("load_coulomb"), Turns(halves / 2, halves, angles, False, True))
    assert "natural_frequency" not in fit.free
    assert dict(zip(fit.free, fit.values, strict=True))["load_friction"] == pytest.approx(0.003, rel=1e-5)


def test_a_scale_whose_zero_is_off_is_told_from_both_sides():
    draws = np.random.default_rng(4)
    values = {"natural_frequency": 4.0, "viscous_ratio": 0.005}
    turns = read(*turning_points(values, 0.4, 40), draws, (0.005, 0.001), True)
    fit = fit_turns(Model("viscous"), turns._replace(angles=turns.angles + 0.03))
    assert dict(zip(fit.free, fit.values, strict=True))["zero"] == pytest.approx(0.03, abs=1e-3)


def test_intervals_hold_the_truth_as_often_as_they_say():
    inside = []
    for number in range(60):
        draws = np.random.default_rng((7, number))
        values, (times, angles), deviations = drawn(draws)
        fit = fit_turns(model_of(values), read(times, angles, draws, deviations, bool(number % 2)))
        off = dict(
            zip(
                fit.free,
                zip(fit.values, np.sqrt(np.diag(fit.random)) * fit.factors, strict=True),
                strict=True,
            )
        )
        inside += [abs(off[name][0] - value) < off[name][1] for name, value in values.items()]
    # a tenth of 95 % intervals outside would be less likely than 1 in 100
    assert np.mean(inside) > 0.9


def test_what_rounding_adds_is_beside_the_scatter_that_it_leaves():
    """Of errors that are three quarters rounding the rest scatters by half of them, and that blurs the steps."""
    rng, count = np.random.default_rng(1), 60
    slopes, place = rng.standard_normal((count, 2)), np.linspace(0.0, 30.0, count)
    found, slow = middle(slopes, rng.standard_normal(count), 3.0, place)
    assert slow == 1.0
    assert found == pytest.approx(slopes.T @ slopes + rounding(slopes.T, place, 3.0, 0.5))


def test_too_few_are_refused_in_words():
    with pytest.raises(InputError, match="there are 3"):
        fit_turns(
            Model("viscous"), Turns(np.arange(3.0), np.arange(3), np.array([0.3, -0.29, 0.28]), True, True)
        )


def test_a_fit_takes_few_evaluations():
    values = {"natural_frequency": 5.0, "viscous_ratio": 0.002, "quadratic_coefficient": 0.004}
    times, angles = turning_points(values, 0.5, 200)
    turns = read(times, angles, np.random.default_rng(5), (1e-3, 1e-3), True)
    small = fit_turns(Model("viscous"), turns)
    large = fit_turns(model_of(values), turns, [small.known])
    assert large.known["viscous_ratio"] == pytest.approx(0.002, rel=0.1)
    assert large.evaluations < 30  # each takes some trajectories of all its swings
