"""Fits side by side in the processor's lanes: the same optimum as one by one, and no fit that another one changes."""

import shutil

import in_lanes
import numpy as np
import pytest
from in_lanes import RELEASE
from swings import TIMES

from swingdown.engine import build, interface
from swingdown.engine.trajectory import sensitivities, simulate
from swingdown.errors import InputError
from swingdown.fitting.batch import Search, fit_batch
from swingdown.fitting.least_squares import fit_trajectory
from swingdown.fitting.result import Begin, SwingStart
from swingdown.pendulum.catalogue import SHIPPED
from swingdown.pendulum.model import Model

SMOOTH = in_lanes.SMOOTH | {
    "viscous+damping_drift+sensor_zero": {"damping_drift": 0.5, "sensor_zero": 0.01},
    "viscous+base_vibration": {
        "vibration_acceleration": 2.0,
        "vibration_frequency": 3.0,
        "vibration_phase": 0.3,
    },
}
DIRECTED = in_lanes.DIRECTED | {"constant_coulomb": {"constant_friction": 0.05}}
BOTH = SMOOTH | DIRECTED
FULL = "viscous+quadratic_drag+load_coulomb+sensor_zero"
IRREGULAR = np.sort(np.random.default_rng(5).uniform(0.0, 10.0, 700))
SPARSE = np.arange(0.0, 10.0, 0.13)
CLOSE = Search(tolerance=1e-13)


def model(label):
    viscous = {"viscous_ratio": 0.02} if "viscous" in label else {}
    return Model(label, {"natural_frequency": 7.25} | viscous | BOTH[label])


def noisy(label, times=TIMES, count=20, noise=3e-3, release=RELEASE):
    clean = simulate(model(label), times, *release)
    return clean + noise * np.random.default_rng([3, len(label)]).standard_normal((count, times.size))


def from_guess(guess, times, angle, **options):
    """The fit of one series by itself, from where a batch starts."""
    begin = Begin(guess, (SwingStart(guess.values, *RELEASE),))
    return fit_trajectory(
        guess.label, times, angle, guess=begin, seen=False, grown=False, tolerance=1e-13, **options
    )


@pytest.mark.parametrize("times", [TIMES, IRREGULAR, SPARSE], ids=["even", "irregular", "sparse"])
@pytest.mark.parametrize("label", BOTH)
def test_the_optimum_is_that_of_a_fit_by_itself(label, times):
    series, guess = noisy(label, times, count=3), model(label)
    many = fit_batch(guess, times, series, RELEASE, search=CLOSE)
    assert not many.alone.any() and many.converged.all()
    for angle, values, rss in zip(series, many.values, many.rss, strict=True):
        alone = from_guess(guess, times, angle)
        assert rss == pytest.approx(alone.rss, rel=1e-6)
        determined = np.isfinite(alone.standard_errors)
        assert np.abs((values - alone.values) / alone.standard_errors)[determined].max() < 1e-4


@pytest.mark.parametrize("velocity", [0.1, -0.3, 1e-4, 2.0])
@pytest.mark.parametrize("label", ["viscous+quadratic_drag", "viscous+constant_coulomb"])
def test_pushed_at_the_release(label, velocity):
    """A push away from rest turns the pendulum at once: a half-swing much shorter than the others."""
    values = {
        "viscous": "viscous_ratio",
        "quadratic_drag": "quadratic_coefficient",
        "constant_coulomb": "constant_friction",
    }
    true = Model(label, {"natural_frequency": 7.25} | {values[name]: 0.02 for name in label.split("+")})
    fit = fit_batch(true, TIMES, simulate(true, TIMES, 0.5, velocity)[None], (0.5, velocity), search=CLOSE)
    assert fit.values[0] == pytest.approx([*true.vector(), 0.5, velocity], abs=1e-7)
    assert not fit.alone[0] and np.sqrt(fit.rss[0] / TIMES.size) < 5e-9 * 0.5


STOPPED = [
    Model("constant_coulomb", {"natural_frequency": 7.25, "constant_friction": 2.0}),
    Model("viscous+load_coulomb", {"natural_frequency": 7.25, "viscous_ratio": 0.03, "load_friction": 0.01}),
]


