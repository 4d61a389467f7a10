"""The whole search: from the base model move by move, along other ways where the first does not end well, and what it establishes."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from ..fitting.result import Fit
from ..pendulum.model import Model, as_model
from .admissible import leaves_noise
from .budget import Budget
from .campaign import Campaign
from .choice import held_out
from .established import AT_FIRST, Finding, changing, established, rivals, unneeded
from .folds import in_turn
from .linear import frame
from .next_swing import NextSwing, next_swing
from .posterior import Structure, probabilities, weighed
from .ranking import Candidate, evidence, in_place_of
from .rounds import after, first_fit, look, look_again, without_a_name
from .state import Round

_MANY = 3  # effects together can leave nothing of what none of them is: each has to be established
_DOUBTED = 0.01  # probability of the second structure, from which on a swing is looked for that tells it from the first
_WAYS = 2  # that are gone, the first included
_PARAMETER = 0.01  # of the score on swings left out: what a model must be better for each parameter more
_DONE = 0.05  # the same: what an end with nothing missing may be worse
_MINDED = 0.02  # of the logarithm of what is left of held-out swings: more is minded


@dataclass(frozen=True)
class _Search:
    """What stays the same throughout a search."""

    campaign: Campaign
    rounds: int
    allowed: Collection[str] | None
    budget: Budget
    base: tuple[str, ...] = ()  # the effects that the model had at first: none of them is found
    looked: list[Round] = field(default_factory=list)  # all rounds of all ways, in order

    def after(self, found: Sequence[str], chosen: Candidate) -> tuple[str, ...]:
        """The names of the effects found, after a move."""
        return tuple(name for name in after(found, chosen) if name not in self.base)


def discover(
    campaign: Campaign,
    base: Model | str,
    rounds: int = 4,
    allowed: Collection[str] | None = None,
    budget_s: float | None = None,
) -> list[Round]:
    """The list of ``Round``s from the base model until nothing is missing, nothing helps, or ``rounds`` moves were made.

    Where the first way does not end with nothing missing, other ways are gone from its first choice, and the one is told
    that ends best on swings left out in turn. ``allowed`` limits the effects that may be added. After ``budget_s`` CPU
    seconds (None: no end) nothing new is begun, and the last round says so.
    """
    model = as_model(base)
    search = _Search(campaign, rounds, allowed, Budget(budget_s), tuple(model.names))
    states = _way(search, first_fit(campaign, model), (), 0, set())
    if states[-1].missing:
        states = _best(search, _ways(search, states))
    if any(state.out_of_sample for state in states):
        states = _simplified(search, states)
    states = _told(search, states) if states[-1].missing else _leaner(search, _restored(search, states))
    if states[-1].established is None and len(states[-1].found) >= _MANY:
        sure, number = _established(search, states)
        # where nothing is left, what would do as well was told by the evidence: many together must each stand alone
        alone = {name: one.alone for name, one in sure.items()}
        states = [*states[:-1], replace(states[-1], established=alone, established_in=number)]
    told = weighed([*search.looked, *states], campaign)
    likely = probabilities(told, states[0].fit.model.names)
    last = replace(states[-1], spent=search.budget.spent, probabilities=likely)
    return [*states[:-1], replace(last, next_swing=_next(last, told, campaign))]


def _next(last: Round, told: Sequence[tuple[float, Structure]], campaign: Campaign) -> NextSwing | None:
    """The swing that tells the two most probable structures apart; None where nothing is missing and one of them is sure."""
    named = [one for one in told if not _nameless(one[1])][:2]
    if len(named) < 2 or not (last.missing or named[1][0] > _DOUBTED):
        return None
    return next_swing(named[0][1].fit, named[1][1].fit, campaign, last.noise)


def _nameless(one: Structure) -> bool:
    return not all(one.fit.model.catalogue.has_name(name) for name in one.names)


def _way(search: _Search, fit: Fit, found: Sequence[str], number: int, seen: set[str]) -> list[Round]:
    """The rounds from a fit to where nothing more is chosen, or to a model that another way has ``seen``, which it adds to."""
    states: list[Round] = []
    for k in range(number, search.rounds + 1):
        last = k == search.rounds
        states.append(look(k, search.campaign, fit, found, search.allowed, last, search.budget))
        search.looked.append(states[-1])
        chosen = states[-1].chosen
        if chosen is None or chosen.fit.model.label in seen:
            break
        seen.add(chosen.fit.model.label)
        fit, found = chosen.fit, search.after(found, chosen)
    return states


def _ways(search: _Search, first: list[Round]) -> list[list[Round]]:
    """The first way and others, from what else was confirmed at its first choice."""
    ways = [first]
    seen = {state.fit.model.label for state in first}
    for other in first[0].others:
        if len(ways) == _WAYS or search.budget.spent:
            break
        if other.fit.model.label in seen or _alike(first[0], other):
            continue
        seen.add(other.fit.model.label)
        begun = replace(first[0], chosen=other, reason="")
        ways.append([begun, *_way(search, other.fit, search.after((), other), 1, seen)])
        if not ways[-1][-1].missing:
            break
    return ways


def _alike(state: Round, other: Candidate) -> bool:
    """True where another choice is a richer or a simpler form of the one that was made, which is no other way."""
    known, chosen = state.fit.model.catalogue, state.chosen
    return chosen is not None and any(
        mine in known.contained_in(name) or name in known.contained_in(mine)
        for name in other.names
        for mine in chosen.names
    )


def _best(search: _Search, ways: list[list[Round]]) -> list[Round]:
    """The way that leaves least of swings left out in turn; a parameter more must earn its place, and an end with nothing
    missing counts for some."""
    if len(ways) == 1:
        return ways[0]

    def cost(states: list[Round]) -> float:
        last = states[-1]
        turns = in_turn(last.fit, search.campaign, last.holdout)
        if turns is None:
            return float("inf")
        parameters = len(last.fit.model.parameters)
        return turns.score + _PARAMETER * parameters - (0.0 if last.missing else _DONE)

    best = min(ways, key=cost)
    if best[-1].chosen is None:
        return best
    return [*best[:-1], replace(best[-1], chosen=None, reason="it leads where another way has been")]


def _simplified(search: _Search, states: list[Round]) -> list[Round]:
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
                return _simplified(search, [*states[:-1], chosen, following])
    return states


def _restored(search: _Search, states: list[Round]) -> list[Round]:
    """The rounds of a way that ends with nothing missing, and one that puts an effect of the base back into the place of what was found
    for it, where the data do not mind: what was expected beforehand takes less to believe."""
    last = states[-1]
    if last.number == search.rounds or len(last.found) < 2 or search.budget.spent:
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
                    return [*states[:-1], replace(last, chosen=one, reason=""), following]
    return states


def _leaner(search: _Search, states: list[Round]) -> list[Round]:
    """The rounds of a way that ends with nothing missing; of many effects those that the last move made idle give way to it."""
    while len(states[-1].found) >= _MANY and not search.budget.spent:
        before, last = states[-2:]
        idle = unneeded(last, search.campaign)
        if idle is None or before.chosen is None or before.chosen.dropped is not None:
            break
        chosen = replace(before.chosen, dropped=idle.dropped, fit=idle.fit, bic=idle.bic)
        if idle.dropped in chosen.names:
            break
        found = search.after(before.found, chosen)
        leaner = look(last.number, search.campaign, idle.fit, found, search.allowed, True)
        if leaner.missing:
            break
        search.looked.append(leaner)
        states = [*states[:-2], replace(before, chosen=chosen), leaner]
    return states


def _told(search: _Search, states: list[Round]) -> list[Round]:
    """The rounds of a way that ends with something missing: terms that later ones made idle are dropped, what is established is
    found out, and what remains is kept as a torque without a name."""
    last = states[-1]
    while last.missing and not search.budget.spent and last.number < search.rounds:
        idle = unneeded(last, search.campaign)
        if idle is None:
            break
        states = [*states[:-1], replace(last, chosen=idle, reason="")]
        found = search.after(last.found, idle)
        last = look(last.number + 1, search.campaign, idle.fit, found, search.allowed, True, search.budget)
        states.append(last)
    if not last.missing:
        return states
    sure, told = _established(search, states)
    last = replace(last, established=sure, established_in=told)
    if last.number < search.rounds and not search.budget.spent:
        last = without_a_name(last, search.campaign)
    states = [*states[:-1], last]
    while (chosen := states[-1].chosen) is not None:
        number, found = states[-1].number + 1, search.after(states[-1].found, chosen)
        one = look_again(number, search.campaign, chosen.fit, found, number == search.rounds)
        states.append(replace(one, established=sure, established_in=told))
    return states


def _established(search: _Search, states: list[Round]) -> tuple[dict[str, Finding], int]:
    """What is established of the effects that the last round has, and the round that tells it.

    Many terms that share out what has no name leave none of them determined: then what is established before they came is
    asked for. What was no better than another when it was chosen is not: all that came later was chosen to go with it.
    """
    last = states[-1]
    found = _since_chosen(search, states)
    for k in range(len(states) - 1, 0, -1):
        if any(one.sure for one in found.values()) or not states[k - 1].found or search.budget.spent:
            break
        before = _since_chosen(search, states[:k])
        if any(name in before and before[name].sure for name in last.found):
            late = Finding("what came before it is established without it")
            return {name: before.get(name, late) for name in last.found}, states[k - 1].number
    return found, last.number


def _since_chosen(search: _Search, states: list[Round]) -> dict[str, Finding]:
    """What is established in the last of these rounds, and in the one that it was first in was told from its rivals and much the
    same everywhere: what came later was chosen to go with it."""
    last, base = states[-1], states[0].fit.model.names
    found = established(last, search.campaign, search.allowed, search.budget, base)
    for name, one in found.items():
        first = next(state for state in states if name in state.found)
        if one.sure and first is not last and not search.budget.spent:
            if why := changing(first, search.campaign, name, AT_FIRST):
                found[name] = replace(one, doubt=f"{why}, as it was found", ties=())
                continue
            near = rivals(first, search.campaign, search.allowed, name, base)
            found[name] = one.beside(near, name, last.fit.model.catalogue)
    return found
