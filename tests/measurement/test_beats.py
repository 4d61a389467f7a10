"""Two motions of like strength have no one period: that is asked; what disturbs one motion, or a hand, is not taken for it."""

import numpy as np
import pytest

from swingdown.errors import InputError
from swingdown.measurement.judge import Reading, judge
from swingdown.planning.own import take

TIMES = np.arange(0.0, 40.0, 1 / 30)
RAD = Reading("rad", True, 1.0)
NOISE = np.random.default_rng(5).normal(0, 2e-3, TIMES.size)


def motion(period, size=0.2, after=0.0):
    late = TIMES - after
    return np.where(late < 0, 0.0, size * np.exp(-late / 30) * np.cos(2 * np.pi * late / period))


@pytest.mark.parametrize("second", [0.5, 0.8, 1.0])
@pytest.mark.parametrize("period", [1.2, 1.4])
def test_two_motions_of_like_strength_are_asked_about(second, period):
    signal = motion(1.5) + motion(period, 0.2 * second) + NOISE
    with pytest.raises(InputError, match=f"two motions .* of {period:.3g} s and 1.5 s"):
        judge(TIMES, signal, RAD, "here")


@pytest.mark.parametrize("second", [0.0, 0.1, 0.25])
def test_a_weak_second_motion_is_a_disturbance(second):
    judge(TIMES, motion(1.5) + motion(1.3, 0.2 * second) + NOISE, RAD, "here")


def test_a_second_release_and_a_part_that_shrinks_are_no_beat():
    judge(TIMES, motion(1.5) * (TIMES < 20) + motion(1.5, after=20.0) + NOISE, RAD, "here")
    part = TIMES < 5.5
    judge(TIMES[part], (motion(1.5) + motion(1.3) + NOISE)[part], RAD, "here")


def test_each_of_two_releases_is_used_where_it_is_in_step():
    slipped = TIMES - 0.5 * (TIMES > 33)
    second = np.where(
        TIMES < 18, 0.0, 0.3 * np.exp(-(TIMES - 18) / 30) * np.cos(2 * np.pi * (slipped - 18) / 1.5)
    )
    held = np.where((TIMES > 12) & (TIMES < 18), 0.3, 0.0)
    windows = judge(TIMES, motion(1.5, 0.3) * (TIMES <= 12) + held + second + NOISE, RAD, "here").windows
    assert len(windows) == 2
    assert not windows[0].why and "OUT OF STEP" in windows[1].why and 31 < windows[1].ends < 33.6


def test_what_is_left_out_of_a_release_is_told(tmp_path):
    slipped = TIMES - 0.5 * (TIMES > 33)
    second = np.where(
        TIMES < 18, 0.0, 0.3 * np.exp(-(TIMES - 18) / 30) * np.cos(2 * np.pi * (slipped - 18) / 1.5)
    )
    held = np.where((TIMES > 12) & (TIMES < 18), 0.3, 0.0)
    file = tmp_path / "twice.csv"
    angle = motion(1.5, 0.3) * (TIMES <= 12) + held + second + NOISE
    rows = "\n".join(f"{t:.6f},{y:.6f}" for t, y in zip(TIMES, angle, strict=True))
    file.write_text(f"time (s),angle (rad)\n{rows}\n")
    row = {"recording": "twice", "campaign": "twice", "file": str(file)}
    first, other = take(row, file)
    assert "OUT OF STEP" in other.recording.attrs["remarks"]
    assert "OUT OF STEP" not in first.recording.attrs.get("remarks", "")
    assert 31 < other.recording["time"].values[-1] < 33.6


def test_the_pendulum_that_was_at_rest_beside_another_beats_as_well():
    """It grows at first, and shrinks where the record ends: no hand lifts it, and it is none that swings by itself."""
    part = TIMES < 18  # from one node to the next
    with pytest.raises(InputError, match="two motions .* of 1.3. s and 1.5.? s: from 0 s on its swings grow"):
        judge(TIMES[part], (motion(1.5) - motion(1.37) + NOISE)[part], RAD, "here")
