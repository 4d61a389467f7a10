"""Structures: sets of effects with their best fit, what each lacks, and the probability of each among all that were looked at.

Each structure is there twice: as if nothing else were missing, and beside a discrepancy. Before the data a structure is the less
probable by as many effects as the catalogue has for each that it adds, and a discrepancy counts as such an effect. So does, beside one, each
effect of the base that it lacks: what something unnamed may do in its place was not shown to be needless.
"""

from collections.abc import Collection, Iterable, Mapping
from contextlib import suppress
from copy import copy
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.special import erf

from ...engine.trajectory import TrajectoryError
from ...fitting.result import Fit
from ...pendulum.effect import NATURAL_FREQUENCY
from ..criterion import USUAL, Criterion
from ..data.campaign import Campaign
from ..data.noise import Noise
from ..move.admissible import at_its_bound, swings_by_itself
from ..move.candidates import without
from ..move.refit import FAILURES, refit
from ..see.discrepancy import Discrepancy, Unnamed
from ..see.envelope import NOT_SEEN, Seen, Stretch, amplitudes, seen
from ..see.kinds import DISSIPATIVE
from ..see.linear import Frame, frame
from .confirm import predict

Key = frozenset[str]
_COUNTS = 0.01  # the least share of a structure that values are told from
OWN = "a frequency each"  # in a key: recordings that have a natural frequency each


@dataclass(frozen=True)
class Structure:
    """A set of effects: its fit, the fit seen to first order, what it lacks, and its evidence (natural logarithm) ``plain``, as if
    nothing were missing, and with something ``unnamed``."""

    fit: Fit
    frame: Frame
    lacks: Discrepancy
    plain: float
    unnamed: float

    @property
    def key(self) -> Key:
        """The names of its effects."""
        return key_of(self.fit)

    @property
    def evidence(self) -> float:
        """The logarithm of its evidence, whether or not something unnamed is missing."""
        return float(np.logaddexp(self.plain, self.unnamed))

    @property
    def whole(self) -> float:
        """The probability that nothing else is missing, given these effects."""
        return float(np.exp(self.plain - self.evidence))

    @property
    def rubs(self) -> float:
        """How sure it is that what it lacks holds a friction: a torque against the motion that is left as the speed goes to nothing."""
        lacks = self.lacks
        clear = lacks.friction / lacks.friction_error if lacks.friction_error > 0 else 0.0
        return (1 - self.whole) * float(erf(max(clear, 0.0) / np.sqrt(2)))

    @property
    def widened(self) -> dict[str, float]:
        """By how much the standard error of each shared value is larger for what may be missing, weighed by how probable that is."""
        return {
            name: float(np.sqrt(self.whole + (1 - self.whole) * factor**2))
            for name, factor in self.lacks.widened.items()
        }

    def left(self, noise: Noise) -> float:
        """The RMS of its residuals beyond the noise (rad), weighed by the probability that this is no chance."""
        return float(np.sqrt(max(self.fit.rms**2 - noise.deviation**2, 0.0))) * (1 - self.whole)


def key_of(fit: Fit) -> Key:
    """The ``Key`` of a fit."""
    return frozenset((*fit.model.names, *([OWN] if fit.model.own_frequency else [])))


