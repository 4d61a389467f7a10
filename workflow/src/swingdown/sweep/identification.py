"""Which model describes a noisy swing: every model fitted to draws of one simulated term, by norm and by evidence."""

import math
from dataclasses import dataclass

import numpy as np

from ..engine.trajectory import simulate, simulate_each
from ..fitting.batch import fit_batch
from ..fitting.least_squares import fit_trajectory
from ..fitting.nested import contains
from ..pendulum.catalogue import catalogue
from ..pendulum.model import Model
from ..studies.noise import add_noise
from .draws import noise_key, stream, value_of
from .impossible import IMPOSSIBLE, reason

_BLOCK = 64  # draws held in memory at a time
# trajectories of a fit: side by side with others they cost little, and one that runs out of them is made again, alone
_MOST, _AGAIN = 300, 100
# name: unit, meaning
VARIABLES = {
    "norm": ("degrees", "RMS of fit minus noise-free truth"),
    "residual_norm": ("degrees", "RMS of noisy data minus fit"),
    "bic": ("1", "Bayesian information criterion, residuals taken for independent"),
    "converged": (None, "whether the fit ended at a stationary point"),
}
DIMENSION = "fitted"  # what every variable is listed by, beside cell and draw


@dataclass(frozen=True)
class _Cell:
    """What the draws of a cell share: times (s), noise-free swing (rad), and where each model's fits begin."""

    settings: dict
    key: str
    times: np.ndarray
    truth: np.ndarray
    release_angle: float
    begin: dict  # None for a model that has no fit

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
    """The ``VARIABLES`` of ``count`` draws from index ``first`` on of one cell, arrays (count, fitted) by name, and a reason.

    A model's fits start where it comes closest to the noise-free swing; one that ends above a smaller model inside it, or
    that is not stationary, is made again from the optima of those. What cannot be fitted is NaN and not converged (every
    draw of a model that cannot be fitted to the noise-free swing). Where no such swing can be computed nothing is fitted, and
    the reason says why; else it is empty. Where nothing is drawn (``quantisation``) all draws are the first one.
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
        for label in sorted(labels, key=_size):
            fitted[label] = _fitted(cell, label, noisy, fitted)
        for column, label in enumerate(labels):
            for name, values in _told(cell, label, noisy, *fitted[label]).items():
                found[name][block.start : block.stop, column] = values
    if alike > 1:
        found = {name: np.repeat(values[:1], alike, axis=0) for name, values in found.items()}
    return found, ""


def make(settings):
    """What the draws of a cell share; what the engine raised comes back where there is no such swing."""
    model, times, release, truth = _swing(settings)
    begin = {}
    for one in sorted(settings["simulation.fitted"], key=_size):
        guess = [begin[other] for other in begin if contains(one, other) and begin[other]]
        begin[one] = _noise_free(one, times, truth, model, guess)
    return _Cell(settings, noise_key(settings), times, truth, release, begin)


def foresee(settings):
    """Nothing; where the swing of a cell cannot be computed, what the engine raised comes back."""
    _swing(settings)


def _swing(settings):
    """The simulated model, times (s), release angle (rad) and noise-free swing (rad) of a cell."""
    duration, rate = settings["simulation.duration_s"], settings["simulation.sampling_rate_hz"]
    times = np.arange(round(duration * rate) + 1) / rate
    release = math.radians(settings["simulation.release_angle_deg"])
    (label,) = settings["simulation.simulated"]
    options = settings["model.restoring"], settings["model.form"]
    model = Model(label, {}, {}, *options, catalogue(settings.get("effects")))
    model = model.with_values({name: value_of(settings, name) for name in model.parameters})
    return model, times, release, simulate(model, times, release)


def _noise_free(label, times, truth, model, guess):
    """A model with the values that come closest to the noise-free swing: the truth, where it contains it; None if there are none."""
    wider = model.with_effects(label.split("+"))
    if label == model.label or contains(label, model.label):
        return wider.with_values({name: model.values.get(name, 0.0) for name in wider.parameters})
    try:
        return fit_trajectory(wider, times, truth, start="free", guess=guess).model
    except IMPOSSIBLE:
        return None


def _fitted(cell, label, noisy, smaller):
    """Values (draw, free), sums of squares (rad^2) and convergence of one model's fits to a block of draws."""
    start = cell.settings["simulation.start"]
    if cell.begin[label] is None:
        return np.full((len(noisy), 0), np.nan), np.full(len(noisy), np.nan), np.zeros(len(noisy), bool)
    batch = fit_batch(cell.begin[label], cell.times, noisy, cell.release_angle, start=start, most=_MOST)
    values, rss, converged = batch.values, batch.rss.copy(), batch.converged.copy()
    inside = {
        other: found for other, found in smaller.items() if contains(label, other) and cell.begin[other]
    }
    lowest = np.fmin.reduce([found[1] for found in inside.values()]) if inside else np.full(rss.shape, np.inf)
    for k in np.flatnonzero(~converged | ~np.isfinite(rss) | (rss > lowest * (1 + 1e-9))):
        for other, found in inside.items():
            if not np.all(np.isfinite(found[0][k])):
                continue
            again = fit_batch(*_from(cell, label, other, found[0][k], noisy[k]), start=start, most=_AGAIN)
            if (
                again.rss[0] < rss[k]
                or not np.isfinite(rss[k])
                or (again.converged[0] and not converged[k] and again.rss[0] <= rss[k])
            ):
                values[k], rss[k], converged[k] = again.values[0], again.rss[0], again.converged[0]
        rss[k] = rss[k] if np.isfinite(rss[k]) else np.nan
    return values, rss, converged


def _from(cell, label, other, values, noisy):
    """What ``fit_batch`` takes to fit one draw from the optimum of a smaller model: model, times, series, release."""
    model, smaller = cell.begin[label], cell.begin[other].parameters
    known = dict(zip(smaller, map(float, values), strict=False))
    release = tuple(map(float, values[len(smaller) :])) or (float(noisy[0]), 0.0)
    return (
        model.with_values({name: known.get(name, 0.0) for name in model.parameters}),
        cell.times,
        noisy[np.newaxis],
        *release,
    )


def _told(cell, label, noisy, values, rss, converged):
    """The ``VARIABLES`` of one model's fits, by name."""
    model, samples, free = cell.begin[label], cell.times.size, values.shape[1]
    if model is None:
        return {"converged": converged}
    size = len(model.parameters)
    slots = np.zeros((len(noisy), size + 2))
    slots[:, size] = noisy[:, 0]  # at rest at the first noisy sample, where the release is not fitted
    slots[:, :free] = values
    series = simulate_each(model, cell.times, slots)
    return {
        "norm": np.degrees(np.sqrt(np.mean(np.square(series - cell.truth), axis=1))),
        "residual_norm": [math.degrees(math.sqrt(one / samples)) for one in rss],
        "bic": [
            samples * math.log(one / samples) + free * math.log(samples) if one > 0 else math.nan
            for one in rss
        ],
        "converged": converged,
    }


def _size(label):
    return label.count("+")
