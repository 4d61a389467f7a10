"""One round of discovery after the other: fit, look where it fails, name what is missing, confirm, add."""

from dataclasses import dataclass, field, replace

import numpy as np

from ..engine.trajectory import TrajectoryError
from ..fitting.fit import fit_jointly
from ..pendulum import catalogue as effects
from .campaign import measure_noise
from .confirm import better, predict
from .free_form import fit_free_form, kept, missing
from .half_swings import beside
from .linear import each_model, frame
from .locate import groups
from .name import Candidate, correlation, drops, evidence, in_place_of, ranking, tied
from .refit import nudged, refit
from .verdict import GUARD

_SUBSTANTIAL = (
    1 / 3
)  # of what is left beyond the noise: many small additions can imitate anything, and name nothing
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
    fit: object
    holdout: object
    noise: object
    groups: tuple
    curves: object
    kept: object
    half_swings: object
    found: tuple = ()
    ranked: tuple = ()
    ties: tuple = ()
    alike: dict = field(default_factory=dict)
    rivals: dict = field(default_factory=dict)
    chosen: object = None  # the Candidate that is the next model, or None
    reason: str = ""  # why there is none

    @property
    def bic(self):
        """The evidence of the fit, to hold the candidates' against."""
        return evidence(self.fit, self.noise)

    @property
    def model(self):
        """The model with standard errors that know the noise's colour."""
        wider = np.sqrt(self.noise.inflation)
        model = self.fit.model
        return model.with_values(
            model.values, {name: error * wider for name, error in model.standard_errors.items()}
        )

    @property
    def missing(self):
        """True where some group finds more than the noise allows."""
        return any(group.p < GUARD["p_missing"] for group in self.groups)


def first_fit(campaign, base, restoring="sine", form="consistent"):
    """The base model fitted jointly within the catalogue's bounds."""
    fit = fit_jointly(
        base, [swing.pair for swing in campaign.fit], bounded=True, restoring=restoring, form=form
    )
    return nudged(fit, campaign.fit)


def fit_from(campaign, begin):
    """The joint fit of the model that a ``refit.Begin`` describes, from the values it has."""
    return refit(begin.model.effects, begin.own, begin, campaign.fit)


def look(number, campaign, fit, found=(), allowed=None, last=False):
    """The ``Round`` at a fit: noise, disagreement, ranking, and the confirmed choice of the next model.

    ``found`` names the effects added before; ``allowed`` limits those that may be added; in the ``last`` round nothing
    more is chosen.
    """
    intervals = [(s.times[-1] - s.times[0]) / (s.times.size - 1) for s in campaign.fit]
    residuals = [swing.angle - series for swing, series in zip(campaign.fit, fit.angle, strict=True)]
    noise = measure_noise(
        residuals, intervals, fit.model.values["natural_frequency"] / (2 * np.pi), campaign.static
    )
    here = frame(fit, campaign.fit)
    modelled = [(swing.times, series) for swing, series in zip(campaign.fit, fit.angle, strict=True)]
    names, pairs = [swing.name for swing in campaign.fit], [swing.pair for swing in campaign.fit]
    seen = beside(names, pairs, modelled, fit.model.values["natural_frequency"])
    state = Round(
        number,
        fit,
        predict(fit, campaign.holdout),
        noise,
        tuple(groups(here, noise)),
        missing(here, noise),
        kept(here, noise),
        seen,
        tuple(found),
    )
    if not state.missing:
        return _finished(state, here, campaign, allowed, last)
    if last:
        return replace(state, reason="no round is left")
    if nameless(found):  # names given to what a free curve leaves would be names of its failings
        return _without_a_name(replace(state, reason="what remains has no form either"), here, campaign)
    ranked = list(ranking(here, noise, allowed))
    for (
        old
    ) in found:  # two that were found may stand for two others: a better one may take an earlier one's place
        ranked += in_place_of(here, noise, old, allowed)
    ranked.sort(key=lambda one: (bool(one.refused), one.bic))
    ties = tuple(tied(ranked, noise))
    alike = {one.move: correlation(here, ties[0], one) for one in ties}
    state = replace(
        state, ranked=tuple(ranked), ties=ties, alike=alike, reason="no effect of the catalogue explains it"
    )
    excess = fit.rss - fit.n * noise.deviation**2
    for one in ties:
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
    return _without_a_name(state, here, campaign)


def _settled(one, state, campaign):
    """The candidate with its fit brought to an end: those that are only ranked stop early, and held-out swings judge the end."""
    fit = refit(
        one.fit.model.effects,
        tuple(model.values for model in each_model(one.fit)),
        one.fit,
        campaign.fit,
        most=_TO_THE_END,
    )
    return replace(one, fit=fit, bic=evidence(fit, state.noise))


def gained(state, candidate, campaign):
    """What a candidate's model gains on the held-out swings, in units of the noise's variance; less than 0 is worse."""
    try:
        return better(state.holdout, predict(candidate.fit, campaign.holdout), state.noise)
    except TrajectoryError:
        return -np.inf


def _finished(state, here, campaign, allowed, last):
    """The state where nothing is missing: what is not needed is dropped, and the rivals of what was found are told."""
    if nameless(state.found):
        return replace(state, reason="what was missing has no name")
    state = replace(state, reason="nothing is missing")
    now = evidence(state.fit, state.noise)
    if not last:
        for one in drops(here, state.noise):
            if not one.refused and one.bic < now and gained(state, one, campaign) > -_UNNEEDED:
                return replace(state, chosen=one, reason="")
    rivals = {}
    if len(state.found) > 1:
        own = Candidate(None, None, state.fit, now)
        for name in state.found:
            near = tied(
                [replace(own, added=name), *in_place_of(here, state.noise, name, allowed)], state.noise
            )
            rivals[name] = [one.added for one in near if one.added != name]
    return replace(state, rivals=rivals)


def _without_a_name(state, here, campaign):
    """The state with a free-form torque as its choice, if one explains something that held-out swings have too.

    The forms are tried in the order of what their groups explain, those that the model has already left out.
    """
    shares = {f"unnamed_{group.name}": group.share for group in state.groups}
    left = [name for name in effects.FREE_FORM if name not in state.found]
    for name in sorted(left, key=lambda name: -shares[name]):
        try:
            fit = fit_free_form(here, name)
            one = _settled(Candidate(name, None, fit, evidence(fit, state.noise)), state, campaign)
        except TrajectoryError:
            continue
        if state.bic - one.bic >= GUARD["worth_bic"] and gained(state, one, campaign) > 0:
            return replace(state, chosen=one)
    return state


def discover(campaign, base, rounds=4, allowed=None, restoring="sine", form="consistent"):
    """The list of ``Round``s from the base model until nothing is missing, nothing helps, or ``rounds`` moves were made."""
    fit, found, states = first_fit(campaign, base, restoring, form), (), []
    for number in range(rounds + 1):
        states.append(look(number, campaign, fit, found, allowed, last=number == rounds))
        if states[-1].chosen is None:
            break
        fit, found = states[-1].chosen.fit, after(found, states[-1].chosen)
    return states


def nameless(found):
    """Those of the effects that are torques without a name."""
    return [name for name in found if name in effects.FREE_FORM]


def after(found, chosen):
    """The names of the effects found, after a move."""
    return tuple(name for name in (*found, chosen.added) if name not in (None, chosen.dropped))
