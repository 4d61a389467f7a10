"""A recording that begins in a hand is used from where the pendulum swings by itself, and says so."""

import numpy as np
import pytest

from swingdown.measurement.angle import to_angle
from swingdown.measurement.recording import ingest
from swingdown.measurement.release import find_release
from swingdown.measurement.sheet import read_sheet


def swing(time, phase=0.0, noise=0.002, seed=1):
    clean = 0.6 * np.exp(-0.05 * time) * np.cos(7.25 * time + phase)
    return clean + noise * np.random.default_rng(seed).standard_normal(time.size)


def held(rate, seconds, seed=1):
    time = np.arange(15 * rate) / rate
    noise = 0.002 * np.random.default_rng(seed).standard_normal(time.size)
    return time, swing(np.maximum(time - seconds, 0), noise=0) + noise


@pytest.mark.parametrize("rate", [30, 100, 250])
def test_a_free_swing_is_used_from_its_first_sample_on(rate):
    time = np.arange(10 * rate) / rate
    for k in range(40):
        assert find_release(time, swing(time, phase=k * np.pi / 20, seed=k)) is None


@pytest.mark.parametrize("rate", [30, 100, 250])
@pytest.mark.parametrize("seconds", [0.7, 1.5, 3.0, 6.0])
def test_a_bob_that_is_held_first(rate, seconds):
    time, signal = held(rate, seconds)
    found = find_release(time, signal)
    assert found is not None
    assert found.released == pytest.approx(seconds, abs=0.08)
    assert seconds + 0.15 < found.free < seconds + 0.35


def test_a_bob_that_is_lifted_first():
    time, signal = held(100, 2.0)
    signal[:200] -= 0.4 * (1 - time[:200] / 2)
    found = find_release(time, signal)
    assert found is not None and found.released == pytest.approx(2.0, abs=0.08)


def test_the_recording_is_kept_and_the_angle_begins_after_the_release(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    time, signal = held(100, 3.0)
    text = "t_s,theta_rad\n" + "".join(f"{t:.2f},{x:.6f}\n" for t, x in zip(time, signal, strict=True))
    (tmp_path / "swing.csv").write_text(text)
    (tmp_path / "sheet.csv").write_text("recording,file,start_s\na,swing.csv,\nb,swing.csv,1\n")
    rows = read_sheet("sheet.csv")
    found = ingest(rows.loc["a"], "sheet.csv")
    assert found.sizes["time"] == 1500 and "released at about 3.0" in found.attrs["remarks"]
    angle = to_angle(found)
    assert 3.15 < float(angle["time"][0]) < 3.35
    assert angle.attrs["expected_samples"] == angle.sizes["time"]
    stated = ingest(rows.loc["b"], "sheet.csv")
    assert "released" not in stated.attrs.get("remarks", "")
    assert float(to_angle(stated)["time"][0]) == 1.0
