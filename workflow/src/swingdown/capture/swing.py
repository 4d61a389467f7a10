"""A swing as it goes on, in a few numbers: amplitude, period and, after ten of them, how much each swing loses."""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

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
    middle = (np.max(values) + np.min(values)) / 2
    away = values - middle
    hysteresis = max(_CLEAR / 2 * noise, 0.02 * np.max(np.abs(away)))
    if np.max(np.abs(away)) < max(_CLEAR * noise, 1e-12):
        return None
    crossings, below = [], False
    for k in range(1, len(away)):
        below = below or away[k] < -hysteresis
        if below and away[k] >= 0 > away[k - 1]:
            crossings.append(k)
            below = False
    if len(crossings) < 2:
        return None
    after = np.array(crossings)
    before = after - 1
    part = away[before] / (away[before] - away[after])
    at = times[before] + part * (times[after] - times[before])
    sizes = np.array([np.ptp(values[a:b]) / 2 for a, b in zip(after[:-1], after[1:], strict=True)])
    last = min(len(at) - 1, MANY)
    loss = None
    if len(sizes) > MANY:
        loss = float(1 - (sizes[-1] / sizes[-1 - MANY]) ** (1 / MANY))
    return Swing(float(sizes[-1]), float((at[-1] - at[-1 - last]) / last), len(sizes), loss)
