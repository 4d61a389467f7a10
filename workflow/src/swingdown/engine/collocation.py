"""Constants of Gauss-Legendre collocation on [0, 1], to more digits than a double holds."""

from functools import cache

import mpmath

NODES = 16
LOCKSTEP_NODES = 8  # for fits side by side: half as many over half as long take less work for the same


@cache
def collocation(count=NODES):
    """The tables by name for ``count`` nodes: ``nodes``, ``first`` and ``second`` (integrals of the Lagrange basis up to
    each node, once and twice), ``reciprocal`` (of 1, 2, ...), ``monomial`` (node values to coefficients of powers of
    2x - 1), ``weights`` (of the integral) and ``tail`` (node values to the last two Legendre coefficients). Lists of
    floats, or of lists of floats, row by row.
    """
    with mpmath.workdps(60):
        ends = mpmath.polyroots(
            mpmath.taylor(lambda z: mpmath.legendre(count, z), 0, count)[::-1], maxsteps=200, extraprec=200
        )
        xi = sorted(mpmath.re(root) for root in ends)
        powers = mpmath.matrix(count, count)
        for i, value in enumerate(xi):
            for k in range(count):
                powers[i, k] = value**k
        monomial = powers**-1
        first, second = mpmath.matrix(count, count), mpmath.matrix(count, count)
        for i, value in enumerate(xi):
            for j in range(count):
                # with x = (xi + 1) / 2: the integral from x = 0 of xi^k dx, and of (x_i - x) xi^k dx
                once = [(value ** (k + 1) - (-1) ** (k + 1)) / (k + 1) / 2 for k in range(count)]
                raised = [(value ** (k + 2) - (-1) ** (k + 2)) / (k + 2) / 2 for k in range(count)]
                first[i, j] = mpmath.fsum(monomial[k, j] * once[k] for k in range(count))
                second[i, j] = mpmath.fsum(
                    monomial[k, j] * (value * once[k] - raised[k]) / 2 for k in range(count)
                )
        weights = [2 / ((1 - z**2) * mpmath.diff(lambda u: mpmath.legendre(count, u), z) ** 2) for z in xi]
        tail = [
            [(2 * k + 1) / mpmath.mpf(2) * weights[j] * mpmath.legendre(k, xi[j]) for j in range(count)]
            for k in (count - 2, count - 1)
        ]
        rows = lambda matrix: [[float(matrix[i, j]) for j in range(count)] for i in range(count)]  # noqa: E731
        return {
            "nodes": [float((z + 1) / 2) for z in xi],
            "first": rows(first),
            "second": rows(second),
            "monomial": rows(monomial),
            "reciprocal": [1 / (k + 1) for k in range(count + 2)],
            "weights": [float(weight / 2) for weight in weights],
            "tail": [[float(value) for value in row] for row in tail],
        }
