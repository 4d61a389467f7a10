"""Which effect is missing: every move refitted from several starts, inadmissible ones refused, ranked by evidence."""

from dataclasses import dataclass, replace

import numpy as np

from .. import effects
from ..fit import fit_jointly
from ..trajectory import TrajectoryError
from .candidates import additions, starts_to_add, starts_to_exchange

TIE = 10.0  # difference of BIC below which two candidates are told as tied
_PROMISING = 0.05  # of the best promise: candidates below are not refitted, a linear step already tells them off
_NEARLY_ALL = 0.97
# what a richer effect contains at one value of its shape: without evidence for more, the simpler one is named
CONTAINS = {
    "power_law_drag": ("viscous", "quadratic_drag", "constant_coulomb"),
    "steady_wind": ("quadratic_drag",),
    "presliding": ("constant_coulomb",),
    "stribeck": ("constant_coulomb",),
    "eddy_brake": ("viscous",),
}


@dataclass(frozen=True)
class Candidate:
    """A move and its refit: effect added and dropped (or None), the fit, its BIC, and why it is refused (or empty)."""

    move: str
    added: str | None
    dropped: str | None
    fit: object
    bic: float
    refused: str = ""


def evidence(fit, noise):
    """The BIC of a fit whose residuals are correlated as the noise is: n effective ln(rss / n) + k ln(n effective)."""
    n = noise.effective(fit.n)
    return float(n * np.log(fit.rss / fit.n) + len(fit.free) * np.log(n))


def refit(start, frame):
    """The joint fit of a ``Start``, within the catalogue's bounds."""
    model = frame.fit.model
    own = [p.name for name in start.effects for p in effects.effect(name).parameters if p.own]
    begin = replace(
        frame.fit,
        own=start.values,
        release_angle=start.release_angle or frame.fit.release_angle,
        release_velocity=start.release_velocity or frame.fit.release_velocity,
    )
    pairs = [swing.pair for swing in frame.swings]
    return fit_jointly(start.effects, pairs, guess=begin, seen=False, bounded=True, own=own, most=30,
                       restoring=model.restoring, form=model.form)  # fmt: skip


def ranking(frame, noise, allowed=None):
    """The ``Candidate``s, best first: additions, exchanges and drops, each refitted from its starts.

    ``allowed`` limits the effects that may be added (all of the catalogue by default). A candidate is refused where a
    parameter ends at a bound at which the effect is not there, or where no start gives a trajectory.
    """
    names = [name for name in additions(frame.fit.model) if allowed is None or name in allowed]
    moves = {name: starts_to_add(frame, name) for name in names}
    most = max((starts[0].promise for starts in moves.values() if starts), default=0.0)
    groups = [starts for starts in moves.values() if starts and starts[0].promise >= _PROMISING * most]
    exchanges = {}
    for start in starts_to_exchange(frame):
        if start.added is None or allowed is None or start.added in allowed:
            exchanges.setdefault(start.move, []).append(start)
    found = [_best(starts, frame, noise) for starts in (*groups, *exchanges.values())]
    return sorted((one for one in found if one), key=lambda one: (bool(one.refused), one.bic))


def _best(starts, frame, noise):
    fits = []
    for start in starts:
        try:
            fits.append(refit(start, frame))
        except TrajectoryError:
            continue
    if not fits:
        return None
    fit, start = min(fits, key=lambda fit: fit.rss), starts[0]
    return Candidate(start.move, start.added, start.dropped, fit, evidence(fit, noise), _inadmissible(fit, start.added))


def _inadmissible(fit, added):
    if added is None:
        return ""
    effect = effects.effect(added)
    if not effect.parameters:
        return ""
    first = effect.parameters[0]
    value = fit.model.values[first.name]
    if value <= first.lower + 1e-12:
        return f"{first.name} wants to be below {first.lower:g} {first.unit}"
    for parameter in effect.parameters[1:]:
        if parameter.phase:
            continue
        if fit.model.values[parameter.name] >= parameter.upper * (1 - 1e-9):
            return f"{parameter.name} runs to its bound {parameter.upper:g} {parameter.unit}"
    return ""


def tied(ranked, before):
    """The candidates that the evidence does not tell from the best, the best first: those within ``TIE`` of its BIC.

    ``before`` is the sum of squares (rad^2) of the fit that they would mend. A richer effect is left out beside a simpler
    one that it contains, and gives way to it where the simpler explains nearly all that it does: what is left may have
    another cause, and a later round can still exchange the one for the other.
    """
    admissible = [one for one in ranked if not one.refused]
    if not admissible:
        return []
    best = admissible[0]
    simpler = [one for one in admissible if one.added in CONTAINS.get(best.added, ()) and one.dropped == best.dropped]
    for one in simpler:
        if before - one.fit.rss > _NEARLY_ALL * (before - best.fit.rss):
            best = one
            break
    near = [one for one in admissible if one is best or 0 <= one.bic - best.bic < TIE]
    simple = {one.added for one in near}
    kept = [one for one in near if not any(part in simple for part in CONTAINS.get(one.added, ()))]
    return sorted(kept, key=lambda one: one is not best)


def correlation(frame, first, second):
    """How alike two candidates are to the data: the correlation of what each adds to the angles, beyond the current fit."""
    changes = []
    for one in (first, second):
        series = np.concatenate(one.fit.angle) - np.concatenate(frame.fit.angle)
        changes.append(frame.outside(series))
    size = np.linalg.norm(changes[0]) * np.linalg.norm(changes[1])
    return float(changes[0] @ changes[1] / size) if size > 0 else np.nan


