"""The noise that neighbouring samples alone tell: where a swing is sampled too coarsely to have a band without it."""

from collections.abc import Sequence
from math import comb

import numpy as np

from .campaign import Noise, Swing, at_most

_ORDER = 6
_FEWEST, _MOST = (
    15.0,
    32.0,
)  # samples a period: of fewer the swing itself is in the differences, of more a band is free of it


def coarse_noise(noise: Noise, swings: Sequence[Swing], frequency: float) -> Noise:
    """The noise, or of swings that are sampled coarsely, such noise of the size that their sixth differences have.

    Below 32 samples a period what a wrong model leaves at the pendulum's harmonics reaches the highest frequency, and passes for
    strong coloured noise. ``frequency`` is the pendulum's in Hz. The noise is not more than it was measured to be, but for what both are known to.
    """
    rates = [(swing.times.size - 1) / (swing.times[-1] - swing.times[0]) / frequency for swing in swings]
    if not all(_FEWEST < rate < _MOST for rate in rates):
        return noise
    differences = np.concatenate([np.diff(swing.angle, _ORDER) for swing in swings])
    # the correlation of differences so many apart; their squares have its square
    apart = np.array([comb(2 * _ORDER, _ORDER + k) for k in range(-_ORDER, _ORDER + 1)], dtype=float)
    signed = (-1.0) ** np.arange(-_ORDER, _ORDER + 1) * noise.correlation ** np.abs(
        np.arange(-_ORDER, _ORDER + 1)
    )
    size = float(np.sqrt(np.mean(differences**2) / (apart @ signed)))
    known = float(np.sqrt(2 * np.square(apart / apart[_ORDER]).sum() / differences.size))
    if at_most(noise, size, known) is noise:
        return noise
    return Noise(size, noise.correlation, float(np.hypot(known, noise.known)) if noise.correlation else known)
