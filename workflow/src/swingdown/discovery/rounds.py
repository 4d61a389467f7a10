"""One round of discovery: look where the fit fails, name what could mend it, and choose what swings that were left out confirm."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import pandas as pd

from ..engine.trajectory import TrajectoryError
from ..fitting.least_squares import fit_jointly
from ..fitting.result import Fit
from ..pendulum.effect import NATURAL_FREQUENCY
from ..pendulum.model import Model
from .budget import Budget
from .campaign import Campaign, Noise, measure_noise
from .candidates import without
from .confirm import better, predict
from .differences import coarse_noise
from .free_form import fit_free_form, kept, missing
from .half_swings import beside
from .linear import Frame, frame
from .locate import Group, groups
from .ranking import (
    ENDLESS,
    TIE,
    Candidate,
    correlation,
    drops,
    evidence,
    in_pairs,
    in_place_of,
    leaves_noise,
    ranking,
    tied,
)
from .refit import nudged, refit
from .verdict import GUARD

# of what is left beyond the noise: many small additions can imitate anything, and name nothing
_SUBSTANTIAL = 1 / 3
_TO_THE_END = 200  # evaluations
_UNNEEDED = 4.0  # chi-square that a held-out swing may lose with a term that is dropped
_REACHED = 0.9  # of what a shape gains: pairs that promise less to first order are not tried beside it
_CONTENDERS = 6  # that held-out swings judge, besides pairs
_EACH = 0.02  # of the logarithm of what is left: what a parameter more must gain


@dataclass(frozen=True)
class Round:
    """The state after so many moves: the fit and where it fails, what could mend it, and what was chosen.

    ``found`` names the effects added so far; ``ties`` are those of ``ranked`` that the data do not tell apart, ``alike`` their
    correlations with the first of them by move; ``rivals`` holds for each the effects that would do as well in its place
    (looked for in the last round); ``curves`` is the table of missing torques, ``kept`` that of the torques without a name
    that the model has, ``half_swings`` that of what the fitted swings show without a model, beside what the model shows.
    ``out_of_sample`` holds, by move, the logarithm by which those that were judged so shrink what held-out swings leave;
    ``others`` are those of them that were not chosen, best first.
    """

    number: int
    fit: Fit
    holdout: Fit
    noise: Noise
    groups: tuple[Group, ...]
    curves: pd.DataFrame
    kept: pd.DataFrame
    half_swings: pd.DataFrame
    found: tuple[str, ...] = ()
    ranked: tuple[Candidate, ...] = ()
    ties: tuple[Candidate, ...] = ()
    alike: dict[str, float] = field(default_factory=dict)
    rivals: dict[str, list[str]] = field(default_factory=dict)
    chosen: Candidate | None = None  # the next model
    reason: str = ""  # why there is none
    out_of_sample: dict[str, float] = field(default_factory=dict)
    others: tuple[Candidate, ...] = ()
    established: dict[str, str] | None = None
    """By effect found, why it is not established, or empty; None where nothing more is missing."""
    spent: bool = False  # the search's budget

    @property
    def bic(self) -> float:
        """The evidence of the fit, to hold the candidates' against."""
        return evidence(self.fit, self.noise)

    @property
    def model(self) -> Model:
        """The model with standard errors that know the noise's colour."""
        wider = np.sqrt(self.noise.inflation)
        model = self.fit.model
        return model.with_values(
            model.values, {name: error * wider for name, error in model.standard_errors.items()}
        )

    @property
    def nameless(self) -> list[str]:
        """Those of the effects found that are torques without a name."""
        return [name for name in self.found if not self.fit.model.catalogue.has_name(name)]

    @property
    def missing(self) -> bool:
        """True where some group finds more than the noise allows."""
        return any(group.p < GUARD["p_missing"] for group in self.groups)


def first_fit(campaign: Campaign, base: Model) -> Fit:
    """The base model fitted jointly within the catalogue's bounds."""
    fit = fit_jointly(base, [swing.pair for swing in campaign.fit], bounded=True)
    return nudged(fit, campaign.fit)


