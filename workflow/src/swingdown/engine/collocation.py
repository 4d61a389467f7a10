"""Constants of 16-node Gauss-Legendre collocation on [0, 1], to more digits than a double holds."""

from functools import cache

import mpmath

NODES = 16


@cache
def collocation():
    """The tables by name: ``nodes``, ``first`` and ``second`` (integrals of the Lagrange basis up to each node, once
    and twice), ``reciprocal`` (of 1, 2, ...), ``monomial`` (node values to coefficients of powers of 2x - 1) and ``tail`` (node values to the
    last two Legendre coefficients). Lists of floats, or of lists of floats, row by row.
    """
    with mpmath.workdps(60):
        ends = mpmath.polyroots(
            mpmath.taylor(lambda z: mpmath.legendre(NODES, z), 0, NODES)[::-1], maxsteps=200, extraprec=200
        )
        xi = sorted(mpmath.re(root) for root in ends)
        powers = mpmath.matrix(NODES, NODES)
        for i, value in enumerate(xi):
            for k in range(NODES):
                powers[i, k] = value**k
        monomial = powers**-1
        first, second = mpmath.matrix(NODES, NODES), mpmath.matrix(NODES, NODES)
        for i, value in enumerate(xi):
            for j in range(NODES):
                # with x = (xi + 1) / 2: the integral from x = 0 of xi^k dx, and of (x_i - x) xi^k dx
                once = [(value ** (k + 1) - (-1) ** (k + 1)) / (k + 1) / 2 for k in range(NODES)]
                raised = [(value ** (k + 2) - (-1) ** (k + 2)) / (k + 2) / 2 for k in range(NODES)]
                first[i, j] = mpmath.fsum(monomial[k, j] * once[k] for k in range(NODES))
                second[i, j] = mpmath.fsum(
                    monomial[k, j] * (value * once[k] - raised[k]) / 2 for k in range(NODES)
                )
        weights = [2 / ((1 - z**2) * mpmath.diff(lambda u: mpmath.legendre(NODES, u), z) ** 2) for z in xi]
        tail = [
            [(2 * k + 1) / mpmath.mpf(2) * weights[j] * mpmath.legendre(k, xi[j]) for j in range(NODES)]
            for k in (NODES - 2, NODES - 1)
        ]
        rows = lambda matrix: [[float(matrix[i, j]) for j in range(NODES)] for i in range(NODES)]  # noqa: E731
        return {
            "nodes": [float((z + 1) / 2) for z in xi],
            "first": rows(first),
            "second": rows(second),
            "monomial": rows(monomial),
            "reciprocal": [1 / (k + 1) for k in range(NODES + 2)],
            "tail": [[float(value) for value in row] for row in tail],
        }
