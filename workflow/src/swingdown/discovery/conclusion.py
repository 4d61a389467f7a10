"""The model that a search ends with, fitted once more to the whole of every recording: its quantities, with their covariance."""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np

from ..arrays import finite_or_none
from ..engine.trajectory import simulate
from ..fitting.result import Begin, Fit, SwingStart
from ..fitting.uncertainty import uncertainty
from ..pendulum.free_form import FreeForm
from ..studies.quantities import UNITS, Beside, Quantity, over_models, quantities, steady
from .campaign import Campaign
from .refit import FAILURES, refit
from .state import Round


def conclusion(state: Round, campaign: Campaign) -> dict[str, Any] | None:
    """What a search says of its pendulum, as verdict.json has it.

    A search holds swings, or parts of a recording, out of its fits; here nothing is. Natural frequency, period, quality and decay time are
    means over the structures that the data leave. Effects that change with the time of the record (``left_out``) are in the fit and in no
    quantity: a pendulum has none of these once for all.

    Parameters
    ----------
    state
        The last round.
    campaign
        The swings that were searched.

    Returns
    -------
    dict
        ``model``, the last model's label; ``amplitude_rad``, the largest angle of its motion, at which ``quantities`` (value,
        standard_uncertainty, unit) hold; ``residual``, the RMS that it leaves (rad, of a rate rad/s); ``covariance``, that of the ``parameters``
        of its motion, in their units, with the residuals' colour and what the measurement leaves open.

    Raises
    ------
    TrajectoryError
        If the last model cannot be fitted to the whole.
    """
    last = _Told(state.fit, state, campaign)
    found = last.quantities()
    each = [
        (share, found if fit is state.fit else _said(fit, state, campaign)) for share, fit in state.counting
    ]
    named = {
        p.name
        for effect in last.motion.effects
        if not isinstance(effect, FreeForm)
        for p in effect.parameters
        if not p.each
    }
    found = found | over_models(each, UNITS) | last.of_the_drive()
    return {
        "model": last.fit.model.label,
        "amplitude_rad": last.amplitude,
        "residual": last.fit.rms,
        "quantities": {
            name: {
                "value": finite_or_none(one.value),
                "standard_uncertainty": finite_or_none(one.uncertainty),
                "unit": one.unit,
            }
            for name, one in found.items()
            if name not in last.motion.parameters[1:] or name in named
        },
        "parameters": list(last.motion.parameters),
        "covariance": [[finite_or_none(cell) for cell in row] for row in last.covariance],
        "left_out": [name for name in last.fit.model.motion.names if name not in last.motion.names],
    }


class _Told:
    """What a model that a search looked at says of the pendulum, fitted once more to the whole of every recording."""

    def __init__(self, fit: Fit, state: Round, campaign: Campaign) -> None:
        whole = campaign.whole
        self.pairs = [swing.pair for swing in whole]
        self.fit = refit(Begin(fit.model, _begins(fit, state, campaign)), whole, grown=False, ended=True)
        self.motion = steady(self.fit.model.motion)
        known = uncertainty(self.fit, self.pairs, free=True)
        self.known = known.covariance
        self.covariance = _of(self.motion.parameters, self.fit, self.known)
        over = known.courses and known.courses.over(self.fit.free, self.motion.parameters)
        self.beside = over and Beside(*over)
        self.begins = known.courses.begins if known.courses else [0.0] * len(self.pairs)

    @cached_property
    def amplitude(self) -> float:
        """The largest angle of the fitted motion, rad: what a sensor makes of it is another with each model."""
        swings = zip(self.pairs, self.fit.swings, self.begins, strict=True)
        return max(
            float(np.abs(simulate(one.model.motion, times, one.release_angle, one.release_velocity)).max() * np.exp(more))
            for (times, _), one, more in swings
        )  # fmt: skip

    def quantities(self) -> dict[str, Quantity]:
        """The quantities by name, of the largest swing."""
        return quantities(self.motion, self.amplitude, self.covariance, self.beside)

    def of_the_drive(self) -> dict[str, Quantity]:
        """What was fitted of the sensor of a measured drive: gain and delay. They are no part of the pendulum by itself."""
        model = self.fit.model
        driven = [p for effect in model.effects if effect.takes_input for p in effect.parameters]
        errors = np.sqrt(np.diag(_of(tuple(p.name for p in driven), self.fit, self.known)))
        return {
            p.name: Quantity(model.values[p.name], float(error), p.unit)
            for p, error in zip(driven, errors, strict=True)
            if p.name in self.fit.free
        }


def _said(fit: Fit, state: Round, campaign: Campaign) -> dict[str, Quantity]:
    """The quantities of a model; none where it cannot be fitted to the whole."""
    with suppress(*FAILURES):
        return _Told(fit, state, campaign).quantities()
    return {}


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
