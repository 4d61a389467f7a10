"""The noise on a campaign's swings, from what a fit leaves where a pendulum has nothing to say, and from records at rest."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from math import comb

import numpy as np

from ...arrays import Floats
from ...measurement.swings.even import evenly
from ...measurement.swings.noise_level import HANN, HARMONICS, SPECTRUM, either
from .campaign import Swing

_ORDER = 6  # of the differences of neighbouring samples
# samples a period: of fewer the swing itself is in the differences, of more a band is free of it
_FEWEST, _MOST = 15.0, 32.0


@dataclass(frozen=True)
class Noise:
    """White or first-order autocorrelated noise: standard deviation (rad), correlation of neighbouring samples, ``known``, the standard
    uncertainty of the logarithm of its variance at the pendulum's frequencies, and ``likely``, the logarithm of how likely it makes what a fit
    leaves where a pendulum has nothing to say."""

    deviation: float
    correlation: float = 0.0
    known: float = 0.0
    likely: float = field(default=0.0, compare=False)

    @property
    def inflation(self) -> float:
        """How much larger the noise's spectrum is at the pendulum's frequencies than that of white noise as strong."""
        return (1 + self.correlation) / (1 - self.correlation)

    @property
    def slow_variance(self) -> float:
        """The variance (rad^2) of white noise with the same spectrum at low frequency: what slow residuals count against."""
        return self.deviation**2 * self.inflation

    def effective(self, samples: float) -> float:
        """The number of independent samples that so many correlated ones are worth."""
        return samples / self.inflation


def measure_noise(
    residuals: Sequence[tuple[Floats, Floats]],
    frequency: float,
    static: Sequence[tuple[Floats, Floats]] = (),
    free: int = 0,
) -> list[Noise]:
    """What the ``Noise`` of a campaign may be, the most likely first: white, and with each memory that is told apart.

    Each is measured from the residuals of a fit and from static records. The spectrum of first-order autocorrelated noise is fitted
    (Whittle's likelihood) to the periodograms above eight times the pendulum's frequency, where a model's error leaves nothing; a static
    record counts in full. Each piece between holes that a swing is not followed across has a periodogram of its own: over a hole a slow
    error jumps, and a jump is in every band.

    Parameters
    ----------
    residuals
        Of each swing: (times in s, what a fit left in rad).
    frequency
        Of the pendulum, in Hz.
    static
        Records at rest: (times in s, angles in rad).
    free
        How many values the fit had.
    """
    shapes, powers = [], []
    pieces = [piece for times, residual in residuals for piece in _pieces(times, residual, 1 / frequency)]
    for times, residual, low in [
        *((*piece, HARMONICS * frequency) for piece in pieces),
        *((times, angle - angle.mean(), 0.0) for times, angle in static if np.ptp(angle) > 0),
    ]:
        interval = (times[-1] - times[0]) / (times.size - 1)
        window = np.hanning(residual.size)
        power = np.abs(np.fft.rfft(window * residual)) ** 2 / np.sum(window**2)
        at = np.fft.rfftfreq(residual.size, interval)
        kept = (at > min(low, 0.25 / interval)) & (at < 0.499 / interval)
        shapes.append(np.cos(2 * np.pi * at[kept] * interval))
        powers.append(power[kept])
    cosine, power = np.concatenate(shapes), np.concatenate(powers)
    # what a kinked error leaves in the band looks like strong slow noise; the noise is not more than the whole residual
    squares = np.concatenate([np.square(residual) for _, residual in residuals])
    whole = float(np.sqrt(squares.sum() / max(squares.size - free, 1)))
    # what is not forgotten within a half-swing is a drift, and no noise
    most = float(np.exp(-2 * frequency * np.median([np.median(np.diff(times)) for times, _ in residuals])))
    found = [
        # that the noise rises within the band does not say that it is next to none below
        at_most(
            Noise(one.deviation, max(one.correlation, 0.0), one.known, likely),
            whole,
            float(np.sqrt(2 / squares.size)),
        )
        for likely, one in either(cosine, power, HANN, whole, squares.size, most)
    ]
    return sorted(found, key=lambda noise: -noise.likely)


def _pieces(times: Floats, residual: Floats, period: float) -> list[tuple[Floats, Floats]]:
    """(times, residual) between holes that are too long for a swing of a ``period`` (s) to be followed across: those that are long enough
    for a spectrum, or the longest."""
    ends = np.searchsorted(times, [end for _, end in evenly(times, residual).deep(period)])
    pieces = list(zip(np.split(times, ends), np.split(residual, ends), strict=True))
    return [piece for piece in pieces if piece[0].size >= SPECTRUM] or [
        max(pieces, key=lambda piece: piece[0].size)
    ]


def at_most(noise: Noise, deviation: float, known: float) -> Noise:
    """The noise, or what is told of it otherwise where that is less by more than both are known to: of two estimates that chance alone
    tells apart the smaller is no better. ``known`` is the standard uncertainty of the logarithm of the other variance."""
    apart = 2 * np.log(noise.deviation / deviation) if noise.deviation > 0 < deviation else 0.0
    return replace(noise, deviation=deviation) if apart > 2 * np.hypot(noise.known, known) else noise


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
    known = float(np.hypot(known, noise.known)) if noise.correlation else known
    return replace(noise, deviation=size, known=known)


def _over_equal_steps(swing: Swing, step: float) -> Floats:
    """The differences of a swing where no sample is missing: over a hole the swing itself is in them."""
    spans = swing.times[_ORDER:] - swing.times[:-_ORDER]
    return np.diff(swing.angle, _ORDER)[spans < (_ORDER + 0.5) * step]