@pytest.mark.parametrize("start", ["free", "rest"])
@pytest.mark.parametrize("true", STOPPED, ids=lambda true: true.label)
def test_a_pendulum_that_friction_stops_has_the_optimum_of_a_fit_by_itself(true, start):
    release = (0.5, 0.2) if start == "free" else (0.5, 0.0)
    clean = simulate(true, TIMES, *release)
    assert np.ptp(clean[-100:]) == 0.0
    series = clean + 1e-3 * np.random.default_rng(1).standard_normal((9, TIMES.size))
    fit = fit_batch(true, TIMES, series, release, start=start, search=CLOSE)
    assert not fit.alone.any() and fit.converged.all()
    begin = Begin(true, (SwingStart(true.values, *release),))
    for angle, rss in zip(series, fit.rss, strict=True):
        alone = fit_trajectory(true, TIMES, angle, start=start, guess=begin, seen=False, grown=False)
        assert rss == pytest.approx(alone.rss, rel=1e-6)


@pytest.mark.parametrize("release", [RELEASE, (0.5, 0.0)])
@pytest.mark.parametrize("label", ["viscous+sensor_zero", FULL, "load_coulomb", "eccentricity"])
def test_how_far_fits_are_from_a_reference(label, release):
    values = (
        {"load_friction": 0.02}
        if label == "load_coulomb"
        else {"eccentricity": 0.01, "eccentricity_phase": 0.8}
    )
    true = model(label) if label in BOTH else Model(label, {"natural_frequency": 7.25} | values)
    truth = simulate(true, TIMES, *release)
    series = truth + 3e-3 * np.random.default_rng(4).standard_normal((5, TIMES.size))
    for foretells in (False, True):
        fit = fit_batch(
            true, TIMES, series, release, search=Search(reference=truth, tolerance=1e-7, foretells=foretells)
        )
        assert fit.alone.all() == (label == "eccentricity")
        for values, off in zip(fit.values, fit.off, strict=True):
            found = simulate(
                true.with_values(dict(zip(true.parameters, map(float, values), strict=False))),
                TIMES,
                *map(float, values[-2:]),
            )
            assert off == pytest.approx(
                np.sqrt(np.mean((found - truth) ** 2)), rel=1e-3 if foretells else 1e-9, abs=1e-9
            )
    assert fit_batch(true, TIMES, series, release).off is None


@pytest.mark.parametrize("label", ["viscous+sensor_zero", FULL, "constant_coulomb"])
def test_a_last_step_that_is_foretold_ends_at_the_same_optimum_sooner(label):
    series, guess = noisy(label), model(label)
    exact = fit_batch(guess, TIMES, series, RELEASE, search=CLOSE)
    sooner = fit_batch(
        guess,
        TIMES,
        series,
        RELEASE,
        search=Search(tolerance=1e-4 / TIMES.size, foretells=True, coarseness=100),
    )
    assert sooner.converged.all() and not sooner.alone.any()
    assert sooner.evaluations.mean() <= exact.evaluations.mean() - 1
    errors = np.std(exact.values, axis=0)  # of 20 draws: the standard errors, nearly
    assert np.abs((sooner.values - exact.values) / errors).max() < 0.02
    assert np.abs(sooner.rss / exact.rss - 1).max() < 1e-3 / TIMES.size


def test_each_fit_may_start_elsewhere():
    label = FULL
    series, guess = noisy(label), model(label)
    near = [*guess.vector(), *RELEASE]
    starts = np.tile(near, (len(series), 1)) * np.linspace(0.97, 1.03, len(series))[:, np.newaxis]
    one = fit_batch(guess, TIMES, series, RELEASE, search=CLOSE)
    other = fit_batch(guess, TIMES, series, RELEASE, search=Search(tolerance=1e-13, starts=starts))
    assert other.converged.all() and not np.array_equal(one.evaluations, other.evaluations)
    assert other.rss == pytest.approx(one.rss, rel=1e-9)
    lone = fit_batch(guess, TIMES, series[3:4], RELEASE, search=Search(tolerance=1e-13, starts=starts[3:4]))
    assert np.array_equal(lone.values[0], other.values[3])


