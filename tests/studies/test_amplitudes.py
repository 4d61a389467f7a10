"""Amplitudes, passages and their uncertainties of a swing whose turning points are known."""

import numpy as np
import pytest

from swingdown.answer.given import swings
from swingdown.engine.trajectory import simulate
from swingdown.errors import InputError
from swingdown.pendulum.catalogue import RATE
from swingdown.pendulum.half_swings import reached
from swingdown.pendulum.model import Model
from swingdown.studies.amplitudes import half_swings_of, of_samples

FREQUENCY, RATIO, SIZE = 5.0, 0.01, 0.4  # rad/s, damping ratio, rad
OWN = FREQUENCY * np.sqrt(1 - RATIO**2)
HALF = np.pi / OWN  # s


def decay(times, size=SIZE, phase=0.0):
    """A decaying cosine; its slope is that of a pendulum's rate but for the phase."""
    return size * np.exp(-RATIO * FREQUENCY * times) * np.cos(OWN * times + phase)


def turns(count, size=SIZE):
    """Times (s) and angles (rad) of the turning points of that decay."""
    at = (np.arange(count) * np.pi - np.arctan2(RATIO, np.sqrt(1 - RATIO**2))) / OWN
    return at, decay(at, size)


def noisy(times, noise=1e-3, seed=1, **of):
    return decay(times, **of) + np.random.default_rng(seed).normal(0, noise, times.size)


@pytest.mark.parametrize("middle", [0.0, 0.15])
def test_turning_points_and_passages_are_those_of_the_decay_wherever_its_middle_is(middle):
    times = np.arange(0.05, 30, 0.01)
    found = of_samples("one", times, decay(times) + middle)
    at, size = turns(60)
    first = int(np.argmin(np.abs(at - found.times[0])))
    known = slice(first, first + found.angle.size)
    assert found.angle.size > 40 and found.passages and found.both
    assert found.times == pytest.approx(at[known], abs=1e-4)
    assert found.angle == pytest.approx(size[known], abs=5e-5)
    assert np.array_equal(np.diff(found.number), np.ones(found.number.size - 1))
    through = (np.round(found.mark * OWN / np.pi - 0.5) + 0.5) * np.pi / OWN
    assert found.mark == pytest.approx(through, abs=1e-4)
    assert np.array_equal(np.sign(found.slope), np.where(np.round(found.mark / HALF - 0.5) % 2, 1, -1))
    # a passage lies half a half-swing before the turn of its number
    assert found.at[0] == found.number[0] - 0.5 and found.mark[0] < found.times[0]


def test_a_swing_that_rises_faster_than_it_falls_has_its_turning_points():
    """As a magnet that falls through a coil: each turn lies far from the middle between two passages."""
    times = np.arange(0, 12, 0.002)
    phase = 2 * np.pi * 2.3 * times
    read = np.exp(-0.05 * times) * (np.sin(phase) + 0.35 * np.sin(2 * phase) + 0.1 * np.sin(3 * phase))
    found = of_samples("coil", times, read + 1e-3 * np.random.default_rng(2).standard_normal(times.size))
    assert found.angle.size > 50
    largest = np.max(
        np.sin(x := np.linspace(0, 2 * np.pi, 100_001)) + 0.35 * np.sin(2 * x) + 0.1 * np.sin(3 * x)
    )
    assert np.abs(found.angle) == pytest.approx(largest * np.exp(-0.05 * found.times), rel=5e-3)


@pytest.mark.parametrize("step", [0.01, 0.06])
def test_what_is_stated_is_how_far_they_are_off(step):
    """With 60 samples of a half-swing, and with ten, for which the windows grow."""
    off, late = [], []
    for seed in range(8):
        times = np.arange(0.05, 25, step)
        found = of_samples("one", times, noisy(times, seed=seed))
        at, size = turns(60)
        known = size[np.abs(at[:, np.newaxis] - found.times).argmin(axis=0)]
        off.append((found.angle - known) / found.u_angle)
        through = (np.round(found.mark * OWN / np.pi - 0.5) + 0.5) * np.pi / OWN
        late.append((found.mark - through) / found.u_mark)
    assert np.std(np.concatenate(off)) == pytest.approx(1.0, abs=0.15)
    assert np.std(np.concatenate(late)) == pytest.approx(1.0, abs=0.15)


