"""The colour of a series: its spectrum by an autoregressive model (Burg's recursion; the order by BIC), and lines beside it.

It is a flat spectrum for white noise, and a peak for a model that misses something.
"""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
from scipy.ndimage import uniform_filter1d
from scipy.optimize import minimize_scalar

from ..arrays import Floats

_HIGHEST = 12  # order of the autoregressive model
_FEWEST = 20  # means for each order
_MOST_LINES = 4  # the mains and its harmonics
_CHANCE = 1e-3  # of a line in white noise


class Colour(NamedTuple):
    """An autoregressive model of a series: x_k = sum of coefficients times the x before + noise of this variance (rad^2)."""

    coefficients: Floats
    variance: float

    def spectrum(self, size: int) -> Floats:
        """The variance (rad^2) of white noise as strong at each of ``size // 2 + 1`` frequencies up to half the rate."""
        return self.variance / np.abs(np.fft.rfft(np.append(1.0, -self.coefficients), size)) ** 2


class Line(NamedTuple):
    """A line in a series' spectrum: amplitude, the series of it, and a cosine and a sine of its frequency (2, samples)."""

    amplitude: float
    fitted: Floats
    waves: Floats


def lines_of(series: Floats, above: float, at: Floats | None = None) -> Iterator[Line]:
    """The lines of a series, strongest first: white noise has none as strong in a thousand series.

    Source: Fisher, Proc. R. Soc. A 125, 54 (1929).

    Parameters
    ----------
    series
        Of shape (sample,).
    above
        The frequency beyond which they are sought, in cycles a step.
    at
        The samples' times in steps. Default: a sample a step.
    """
    at = np.arange(series.size, dtype=float) if at is None else at
    slots = np.round(at).astype(np.int64)
    length = int(slots[-1]) + 1
    smooth = max(3, int(1 / above)) if length > series.size else 0
    for _ in range(_MOST_LINES):
        power = np.abs(np.fft.rfft(np.bincount(slots, _quick(series, smooth)))) ** 2
        first = max(2, int(np.ceil(above * length)))
        high = power[first:]
        if high.size < _FEWEST or not high.max() > np.log(high.size / _CHANCE) * np.median(high) / np.log(2):
            return
        line = _line_beside(series, at, (first + int(np.argmax(high))) / length, smooth)
        yield line
        series = series - line.fitted


def _quick(series: Floats, smooth: int) -> Floats:
    """What a series (…, samples) has beside means of so many samples; all of it for 0. A slow wave with samples missing has lines of its
    own, where the holes come evenly."""
    for _ in range(2 if smooth else 0):
        series = series - uniform_filter1d(series, smooth, axis=-1, mode="nearest")
    return series


def _line_beside(series: Floats, at: Floats, place: float, smooth: int) -> Line:
    """The ``Line`` that leaves least of a series, within a step of its spectrum beside a frequency (cycles a step)."""
    step = 1 / (at[-1] + 1)
    found = minimize_scalar(
        lambda frequency: -_wave(series, at, frequency, smooth).amplitude,
        bounds=(place - step, min(place + step, 0.5)),
        method="bounded",
        options={"xatol": 1e-4 * step},
    )
    return _wave(series, at, float(found.x), smooth)


def _wave(series: Floats, at: Floats, frequency: float, smooth: int) -> Line:
    """The ``Line`` of this frequency (cycles a step) that leaves least of what is quick in a series."""
    phase = 2 * np.pi * frequency * at
    waves = np.array([np.cos(phase), np.sin(phase)])
    quick = _quick(waves, smooth)
    # by the normal equations of two columns: their condition is near 1 but where one vanishes
    fitted = np.linalg.lstsq(quick @ quick.T, quick @ _quick(series, smooth), rcond=1e-15)[0] @ waves
    return Line(float(np.sqrt(2 * np.mean(fitted**2))), fitted, waves)


def weighted(slopes: Floats, colour: Colour) -> Floats:
    """J' R J for the slopes (free, means) and the autocovariance of a colour."""
    size = 2 * slopes.shape[1]
    spectrum = np.fft.rfft(slopes, size)
    weight = colour.spectrum(size) / size
    weight[1 : (size + 1) // 2] *= 2
    return np.real((spectrum * weight) @ spectrum.conj().T)


def autoregression(series: Sequence[Floats], highest: int = _HIGHEST) -> Colour:
    """The colour that several evenly spaced series share, nan where a value is missing: Burg's coefficients of the order that BIC prefers.

    Their means are not taken off: of a residual they are part of the error. An error of prediction counts where all that it is made of are
    there (de Waele and Broersen, IEEE Trans. Signal Process. 48, 2876 (2000)).
    """
    forward = [np.asarray(one, dtype=float) for one in series]
    backward = list(forward)
    n = sum(int(np.isfinite(one).sum()) for one in forward)
    whole = n == sum(one.size for one in forward)

    def shared(one: Floats, other: Floats) -> float:  # of places at which both are there
        return float(one @ other if whole else np.nansum(one * other))

    variance = sum(shared(one, one) for one in forward) / n
    coefficients = np.zeros(0)
    best = Colour(coefficients, variance)
    least = bic = n * np.log(variance) if variance > 0 else -np.inf
    for _ in range(min(highest, min(one.size for one in forward) // _FEWEST)):
        ahead, behind = [one[1:] for one in forward], [one[:-1] for one in backward]
        power = sum(
            shared(a, a) + shared(b, b) if whole else float(np.nansum(a * a + b * b))
            for a, b in zip(ahead, behind, strict=True)
        )
        if not (variance > 0 and power > 0):
            break
        reflection = 2 * sum(map(shared, ahead, behind)) / power
        left = 1 - reflection**2
        if not left > 0:  # to rounding all of it is foretold: no noise is there to be coloured
            break
        coefficients = np.append(coefficients - reflection * coefficients[::-1], reflection)
        forward = [a - reflection * b for a, b in zip(ahead, behind, strict=True)]
        backward = [b - reflection * a for a, b in zip(ahead, behind, strict=True)]
        variance *= left
        # the share of predictions that tell this reflection
        seen = 1.0 if whole else np.mean(np.isfinite(np.concatenate(forward)))
        bic += n * seen * np.log(left) + np.log(n)
        if bic < least:
            best, least = Colour(coefficients, variance), bic
    return best
