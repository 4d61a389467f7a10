"""Readings in steps: the step is found, and what rounding does to fitted values is what it does in simulations."""

import numpy as np
import pytest

from swingdown.engine.trajectory import sensitivities
from swingdown.pendulum.model import Model
from swingdown.quantisation import quantisation_step, rounding

MODEL = Model(
    ("quadratic_drag", "load_coulomb"),
    {"natural_frequency": 7.25, "quadratic_coefficient": 0.0012, "load_friction": 0.0018},
)


def test_steps_of_a_signal():
    x = np.sin(np.arange(5000) / 30)
    assert quantisation_step(np.round(x / 0.003) * 0.003) == pytest.approx(0.003, rel=1e-6)
    assert quantisation_step(x) == 0


def test_a_step_is_found_though_levels_are_missing_or_printed_in_two_ways():
    x = 0.25 * np.round(np.sin(np.arange(900) / 30) / 0.05)
    gaps = x[~np.isin(x, (1.0, 1.25, -3.0))]
    assert quantisation_step(gaps) == pytest.approx(0.25)
    assert quantisation_step(x + 1e-12 * (np.arange(900) % 2)) == pytest.approx(0.25)
    assert quantisation_step(7 + 1000 * x) == pytest.approx(250)
    assert quantisation_step(1e5 * x + 1e-6 * (np.arange(900) % 2)) == pytest.approx(25_000)


def test_what_comes_in_two_levels_in_uneven_ones_or_all_unlike_has_no_step():
    x = np.round(np.sin(np.arange(900) / 30) / 0.05)
    assert quantisation_step(np.sign(x + 0.5)) == 0
    assert quantisation_step(np.cbrt(x)) == 0
    assert quantisation_step(np.append(np.arange(6.0), np.arange(5.0))) == 0  # more than half are levels
    assert quantisation_step(np.append(np.arange(6.0), np.arange(6.0))) == 1


def test_rounding_adds_nothing_where_noise_hides_the_steps():
    slopes = np.stack([np.sin(np.arange(500) / 20), np.ones(500)])
    hidden = rounding(slopes, np.arange(500) / 7, 0.01, noise=0.01)
    assert np.abs(hidden).max() < 1e-6 * 0.01**2 * 500


@pytest.mark.parametrize("ratio", [0.0, 0.1, 0.2])
def test_errors_of_rounding_go_together_as_they_do_over_all_places_of_the_steps(ratio):
    """Each sample's mean error over its noise, multiplied with every other's: the mean over where the steps lie."""
    step, draws = 0.02, np.linspace(-4, 4, 801)
    signal = 0.05 * np.sin(np.arange(300) / 90)
    slopes = np.stack([np.ones(300), np.arange(300) / 150 - 1, np.cos(np.arange(300) / 30)])
    weights = np.exp(-(draws**2) / 2) / np.sum(np.exp(-(draws**2) / 2))
    phases = (np.arange(400) + 0.5) / 400 * step
    near = phases[:, None] + ratio * step * draws  # of a sample so far above a step, its noise
    mean = (step * np.round(near / step) - phases[:, None]) @ weights
    expected = np.zeros((3, 3))
    for offset in phases:
        errors = np.interp((signal - offset) % step, phases, mean, period=step)
        own = slopes * errors
        expected += (np.outer(own.sum(axis=1), own.sum(axis=1)) - own @ own.T) / phases.size
    found = rounding(slopes, signal, step, ratio * step)
    np.testing.assert_allclose(found, expected, atol=0.04 * np.abs(expected).max())
    assert np.abs(expected).max() > 300 * step**2 / 12  # more than independent errors make


