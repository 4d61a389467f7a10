"""The project's minimiser on bounds, and on functions that fail; on NIST's certified fits: tests/trust."""

import numpy as np
import pytest

from swingdown.errors import InputError
from swingdown_trials.certified.minimum import least_squares


def both(x):
    """Rosenbrock's valley."""
    return np.array([10 * (x[1] - x[0] ** 2), 1 - x[0]]), np.array([[-20 * x[0], 10.0], [-1.0, 0.0]])


def test_bounds_hold_by_an_active_set():
    free = least_squares(both, [-1.2, 1.0])
    assert free.converged and free.x == pytest.approx([1, 1], abs=1e-7)
    held = least_squares(both, [-1.2, 1.0], upper=[0.5, np.inf])
    assert held.converged and held.x[0] == 0.5 and held.x[1] == pytest.approx(0.25, abs=1e-9)
    corner = least_squares(both, [2.0, 3.0], lower=[1.5, 2.5], upper=[4, 4])
    assert corner.x[0] >= 1.5 and corner.converged
    outside = least_squares(both, [9.0, 9.0], upper=[0.5, 0.1])
    assert outside.x == pytest.approx([0.316227766, 0.1], abs=0.2) and np.all(outside.x <= [0.5, 0.1])


def test_a_minimum_that_is_not_reached_is_not_called_one():
    assert not least_squares(both, [-1.2, 1.0], most=3).converged


def test_a_search_at_its_roundings_end_stops_there():
    start = 1.01

    def rough(x):  # every other point is worse by more than the slopes promise
        return np.array([1.0 + 1e-9 * (x[0] != start), 1e-4 * (x[0] - 1.0)]), np.array([[0.0], [1e-4]])

    found = least_squares(rough, [start])
    assert found.converged and found.x[0] == start and found.evaluations < 50


def test_a_point_that_cannot_be_computed_is_stepped_back_from():
    def narrow(x):
        with np.errstate(invalid="ignore"):
            root = np.sqrt(1.0 - x)
        return np.array([root[0] - 0.9]), np.array([[-0.5 / root[0]]])

    assert least_squares(narrow, [0.99]).x[0] == pytest.approx(0.19, abs=1e-6)
    with pytest.raises(InputError, match="not finite"):
        least_squares(narrow, [2.0])


def test_what_the_function_raises_comes_through():
    def broken(x):
        raise LookupError("mine")

    with pytest.raises(LookupError, match="mine"):
        least_squares(broken, [1.0])


@pytest.mark.parametrize(
    "arguments",
    [([],), ([np.nan, 1.0],), ([1.0, 1.0], [0.0]), ([1.0, 1.0], [2.0, 0.0], [1.0, 1.0]), ([1.0, 1.0, 1.0],)],
)
def test_bad_input_is_told(arguments):
    with pytest.raises(InputError, match="least squares"):
        least_squares(both, *arguments)
