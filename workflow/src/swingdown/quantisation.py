"""Readings that come in steps: how large a step is, and what the rounding adds to the errors of a slowly moving signal."""

import numpy as np

from .arrays import Floats

_LEAST = 1e-4  # of the step's square: waves of the rounding that are weaker than this are left out
_MOST = 30  # waves


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


def rounding(slopes: Floats, signal: Floats, step: float, noise: float) -> Floats:
    """What rounding ``signal`` to steps adds to the covariance of its products with ``slopes``, above white noise as strong.

    ``slopes`` (row, sample), ``signal`` and ``step`` in one unit, ``noise`` the standard deviation of the noise before the
    rounding, in that unit; (row, row), in the slopes' unit times its own, squared. No direction is left with less
    than half of what white noise of the rounding's own variance does. The mean error of rounding is a sum of
    waves sin(2 pi k signal / step) of amplitude step / (pi k) exp(-2 (pi k noise / step)^2), whose phase hangs on where the
    steps lie, which is unknown (Sripad and Snyder, IEEE Trans. ASSP 25, 442 (1977); Widrow and Kollar, Quantization Noise,
    2008): neighbouring samples of a slowly moving signal, and those of later swings at the same height, err alike.
    """
    whole = np.zeros((len(slopes), len(slopes)))
    alone = slopes @ slopes.T
    for k in range(1, _MOST + 1):
        variance = 0.5 * (step / (np.pi * k)) ** 2 * np.exp(-4 * (np.pi * k * noise / step) ** 2)
        if variance < _LEAST * step**2:
            break
        wave = slopes @ np.exp(2j * np.pi * k * signal / step)
        whole += variance * (np.real(np.outer(wave, wave.conj())) - alone)
    return _bounded(whole, alone * step**2 / 12)


def _bounded(whole: Floats, white: Floats) -> Floats:
    """``whole`` raised to minus half of ``white`` along the directions in which it lies below."""
    size = np.sqrt(np.diag(white))
    size = np.where(size > 0, size, 1.0)
    power, axes = np.linalg.eigh(white / np.outer(size, size))
    root = axes * np.sqrt(np.maximum(power, 1e-12))
    inverse = (axes / np.sqrt(np.maximum(power, 1e-12))).T
    share, directions = np.linalg.eigh(inverse @ (whole / np.outer(size, size)) @ inverse.T)
    turned = root @ directions
    return (turned * np.maximum(share, -0.5)) @ turned.T * np.outer(size, size)