def test_the_curvature_of_a_model_that_does_not_fit_saves_steps():
    """Quadratic drag for viscous friction: the misfit is far above the noise, and J'J alone creeps towards the minimum."""
    times = np.arange(0.0, 40.0, 0.02)
    truth = simulate(Model("viscous", {"natural_frequency": 7.25, "viscous_ratio": 0.03}), times, 0.17)
    guess = Model("quadratic_drag", {"natural_frequency": 7.25, "quadratic_coefficient": 0.15})
    best = fit_batch(guess, times, truth[None], (0.2, -0.1), search=CLOSE)
    near = guess.with_values(dict(zip(guess.parameters, map(float, best.values[0]), strict=False)))
    release = tuple(map(float, best.values[0, 2:]))

    def gradient(values):
        at = near.with_values(dict(zip(near.parameters, map(float, values), strict=False)))
        angles, slopes = sensitivities(at, times, *map(float, values[2:]))
        return slopes @ (angles - truth), slopes @ slopes.T

    at = best.values[0]
    normal = gradient(at)[1]
    steps = 1e-3 * np.sqrt(best.rss[0] / times.size / normal.diagonal())
    whole = np.array([(gradient(at + step)[0] - gradient(at - step)[0]) / (2 * size)
                      for step, size in zip(np.diag(steps), steps, strict=True)])  # fmt: skip
    series = truth + 1e-3 * np.random.default_rng(9).standard_normal((16, times.size))
    plain, informed = (
        fit_batch(near, times, series, release, search=Search(tolerance=1e-8, curvature=curvature))
        for curvature in (None, (whole + whole.T) / 2 - normal)
    )
    assert plain.converged.all() and informed.converged.all()
    assert informed.rss == pytest.approx(plain.rss, rel=1e-7)
    assert informed.evaluations.mean() < 0.7 * plain.evaluations.mean()


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("starts", np.zeros((2, 4))),
        ("starts", np.full((3, 5), np.nan)),
        ("reference", np.zeros(3)),
        ("reference", np.full(TIMES.size, np.inf)),
        ("curvature", np.zeros((2, 2))),
    ],
)
def test_arrays_of_other_shapes_or_not_finite_are_refused(name, value):
    series = noisy("viscous+sensor_zero", count=3)
    with pytest.raises(InputError, match=name):
        fit_batch(model("viscous+sensor_zero"), TIMES, series, RELEASE, search=Search(**{name: value}))


@pytest.mark.parametrize("degrees", [5, 20, 60, 100, 140])
def test_a_model_fitted_to_itself_comes_back(degrees):
    true, release = model("viscous+sensor_zero"), (np.radians(degrees), 0.1)
    fit = fit_batch(true, TIMES, simulate(true, TIMES, *release)[None], (0.999 * release[0], 0.1))
    assert not fit.alone[0]
    assert fit.values[0] == pytest.approx([*true.vector(), *release], abs=1e-8)
    assert np.sqrt(fit.rss[0] / TIMES.size) < 5e-9 * release[0]


@pytest.mark.parametrize("label", ["viscous+sensor_zero", FULL])
def test_a_hopeless_series_harms_no_other(label):
    series, rng = noisy(label), np.random.default_rng(7)
    rough = series.copy()
    rough[3], rough[11] = 10 * rng.standard_normal(TIMES.size), 1e6 * np.sin(40 * TIMES)
    rough[12] = 0.0
    good, mixed = (fit_batch(model(label), TIMES, each, RELEASE) for each in (series, rough))
    others = np.setdiff1d(np.arange(len(series)), [3, 11, 12])
    assert not good.alone.any()
    assert np.array_equal(good.values[others], mixed.values[others])
    assert np.array_equal(good.rss[others], mixed.rss[others])
    assert np.array_equal(good.evaluations[others], mixed.evaluations[others])
    for k in (3, 11, 12):  # and what becomes of it depends on nothing else either
        lone = fit_batch(model(label), TIMES, rough[k][None], RELEASE)
        assert np.array_equal(lone.values[0], mixed.values[k], equal_nan=True)


@pytest.mark.parametrize("label", ["viscous+sensor_zero", FULL, "constant_coulomb"])
@pytest.mark.parametrize(
    "options",
    [{}, {"start": "rest"}, {"search": Search(bounded=True, tolerance=1e-6)}, {"search": Search(most=3)},
     {"search": Search(tolerance=1e-6, foretells=True, coarseness=100)}],
)  # fmt: skip
def test_a_batch_of_one_has_the_same_bits(options, label):
    series = noisy(label, count=11)
    release = 0.48, 0.0 if "start" in options else 0.2
    together = fit_batch(model(label), TIMES, series, release, **options)
    for k in range(len(series)):
        lone = fit_batch(model(label), TIMES, series[k : k + 1], release, **options)
        assert np.array_equal(lone.values[0], together.values[k])
        assert lone.rss[0] == together.rss[k] and lone.evaluations[0] == together.evaluations[k]


