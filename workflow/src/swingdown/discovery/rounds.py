"""One round of discovery after the other: fit, look where it fails, name what is missing, confirm, add."""

from dataclasses import dataclass, replace

import numpy as np

from .. import effects
from ..fit import fit_jointly
from ..model import Model
from .campaign import measure_noise
from .confirm import better, predict
from .linear import frame
from .locate import groups
from .name import evidence, ranking, tied

P_MISSING = 1e-4  # a group's p below which something is missing; calibrated by simulation, see hidden_effects
WORTH = 10.0  # BIC that an effect must gain


@dataclass(frozen=True)
class Round:
    """The state after n moves: the fit and where it fails, the ranking of what could mend it, and what was chosen."""

    number: int
    fit: object
    holdout: object
    noise: object
    groups: tuple
    ranked: tuple
    ties: tuple
    chosen: object  # the Candidate added next, or None
    reason: str  # why there is none

    @property
    def missing(self):
        """True where some group finds more than the noise allows."""
        return any(group.p < P_MISSING for group in self.groups)


def first_fit(campaign, base, restoring="sine", form="consistent"):
    """The base model fitted jointly within the catalogue's bounds."""
    return fit_jointly(base, [swing.pair for swing in campaign.fit], bounded=True, restoring=restoring, form=form)


def fit_from(campaign, beginning):
    """The joint fit of the model that a ``files.Beginning`` describes, from the values it has."""
    model = beginning.model
    own = [p.name for name in model.effects for p in effects.effect(name).parameters if p.own]
    return fit_jointly(model.effects, [swing.pair for swing in campaign.fit], guess=beginning, seen=False, bounded=True,
                       own=own, restoring=model.restoring, form=model.form)  # fmt: skip


def look(number, campaign, fit, allowed=None, last=False):
    """The ``Round`` at a fit: noise, disagreement, ranking, and the confirmed choice of the next model.

    ``allowed`` limits the effects that may be added; in the ``last`` round nothing more is looked for.
    """
    intervals = [(s.times[-1] - s.times[0]) / (s.times.size - 1) for s in campaign.fit]
    residuals = [swing.angle - series for swing, series in zip(campaign.fit, fit.angle, strict=True)]
    noise = measure_noise(residuals, intervals, fit.model.values["natural_frequency"] / (2 * np.pi), campaign.static)
    holdout = predict(fit, campaign.holdout)
    here = frame(fit, campaign.fit)
    found = tuple(groups(here, noise))
    state = Round(number, fit, holdout, noise, found, (), (), None, "nothing is missing")
    if not state.missing or last:
        return state if not state.missing else replace(state, reason="no round is left")
    ranked = tuple(ranking(here, noise, allowed))
    ties = tuple(tied(ranked, fit.rss))
    state = replace(state, ranked=ranked, ties=ties, reason="no effect of the catalogue explains it")
    now = evidence(fit, noise)
    for one in ties:
        if now - one.bic < WORTH:
            continue
        if better(holdout, predict(one.fit, campaign.holdout), noise) > 0:
            return replace(state, chosen=one, reason="")
        state = replace(state, reason=f"{one.move} is not confirmed on held-out swings")
    return state


def discover(campaign, base, rounds=3, allowed=None, restoring="sine", form="consistent"):
    """The list of ``Round``s from the base model until nothing is missing, nothing helps, or ``rounds`` moves were made."""
    fit = first_fit(campaign, base, restoring, form)
    states = []
    for number in range(rounds + 1):
        states.append(look(number, campaign, fit, allowed, last=number == rounds))
        if states[-1].chosen is None:
            break
        fit = states[-1].chosen.fit
    return states


def free_form(state, campaign):
    """The fit with a torque without a name in the variable that the score tests point at, and that effect's name."""
    best = max(state.groups[:3], key=lambda group: group.share)
    name = f"unnamed_{best.name}"
    effect, model = effects.effect(name), state.fit.model
    fixed = {}
    if best.name != "time":
        series = list(state.fit.angle)
        if best.name == "velocity":
            series = [np.gradient(angle, swing.times) for angle, swing in zip(series, campaign.fit, strict=True)]
        fixed = {f"{name}_range": max(float(np.max(np.abs(one))) for one in series)}
    wider = Model((*model.effects, name), restoring=model.restoring, form=model.form)
    zero = {p.name: 0.0 for p in effect.parameters if p.name not in fixed}
    own = tuple(model.values | one | zero | fixed for one in (state.fit.own or ({},) * len(campaign.fit)))
    return fit_jointly(wider.effects, [swing.pair for swing in campaign.fit], guess=replace(state.fit, own=own), seen=False,
                       bounded=True, fixed=fixed, own=tuple(state.fit.own[0]) if state.fit.own else (),
                       restoring=model.restoring, form=model.form), name  # fmt: skip
