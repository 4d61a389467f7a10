"""The noise of a recording, read from the recording itself where the pendulum has nothing to say."""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import minimize_scalar

from ...arrays import Floats
from ...errors import InputError

HARMONICS = 8  # of the pendulum: above, a swing leaves nothing
_LINE = 10.0  # times its neighbours' median: a line of the mains or of a bearing, and no noise
_NEIGHBOURS = 32
SPECTRUM = 64  # samples; a spectrum of fewer is too coarse for a band
_WINDOWS = 20_000  # that are looked at
FINEST = 1e-6  # of the swing: no sensor of a pendulum reads more finely
BAND = (15.0, 50.0)  # Hz; far above a pendulum's harmonics, below what mains and bearings bring


class Noise(NamedTuple):
    """White or first-order autocorrelated noise: standard deviation, correlation of neighbouring samples, and ``known``, the standard uncertainty of
    the logarithm of its spectrum (0: not told)."""

    deviation: float
    correlation: float
    known: float = 0.0


def noise_of(times: ArrayLike, signal: ArrayLike) -> Noise:
    """The ``Noise`` of a swing: white unless its spectrum above the pendulum's harmonics asks for colour.

    White noise is that of ``noise_level``; coloured noise first-order autocorrelated, as ``whittle`` gives it, lines above their
    neighbours cut down to them.

    Parameters
    ----------
    times, signal
        In s (evenly spaced) and any unit, which is the noise's too, both of shape (sample,).

    Raises
    ------
    InputError
        If there are fewer than 64 samples.
    """
    level = noise_level(times, signal)
    times, signal = np.asarray(times, dtype=float), np.asarray(signal, dtype=float)
    interval = (times[-1] - times[0]) / (len(times) - 1)
    frequency, power, gain = _spectrum(signal, interval)
    own = frequency[np.argmax(power / np.maximum(gain, gain[1]))]
    inside = (frequency > min(HARMONICS * own, 0.25 / interval)) & (frequency < 0.499 / interval)
    if np.count_nonzero(inside) < 2 * _NEIGHBOURS or not level > 0:
        return Noise(level, 0.0)
    power, gain = power[inside], gain[inside]
    size = power.size // _NEIGHBOURS * _NEIGHBOURS
    around = np.median((power / gain)[:size].reshape(-1, _NEIGHBOURS), axis=1).repeat(_NEIGHBOURS) / np.log(2)
    cosine = np.cos(2 * np.pi * frequency[inside][:size] * interval)
    # The window takes neighbouring frequencies together: so many of them are one.
    found = whittle(cosine, np.minimum((power / gain)[:size], _LINE * around), independent=0.5)
    return found if found.correlation else Noise(level, 0.0)


def whittle(cosine: Floats, power: Floats, independent: float = 1.0) -> Noise:
    """The first-order autocorrelated ``Noise`` whose spectrum is most likely for these powers (Whittle's likelihood); a correlation that BIC
    does not ask for is none.

    ``cosine`` of 2 pi frequency times sampling interval, ``power`` the periodogram there, of which the share ``independent`` counts.
    """
    effective = power.size * independent
    best = minimize_scalar(
        lambda one: whittle_cost(one, cosine, power)[0],
        bounds=(-0.9, 0.95),
        method="bounded",
        options={"xatol": 1e-4},
    ).x
    (white, level), (coloured, innovations) = (whittle_cost(one, cosine, power) for one in (0.0, best))
    if (white - coloured) * independent <= 0.5 * np.log(effective):
        return Noise(float(np.sqrt(level)), 0.0, 1 / np.sqrt(effective))
    return Noise(float(np.sqrt(innovations / (1 - best**2))), float(best), 1 / np.sqrt(effective))


def whittle_cost(correlation: float, cosine: Floats, power: Floats) -> tuple[float, float]:
    """-ln of the likelihood of a correlation but for a constant, and the variance of the innovations."""
    shape = 1 / (1 + correlation**2 - 2 * correlation * cosine)
    variance = np.mean((power + 1e-300 + 1e-12 * np.mean(power)) / shape)
    return float(np.sum(np.log(variance * shape)) + power.size), float(variance)


