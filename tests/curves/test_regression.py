"""Laws and a smooth curve beside each other, held against dense algebra over all sizes that the curve may have."""

import numpy as np
import pytest
from scipy.linalg import block_diag
from scipy.optimize import brentq
from scipy.signal import lfilter
from scipy.special import logsumexp
from scipy.stats import norm, t

from swingdown.curves.regression import Design, Posterior, Prior, regression
from swingdown.fitting.coloured_noise import autoregression

NODES = np.linspace(-2.0, 1.0, 7)
SCALE = 0.5


def measured(count, memory=0.0, seed=1):
    """Observations of two laws (one of which may be as large as the curve), a curve, and a middle of their own; errors are stated too small."""
    rng = np.random.default_rng(seed)
    place = np.linspace(-2.0, 1.0, count)
    hats = np.maximum(0.0, 1 - np.abs(place[:, np.newaxis] - NODES) / (NODES[1] - NODES[0]))
    laws, curve = np.exp(place)[:, np.newaxis], np.column_stack([place, hats])
    besides = np.column_stack([np.ones(count), (-1.0) ** np.arange(count)])
    error = 0.02 * (1 + 0.5 * np.cos(place))
    white = lfilter([np.sqrt(1 - memory**2)], [1, -memory], rng.standard_normal(count + 50))[50:]
    observed = (
        0.8 * laws[:, 0] + 0.3 * place + 0.2 * np.sin(3 * place) + besides @ [5.0, 0.1] + 1.5 * error * white
    )
    return observed, error, Design(laws, curve, besides)


def dense(observed, error, design, prior):
    """Mean, covariance, noise, degrees of freedom, and the cases, of whole matrices: V = noise + what the coefficients do, the rest by generalised
    least squares; the noise's size by restricted likelihood."""
    known, fixed = np.hstack(design[:2]), design.besides
    n, laws = observed.size, design.laws.shape[1]
    as_large = design.curve.shape[1] - NODES.size
    inner = np.hstack([known, fixed])
    found = []
    for width in (0.35, 0.8, 1.8):
        smooth = np.exp(-0.5 * ((NODES[:, np.newaxis] - NODES) / width) ** 2) + 1e-8 * np.eye(NODES.size)
        for (of_laws, of_curve), odds in zip(prior.sizes, prior.odds, strict=True):
            before = SCALE**2 * block_diag(
                9 * np.eye(laws), of_laws**2 * np.eye(as_large), of_curve**2 * smooth
            )
            spread = np.diag(error**2) + known @ before @ known.T
            inverse = np.linalg.inv(spread)
            normal = fixed.T @ inverse @ fixed
            left = inverse - inverse @ fixed @ np.linalg.solve(normal, fixed.T @ inverse)
            freedom = n - fixed.shape[1]
            variance = observed @ left @ observed / freedom
            likelihood = (
                -(np.linalg.slogdet(spread)[1] + np.linalg.slogdet(normal)[1] + freedom * np.log(variance))
                / 2
            )
            gain = np.vstack([before @ known.T @ left, np.linalg.solve(normal, fixed.T @ inverse)])
            # a fixed value is known nowhere beforehand: a variance beyond all others stands for that
            open_ = block_diag(before, 1e5 * np.eye(fixed.shape[1]))
            whole = np.diag(error**2) + inner @ open_ @ inner.T
            after = open_ - open_ @ inner.T @ np.linalg.solve(whole, inner @ open_)
            free = np.trace(np.diag(error**2) @ left)
            found.append((likelihood + np.log(odds), gain @ observed, variance * after, variance, free))
    likelihood, means, covariances, variances, frees = (np.array(one) for one in zip(*found, strict=True))
    weights = np.exp(likelihood - logsumexp(likelihood))
    mean = weights @ means
    away = means - mean
    covariance = np.tensordot(weights, covariances, 1) + np.einsum("k,ki,kj->ij", weights, away, away)
    return mean, covariance, np.sqrt(weights @ variances), weights @ frees, (weights, means, covariances)


PRIORS = [Prior.enough(1, NODES, SCALE, 3e-3), Prior.any_size(1, NODES, SCALE, 1e-2, 1e-2)]


