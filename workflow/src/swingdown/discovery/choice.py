"""The choice of a move: candidates confirmed by swings that they were not fitted to, the easy way and where nothing does."""

from collections.abc import Collection, Sequence
from dataclasses import replace

import numpy as np

from ..engine.trajectory import TrajectoryError
from ..fitting.result import Fit
from .budget import Budget
from .campaign import Campaign
from .candidates import without
from .confirm import better, predict
from .evidence import TIE, Candidate, correlation, evidence, tied
from .linear import Frame
from .ranking import beside_the_best, in_pairs
from .refit import refit
from .state import Round
from .verdict import GUARD

# of what is left beyond the noise: many small additions can imitate anything, and name nothing
_SUBSTANTIAL = 1 / 3
_REACHED = 0.9  # of what a shape gains: pairs that promise less to first order are not tried beside it
_CONTENDERS, _PAIRS = 6, 2  # that held-out swings judge
_EACH = 0.02  # of the logarithm of what is left: what a parameter more must gain


def ranked_by_evidence(state: Round, here: Frame, ranked: Sequence[Candidate]) -> Round:
    """The state with these candidates, best first, and those of them that the data do not tell apart."""
    ranked = sorted(ranked, key=lambda one: (bool(one.refused), one.bic))
    ties = tuple(tied(ranked, state.noise))
    alike = {one.move: correlation(here, ties[0], one) for one in ties}
    reason = "no effect of the catalogue explains it"
    return replace(state, ranked=tuple(ranked), ties=ties, alike=alike, reason=reason)


def _substantial(one: Candidate, state: Round) -> bool:
    """True where a candidate is worth its parameters and explains a good part of what is left beyond the noise."""
    excess = state.fit.rss - state.fit.n * state.noise.deviation**2
    return state.bic - one.bic >= GUARD["worth_bic"] and state.fit.rss - one.fit.rss >= _SUBSTANTIAL * excess


def confirmed(state: Round, campaign: Campaign) -> Round:
    """The state with the first of its tied candidates that held-out swings confirm as its choice, or why there is none."""
    for one in state.ties:
        if not _substantial(one, state):
            state = replace(state, reason=f"{one.move} explains little of what is left")
            continue
        settled = to_the_end(one, state, campaign)
        if settled is None:  # at the edge of what the engine can follow, and no model to go on from
            state = replace(state, reason=f"{one.move} makes motions that cannot be computed closely enough")
        elif gained(state, settled, campaign) > 0:
            return replace(state, chosen=settled, reason="")
        else:
            state = replace(state, reason=f"{one.move} is not confirmed on held-out swings")
    return state


def to_the_end(one: Candidate, state: Round, campaign: Campaign, grown: bool = True) -> Candidate | None:
    """The candidate with its fit brought to an end: those that are only ranked stop early, and held-out swings judge the end.

    ``grown`` looks for it again in growing parts of the swings, as one whose fit was not grown into them needs. None where the end is none
    that the engine can follow.
    """
    try:
        fit = refit(one.fit.begin, campaign.fit, grown=grown, ended=True)
    except TrajectoryError:
        return None
    return replace(one, fit=fit, bic=evidence(fit, state.noise))


def gained(state: Round, candidate: Candidate, campaign: Campaign) -> float:
    """What a candidate's model gains on the held-out swings, in units of the noise's variance; less than 0 is worse."""
    try:
        return better(state.holdout, predict(candidate.fit, campaign.holdout), state.noise)
    except TrajectoryError:
        return -np.inf


def shape_believed(
    state: Round, here: Frame, campaign: Campaign, allowed: Collection[str] | None, budget: Budget
) -> Round:
    """The state as it is, or with two effects without a shape in place of its choice: one with a shape can imitate two
    without, and is believed only where no two do as well."""
    chosen = state.chosen
    if chosen is None or not _shaped(chosen):
        return state
    reach = _REACHED * (state.fit.rss - chosen.fit.rss)
    pairs = [one for one in in_pairs(here, state.noise, allowed, reach, budget=budget) if not one.refused]
    if not pairs or pairs[0].bic > chosen.bic + TIE:
        return state
    state = ranked_by_evidence(state, here, [*state.ranked, *pairs])
    return replace(confirmed(state, campaign), ranked=state.ranked)


def _shaped(one: Candidate) -> bool:
    """True where an effect that is added has a shape of its own."""
    catalogue = one.fit.model.catalogue
    return any(catalogue[name].with_role("shape") for name in one.names)


def weighed(
    state: Round, here: Frame, campaign: Campaign, allowed: Collection[str] | None, budget: Budget
) -> Round:
    """The state with the candidate as its choice that gains most on fitted and held-out swings together, and the others that gain.

    Where every model is far above the noise the fitted swings' evidence separates everything and tells little, and the largest
    gain on a few held-out swings misleads as well: the ranking is walked, pairs without a shape are in it, each must do better
    on the held-out swings, and what it leaves of both kinds of swings is weighed alike.
    """
    chosen = state.chosen
    pairs = in_pairs(here, state.noise, allowed, budget=budget)
    pairs += beside_the_best(here, state.noise, state.ranked, allowed, budget=budget)
    pairs = list({frozenset(one.names): one for one in sorted(pairs, key=lambda one: -one.fit.rss)}.values())
    state = ranked_by_evidence(replace(state, chosen=None), here, [*state.ranked, *pairs])
    worthy = [one for one in state.ranked if not one.refused and _substantial(one, state)]
    judged: list[tuple[float, Candidate]] = []
    gains: dict[str, float] = {}
    alone, two = ([one for one in worthy if bool(one.also) == paired] for paired in (False, True))
    for one in (*alone[:_CONTENDERS], *two[:_PAIRS]):
        if budget.spent and judged:
            break
        settled = chosen if chosen and chosen.move == one.move else to_the_end(one, state, campaign)
        if settled is None:
            continue
        settled = _exchanged(settled, state, campaign)
        held = held_out(settled, campaign)
        if held is None:
            continue
        gains[one.move] = float(np.log(state.holdout.rms / held.rms))
        if gains[one.move] > 0:
            more = len(settled.fit.model.parameters) - len(state.fit.model.parameters)
            both = (gains[one.move] + float(np.log(state.fit.rms / settled.fit.rms))) / 2
            judged.append((both - _EACH * more, settled))
        else:
            state = replace(state, reason=f"{one.move} is not confirmed on held-out swings")
    judged.sort(key=lambda entry: -entry[0])
    state = replace(state, out_of_sample=gains)
    if not judged:
        return state
    return replace(state, chosen=judged[0][1], others=tuple(one for _, one in judged[1:]), reason="")


def held_out(one: Candidate, campaign: Campaign) -> Fit | None:
    """What a candidate's model makes of the held-out swings; None where it has no trajectory for them."""
    try:
        return predict(one.fit, campaign.holdout)
    except TrajectoryError:
        return None


def _exchanged(one: Candidate, state: Round, campaign: Campaign) -> Candidate:
    """The candidate, or where it drives an effect of the model to nothing, the exchange that it is."""
    if one.dropped is not None:
        return one
    for effect in state.fit.model.effects:
        size = effect.size
        if size is None or not effect.one_sided or state.fit.model.values[size.name] <= 0:
            continue
        if one.fit.model.values[size.name] <= 1e-3 * state.fit.model.values[size.name]:
            try:
                fit = refit(without(one.fit, effect.name), campaign.fit, ended=True)
            except TrajectoryError:
                return one
            return replace(one, dropped=effect.name, fit=fit, bic=evidence(fit, state.noise))
    return one
