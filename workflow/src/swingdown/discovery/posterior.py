"""How sure: the weights of all structures that a search has fitted, and the probability of each effect that they give.

A structure's evidence is Schwarz's approximation (Annals of Statistics 6, 461 (1978)), counted in samples that are worth
independent ones: of the noise where it is all that the best structure leaves, else of what that leaves, which is the
slower the more it misses. Before the data a structure with one effect more is the less probable by as many as could be added.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from ..fitting.colour import uncertainty
from ..fitting.result import Fit
from .admissible import leaves_noise
from .campaign import Campaign, Noise
from .state import Round


@dataclass(frozen=True)
class Structure:
    """A set of effects, and the best fit with it that a search has seen."""

    names: frozenset[str]
    fit: Fit

    @property
    def free(self) -> int:
        """The number of free values, without those of what the measurement leaves open."""
        return len(self.fit.free) - len(self.fit.model.slack.names)


def structures(rounds: Iterable[Round]) -> list[Structure]:
    """The ``Structure``s that these rounds have fitted, each once; those refused are none."""
    best: dict[frozenset[str], Fit] = {}
    for state in rounds:
        fits = [state.fit, *(one.fit for one in state.ranked if not one.refused)]
        fits += [] if state.chosen is None else [state.chosen.fit]
        for fit in fits:
            names = frozenset(fit.model.names)
            if names not in best or fit.rss < best[names].rss:
                best[names] = fit
    return [Structure(names, fit) for names, fit in best.items()]


def weights(found: list[Structure], base: Iterable[str], campaign: Campaign, noise: Noise) -> list[float]:
    """The probability of each structure, of these and no others."""
    first = min(found, key=lambda one: one.fit.rss)
    n, catalogue, known = first.fit.n, first.fit.model.catalogue, frozenset(base)
    worth = noise.effective(n)
    if not leaves_noise(first.fit, noise):
        slow = uncertainty(first.fit, [swing.pair for swing in campaign.fit]).inflation
        worth = min(worth, n / slow) if slow > 0 else worth
    each = np.log(len(catalogue))
    logs = np.array(
        [
            -(worth * np.log(one.fit.rss / one.fit.n) + one.free * np.log(worth)) / 2
            - each * len(one.names - known)
            for one in found
        ]
    )
    shares = np.exp(logs - logs.max())
    return list(map(float, shares / shares.sum()))


def weighed(rounds: Sequence[Round], campaign: Campaign) -> list[tuple[float, Structure]]:
    """The structures that the rounds of a search have fitted with the probability of each, the most probable first; empty where
    nothing was tried."""
    found = structures(rounds)
    if len(found) < 2:
        return []
    shares = weights(found, rounds[0].fit.model.names, campaign, rounds[-1].noise)
    return sorted(zip(shares, found, strict=True), key=lambda one: -one[0])


def probabilities(told: Iterable[tuple[float, Structure]], base: Iterable[str]) -> dict[str, float]:
    """The probability of being there of each effect that some of these structures has beside the ``base``, the most probable first."""
    told, known = list(told), frozenset(base)
    names = {name for _, one in told for name in one.names} - known
    sums = {name: sum(share for share, one in told if name in one.names) for name in names}
    return dict(sorted(sums.items(), key=lambda entry: (-entry[1], entry[0])))
