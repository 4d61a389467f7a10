"""A user's fit of one swing goes in segments, side by side: the same minimum as by any other way, or not at all."""

import numpy as np
import pytest
from in_lanes import DIRECTED, RELEASE, SMOOTH
from swings import TIMES

from swingdown.engine import interface
from swingdown.engine.trajectory import sensitivities, simulate
from swingdown.fitting import least_squares
from swingdown.fitting.least_squares import fit_jointly, fit_trajectory
from swingdown.fitting.result import Begin, SwingStart
from swingdown.pendulum.model import Model

BOTH = SMOOTH | DIRECTED


def swing(label, times=TIMES, noise=3e-3, **values):
    """A true model, and its noisy angles (rad)."""
    known = {"natural_frequency": 7.25, "viscous_ratio": 0.02} | BOTH.get(label, {}) | values
    model = Model(label, {name: known[name] for name in Model(label).parameters})
    noise = noise * np.random.default_rng([8, times.size]).standard_normal(times.size)
    return model, simulate(model, times, *RELEASE) + noise


@pytest.fixture
def searches(monkeypatch):
    """The searches by whole trajectories since the test began: one entry each."""
    seen, fit_swings = [], interface.fit_swings

    def told(*given, **options):
        seen.append(given)
        return fit_swings(*given, **options)

    monkeypatch.setattr(interface, "fit_swings", told)
    return seen


def from_truth(model, times, angle, **options):
    """The fit by whole trajectories, from the truth to the very minimum."""
    begin = Begin(model, (SwingStart(model.values, *RELEASE),))
    return fit_trajectory(model.label, times, angle, guess=begin, tolerance=1e-14, **options)


def assert_same(fit, other, times, angle):
    """It is the other's minimum, and more nearly than searches by whole trajectories come to it: a step on moves next to nothing."""
    assert np.abs((fit.values - other.values) / other.standard_errors).max() < 1e-4
    assert fit.standard_errors == pytest.approx(other.standard_errors, rel=1e-6)
    assert fit.rss == pytest.approx(other.rss, rel=1e-10)
    release = fit.only.release_angle, fit.only.release_velocity
    read, slopes = sensitivities(fit.model, times, *release, free=fit.free)
    step = np.linalg.solve(slopes @ slopes.T, slopes @ (angle - read))
    assert np.abs(step / fit.standard_errors).max() < 1e-6


@pytest.mark.parametrize("label", BOTH)
def test_the_minimum_is_that_of_whole_trajectories(label, searches):
    model, angle = swing(label)
    fit = fit_trajectory(label, TIMES, angle)
    assert fit.converged and not searches
    own = simulate(fit.model, TIMES, fit.only.release_angle, fit.only.release_velocity)
    assert np.array_equal(fit.angle, own)
    assert fit.rss == pytest.approx(np.sum((own - angle) ** 2), rel=1e-12)
    assert_same(fit, from_truth(model, TIMES, angle), TIMES, angle)
    assert searches


