"""Ten swings timed together, as with a stop-watch."""

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from scipy.special import softmax
from scipy.stats import theilslopes

import swingdown
from swingdown.arrays import Shown
from swingdown.engine.trajectory import simulate
from swingdown.fitting.passages import both_ways, pace
from swingdown.measurement.slack import of_angles
from swingdown.pendulum.model import Model
from swingdown.studies.pendulums import NOT_DYING, pendulums
from swingdown.studies.quantities import cycle
from swingdown.studies.stop_watch import _run_away, by_stop_watch, timed
from swingdown.studies.unscaled import (
    at_first_swing,
    counted_passages,
    of_first_swings,
    of_last_swings,
    pace_of,
)

TIMES = np.arange(0.0, 40.0, 0.02)


def chirp(times, first=2.0, last=1.6, swings=22):
    """A swing whose period falls evenly from swing to swing, released at rest; the times at which its swings end are ``ends``."""
    ends = np.concatenate([[0.0], np.cumsum(np.linspace(first, last, swings))])
    return np.exp(-times / 60) * np.cos(2 * np.pi * np.interp(times, ends, np.arange(swings + 1))), ends


def test_ten_swings_take_as_long_as_a_stop_watch_shows():
    times = TIMES[TIMES < 39.0]
    swing, ends = chirp(times)
    first, last = timed(times, swing)
    assert first.swings == last.swings == 10
    assert first.period == pytest.approx((ends[10] - ends[0]) / 10, abs=0.012)
    assert last.period == pytest.approx((ends[-1] - ends[-11]) / 10, abs=0.025)
    assert 0.8 < first.amplitude < 0.98 and last.amplitude < first.amplitude


@pytest.mark.parametrize(("begin", "first"), [(0.0, 2.0), (0.4, (2.0 + 2.0 - 0.4 / 21) / 2)])
def test_the_first_swing_begins_at_the_widest_turning_point(begin, first):
    """Of one that is cut before its first passage that is the turning point after it."""
    swing, _ = chirp(TIMES)
    kept = (begin <= TIMES) & (TIMES < 39.0)
    assert of_first_swings(TIMES[kept], swing[kept])["period_first"] == pytest.approx(first, abs=3e-3)


def test_passages_that_run_away_from_the_curve_tell_the_mean():
    noise = 0.02 * np.random.default_rng(5).standard_normal(TIMES.size)
    swing, curve = np.cos(np.pi * TIMES) + noise, np.cos(np.pi * TIMES / 1.01)
    first, last = timed(TIMES, swing, curve)
    assert first.period == pytest.approx(2.0, abs=0.002) and last.period == pytest.approx(2.0, abs=0.002)
    lost = np.where(
        np.abs(TIMES - 2.5) < 0.2, 0.9, swing
    )  # a tracker that follows something else at a passage
    assert timed(TIMES, lost, curve)[0].period == pytest.approx(2.0, abs=0.002)


def test_noise_does_not_move_what_a_curve_tells_that_it_follows():
    off = []
    for seed in range(20):
        noise = 0.3 * np.random.default_rng(seed).standard_normal(TIMES.size)
        first, _ = timed(TIMES, np.cos(np.pi * TIMES) + noise, np.cos(np.pi * TIMES))
        off.append(first.period - 2.0)
    assert np.std(off) < 0.004  # a passage is known to 0.02 s


def test_passages_that_scatter_run_away_by_less_than_they_seem_to():
    halves, noise = np.arange(40), 0.01 * np.random.default_rng(3).standard_normal(40)
    assert _run_away(halves, 0.002 * halves) == pytest.approx(0.002, rel=1e-9)
    assert _run_away(halves, 0.002 * halves + noise) == pytest.approx(0.002, rel=0.2)
    seen = theilslopes(noise, halves)[0]
    assert 0 < _run_away(halves, noise) / seen < 0.7


@pytest.mark.parametrize(("unit", "told"), [("rad", True), ("rad/s", False), ("mm", False)])
def test_an_amplitude_is_told_of_angles_alone(unit, told):
    series = 0.4 * np.exp(-TIMES / 60) * np.cos(np.pi * TIMES)
    shown = [Shown("bob", "", TIMES, series, series, unit=unit)]
    for amplitude in (0.4, np.nan):
        table = pd.DataFrame({"recording": ["bob"], "amplitude_rad": [amplitude], "period_of": ["model"]})
        (one,) = by_stop_watch(shown, table)
        assert (one["first"]["amplitude_rad"] is not None) == (told and np.isfinite(amplitude))


