"""Standard errors for autocorrelated residuals, held to the scatter of fits to many noisy copies."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lfilter
from scipy.special import ndtr

from swingdown.engine.trajectory import simulate
from swingdown.fitting.coloured_noise import autoregression, lines_of
from swingdown.fitting.least_squares import fit_jointly, fit_trajectory
from swingdown.fitting.uncertainty import Uncertainty, half_widths, uncertainty
from swingdown.pendulum.model import Model

TIMES = np.arange(1000) / 50
CLEAN = simulate(Model("viscous", {"natural_frequency": 6.0, "viscous_ratio": 0.01}), TIMES, 0.3)

HUMMED = Model(
    "quadratic_drag+load_coulomb",
    {"natural_frequency": 7.25, "quadratic_coefficient": 0.02, "load_friction": 0.0018},
)


def noise(number, memory):
    rng = np.random.default_rng([5, number])
    white = rng.standard_normal(TIMES.size + 200)
    return 1e-3 * lfilter([np.sqrt(1 - memory**2)], [1, -memory], white)[200:]


@pytest.mark.parametrize(("memory", "ordinary_is_good"), [(0.0, True), (0.5, False), (0.95, False)])
def test_errors_are_those_of_repeated_fits(memory, ordinary_is_good):
    swings = [(TIMES, CLEAN + noise(number, memory)) for number in range(300)]
    fits = [fit_trajectory("viscous", *swing) for swing in swings]
    scatter = np.std([fit.values for fit in fits], axis=0, ddof=1)
    found = [np.diag(uncertainty(fit, [swing]).random) for fit, swing in zip(fits, swings, strict=True)]
    ordinary = np.sqrt(np.mean([np.diag(fit.covariance) for fit in fits], axis=0))
    # 300 copies tell a scatter to 4 %
    assert np.sqrt(np.mean(found, axis=0)) == pytest.approx(scatter, rel=0.15)
    assert (np.abs(ordinary / scatter - 1) < 0.15).all() == ordinary_is_good


def test_a_model_that_misses_something_is_not_called_sure():
    wrong = fit_trajectory("viscous", TIMES, (angle := _with_friction()) + noise(0, 0.0))
    right = fit_trajectory("viscous+constant_coulomb", TIMES, angle + noise(0, 0.0))
    sure, unsure = (uncertainty(fit, [(TIMES, angle + noise(0, 0.0))]) for fit in (right, wrong))
    assert 0.5 < sure.inflation < 1.6
    assert unsure.inflation > 10
    # the wrong model's frequency is off by many of its ordinary errors, and not by many of these
    off = abs(wrong.values[0] - 6.0)
    assert off < 3 * np.sqrt(unsure.random[0, 0])


def _with_friction():
    values = {"natural_frequency": 6.0, "viscous_ratio": 0.01, "constant_friction": 0.02}
    return simulate(Model("viscous+constant_coulomb", values), TIMES, 0.3)


def test_two_swings_alike_halve_the_variance_of_one():
    swing = (TIMES, CLEAN + noise(1, 0.9))
    one, two = fit_trajectory("viscous", *swing), fit_jointly("viscous", [swing, swing])
    alone, both = uncertainty(one, [swing]).random, uncertainty(two, [swing, swing]).random
    # the same residuals twice: the same colour but for the order, which twice as many samples may raise
    assert np.sqrt(np.diag(both)[:2]) == pytest.approx(np.sqrt(np.diag(alone)[:2] / 2), rel=0.1)


@pytest.mark.parametrize("coefficients", [[], [0.7], [1.2, -0.6]])
def test_burg_finds_the_coefficients_and_the_order(coefficients):
    rng = np.random.default_rng(8)
    series = [lfilter([1.0], [1.0, *(-c for c in coefficients)], rng.standard_normal(3000)) for _ in range(4)]
    found = autoregression(series)
    assert found.coefficients == pytest.approx(coefficients, abs=0.03)
    assert found.variance == pytest.approx(1.0, rel=0.05)


def test_the_spectrum_is_that_of_the_process():
    series = np.random.default_rng(9).standard_normal((40, 4000))
    coloured = lfilter([1.0], [1.0, -0.8], series)
    power = np.mean(np.abs(np.fft.rfft(coloured)) ** 2, axis=0) / 4000
    found = autoregression(list(coloured)).spectrum(4000)
    ratio = power / found
    assert [part.mean() for part in np.array_split(ratio, 8)] == pytest.approx([1.0] * 8, rel=0.1)


def test_a_frequency_far_too_low_ends_no_fit():
    """A wrong model of a swing may say that its period is longer than the recording."""
    swing = TIMES, CLEAN + noise(0, 0.0)
    fit = fit_trajectory("viscous", *swing)
    slow = fit.model.with_values({**fit.model.values, "natural_frequency": 0.002})
    found = uncertainty(replace(fit, model=slow, swings=(replace(fit.only, model=slow),)), [swing])
    assert found.random.shape == fit.covariance.shape


def with_hum(rate, number, hum=7e-4):
    """Times, and the angle of a pendulum under a little white noise and the mains' 50 Hz at some phase."""
    rng, times = np.random.default_rng([9, number]), np.arange(15 * rate) / rate
    wave = np.sin(2 * np.pi * 50 * (1 + 1e-4 * rng.standard_normal()) * times + rng.uniform(0, 2 * np.pi))
    clean = simulate(HUMMED, times, rng.uniform(0.3, 0.6))
    return times, clean + hum * wave + 1e-4 * rng.standard_normal(times.size)


