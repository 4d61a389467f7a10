"""Fits of turning points alone, held against pendulums whose law is known."""

import numpy as np
import pytest
from scipy.optimize import approx_fprime, curve_fit
from scipy.special import ellipk
from scipy.stats import t
from turning import drawn, turning_points

from swingdown.errors import InputError
from swingdown.fitting.turning_points import Turns, Unmet, fit_turns, frequency_of, middle
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


OMEGA, RATIO, FIRST, ZERO, RELEASE = 5.0, 0.01, 3.0, 0.02, 0.4  # of a spring with viscous friction


def by_hand(halves, omega, ratio, release, first=0.0, zero=0.0):
    """Times (s) and angles (rad) of a spring's turning points in closed form."""
    since = halves * np.pi / (omega * np.sqrt(1 - ratio**2))
    return first + since, zero + release * np.exp(-ratio * omega * since) * np.cos(np.pi * halves)


def quiet(seed, deviation, size=40):
    """Noise that takes back each time what it added: least of it is slow, as where none of it is coloured."""
    white = np.random.default_rng(seed).standard_normal(size + 1)
    return deviation * np.diff(white) / np.sqrt(2)


@pytest.mark.parametrize("both", [True, False])
def test_values_and_uncertainties_are_those_of_weighted_least_squares_in_closed_form(both):
    """By another program: weights by what each kind of residuals scatters, less what the fit takes; factors as of Welch and Satterthwaite."""
    halves = np.arange(40) * (1 if both else 2)
    free = ("omega", "ratio", "release", "first", "zero")[: 5 if both else 4]
    truth = dict(zip(free, (OMEGA, RATIO, RELEASE, FIRST, ZERO), strict=False))
    times, angles = by_hand(halves, **truth)
    turns = Turns(times + quiet(1, 2e-3), halves, angles + quiet(2, 1e-3), True, both)
    fit = fit_turns(Model("viscous", restoring="linear"), turns, clock=1e-4)
    scatter, seen = np.array([2e-3, 1e-3]), np.concatenate([turns.times, turns.angles])

    def model(_, *values):
        return np.concatenate(by_hand(halves, **dict(zip(free, values, strict=True))))

    for _ in range(30):
        weights = np.repeat(scatter, 40)
        found, covariance = curve_fit(model, None, seen, [*truth.values()], weights, absolute_sigma=True)
        slopes = approx_fprime(found, lambda x: model(None, *x), 1e-7) / weights[:, np.newaxis]
        leverage = np.einsum("ij,jk,ik->i", slopes, covariance, slopes)
        squares = ((seen - model(None, *found)) ** 2).reshape(2, 40).sum(axis=1)
        freedom = 40 - leverage.reshape(2, 40).sum(axis=1)
        scatter = np.sqrt(squares / freedom)
    assert fit.inflation == 1
    assert fit.scatter == pytest.approx(scatter, rel=2e-3)
    assert fit.rss == pytest.approx(squares, rel=1e-3)
    assert fit.values == pytest.approx(found, rel=1e-4, abs=1e-6)
    assert fit.times == pytest.approx(model(None, *found)[:40], abs=1e-5)
    assert fit.angles == pytest.approx(model(None, *found)[40:], abs=1e-5)
    errors = np.sqrt(np.diag(covariance))
    assert np.sqrt(np.diag(fit.random)) == pytest.approx(errors, rel=5e-3)
    correlations = covariance / np.outer(errors, errors)
    assert fit.random / np.outer(errors, errors) == pytest.approx(correlations, abs=0.01)
    # a variance's freedom: that of times and that of angles, by what each gives of it
    by_kind = [slopes[part] @ covariance for part in (slice(40), slice(40, None))]
    shares = np.array([np.sum(one**2, axis=0) for one in by_kind])
    dof = shares.sum(axis=0) ** 2 / np.sum(shares**2 / freedom[:, np.newaxis], axis=0)
    assert fit.factors == pytest.approx(t.ppf(0.975, dof), rel=1e-3)
    assert fit.systematic == pytest.approx([-found[0] * 1e-4, *[0] * (len(free) - 1)])
    assert fit.covariance[0, 0] == pytest.approx(errors[0] ** 2 + (found[0] * 1e-4) ** 2, rel=0.01)
    assert fit.model.standard_errors["natural_frequency"] == pytest.approx(np.sqrt(fit.covariance[0, 0]))
    likelihood = 40 * np.log(squares / 40).sum()
    assert fit.bic == pytest.approx(likelihood + len(free) * np.log(80), rel=1e-4)
    assert fit.converged


def test_a_count_has_the_clock_of_a_swing_a_second_and_the_scatter_of_its_angles_alone():
    halves = np.arange(40)
    _, angles = by_hand(halves, 2 * np.pi, RATIO, RELEASE)
    fit = fit_turns(
        Model("viscous", restoring="linear"), Turns(halves / 2, halves, angles + quiet(2, 1e-3), False, True)
    )

    def model(at, ratio, release, zero):
        return by_hand(at, 2 * np.pi, ratio, release, zero=zero)[1]

    found, covariance = curve_fit(model, halves, fit.turns.angles, [RATIO, RELEASE, 0.0])
    assert fit.free == ("viscous_ratio", "release_angle", "zero")
    assert fit.values == pytest.approx(found, rel=1e-5, abs=1e-7)
    assert fit.random == pytest.approx(covariance, rel=1e-3)
    assert fit.factors == pytest.approx(t.ppf(0.975, 37))
    squares = np.sum((fit.turns.angles - model(halves, *found)) ** 2)
    assert fit.scatter[1] == pytest.approx(np.sqrt(squares / 37))
    assert fit.bic == pytest.approx(40 * np.log(squares / 40) + 3 * np.log(40))
    assert fit.model.values["natural_frequency"] == pytest.approx(2 * np.pi)


@pytest.mark.parametrize(
    ("stated", "floors"),
    [
        ({"u_times": 0.01, "u_angles": 0.005}, (0.01, 0.005)),
        ({"time_step": 0.02, "angle_step": 0.01}, (0.02 / np.sqrt(12), 0.01 / np.sqrt(12))),
        ({"u_times": 1e-5, "angle_step": 1e-5}, None),
    ],
)
def test_the_scatter_is_nowhere_below_what_is_stated_or_rounded(stated, floors):
    halves = np.arange(40)
    times, angles = by_hand(halves, OMEGA, RATIO, RELEASE)
    turns = Turns(times + quiet(1, 2e-3), halves, angles + quiet(2, 1e-3), True, True)
    model = Model("viscous", restoring="linear")
    assert fit_turns(model, turns._replace(**stated)).scatter == pytest.approx(
        floors or fit_turns(model, turns).scatter
    )


def test_the_frequency_of_the_count_is_that_of_small_swings():
    """A weight's half-swing lasts as long as the elliptic integral says, also where some were not written down."""
    halves, omega = np.array([0, 1, 3, 4, 8, 9]), 5.0
    turns = Turns(2 * ellipk(np.sin(0.6) ** 2) / omega * halves + 7, halves, 1.2 * np.cos(np.pi * halves))
    assert frequency_of(turns, "sine") == pytest.approx(omega, rel=1e-6)
    spring = turns._replace(times=np.pi / omega * halves)
    assert frequency_of(spring, "linear") == pytest.approx(omega, rel=1e-12)


def test_turning_points_that_no_pendulum_has_are_refused():
    halves = np.arange(20)
    with pytest.raises(Unmet, match="no swing of the model viscous meets them"):
        fit_turns(Model("viscous"), Turns(halves * 0.6, halves, 3.5 * np.cos(np.pi * halves), True, True))
