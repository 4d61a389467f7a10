"""The free courses of frequency and loss beside a law: what they take from a swing, and when one is worth its price."""

import numpy as np
import pytest
from scipy.special import ellipk

from swingdown.fitting.course import Free, Pieces, _chosen

TIMES = np.arange(0, 20, 0.02)


def piece(angle):
    """The pieces of a swing that lies there as it was read."""
    slopes = np.cos(6 * TIMES)[np.newaxis]
    return Pieces(np.zeros(1, dtype=int), slopes, 0 * TIMES, np.ones(TIMES.size), angle, 0.02, 1.0)


def beside(one):
    """The free courses beside a law that follows this swing to a milliradian."""
    return Free([one], np.zeros((1, 1)), np.ones(1, dtype=bool), 1e-6 * TIMES.size)


def test_a_swing_tells_its_amplitude_its_loss_and_by_how_much_a_larger_one_is_slower():
    """The frequency of an amplitude A is pi / (2 K(sin^2(A/2))) of that of small swings (Nayfeh and Mook 1979)."""
    amplitude = 0.5 * np.exp(-0.02 * TIMES)
    found = beside(piece(amplitude * np.cos(6 * TIMES))).leading
    middle = slice(100, -100)
    assert np.exp(found.level)[middle] == pytest.approx(amplitude[middle], rel=0.02)
    assert found.pace[middle] == pytest.approx(0.02, rel=0.1)
    assert found.frequency == pytest.approx(6, rel=0.01)
    frequency = 6 * np.pi / 2 / ellipk(np.sin(amplitude / 2) ** 2)
    assert found.bend[middle] == pytest.approx(np.gradient(frequency, np.log(amplitude))[middle], rel=0.05)


@pytest.mark.parametrize(
    ("of_frequency", "of_loss", "of_both", "kinds"),
    [
        (0.9, 0.9, 1.9, {(0, 0)}),
        (1.1, 0.9, 1.9, {(0, 0), (1, 0)}),
        (1.1, 1.1, 2.1, {(0, 0), (1, 0), (0, 1), (1, 1)}),
    ],
)
def test_a_course_counts_where_it_gains_more_than_its_price(of_frequency, of_loss, of_both, kinds):
    gains = np.array([[0.0, of_loss], [of_frequency, of_both]])
    assert {(f, g) for f, g, gain in _chosen(gains) if gain > 0 or (f, g) == (0, 0)} == kinds


@pytest.mark.parametrize("value", [0.0, 0.3, np.inf])
def test_a_fit_that_does_not_move_has_no_courses(value):
    with np.errstate(invalid="ignore"), pytest.raises(np.linalg.LinAlgError):
        beside(piece(np.full(TIMES.size, value)))
