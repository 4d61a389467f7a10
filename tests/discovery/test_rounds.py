"""A hidden effect is named, and nothing is named where nothing is hidden; the swings are made by scipy, not by the engine."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from swingdown.discovery.data.campaign import Swing, campaign
from swingdown.discovery.data.noise import measure_noise
from swingdown.discovery.move.candidates import starts_to_add
from swingdown.discovery.move.refit import with_effect
from swingdown.discovery.search import discover
from swingdown.discovery.see.linear import columns_of, frame
from swingdown.discovery.tell.files import summary
from swingdown.engine.trajectory import TrajectoryError, simulate
from swingdown.fitting.least_squares import fit_jointly
from swingdown.pendulum.model import Model
from swingdown.plots.discovery import missing_torque

TIMES = np.arange(1201) / 100  # s
NOISE = 1e-3  # rad


def swings(quadratic, seed):
    """Five swings of a pendulum with viscous and (or no) quadratic drag, from 0.3 to 0.9 rad, with white noise."""
    draws = np.random.default_rng(seed)
    found = []
    for k, release in enumerate(np.linspace(0.3, 0.9, 5)):

        def motion(t, state):
            angle, velocity = state
            drag = 2 * 0.008 * 7.25 * velocity + 7.25 * quadratic * velocity * abs(velocity)
            return velocity, -(7.25**2) * np.sin(angle) - drag

        angle = solve_ivp(motion, (0, TIMES[-1]), (release, 0.0), "DOP853", TIMES, rtol=1e-10, atol=1e-12).y[
            0
        ]
        found.append(Swing(f"swing {k + 1}", TIMES, angle + NOISE * draws.standard_normal(TIMES.size)))
    return found


@pytest.fixture(scope="module")
def named():
    return discover(
        campaign("hidden", swings(0.003, 11)),
        "viscous",
        rounds=2,
        allowed=("quadratic_drag", "constant_torque", "cubic_stiffness"),
    )


def test_the_hidden_effect_is_named_and_the_gap_closes(named):
    assert named[0].missing
    assert named[0].chosen.added == "quadratic_drag"
    last = named[-1]
    assert last.fit.model.label == "viscous+quadratic_drag"
    assert not last.missing
    assert last.holdout.rms / NOISE == pytest.approx(1, abs=0.05)
    assert last.holdout.rms < 0.5 * named[0].holdout.rms


def test_the_missing_torque_is_drawn_as_large_as_it_is(named):
    """Quadratic drag beyond what the viscous term can do of it: less than the drag itself, and nothing once it is there."""
    before, after = (one.curves[one.curves["over"] == "velocity"] for one in (named[0], named[-1]))
    whole = 7.25 * 0.003 * before["x"].max() ** 2
    assert 0.02 * whole < before["torque"].abs().max() < whole
    assert (after["torque"].abs() < 0.02 * whole).all()
    assert (after["band"] < 0.02 * whole).all()  # what the fit's own drag can do is no part of the map


def test_what_has_no_name_is_drawn():
    """Without the drag in the catalogue the torque that is missing over the speed is the drag's, beyond what viscous damping can do."""
    one = campaign("hidden", swings(0.003, 11))
    states = discover(one, "viscous", rounds=1, allowed=("constant_torque",))
    assert states[-1].missing and not any(found.sure for found in states[-1].findings.values())
    drawn = missing_torque(states[0].curves, states[-1].curves, [summary(state, one) for state in states])
    assert "velocity" in drawn.axes[1].get_title(loc="left")


def test_the_disagreement_is_seen_as_dissipative(named):
    shares = {group.name: group.share for group in named[0].groups}
    assert max(shares, key=shares.get) == "velocity"


def test_nothing_is_named_where_nothing_is_hidden():
    states = discover(campaign("null", swings(0.0, 12)), "viscous", rounds=2)
    assert len(states) == 1
    assert not states[0].missing


def test_the_middle_amplitudes_are_held_out():
    split = campaign("hidden", swings(0.0, 1))
    assert [swing.name for swing in split.holdout] == ["swing 2"]
    assert len(split.fit) == 4


@pytest.mark.parametrize("correlation", [0.0, 0.5])
def test_noise_is_measured_with_its_colour(correlation):
    draws = np.random.default_rng(5).standard_normal(20_000)
    series = np.zeros_like(draws)
    for k in range(1, draws.size):
        series[k] = correlation * series[k - 1] + np.sqrt(1 - correlation**2) * draws[k]
    noise = measure_noise([(0.01 * np.arange(series.size), NOISE * series)], 1.15)[0]
    assert noise.deviation == pytest.approx(NOISE, rel=0.03)
    assert noise.correlation == pytest.approx(correlation, abs=0.03)


def test_noise_that_rises_in_its_band_is_taken_for_white():
    """Differences of white noise have next to nothing at the pendulum's frequency: that is not known of a sensor."""
    series = np.diff(np.random.default_rng(6).standard_normal(20_000)) / np.sqrt(2)
    noise = measure_noise([(0.01 * np.arange(series.size), NOISE * series)], 1.15)[0]
    assert noise.slow_variance == pytest.approx(NOISE**2, rel=0.1)


def test_a_candidate_that_the_engine_does_not_take_ends_no_search():
    """Of a pendulum so slow that a support in proportion to it would be below the catalogue's lowest frequency."""
    times, rng = 200.0 * TIMES, np.random.default_rng(3)
    slow = Model("viscous", {"natural_frequency": 7.25 / 200, "viscous_ratio": 0.01})
    parts = [
        Swing(f"swing {k}", times, simulate(slow, times, release) + NOISE * rng.standard_normal(times.size))
        for k, release in enumerate((0.3, 0.5))
    ]
    here = frame(fit_jointly("viscous", [part.pair for part in parts], bounded=True), parts)
    found = starts_to_add(here, "flexible_pivot")  # of four frequencies to start from, two are too low
    assert found
    assert min(start.begin.swings[0].values["pivot_frequency"] for start in found) >= 0.1
    assert starts_to_add(here, "quadratic_drag")
    begin = with_effect(here.fit.begin, "presliding", {"presliding_friction": 1e-5, "presliding_angle": 0.0})
    with pytest.raises(TrajectoryError):
        columns_of(here, begin.model.catalogue["presliding"], begin.swings[0].values, ["presliding_friction"])