@pytest.mark.parametrize("prior", PRIORS, ids=["enough", "any size"])
def test_values_and_covariance_are_those_of_the_whole_mixture(prior):
    observed, error, design = measured(36)
    found = regression(observed, error, design, prior)
    mean, covariance, noise, freedom, _ = dense(observed, error, design, prior)
    u = np.sqrt(np.diag(covariance))
    assert (found.mean - mean) / u == pytest.approx(np.zeros(mean.size), abs=1e-3)
    assert found.covariance / np.outer(u, u) == pytest.approx(covariance / np.outer(u, u), abs=3e-3)
    assert found.noise == pytest.approx(noise, rel=1e-4)
    assert found.freedom == pytest.approx(freedom, rel=1e-3)
    columns = np.hstack(design)
    assert found.residual == pytest.approx((observed - columns @ mean) / error, abs=0.01)


@pytest.mark.parametrize("besides", [0.0, 0.05])
def test_a_band_holds_95_percent_of_the_mixture(besides):
    """Of each curve: what lies within k u about the mean, by the normal distribution of each case; Student's of the noise's freedom widens it."""
    observed, error, design = measured(36)
    found = regression(observed, error, design, PRIORS[0])
    _, _, _, freedom, (weights, means, covariances) = dense(observed, error, design, PRIORS[0])
    rows = np.hstack(design[:2])[[0, 10, 20, 35]]
    value, u, factor = found.band(rows, besides)
    size = rows.shape[1]
    for k, row in enumerate(rows):
        each = np.sqrt(np.einsum("i,kij,j->k", row, covariances[:, :size, :size], row) + besides**2)
        centre = means[:, :size] @ row

        def held(half, each=each, centre=centre, middle=value[k]):
            return weights @ (
                norm.cdf((middle + half - centre) / each) - norm.cdf((middle - half - centre) / each)
            )

        half = brentq(lambda half: held(half) - 0.95, 0, 100 * each.max())
        wider = t.ppf(0.975, freedom) / norm.ppf(0.975)
        assert factor[k] * u[k] == pytest.approx(half * wider, rel=5e-3)
        assert value[k] == pytest.approx(weights @ centre, abs=1e-3 * u[k])
        spread = weights @ (each**2 + (centre - weights @ centre) ** 2)
        assert u[k] == pytest.approx(np.sqrt(spread), rel=2e-3)


def test_slow_errors_widen_all_by_their_spectrum_at_rest():
    """From forty observations on a colour is asked for; of fewer it would be noise."""
    observed, error, design = measured(90, memory=0.8)
    found = regression(observed, error, design, PRIORS[0])
    covariance = dense(observed, error, design, PRIORS[0])[1]
    colour = autoregression([found.residual], highest=4)
    slow = colour.variance / (1 - colour.coefficients.sum()) ** 2 / np.mean(found.residual**2)
    assert slow > 2
    assert np.diag(found.covariance) / np.diag(covariance) == pytest.approx(slow, rel=0.02)
    rows = np.hstack(design[:2])[[10, 60]]
    alone = Posterior(
        found.mean, found.covariance / slow, found.freedom, found.residual, found.noise, found.cases
    )
    assert found.band(rows)[1] == pytest.approx(np.sqrt(slow) * alone.band(rows)[1])
    assert found.band(rows)[2] == pytest.approx(t.ppf(0.975, found.freedom), rel=0.1)


def test_laws_that_are_enough_are_as_probable_as_that_they_are_not():
    enough, any_size = PRIORS
    assert enough.sizes[0] == pytest.approx([3e-3, 3e-3]) and enough.sizes[-1] == pytest.approx([1, 1])
    assert enough.odds[0] == 0.5 and enough.odds.sum() == pytest.approx(1)
    assert np.diff(np.log(enough.sizes[:, 0])) == pytest.approx(np.log(1 / 3e-3) / 7)
    # any variance of the whole is as probable as any other: large sizes are likelier by their square
    whole, curve = any_size.sizes.T
    of_whole = [any_size.odds[whole == one].sum() for one in np.unique(whole)]
    assert of_whole == pytest.approx(np.unique(whole) ** 2 / np.sum(np.unique(whole) ** 2))
    least = np.isclose(curve / whole, 1e-2)
    assert any_size.odds[least].sum() == pytest.approx(0.5)
    assert (np.unique(whole)[0], np.unique(whole)[-1]) == pytest.approx((1e-2, 1.0))
