"""Which model describes a noisy swing: every model fitted to draws of one simulated term, by norm and by evidence."""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..fitting.batch import Search, fit_batch
from ..fitting.nested import contains
from ..studies.noise import add_noise
from .draws import noise_key, stream
from .impossible import IMPOSSIBLE, reason
from .noise_free import noise_free, simulated

_BLOCK = 256  # draws held in memory at a time
# trajectories of a fit; one that runs out of them is made again from smaller models' optima
_MOST, _AGAIN = 300, 100
# of the variance: what the last step promises to gain; it is taken as foretold (a hundredth of a standard error)
_NEAR = 1e-4
# of trajectories
_COARSENESS = 100
# name: unit, meaning
VARIABLES = {
    "norm": ("degrees", "RMS of fit minus noise-free truth"),
    "residual_norm": ("degrees", "RMS of noisy data minus fit"),
    "bic": ("1", "Bayesian information criterion, residuals taken for independent"),
    "converged": (None, "whether the fit ended at a stationary point"),
}
DIMENSION = "fitted"  # what every variable is listed by, beside cell and draw


class _Fits(NamedTuple):
    """One model's fits to several draws: values (draw, free), sums of squares (rad^2), RMS off the truth (rad), convergence."""

    values: np.ndarray
    rss: np.ndarray
    off: np.ndarray
    converged: np.ndarray


@dataclass(frozen=True)
class _Cell:
    """What the draws of a cell share: times (s), noise-free swing (rad), and where each model's fits begin."""

    settings: dict
    key: str
    times: np.ndarray
    truth: np.ndarray
    begin: dict  # of labels: a ``Begin``, or None for a model that has no fit

    def noisy(self, realization):
        """One noisy swing (rad)."""
        drawn = stream(self.settings, self.key, realization).standard_normal(self.times.size)
        return add_noise(
            self.settings["simulation.noise"], self.truth, self.settings["simulation.snr"], drawn
        )


def entries(settings):
    """The models that are fitted, along ``DIMENSION``."""
    return list(settings["simulation.fitted"])


def fits(settings):
    """The number of fits that one draw takes."""
    return len(settings["simulation.fitted"])


def results(settings, first, count):
    """The ``VARIABLES`` of one cell's draws, arrays (count, fitted) by name, and a reason.

    A model's fits start where it comes closest to the noise-free swing (``noise_free``), and end with a step that promises less than a
    hundredth of a standard error. A fit that ends above a smaller model inside it, or that is not stationary, is made again from the
    optima of those. Where nothing is drawn (``quantisation``) all draws are the first one.

    Parameters
    ----------
    settings
        Those of the cell.
    first, count
        The draws: from index ``first`` on, ``count`` of them.

    Returns
    -------
    tuple
        What cannot be fitted is NaN and not converged. Where no noise-free swing can be computed nothing is fitted, and the reason says
        why; else it is empty.
    """
    labels = settings["simulation.fitted"]
    found = {name: np.full((count, len(labels)), np.nan) for name in ("norm", "residual_norm", "bic")}
    found["converged"] = np.zeros((count, len(labels)), dtype=bool)
    try:
        cell = make(settings)
    except IMPOSSIBLE as error:
        return found, reason(error)
    if settings["simulation.noise"] == "quantisation":
        first, alike, count = 0, count, 1
    else:
        alike = 1
    for start in range(0, count, _BLOCK):
        block = range(start, min(start + _BLOCK, count))
        noisy = np.array([cell.noisy(first + k) for k in block])
        fitted = {}
        for label in sorted(labels, key=lambda label: label.count("+")):
            fitted[label] = _fitted(cell, label, noisy, fitted)
        for column, label in enumerate(labels):
            for name, values in _told(cell, *fitted[label]).items():
                found[name][block.start : block.stop, column] = values
    if alike > 1:
        found = {name: np.repeat(values[:1], alike, axis=0) for name, values in found.items()}
    return found, ""


