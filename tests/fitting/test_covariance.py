"""The inverse of J'J that a fit's covariance is made of."""

from types import SimpleNamespace

import numpy as np
import pytest

from swingdown.engine import interface
from swingdown.engine.trajectory import engine
from swingdown.fitting.covariance import inverse_of

FREE = np.inf


def problem(size, upper=FREE):
    """What ``inverse_of`` needs of a fit's problem: so many variables below a bound."""
    bounds = interface.Bounds(np.full(size, -FREE), np.full(size, float(upper)))
    c = SimpleNamespace(bounds=tuple(map(interface.doubles, bounds)))
    compiled = SimpleNamespace(library=engine())
    return SimpleNamespace(compiled=[compiled], c=c, lower=bounds.lower, upper=bounds.upper)


def normal(size, spread=1e4):
    """J'J of columns whose sizes are a factor ``spread`` apart, and which are correlated."""
    slopes = np.random.default_rng(size).standard_normal((3 * size, size))
    slopes[:, -1] += 3 * slopes[:, 0]
    slopes *= np.geomspace(1, spread, size)
    return slopes.T @ slopes


@pytest.mark.parametrize("size", [1, 2, 5, 40, 192])
def test_the_engine_inverts_as_numpy_does(size):
    matrix, inverse = normal(size), np.empty((size, size))
    bounds = problem(size).c.bounds
    condition = interface.invert_normal(engine(), np.zeros(size), bounds, matrix, inverse)
    scale = np.sqrt(np.outer(np.diag(matrix), np.diag(matrix)))
    least = np.linalg.cond(matrix / scale)
    assert least * (1 - 1e-9) <= condition <= least * size * (1 + 1e-9)
    assert inverse * scale == pytest.approx(np.linalg.inv(matrix / scale), rel=1e-9, abs=1e-9)
    assert np.array_equal(inverse, inverse.T)


def test_with_and_without_the_engine_it_is_the_same():
    matrix, at = normal(5), np.zeros(5)
    assert inverse_of(problem(5), matrix, at, quickly=True) == pytest.approx(
        inverse_of(problem(5), matrix, at), rel=1e-9
    )


@pytest.mark.parametrize("quickly", [True, False])
@pytest.mark.parametrize(
    "given",
    [np.diag([1.0, 0.0]), np.ones((2, 2)), np.full((2, 2), np.nan), np.array([[1.0, np.nan], [np.nan, 1.0]]), np.diag([1.0, np.inf])],
)  # fmt: skip
def test_nothing_is_known_of_what_the_data_leave_open(given, quickly):
    """Also where a search ran away to where slopes are no numbers any more."""
    with np.errstate(invalid="ignore"):
        found = inverse_of(problem(2), given, np.zeros(2), quickly=quickly)
    assert np.isnan(found[1, 1]) and np.isnan(found[0, 1])


def test_what_a_bound_holds_is_taken_for_known():
    matrix, at = normal(3), np.array([0.0, 1.0, 0.0])
    found = inverse_of(problem(3, upper=1.0), matrix, at, quickly=True)
    kept = np.ix_([0, 2], [0, 2])
    assert found[kept] == pytest.approx(np.linalg.inv(matrix[kept]), rel=1e-9)
    assert np.isnan(found[1]).all() and np.isnan(found[:, 1]).all()
