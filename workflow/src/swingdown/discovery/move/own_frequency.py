"""Recordings that differ in natural frequency: a pendulum taken down between them, its bob screwed on again, another day's warmth.

No effect of the catalogue is the same for all recordings and does that. Each is given a frequency of its own where the data ask for
it more than for any effect, and the verdict says so.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ...engine.trajectory import TrajectoryError
from ...fitting.result import Begin, Fit
from ...pendulum.effect import NATURAL_FREQUENCY
from ..data.campaign import Campaign
from ..data.noise import Noise
from ..see.linear import Frame, explained
from .evidence import TIE, Candidate, evidence
from .refit import refit

_SUBSTANTIAL = 1 / 3  # of what is left beyond the noise, that own frequencies must explain to first order
_FEWEST = 3  # recordings; two frequencies are an effect of the amplitude as well


def with_own_frequencies(
    here: Frame, noise: Noise, campaign: Campaign, ranked: Sequence[Candidate]
) -> Fit | None:
    """The ``Fit`` with a natural frequency for each recording, where the evidence prefers it to every admissible candidate; else None.

    Parts of one recording have one frequency.
    """
    fit = here.fit
    if fit.model.own_frequency or min(len(campaign.whole), len(here.swings)) < _FEWEST:
        return None
    columns = here.apart(here.slopes[:, here.names.index(NATURAL_FREQUENCY.name)])
    excess = fit.rss - fit.n * noise.deviation**2
    if explained(here, columns)[0] < _SUBSTANTIAL * excess:
        return None
    try:
        begin = Begin(replace(fit.model, own_frequency=True), fit.begin.swings)
        own = refit(begin, here.swings, grown=False, ended=True)
    except TrajectoryError:
        return None
    best = min((one.bic for one in ranked if not one.refused), default=np.inf)
    return own if evidence(own, noise) < min(best, evidence(fit, noise)) - TIE else None


def frequencies(fit: Fit, held_out: Fit, campaign: Campaign) -> dict[str, float]:
    """The natural frequency (rad/s) of each recording, fitted and held out, by name; empty where they share one."""
    if not fit.model.own_frequency:
        return {}
    swings = [*campaign.fit, *campaign.holdout]
    models = [one.model for one in (*fit.swings, *held_out.swings)]
    return {
        swing.name: float(model.values[NATURAL_FREQUENCY.name])
        for swing, model in zip(swings, models, strict=True)
    }
