"""When a way has ended: a simpler effect in the place of one that contains it, what was expected put back, what idles left out."""

from dataclasses import replace

import numpy as np

from .admissible import leaves_noise
from .choice import held_out
from .established import unneeded
from .evidence import Candidate, evidence
from .linear import frame
from .ranking import in_place_of
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


def leaner(search: Search, states: list[Round]) -> list[Round]:
    """The rounds of a way that ends with nothing missing, of many effects those that later moves made idle left out.

    The last move takes the place of the one that brought such an effect, or the effect gives way to what the last move adds;
    else it is dropped in a round of its own where one is left.
    """
    while len(states[-1].found) >= MANY and not search.budget.spent:
        states = _shorter(states)
        idle = unneeded(states[-1], search.campaign)
        if idle is None:
            break
        kept, chosen = _rewritten(states, idle)
        number, found = kept[-1].number + 1, search.after(states[-1].found, idle)
        if number > search.rounds:
            break
        last = look(number, search.campaign, idle.fit, found, search.allowed, True)
        if last.missing:
            break
        search.looked.append(last)
        states = [*kept[:-1], replace(kept[-1], chosen=chosen, reason=""), last]
    return states


def _rewritten(states: list[Round], idle: Candidate) -> tuple[list[Round], Candidate]:
    """The rounds before the one without an idle effect, and the move of the last of them that leads there."""
    brought, latest = (states[-3].chosen if len(states) > 2 else None), states[-2].chosen

    def fitted(move: Candidate, dropped: str | None) -> Candidate:
        return replace(move, dropped=dropped, fit=idle.fit, bic=idle.bic)

    if brought is not None and latest is not None and brought.names == (idle.dropped,):
        dropped = {brought.dropped, latest.dropped} - {None}
        if len(dropped) < 2:
            return states[:-2], fitted(latest, next(iter(dropped), None))
    if latest is not None and latest.dropped is None and idle.dropped not in latest.names:
        return states[:-1], fitted(latest, idle.dropped)
    return states, idle


def _shorter(states: list[Round]) -> list[Round]:
    """The rounds with what the last one dropped given way to the addition before it, so that a round is left for more; an
    addition that was dropped at once was none."""
    if len(states) < 3:
        return states
    added, dropped = states[-3].chosen, states[-2].chosen
    if added is None or dropped is None or dropped.added is not None or added.dropped is not None:
        return states
    if dropped.dropped not in added.names:
        chosen = replace(added, dropped=dropped.dropped, fit=dropped.fit, bic=dropped.bic)
        return [
            *states[:-3],
            replace(states[-3], chosen=chosen),
            replace(states[-1], number=states[-2].number),
        ]
    if added.names == (dropped.dropped,) and len(states) > 3:
        return [*states[:-3], replace(states[-1], number=states[-3].number)]
    return states