def test_intervals_hold_what_they_say_beside_the_hum_of_the_mains():
    """200 samples a second, averaged to 24 a period, fold 50 Hz to among the pendulum's harmonics: 92.2 % were held."""
    held = []
    for number in range(400):
        swing = with_hum(200, number)
        fit = fit_trajectory(HUMMED.label, *swing)
        known = uncertainty(fit, [swing])
        off = np.abs(fit.values[:3] - list(HUMMED.values.values()))
        held.append(off < (known.factors * np.sqrt(np.diag(known.covariance)))[:3])
    assert 0.935 < np.mean(held) < 0.965


@pytest.mark.parametrize(
    ("rate", "above", "found"), [(200, 0.06, [0.25]), (120, 0.1, [50 / 120]), (200, 0.3, [])]
)
def test_lines_are_found_beyond_a_frequency_with_their_size(rate, above, found):
    times, angle = with_hum(rate, 1)
    residual = angle - fit_trajectory(HUMMED.label, times, angle).angle
    lines = list(lines_of(residual, above))
    assert [line.amplitude for line in lines] == pytest.approx([7e-4] * len(found), rel=0.02)
    for line, frequency in zip(lines, found, strict=True):
        peak = np.argmax(np.abs(np.fft.rfft(line.fitted))) / line.fitted.size
        assert peak == pytest.approx(frequency, abs=1 / line.fitted.size)
    assert np.std(residual - sum(line.fitted for line in lines)) < (1.1e-4 if found else 6e-4)


def test_white_noise_has_no_line():
    counted = [len(list(lines_of(noise(number, 0.0), 0.1))) for number in range(200)]
    assert sum(counted) <= 2


def lost(how, size, rng):
    """Which samples are there where a third is lost at random, in bursts of 0.6 s, or one of three."""
    kept = np.ones(size, dtype=bool)
    if how == "at random":
        kept = rng.random(size) > 0.3
    elif how == "in bursts":
        while np.count_nonzero(kept) > 0.7 * size:
            at = rng.integers(1, size - 30)
            kept[at : at + 30] = False
    elif how == "every third":
        kept[2::3] = False
    kept[0] = True
    return kept


