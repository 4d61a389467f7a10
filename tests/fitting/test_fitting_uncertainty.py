"""The uncertainty of fitted values: held to the scatter of fits to many noisy copies, and to dense algebra."""

from dataclasses import replace

import numpy as np
import pytest
from noisy import CLEAN, HUMMED, TIMES, lost, noise, with_hum
from scipy.linalg import toeplitz
from scipy.signal import lfilter
from scipy.special import ndtr
from scipy.stats import t

from swingdown.engine.trajectory import sensitivities, simulate
from swingdown.fitting.coloured_noise import autoregression
from swingdown.fitting.least_squares import fit_jointly, fit_trajectory
from swingdown.fitting.uncertainty import Uncertainty, _pieces, _timing, half_widths, in_steps, uncertainty
from swingdown.pendulum.model import Model
from swingdown.studies.quantities import Beside, quantities


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


def test_a_frequency_far_too_low_ends_no_fit():
    """A wrong model of a swing may say that its period is longer than the recording."""
    swing = TIMES, CLEAN + noise(0, 0.0)
    fit = fit_trajectory("viscous", *swing)
    slow = fit.model.with_values({**fit.model.values, "natural_frequency": 0.002})
    found = uncertainty(replace(fit, model=slow, swings=(replace(fit.only, model=slow),)), [swing])
    assert found.random.shape == fit.covariance.shape


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


@pytest.mark.parametrize("memory", [0.0, 0.8])
def test_the_covariance_is_the_sandwich_of_all_residuals(memory):
    """By dense matrices: means of two samples, whose autocovariance is that of their colour; widened for the values that took their share."""
    swing = TIMES, CLEAN + noise(4, memory)
    fit = fit_trajectory("viscous", *swing)
    known = uncertainty(fit, [swing])
    one = fit.only
    release = one.release_angle, one.release_velocity
    slopes = sensitivities(fit.model, TIMES, *release, free=fit.free)[1]
    residual = (swing[1] - fit.angle).reshape(-1, 2)  # 24 means a period of 52 samples
    alike = np.clip(np.mean(residual[:, 0] * residual[:, 1]) / np.mean(residual**2), 0, 1)
    spread = np.sqrt(2 * (1 + alike))
    colour = autoregression([residual.sum(axis=1) / spread])
    ringing = lfilter([1.0], np.append(1.0, -colour.coefficients), np.eye(1, 2000)[0])
    delays = [colour.variance * ringing[k:] @ ringing[: ringing.size - k] for k in range(500)]
    means = slopes.reshape(len(fit.free), -1, 2).mean(axis=2)
    inverse = np.linalg.inv(2 * means @ means.T)
    random = inverse @ (spread**2 * means @ toeplitz(delays) @ means.T) @ inverse
    n, size = TIMES.size, len(fit.free)
    inflation = np.exp(np.mean(np.log(np.diag(random) / (fit.rss / n * np.diag(inverse)))))
    dof = n / max(1.0, inflation) - size
    assert known.inflation == pytest.approx(inflation, rel=1e-3)
    assert known.dof == pytest.approx(dof, rel=1e-3)
    errors = np.sqrt(np.diag(random))
    wider = 1 + size / dof
    assert known.random / np.outer(errors, errors) == pytest.approx(
        wider * random / np.outer(errors, errors), abs=2e-3
    )
    assert known.noise == pytest.approx(np.sqrt(fit.rss / n * inflation * wider), rel=1e-3)
    assert (inflation > 3) == (memory > 0)


def test_two_swings_of_other_noise_have_each_their_weight():
    """The swings' own values are next to those they share; of swings with other steps each has a colour of its own."""
    rng = np.random.default_rng(1)
    often = np.arange(2000) / 100
    clean = simulate(Model("viscous", {"natural_frequency": 6.0, "viscous_ratio": 0.01}), often, 0.3)
    swings = [
        (TIMES, CLEAN + 1e-3 * rng.standard_normal(TIMES.size)),
        (often, clean + 1e-3 * rng.standard_normal(often.size)),
    ]
    both = fit_jointly("viscous", swings)
    known = np.diag(uncertainty(both, swings).random)[:2]
    each = [np.diag(uncertainty(fit_trajectory("viscous", *one), [one]).random)[:2] for one in swings]
    assert 1 / known == pytest.approx(1 / each[0] + 1 / each[1], rel=0.15)


