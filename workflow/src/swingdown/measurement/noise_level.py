"""The white noise of a recording, read from the recording itself where the pendulum has nothing to say."""

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Floats
from ..errors import InputError

BAND = (15.0, 50.0)  # Hz; far above a pendulum's harmonics, below what mains and bearings bring


def noise_level(times: ArrayLike, signal: ArrayLike, band: tuple[float, float] = BAND) -> float:
    """The standard deviation of the white noise, in the unit of ``signal``, from the level of its spectrum in
    a band.

    ``times`` (s) are evenly spaced. The second difference takes the swing out before the window, so that it
    cannot leak into the band; the median over the band passes over single lines. Where sampling is too slow
    for the band, its upper end is the Nyquist frequency and its lower end at most 0.6 of that. Noise that is
    not white is told as the white noise of that level. InputError for fewer than 64 samples.
    """
    times, signal = np.asarray(times, dtype=float), np.asarray(signal, dtype=float)
    if len(signal) < 64:
        raise InputError("noise level", f"{len(signal)} samples", "at least 64", "record for longer")
    interval = (times[-1] - times[0]) / (len(times) - 1)
    difference = np.diff(signal, 2)
    window = _blackman_harris(len(difference))
    frequency = np.fft.rfftfreq(len(difference), interval)
    gain = (2 * np.sin(np.pi * frequency * interval)) ** 4
    power = np.abs(np.fft.rfft(window * difference)) ** 2 / np.sum(window**2)
    high = min(band[1], 0.5 / interval)
    low = min(band[0], 0.6 * high)
    inside = (frequency >= low) & (frequency <= high) & (frequency < 0.5 / interval)
    return float(np.sqrt(np.median(power[inside] / gain[inside]) / np.log(2)))


def _blackman_harris(size: int) -> Floats:
    """The window of Harris, Proc. IEEE 66, 51 (1978), four terms (scipy.signal has it and takes a second to load)."""
    x = np.linspace(0, 2 * np.pi, size)
    return 0.35875 - 0.48829 * np.cos(x) + 0.14128 * np.cos(2 * x) - 0.01168 * np.cos(3 * x)


def quantisation_step(signal: Floats) -> float:
    """The step in which ``signal`` comes, in its unit; 0.0 if it does not come in steps."""
    values = np.unique(signal)
    if len(values) < 3 or len(values) > 0.5 * len(signal):
        return 0.0
    gaps = np.diff(values)
    gaps = gaps[gaps > 1e-9 * np.ptp(values)]  # the same level, printed or computed twice
    step = gaps.min()
    step = gaps[gaps < 1.5 * step].mean()
    many = gaps / step
    return float(step) if np.mean(np.abs(many - np.round(many)) < 0.15) > 0.99 else 0.0
