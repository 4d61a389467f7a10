"""What a search says of its pendulum: the values of the model that it ends with, and the quantities, with their covariance."""

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np

from ...arrays import finite_or_none, standard_errors
from ...fitting.result import Begin, Fit, SwingStart
from ...fitting.uncertainty import uncertainty
from ...measurement.plausibility import KEPT, narrowing
from ...studies.fit_rows import largest_angles
from ...studies.quantities import UNITS, Beside, Quantity, about, over_models, quantities, steady
from ..data.campaign import Campaign, Swing
from ..judge.confirm import predict
from ..move.admissible import determined
from ..move.refit import FAILURES, refit
from ..state import Round


def conclusion(state: Round, campaign: Campaign) -> dict[str, Any]:
    """What a search says of its pendulum, as verdict.json has it: the one source of each value in sentence, table and JSON.

    A search holds swings, or parts of a recording, out of its fits; here nothing is, unless the model does not follow the whole: where
    the values of the whole add more to what the fitted swings leave than these leave with their own, the latter are reported. Natural
    frequency, period, quality and decay time are means over the structures that the data leave; each value of the model has its own
    uncertainty and what it is off in the others that have it. Effects that change with the time of the record (``left_out``) are in the
    fit and in no quantity: a pendulum has none of these once for all.

    Parameters
    ----------
    state
        The last round.
    campaign
        The swings that were searched.

    Returns
    -------
    dict
        ``model``, the last model's label; ``values`` (value, standard_error, unit) of all its parameters; ``amplitude_rad``, the largest
        angle of its motion, at which ``quantities`` (value, standard_uncertainty, unit) hold; ``residual``, the RMS that it leaves (rad,
        of a rate rad/s); ``covariance``, that of the ``parameters`` of its motion, in their units, with the residuals' colour and what the
        measurement leaves open; ``of_the_whole``, whether all these are of the whole recordings; ``whole_leaves``, what the model leaves
        of these (noise standard deviations), None where it cannot be fitted to them; ``narrows``, whether a recording's turning
        points say by themselves that it dies away, None where there are too few.

    Raises
    ------
    TrajectoryError
        If the motion of the last model cannot be followed.
    """
    whole = _of_the_whole(state.fit, state, campaign)
    follows = whole is not None and holds_throughout(whole.fit, state.fit, campaign)
    last = whole if whole is not None and follows else _Told(state.fit, campaign.fit)
    others = [
        (share, last if fit is state.fit else _other(fit, state, campaign, follows))
        for share, fit in state.counting
    ]
    means = over_models([(share, one.derived) for share, one in others if one is not None], UNITS)
    values = about(
        last.values(state), [(share, one.telling(state)) for share, one in others if one is not None]
    )
    told = last.derived | means | {name: values[name] for name in last.reported}
    return {
        "model": last.fit.model.label,
        "values": _as_plain(values, "standard_error"),
        "amplitude_rad": last.amplitude,
        "residual": last.fit.rms,
        "quantities": _as_plain(told, "standard_uncertainty"),
        "of_the_whole": follows,
        "narrows": _narrows(campaign),
        "whole_leaves": None if whole is None else whole.fit.rms / state.noise.deviation,
        "parameters": list(last.motion.parameters),
        "covariance": [[finite_or_none(cell) for cell in row] for row in last.covariance],
        "left_out": [name for name in last.fit.model.motion.names if name not in last.motion.names],
    }


def _as_plain(found: Mapping[str, Quantity], error: str) -> dict[str, dict[str, Any]]:
    """Each quantity as plain numbers, the uncertainty under the name ``error``; None for what is not known."""
    return {
        name: {"value": finite_or_none(one.value), error: finite_or_none(one.uncertainty), "unit": one.unit}
        for name, one in found.items()
    }