def look(
    number: int,
    campaign: Campaign,
    fit: Fit,
    found: Sequence[str] = (),
    allowed: Collection[str] | None = None,
    last: bool = False,
    budget: Budget = ENDLESS,
) -> Round:
    """The ``Round`` at a fit: noise, disagreement, ranking, and the confirmed choice of the next model.

    ``found`` names the effects added before; ``allowed`` limits those that may be added; in the ``last`` round nothing
    more is chosen, nor where the ``budget`` is spent.
    """
    here = frame(fit, campaign.fit)
    state = _seen(number, campaign, here, tuple(found))
    if not state.missing:
        return _finished(state, here, campaign, allowed, last)
    if last or budget.spent:
        return replace(state, reason="no round is left" if last else "the search's time is spent")
    ranked = list(ranking(here, state.noise, allowed, budget))
    # two that were found may stand for two others: a better one may take an earlier one's place
    for old in found:
        if not budget.spent:
            ranked += in_place_of(here, state.noise, old, allowed)
    state = _ranked(state, here, ranked)
    state = _confirmed(state, campaign)
    if state.chosen and leaves_noise(state.chosen.fit, state.noise):
        return _shape_believed(state, here, campaign, allowed, budget)
    return _judged(state, here, campaign, allowed, budget)


def _ranked(state: Round, here: Frame, ranked: Sequence[Candidate]) -> Round:
    """The state with these candidates, best first, and those of them that the data do not tell apart."""
    ranked = sorted(ranked, key=lambda one: (bool(one.refused), one.bic))
    ties = tuple(tied(ranked, state.noise))
    alike = {one.move: correlation(here, ties[0], one) for one in ties}
    reason = "no effect of the catalogue explains it"
    return replace(state, ranked=tuple(ranked), ties=ties, alike=alike, reason=reason)


def _seen(number: int, campaign: Campaign, here: Frame, found: tuple[str, ...]) -> Round:
    """The ``Round`` at a fit before anything is tried: the noise, and where model and measurement disagree."""
    fit, swings = here.fit, campaign.fit
    frequency = fit.model.values[NATURAL_FREQUENCY.name]
    intervals = [(swing.times[-1] - swing.times[0]) / (swing.times.size - 1) for swing in swings]
    residuals = [swing.angle - one.angle for swing, one in zip(swings, fit.swings, strict=True)]
    noise = measure_noise(residuals, intervals, frequency / (2 * np.pi), campaign.static)
    noise = coarse_noise(noise, swings, frequency / (2 * np.pi))
    modelled = [(swing.times, one.angle) for swing, one in zip(swings, fit.swings, strict=True)]
    names, pairs = [swing.name for swing in swings], [swing.pair for swing in swings]
    return Round(
        number, fit, predict(fit, campaign.holdout), noise, tuple(groups(here, noise)), missing(here, noise),
        kept(here, noise), beside(names, pairs, modelled, frequency), found,
    )  # fmt: skip


def _substantial(one: Candidate, state: Round) -> bool:
    """True where a candidate is worth its parameters and explains a good part of what is left beyond the noise."""
    excess = state.fit.rss - state.fit.n * state.noise.deviation**2
    return state.bic - one.bic >= GUARD["worth_bic"] and state.fit.rss - one.fit.rss >= _SUBSTANTIAL * excess


def _confirmed(state: Round, campaign: Campaign) -> Round:
    """The state with the first of its tied candidates that held-out swings confirm as its choice, or why there is none."""
    for one in state.ties:
        if not _substantial(one, state):
            state = replace(state, reason=f"{one.move} explains little of what is left")
            continue
        settled = _settled(one, state, campaign)
        if settled is None:  # at the edge of what the engine can follow, and no model to go on from
            state = replace(state, reason=f"{one.move} makes motions that cannot be computed closely enough")
        elif gained(state, settled, campaign) > 0:
            return replace(state, chosen=settled, reason="")
        else:
            state = replace(state, reason=f"{one.move} is not confirmed on held-out swings")
    return state


def _settled(one: Candidate, state: Round, campaign: Campaign) -> Candidate | None:
    """The candidate with its fit brought to an end: those that are only ranked stop early, and held-out swings judge the end.

    None where the end is none that the engine can follow.
    """
    try:
        fit = refit(one.fit.begin, campaign.fit, most=_TO_THE_END)
    except TrajectoryError:
        return None
    return replace(one, fit=fit, bic=evidence(fit, state.noise))


def gained(state: Round, candidate: Candidate, campaign: Campaign) -> float:
    """What a candidate's model gains on the held-out swings, in units of the noise's variance; less than 0 is worse."""
    try:
        return better(state.holdout, predict(candidate.fit, campaign.holdout), state.noise)
    except TrajectoryError:
        return -np.inf


