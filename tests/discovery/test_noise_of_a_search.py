"""The noise that a search goes by: as large as it is, and known as well as it says."""

from collections import Counter

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.signal import lfilter

from swingdown.discovery.data.campaign import Swing, campaign
from swingdown.discovery.data.noise import Noise, at_most, coarse_noise, measure_noise
from swingdown.discovery.rounds import first_fit
from swingdown.discovery.search import discover
from swingdown.discovery.see.linear import frame
from swingdown.discovery.see.locate import line
from swingdown.discovery.tell.files import summary
from swingdown.discovery.tell.verdict import verdict
from swingdown.engine.trajectory import simulate
from swingdown.pendulum.model import Model
from swingdown_trials.second_pendulum import trajectory

SIZE, FREQUENCY, DRAWS = 2e-3, 1.0, 300  # rad, Hz


def measured(samples, rate, correlation=0.0):
    """Each draw's noise over the true one, as variances at low frequencies, and how well it says to be known: of white noise the most likely's."""
    found = []
    for seed in range(DRAWS):
        draws = np.random.default_rng([5, seed]).standard_normal(samples + 300)
        series = SIZE * lfilter([np.sqrt(1 - correlation**2)], [1, -correlation], draws)[300:]
        swing = Swing("a", np.arange(samples) / rate, series)
        every = measure_noise([swing.pair], FREQUENCY)[: None if correlation else 1]
        likely = np.exp([one.likely - every[0].likely for one in every])
        every = [coarse_noise(one, [swing], FREQUENCY) for one in every]
        level, known = np.array([(np.log(one.slow_variance), one.known) for one in every]).T
        mean = np.average(level, weights=likely)
        found.append((mean, np.sqrt(np.average(known**2 + (level - mean) ** 2, weights=likely))))
    mean, known = np.array(found).T
    return np.exp(mean) / SIZE**2 * (1 - correlation) / (1 + correlation), known


def verdict_on(one, base, restoring="sine"):
    base = Model(base, restoring=restoring)
    return verdict([summary(state, one) for state in discover(one, base)], base.catalogue)


def status(one, base):
    return verdict_on(one, base)["status"]


@pytest.mark.parametrize(("samples", "rate"), [(600, 50), (1000, 50), (600, 30), (3000, 30)])
def test_white_noise_is_as_large_as_it_is_and_known_as_well_as_it_says(samples, rate):
    ratio, known = measured(samples, rate)
    assert np.sqrt(ratio.mean()) == pytest.approx(1, abs=0.01)
    assert np.log(ratio).std() == pytest.approx(np.median(known), rel=0.25)


@pytest.mark.parametrize("correlation", [0.5, 0.9])
def test_coloured_noise_says_how_little_of_it_is_known(correlation):
    ratio, known = measured(1000, 50, correlation)
    assert abs(np.log(ratio).mean()) < np.median(known)
    assert np.median(known) > 0.2 > np.median(measured(1000, 50)[1])


@pytest.mark.parametrize(
    ("correlation", "rate", "duration"), [(0.92, 48, 10), (0.97, 100, 20), (0.99, 300, 20)]
)
def test_noise_with_a_long_memory_is_no_effect(correlation, rate, duration):
    """Its slow part lies where the swing is: of the memories that the band leaves open the swings themselves say which."""
    values = {"natural_frequency": 6.0, "viscous_ratio": 0.008, "load_friction": 0.004}
    told = Counter()
    for seed in range(4, 12):
        rng, times = np.random.default_rng([12, seed, rate]), np.arange(0, duration, 1 / rate)
        made = trajectory(("viscous", "load_coulomb"), values, times, 0.6).reading
        draws = rng.standard_normal(times.size + 1000)
        noise = lfilter([np.sqrt(1 - correlation**2)], [1, -correlation], draws)[1000:]
        told[
            status(campaign("slow", [Swing("a", times, made + 3 * SIZE * noise)]), "viscous+load_coulomb")
        ] += 1
    assert told["consistent"] >= 6
    assert set(told) <= {"consistent", "unknown"}


@pytest.mark.parametrize("lost", [40, 12])
def test_what_a_model_lacks_is_no_noise_where_samples_are_lost(lost):
    """Over a hole a slow error jumps, and what jumps is in every band."""
    rng, times = np.random.default_rng([8, lost]), np.arange(0, 60, 0.02)
    there = np.sin(2 * np.pi * times / 7.3) ** 2 > 0.02  # other holes, that are as long each
    there = np.convolve(~there, np.ones(lost), "same") == 0
    assert 0.05 < np.mean(~there) < 0.5
    error = 10 * SIZE * np.sin(2 * np.pi * 2.3 * times)
    left = (error + SIZE * rng.standard_normal(times.size))[there]
    noise = measure_noise([(times[there], left)], FREQUENCY)[0]
    assert noise.deviation == pytest.approx(SIZE, rel=0.06)
    assert abs(noise.correlation) < 0.1


