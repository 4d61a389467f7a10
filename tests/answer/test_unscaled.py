"""Readings of a converter whose scale nobody states: the period at the amplitudes that were there, and none of small swings."""

import numpy as np
import pandas as pd
import pytest

from swingdown.__main__ import main
from swingdown.engine.trajectory import simulate
from swingdown.measurement.apparent_scale import ON_A_SPRING, RELATIVE, apparent_scale
from swingdown.pendulum.model import Model
from swingdown.studies.quantities import quantities

PENDULUM = Model("viscous", {"natural_frequency": 4.2, "viscous_ratio": 0.006})
RELEASE = np.radians(22)


def log(folder, seconds, kept=slice(None)):
    times = np.arange(0, seconds, 0.02)
    reading = (
        512 + 600 * simulate(PENDULUM, times, RELEASE) + np.random.default_rng(1).standard_normal(times.size)
    )
    table = pd.DataFrame({"t_ms": np.round(1e3 * times).astype(int), "adc": np.round(reading).astype(int)})
    table[kept(times) if callable(kept) else kept].to_csv(folder / "log.csv", index=False)


def told(folder, capsys, monkeypatch):
    monkeypatch.chdir(folder)
    assert main(["log.csv", "--quick"]) == 0
    return capsys.readouterr().out, pd.read_csv("log-swingdown/first_answer.csv").iloc[0]


@pytest.mark.parametrize("kept", [slice(None), lambda times: (times < 14) | (times > 15)])
def test_the_period_is_that_of_the_first_swing_and_how_it_changes_is_told(
    tmp_path, capsys, monkeypatch, kept
):
    """Fitted as small swings the period was 1.5024(5) s, which is that of no swing: of the first 1.5098 s, of the last 1.4979 s."""
    log(tmp_path, 40, kept)
    text, row = told(tmp_path, capsys, monkeypatch)
    at = {angle: quantities(PENDULUM, angle)["period"].value for angle in (RELEASE, RELEASE * np.exp(-1))}
    assert abs(row["period_s"] - at[RELEASE]) < 3 * row["period_s_u"] < 3e-3
    said = text.partition("the period goes from ")[2]
    first, last = (
        float(one.partition("(")[0]) for one in said.partition(" s;")[0].partition(" s\n")[0].split(" to ")
    )
    assert (first, last) == pytest.approx(tuple(at.values()), abs=2e-3)
    assert "at the first swing" in text and "the period of small swings needs the scale" in text
    assert "natural frequency" not in text


def test_the_quality_is_that_of_the_pendulum_though_its_period_falls(tmp_path, capsys, monkeypatch):
    """With one period for all swings other laws than the drag made up for it, and the quality was known to a tenth or wrong."""
    log(tmp_path, 40)
    _, row = told(tmp_path, capsys, monkeypatch)
    true = quantities(PENDULUM, RELEASE * np.exp(-np.pi / 2 * 2 * 0.006))["quality"].value
    assert abs(row["quality"] - true) < 3 * row["quality_u"] < 0.06 * true


def test_of_a_few_swings_no_change_is_told(tmp_path, capsys, monkeypatch):
    log(tmp_path, 3.2)
    text, row = told(tmp_path, capsys, monkeypatch)
    assert "the period goes from" not in text and row["period_s"] == pytest.approx(1.51, abs=0.02)


def test_where_no_model_follows_the_readings_the_period_is_the_mean_of_the_first(
    tmp_path, capsys, monkeypatch
):
    """A few swings that die fast and not as any law has it: a curve through the times of so few passages runs away at its ends."""
    times = np.arange(0, 14, 0.05)
    phase = 4 * times + 0.3 * np.sin(0.9 * times)
    reading = np.exp(-0.16 * times) * np.cos(phase) + 0.05 * np.exp(-0.1 * times) * np.cos(1.7 * times)
    table = pd.DataFrame(
        {"t_ms": np.round(1e3 * times).astype(int), "adc": np.round(512 + 400 * reading).astype(int)}
    )
    table.to_csv(tmp_path / "log.csv", index=False)
    text, row = told(tmp_path, capsys, monkeypatch)
    assert "at the first swings" in text and "for the model lacks something" in text
    assert abs(row["period_s"] - 2 * np.pi / 4) < 2 * row["period_s_u"]


def test_what_a_reading_is_worth_by_its_period_alone():
    times, rng = np.arange(0, 60, 0.02), np.random.default_rng(2)
    for release in (0.4, 1.2, 2.0):
        reading = 600 * simulate(PENDULUM, times, release) + rng.standard_normal(times.size)
        assert apparent_scale(times, reading) == pytest.approx(1 / 600, rel=0.03)
    small = 2 * ON_A_SPRING / np.ptp(reading)
    assert apparent_scale(times, reading, "linear") == small
    spring = 600 * np.exp(-times / 40) * np.cos(4.2 * times) + rng.standard_normal(times.size)
    assert apparent_scale(times, spring) == pytest.approx(2 * RELATIVE / np.ptp(spring))
