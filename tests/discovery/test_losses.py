"""What half-swings show without a model: loss, period and middle, of a pendulum and of a wheel on a spring, beyond the top too."""

import numpy as np
import pytest

from swingdown.discovery.see.losses import half_swings
from swingdown.engine.trajectory import simulate
from swingdown.pendulum.model import Model

FREQUENCY = 3.3  # rad/s
TIMES = np.arange(0, 60, 0.02)  # s
RATIO = 0.01


def swung(release, restoring):
    """A viscous pendulum's angle."""
    model = Model("viscous", {"natural_frequency": FREQUENCY, "viscous_ratio": RATIO}, restoring=restoring)
    return simulate(model, TIMES, release)


@pytest.mark.parametrize("release", [0.5, 2.5, 4.0])
def test_a_wheel_on_a_spring_keeps_its_period_and_loses_the_same_share_from_any_angle(release):
    table = half_swings(TIMES, swung(release, "linear"), FREQUENCY, "linear")
    assert table["amplitude_rad"].max() > 0.9 * release
    assert table["period_ratio"].to_numpy() == pytest.approx(1, abs=2e-3)
    assert table["energy_loss"].to_numpy() == pytest.approx(1 - np.exp(-2 * np.pi * RATIO), rel=0.05)


def test_a_pendulum_s_period_is_held_against_that_of_its_amplitude():
    table = half_swings(TIMES, swung(2.5, "sine"), FREQUENCY)
    assert table["amplitude_rad"].max() > 2.2
    assert table["period_ratio"].to_numpy() == pytest.approx(1, abs=0.02)


def test_turning_points_beyond_the_top_are_no_half_swings_of_a_pendulum():
    wheel = swung(4.0, "linear")
    table = half_swings(TIMES, wheel, FREQUENCY)
    assert 0 < len(table) < len(half_swings(TIMES, wheel, FREQUENCY, "linear"))
    assert table["amplitude_rad"].max() < np.pi
    assert np.isfinite(table.to_numpy()).all()


def test_a_turning_point_that_is_missing_makes_no_small_half_swing():
    swing = swung(0.5, "sine")
    table = half_swings(TIMES, swing, FREQUENCY)
    turn = table["time_s"].iloc[20] + np.pi / FREQUENCY / 2
    seen = np.abs(TIMES - turn) > 0.3
    holed = half_swings(TIMES[seen], swing[seen], FREQUENCY)
    assert len(holed) == len(table) - 2
    assert holed["amplitude_rad"].to_numpy() == pytest.approx(np.interp(holed["time_s"], table["time_s"], table["amplitude_rad"]), rel=1e-3)  # fmt: skip
