"""Whether discovery finds a hidden effect and names it: campaigns made with one effect more than the base model has."""

import math
from dataclasses import dataclass

import numpy as np

from ..discovery import search
from ..discovery.data.campaign import Swing, campaign
from ..discovery.tell.files import summary
from ..discovery.tell.verdict import verdict
from ..engine.trajectory import simulate
from ..fitting.least_squares import fit_jointly
from ..pendulum.catalogue import SHIPPED, catalogue
from ..pendulum.model import Model
from ..status import Status
from ..studies.noise import add_noise
from .draws import noise_key, stream
from .impossible import IMPOSSIBLE, reason

OUTCOMES = ("nothing", "named", "among_others", "unknown", "wrong", "failed", "not_made")
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
_STEPS = 16


@dataclass(frozen=True)
class _Hidden:
    """The swings of a cell without noise: times (s), names and angles (rad), the effect's size, what the base leaves of them."""

    times: np.ndarray
    swings: dict
    coefficient: float
    left: float
    noise: float  # standard deviation (rad)


def entries(settings):
    """Nothing: a draw gives one verdict."""
    return None


def fits(settings):
    """The number of verdicts that one draw takes."""
    return 1


def results(settings, first, count):
    """The ``VARIABLES`` of one cell's campaigns, arrays (count,) by name, and a reason.

    Parameters
    ----------
    settings
        Those of the cell.
    first, count
        The campaigns: from index ``first`` on, ``count`` of them. All have the same swings, each its own noise.

    Returns
    -------
    tuple
        ``outcome`` and ``answer`` count in ``OUTCOMES`` and ``ANSWERS``. An outcome is ``not_made`` where no such swing can be computed,
        and ``failed`` where discovery cannot search the campaign; the reason is that of the first of them, else empty.
    """
    try:
        hidden = make(settings)
    except IMPOSSIBLE as error:
        row = {"coefficient": math.nan, "left": math.nan, "gap": math.nan, "answer": 0}
        return _columns([row | {"outcome": OUTCOMES.index("not_made")}] * count), reason(error)
    key, rows, why = noise_key(settings), [], ""
    for realization in range(first, first + count):
        drawn = stream(settings, key, realization)
        swings = [
            Swing(
                name, hidden.times, _noisy(settings, angle, hidden.noise, drawn.standard_normal(angle.size))
            )
            for name, angle in hidden.swings.items()
        ]
        row = {"coefficient": hidden.coefficient, "left": hidden.left, "gap": math.nan, "answer": 0}
        try:
            row |= _told(answer(campaign(f"draw {realization}", swings), settings), settings)
        except IMPOSSIBLE as error:
            row["outcome"] = OUTCOMES.index("failed")
            why = why or reason(error)
        rows.append(row)
    return _columns(rows), why


def _columns(rows):
    found = {name: np.array([row[name] for row in rows]) for name in VARIABLES}
    return found | {name: found[name].astype(np.int8) for name in FLAGS}


def _told(found, settings):
    """What is kept of a verdict."""
    added = [one["name"] for one in (*found["effects"], *found["stand_ins"])]
    present = None if settings["detection.size"] == 0 else settings["detection.effect"]
    return {
        "gap": found["gap"]["fit"][0],
        "answer": ANSWERS.index(added[0] if added[0] in ANSWERS else "other") if added else 0,
        "outcome": OUTCOMES.index(_outcome(found, present)),
    }


def answer(campaign, settings):
    """The verdict (a dict as in verdict.json) of discovery on a campaign, under the settings of a cell."""
    base = _model(settings, settings["discovery.base"])
    states = search.discover(campaign, base, settings["discovery.rounds"])
    return verdict([summary(state, campaign) for state in states], base.catalogue)


def _model(settings, names):
    """The model of these effects, of the catalogue with the study's own and with the options that the settings say."""
    options = settings["model.restoring"], settings["model.form"]
    return Model(tuple(names), {}, {}, *options, catalogue(settings.get("effects")))


def _outcome(found, present):
    """The word of ``OUTCOMES`` for a verdict where ``present`` was hidden (None: nothing was)."""
    added = [one["name"] for one in found["effects"]]
    told = {*added, *(name for one in found["effects"] for name in one["tied_with"])}
    if found["status"] == Status.CONSISTENT:
        return "nothing"
    if found["status"] == Status.NAMED and added == [present]:
        return "named"
    if present in told:
        return "among_others"
    return "unknown" if found["status"] == Status.UNKNOWN else "wrong"


