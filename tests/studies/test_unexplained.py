"""How much of a swing a model leaves, noise aside."""

import numpy as np
import pytest

from swingdown.studies.unexplained import MUCH, doubt, share_left

PERIODS, A_PERIOD = 10, 100  # a part of a period has 25 samples
SERIES = np.sin(2 * np.pi * np.arange(PERIODS * A_PERIOD) / A_PERIOD)
NOISE = np.tile([2.0, -1, -1, 1, -1], PERIODS * A_PERIOD // 5)  # nothing in means over 25


def test_a_tenth_of_the_swing_is_a_tenth_whatever_the_noise():
    for noise in (0.0, 0.3):
        assert share_left(0.1 * SERIES + noise * NOISE, SERIES) == pytest.approx(0.1, rel=1e-9)


def test_noise_alone_is_next_to_nothing_and_the_whole_swing_is_all():
    assert share_left(NOISE, SERIES) == pytest.approx(0.0, abs=1e-12)
    assert share_left(SERIES + 0.2, SERIES) == pytest.approx(1.0)  # where it rests does not count


def test_a_swing_of_few_samples_is_taken_as_it_is():
    few = np.cos(2 * np.pi * np.arange(30) / 5)
    left = 0.1 * few + 0.05 * (-1.0) ** np.arange(30)
    assert share_left(left, few) == pytest.approx(np.std(left) / np.std(few), rel=1e-12)


def test_much_is_told_with_its_share_and_little_is_not():
    assert doubt(0.9 * MUCH, "anna") == ""
    assert "leaves 66 % of anna" in doubt(0.66, "anna")