def stated_over_scatter(how, copies=200):
    """The stated error of frequency and damping over their scatter, beside a support that moves at nearly the pendulum's frequency."""
    memory, step = np.exp(-0.5 / 50), 6.0 / 50
    values, errors = [], []
    for number in range(copies):
        rng = np.random.default_rng([6, number])
        white = rng.standard_normal(TIMES.size + 2000)
        moved = 4e-5 * lfilter([1.0], [1.0, -2 * memory * np.cos(step), memory**2], white)[2000:]
        kept = lost(how, TIMES.size, rng)
        swing = TIMES[kept], (CLEAN + moved)[kept]
        fit = fit_trajectory("viscous", *swing)
        values.append(fit.values[:2])
        errors.append(np.diag(uncertainty(fit, [swing]).random)[:2])
    off = np.abs(np.array(values) - [6.0, 0.01])
    return 0.6745 * np.sqrt(np.median(errors, axis=0)) / np.median(off, axis=0)


@pytest.mark.parametrize("how", ["at random", "in bursts", "every third"])
def test_what_is_missing_does_not_shorten_the_time_between_what_is_there(how):
    """Taken as neighbours, the samples beside a hole left the errors at two thirds of what they are in swings without one."""
    assert stated_over_scatter(how) == pytest.approx(stated_over_scatter("not at all"), rel=0.12)


@pytest.mark.parametrize("how", ["at random", "in bursts", "every third"])
def test_a_line_is_found_across_holes_and_a_slow_wave_is_none(how):
    times, angle = with_hum(200, 1)
    residual = angle - fit_trajectory(HUMMED.label, times, angle).angle
    kept = lost(how, times.size, np.random.default_rng(4))
    at = np.flatnonzero(kept).astype(float)
    (line,) = lines_of(residual[kept], 0.06, at)
    assert line.amplitude == pytest.approx(7e-4, rel=0.03)
    assert np.std(residual[kept] - line.fitted) < 1.2e-4
    slow = 1e-3 * np.sin(7 * times) + 1e-4 * np.random.default_rng(2).standard_normal(times.size)
    assert sum(one.amplitude for one in lines_of(slow[kept], 0.06, at)) < 1e-4


@pytest.mark.parametrize("limit", [0.1, 1.0, 3.0, 10.0])
def test_an_interval_beside_a_clock_within_limits_holds_95_percent(limit):
    """The clock's error has limits: an interval as of normal errors holds more than it says, up to all."""
    rng = np.random.default_rng(3)
    error = rng.standard_normal(200_000) + limit * rng.uniform(-1, 1, 200_000)
    known = Uncertainty(np.eye(1), np.array([[limit / np.sqrt(3)]]), 1.0, 1.0, 1e9)
    half = known.factors[0] * np.sqrt(known.covariance[0, 0])
    assert np.mean(np.abs(error) < half) == pytest.approx(0.95, abs=0.002)


def test_the_half_width_of_a_clock_within_limits_is_that_of_the_sum():
    """As a mean over the error within limits tells it, from none of it to nothing else."""
    shares = np.array([0.0, 5e-4, 0.01, 0.3, 0.8, 0.97, 0.9999, 1.0])
    for share, k in zip(shares, half_widths(shares), strict=True):
        off = np.sqrt(3) * share * (np.arange(200_000) + 0.5) / 200_000
        spread = max(np.sqrt(1 - share**2), 1e-6)
        assert np.mean(ndtr((k - off) / spread) - ndtr((-k - off) / spread)) == pytest.approx(0.95, abs=1e-5)


@pytest.mark.filterwarnings("error::RuntimeWarning")
def test_a_series_that_is_foretold_to_rounding_has_a_colour_in_numbers():
    """A reflection is then 1, or by rounding more: what it leaves has no logarithm."""
    rates = [0.0, *np.random.default_rng(1).uniform(0, 1e-3, 200)]
    found = [autoregression([1e-9 * np.cos(rate * np.arange(300))]) for rate in rates]
    assert all(one.variance >= 0 and np.isfinite(one.coefficients).all() for one in found)