def test_half_swings_that_nobody_sampled_are_counted():
    times = np.arange(0.05, 25, 0.01)
    kept = np.abs(times - 9.0) > 0.9
    whole, holed = (of_samples("one", one, noisy(one)) for one in (times, times[kept]))
    left = np.isin(whole.number, holed.number)
    assert 2 <= np.count_nonzero(~left) <= 5
    assert whole.times[left] == pytest.approx(holed.times, abs=0.02)
    assert holed.number[-1] == whole.number[-1]


def test_a_swing_ends_where_the_first_turn_is_lost_in_the_noise():
    times = np.arange(0.05, 120, 0.02)
    found = of_samples("one", times, noisy(times, 5e-3))
    smallest = np.abs(turns(int(found.number[-1]) + 4)[1][-1])
    assert 15e-3 < smallest < 35e-3  # five times the noise
    assert set(np.diff(found.number)) <= {1.0, 2.0} and found.number.size > 0.9 * found.number[-1]
    assert found.mark[-1] < found.times[-1] + 2 * HALF


@pytest.mark.parametrize(
    ("size", "noise", "gained"), [(0.3, 2e-3, 0.75), (1.0, 1e-2, 0.7), (1.8, 1e-2, 0.7), (1.0, 0.0, 1.01)]
)
def test_whole_half_swings_tell_turns_surer_beside_noise_and_are_not_asked_without(size, noise, gained):
    """Of a weight: its swings are no sine, and the wider the less. The second value is the noise, the third what is left of the errors."""
    model = Model("viscous", {"natural_frequency": 6.0, "viscous_ratio": 0.004})
    times, often = np.arange(1200) / 40, np.arange(120000) / 4000
    truth = of_samples("", often, simulate(model, often, size))
    read = simulate(model, times, size) + noise * np.random.default_rng(1).standard_normal(times.size)
    errors = []
    for sine in (False, True):
        found = of_samples("", times, read, sine=sine)
        assert np.array_equal(found.number, truth.number[: found.number.size])
        off = np.abs(found.angle) - np.abs(truth.angle[: found.angle.size])
        errors.append(np.sqrt(np.mean(off**2)))
        if noise:
            assert errors[-1] == pytest.approx(np.median(found.u_angle), rel=0.35)
            assert abs(off.mean()) < 4 * errors[-1] / np.sqrt(off.size)
    assert errors[1] < gained * errors[0]


@pytest.mark.parametrize(
    "duration, step, told",
    [(1.5, 0.01, "it passes its middle 3 times"), (20.0, 0.2, "samples in each half-swing")],
)
def test_too_little_of_a_swing_is_refused(duration, step, told):
    times = np.arange(0.05, duration, step)
    with pytest.raises(InputError, match=told):
        of_samples("one", times, noisy(times))


@pytest.mark.parametrize("restoring", ["sine", "linear"])
def test_a_rate_s_largest_values_are_angles_by_the_energy(restoring):
    """Where it is fastest it has all of its energy: 2 sin(angle / 2) of its natural frequency, of a spring the angle itself."""
    model = Model("viscous", {"natural_frequency": FREQUENCY, "viscous_ratio": RATIO}, restoring=restoring)
    times = np.arange(0.05, 25, 0.01)
    rates = simulate(model.of(RATE), times, 1.5) + np.random.default_rng(1).normal(0, 3e-3, times.size)
    data = swings(times, rates, "rad/s", restoring=restoring)[0]
    found = half_swings_of(data, restoring)
    of_rates = of_samples("one", times, data["rate"].values)
    fastest = np.abs(of_rates.angle)
    assert np.abs(found.angle) == pytest.approx(reached(fastest / FREQUENCY, restoring), rel=2e-3)
    grows = (
        reached((fastest + 1e-3) / FREQUENCY, restoring) - reached(fastest / FREQUENCY, restoring)
    ) / 1e-3
    assert found.u_angle == pytest.approx(grows * of_rates.u_angle, rel=5e-3)
    assert found.angle.size > 30 and not found.passages


def test_turning_points_that_somebody_wrote_down_are_taken_as_they_are():
    at, size = turns(30)
    found = half_swings_of(swings(at[1:], np.round(size[1:], 3), "rad", kind="half_swings")[0])
    assert np.abs(found.angle) == pytest.approx(np.abs(size[1:]), abs=6e-4) and found.mark == pytest.approx(
        at[1:]
    )
    assert np.array_equal(found.at, found.number) and np.isinf(found.slope).all() and not found.passages
    with pytest.raises(InputError, match="4 turning points"):
        half_swings_of(swings(at[1:], size[1:], "rad", kind="half_swings")[0].isel(time=slice(4)))