class _Told:
    """What a fitted model says of the pendulum."""

    def __init__(self, fit: Fit, swings: Sequence[Swing]) -> None:
        self.fit, self.pairs = fit, [swing.pair for swing in swings]
        self.motion = steady(fit.model.motion)
        known = uncertainty(fit, self.pairs, free=True)
        self.known = known.covariance
        self.covariance = _of(self.motion.parameters, fit, self.known)
        over = known.courses and known.courses.over(fit.free, self.motion.parameters)
        self.beside = over and Beside(*over)
        self.courses = known.courses

    @cached_property
    def amplitude(self) -> float:
        """The largest angle of the fitted motion, rad: what a sensor makes of it is another with each model."""
        return max(largest_angles(self.fit, self.pairs, self.courses))

    @cached_property
    def derived(self) -> dict[str, Quantity]:
        """Natural frequency, period, quality and decay time of the largest swing."""
        found = quantities(self.motion, self.amplitude, self.covariance, self.beside)
        return {name: found[name] for name in UNITS}

    def values(self, state: Round) -> dict[str, Quantity]:
        """All values of the model but those that the measurement leaves open, and that each swing has for itself.

        What the model may lack (``Round.widened``) is in their uncertainties as it was in the search's: more samples take none of it away.
        """
        model = self.fit.model
        errors = standard_errors(self.known)
        own = {name: errors[self.fit.free.index(name)] for name in self.fit.free}

        def error(name: str) -> float:
            here, wider = own.get(name, np.nan), state.widened.get(name, 1.0)
            searched = state.model.standard_errors.get(name, np.nan)
            if not np.isfinite(searched):  # a bound held it in the search's own part of the swings
                searched = here * wider
            lacks = searched * np.sqrt(1 - 1 / wider**2) if wider > 1 else 0.0
            return float(np.hypot(here, lacks))

        kept = [p for p in model.definitions if p.name not in model.slack.parameters and not p.each]
        return {p.name: Quantity(model.values[p.name], error(p.name), p.unit) for p in kept}

    def telling(self, state: Round) -> dict[str, Quantity]:
        """The values that say something of those of another model: none of an effect whose work another one does here as well, as a power of
        the speed does that of a viscous drag. How two share it is no value of either."""
        effects = self.fit.model.effects
        done = {inner.name for one in effects for inner in one.contains}
        shared = {p.name for one in effects if one.name in done for p in one.parameters}
        return {name: one for name, one in self.values(state).items() if name not in shared}

    @property
    def reported(self) -> list[str]:
        """The parameters that are quantities of the pendulum, or of the sensor of its drive."""
        effects = self.fit.model.effects
        names = [
            p.name for one in effects if one.name in self.motion.names for p in one.parameters if not p.each
        ]
        drive = [
            p.name for one in effects if one.takes_input for p in one.parameters if p.name in self.fit.free
        ]
        return [*names, *drive]


def _narrows(campaign: Campaign) -> bool | None:
    widths = [width for one in campaign.whole if np.isfinite(width := narrowing(one.angle))]
    return min(widths) < KEPT if widths else None


def _of_the_whole(fit: Fit, state: Round, campaign: Campaign) -> _Told | None:
    """What a model that a search looked at says, fitted once more to the whole of every recording; None where it cannot be."""
    begin = Begin(fit.model, _begins(fit, state, campaign))
    try:
        return _Told(refit(begin, campaign.whole, grown=False, ended=True), campaign.whole)
    except FAILURES:
        return None


def _other(fit: Fit, state: Round, campaign: Campaign, whole: bool) -> _Told | None:
    """What another model says, of the whole recordings or of the fitted swings; None where it cannot be followed, or they do not tell its
    values."""
    with suppress(*FAILURES):
        one = _of_the_whole(fit, state, campaign) if whole else _Told(fit, campaign.fit)
        if one is not None and determined(one.fit) and one.derived:
            return one
    return None


def holds_throughout(whole: Fit, fitted: Fit, campaign: Campaign) -> bool:
    """Whether a model holds from part to part: of the fitted swings its values of the whole add no more to what is left than was left
    anyway."""
    try:
        with_these = predict(whole, campaign.fit)
    except FAILURES:
        return False
    return bool(with_these.rss <= 2 * fitted.rss)


def concluded(states: Sequence[Round], campaign: Campaign) -> list[Round]:
    """The rounds of a search, the last with what its model says of the pendulum, where that can be computed.

    Parameters
    ----------
    states
        As ``discover`` returns them.
    campaign
        The swings that were searched.
    """
    try:
        found = conclusion(states[-1], campaign)
    except FAILURES:  # its values mean nothing, and what the search found stands without them
        found = None
    return [*states[:-1], replace(states[-1], concluded=found)]


def _begins(fit: Fit, state: Round, campaign: Campaign) -> tuple[SwingStart, ...]:
    """Where the fit of each whole swing begins: as that of its part that has its first sample did, held-out ones as in the last model."""
    parts = [
        *zip(campaign.fit, fit.swings, strict=True),
        *zip(campaign.holdout, state.holdout.swings, strict=True),
    ]
    found = []
    for swing in campaign.whole:
        one = next(
            one for part, one in parts if part.name.startswith(swing.name) and part.times[0] == swing.times[0]
        )
        own = {name: value for name, value in one.model.values.items() if name in fit.model.parameters}
        found.append(SwingStart({**fit.model.values, **own}, one.release_angle, one.release_velocity))
    return tuple(found)


def _of(names: tuple[str, ...], fit: Fit, known: np.ndarray) -> np.ndarray:
    """The covariance of these values; NaN for those that the fit held."""
    at = [fit.free.index(name) if name in fit.free else -1 for name in names]
    found = np.full((len(names), len(names)), np.nan)
    free = [k for k, place in enumerate(at) if place >= 0]
    found[np.ix_(free, free)] = known[np.ix_([at[k] for k in free], [at[k] for k in free])]
    return found