def make(settings):
    """What the draws of a cell share; what the engine raised comes back where there is no such swing."""
    return _Cell(settings, noise_key(settings), *noise_free(settings))


def foresee(settings):
    """Nothing; where the swing of a cell cannot be computed, what the engine raised comes back."""
    simulated(settings)


def _fitted(cell, label, noisy, smaller):
    """The ``_Fits`` of one model to a block of draws; ``smaller`` has those of other models, by label."""
    if cell.begin[label] is None:
        nothing = np.full(len(noisy), np.nan)
        return _Fits(np.full((len(noisy), 0), np.nan), nothing, nothing, np.zeros(len(noisy), bool))
    found = _fit(cell, label, noisy, _MOST)
    inside = {other: fits for other, fits in smaller.items() if contains(label, other) and cell.begin[other]}
    lowest = (
        np.fmin.reduce([fits.rss for fits in inside.values()]) if inside else np.full(found.rss.shape, np.inf)
    )
    same = lowest * (1 + 10 * _NEAR / cell.times.size)
    doubtful = ~found.converged | ~(found.rss <= same)
    for other, fits in inside.items():
        rows = np.flatnonzero(doubtful & np.isfinite(fits.values).all(axis=1))
        if rows.size:
            start = _from(cell, label, other, fits.values[rows], noisy[rows])
            _take_better(found, rows, _fit(cell, label, noisy[rows], _AGAIN, start))
    for other, fits in inside.items():  # both are there, but for what the searches left
        rows = np.flatnonzero(found.converged & fits.converged & (found.rss > fits.rss) & (found.rss <= same))
        if rows.size:
            whole = _from(cell, label, other, fits.values[rows], noisy[rows])[:, : found.values.shape[1]]
            _take_better(found, rows, _Fits(whole, *(each[rows] for each in fits[1:])))
    found.rss[~np.isfinite(found.rss)] = np.nan
    return found


def _take_better(found, rows, others):
    """Put other fits of some draws in place of those that leave more, or are not stationary and leave no less."""
    before = found.rss[rows]
    better = (others.rss < before) | ~np.isfinite(before)
    better |= others.converged & ~found.converged[rows] & (others.rss <= before)
    for old, new in zip(found, others, strict=True):
        old[rows[better]] = new[better]


def _fit(cell, label, noisy, most, starts=None):
    begin = cell.begin[label]
    search = Search(
        most=most, tolerance=_NEAR / cell.times.size, foretells=True, coarseness=_COARSENESS,
        starts=starts, reference=cell.truth, curvature=begin.curvature,
    )  # fmt: skip
    release, start = (begin.release_angle, begin.release_velocity), cell.settings["simulation.start"]
    fit = fit_batch(begin.model, cell.times, noisy, release, start=start, search=search)
    return _Fits(fit.values, fit.rss, fit.off, fit.converged)


def _from(cell, label, other, values, noisy):
    """Where fits begin that start from the optima of a smaller model: (draw, parameters and release)."""
    names, smaller = cell.begin[label].model.parameters, cell.begin[other].model.parameters
    starts = np.zeros((len(noisy), len(names) + 2))
    for k, name in enumerate(smaller):
        starts[:, names.index(name)] = values[:, k]
    starts[:, len(names)] = noisy[:, 0]
    starts[:, len(names) : len(names) + values.shape[1] - len(smaller)] = values[:, len(smaller) :]
    return starts


def _told(cell, values, rss, off, converged):
    """The ``VARIABLES`` of one model's fits, by name."""
    samples, free = cell.times.size, values.shape[1]
    if not free:
        return {"converged": converged}
    return {
        "norm": np.degrees(off),
        "residual_norm": [math.degrees(math.sqrt(one / samples)) for one in rss],
        "bic": [
            samples * math.log(one / samples) + free * math.log(samples) if one > 0 else math.nan
            for one in rss
        ],
        "converged": converged,
    }
