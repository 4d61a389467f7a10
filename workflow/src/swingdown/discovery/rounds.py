"""One round of discovery after the other: fit, look where it fails, name what is missing, confirm, add."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import pandas as pd

from ..engine.trajectory import TrajectoryError
from ..fitting.least_squares import fit_jointly
from ..fitting.result import Begin, Fit
from ..pendulum.effect import NATURAL_FREQUENCY
from ..pendulum.model import Model, as_model
from ..pendulum.slack import Slack
from .campaign import Campaign, Noise, measure_noise
from .confirm import better, predict
from .free_form import fit_free_form, kept, missing
from .half_swings import beside
from .linear import Frame, frame
from .locate import Group, groups
from .ranking import Candidate, correlation, drops, evidence, in_place_of, ranking, tied
from .refit import nudged, refit, weighed
from .verdict import GUARD

# of what is left beyond the noise: many small additions can imitate anything, and name nothing
_SUBSTANTIAL = 1 / 3
_TO_THE_END = 200  # evaluations
_UNNEEDED = 4.0  # chi-square that a held-out swing may lose with a term that is dropped


@dataclass(frozen=True)
class Round:
    """The state after so many moves: the fit and where it fails, what could mend it, and what was chosen.

    ``found`` names the effects added so far; ``ties`` are those of ``ranked`` that the data do not tell apart, ``alike`` their
    correlations with the first of them by move; ``rivals`` holds for each the effects that would do as well in its place
    (looked for in the last round); ``curves`` is the table of missing torques, ``kept`` that of the torques without a name
    that the model has, ``half_swings`` that of what the fitted swings show without a model, beside what the model shows.
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

    @property
    def bic(self) -> float:
        """The evidence of the fit, to hold the candidates' against."""
        return evidence(self.fit, self.noise)

    @property
    def model(self) -> Model:
        """The model with standard errors that know the noise's colour."""
        model, systematic = self.fit.model, np.sum(self.fit.systematic**2, axis=1)
        random = np.diag(self.fit.covariance) - systematic
        errors = dict(zip(self.fit.free, np.sqrt(random * self.noise.inflation + systematic), strict=True))
        return model.with_values(model.values, {name: float(errors[name]) for name in model.standard_errors})

    @property
    def nameless(self) -> list[str]:
        """Those of the effects found that are torques without a name."""
        return [name for name in self.found if not self.fit.model.catalogue.has_name(name)]

    @property
    def missing(self) -> bool:
        """True where some group finds more than the noise allows."""
        return any(group.p < GUARD["p_missing"] for group in self.groups)


def first_fit(campaign: Campaign, base: Model) -> Fit:
    """The base model fitted jointly within the catalogue's bounds, the sensor and the clock taken for what they say."""
    base = base.with_slack(Slack(clock=campaign.slack.clock))
    fit = fit_jointly(base, [swing.pair for swing in campaign.fit], bounded=True)
    return nudged(fit, campaign.fit)


def fit_from(campaign: Campaign, begin: Begin) -> Fit:
    """The joint fit of the model that a ``Begin`` has, from the values it has."""
    return refit(begin, campaign.fit)


def look(
    number: int,
    campaign: Campaign,
    fit: Fit,
    found: Sequence[str] = (),
    allowed: Collection[str] | None = None,
    last: bool = False,
) -> Round:
    """The ``Round`` at a fit: noise, disagreement, ranking, and the confirmed choice of the next model.

    ``found`` names the effects added before; ``allowed`` limits those that may be added; in the ``last`` round nothing
    more is chosen.
    """
    fit = weighed(fit, campaign.fit, campaign.slack, _noise(campaign, fit))
    here = frame(fit, campaign.fit)
    state = _seen(number, campaign, here, tuple(found))
    if not state.missing:
        return _finished(state, here, campaign, allowed, last)
    if last:
        return replace(state, reason="no round is left")
    if state.nameless:  # names given to what a free curve leaves would be names of its failings
        return _without_a_name(replace(state, reason="what remains has no form either"), here, campaign)
    ranked = list(ranking(here, state.noise, allowed))
    for (
        old
    ) in found:  # two that were found may stand for two others: a better one may take an earlier one's place
        ranked += in_place_of(here, state.noise, old, allowed)
    ranked.sort(key=lambda one: (bool(one.refused), one.bic))
    ties = tuple(tied(ranked, state.noise))
    alike = {one.move: correlation(here, ties[0], one) for one in ties}
    state = replace(
        state, ranked=tuple(ranked), ties=ties, alike=alike, reason="no effect of the catalogue explains it"
    )
    state = _confirmed(state, campaign)
    return state if state.chosen else _without_a_name(state, here, campaign)


