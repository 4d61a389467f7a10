"""A swing as it goes on, in a few numbers: amplitude, period and, after ten of them, how much each swing loses."""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from ..pendulum.half_swings import middle_crossings

MANY = 10  # swings that the loss is told over
_CLEAR = 6  # standard deviations of the noise that a swing's amplitude must have to be one


class Swing(NamedTuple):
    """The last whole swing, to and fro."""

    amplitude: float  # half of highest less lowest, in the signal's unit
    period: float  # s, mean of the last swings, ten at most
    swings: int  # whole ones so far
    loss: float | None  # part of the amplitude that a swing loses, over the last ten; None before


def measure(times: npt.ArrayLike, values: npt.ArrayLike, noise: float = 0.0) -> Swing | None:
    """The amplitude and period of a swing, or None where nothing swings clearly above the noise.

    Parameters
    ----------
    times, values
        In s and the signal's unit, both of shape (sample,).
    noise
        Standard deviation, in the signal's unit.
    """
    times, values = np.asarray(times, float), np.asarray(values, float)
    if len(values) < 8:
        return None
    away = values - (np.max(values) + np.min(values)) / 2
    if np.max(np.abs(away)) < max(_CLEAR * noise, 1e-12):
        return None
    crossings, extremes = middle_crossings(times, away)
    count = (len(crossings) - 1) // 2
    if count < 1:
        return None
    at, halves = crossings[::-2][::-1], extremes[len(extremes) - 2 * count :].reshape(count, 2)
    sizes, last = halves.mean(axis=1), min(count, MANY)
    loss = float(1 - (sizes[-1] / sizes[-1 - MANY]) ** (1 / MANY)) if count > MANY else None
    return Swing(float(sizes[-1]), float((at[-1] - at[-1 - last]) / last), count, loss)
