"""The whole search: from the base model move by move, along other ways where the first does not end well, and what it establishes."""

from collections.abc import Collection, Sequence
from dataclasses import replace

from ..fitting.result import Fit
from ..pendulum.model import Model, as_model
from .budget import Budget
from .campaign import Campaign
from .established import AT_FIRST, Finding, borrowed, changing, established, rivals, still_so, unneeded
from .evidence import Candidate
from .folds import in_turn
from .next_swing import NextSwing, next_swing
from .posterior import Structure, probabilities, weighed
from .rounds import first_fit, look, look_again, without_a_name
from .simpler import MANY, leaner, restored, simplified
from .state import Round, Search

_DOUBTED = 0.01  # probability of the second structure, from which on a swing is looked for that tells it from the first
_WAYS = 2  # that are gone, the first included
_PARAMETER = 0.01  # of the score on swings left out: what a model must be better for each parameter more
_DONE = 0.05  # the same: what an end with nothing missing may be worse


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
    search = Search(campaign, rounds, allowed, Budget(budget_s), tuple(model.names))
    states = _way(search, first_fit(campaign, model), (), 0, set())
    if states[-1].missing:
        states = _best(search, _ways(search, states))
    if any(state.out_of_sample for state in states):
        states = simplified(search, states)
    states = _told(search, states)
    if not states[-1].missing and not states[-1].nameless:
        states = leaner(search, restored(search, states))
    many = len(states[-1].found) >= MANY or borrowed(states[-1], campaign)
    if states[-1].established is None and many:
        sure, number = _established(search, states)
        # where nothing is left, what would do as well was told by the evidence: many together must each stand alone
        alone = {name: one.alone for name, one in sure.items()}
        states = [*states[:-1], replace(states[-1], established=alone, established_in=number)]
    states = [*states[:-1], _still_so(states)]
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


def _way(search: Search, fit: Fit, found: Sequence[str], number: int, seen: set[str]) -> list[Round]:
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


def _ways(search: Search, first: list[Round]) -> list[list[Round]]:
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


def _best(search: Search, ways: list[list[Round]]) -> list[Round]:
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


def _told(search: Search, states: list[Round]) -> list[Round]:
    """The rounds of a way; of one that ends with something missing terms that later ones made idle are dropped, what is established is
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


def _established(search: Search, states: list[Round]) -> tuple[dict[str, Finding], int]:
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


def _still_so(states: Sequence[Round]) -> Round:
    """The last round, whose effects are established only where it has them as the round that tells them has."""
    last = states[-1]
    if last.established is None or last.established_in is None:
        return last
    known, told = last.fit.model.catalogue, states[last.established_in].fit
    sure = {name: still_so(one, known[name], told, last.fit) for name, one in last.established.items()}
    return replace(last, established=sure)


def _since_chosen(search: Search, states: list[Round]) -> dict[str, Finding]:
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
