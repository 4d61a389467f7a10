"""The noise that neighbouring samples alone tell: where a swing is sampled too coarsely to have a band without it."""

from collections.abc import Sequence
from math import comb

import numpy as np

from .campaign import Noise, Swing

_ORDER = 6
_FEWEST, _MOST = (
    15.0,
    32.0,
)  # samples a period: of fewer the swing itself is in the differences, of more a band is free of it


def coarse_noise(noise: Noise, swings: Sequence[Swing], frequency: float) -> Noise:
    """The noise, or of swings that are sampled coarsely, white noise of the size that their sixth differences have.

    Below 32 samples a period what a wrong model leaves at the pendulum's harmonics reaches the highest frequency, and passes for
    strong coloured noise. ``frequency`` is the pendulum's in Hz. The noise is never more than it was measured to be.
    """
    rates = [(swing.times.size - 1) / (swing.times[-1] - swing.times[0]) / frequency for swing in swings]
    if not all(_FEWEST < rate < _MOST for rate in rates):
        return noise
    differences = np.concatenate([np.diff(swing.angle, _ORDER) for swing in swings])
    size = float(np.sqrt(np.mean(differences**2) / comb(2 * _ORDER, _ORDER)))
    return Noise(size) if 0 < size < noise.deviation else noise
