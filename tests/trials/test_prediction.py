"""What a fitted model says of a swing beyond its samples."""

import numpy as np
import pytest

from swingdown.engine.trajectory import simulate
from swingdown.fitting.least_squares import fit_jointly
from swingdown.fitting.uncertainty import uncertainty
from swingdown.pendulum.model import Model
from swingdown_trials.coverage import predict_reading

MODEL = Model("viscous", {"natural_frequency": 7.25, "viscous_ratio": 0.01})
TIMES, LATER = np.arange(400) / 50, np.array([0.0, 1.003, 9.5, 12.0])
RELEASES = (0.35, 0.2)


def swings(seed):
    rng = np.random.default_rng(seed)
    return [
        (TIMES, simulate(MODEL, TIMES, one) + 0.002 * rng.standard_normal(TIMES.size)) for one in RELEASES
    ]


@pytest.mark.parametrize("swing", [0, 1])
def test_it_tells_where_the_pendulum_will_be_and_how_surely(swing):
    """Of 40 recordings the predictions scatter about the truth as they say, each swing with its own release."""
    truth, away = simulate(MODEL, LATER, RELEASES[swing]), []
    for seed in range(40):
        series = swings(seed)
        fit = fit_jointly("viscous", series)
        told, u = predict_reading(fit, uncertainty(fit, series), LATER, swing)
        one = fit.swings[swing]
        moved = simulate(one.model, LATER, one.release_angle, one.release_velocity)
        assert told == pytest.approx(moved, abs=1e-7)
        away.append((told - truth) / u)
    spread = np.sqrt(np.mean(np.square(away), axis=0))
    assert np.all((spread > 0.6) & (spread < 1.5)), spread
