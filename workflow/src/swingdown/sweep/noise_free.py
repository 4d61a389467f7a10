"""A cell's swing without noise, and where the fits to its noisy draws begin: where each model comes closest to it."""

import json
import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from ..engine.trajectory import sensitivities, simulate
from ..fitting.batch import Search, fit_batch
from ..fitting.least_squares import fit_trajectory
from ..fitting.nested import contains
from ..fitting.problem import RELEASE
from ..pendulum.catalogue import catalogue
from ..pendulum.model import Model
from .draws import value_of
from .impossible import IMPOSSIBLE

_MOST = 100  # trajectories of a fit to it, from each start
# times the values that a model fits best with, where it may fit better yet with another release
_NEARBY = np.linspace(0.6, 1.6, 31)
# settings that the swing without noise, and what comes closest to it, do not depend on
_OF_THE_NOISE = {"simulation.noise", "simulation.snr", "simulation.stream", "seed"}


class Begin(NamedTuple):
    """Where the fits of a model begin: it with values, its release (rad, rad/s), and the curvature there (``_curvature``)."""

    model: Model
    release_angle: float
    release_velocity: float
    curvature: np.ndarray | None = None
    exact: bool = False  # it is the truth


def noise_free(settings):
    """Times (s), noise-free swing (rad) and each model's ``Begin`` (None for one that has no fit) of a cell.

    What the engine raised comes back where there is no such swing.
    """
    without_noise = {key: value for key, value in settings.items() if key not in _OF_THE_NOISE}
    start = without_noise.pop("simulation.start")
    return _begun(json.dumps(without_noise, sort_keys=True), start)


def simulated(settings):
    """The simulated model, times (s), release angle (rad) and noise-free swing (rad) of a cell."""
    duration, rate = settings["simulation.duration_s"], settings["simulation.sampling_rate_hz"]
    times = np.arange(round(duration * rate) + 1) / rate
    release = math.radians(settings["simulation.release_angle_deg"])
    (label,) = settings["simulation.simulated"]
    options = settings["model.restoring"], settings["model.form"]
    model = Model(label, {}, {}, *options, catalogue(settings.get("effects")))
    model = model.with_values({name: value_of(settings, name) for name in model.parameters})
    return model, times, release, simulate(model, times, release)


@lru_cache(maxsize=32)
def _free(settings):
    """Times (s), swing (rad) and each model's ``Begin``, of settings (JSON) less those of the noise and of where fits start."""
    settings = json.loads(settings)
    model, times, release, truth = simulated(settings)
    begin = {}
    for one in sorted(settings["simulation.fitted"], key=lambda label: label.count("+")):
        guess = [begin[other].model for other in begin if contains(one, other) and begin[other]]
        begin[one] = _closest(one, times, truth, model, release, guess)
    return times, truth, begin


@lru_cache(maxsize=32)
def _begun(settings, start):
    """The same for fits that start ``free`` or at ``rest``. Cells that differ in nothing but their noise share them."""
    times, truth, begin = _free(settings)
    return times, truth, {label: _best_of_starts(each, times, truth, start) for label, each in begin.items()}


def _best_of_starts(begin, times, truth, start):
    """Where fits that start ``free`` or at ``rest`` come closest to the noise-free swing, of several starts near ``begin``.

    Where friction stops the pendulum there are many minima, and it is not the same one with the release fixed.
    """
    if begin is None or begin.exact:
        return begin
    model, at_first = begin.model, [float(truth[0]), 0.0]
    values = np.array(model.vector())
    release = list(begin[1:3]) if start == "free" else at_first
    rows = [[*values, *release]]
    for factor in _NEARBY:
        rows.append([values[0], *factor * values[1:], *at_first])
    search = Search(most=_MOST, tolerance=1e-8, starts=rows)
    fit = fit_batch(model, times, np.tile(truth, (len(rows), 1)), release, start=start, search=search)
    best = fit.values[np.nanargmin(fit.rss)] if np.isfinite(fit.rss).any() else np.array([])
    found = dict(zip(fit.free, map(float, best), strict=False))
    model = model.with_values({name: found.get(name, model.values[name]) for name in model.parameters})
    release = [found.get(name, one) for name, one in zip(RELEASE, release, strict=True)]
    return Begin(model, *release, _curvature(model, times, truth, release, fit.free))


def _curvature(model, times, truth, release, free):
    """What J'J lacks of the curvature of half the sum of squares at a model's fit to the noise-free swing (free, free).

    It is the same for all draws, but for their noise. None where the curvature is not that of a minimum.
    """

    def gradient(values, *release):
        at = model.with_values(dict(zip(model.parameters, map(float, values), strict=True)))
        angles, slopes = sensitivities(at, times, *map(float, release), free)
        return angles, slopes, slopes @ (angles - truth)

    point = np.array([*model.vector(), *release])
    split = len(model.parameters)
    try:
        angles, slopes, _ = gradient(point[:split], *point[split:])
        normal = slopes @ slopes.T
        whole = np.zeros_like(normal)
        for k in range(len(free)):
            step = np.zeros_like(point)
            step[k] = 1e-3 * np.sqrt(np.sum(np.square(angles - truth)) / times.size / normal[k, k])
            ahead, behind = (
                gradient(each[:split], *each[split:])[2] for each in (point + step, point - step)
            )
            whole[k] = (ahead - behind) / (2 * step[k])
        whole, size = (whole + whole.T) / 2, np.sqrt(np.outer(normal.diagonal(), normal.diagonal()))
        if np.linalg.eigvalsh(whole / size)[0] < 0.1 * np.linalg.eigvalsh(normal / size)[0]:
            return None
        return whole - normal
    except IMPOSSIBLE:
        return None


def _closest(label, times, truth, model, release, guess):
    """The ``Begin`` that comes closest to the noise-free swing: the truth, where the model contains it; None if there is none."""
    wider = model.with_effects(label.split("+"))
    if label == model.label or contains(label, model.label):
        same = wider.with_values({name: model.values.get(name, 0.0) for name in wider.parameters})
        return Begin(same, release, 0.0, exact=True)
    try:
        (swing,) = fit_trajectory(wider, times, truth, start="free", guess=guess).swings
        return Begin(swing.model, swing.release_angle, swing.release_velocity)
    except IMPOSSIBLE:
        return None
