"""Linear regression on known laws and a smooth curve of any shape, with a band that holds both noise and what the laws do not follow.

The curve is a Gaussian process; its size (the least is none to speak of) and its length are not chosen, but summed over by their marginal
likelihood (Rasmussen and Williams, Gaussian Processes for Machine Learning, 2006, 2.2, 5.4), so that a band knows how little the data may say of them. Noise has a size that the residuals
tell (restricted likelihood), and where neighbouring residuals are alike, their colour widens the band.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.special import logsumexp, ndtr, ndtri, stdtrit

from ..arrays import Floats
from ..fitting.coloured_noise import autoregression

_WIDTHS = (0.35, 0.8, 1.8)  # of the curve's features, in the logarithm of its argument
SHARE = 3.0  # times of the whole that a single law may be
_FEWEST = 3.0  # degrees of freedom that the noise is known to
_LONG = 40  # observations, from which a colour is asked for
_UNLIKELY = 1e-3  # of all cases: those that are less likely are left out of a band
_LEVEL = 0.95
_WIDEST = 4.5  # standard uncertainties, beyond which not 1 - 0.95 of any distribution lies (Chebyshev)
_HALVINGS = 20

Banded = tuple[Floats, Floats, Floats]  # values, their standard uncertainties, and the k of a band of 95 %


@dataclass(frozen=True)
class Posterior:
    """What is known of the coefficients (laws, then the curve's nodes; then what is fixed besides): mean, covariance, and degrees of
    freedom. ``residual`` is over its standard uncertainty, ``noise`` the size of the noise over what was stated. It is a mixture of
    ``cases``: their weights, means and covariances."""

    mean: Floats
    covariance: Floats
    freedom: float
    residual: Floats
    noise: float
    cases: tuple[Floats, Floats, Floats]

    def at(self, rows: Floats) -> tuple[Floats, Floats]:
        """Value and standard uncertainty of sums of the coefficients (row, coefficient)."""
        size = rows.shape[1]
        variance = np.einsum("ri,ij,rj->r", rows, self.covariance[:size, :size], rows)
        return rows @ self.mean[:size], np.sqrt(np.maximum(variance, 0.0))

    def band(self, rows: Floats, besides: Floats | float = 0.0) -> Banded:
        """The same, with an independent standard uncertainty ``besides``, and the k of a band of 95 %.

        A few cases with a wide curve have much of the variance and little of the probability, so that k is the mixture's.
        """
        value, own = self.at(rows)
        u, size, (weights, means, covariances) = np.hypot(own, besides), rows.shape[1], self.cases
        variances = np.sum((rows @ covariances[:, :size, :size]) * rows, axis=2)
        with np.errstate(divide="ignore", invalid="ignore"):
            off = (means[:, :size] - self.mean[:size]) @ rows.T / u
            spread = np.sqrt(np.maximum(variances, 0.0) + np.square(besides)) / u
            low, high = np.zeros(value.size), np.full(value.size, _WIDEST)
            for _ in range(_HALVINGS):
                middle = (low + high) / 2
                inside = weights @ (ndtr((middle - off) / spread) - ndtr((-middle - off) / spread))
                low, high = np.where(inside < _LEVEL, middle, low), np.where(inside < _LEVEL, high, middle)
        # the noise is known to so many degrees of freedom in every case
        return value, u, high * stdtrit(self.freedom, (1 + _LEVEL) / 2) / ndtri((1 + _LEVEL) / 2)


class Prior(NamedTuple):
    """What is known before: how many ``laws`` there are, the curve's ``nodes``, the ``scale`` of a law's coefficient, and over it the
    ``sizes`` (case, 2) that laws as large as the curve, and the curve itself, may have, with their ``odds``."""

    laws: int
    nodes: Floats
    scale: float
    sizes: Floats
    odds: Floats

    @classmethod
    def enough(cls, laws: int, nodes: Floats, scale: float, least: float) -> "Prior":
        """That the laws are enough, and the curve of the ``least`` size, is as probable as that they are not."""
        sizes, odds = _enough(least, 8)
        return cls(laws, nodes, scale, np.column_stack([sizes, sizes]), odds)

    @classmethod
    def any_size(cls, laws: int, nodes: Floats, scale: float, least: float, of_curve: float) -> "Prior":
        """That what comes beside ``laws``, however well they do that were chosen because they do well, is again laws that are enough, with a
        curve of the least size ``of_curve`` over theirs; as probable is any variance up to that of the whole (Morris and Lysy,
        Statistical Science 27, 115 (2012))."""
        wholes, (shares, odds) = np.geomspace(least, 1.0, 10), _enough(of_curve, 6)
        sizes = np.stack(np.broadcast_arrays(wholes[:, np.newaxis], np.outer(wholes, shares)), axis=-1)
        likely = np.outer(wholes**2 / np.sum(wholes**2), odds)
        return cls(laws, nodes, scale, sizes.reshape(-1, 2), likely.ravel())


def _enough(least: float, count: int) -> tuple[Floats, Floats]:
    """Sizes from the ``least`` to 1, and their odds: a half that it is the least."""
    sizes = np.geomspace(least, 1.0, count)
    return sizes, np.r_[0.5, np.full(count - 1, 0.5 / (count - 1))]


class Design(NamedTuple):
    """The columns of a regression: ``laws`` (observation, law) with coefficients of some size; ``curve``: laws that are as large as a smooth
    curve, or larger, and the values of that at its nodes; ``besides``, of whose coefficients nothing is known."""

    laws: Floats
    curve: Floats
    besides: Floats


def regression(observed: Floats, error: Floats, design: Design, prior: Prior) -> Posterior:
    """The ``Posterior`` of ``observed`` = laws · a + curve · h + besides · b + noise; ``error`` are standard uncertainties, right but for a
    common factor."""
    columns = np.hstack(design) / error[:, np.newaxis]
    target = observed / error
    gram, right, power = columns.T @ columns, columns.T @ target, float(target @ target)
    n, first, size = target.size, design.laws.shape[1], design.curve.shape[1]
    freedom = max(n - design.besides.shape[1], 1)
    as_large = np.zeros((len(_WIDTHS), size, size))
    as_large[:, :, :] = np.eye(size)
    smooth = slice(size - prior.nodes.size, size)
    as_large[:, smooth, smooth] = [kernel(prior.nodes, width) for width in _WIDTHS]
    roots = np.linalg.cholesky(as_large)
    whole = np.zeros((len(_WIDTHS), len(prior.sizes), len(gram), len(gram)))
    whole[..., :, :] = np.eye(len(gram))
    whole[..., :first, :first] *= prior.scale * SHARE
    shares = prior.scale * np.repeat(prior.sizes, [size - prior.nodes.size, prior.nodes.size], axis=1)
    whole[..., first : first + size, first : first + size] = shares[..., np.newaxis] * roots[:, np.newaxis]
    cases = whole.reshape(-1, *gram.shape)
    likelihood, means, covariances, variances, frees = _each(gram, right, power, cases, first + size, freedom)
    likelihood += np.log(np.tile(prior.odds, len(_WIDTHS)))
    weights = np.exp(likelihood - logsumexp(likelihood))
    mean = weights @ means
    away = means - mean
    covariance = np.tensordot(weights, covariances, 1) + (away.T * weights) @ away
    noise = float(np.sqrt(weights @ variances))
    free = max(float(weights @ frees), _FEWEST)
    residual = target - columns @ mean
    slow = _slow(residual)
    likely = weights > _UNLIKELY
    odds, centres = weights[likely] / weights[likely].sum(), mean + np.sqrt(slow) * away[likely]
    mixture = odds, centres, slow * covariances[likely]
    return Posterior(mean, slow * covariance, free, residual, noise, mixture)


def kernel(nodes: Floats, width: float) -> Floats:
    """The covariance of a smooth curve of size 1 at its nodes."""
    apart = (nodes[:, np.newaxis] - nodes) / width
    return np.exp(-0.5 * apart**2) + 1e-8 * np.eye(nodes.size)


def _each(
    gram: Floats, right: Floats, power: float, whole: Floats, known: int, freedom: int
) -> tuple[Floats, ...]:
    """Logarithms of the marginal likelihood, means, covariances, variances of the noise and its degrees of freedom for each size and width.

    ``whole`` (case, coefficient, coefficient) are roots of the coefficients' covariances, of which the first ``known`` have any.
    """
    inside = np.swapaxes(whole, 1, 2) @ gram @ whole
    normal = inside + np.diag(np.where(np.arange(len(gram)) < known, 1.0, 0.0))
    ridge = np.sqrt(np.diagonal(normal, axis1=1, axis2=2))
    scaled = normal / (ridge[:, :, np.newaxis] * ridge[:, np.newaxis])
    lower = np.linalg.cholesky(scaled + 1e-13 * np.eye(len(gram)))
    inverse = np.linalg.solve(lower, np.eye(len(gram)) / ridge[:, np.newaxis])
    solved = (inverse @ (np.swapaxes(whole, 1, 2) @ right)[..., np.newaxis])[..., 0]
    variance = np.maximum(power - np.sum(solved**2, axis=1), 1e-12 * power) / freedom
    back = whole @ np.swapaxes(inverse, 1, 2)
    means = (back @ solved[..., np.newaxis])[..., 0]
    logarithms = np.log(np.diagonal(lower, axis1=1, axis2=2)).sum(axis=1) + np.log(ridge).sum(axis=1)
    likelihood = -logarithms - 0.5 * freedom * np.log(variance)
    covariances = np.swapaxes(inverse, 1, 2) @ inverse
    used = np.einsum("kij,kji->k", covariances, inside) - (len(gram) - known)
    covariances = variance[:, np.newaxis, np.newaxis] * (back @ np.swapaxes(back, 1, 2))
    return likelihood, means, covariances, variance, freedom - used


def _slow(residual: Floats) -> float:
    """The variance of slow errors over that of independent ones as large, at least 1."""
    if residual.size < _LONG:
        return 1.0
    power = float(residual @ residual) / residual.size
    colour = autoregression([residual], highest=4)
    return max(1.0, float(colour.spectrum(2 * residual.size)[0]) / power) if power > 0 else 1.0