@pytest.mark.parametrize("label", ["viscous+sensor_zero", "viscous+constant_coulomb"])
@pytest.mark.parametrize("count", range(1000, 1008))
def test_every_sample_counts(label, count, searches):
    """However many are left where the record does not divide into equal segments."""
    times = np.arange(count) / 100
    model, angle = swing(label, times)
    angle[[-1, count // 8, count // 4]] += 0.03  # ten standard deviations, so that they would be missed
    fit = fit_trajectory(model.label, times, angle)
    assert not searches
    assert_same(fit, from_truth(model, times, angle), times, angle)


@pytest.mark.parametrize("rate", [10, 30, 2000], ids="{} a second".format)
def test_few_samples_and_many(rate, searches):
    times = np.arange(20 * rate + 1) / rate
    model, angle = swing("viscous+sensor_zero", times)
    fit = fit_trajectory(model.label, times, angle)
    assert not searches
    assert_same(fit, from_truth(model, times, angle), times, angle)


def test_what_lay_in_memory_before_does_not_matter(searches):
    times = np.arange(1001) / 100
    model, angle = swing("viscous+sensor_zero", times)
    for size in np.random.default_rng(5).integers(10, 20_000, 20):
        left = [np.full(one, np.nan) for one in range(size, size + 20)]
        del left
        fit_trajectory(model.label, times, angle)
    assert not searches


def test_what_the_search_is_given_lives_as_long_as_it(searches, monkeypatch):
    """Whatever else is put into memory meanwhile."""
    _, angle = swing("viscous")
    search = interface.fit_in_segments

    class Crowded:
        """The engine, beside others that write into whatever is free."""

        def __init__(self, library):
            self.library = library

        def fit_in_segments(self, swings, result):
            self.others = [(interface.ffi().new("int[]", [7]), np.full(4, 7.0)) for _ in range(10_000)]
            return self.library.fit_in_segments(swings, result)

    monkeypatch.setattr(
        interface, "fit_in_segments", lambda library, *given: search(Crowded(library), *given)
    )
    fixed = {"viscous_ratio": 0.02}
    fit = fit_trajectory("viscous", TIMES, angle, fixed=fixed)
    assert not searches
    assert fit.rss == pytest.approx(np.sum((fit.angle - angle) ** 2), rel=1e-12)


@pytest.mark.parametrize("degrees", [2, 60, 120])
def test_small_swings_and_large(degrees, searches):
    """Larger ones are slower, and no harmonic."""
    truth = Model("viscous", {"natural_frequency": 7.25, "viscous_ratio": 0.01})
    clean = simulate(truth, TIMES, np.radians(degrees))
    angle = clean + 0.005 * np.ptp(clean) * np.random.default_rng(4).standard_normal(TIMES.size)
    fit = fit_trajectory("viscous", TIMES, angle)
    assert not searches
    other = fit_trajectory("viscous", TIMES, angle, guess=truth, tolerance=1e-14)
    assert_same(fit, other, TIMES, angle)


def test_a_swing_from_rest(searches):
    model, angle = swing("viscous")
    angle = simulate(model, TIMES, 0.5) + angle - simulate(model, TIMES, *RELEASE)
    angle[0] = 0.5
    fit = fit_trajectory("viscous", TIMES, angle, start="rest", fixed={"viscous_ratio": 0.02})
    assert not searches
    assert fit.free == ("natural_frequency",) and fit.only.release_velocity == 0.0
    assert fit.only.release_angle == angle[0]
    other = fit_trajectory(
        "viscous", TIMES, angle, guess=fit, start="rest", fixed={"viscous_ratio": 0.02}, tolerance=1e-14
    )
    assert_same(fit, other, TIMES, angle)


def noise_apart(times=TIMES):
    """Angles of a swing with friction, beside which no smooth model leaves noise."""
    model = Model(
        "viscous+constant_coulomb",
        {"natural_frequency": 7.25, "viscous_ratio": 0.02, "constant_friction": 0.3},
    )
    return simulate(model, times, *RELEASE) + 1e-3 * np.random.default_rng(6).standard_normal(times.size)  # fmt: skip


def irregular():
    """A smooth swing of which one sample comes late."""
    times = TIMES.copy()
    times[500] += 1e-4
    return times, swing("viscous", times)[1]


CASES = {
    "friction that stops it": lambda: ("viscous+constant_coulomb", TIMES, noise_apart()),
    "what the model misses": lambda: ("viscous", TIMES, noise_apart()),
    "irregular times": lambda: ("viscous", *irregular()),
    "too few samples": lambda: ("viscous", TIMES[::20], swing("viscous")[1][::20]),
    "a bound": lambda: ("viscous", TIMES, swing("viscous", viscous_ratio=0.0)[1] * (1 + 5e-4 * TIMES)),
    "a drift": lambda: ("viscous+damping_drift", TIMES, swing("viscous")[1]),
    "no noise": lambda: ("viscous", TIMES, simulate(swing("viscous")[0], TIMES, *RELEASE)),
}


@pytest.mark.parametrize("case", CASES)
def test_all_else_is_fitted_as_ever(case, searches, monkeypatch):
    label, times, angle = CASES[case]()
    fit = fit_trajectory(label, times, angle, bounded=True)
    assert searches
    monkeypatch.setattr(least_squares, "_in_segments", lambda *_: None)
    other = fit_trajectory(label, times, angle, bounded=True)
    assert np.array_equal(fit.values, other.values) and fit.evaluations == other.evaluations


def test_several_swings_are_fitted_as_ever(searches):
    _, angle = swing("viscous")
    assert fit_jointly("viscous", [(TIMES, angle)] * 2).converged
    assert searches


def test_no_more_evaluations_than_allowed(searches):
    _, angle = swing("viscous")
    assert not fit_trajectory("viscous", TIMES, angle, most=2).converged
    assert searches
