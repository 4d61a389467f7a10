"""The noise that neighbouring samples alone tell: where a swing is sampled too coarsely to have a band without it."""

from collections.abc import Sequence
from math import comb

import numpy as np

from ..arrays import Floats
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
    steps = [float(np.median(np.diff(swing.times))) for swing in swings]
    if not all(_FEWEST < 1 / (step * frequency) < _MOST for step in steps):
        return noise
    pairs = zip(swings, steps, strict=True)
    differences = np.concatenate([_over_equal_steps(swing, step) for swing, step in pairs])
    if not differences.size:
        return noise
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


def _over_equal_steps(swing: Swing, step: float) -> Floats:
    """The differences of a swing where no sample is missing: over a hole the swing itself is in them."""
    spans = swing.times[_ORDER:] - swing.times[:-_ORDER]
    return np.diff(swing.angle, _ORDER)[spans < (_ORDER + 0.5) * step]