def test_bounds_are_kept():
    label = "viscous+sensor_zero"
    series = simulate(Model("sensor_zero", {"natural_frequency": 7.25, "sensor_zero": 0.01}), TIMES, *RELEASE)
    rng = np.random.default_rng(2)
    series = series + 3e-3 * rng.standard_normal((20, TIMES.size))
    fit = fit_batch(model(label), TIMES, series, RELEASE, search=Search(bounded=True))
    damping = fit.values[:, 1]
    assert fit.converged.all() and damping.min() == 0.0 and 4 <= np.sum(damping == 0.0) <= 16


@pytest.mark.parametrize("label", ["viscous+sensor_zero", FULL])
def test_a_guess_far_off_finds_the_optimum(label):
    series, near = noisy(label), model(label)
    far = near.with_values(near.values | {"natural_frequency": 7.4, "viscous_ratio": 0.06})
    one, other = (fit_batch(each, TIMES, series, RELEASE, search=CLOSE) for each in (near, far))
    assert other.converged.all()
    assert other.values == pytest.approx(one.values, rel=1e-6, abs=1e-7)


def test_other_models_are_fitted_one_by_one():
    true = Model("viscous+eccentricity", {"natural_frequency": 7.25, "viscous_ratio": 0.02, "eccentricity": 0.01, "eccentricity_phase": 0.8})  # fmt: skip
    series = simulate(true, TIMES, *RELEASE) + 1e-3 * np.random.default_rng(1).standard_normal(
        (2, TIMES.size)
    )
    fit = fit_batch(true, TIMES, series, RELEASE)
    assert fit.alone.all()


EFFECTS, GRAVITIES = (SHIPPED["viscous"], SHIPPED["constant_coulomb"]), tuple(SHIPPED.gravity.values())


def test_the_number_of_lanes_changes_no_bit(tmp_path, monkeypatch):
    interface.ffi()  # from the usual cache
    gcc = shutil.which("gcc")
    if gcc is None:
        pytest.skip("gcc is not installed")
    found = []
    for given in ("", "-mno-avx512f -mno-avx"):
        monkeypatch.setenv("SWINGDOWN_CACHE", str(tmp_path / f"cache{len(found)}"))
        program = tmp_path / f"compiler{len(found)}"
        program.write_text(f'#!/bin/sh\nexec {gcc} "$@" {given} -O1\n')
        program.chmod(0o755)
        monkeypatch.setenv("CC", str(program))
        library = interface.ffi().dlopen(str(build.library(EFFECTS, GRAVITIES)))
        found.append([*batch_by(library, 0), *batch_by(library, 1)])
    for one, other in zip(*found, strict=True):
        assert np.array_equal(one, other)


def batch_by(library, effect):
    """Values, sums of squares and evaluations of fits with one of ``EFFECTS`` by an engine that knows them."""
    label = ("viscous", "constant_coulomb")[effect]
    series, first = noisy(label, count=11), np.array([7.2, 0.03, 0.5, 0.2])
    places = [(0, 1, 0), (2 + effect, 1, 0)]
    placed = interface.model(interface.Layout(places, n_parameters=2), 10.0)
    counts = np.zeros((3, 11), dtype=np.int32)
    result = interface.BatchResult(np.zeros((11, 4)), np.zeros(11), *counts)
    bounds = interface.Bounds(np.full(4, -np.inf), np.full(4, np.inf))
    where = np.arange(4, dtype=np.int32)
    common = interface.Batch(placed, TIMES, first, where, bounds)
    options = interface.Options(100, 1e-10)
    interface.fit_batch(library, common, series, np.tile(first, (11, 1)), options, result)
    assert not result.alone.any() and np.all(result.converged == 1)
    return result.values, result.rss, result.evaluations


def test_no_series_have_no_fits():
    fit = fit_batch(model(FULL), SPARSE, np.empty((0, SPARSE.size)), RELEASE)
    assert fit.values.shape == (0, 7) and fit.converged.size == 0
