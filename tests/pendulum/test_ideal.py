"""How much longer a large swing takes than a small one."""

import numpy as np
import pytest
from scipy.integrate import quad

from swingdown.pendulum.ideal import LARGEST, lengthening, reached


def by_quadrature(amplitude):
    """The same by the time from the middle to the turn, with sin(angle / 2) = sin(amplitude / 2) sin(phase)."""
    share = np.sin(amplitude / 2)
    return quad(lambda phase: 1 / np.sqrt(1 - (share * np.sin(phase)) ** 2), 0, np.pi / 2)[0] * 2 / np.pi


def test_it_is_the_period_of_the_undamped_pendulum_whichever_side_it_swings_to():
    amplitudes = np.array([0.0, 0.1, -0.1, 1.0, np.pi / 2, 2.9])
    found = lengthening(amplitudes)
    assert found == pytest.approx([by_quadrature(one) for one in amplitudes], rel=1e-10)
    assert found[0] == 1 and found[4] == pytest.approx(1.18034, rel=1e-5)


def test_near_the_top_it_stays_finite():
    assert lengthening(np.pi) == lengthening(LARGEST) == pytest.approx(by_quadrature(3.0), rel=1e-9)


def test_a_pendulum_that_is_so_fast_where_it_hangs_turns_where_its_energy_is_used_up():
    angle = np.array([-2.5, -0.3, 0.0, 0.3, 2.5])
    fast = np.sign(angle) * np.sqrt(2 * (1 - np.cos(angle)))
    assert reached(fast) == pytest.approx(angle)
    assert reached(np.array([2.5, -2.5])) == pytest.approx([np.pi, -np.pi])  # it goes over
    assert reached(fast, "linear") == pytest.approx(fast)
