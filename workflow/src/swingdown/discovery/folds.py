"""Swings left out in turn: what a model makes of those that it was not fitted to, each once."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..arrays import Floats
from ..engine.trajectory import TrajectoryError
from ..fitting.least_squares import fit_jointly
from ..fitting.result import Begin, Fit
from .campaign import Campaign, Noise, Swing
from .confirm import predict
from .refit import refit

_MOST = 5  # folds; more swings are left out several at a time
_PLAIN = 1e-12  # rad; a residual that is smaller is none


@dataclass(frozen=True)
class Turns:
    """What a model left of each fold while that was left out: RMS (rad), and the values fitted to the others."""

    left: Floats
    values: tuple[dict[str, float], ...]

    @property
    def score(self) -> float:
        """The mean logarithm of what was left: a tenth less is a tenth smaller residuals of what was not fitted."""
        return float(np.mean(np.log(np.maximum(self.left, _PLAIN))))

    def gain(self, before: "Turns") -> float:
        """By how much the score is below that of another model."""
        return before.score - self.score

    def excess(self, noise: Noise) -> float:
        """The mean square (rad^2) that was left beyond the noise; not below 0."""
        return max(float(np.mean(self.left**2)) - noise.deviation**2, 0.0)

    def better(self, before: "Turns") -> float:
        """The share of folds of which less is left than by another model."""
        return float(np.mean(self.left < before.left))

    def spread(self, name: str) -> float:
        """The standard error of a value by the jackknife: fits without each fold in turn differ as misfits make them differ."""
        values = np.array([one[name] for one in self.values])
        count = values.size
        return float(np.sqrt((count - 1) / count * np.sum((values - values.mean()) ** 2)))


def folds(campaign: Campaign) -> list[list[int]]:
    """Which of a campaign's swings (fitted ones first, then held-out) are left out together: bands of amplitude, in turn."""
    swings = (*campaign.fit, *campaign.holdout)
    order = sorted(range(len(swings)), key=lambda k: swings[k].amplitude)
    count = min(_MOST, len(order))
    return [[int(k) for k in part] for part in np.array_split(order, count)]


def in_turn(fit: Fit, campaign: Campaign, held: Fit | None = None) -> Turns | None:
    """The ``Turns`` of a fit's model, refitted from its values to all swings but those of each fold.

    ``held`` is the fit's prediction of the held-out swings where it is known. None where some fold has no trajectory, or
    where there is nothing to leave out.
    """
    swings: Sequence[Swing] = (*campaign.fit, *campaign.holdout)
    if len(swings) < 2:
        return None
    left, values = [], []
    try:
        held = predict(fit, campaign.holdout) if held is None else held
        starts = (*fit.begin.swings, *held.begin.swings)
        for out in folds(campaign):
            kept = [k for k in range(len(swings)) if k not in out]
            begin = Begin(fit.model, tuple(starts[k] for k in kept))
            one = refit(begin, [swings[k] for k in kept], grown=False)
            model = one.model
            fixed = {name: value for name, value in model.values.items() if name not in model.each}
            begin = Begin(model, tuple(starts[k]._replace(values={**starts[k].values, **fixed}) for k in out))
            # from the releases that the whole campaign's fit gives: nothing else of these swings is fitted
            pairs = [swings[k].pair for k in out]
            own = fit_jointly(
                model, pairs, guess=begin, seen=False, bounded=True, own=model.each, fixed=fixed, grown=False
            )
            left.append(own.rms)
            values.append(dict(one.model.values))
    except TrajectoryError:
        return None
    return Turns(np.array(left), tuple(values))
