"""Linear regression on known laws and a smooth curve of any shape, with a band that holds both noise and what the laws do not follow.

The curve is a Gaussian process; its size and its length are not chosen, but summed over by their marginal likelihood (Rasmussen and
Williams, Gaussian Processes for Machine Learning, 2006, 2.2, 5.4), so that a band knows how little the data may say of them. Noise has a size that the residuals
tell (restricted likelihood), and where neighbouring residuals are alike, their colour widens the band.
"""

from dataclasses import dataclass

import numpy as np
from scipy.special import logsumexp, stdtrit

from ..arrays import Floats
from ..fitting.colour import autoregression

_WIDTHS = (0.35, 0.8, 1.8)  # of the curve's features, in the logarithm of its argument
_SIZES = 8  # of the curve over that of the laws, evenly in the logarithm
_SHARE = 3.0  # times of the whole that a single law may be
_FEWEST = 3.0  # degrees of freedom that the noise is known to
_LONG = 40  # observations, from which a colour is asked for


@dataclass(frozen=True)
class Posterior:
    """What is known of the coefficients (laws, then the curve's nodes; then what is fixed besides): mean, covariance, and degrees of
    freedom. ``residual`` is over its standard uncertainty, ``noise`` the size of the noise over what was stated."""

    mean: Floats
    covariance: Floats
    freedom: float
    residual: Floats
    noise: float

    @property
    def factor(self) -> float:
        """The k of a band of 95 %."""
        return float(stdtrit(self.freedom, 0.975))

    def at(self, rows: Floats) -> tuple[Floats, Floats]:
        """Value and standard uncertainty of sums of the coefficients (row, coefficient)."""
        size = rows.shape[1]
        variance = np.einsum("ri,ij,rj->r", rows, self.covariance[:size, :size], rows)
        return rows @ self.mean[:size], np.sqrt(np.maximum(variance, 0.0))


def regression(
    observed: Floats,
    error: Floats,
    laws: Floats,
    curve: Floats,
    besides: Floats,
    nodes: Floats,
    scale: float,
    least: float,
) -> Posterior:
    """The ``Posterior`` of ``observed`` = laws · a + curve · h + besides · b + noise.

    ``error`` are standard uncertainties, right but for a common factor. ``laws`` (observation, law) have coefficients of the size ``scale``,
    ``curve`` (observation, node) has the values of a smooth curve at ``nodes``, of a size from ``least`` to 1 times ``scale``; of ``besides``
    nothing is known.
    """
    columns = np.hstack([laws, curve, besides]) / error[:, np.newaxis]
    target = observed / error
    gram, right, power = columns.T @ columns, columns.T @ target, float(target @ target)
    n, first, size = target.size, laws.shape[1], curve.shape[1]
    freedom = max(n - besides.shape[1], 1)
    found = []
    for width in _WIDTHS:
        root = np.linalg.cholesky(kernel(nodes, width))
        for share in np.geomspace(least, 1.0, _SIZES):
            found.append(
                _one(gram, right, power, root, scale * np.array([_SHARE, share]), (first, size), freedom)
            )
    weights = np.exp([one[0] for one in found] - logsumexp([one[0] for one in found]))
    mean = sum(w * one[1] for w, one in zip(weights, found, strict=True))
    covariance = sum(
        w * (one[2] + np.outer(one[1] - mean, one[1] - mean)) for w, one in zip(weights, found, strict=True)
    )
    noise = float(np.sqrt(sum(w * one[3] for w, one in zip(weights, found, strict=True))))
    free = max(float(sum(w * one[4] for w, one in zip(weights, found, strict=True))), _FEWEST)
    residual = target - columns @ mean
    covariance = covariance * _slow(residual)
    return Posterior(mean, covariance, free, residual, noise)


def kernel(nodes: Floats, width: float) -> Floats:
    """The covariance of a smooth curve of size 1 at its nodes."""
    apart = (nodes[:, np.newaxis] - nodes) / width
    return np.exp(-0.5 * apart**2) + 1e-8 * np.eye(nodes.size)


def _one(
    gram: Floats,
    right: Floats,
    power: float,
    root: Floats,
    sizes: Floats,
    counts: tuple[int, int],
    freedom: int,
) -> tuple[float, Floats, Floats, float, float]:
    """Logarithm of the marginal likelihood, mean, covariance, variance of the noise and its degrees of freedom for one size and width."""
    first, size = counts
    whole = np.eye(len(gram))
    whole[:first, :first] *= sizes[0]
    whole[first : first + size, first : first + size] = sizes[1] * root
    known = np.zeros(len(gram))
    known[: first + size] = 1.0
    inside = whole.T @ gram @ whole
    normal = inside + np.diag(known)
    ridge = np.sqrt(np.diag(normal))
    lower = np.linalg.cholesky(normal / np.outer(ridge, ridge) + 1e-13 * np.eye(len(gram)))
    solved = np.linalg.solve(lower, (whole.T @ right) / ridge)
    variance = max(power - float(solved @ solved), 1e-12 * power) / freedom
    inverse = np.linalg.solve(lower, np.diag(1 / ridge))
    covariance = inverse.T @ inverse
    mean = whole @ (inverse.T @ solved)
    likelihood = -float(np.log(np.diag(lower)).sum() + np.log(ridge).sum()) - 0.5 * freedom * np.log(variance)
    used = float(np.einsum("ij,ji->", covariance, inside)) - (len(gram) - first - size)
    return likelihood, mean, variance * (whole @ covariance @ whole.T), variance, freedom - used


def _slow(residual: Floats) -> float:
    """The variance of slow errors over that of independent ones as large, at least 1."""
    if residual.size < _LONG:
        return 1.0
    power = float(residual @ residual) / residual.size
    colour = autoregression([residual], highest=4)
    return max(1.0, float(colour.spectrum(2 * residual.size)[0]) / power) if power > 0 else 1.0
