"""The inverse of J'J that a fit's covariance is made of."""

from types import SimpleNamespace

import numpy as np
import pytest

from swingdown.fitting.covariance import inverse_of


def problem(size, upper=np.inf):
    """What ``inverse_of`` needs of a fit's problem: so many variables below a bound."""
    return SimpleNamespace(lower=np.full(size, -np.inf), upper=np.full(size, float(upper)))


def normal(size, spread=1e4):
    """J'J of columns whose sizes are a factor ``spread`` apart, and which are correlated."""
    slopes = np.random.default_rng(size).standard_normal((3 * size, size))
    slopes[:, -1] += 3 * slopes[:, 0]
    slopes *= np.geomspace(1, spread, size)
    return slopes.T @ slopes


@pytest.mark.parametrize(
    "given",
    [np.diag([1.0, 0.0]), np.ones((2, 2)), np.full((2, 2), np.nan), np.array([[1.0, np.nan], [np.nan, 1.0]]), np.diag([1.0, np.inf])],
)  # fmt: skip
def test_nothing_is_known_of_what_the_data_leave_open(given):
    """Also where a search ran away to where slopes are no numbers any more."""
    with np.errstate(invalid="ignore"):
        found = inverse_of(problem(2), given, np.zeros(2))
    assert np.isnan(found[1, 1]) and np.isnan(found[0, 1])


def test_what_a_bound_holds_is_taken_for_known():
    matrix, at = normal(3), np.array([0.0, 1.0, 0.0])
    found = inverse_of(problem(3, upper=1.0), matrix, at)
    kept = np.ix_([0, 2], [0, 2])
    assert found[kept] == pytest.approx(np.linalg.inv(matrix[kept]), rel=1e-9)
    assert np.isnan(found[1]).all() and np.isnan(found[:, 1]).all()
