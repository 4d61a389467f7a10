"""Sparse Bayesian learning on the weak form's columns: a term is named where its coefficient is plainly not nothing.

Each coefficient has a prior variance of its own, found from the evidence; most go to nothing (Tipping, J. Mach. Learn. Res. 1,
211 (2001); for equations of motion: Zhang and Lin, Proc. R. Soc. A 474, 20180305 (2018)), as scikit-learn has it. The base is
taken off first and columns that nothing tells apart are one, as for pysindy's sparse regression; rows count as independent.
"""

import warnings

import numpy as np
from campaigns import period
from sindy import SEED, WEAK, _beside, _groups, _integrals, _names, _system, _width
from sklearn.linear_model import ARDRegression

SURE = (
    6.0  # posterior standard deviations from nothing: chosen on campaigns of another seed than the figures'
)


def named(swings, lacks=()):
    """The terms named, each a tuple of the effects it may stand for; ``lacks`` names effects that are not in the catalogue."""
    terms = [one for one in WEAK.terms if one.effects[0] not in lacks]
    length = np.median([period(*one) for one in swings])
    state = np.random.get_state()  # noqa: NPY002, pysindy places its test functions by this generator
    np.random.seed(SEED)  # noqa: NPY002
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            columns, target, _ = _system(swings, terms, length, _integrals, WEAK.smooth)
    finally:
        np.random.set_state(state)  # noqa: NPY002
    groups = _groups(columns)
    first = [min(group) for group in groups]
    beside, left = _beside(columns, target)
    beside = beside[:, first] / np.linalg.norm(beside[:, first], axis=0)
    left = left / np.std(left)
    fit = ARDRegression(fit_intercept=False, max_iter=500).fit(beside, left)
    kept = np.flatnonzero(fit.lambda_ < fit.threshold_lambda)
    spread = np.zeros(fit.coef_.size)
    spread[kept] = np.sqrt(np.diag(fit.sigma_))
    sure = np.abs(fit.coef_) > SURE * np.where(spread > 0, spread, np.inf)
    owners = [one for one in terms for _ in range(_width(one))]
    found = [
        _names(owners, group, value, lacks)
        for group, value, plain in zip(groups, fit.coef_, sure, strict=True)
        if plain
    ]
    return list(dict.fromkeys(found))
