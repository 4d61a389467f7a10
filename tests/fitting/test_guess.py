"""The first guess, from the data alone."""

import numpy as np
import pytest

from swingdown.engine.trajectory import simulate
from swingdown.errors import InputError
from swingdown.fitting.guess import _without_hole, at_first, first_guess
from swingdown.pendulum.model import Model

TIMES = np.arange(1001) / 100


@pytest.mark.parametrize("frequency", [1.5, 7.25, 30.0])
@pytest.mark.parametrize("degrees", [2, 20, 60, 120])
@pytest.mark.parametrize("noise", [0.0, 0.02], ids=["clean", "noisy"])
def test_frequency_and_release(frequency, degrees, noise):
    model = Model("viscous", {"natural_frequency": frequency, "viscous_ratio": 0.01})
    release = np.radians(degrees)
    angle = simulate(model, TIMES, release)
    seen = first_guess(TIMES, angle + noise * release * np.random.default_rng(1).standard_normal(TIMES.size))
    assert seen.natural_frequency == pytest.approx(frequency, rel=0.03)
    assert seen.release_angle == pytest.approx(release, rel=0.15)


@pytest.mark.parametrize(
    "name",
    [
        "viscous+0.01",
        "quadratic_drag+0.05",
        "load_coulomb+0.01",
        "constant_coulomb+0.4",
        "structural_damping+1.0",
    ],
)
def test_the_loss_tells_each_damping_alone(name):
    effect, size = name.split("+")
    model = Model(effect)
    parameter = model.parameters[1]
    angle = simulate(model.with_values({"natural_frequency": 7.25, parameter: float(size)}), TIMES[:400], 0.4)
    seen = first_guess(TIMES[:400], angle).damping(model)
    assert list(seen) == [parameter]
    assert seen[parameter] == pytest.approx(float(size), rel=0.5)


@pytest.mark.parametrize(
    "angle", [np.zeros(50), np.linspace(0.5, 0.4, 50), np.ones(50)], ids=["nothing", "a slope", "held"]
)
def test_what_does_not_swing_is_refused(angle):
    with pytest.raises(InputError, match="half-swing"):
        first_guess(np.arange(50) / 100, angle)


def test_holes_of_several_half_swings_tell_no_frequency():
    """Bursts of lost samples as long as four half-swings, the first of them among those that are widest."""
    times = np.arange(0, 20, 0.04)
    kept = ((times < 0.5) | (times > 2.1)) & ((times < 3.9) | (times > 5.5))
    swing = 0.6 * np.exp(-0.3 * times) * np.cos(8.0 * times)
    assert first_guess(times[kept], swing[kept], "linear").natural_frequency == pytest.approx(8.0, rel=0.02)


@pytest.mark.parametrize("reading", ["angle", "rate"])
@pytest.mark.parametrize("restoring", ["sine", "linear"])
@pytest.mark.parametrize("degrees", [10, 60, 110, -60])
def test_all_that_a_swing_shows_of_itself(reading, restoring, degrees):
    """From an angle and from a rate the same: frequency, release, amplitude and what a half-swing loses."""
    model = Model("viscous", {"natural_frequency": 7.0, "viscous_ratio": 0.05}, restoring=restoring).of(reading)  # fmt: skip
    release, velocity = np.radians(degrees), 1.0
    seen = first_guess(TIMES, simulate(model, TIMES, release, velocity), restoring, reading)
    angle = simulate(model.of("angle"), TIMES, release, velocity)
    peaks = np.abs(angle[1:-1][(np.diff(angle)[1:] * np.diff(angle)[:-1]) < 0])
    assert seen.natural_frequency == pytest.approx(7.0, rel=0.02)
    assert seen.release_angle == pytest.approx(release, rel=0.15)
    assert seen.release_velocity == pytest.approx(velocity, abs=0.5)
    assert peaks[0] / 2 < seen.amplitude < 1.02 * peaks[0]
    assert seen.loss == pytest.approx((peaks[0] - peaks[-1]) / (peaks.size - 1), rel=0.15)


def test_two_passages_of_a_rate_are_enough_for_a_start():
    times = np.arange(0, 0.75, 0.01)
    seen = first_guess(times, np.cos(2 * np.pi * times + 0.3), "sine", "rate")
    assert seen.natural_frequency == pytest.approx(2 * np.pi, rel=0.3)  # its mean is no zero


def test_value_and_slope_are_those_of_the_first_sample_whatever_its_time():
    times = 7 + np.arange(40) / 100
    since = times - 7
    value, slope = at_first(times, 0.3 + 0.5 * since - 2 * since**2, 0.8)
    assert (value, slope) == pytest.approx((0.3, 0.5), rel=1e-9)


@pytest.mark.parametrize(
    ("hole", "whole"),
    [
        (9, [False, True, True]),
        (10, [False, False, True]),
        (11, [True, False, True]),
        (19, [True, False, True]),
    ],
)
def test_a_hole_spoils_the_half_swing_it_is_in_and_none_beside_it(hole, whole):
    """Of half-swings of ten samples; also right behind a crossing, and right before the next."""
    steps = np.full(31, 0.01)
    steps[hole] = 0.1
    times = np.concatenate([[0.0], np.cumsum(steps)])
    crossings = np.array([(times[k] + times[k + 1]) / 2 for k in (0, 10, 20, 30)])
    assert list(_without_hole(times, steps, crossings)) == whole