def test_a_vibration_has_its_frequency_where_samples_are_lost():
    """What is left beside a hole does not follow: taken so, a line goes to where none is."""
    values = {"natural_frequency": 7.0, "viscous_ratio": 0.008}
    times, made = np.arange(0, 12, 0.02), []
    for seed, angle in enumerate((0.7, -0.5)):
        rng, there = np.random.default_rng([10, seed]), np.ones(times.size, dtype=bool)
        for at in rng.integers(1, times.size - 41, 4):
            there[at : at + 40] = False
        readings = trajectory(("viscous",), values, times, angle).reading + SIZE * np.sin(
            2 * np.pi * 2.3 * times + seed
        )
        made.append(Swing(f"{angle}", times[there], readings[there]))
    one = campaign("vibrating", made)
    assert line(frame(first_fit(one, Model("viscous")), one.fit))[0] == pytest.approx(2.3, abs=0.05)


def test_a_slow_pendulum_has_its_line_too():
    """Of a torsion balance, a swing in minutes and a reading in seconds."""
    times = np.arange(0, 6000, 2.0)
    rng = np.random.default_rng(5)
    swing = 0.1 * np.exp(-4e-4 * times) * np.cos(0.02 * times)
    shaken = swing + 2e-3 * np.sin(0.09 * times) + 1e-4 * rng.standard_normal(times.size)
    one = campaign("balance", [Swing("a", times, shaken)])
    found = line(frame(first_fit(one, Model("viscous", restoring="linear")), one.fit))
    assert found[0] == pytest.approx(0.09 / (2 * np.pi), rel=0.03)


def test_coarse_swings_tell_their_noise_where_frames_are_lost():
    """Of 25 samples a period the swing itself is in a difference over a hole, and passes for noise."""
    rng, times = np.random.default_rng(9), np.arange(0, 40, 0.04)
    series = 0.3 * np.sin(2 * np.pi * times) + SIZE * rng.standard_normal(times.size)
    there = rng.random(times.size) > 0.05
    asked = coarse_noise(Noise(20 * SIZE, 0.0, 0.1), [Swing("a", times[there], series[there])], FREQUENCY)
    assert asked.deviation == pytest.approx(SIZE, rel=0.1)


def test_of_two_estimates_that_chance_tells_apart_the_smaller_is_no_better():
    noise = Noise(1.0, 0.0, 0.1)
    assert at_most(noise, 0.95, 0.1) is noise
    assert at_most(noise, 0.5, 0.1).deviation == 0.5


@pytest.mark.parametrize("seed", [1, 5, 6])
def test_noise_with_a_memory_is_no_effect_where_samples_are_few(seed):
    """Of some 25 samples a period the band above the harmonics hardly tells noise with a memory from less white noise."""
    rng, times, made = np.random.default_rng([7, seed]), np.arange(0, 20, 1 / 30), []
    for angle in (0.4, -0.25):
        clean = trajectory(
            ("viscous",), {"natural_frequency": 5.2, "viscous_ratio": 0.006}, times, angle
        ).reading
        noise = lfilter([np.sqrt(0.75)], [1, -0.5], rng.standard_normal(times.size + 100))[100:]
        made.append(Swing(f"{angle}", times, clean + SIZE * noise))
    assert status(campaign("coloured", made), "viscous") == "consistent"


@pytest.mark.parametrize("seed", [0, 1])
def test_a_damping_of_which_a_swing_has_few_samples_is_no_slow_noise(seed):
    """Six seconds of a braked wheel at ten samples a second: noise that forgets nothing within the record would explain all that is missing."""
    values = {"natural_frequency": 3.35, "viscous_ratio": 0.19, "constant_friction": 0.02}
    times = np.arange(0, 6, 0.1)
    made = simulate(Model("viscous+constant_coulomb", values, restoring="linear"), times, 2.0)
    made = made + 0.005 * np.random.default_rng([3, seed]).standard_normal(times.size)
    found = verdict_on(campaign("braked", [Swing("a", times, made)]), "constant_coulomb", "linear")
    assert "viscous" in {name for one in found["effects"] for name in (one["name"], *one["tied_with"])}


def computed(cubic, drag, less_exact=0.0):
    """A swing as somebody's solver computes it, with all digits and no noise; ``less_exact`` by so much (rad), slowly."""

    def slope(_, state):
        angle, speed = state
        return speed, -36 * np.sin(angle) - 0.2 * speed - drag * speed * abs(speed) - cubic * angle**3

    times = np.arange(1000) / 50
    found = solve_ivp(slope, (0, 20), (0.8, 0.0), t_eval=times, method="DOP853", rtol=1e-11, atol=1e-13)
    return campaign("one", [Swing("a", times, found.y[0] + less_exact * np.sin(times) ** 2)])


@pytest.mark.parametrize("base", ["viscous", "viscous+quadratic_drag+load_coulomb"])
def test_of_computed_swings_what_remains_is_arithmetic(base):
    """To take it for what is missing would be to name a flexible pivot of a part in 10^11."""
    for less_exact in (0.0, 3e-8):  # as exact as a solver can be, and as one is by default
        found = verdict_on(computed(0.0, 0.0, less_exact), base)
        assert (found["status"], found["effects"]) == ("consistent", [])
        assert found["gap"]["fit"][-1] < 0.1


@pytest.mark.parametrize(
    ("cubic", "drag", "name"), [(2.0, 0.0, "cubic_stiffness"), (0.0, 0.05, "quadratic_drag")]
)
def test_what_computed_swings_lack_is_named(cubic, drag, name):
    found = verdict_on(computed(cubic, drag), "viscous")
    assert (found["status"], [one["name"] for one in found["effects"]]) == ("named", [name])