@pytest.mark.parametrize("ratio", [0.0, 0.1, 0.25])
def test_the_spread_of_fitted_values_under_rounding_is_foretold(ratio):
    times, step, rng = np.arange(3000) / 200, 0.01, np.random.default_rng(3)
    free = [*MODEL.parameters, "release_angle", "release_velocity"]
    signal, slopes = sensitivities(MODEL, times, 0.47, 0.0, free=free)
    inverse = np.linalg.inv(slopes @ slopes.T)
    shifts = []
    for _ in range(1500):
        offset = rng.uniform(0, step)
        read = step * np.round((signal + ratio * step * rng.standard_normal(times.size) - offset) / step)
        shifts.append(inverse @ slopes @ (read + offset - signal))
    white = step**2 * (1 / 12 + ratio**2)
    foretold = np.diag(white * inverse + inverse @ rounding(slopes, signal, step, ratio * step) @ inverse)
    # where rounding does less than noise would, half of that is kept as a guard
    assert np.all((share := np.var(shifts, axis=0) / foretold) < 1.15)
    assert np.all(share > (0.5 if ratio < 0.1 else 0.85))
    # what independent errors would do is far off where steps are coarse, and about right where noise hides them
    alone = np.var(shifts, axis=0) / np.diag(white * inverse)
    assert (np.max(alone) > 1.5) == (ratio < 0.2)


def test_levels_in_no_steps_and_steps_that_are_left_out():
    """A signal that takes few values has steps only where these are multiples of one; of some of them nothing may be read."""
    rng = np.random.default_rng(1)
    irregular = np.cumsum(rng.uniform(0.5, 1.9, 40))
    assert quantisation_step(irregular[rng.integers(0, 40, 2000)]) == 0
    levels = 0.25 * np.array([0, 1, 2, 3, 5, 6, 9, 10, 11, 12, 20, 21])
    assert quantisation_step(levels[rng.integers(0, 12, 500)]) == pytest.approx(0.25)
    assert quantisation_step(np.tile([0.0, 1.0], 50)) == 0  # two levels are no steps
    assert quantisation_step(np.tile([0.0, 1.0, 2.0], 50)) == 1
    assert (
        quantisation_step(0.5 * np.arange(100)) == 0
    )  # where each level is there once, it may as well be a rate
    fine = np.round(np.sin(np.arange(20_000) / 30) / 4e-4) * 4e-4  # of thousands of steps
    assert quantisation_step(fine) == pytest.approx(4e-4, rel=1e-6)
    # printed or computed twice, a level is one level
    assert quantisation_step(np.tile([0.0, 1.0, 1.0 + 1e-14, 2.0], 50)) == pytest.approx(1)


@pytest.mark.parametrize("ratio", [0.0, 0.15, 0.3])
@pytest.mark.parametrize("reach", [0.3, 2.0])
def test_rounding_errs_as_its_mean_error_over_all_places_of_the_steps(ratio, reach):
    """Of a signal that stays within a part of a step, or crosses some: the mean error beneath the noise, by quadrature, at each place."""
    step, size = 0.02, 60
    signal = step * reach * np.linspace(0, 1, size) ** 2
    slopes = (1 + np.linspace(0, 1, size))[np.newaxis]
    places = step * (np.arange(4000) + 0.5) / 4000
    noise, weight = np.polynomial.hermite_e.hermegauss(200)
    x = np.linspace(0, 1, 2001)[:-1]  # of a step
    moved = x[:, np.newaxis] + ratio * noise
    error = (np.round(moved) - moved) @ weight / weight.sum()
    at = ((signal - places[:, np.newaxis]) / step) % 1
    summed = step * np.interp(at, np.append(x, 1.0), np.append(error, error[0])) @ slopes[0]
    own = np.mean(error**2) * step**2 * np.sum(slopes**2)  # of each sample alone, which counts as noise does
    found = rounding(slopes, signal, step, ratio * step)[0, 0]
    least = -0.5 * step**2 / 12 * np.sum(slopes**2)
    assert found == pytest.approx(max(np.mean(summed**2) - own, least), rel=0.03, abs=0.02 * abs(least))


def test_no_direction_is_left_with_less_than_half_of_its_noise():
    """Samples spread evenly over a step err less together than noise would: of that half is kept."""
    step, size = 0.01, 400
    slopes = np.array([np.ones(size), 3 + np.cos(np.linspace(0, 2 * np.pi, size, endpoint=False))])
    found = rounding(slopes, 5 * step * np.arange(size) / size * 7, step, 0.0)
    assert found == pytest.approx(-0.5 * step**2 / 12 * slopes @ slopes.T, rel=1e-6)