def test_swings_in_a_hole_are_counted():
    there = (TIMES < 8.1) | (TIMES > 14.3)
    swing = np.cos(np.pi * TIMES[there])
    first, _ = timed(TIMES[there], swing)
    assert first.period == pytest.approx(2.0, abs=0.01)


def test_of_one_swing_nothing_is_timed():
    swing = np.cos(np.pi * TIMES[:140])
    assert timed(TIMES[:140], swing) is None


def test_an_answer_tells_them():
    model = swingdown.Model(("viscous",), {"natural_frequency": 3.0, "viscous_ratio": 0.02})
    swing = swingdown.simulate(model, np.arange(0, 50, 0.04), 1.2)
    noise = 1e-3 * np.random.default_rng(3).standard_normal(swing.size)
    answer = swingdown.fit(swing["time"].values, swing.values + noise, unit="rad", fitted=("viscous",))
    (told,) = answer.to_dict()["timed"]
    assert told["swings"] == 10
    ends = 2 * np.pi / 3.0
    assert ends < told["last"]["period_s"] < told["first"]["period_s"] < answer["period"].value
    assert told["first_swing"]["period_s"] == pytest.approx(answer["period"].value, rel=0.01)
    middle = (
        5.25 * told["first"]["period_s"]
    )  # the first passage comes a quarter of a swing after the release
    assert told["first"]["amplitude_rad"] == pytest.approx(1.2 * np.exp(-0.02 * 3.0 * middle), rel=0.06)


def test_two_whole_swings_are_the_fewest():
    """They take five passages of the middle; the period is that of both together."""
    times = TIMES[TIMES < 4.6]
    first, last = timed(times, np.cos(np.pi * times))
    assert first == last and first.swings == 2 and first.period == pytest.approx(2.0, abs=1e-3)
    times = TIMES[TIMES < 4.4]
    assert timed(times, np.cos(np.pi * times)) is None


def test_the_amplitude_is_about_where_the_pendulum_hangs(tmp_path):
    model = swingdown.Model(("viscous",), {"natural_frequency": 3.0, "viscous_ratio": 0.01})
    times, draws = np.arange(0, 40, 0.04), np.random.default_rng(3)
    swing = swingdown.simulate(model, times, 1.4).values + 0.06  # a camera that hangs askew
    places = np.array([np.sin(swing), -np.cos(swing)]) + 1e-3 * draws.standard_normal((2, swing.size))
    np.savetxt(
        tmp_path / "a.csv",
        np.c_[times, places.T],
        fmt="%.6f",
        delimiter=",",
        header="t_s,x_m,y_m",
        comments="",
    )
    recording = swingdown.read(tmp_path / "a.csv")
    answer = recording.fit(fitted=("viscous",))
    assert answer.to_dict()["amplitude_rad"] == pytest.approx(1.4, abs=0.01)
    assert answer["period"].value == pytest.approx(cycle(model, 1.4).period, abs=0.004)


def test_a_middle_that_is_off_moves_no_mean():
    """It is passed later and later on the way up, and earlier and earlier on the way down, of a swing that dies."""
    swing = np.exp(-TIMES / 15) * np.cos(np.pi * TIMES)
    for mean in timed(TIMES, swing + 0.05 * (1 + TIMES / 40)):
        assert mean.period == pytest.approx(2.0, abs=1e-3)


def test_all_passages_tell_the_mean_where_no_model_does():
    """As where the last swing drowns in noise: by the first and the last passage alone the period would be 1.96 s."""
    times = TIMES[TIMES < 9.0]
    swing = np.cos(np.pi * np.where(times > 8.2, times + 0.15, times))
    first, last = timed(times, swing)
    assert first == last and first.swings == 4 and first.period == pytest.approx(2.0, abs=0.025)


