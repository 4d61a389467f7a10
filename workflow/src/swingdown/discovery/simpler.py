"""When a way has ended: a simpler effect in the place of one that contains it, what was expected put back, what idles left out."""

from dataclasses import replace
from itertools import combinations

import numpy as np

from ..engine.trajectory import TrajectoryError
from ..pendulum.model import Model
from .admissible import leaves_noise
from .candidates import without
from .choice import held_out
from .established import unneeded
from .evidence import Candidate, evidence
from .linear import frame
from .ranking import in_place_of
from .refit import refit, with_effect
from .rounds import look
from .state import Round, Search

MANY = 3  # effects together can leave nothing of what none of them is: each has to be established
_MINDED = 0.02  # of the logarithm of what is left of held-out swings: more is minded


def simplified(search: Search, states: list[Round]) -> list[Round]:
    """The rounds, and those that put a simpler effect in the place of one that contains it, where held-out swings do not mind."""
    last = states[-1]
    for name in last.found:
        for simpler in last.fit.model.catalogue.contained_in(name):
            if last.number == search.rounds or search.budget.spent or simpler in last.fit.model.names:
                continue
            if search.allowed is not None and simpler not in search.allowed:
                continue
            here = frame(last.fit, search.campaign.fit)
            for one in in_place_of(here, last.noise, name, [simpler], few=1):
                held = held_out(one, search.campaign)
                if one.refused or held is None or np.log(held.rms / last.holdout.rms) > _MINDED:
                    continue
                chosen = replace(last, chosen=one, reason="")
                found = search.after(last.found, one)
                following = look(last.number + 1, search.campaign, one.fit, found, search.allowed, True)
                return simplified(search, [*states[:-1], chosen, following])
    return states


def restored(search: Search, states: list[Round]) -> list[Round]:
    """The rounds of a way that ends with nothing missing, and one that puts an effect of the base back into the place of what was found
    for it, where the data do not mind: what was expected beforehand takes less to believe."""
    last = states[-1]
    if len(last.found) < 2 or search.budget.spent:
        return states
    here, known = frame(last.fit, search.campaign.fit), last.fit.model.catalogue
    here_bic = evidence(last.fit, last.noise) + 2 * np.log(len(known))
    for old in (name for name in search.base if name not in last.fit.model.names):
        for name in last.found:
            if bool(known[name].damping) != bool(known[old].damping):
                continue
            for one in in_place_of(here, last.noise, name, [old], few=1):
                if one.refused or one.bic > here_bic or not leaves_noise(one.fit, last.noise):
                    continue
                found = search.after(last.found, one)
                following = look(last.number + 1, search.campaign, one.fit, found, search.allowed, True)
                if not following.missing:
                    search.looked.append(following)
                    if last.number == search.rounds:
                        return _straight(search, states[0], following) or states
                    return [*states[:-1], replace(last, chosen=one, reason=""), following]
    return states


def leaner(search: Search, states: list[Round]) -> list[Round]:
    """The rounds of a way that ends with nothing missing; where many effects did it and fewer do, those that lead straight there.

    Left out is what neither fitted swings nor those left out in turn miss; or one effect takes the place of two.
    """
    last = states[-1]
    while len(last.found) >= MANY and not search.budget.spent:
        one = unneeded(last, search.campaign) or _one_for_two(search, last)
        if one is None:
            break
        kept = (name for name in last.found if name in one.fit.model.names)
        found = search.after(tuple(kept), one)
        fewer = look(last.number, search.campaign, one.fit, found, search.allowed, True)
        if fewer.missing:
            break
        search.looked.append(fewer)
        last = fewer
    return (last is not states[-1] and _straight(search, states[0], last)) or states


def _one_for_two(search: Search, last: Round) -> Candidate | None:
    """The ``Candidate`` that has one effect in the place of two that were found, where the evidence is for it; None where there is none."""
    found: list[Candidate] = []
    for one, other in combinations(last.found, 2):
        try:
            fit = refit(without(last.fit, one), search.campaign.fit)
        except TrajectoryError:
            continue
        here = frame(fit, search.campaign.fit)
        found += [
            candidate
            for candidate in in_place_of(here, last.noise, other, search.allowed, beside=True)
            if not candidate.refused and leaves_noise(candidate.fit, last.noise)
        ]
    best = min(found, key=lambda one: one.bic, default=None)
    return best if best is not None and best.bic < last.bic else None


def _straight(search: Search, first: Round, last: Round) -> list[Round] | None:
    """The rounds that lead from the first model to that of the last round, an effect a move; None where there are none."""
    moves = _moves(first.fit.model, last)
    if not 0 < len(moves) <= search.rounds:
        return None
    fits = [last.fit]
    try:
        for added, dropped in moves[:0:-1]:  # from the end, each with one move less
            begin = fits[0].begin if added is None else without(fits[0], added)
            if dropped is not None:
                own = (p.name for p in first.fit.model.catalogue[dropped].parameters)
                begin = with_effect(begin, dropped, {name: first.fit.model.values[name] for name in own})
            fits.insert(0, refit(begin, search.campaign.fit, ended=True))
    except TrajectoryError:
        return None
    states = [first]
    for k, ((added, dropped), fit) in enumerate(zip(moves, fits, strict=True), start=1):
        chosen = Candidate(added, dropped, fit, evidence(fit, states[-1].noise))
        states[-1] = replace(states[-1], chosen=chosen, reason="")
        found = search.after(states[-1].found, chosen)
        end = fit is last.fit
        state = last if end else look(k, search.campaign, fit, found, search.allowed, True)
        states.append(replace(state, number=k, found=found))
    return states


def _moves(base: Model, last: Round) -> list[tuple[str | None, str | None]]:
    """What is added and what is dropped, move by move: of what damps the base's goes where another comes, else what goes goes last."""
    known = base.catalogue
    moves: list[tuple[str | None, str | None]] = [(name, None) for name in last.found]
    for gone in (name for name in base.names if name not in last.fit.model.names):
        free = [k for k, (added, dropped) in enumerate(moves) if dropped is None and added is not None]
        alike = [k for k in free if bool(known[moves[k][0] or ""].damping) == bool(known[gone].damping)]
        if at := (alike or free)[-1:]:
            moves[at[0]] = (moves[at[0]][0], gone)
        else:
            moves.append((None, gone))
    return moves