def _noise(campaign: Campaign, fit: Fit) -> Noise:
    """The noise on a campaign's swings, from the residuals of a fit to them."""
    swings, frequency = campaign.fit, fit.model.values[NATURAL_FREQUENCY.name]
    intervals = [(swing.times[-1] - swing.times[0]) / (swing.times.size - 1) for swing in swings]
    residuals = [swing.angle - one.angle for swing, one in zip(swings, fit.swings, strict=True)]
    return measure_noise(residuals, intervals, frequency / (2 * np.pi), campaign.static)


def _seen(number: int, campaign: Campaign, here: Frame, found: tuple[str, ...]) -> Round:
    """The ``Round`` at a fit before anything is tried: the noise, and where model and measurement disagree."""
    fit, swings = here.fit, campaign.fit
    frequency = fit.model.values[NATURAL_FREQUENCY.name]
    noise = _noise(campaign, fit)
    modelled = [(swing.times, one.angle) for swing, one in zip(swings, fit.swings, strict=True)]
    names, pairs = [swing.name for swing in swings], [swing.pair for swing in swings]
    return Round(
        number, fit, predict(fit, campaign.holdout), noise, tuple(groups(here, noise)), missing(here, noise),
        kept(here, noise), beside(names, pairs, modelled, frequency), found,
    )  # fmt: skip


def _confirmed(state: Round, campaign: Campaign) -> Round:
    """The state with the first of its tied candidates that held-out swings confirm as its choice, or why there is none."""
    fit = state.fit
    excess = fit.rss - fit.n * state.noise.deviation**2
    for one in state.ties:
        if state.bic - one.bic < GUARD["worth_bic"]:
            continue
        if fit.rss - one.fit.rss < _SUBSTANTIAL * excess:
            state = replace(state, reason=f"{one.move} explains little of what is left")
            continue
        try:
            settled = _settled(one, state, campaign)
        except TrajectoryError:  # at the edge of what the engine can follow, and no model to go on from
            state = replace(state, reason=f"{one.move} makes motions that cannot be computed closely enough")
            continue
        if gained(state, settled, campaign) > 0:
            return replace(state, chosen=settled, reason="")
        state = replace(state, reason=f"{one.move} is not confirmed on held-out swings")
    return state


def _settled(one: Candidate, state: Round, campaign: Campaign) -> Candidate:
    """The candidate with its fit brought to an end: those that are only ranked stop early, and held-out swings judge the end."""
    fit = refit(one.fit.begin, campaign.fit, most=_TO_THE_END)
    return replace(one, fit=fit, bic=evidence(fit, state.noise))


def gained(state: Round, candidate: Candidate, campaign: Campaign) -> float:
    """What a candidate's model gains on the held-out swings, in units of the noise's variance; less than 0 is worse."""
    try:
        return better(state.holdout, predict(candidate.fit, campaign.holdout), state.noise)
    except TrajectoryError:
        return -np.inf


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


def _without_a_name(state: Round, here: Frame, campaign: Campaign) -> Round:
    """The state with a free-form torque as its choice, if one explains something that held-out swings have too.

    The forms are tried in the order of what their groups explain, those that the model has already left out.
    """
    shares = {group.name: group.share for group in state.groups}
    left = [form for form in state.fit.model.catalogue.free_forms if form.name not in state.found]
    for form in sorted(left, key=lambda form: -shares[form.over]):
        try:
            fit = fit_free_form(here, form)
            one = _settled(Candidate(form.name, None, fit, evidence(fit, state.noise)), state, campaign)
        except TrajectoryError:
            continue
        if state.bic - one.bic >= GUARD["worth_bic"] and gained(state, one, campaign) > 0:
            return replace(state, chosen=one)
    return state


def discover(
    campaign: Campaign, base: Model | str, rounds: int = 4, allowed: Collection[str] | None = None
) -> list[Round]:
    """The list of ``Round``s from the base model until nothing is missing, nothing helps, or ``rounds`` moves were made."""
    found: tuple[str, ...] = ()
    fit, states = first_fit(campaign, as_model(base)), []
    for number in range(rounds + 1):
        states.append(look(number, campaign, fit, found, allowed, last=number == rounds))
        if states[-1].chosen is None:
            break
        fit, found = states[-1].chosen.fit, after(found, states[-1].chosen)
    return states


def after(found: Sequence[str], chosen: Candidate) -> tuple[str, ...]:
    """The names of the effects found, after a move."""
    return tuple(name for name in (*found, chosen.added) if name is not None and name != chosen.dropped)
