"""The search for what is missing.

1. Fit the base model, and look at it: its evidence as it is, and with a discrepancy (``discrepancy``).
2. Fit each effect of the catalogue in addition, and in the place of what it can stand in for (``ranking``); two at a time where no one
   leaves nothing.
3. Look at each of these structures in the same way, and go on from the most probable, until that is one that was gone on from.
4. Fit the most probable structure without each of its effects, and with others in the place of each: what else would do. Fit those about as
   probable without what of the base is idle in them.
5. Judge each effect that it adds by the numbers of ``criterion`` (``judge``). Swings that are held out are asked here, and nowhere before. Effects
   that take away too little of what is missing are left out one by one, where any is left that takes away enough. Of effects that are tied
   a less probable one may be told that leaves less. Of what is told step 4 is asked, too, and what is found to be more probable is judged
   instead. Friction and drag may be sure without a name: by the discrepancy, or by the envelope of the swings (``envelope``). Where something
   unnamed does as well as any name, the most probable of these is judged (``stand_in``). What held-out swings alone show is missing, too.
6. Fit each law of damping beside what else the structure has: the pendulum's values are told from all of them (``conclusion``).

The discrepancy in every structure is that of Kennedy and O'Hagan, J. R. Stat. Soc. B 63, 425 (2001).
"""

from collections.abc import Collection
from contextlib import suppress
from dataclasses import replace

import numpy as np
from threadpoolctl import threadpool_limits

from ..engine.trajectory import TrajectoryError
from ..fitting.result import Begin, Fit
from ..pendulum.catalogue import READINGS
from ..pendulum.model import Model, as_model
from ..studies.scale import scale_of
from .budget import Budget
from .criterion import USUAL, Criterion
from .data.campaign import Campaign
from .judge.findings import stand_in, told_of
from .judge.structures import Key, Structure
from .move.admissible import chance_of, clear
from .move.candidates import without
from .move.evidence import Candidate
from .move.laws import damping, with_each_law
from .move.own_frequency import with_own_frequencies
from .move.ranking import beside_the_best, drops, in_pairs, in_place_of, ranking
from .move.refit import FAILURES, opened, refit, with_effect
from .next.proposal import NextSwing, next_swing
from .rounds import first_fit, pool_of, round_of, unseen
from .state import Round
from .tell.conclusion import holds_throughout

_AGAIN = (
    2  # times that what else would do, or what is around the best of names, may turn out to be more probable
)


def discover(
    campaign: Campaign,
    base: Model | str,
    rounds: int = 4,
    allowed: Collection[str] | None = None,
    budget_s: float | None = None,
    criterion: Criterion = USUAL,
) -> list[Round]:
    """The rounds of a search, from the base model to the most probable structure; the last round is judged.

    Parameters
    ----------
    campaign
        The swings of one pendulum, as ``campaign.campaign`` returns them.
    base
        The model to begin with, or its label.
    rounds
        The most moves.
    allowed
        The effects that may be added. Default: all of the catalogue.
    budget_s
        Seconds (``Budget``) after which nothing new is begun; the last round says so. None: no end.
    criterion
        What is told of what is found.

    Returns
    -------
    list of Round
        A single round with the reason (``failed``), where the search itself breaks off.

    Raises
    ------
    TrajectoryError, InputError
        If the base model itself cannot be fitted.
    """
    begun = first_fit(campaign, as_model(base))
    try:
        with threadpool_limits(1, "blas"):  # matrices so small that threads only wait for one another
            search = _Search(campaign, allowed, Budget(budget_s), begun, criterion)
            return search.told(search.searched(rounds))
    except FAILURES as problem:
        return [replace(unseen(campaign, begun), reason="the search broke off", failed=str(problem))]