def test_a_period_that_falls_at_once_is_that_of_the_first_swing():
    """A smooth course through all passages is too slow for it: it would tell 0.88 s."""
    ends = np.concatenate([[0.0], np.cumsum(0.84 + 0.09 * np.exp(-np.arange(20) / 1.5))])
    times = np.arange(0.0, 14.0, 0.005)
    jitter = 0.006 * np.random.default_rng(0).standard_normal(ends.size)
    phase = np.interp(times, ends + jitter, np.arange(ends.size))
    series = np.exp(-times / 6) * np.cos(2 * np.pi * phase)
    angle = xr.Dataset({"angle": ("time", series)}, {"time": times})
    assert pace_of(angle, times, series)["period_first"] == pytest.approx(ends[1], abs=0.03)


@pytest.mark.parametrize("release", [1.5, 2.2, 2.5])
def test_a_period_that_falls_ever_slower_is_that_of_the_first_swing(release):
    """As of a wide swing: by a straight line the period of 2.71 s from 2.2 rad would be 2.53(5) s."""
    model = swingdown.Model(("viscous",), {"natural_frequency": 3.0, "viscous_ratio": 0.03})
    swing = swingdown.simulate(model, np.arange(0, 30, 0.01), release)
    noise = 1e-3 * np.random.default_rng(1).standard_normal(swing.size)
    told = of_first_swings(swing["time"].values, swing.values + noise)
    off = abs(told["period_first"] - cycle(model, release).period)
    assert off < 2 * told["period_first_u"] < 0.2 * told["period_first"]


def test_what_dies_in_its_turning_points_has_a_loss_however_unsure_the_model():
    model = swingdown.Model(("viscous",), {"natural_frequency": 3.0, "viscous_ratio": 0.02})
    swing = swingdown.simulate(model, np.arange(0, 30, 0.04), 0.5)
    norms = swingdown.fit(swing["time"].values, swing.values, unit="rad", fitted=("viscous",)).fits
    unsure = norms.assign(covariance=1e23 * norms["covariance"])
    assert pendulums(unsure)["model"][0] == "viscous"
    assert pendulums(unsure.assign(narrowing=1 + 0 * norms["narrowing"]))["model"][0] == NOT_DYING


@pytest.mark.parametrize(
    ("off", "left", "told"),
    [(0.03, 0.03, True), (-0.03, 0.03, True), (0.006, 0.03, False), (0.03, 0.002, False)],
)
def test_where_model_and_passages_surely_disagree_the_passages_are_told(off, left, told):
    """A model that leaves a five-hundredth of 14 swings is in none of them off by a thirtieth of a period."""
    model = swingdown.Model(("viscous",), {"natural_frequency": 3.0, "viscous_ratio": 0.02})
    swing = swingdown.simulate(model, np.arange(0, 30, 0.04), 0.5)
    noise = 1e-3 * np.random.default_rng(3).standard_normal(swing.size)
    norms = swingdown.fit(swing["time"].values, swing.values + noise, unit="rad", fitted=("viscous",)).fits
    other = norms.assign(
        period_first=(1 + off) * norms["period_first"], share_left=left + 0 * norms["share_left"]
    )
    found, row = float(other["period_first"].values.ravel()[0]), pendulums(other).iloc[0]
    assert (row["period_s"] == pytest.approx(found, rel=1e-9)) == told
    if told:
        assert row["period_of"] == "passages" and "passages of the middle" in row["note"]


def test_too_few_passages_tell_no_period():
    times = TIMES[TIMES < 1.9]
    swing = np.cos(np.pi * times)
    assert (
        np.isnan(of_first_swings(times, swing)["period_first"])
        and np.isnan(of_last_swings(times, swing)).all()
    )


