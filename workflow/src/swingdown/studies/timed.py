"""What a stop-watch would show: the mean period of the first swings of a recording, and of its last."""

from typing import NamedTuple

import numpy as np

from ..arrays import Floats
from ..measurement.half_swings import half_swings
from .unscaled import HIDES, counted_passages, of_first_swings

SWINGS = 10  # that are timed; of a shorter recording all
_FEWEST = 2


class Timed(NamedTuple):
    """The mean period (s) of so many swings, and the amplitude in their middle, in the unit of the curve."""

    swings: int
    period: float
    amplitude: float


def timed(times: Floats, curve: Floats, period: float, most: int = SWINGS) -> tuple[Timed, Timed] | None:
    """The first and the last swings of a recording, each timed together as with a stop-watch; None where fewer than two whole ones are seen.

    Parameters
    ----------
    times
        In s, of shape (sample,).
    curve
        The fitted swing, or the swing itself where no model follows it, of shape (sample,). It tells how its period changes from swing to
        swing. Passages that a hole hides are counted by the time between the others.
    period
        That of the first whole swing (s), as it is reported; all others follow from it.
    most
        Swings that are timed together.
    """
    swings = half_swings(curve)
    centre = swings.centre()
    passed, halves = counted_passages(times, curve, HIDES)
    first = of_first_swings(times, curve)["period_first"]
    if passed.size < 2 * _FEWEST + 1 or not np.isfinite(first):
        return None
    away = np.abs(swings.turns[1:-1] - centre)
    count = int(min(most, halves[-1] // 2))

    def of(begin: int, end: int) -> Timed:
        mean = 2 * (passed[end] - passed[begin]) / (halves[end] - halves[begin])
        return Timed(count, float(period * mean / first), float(np.median(away[begin:end])))

    end = int(np.searchsorted(halves, 2 * count))
    begin = int(np.searchsorted(halves, halves[-1] - 2 * count, side="right")) - 1
    return of(0, end), of(begin, passed.size - 1)
