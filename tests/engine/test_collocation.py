"""The tables of collocation integrate polynomials exactly, at the nodes that Gauss and Legendre have."""

import numpy as np
import pytest
from numpy.polynomial import Legendre, Polynomial

from swingdown.engine.collocation import LOCKSTEP_NODES, NODES, collocation


@pytest.fixture(params=[NODES, LOCKSTEP_NODES, 3], ids=str)
def tables(request):
    return request.param, {name: np.array(values) for name, values in collocation(request.param).items()}


def test_nodes_and_weights_are_those_of_gauss_on_0_to_1(tables):
    count, found = tables
    nodes, weights = np.polynomial.legendre.leggauss(count)
    np.testing.assert_allclose(found["nodes"], (nodes + 1) / 2, rtol=1e-13)
    np.testing.assert_allclose(found["weights"], weights / 2, rtol=1e-13)
    assert np.all(np.diff(found["nodes"]) > 0)


def test_a_polynomial_is_integrated_once_and_twice_up_to_each_node(tables):
    count, found = tables
    x = found["nodes"]
    for power in range(count):
        np.testing.assert_allclose(
            found["first"] @ x**power, x ** (power + 1) / (power + 1), rtol=1e-11, atol=1e-16
        )
        twice = x ** (power + 2) / (power + 1) / (power + 2)
        np.testing.assert_allclose(found["second"] @ x**power, twice, rtol=1e-9, atol=1e-16)


def test_values_at_the_nodes_have_the_coefficients_of_their_polynomial(tables):
    """In powers of 2x - 1; the last two of Legendre's tell how far it is from converged."""
    count, found = tables
    asked = np.random.default_rng(1).standard_normal(count)
    values = Polynomial(asked)(2 * found["nodes"] - 1)
    np.testing.assert_allclose(found["monomial"] @ values, asked, atol=1e-9)
    waves = np.random.default_rng(2).standard_normal(count)
    values = Legendre(waves)(2 * found["nodes"] - 1)
    np.testing.assert_allclose(found["tail"] @ values, waves[-2:], atol=1e-12)


def test_reciprocals_are_of_1_and_on_two_beyond_the_nodes(tables):
    count, found = tables
    np.testing.assert_array_equal(found["reciprocal"], 1 / np.arange(1, count + 3))
