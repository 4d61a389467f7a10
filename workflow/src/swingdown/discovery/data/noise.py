"""The noise on a campaign's swings, from what a fit leaves where a pendulum has nothing to say, and from records at rest."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from math import comb

import numpy as np
from numpy.typing import NDArray
from scipy.special import log_ndtr

from ...arrays import Floats
from ...measurement.swings.even import evenly
from ...measurement.swings.noise_level import FINEST, HARMONICS, SPECTRUM, whittle_cost
from .campaign import Swing

_ORDER = 6  # of the differences of neighbouring samples
# samples a period: of fewer the swing itself is in the differences, of more a band is free of it
_FEWEST, _MOST = 15.0, 32.0
_MEMORIES = 300  # that are looked at: of correlations from -0.9 on, any level of slow noise as likely before
_FORGETS = 0.5  # periods in which noise has forgotten: what is slower is a drift, and no noise
_APART = 0.5  # of the logarithm of the slow spectrum: what is known no better is told apart
_COMPUTED = 1e-9  # rad, to which trajectories are
_HANN = 0.514  # of neighbouring powers under Hann's window: they are correlated by 0.444, those after next by 0.028


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
    cosine, power = _band(residuals, frequency, static)
    # what a kinked error leaves in the band looks like strong slow noise; the noise is not more than the whole residual
    squares = np.concatenate([np.square(residual) for _, residual in residuals])
    whole = float(np.sqrt(squares.sum() / max(squares.size - free, 1)))
    interval = np.median([np.median(np.diff(times)) for times, _ in residuals])
    most = float(np.exp(-frequency * interval / _FORGETS))
    found = _each_memory(cosine, power, whole, squares.size, most)
    known = float(np.sqrt(2 / squares.size))
    return sorted((at_most(noise, whole, known) for noise in found), key=lambda noise: -noise.likely)


def _band(
    residuals: Sequence[tuple[Floats, Floats]], frequency: float, static: Sequence[tuple[Floats, Floats]]
) -> tuple[Floats, Floats]:
    """(cosine of 2 pi frequency times sampling interval, power) above the pendulum's harmonics, and of records at rest everywhere."""
    cosines, powers = [], []
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
        cosines.append(np.cos(2 * np.pi * at[kept] * interval))
        powers.append(power[kept])
    return np.concatenate(cosines), np.concatenate(powers)


def _each_memory(cosine: Floats, power: Floats, whole: float, samples: int, most: float) -> list[Noise]:
    """The noise without a memory, and with each that is told apart, by the powers of a band.

    They tell little of a memory, and less of the spectrum below the band: of groups of correlations up to ``most``, all as probable, the
    means are told, of the logarithms of variance and slow spectrum. The noise is as likely to be all of a series of so many ``samples``, whose
    standard deviation is ``whole``, as any part of it.
    """
    rho = np.r_[0.0, np.tanh(np.linspace(np.arctanh(-0.9), np.arctanh(most), _MEMORIES))]
    own = 1 / np.sqrt(power.size * _HANN)
    costs, innovations = np.array([whittle_cost(one, cosine, power) for one in rho]).T
    variance, slow = np.log(innovations / (1 - rho**2)), np.log(innovations / (1 - rho) ** 2)
    above = np.log(whole**2) - variance
    known = np.hypot(own, np.sqrt(2 / samples * (1 + rho**2) / (1 - rho**2)))
    every = -0.5 * (above / known) ** 2 - np.log(np.sqrt(2 * np.pi) * known)
    part = log_ndtr(above / known) - np.log(max(float(above.max()), own))
    likely = np.logaddexp(every, part) - costs * _HANN
    likely[1:] -= np.log(_MEMORIES)
    found = []
    for these in (np.arange(1), *_told_apart(slow, likely)):
        together = float(np.logaddexp.reduce(likely[these]))
        weight = np.exp(likely[these] - together)
        size, level = float(weight @ variance[these]), float(weight @ slow[these])
        error = float(np.sqrt(weight @ (slow[these] - level) ** 2 + own**2))
        # the correlation of a spectrum that has these two levels; that the noise rises within the band does not say that it is next to none below
        memory = max(float(np.tanh(0.5 * (level - size))), 0.0)
        found.append(Noise(float(np.exp(0.5 * size)), memory, error, together))
    return found


def _told_apart(slow: Floats, likely: Floats) -> list[NDArray[np.intp]]:
    """The memories (the first of all is none) in groups of equal probability, as many as leave the slow spectrum known to ``_APART`` in each."""
    weight = np.exp(likely[1:] - np.logaddexp.reduce(likely[1:]))
    spread = float(np.sqrt(weight @ (slow[1:] - weight @ slow[1:]) ** 2))
    count = max(int(np.ceil(spread / _APART)), 1)
    group = np.minimum((np.cumsum(weight) - 0.5 * weight) * count, count - 1).astype(int)
    return [1 + np.flatnonzero(group == k) for k in np.unique(group)]


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


def not_too_fine(noise: Noise, swings: Sequence[Swing]) -> Noise:
    """The noise, or where it is finer than any sensor of these swings reads the least that may be: of computed swings what remains is
    arithmetic."""
    least = max(FINEST * max(swing.amplitude for swing in swings), _COMPUTED)
    return noise if noise.deviation >= least else replace(noise, deviation=least, correlation=0.0)


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