class Pool:
    """All structures that a search has looked at, by their effects, each beside the same discrepancy: what unnamed torques do to swings
    ``near`` those of a fit (the base's by default)."""

    def __init__(
        self,
        campaign: Campaign,
        noise: Noise,
        base: Fit,
        near: Fit | None = None,
        unnamed: Unnamed | None = None,
        criterion: Criterion = USUAL,
    ):
        self.campaign, self.noise, self.base, self.near = campaign, noise, key_of(base), near or base
        self.criterion = criterion
        period = 2 * np.pi / base.model.values[NATURAL_FREQUENCY.name]
        self.unnamed = unnamed or Unnamed(self.near, campaign.fit, period, noise)
        self._each = float(np.log(len(base.model.catalogue)))
        self._envelopes: dict[frozenset[int], Seen] = {}
        self._held_out: dict[int, tuple[Fit, Fit]] = {}  # by the identity of a fit: itself, and what it says
        self.known: dict[Key, Structure] = {}
        self.first = self._seen(base, frame(base, campaign.fit))
        self.known[self.base] = self.first

    @property
    def begun_with(self) -> Key:
        """The effects of the base."""
        return self.base - {OWN}

    @property
    def absolute(self) -> float:
        """The evidence of the best structure and of its noise, in units that no noise sets."""
        return self.best.evidence + self.unnamed.level(self.best.frame) + self.noise.likely

    def look(self, fit: Fit) -> None:
        """Keep a fit where it is the best of its effects; one that cannot be seen to first order is passed over.

        Effects whose best fit has one at a bound are no structure: to first order it could go on beyond, and what it stands in for there
        is another effect. Nor are those beside which the pendulum does not swing by itself.
        """
        key = key_of(fit)
        old = self.known.get(key)
        if old is not None and old.fit.rss <= fit.rss:
            return
        added = [name for name in fit.model.names if name not in self.base]
        if any(at_its_bound(fit, name) for name in added) or not swings_by_itself(fit, added):
            self.known.pop(key, None)
            return
        try:
            one = self._seen(fit, frame(fit, self.campaign.fit))
        except FAILURES:
            return
        self.known[one.key] = one

    def best_named(self) -> Structure | None:
        """Of the structures that add effects the most probable as if nothing else were missing; None where there is none."""
        adding = (one for one in self.known.values() if self.added(one.key))
        return max(adding, key=lambda one: one.plain, default=None)

    def held_out(self, fit: Fit) -> Fit:
        """What a fit says of the held-out swings; TrajectoryError where it cannot follow them."""
        if id(fit) not in self._held_out:
            self._held_out[id(fit)] = fit, predict(fit, self.campaign.holdout)
        return self._held_out[id(fit)][1]

    def follows(self, fit: Fit) -> bool:
        """Whether a fit can follow the held-out swings."""
        try:
            self.held_out(fit)
        except TrajectoryError:
            return False
        return True

    def but(self, dropped: Collection[str], kept: Collection[str]) -> "Pool":
        """The structures but those that have effects which are not there beside effects that are kept."""
        found, dropped, kept = copy(self), frozenset(dropped), frozenset(kept)
        found.known = {key: one for key, one in self.known.items() if not (key & dropped and key & kept)}
        return found

    def lacking(self, one: Structure, names: Collection[str]) -> list[Structure]:
        """The structure without these of its effects, fitted where it is not known, and those with effects of the base again which they may
        have taken the place of, the most probable first; where that has one at a bound, those that lack more; empty where there is none."""
        key = one.key - set(names)
        if key not in self.known:
            begin = one.fit
            with suppress(TrajectoryError):
                for name in names:
                    if name in begin.model.names:
                        begin = refit(without(begin, name), self.campaign.fit, ended=True)
                self.look(begin)
        near = [other for other in self.known.values() if key <= other.key <= key | self.base]
        if not near:  # what is left of the effects has one at a bound
            near = [
                other
                for other in self.known.values()
                if not other.key & set(names) and other.key <= key | self.base
            ]
        return sorted(near, key=lambda other: -other.evidence)

    def evidence_of(self, fit: Fit) -> float:
        """The evidence of the structure that a fit is of; none where it could not be looked at."""
        known = self.known.get(key_of(fit))
        return -np.inf if known is None else known.evidence

    def loses_more(self, one: Structure) -> bool:
        """True where a structure surely lacks something that does most as a torque over angle, speed and side would: none of its laws of
        damping is the whole of what takes energy then."""
        sizes = one.lacks.sizes
        most = max(sizes, key=lambda kind: sizes[kind])
        return one.whole < self.criterion.possible and most == DISSIPATIVE

    def lacks(self, one: Structure) -> bool:
        """True where something is missing beside a structure: of one that adds nothing, unless it may be that nothing is; of others, what
        is probable and above the noise."""
        if not self.added(one.key):
            return self.nothing() <= self.criterion.possible
        return one.whole < 0.5 and one.left(self.noise) > self.noise.deviation

    def _seen(self, fit: Fit, there: Frame) -> Structure:
        lacks = self.unnamed.beside(there)
        free, key = len(fit.free) - len(fit.model.slack.names), key_of(fit)
        known = -0.5 * free * np.log(self.noise.effective(fit.n)) - self._each * len(key - self.base)
        beside = self._each * (1 + len(self.base - key))
        return Structure(fit, there, lacks, lacks.log_plain + known, lacks.log_evidence + known - beside)

    def under(self, noise: Noise) -> "Pool":
        """The same structures under another noise."""
        found = Pool(
            self.campaign, noise, self.first.fit, self.near, self.unnamed.under(noise), self.criterion
        )
        found.take(self)
        return found

    def take(self, other: "Pool") -> None:
        """Keep the structures of another pool of these swings, seen as those of this one are."""
        for key, one in other.known.items():
            there = self.known.get(key)
            if there is None or there.fit is not one.fit:
                with suppress(*FAILURES):
                    self.known[key] = self._seen(one.fit, one.frame)

    @property
    def best(self) -> Structure:
        """The most probable structure."""
        return max(self.known.values(), key=lambda one: one.evidence)

    def added(self, key: Key) -> list[str]:
        """The effects of a structure that the base has not, in the catalogue's order."""
        return [
            name for name in self.first.fit.model.catalogue.names if name in key and name not in self.base
        ]

    def probabilities(self) -> Mapping[Key, float]:
        """The probability of each structure."""
        logs = np.array([one.evidence for one in self.known.values()])
        shares = np.exp(logs - np.logaddexp.reduce(logs))
        return dict(zip(self.known, map(float, shares), strict=True))

    def counting(self, laws: Collection[str]) -> list[tuple[float, Fit]]:
        """The fits of the structures that values are told from, with how much each counts.

        What they have beside the effects of the ``laws`` of damping counts by its probability, and the laws beside it by AIC: BIC leaves
        out what is too small to be seen and large enough to move a value (Burnham & Anderson, Sociol. Methods Res. 33, 261 (2004)).
        """
        chances, beside = self.probabilities(), {key: key - frozenset(laws) for key in self.known}
        found = []
        for rest in dict.fromkeys(
            beside.values()
        ):  # in the order in which they were looked at: the last digits stay
            group = [one for key, one in self.known.items() if beside[key] == rest]
            logs = np.array([one.evidence + self._aic_for_bic(one) for one in group])
            shares = np.exp(logs - np.logaddexp.reduce(logs)) * sum(chances[one.key] for one in group)
            found += [
                (float(share), one.fit) for share, one in zip(shares, group, strict=True) if share >= _COUNTS
            ]
        return found

    def _aic_for_bic(self, one: Structure) -> float:
        """What the logarithm of a structure's evidence gains where its effects are not counted by BIC, nor by the odds of a name."""
        free = len(one.fit.free) - len(one.fit.model.slack.names)
        return (
            0.5 * free * (np.log(self.noise.effective(one.fit.n)) - 2) + len(one.key - self.base) * self._each
        )

    def of(self, names: Iterable[str]) -> float:
        """The probability that at least one of these effects is there."""
        wanted = frozenset(names)
        return sum(chance for key, chance in self.probabilities().items() if key & wanted)

    def of_friction(self) -> float:
        """The probability that a friction is there, of whatever law: one of the catalogue, or one that an unnamed torque holds."""
        rubbing = frozenset(self.frictions())
        shares = self.probabilities().items()
        return sum(chance * (1.0 if key & rubbing else self.known[key].rubs) for key, chance in shares)

    def sees_friction(self) -> float:
        """The probability that an unnamed torque holds a friction, of the structures that name none: that one is there needs no name then."""
        rubbing = frozenset(self.frictions())
        unnamed = [one for key, one in self.known.items() if not key & rubbing]
        logs = np.array([one.evidence for one in unnamed])
        shares = np.exp(logs - np.logaddexp.reduce(logs))
        seen = sum(float(share) * one.rubs for share, one in zip(shares, unnamed, strict=True))
        shown = self.envelope(self.unlike_the_base(self.frictions())[0])
        return 0.0 if shown.chance < self.criterion.possible else seen

    def envelope(self, laws: frozenset[int]) -> Seen:
        """What the envelope shows of losses of these ``laws`` (``powers_lost``); its ``gain`` is that of a name. Nothing where an effect has a
        size of its own in each recording: they do not lose alike."""
        if laws not in self._envelopes:
            found = NOT_SEEN
            if laws and not self.first.fit.model.own:
                found = seen(self._amplitudes, laws, self.criterion.possible)
            self._envelopes[laws] = found._replace(gain=found.gain - self._each)
        return self._envelopes[laws]

    @cached_property
    def _amplitudes(self) -> tuple[Stretch, ...]:
        base = self.first.fit.model
        return amplitudes(self.campaign, base.values[NATURAL_FREQUENCY.name], base.restoring)

    def unlike_the_base(self, kind: Collection[str]) -> tuple[frozenset[int], list[str]]:
        """(the laws of loss that effects of this kind of damping have and the base has not; the effects that have one of them).

        Friction takes the same from every swing, drag more from a larger one.
        """
        base = self.first.fit.model
        catalogue, powers = base.catalogue, base.catalogue.powers_lost
        of_base = {power for name in base.names for power in powers(name)}
        laws = frozenset(
            power
            for name in kind
            for power in powers(name)
            if power not in of_base and (power == 0) == catalogue.rubs(name)
        )
        return laws, [name for name in kind if powers(name) & laws and name not in self.base]

    def frictions(self, key: Key | None = None) -> list[str]:
        """The frictions among the effects of a structure (default: of the catalogue)."""
        catalogue = self.first.fit.model.catalogue
        return [name for name in catalogue.names if catalogue.rubs(name) and (key is None or name in key)]

    def drags(self, key: Key | None = None) -> list[str]:
        """What takes energy and is no friction among the effects of a structure (default: of the catalogue)."""
        catalogue = self.first.fit.model.catalogue
        names = (name for name in catalogue.names if catalogue.damps(name) and not catalogue.rubs(name))
        return [name for name in names if key is None or name in key]

    def effects(self) -> dict[str, float]:
        """The probability of being there of each effect beside the base, the most probable first."""
        names = {name for key in self.known for name in self.added(key)}
        return dict(
            sorted(((name, self.of([name])) for name in names), key=lambda entry: (-entry[1], entry[0]))
        )

    def nothing(self) -> float:
        """The probability that nothing is missing, though recordings may have a natural frequency each."""
        return self.whole_without(set(self.first.fit.model.catalogue.names) - self.base)

    def whole_without(self, names: Collection[str]) -> float:
        """The probability that none of these effects is there, and that the others leave nothing that is missing."""
        unwanted, shares = frozenset(names), self.probabilities()
        return sum(shares[key] * one.whole for key, one in self.known.items() if not key & unwanted)

    @property
    def bases(self) -> list[Structure]:
        """The structures that add no effect, the most probable first."""
        return sorted(
            (one for one in self.known.values() if not self.added(one.key)), key=lambda one: -one.evidence
        )