def test_stamps_that_are_off_add_what_they_do_to_the_fastest_samples():
    """Residuals of a white part and of the speed times the stamp's error: more than white noise where the slope is large with the speed, and no
    less where it is not."""
    rng, times = np.random.default_rng(1), np.arange(20_000) / 100
    fitted, speed = 0.3 * np.cos(6 * times), -1.8 * np.sin(6 * times)
    slopes = np.array([times * np.sin(6 * times), np.cos(6 * times)])
    white, late = 1e-3 * rng.standard_normal(times.size), 2e-3 * rng.standard_normal(times.size)
    found = _timing(slopes, times, fitted, white + speed * late)
    right = 2e-3**2 * np.sum(slopes[0] ** 2 * (speed**2 - np.mean(speed**2)))
    assert found[0, 0] == pytest.approx(right, rel=0.1)
    assert abs(found[1, 1]) < 1e-3 * 2e-3**2 * np.sum(slopes[1] ** 2 * speed**2)
    assert not _timing(slopes, times, fitted, white).any()
    # of stamps alone the residuals are nothing at rest: all of them is of the stamps
    alone = _timing(slopes, times, fitted, speed * late)
    assert alone[0, 0] == pytest.approx(right, rel=0.1)


def test_missing_samples_are_steps_of_a_recorder_that_kept_its_rate():
    there = np.array([0, 1, 2, 3, 5, 6, 7, 8, 12, 13])
    interval, at = in_steps(7.0 + 0.02 * there)
    assert interval == pytest.approx(0.02) and at == pytest.approx(there)


def test_pieces_are_longer_where_too_many_would_be_empty():
    whole = np.arange(23)
    each, counts = _pieces(whole, 4)
    assert each == 4 and list(counts) == [4] * 5  # what is left at the end goes
    # one of four is there: of pieces of two each second is empty, of three each fourth
    each, counts = _pieces(whole * 4, 2)
    assert each == 4 and list(counts) == [1] * 22
    assert _pieces(whole * 40, 2)[0] == 6  # no longer than three times


@pytest.mark.parametrize("missed", ["loss", "frequency"])
def test_free_courses_find_what_the_law_misses(missed):
    """Of friction that a viscous law has not, and of a magnet's pull: period and quality of the first swing are those of the true model."""
    more = {
        "loss": ("load_coulomb", {"load_friction": 0.004}),
        "frequency": ("magnet", {"magnet_depth": 0.1, "magnet_width": 0.3}),
    }
    name, values = more[missed]
    times = np.arange(2000) / 50
    true = Model(f"viscous+{name}", {"natural_frequency": 6.0, "viscous_ratio": 0.004} | values)
    swing = times, simulate(true, times, 0.4) + 1e-3 * np.random.default_rng(1).standard_normal(times.size)
    fit = fit_trajectory("viscous", *swing)
    courses = uncertainty(fit, [swing], free=True).courses
    size = len(fit.model.parameters)
    beside = Beside(*courses.over(fit.free, fit.model.parameters))
    plain = quantities(fit.model, 0.4, fit.covariance[:size, :size])
    told, right = quantities(fit.model, 0.4, fit.covariance[:size, :size], beside), quantities(true, 0.4)
    for one in {"loss": ("quality",), "frequency": ("period",)}[missed]:
        off, before = (abs(each[one].value - right[one].value) for each in (told, plain))
        assert off < 3 * told[one].u and off < before / 2
    assert courses.gain > 10 and 0 < courses.left < 0.8
    assert courses.inflation < uncertainty(fit, [swing]).inflation / 2


def test_a_law_that_misses_nothing_has_no_courses():
    swing = TIMES, CLEAN + noise(4, 0.0)
    courses = uncertainty(fit_trajectory("viscous", *swing), [swing], free=True).courses
    assert abs(courses.gain) < 1 and courses.left == pytest.approx(1, abs=2e-3)
    assert np.abs(courses.shift[:2]) == pytest.approx([0, 0], abs=1e-3)


def test_what_is_known_beside_the_scatter_adds_to_its_degrees_of_freedom():
    """Welch and Satterthwaite: half of the variance is told by five, and the other half is known."""
    known = Uncertainty(np.eye(1), np.array([[1.0, 0.0]]), 1.0, 1.0, 5.0)
    assert known.factors == pytest.approx(t.ppf(0.975, 5 * 2**2), rel=1e-6)


def test_stamps_that_are_right_are_seldom_blamed():
    """One in forty, for what is more than two standard errors."""
    times = np.arange(600) / 50
    slopes, fitted = np.sin(6 * times)[np.newaxis], 0.3 * np.cos(6 * times)
    draws = [np.random.default_rng((2, number)).standard_normal(times.size) for number in range(200)]
    assert sum(_timing(slopes, times, fitted, 1e-3 * one).any() for one in draws) < 15