@pytest.mark.parametrize("drift", [0.0, 4e-5, 4e-4])
def test_a_change_of_the_period_counts_as_far_as_it_is_seen(drift):
    """Akaike's weights: a course on which the period changes has one value more, and has to lower chi-squared by more than two for it."""
    ends = np.concatenate([[0.0], np.cumsum(2.0 * (1 + drift * np.arange(18)))])
    jitter = 2e-3 * np.random.default_rng(2).standard_normal(ends.size)
    times = np.arange(0, ends[-1], 0.01)
    series = np.cos(2 * np.pi * np.interp(times, ends + jitter, np.arange(ends.size)))
    angle = xr.Dataset({"angle": ("time", series)}, {"time": times})
    told = pace_of(angle, times, series)
    found, halves = counted_passages(times, series)
    one = pace(both_ways(found, halves), halves, of_angles([angle]).clock)
    criteria = np.array([0.0, 2 - (one.change / one.u_change) ** 2])  # less the steady one's
    steady, changing = softmax(-criteria / 2)
    first = steady * one.period + changing * one.first
    assert told["period_first"] == pytest.approx(first)
    spread = steady * (one.u_period**2 + (one.period - first) ** 2) + changing * (one.u_first**2 + (one.first - first) ** 2)  # fmt: skip
    assert told["period_first_u"] == pytest.approx(np.sqrt(spread))
    assert told["period_change"] == pytest.approx(changing * one.change)
    spread = changing * one.u_change**2 + steady * changing * one.change**2
    assert told["period_change_u"] == pytest.approx(np.sqrt(spread))
    assert (told["period_change"] > 2 * told["period_change_u"]) == (drift == 4e-4)


def test_a_passage_in_a_hole_is_counted_and_has_no_time():
    """A hole of more than a quarter of a half-swing: in a smaller one the swing is nearly a line."""
    for hole, seen in ((0.1, True), (0.2, False)):  # s on either side of a passage, of half-swings of 1 s
        there = np.abs(TIMES - 4.5) > hole
        found, halves = counted_passages(TIMES[there], np.cos(np.pi * TIMES[there]))
        assert np.isclose(found, 4.5, atol=0.02).any() == seen
        assert halves[-1] == 39 and halves.size == 40 - (not seen)
        assert found == pytest.approx(halves + 0.5, abs=5e-3)


@pytest.mark.parametrize("restoring", ["sine", "linear"])
def test_the_course_of_the_period_is_told_without_a_scale(restoring):
    cells = {"period_first": 2.0, "period_first_u": 0.003, "period_change": -0.1, "period_change_u": 0.004}
    own = xr.Dataset({name: ("fitted", [one]) for name, one in cells.items()}, attrs={"restoring": restoring})
    period, row = at_first_swing(own)
    assert tuple(period) == (2.0, 0.003, "s") and row["last_period_s"] == pytest.approx(1.9)
    assert row["note"].startswith("between the first and the last swing the period goes from 2.0000(30) to 1.9000(50) s")  # fmt: skip
    assert ("small swings needs the scale" in row["note"]) == (restoring == "sine")
    assert row["period_of"] == "passages" and row["amplitude_text"] == "the first swing"
    assert at_first_swing(own.assign(period_change=("fitted", [np.nan]))) == (None, {})
    assert at_first_swing(own.drop_vars("period_first")) == (None, {})


def test_the_last_swings_are_the_mean_of_four_periods():
    """A half-swing apart, so that each half-swing is in two of them."""
    passed = np.cumsum(np.concatenate([[0.3], np.tile([1.0, 1.02, 0.99, 1.01, 1.0, 0.98], 4)]))
    times = np.arange(0, passed[-1] + 0.4, 0.002)
    series = np.sin(
        np.pi * np.interp(times, np.r_[passed[0] - 1, passed, passed[-1] + 1], np.arange(-1, passed.size + 1))
    )
    periods = (passed[2:] - passed[:-2])[-4:]
    mean, u = of_last_swings(times, series)
    assert mean == pytest.approx(periods.mean(), abs=1e-3)
    assert u == pytest.approx(periods.std(ddof=1) / np.sqrt(2), rel=0.15)


def test_a_model_that_follows_a_wide_swing_knows_its_first_period_better_than_a_stop_watch():
    """From 170 degrees the period falls by a tenth from each swing to the next; a parabola through a few is 0.2 s off."""
    times = np.arange(0, 40, 0.02)
    model = Model("viscous", {"natural_frequency": 4.83322, "viscous_ratio": 0.008})
    noise = np.radians(0.3) * np.random.default_rng(1).standard_normal(times.size)
    found = swingdown.fit(times, simulate(model, times, np.radians(170)) + noise)
    assert abs(found["natural_frequency"].value - 4.83322) < 3 * found["natural_frequency"].u < 0.003
    assert abs(found["period"].value - 2.4531) < 3 * found["period"].u < 0.002
    assert "lacks something" not in str(found)