def noise_level(times: ArrayLike, signal: ArrayLike) -> float:
    """The standard deviation of the white noise, in the signal's unit, from the level of its spectrum in ``BAND``.

    Where sampling is too slow for the band, its upper end is the Nyquist frequency and its lower end at most 0.6 of that.

    The second difference takes the swing out before the window, so that it cannot leak into the band; the median over the band
    passes over single lines. Noise that is not white is taken for white noise of that level.

    Parameters
    ----------
    times, signal
        In s (evenly spaced) and any unit, both of shape (sample,).

    Raises
    ------
    InputError
        If there are fewer than 64 samples.
    """
    times, signal = np.asarray(times, dtype=float), np.asarray(signal, dtype=float)
    if len(signal) < SPECTRUM:
        mend = "record longer, or more samples a second"
        raise InputError("noise level", f"{len(signal)} samples", f"at least {SPECTRUM}", mend)
    interval = (times[-1] - times[0]) / (len(times) - 1)
    frequency, power, gain = _spectrum(signal, interval)
    high = min(BAND[1], 0.5 / interval)
    low = min(BAND[0], 0.6 * high)
    inside = (frequency >= low) & (frequency <= high) & (frequency < 0.5 / interval)
    return float(np.sqrt(np.median(power[inside] / gain[inside]) / np.log(2)))


def too_quiet(times: ArrayLike, signal: ArrayLike) -> bool:
    """True of an evenly spaced swing with less noise than any sensor has: it was computed, or smoothed. Too few samples tell nothing."""
    if len(np.asarray(signal)) < SPECTRUM:
        return False
    return noise_level(times, signal) < FINEST * float(np.ptp(signal)) / 2


def scatter(times: Floats, signal: Floats, window: int, order: int) -> Floats:
    """The variances that polynomials of an ``order`` leave in windows of so many neighbouring samples, each by its own times.

    ``times`` (s) need not be even; of more than ``_WINDOWS`` windows as many are looked at, evenly chosen.
    """
    count = len(times) // window
    chosen = np.linspace(0, count - 1, min(count, _WINDOWS)).astype(int)
    own, when = (np.asarray(one)[: count * window].reshape(count, window)[chosen] for one in (signal, times))
    when = when - when.mean(axis=1, keepdims=True)
    when = when / np.abs(when).max(axis=1, keepdims=True)
    basis = np.linalg.qr(when[..., None] ** np.arange(order + 1))[0]
    left = own - np.einsum("mij,mkj,mk->mi", basis, basis, own, optimize=True)
    return np.sum(left**2, axis=1) / (window - order - 1)


def noise_by_times(times: Floats, signal: Floats, period: float) -> float:
    """The standard deviation of the white noise of a swing whose samples keep no rate, in the unit of ``signal``.

    It is the usual scatter about quintics through less than half a ``period`` (s, nan for less than one) each; of fewer than nine samples
    there, quartics.
    """
    span = 0.45 * period if period == period else float(np.ptp(times))
    samples = int(span / max(float(np.median(np.diff(times))), 1e-12))
    window = min(max(samples, 7), 25, len(times))
    order = 5 if window > 8 else 4
    freedom = window - order - 1
    usual = (1 - 2 / (9 * freedom)) ** 3  # the median of chi-square over its mean (Wilson and Hilferty)
    return float(np.sqrt(np.median(scatter(times, signal, window, order)) / usual))


def _spectrum(signal: Floats, interval: float) -> tuple[Floats, Floats, Floats]:
    """Frequencies (Hz), the periodogram of the second difference, and what the difference did to the signal's own."""
    difference = np.diff(signal, 2)
    window = _blackman_harris(len(difference))
    frequency = np.fft.rfftfreq(len(difference), interval)
    gain = (2 * np.sin(np.pi * frequency * interval)) ** 4
    return frequency, np.abs(np.fft.rfft(window * difference)) ** 2 / np.sum(window**2), gain


def _blackman_harris(size: int) -> Floats:
    """The window of Harris, Proc. IEEE 66, 51 (1978), four terms (scipy.signal has it and takes a second to load)."""
    x = np.linspace(0, 2 * np.pi, size)
    return 0.35875 - 0.48829 * np.cos(x) + 0.14128 * np.cos(2 * x) - 0.01168 * np.cos(3 * x)
