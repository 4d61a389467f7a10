"""Whether discovery finds a hidden effect and names it: campaigns made with one effect more than the base model has."""

import math
from dataclasses import dataclass

import numpy as np

from ..discovery import rounds
from ..discovery.campaign import Swing, campaign
from ..discovery.files import summary
from ..discovery.verdict import verdict
from ..engine.trajectory import TrajectoryError, simulate
from ..errors import InputError
from ..fitting.least_squares import fit_jointly
from ..pendulum.catalogue import SHIPPED, catalogue
from ..pendulum.model import Model
from ..studies.noise import additive_of_size
from .table import noise_key, stream

OUTCOMES = ("nothing", "named", "among_others", "unknown", "wrong", "failed")
ANSWERS = ("none", *SHIPPED.names, "other")  # other: an effect of the study's own, or a torque without a name
VARIABLES = {
    "outcome": (None, "what discovery said of the campaign"),
    "answer": (None, "the effect that discovery added first"),
    "coefficient": ("see the hidden effect's first parameter", "size of the hidden effect"),
    "left": ("1", "RMS that the base model leaves of the noise-free swings, over the noise"),
    "gap": (
        "1",
        "RMS that the base model leaves of the noisy swings, over the noise that discovery measured",
    ),
}
FLAGS = {"outcome": OUTCOMES, "answer": ANSWERS}
DIMENSION = None
_CLOSE = 0.01  # the size of a hidden effect is met to this share
_STEPS = 12


@dataclass(frozen=True)
class _Hidden:
    """The swings of a cell without noise: times (s), names and angles (rad), the effect's size, what the base leaves of them."""

    times: np.ndarray
    swings: dict
    coefficient: float
    left: float


def entries(settings):
    """Nothing: a draw gives one verdict."""
    return None


def fits(settings):
    """The number of verdicts that one draw takes."""
    return 1


def results(settings, first, count):
    """The ``VARIABLES`` of ``count`` campaigns from index ``first`` on of one cell: arrays (count,) by name.

    Every campaign has the same swings and its own noise. ``outcome`` and ``answer`` count in ``OUTCOMES`` and ``ANSWERS``.
    """
    hidden, key = _hidden(settings), noise_key(settings)
    rows = []
    for realization in range(first, first + count):
        drawn, noise = stream(settings, key, realization), settings["detection.noise_rad"]
        swings = [
            Swing(name, hidden.times, additive_of_size(angle, noise, drawn.standard_normal(angle.size)))
            for name, angle in hidden.swings.items()
        ]
        rows.append(_row(campaign(f"draw {realization}", swings), settings, hidden))
    found = {name: np.array([row[name] for row in rows]) for name in VARIABLES}
    return found | {name: found[name].astype(np.int8) for name in FLAGS}


def _row(campaign, settings, hidden):
    row = {"coefficient": hidden.coefficient, "left": hidden.left, "gap": math.nan, "answer": 0}
    try:
        found = answer(campaign, settings)
    except TrajectoryError:
        return row | {"outcome": OUTCOMES.index("failed")}
    added = [one["name"] for one in found["effects"]]
    row |= {
        "gap": found["gap"]["fit"][0],
        "answer": ANSWERS.index(added[0] if added[0] in ANSWERS else "other") if added else 0,
    }
    present = None if settings["detection.size"] == 0 else settings["detection.effect"]
    return row | {"outcome": OUTCOMES.index(_outcome(found, present))}


def answer(campaign, settings):
    """The verdict (a dict as in verdict.json) of discovery on a campaign, under the settings of a cell."""
    base = _model(settings, settings["discovery.base"])
    states = rounds.discover(campaign, base, settings["discovery.rounds"])
    return verdict([summary(state, campaign) for state in states], base.catalogue)


def _model(settings, names):
    """The model of these effects, of the catalogue with the study's own and with the options that the settings say."""
    options = settings["model.restoring"], settings["model.form"]
    return Model(tuple(names), {}, {}, *options, catalogue(settings.get("effects")))


def _outcome(found, present):
    """The word of ``OUTCOMES`` for a verdict where ``present`` was hidden (None: nothing was)."""
    added = [one["name"] for one in found["effects"]]
    told = {*added, *(name for one in found["effects"] for name in one["tied_with"])}
    if found["status"] == "consistent":
        return "nothing"
    if found["status"] == "named" and added == [present]:
        return "named"
    if present in told:
        return "among_others"
    return "unknown" if found["status"] == "unknown" else "wrong"


def _hidden(settings):
    """The noise-free campaign of a cell, its hidden effect sized so that the base model leaves what ``detection.size`` says."""
    rate, duration = settings["simulation.sampling_rate_hz"], settings["simulation.duration_s"]
    times = np.arange(round(duration * rate) + 1) / rate
    name, size, noise = (
        settings["detection.effect"],
        settings["detection.size"],
        settings["detection.noise_rad"],
    )
    first = catalogue(settings.get("effects"))[name].size
    if size == 0:
        return _Hidden(times, _swings(settings, times, None), 0.0, 0.0)
    coefficient = first.typical * 0.1
    low, high = 0.0, math.inf  # between which the size lies
    for _ in range(_STEPS):
        try:
            swings = _swings(settings, times, coefficient)
            left = _left(settings, times, swings) / noise
        except TrajectoryError:
            left = math.inf
        if abs(left / size - 1) < _CLOSE:
            break
        low, high = (coefficient, high) if left < size else (low, coefficient)
        coefficient = min(coefficient * min(max(size / max(left, 1e-3 * size), 0.02), 30.0), first.upper)
        if not low < coefficient < high:
            coefficient = (
                math.sqrt(low * high)
                if low > 0 and math.isfinite(high)
                else 0.5 * (low + min(high, first.upper))
            )
    if not math.isfinite(left):
        raise InputError(f"sweep, cell with {name} of size {size:g}", "no such swing can be computed",
                         "a size at which the pendulum still swings", "leave that size out of the axis")  # fmt: skip
    return _Hidden(times, swings, coefficient, left)


def _swings(settings, times, coefficient):
    """The noise-free swings (rad) by name, with the hidden effect at ``coefficient`` or without it (None)."""
    base = tuple(settings["discovery.base"])
    names = base if coefficient is None else (*base, settings["detection.effect"])
    model = _model(settings, names)
    values = {p.name: settings.get(f"simulation.{p.name}", p.typical) for p in model.definitions}
    if coefficient is not None:
        values[model.catalogue[settings["detection.effect"]].size.name] = coefficient
    return {
        f"{angle:g} degrees": simulate(model.with_values(values), times, math.radians(angle))
        for angle in settings["detection.release_angles_deg"]
    }


def _left(settings, times, swings):
    """The RMS (rad) that the base model leaves of noise-free swings."""
    pairs = [(times, angle) for angle in swings.values()]
    return fit_jointly(_model(settings, settings["discovery.base"]), pairs, bounded=True).rms