def _shape_believed(
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
    state = _ranked(state, here, [*state.ranked, *pairs])
    return replace(_confirmed(state, campaign), ranked=state.ranked)


def _shaped(one: Candidate) -> bool:
    """True where an effect that is added has a shape of its own."""
    catalogue = one.fit.model.catalogue
    return any(catalogue[name].with_role("shape") for name in one.names)


def _judged(
    state: Round, here: Frame, campaign: Campaign, allowed: Collection[str] | None, budget: Budget
) -> Round:
    """The state with the candidate as its choice that gains most on fitted and held-out swings together, and the others that gain.

    Where every model is far above the noise the fitted swings' evidence separates everything and tells little, and the largest
    gain on a few held-out swings misleads as well: the ranking is walked, pairs without a shape are in it, each must do better
    on the held-out swings, and what it leaves of both kinds of swings is weighed alike.
    """
    chosen = state.chosen
    pairs = in_pairs(here, state.noise, allowed, budget=budget)
    state = _ranked(replace(state, chosen=None), here, [*state.ranked, *pairs])
    worthy = [one for one in state.ranked if not one.refused and _substantial(one, state)]
    judged: list[tuple[float, Candidate]] = []
    gains: dict[str, float] = {}
    for one in [one for one in worthy if not one.also][:_CONTENDERS] + [one for one in worthy if one.also][
        :2
    ]:
        if budget.spent and judged:
            break
        settled = chosen if chosen and chosen.move == one.move else _settled(one, state, campaign)
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
                fit = refit(without(one.fit, effect.name), campaign.fit, most=_TO_THE_END)
            except TrajectoryError:
                return one
            return replace(one, dropped=effect.name, fit=fit, bic=evidence(fit, state.noise))
    return one


def _finished(
    state: Round, here: Frame, campaign: Campaign, allowed: Collection[str] | None, last: bool
) -> Round:
    """The state where nothing is missing: what is not needed is dropped, and the rivals of what was found are told."""
    if state.nameless:
        return replace(state, reason="what was missing has no name")
    state = replace(state, reason="nothing is missing")
    now = evidence(state.fit, state.noise)
    if not last:
        for one in drops(here, state.noise):
            if not one.refused and one.bic < now and gained(state, one, campaign) > -_UNNEEDED:
                return replace(state, chosen=one, reason="")
    rivals: dict[str, list[str]] = {}
    if len(state.found) > 1:
        own = Candidate(None, None, state.fit, now)
        for name in state.found:
            others = in_place_of(here, state.noise, name, allowed)
            near = tied([replace(own, added=name), *others], state.noise)
            rivals[name] = [one.added for one in near if one.added is not None and one.added != name]
    return replace(state, rivals=rivals)


def without_a_name(state: Round, campaign: Campaign) -> Round:
    """The state with a free-form torque as its choice, if one explains something that held-out swings have too.

    The forms are tried in the order of what their groups explain, those that the model has already left out.
    """
    here = frame(state.fit, campaign.fit)
    shares = {group.name: group.share for group in state.groups}
    left = [form for form in state.fit.model.catalogue.free_forms if form.name not in state.found]
    for form in sorted(left, key=lambda form: -shares[form.over]):
        try:
            fit = fit_free_form(here, form)
        except TrajectoryError:
            continue
        one = _settled(Candidate(form.name, None, fit, evidence(fit, state.noise)), state, campaign)
        if one and state.bic - one.bic >= GUARD["worth_bic"] and gained(state, one, campaign) > 0:
            return replace(state, chosen=one)
    return state


def look_again(number: int, campaign: Campaign, fit: Fit, found: Sequence[str], last: bool) -> Round:
    """The ``Round`` at a fit with a torque without a name: names given to what a free curve leaves would be names of its failings."""
    state = _seen(number, campaign, frame(fit, campaign.fit), tuple(found))
    if not state.missing:
        return replace(state, reason="what was missing has no name")
    if last:
        return replace(state, reason="no round is left")
    return without_a_name(replace(state, reason="what remains has no form either"), campaign)


def after(found: Sequence[str], chosen: Candidate) -> tuple[str, ...]:
    """The names of the effects found, after a move."""
    return tuple(name for name in (*found, *chosen.names) if name != chosen.dropped)
