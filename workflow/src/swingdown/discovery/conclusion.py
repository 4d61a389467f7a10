"""The model that a search ends with, fitted once more to the whole of every recording: its quantities, with their covariance."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from ..fitting.colour import uncertainty
from ..fitting.result import Begin, Fit, SwingStart
from ..pendulum.free_form import FreeForm
from ..studies.experiment import largest_angles
from ..studies.quantities import quantities, steady
from .campaign import Campaign
from .refit import FAILURES, refit
from .state import Round


def conclusion(state: Round, campaign: Campaign) -> dict[str, Any] | None:
    """What the last model of a search says of its pendulum, as verdict.json has it; TrajectoryError where it cannot be fitted to the whole.

    ``model`` its label; ``amplitude_rad`` the largest fitted angle, at which ``quantities`` (value, standard_uncertainty, unit)
    hold; ``residual`` (rad, of a rate rad/s) the RMS that it leaves; ``covariance`` that of the ``parameters`` of its motion, in
    their units, with the residuals' colour and what the measurement leaves open. A search holds swings, or parts of a recording,
    out of its fits; here nothing is. Effects that change with the time of the record (``left_out``) are in the fit and in no
    quantity: a pendulum has none of these once for all.
    """
    whole = campaign.whole
    fit = refit(Begin(state.fit.model, _begins(state, campaign)), whole, grown=False, ended=True)
    pairs = [swing.pair for swing in whole]
    known = uncertainty(fit, pairs).covariance
    motion = steady(fit.model.motion)
    amplitude = max(largest_angles(fit, pairs))
    covariance = _of(motion.parameters, fit, known)
    named = {
        p.name
        for effect in motion.effects
        if not isinstance(effect, FreeForm)
        for p in effect.parameters
        if not p.each
    }
    found = quantities(motion, amplitude, covariance)
    return {
        "model": fit.model.label,
        "amplitude_rad": amplitude,
        "residual": fit.rms,
        "quantities": {
            name: {
                "value": _finite(one.value),
                "standard_uncertainty": _finite(one.uncertainty),
                "unit": one.unit,
            }
            for name, one in found.items()
            if name not in motion.parameters[1:] or name in named
        },
        "parameters": list(motion.parameters),
        "covariance": [[_finite(cell) for cell in row] for row in covariance],
        "left_out": [name for name in fit.model.motion.names if name not in motion.names],
    }


def concluded(states: Sequence[Round], campaign: Campaign) -> list[Round]:
    """The rounds of a search, the last with what its model says of the pendulum, where that can be computed."""
    try:
        found = conclusion(states[-1], campaign)
    except FAILURES:  # its values mean nothing, and what the search found stands without them
        found = None
    return [*states[:-1], replace(states[-1], concluded=found)]


def _begins(state: Round, campaign: Campaign) -> tuple[SwingStart, ...]:
    """Where the fit of each whole swing begins: as the fit of its part that has its first sample did."""
    parts = [
        *zip(campaign.fit, state.fit.swings, strict=True),
        *zip(campaign.holdout, state.holdout.swings, strict=True),
    ]
    found = []
    for swing in campaign.whole:
        one = next(
            one for part, one in parts if part.name.startswith(swing.name) and part.times[0] == swing.times[0]
        )
        found.append(
            SwingStart(
                {**state.fit.model.values, **one.model.values}, one.release_angle, one.release_velocity
            )
        )
    return tuple(found)


def _of(names: tuple[str, ...], fit: Fit, known: np.ndarray) -> np.ndarray:
    """The covariance of these values; NaN for those that the fit held."""
    at = [fit.free.index(name) if name in fit.free else -1 for name in names]
    found = np.full((len(names), len(names)), np.nan)
    free = [k for k, place in enumerate(at) if place >= 0]
    found[np.ix_(free, free)] = known[np.ix_([at[k] for k in free], [at[k] for k in free])]
    return found


def _finite(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None