class _Search:
    """A search on its way."""

    def __init__(
        self,
        campaign: Campaign,
        allowed: Collection[str] | None,
        budget: Budget,
        begun: Fit,
        criterion: Criterion,
    ):
        self.campaign, self.allowed, self.budget = campaign, allowed, budget
        self.pool = pool_of(campaign, begun, criterion=criterion)
        base = opened(begun, campaign.fit, campaign.slack, self.pool.noise)
        if base is not begun:
            self.pool = pool_of(campaign, base, criterion=criterion)
        self.ranked: dict[Key, list[Candidate]] = {}  # by structure, what was tried there
        self.with_laws: set[Key] = set()  # what each law of damping was tried beside
        self.doubted: set[Key] = set()  # the structures of which it was asked what else would do

    def searched(self, rounds: int) -> list[Structure]:
        """The way to the most probable structure."""
        way = [self.pool.first]
        while len(way) <= rounds and not self._ended(way[-1]):
            self._look_around(way[-1])
            self._heard(self._settled())
            if (
                self.pool.best.whole < 0.5
                and self.pool.nothing() <= self.pool.criterion.possible
                and not self.budget.spent
            ):
                self._look_at_pairs(way[-1])
            further = self._further(way)
            if further is None:
                break
            way.append(further)
        for _ in range(_AGAIN if len(way) > 1 else 0):
            self._doubt(way[-1])
            best = self._settled()
            if best.key == way[-1].key:
                break
            others = [one for one in way if one.key != best.key]
            way = way[:1] if best.key == self.pool.base else [*others, best]
        if self.pool.nothing() > self.pool.criterion.possible:
            way = [self.pool.first, *(one for one in self.pool.bases[:1] if one.key != self.pool.first.key)]
        way = [self.pool.known[one.key] for one in way if one.key in self.pool.known]
        return [way[0], *way[1:][-rounds:]] if rounds else way[:1]

    def told(self, way: list[Structure]) -> list[Round]:
        """The rounds of the way, the last with what is judged."""
        pool, way = self.pool, self._followed(way)
        if not pool.added(way[-1].key) and pool.lacks(way[-1]):
            way = [*way, *stand_in(pool)]
        best = pool.best.key
        last, found = told_of(pool, way[-1])
        if any(one.sure for one in found.values()) and last.key not in self.doubted:
            self._doubt(last)  # of fewer effects than the most probable structure has
            last, found = told_of(pool, way[-1])
        looked_at = pool.best.key not in (best, way[0].key) and pool.follows(pool.best.fit)
        if looked_at and pool.nothing() <= pool.criterion.possible:
            return self.told([way[0], pool.best])  # more probable than what it was looked at to judge
        way = way if last.key == way[-1].key else [way[0], *way[1:-1], last]
        sure = any(one.sure for one in found.values())
        try:
            states = self._rounds(way)
        except TrajectoryError:  # of held-out swings that a model on the way cannot follow
            states = []
            if sure and pool.follows(last.fit):
                states = self._rounds([way[0], last])
        if not (states and (sure or states[-1].holdout.rms <= states[0].holdout.rms)):
            # where nothing is told, what held-out swings speak against is no better model
            last, found, states = way[0], {}, self._rounds(way[:1])
        if not states[-1].missing and self._surprised(states[-1]):
            # where in the fitted swings it is missing is not seen
            states[-1] = replace(states[-1], missing=True, groups=())
        state = replace(
            states[-1], reason=self._reason(last), findings=found, probabilities=pool.effects(), nothing=pool.nothing(),
            spent=self.budget.spent,
        )  # fmt: skip
        if state.missing or state.found:
            pairs = [
                swing.pair for swing in self.campaign.whole or (*self.campaign.fit, *self.campaign.holdout)
            ]
            scale = scale_of(pairs, state.fit.model.restoring, self.campaign.reading)
            # where nothing is missing any more, and another unit would leave something, it is found in the unit that there is
            clear = not state.missing and scale.left > chance_of(state.fit, pool.noise)
            known = self.campaign.own or clear
            doubt = "" if known else scale.doubt(READINGS[self.campaign.reading])
            state = replace(state, unit_doubt=self.campaign.unit_doubt or doubt, next_swing=self._next(state))
        return [*states[:-1], replace(state, counting=tuple(self._counting(last)))]

    def _surprised(self, state: Round) -> bool:
        """Whether held-out swings show that something is missing of which the fitted ones show nothing: fitted to all of them the model leaves
        more than it does of these, by more than five standard deviations of chance. (Of one recording what holds from part to part alone is told
        as such.)"""
        fit, allowed = state.fit, chance_of(state.fit, self.pool.noise)
        if state.holdout.rms <= allowed:
            return False
        swings = (*self.campaign.fit, *self.campaign.holdout)
        begin = Begin(fit.model, (*fit.begin.swings, *state.holdout.begin.swings))
        try:
            whole = refit(begin, swings, grown=False, ended=True)
        except TrajectoryError:
            return True
        of_parts = len(self.campaign.whole) == 1 and not holds_throughout(whole, fit, self.campaign)
        return whole.rms > allowed and not of_parts

    def _followed(self, way: list[Structure]) -> list[Structure]:
        """The way to the most probable structure that can follow the held-out swings: one that cannot is none."""
        while way[1:] and not self.pool.follows(way[-1].fit):
            self.pool.known.pop(way[-1].key)
            best = self.pool.best
            before = [one for one in way[1:-1] if one.key != best.key]
            way = way[:1] if best.key == way[0].key else [way[0], *before, best]
        return way

    def _rounds(self, way: list[Structure]) -> list[Round]:
        """The rounds of the way; TrajectoryError where held-out swings cannot be followed."""
        goes_on = [*way[1:], None]
        return [
            round_of(k, self.pool, one, self.ranked.get(one.key, ()), to)
            for k, (one, to) in enumerate(zip(way, goes_on, strict=True))
        ]

    def _reason(self, last: Structure) -> str:
        """Why nothing more was chosen."""
        if not self.pool.lacks(last):
            return "nothing is missing"
        return "the search's time is spent" if self.budget.spent else "nothing more is as probable"

    def _next(self, state: Round) -> NextSwing | None:
        """The experiment that tells the two most probable structures apart; None where the first is sure."""
        shares = self.pool.probabilities()
        known = sorted(self.pool.known.values(), key=lambda one: -shares[one.key])[:2]
        if len(known) < 2 or not (state.missing or shares[known[1].key] > self.pool.criterion.possible):
            return None
        return next_swing(known[0].fit, known[1].fit, self.campaign, self.pool.noise)

    def _ended(self, here: Structure) -> bool:
        """True where nothing more is asked: time is spent, or what is there leaves nothing that a discrepancy would explain."""
        return self.budget.spent or (here.key != self.pool.base and here.whole > 0.5)

    def _further(self, way: list[Structure]) -> Structure | None:
        """The most probable structure, where the way has not come to it; None where nothing more is.

        Something unnamed does in the place of an effect what that does not do without another one. Where it is the most probable, what may be
        as probable is looked for around the best structure of names alone.
        """
        been, best = {one.key for one in way}, self._settled()
        tried = set(been)
        for _ in range(_AGAIN):
            named = self.pool.best_named()
            whole = best.key not in been or not self.pool.lacks(best)
            if whole or self.budget.spent or named is None or named.key in tried:
                break
            tried.add(named.key)
            least = best.evidence + np.log(self.pool.criterion.possible) - named.plain
            self._look_around(named, named.fit.rss - 2 * self.pool.noise.slow_variance * least)
            self._heard(self._settled())
            best = self._settled()
        return None if best.key in been else best

    def _look_around(self, here: Structure, reach: float = np.inf) -> None:
        """Each effect in addition and in the place of others, the structure without each, and a natural frequency for each recording; of
        effects those alone that may leave no more than ``reach`` (rad^2)."""
        ranked = ranking(here.frame, self.pool.noise, self.allowed, self.budget, reach)
        for old in self.pool.added(here.key):
            if not self.budget.spent:
                ranked += in_place_of(here.frame, self.pool.noise, old, self.allowed, reach=reach)
        if not self.budget.spent:
            own = with_own_frequencies(here.frame, self.pool.noise, self.campaign, ranked)
            if own is not None:
                self.pool.look(own)
        if not self.budget.spent and here.key == self.pool.base:
            ranked += drops(here.frame, self.pool.noise)
        self._keep(here, ranked)

    def _look_at_pairs(self, here: Structure) -> None:
        """Two effects at a time."""
        pairs = in_pairs(here.frame, self.pool.noise, self.allowed, budget=self.budget)
        ranked = self.ranked.get(here.key, [])
        pairs += beside_the_best(here.frame, self.pool.noise, ranked, self.allowed, budget=self.budget)
        self._keep(here, [*ranked, *pairs])

    def _keep(self, here: Structure, ranked: list[Candidate]) -> None:
        best = sorted(ranked, key=lambda one: (bool(one.refused), one.bic))
        moves: dict[str, Candidate] = {}
        for one in best:
            moves.setdefault(one.move, one)
        self.ranked[here.key] = [*moves.values()]
        for one in ranked:
            if not one.refused:
                self.pool.look(one.fit)

    def _settled(self) -> Structure:
        """The most probable structure, its fit brought to the end."""
        while True:
            best = self.pool.best
            try:
                fit = refit(best.fit.begin, self.campaign.fit, ended=True)
            except TrajectoryError:
                return best
            if not fit.rss < best.fit.rss * (1 - 1e-9):
                return best
            self.pool.look(fit)

    def _heard(self, best: Structure) -> None:
        """What the best structure leaves in the band of the noise is the noise: what a worse one leaves there may be its misfit. Of this and
        the noise so far it is the one under which a structure is more probable. Unnamed torques are those that act on the best one's swings."""
        if best.fit is not self.pool.near:
            first, criterion = self.pool.first.fit, self.pool.criterion
            heard = pool_of(self.campaign, best.fit, first, [self.pool.noise], criterion)
            heard.take(self.pool)
            self.pool = heard

    def _doubt(self, last: Structure) -> None:
        """What else would do: the structure without each of its effects, those of the base too, with another in the place of each, and with
        each law of damping."""
        self.doubted.add(last.key)
        for name in self.pool.begun_with & last.key if len(last.fit.model.names) > 1 else ():
            if not self.budget.spent:
                self.pool.lacking(last, [name])
        self._without_idle()
        for name in self.pool.added(last.key):
            if self.budget.spent:
                return
            self.pool.lacking(last, [name])
            for one in in_place_of(last.frame, self.pool.noise, name, self.allowed, beside=True):
                if not one.refused:
                    self.pool.look(one.fit)
            for old in self.pool.begun_with - last.key:
                with suppress(TrajectoryError):
                    self.pool.look(self._restored(last.fit, name, old))
        self._look_at_laws(last)

    def _without_idle(self) -> None:
        """The structures that may be as probable as the best, without the effects of the base that do nothing beside theirs: what an idle
        effect costs is no evidence against another."""
        pool = self.pool
        for one in list(pool.known.values()):
            idle = [
                name for name in pool.begun_with & one.key if pool.added(one.key) and not clear(one.fit, name)
            ]
            gain = 0.5 * len(idle) * np.log(pool.noise.effective(one.fit.n))
            if idle and one.evidence + gain > pool.best.evidence + np.log(pool.criterion.possible):
                if self.budget.spent:
                    return
                pool.lacking(one, idle)

    def _look_at_laws(self, last: Structure) -> None:
        """Each law of damping in the place of the structure's own."""
        beside = last.key - damping(last.fit.model)
        if beside not in self.with_laws:
            for fit in with_each_law(last.fit, self.campaign, self.pool.noise, self.budget, self.allowed):
                self.pool.look(fit)
            self.with_laws.add(beside)

    def _counting(self, last: Structure) -> list[tuple[float, Fit]]:
        """What values are told from: each law of damping in the place of the model's own, beside what else the structures have."""
        self._look_at_laws(last)
        laws = damping(last.fit.model)
        for _, fit in self.pool.counting(laws):
            with suppress(TrajectoryError):
                self.pool.look(refit(fit.begin, self.campaign.fit, ended=True))
        return self.pool.counting(laws)

    def _restored(self, fit: Fit, name: str, old: str) -> Fit:
        """The fit with an effect of the base again in the place of another one."""
        first = self.pool.first.fit.model
        values = {p.name: first.values[p.name] for p in first.catalogue[old].parameters}
        return refit(with_effect(without(fit, name), old, values), self.campaign.fit, ended=True)
