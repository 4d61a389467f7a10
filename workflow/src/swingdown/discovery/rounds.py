"""One round of discovery: look where the fit fails, name what could mend it, and choose what swings that were left out confirm."""

from collections.abc import Collection, Sequence
from dataclasses import replace

import numpy as np

from ..engine.trajectory import TrajectoryError
from ..fitting.least_squares import fit_jointly
from ..fitting.result import Fit
from ..pendulum.effect import NATURAL_FREQUENCY
from ..pendulum.model import Model
from ..pendulum.slack import Slack
from .admissible import leaves_noise
from .budget import Budget
from .campaign import Campaign, Noise, measure_noise
from .choice import confirmed, gained, ranked_by_evidence, shape_believed, to_the_end, weighed
from .confirm import predict
from .differences import coarse_noise
from .evidence import Candidate, evidence, tied
from .free_form import fit_free_form, kept, missing
from .half_swings import beside
from .linear import Frame, frame
from .locate import groups
from .own_frequency import with_own_frequencies
from .ranking import (
    ENDLESS,
    drops,
    in_place_of,
    ranking,
    told_from_changes,
)
from .refit import nudged, opened
from .state import Round
from .verdict import GUARD

_NEAR = 1.5  # times the noise: what is missing there may be that a fit stopped in the minimum beside the best
_UNNEEDED = 4.0  # chi-square that a held-out swing may lose with a term that is dropped


def first_fit(campaign: Campaign, base: Model) -> Fit:
    """The base model fitted jointly within the catalogue's bounds, the sensor and the clock taken for what they say."""
    base = base.of(campaign.reading).with_slack(Slack(clock=campaign.slack.clock))
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
    more is chosen, nor where the ``budget`` is spent. Where recordings differ in natural frequency more than in anything else, the
    round is that of a fit that gives each its own.
    """
    fit = opened(fit, campaign.fit, campaign.slack, _noise(campaign, fit))
    here = frame(fit, campaign.fit)
    state = _seen(number, campaign, here, tuple(found))
    if state.missing and found and not budget.spent and fit.rms < _NEAR * state.noise.deviation:
        better = nudged(fit, campaign.fit)
        if better is not fit:
            return look(number, campaign, better, found, allowed, last, budget)
    if not state.missing:
        return _finished(state, here, campaign, allowed, last)
    if last or budget.spent:
        return replace(state, reason="no round is left" if last else "the search's time is spent")
    ranked = list(ranking(here, state.noise, allowed, budget))
    # two that were found may stand for two others: a better one may take an earlier one's place
    for old in found:
        if not budget.spent:
            ranked += in_place_of(here, state.noise, old, allowed)
    own = None if budget.spent else with_own_frequencies(here, state.noise, campaign, ranked)
    if own is not None:
        return look(number, campaign, own, found, allowed, last, budget)
    ranked = told_from_changes(ranked, here, state.noise, found)
    state = ranked_by_evidence(state, here, ranked)
    state = confirmed(state, campaign)
    if state.chosen and leaves_noise(state.chosen.fit, state.noise):
        return shape_believed(state, here, campaign, allowed, budget)
    return weighed(state, here, campaign, allowed, budget)


def _noise(campaign: Campaign, fit: Fit) -> Noise:
    """The noise on a campaign's swings, from the residuals of a fit to them."""
    swings, frequency = campaign.fit, fit.model.values[NATURAL_FREQUENCY.name]
    intervals = [(swing.times[-1] - swing.times[0]) / (swing.times.size - 1) for swing in swings]
    residuals = [swing.angle - one.angle for swing, one in zip(swings, fit.swings, strict=True)]
    noise = measure_noise(residuals, intervals, frequency / (2 * np.pi), campaign.static)
    return coarse_noise(noise, swings, frequency / (2 * np.pi))


def _seen(number: int, campaign: Campaign, here: Frame, found: tuple[str, ...]) -> Round:
    """The ``Round`` at a fit before anything is tried: the noise, and where model and measurement disagree."""
    fit, swings = here.fit, campaign.fit
    frequency = fit.model.values[NATURAL_FREQUENCY.name]
    noise = _noise(campaign, fit)
    modelled = [(swing.times, one.angle) for swing, one in zip(swings, fit.swings, strict=True)]
    names, pairs = [swing.name for swing in swings], [swing.pair for swing in swings]
    return Round(
        number, fit, predict(fit, campaign.holdout), noise, tuple(groups(here, noise)), missing(here, noise),
        kept(here, noise), beside(names, pairs, modelled, frequency, fit.model.restoring, campaign.reading), found,
    )  # fmt: skip


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
            others = in_place_of(here, state.noise, name, allowed, beside=True)
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
        grown = Candidate(form.name, None, fit, evidence(fit, state.noise))
        one = to_the_end(grown, state, campaign, grown=False)
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
