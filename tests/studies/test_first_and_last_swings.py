"""Ten swings timed together, as with a stop-watch."""

import numpy as np
import pytest

import swingdown
from swingdown.studies.timed import timed

TIMES = np.arange(0.0, 40.0, 0.02)


def chirp(times, first=2.0, last=1.6, swings=22):
    """A swing whose period falls evenly from swing to swing, released at rest; the times at which its swings end are ``ends``."""
    ends = np.concatenate([[0.0], np.cumsum(np.linspace(first, last, swings))])
    return np.exp(-times / 60) * np.cos(2 * np.pi * np.interp(times, ends, np.arange(swings + 1))), ends


def test_ten_swings_take_as_long_as_a_stop_watch_shows():
    times = TIMES[TIMES < 39.0]
    swing, ends = chirp(times)
    first, last = timed(times, swing, 2.0)
    assert first.swings == last.swings == 10
    assert first.period == pytest.approx((ends[10] - ends[0]) / 10, abs=0.012)
    assert last.period == pytest.approx((ends[-1] - ends[-11]) / 10, abs=0.025)
    assert 0.8 < first.amplitude < 0.98 and last.amplitude < first.amplitude


def test_they_follow_the_period_that_is_reported():
    swing, _ = chirp(TIMES)
    right, wrong = timed(TIMES, swing, 2.0), timed(TIMES, swing, 2.2)
    assert wrong[0].period == pytest.approx(1.1 * right[0].period)


def test_swings_in_a_hole_are_counted():
    there = (TIMES < 8.1) | (TIMES > 14.3)
    first, _ = timed(TIMES[there], np.cos(np.pi * TIMES[there]), 2.0)
    assert first.period == pytest.approx(2.0, abs=0.01)


def test_of_one_swing_nothing_is_timed():
    assert timed(TIMES[:140], np.cos(np.pi * TIMES[:140]), 2.0) is None


def test_an_answer_tells_them():
    model = swingdown.Model(("viscous",), {"natural_frequency": 3.0, "viscous_ratio": 0.02})
    swing = swingdown.simulate(model, np.arange(0, 50, 0.04), 1.2)
    noise = 1e-3 * np.random.default_rng(3).standard_normal(swing.size)
    answer = swingdown.fit(swing["time"].values, swing.values + noise, unit="rad", fitted=("viscous",))
    (told,) = answer.to_dict()["timed"]
    assert told["swings"] == 10
    ends = 2 * np.pi / 3.0
    assert ends < told["last"]["period_s"] < told["first"]["period_s"] < answer["period"].value
    middle = (
        5.25 * told["first"]["period_s"]
    )  # the first passage comes a quarter of a swing after the release
    assert told["first"]["amplitude_rad"] == pytest.approx(1.2 * np.exp(-0.02 * 3.0 * middle), rel=0.06)


def test_two_whole_swings_are_the_fewest():
    """They take five passages of the middle; the period is that of both together."""
    times = TIMES[TIMES < 4.6]
    first, last = timed(times, np.cos(np.pi * times), 2.0)
    assert first == last and first.swings == 2 and first.period == pytest.approx(2.0, abs=1e-3)
    times = TIMES[TIMES < 4.4]
    assert timed(times, np.cos(np.pi * times), 2.0) is None