def make(settings):
    """The noise-free campaign of a cell, its hidden effect sized so that the base model leaves what ``detection.size`` says.

    Where no size of the effect does, it has the size that comes nearest, and ``left`` tells what that leaves. What the
    engine or the fit raised comes back where there is no such swing at all.
    """
    rate, duration = settings["simulation.sampling_rate_hz"], settings["simulation.duration_s"]
    times, size = np.arange(round(duration * rate) + 1) / rate, settings["detection.size"]
    bare = _swings(settings, times, None) if size == 0 or settings["detection.snr"] else None
    noise = _noise(settings, bare)
    if size == 0:
        return _Hidden(times, bare, 0.0, 0.0, noise)
    first = catalogue(settings.get("effects"))[settings["detection.effect"]].size
    coefficient, nearest, why, begin = first.typical * 0.1, None, None, None
    low, high = (0.0, 0.0), (math.inf, math.inf)  # (coefficient, what it leaves) between which the size lies
    for _ in range(_STEPS):
        try:
            found, fit = _measured(settings, times, noise, coefficient, begin)
        except IMPOSSIBLE as error:  # too strong for a swing, or for one that can be fitted
            found, fit, why = None, None, error
        left = found.left if found else math.inf
        nearest = _nearer(nearest, found, size)
        if abs(left / size - 1) < _CLOSE or (left < size and coefficient == first.upper):
            break
        if left >= size:
            high = coefficient, left
        else:
            low, begin = (coefficient, left), fit
            if math.isfinite(high[1]):  # from the better start, in case its own led to a worse optimum
                found, _ = _measured(settings, times, noise, high[0], begin)
                high = high[0], found.left
                nearest = _nearer(nearest, found, size)
                if found.left < size:
                    low, high = high, (math.inf, math.inf)
        coefficient = _between(low, high, size, first.upper)
    if nearest is None:
        raise why
    return nearest


def _nearer(one, other, size):
    """Of two _Hidden (None: there is none) the one that leaves more nearly what was asked for; of one coefficient the later."""
    if one is None or other is None:
        return one or other
    if other.coefficient == one.coefficient or abs(other.left - size) < abs(one.left - size):
        return other
    return one


def _measured(settings, times, noise, coefficient, begin):
    """The _Hidden with the effect at ``coefficient``, and the base's fit to it, which starts from the fit ``begin`` too."""
    swings = _swings(settings, times, coefficient)
    fit = _base_fit(settings, times, swings, begin)
    return _Hidden(times, swings, coefficient, fit.rms / noise, noise), fit


def _between(low, high, size, upper):
    """The coefficient to try next: by the power law through both ends, where there are two, and never close to an end."""
    if not math.isfinite(high[0]):  # nothing was too strong yet
        return min(low[0] * min(max(size / max(low[1], 1e-9), 1.5), 30.0), upper)
    if low[0] == 0:
        return high[0] * (0.1 if not math.isfinite(high[1]) else min(max(size / high[1], 0.02), 0.7))
    ratio = 0.5
    if math.isfinite(high[1]):
        ratio = math.log(size / low[1]) / math.log(high[1] / low[1])
    return low[0] * (high[0] / low[0]) ** min(max(ratio, 0.1), 0.9)


def foresee(settings):
    """Nothing; where the swings of a cell cannot be made, what the engine or the fit raised comes back."""
    make(settings)


def _noise(settings, swings):
    """The standard deviation (rad) of the noise: as told, or the RMS of the swings without the hidden effect over the SNR."""
    if settings["detection.snr"] is None:
        return settings["detection.noise_rad"]
    return (
        math.sqrt(np.mean(np.concatenate([np.square(one) for one in swings.values()])))
        / settings["detection.snr"]
    )


def _noisy(settings, angle, noise, normals):
    """A swing (rad) with noise of that standard deviation, of the kind ``detection.noise``."""
    if settings["detection.noise"] == "additive":
        return angle + noise * normals
    return add_noise(
        settings["detection.noise"], angle, math.sqrt(np.mean(np.square(angle))) / noise, normals
    )


def _swings(settings, times, coefficient):
    """The noise-free swings (rad) by name, with the hidden effect at ``coefficient`` or without it (None)."""
    base = tuple(settings["discovery.base"])
    names = base if coefficient is None else (*base, settings["detection.effect"])
    model = _model(settings, names)
    values = _values(settings, model)
    if coefficient is not None:
        values[model.catalogue[settings["detection.effect"]].size.name] = coefficient
    return {
        f"{angle:g} degrees": simulate(model.with_values(values), times, math.radians(angle))
        for angle in settings["detection.release_angles_deg"]
    }


def _values(settings, model):
    """The values that the settings give a model's parameters, by name."""
    return {
        p.name: settings.get(f"simulation.{p.name}", settings.get(f"parameters.{p.name}", p.usual))
        for p in model.definitions
    }


def _base_fit(settings, times, swings, begin):
    """The base model's fit to noise-free swings, whose RMS (rad) is what it leaves of them.

    It starts from the values that were simulated and from the fit ``begin`` (None: from none) too: from what the data show
    alone it may end in an optimum that is not the best, and what is left would jump where the effect grows smoothly.
    """
    pairs = [(times, angle) for angle in swings.values()]
    base = _model(settings, settings["discovery.base"])
    simulated = base.with_values(_values(settings, base))
    return fit_jointly(base, pairs, bounded=True, guess=[simulated, begin] if begin else simulated)
