"""What a half-swing of a recording is: from one crossing of its middle to the next, with a turning point between them."""

from typing import NamedTuple

import numpy as np

from ...arrays import Floats

DEAD_ZONE = 0.05  # of the range: crossings of the middle by noise alone do not count


class Swings(NamedTuple):
    """The half-swings of a recording: where each begins (index), and the signal at its turning point."""

    starts: np.ndarray
    turns: Floats

    def period(self, times: Floats) -> float:
        """The usual period (s), or nan for fewer than three crossings of the middle."""
        return 2 * float(np.median(np.diff(times[self.starts]))) if len(self.starts) > 2 else float("nan")

    def centre(self) -> float:
        """The middle that the swings have, or nan for fewer than four half-swings."""
        centres = self.centres()
        return float(np.median(centres)) if len(centres) else float("nan")

    def centres(self) -> Floats:
        """The middle at each turning point, from it and its neighbours; of fewer than five half-swings none. The first one may be cut, the last too."""
        return middles(self.turns[1:-1])


def middles(turns: Floats) -> Floats:
    """The middle of each three turning points in a row, which decay leaves alone; of fewer than three none."""
    return (turns[:-2] + 2 * turns[1:-1] + turns[2:]) / 4 if len(turns) > 2 else np.empty(0)


def half_swings(signal: Floats, middle: float | None = None) -> Swings:
    """The ``Swings`` of a signal: from one passage of its middle to the next.

    Parameters
    ----------
    signal
        In any unit, of shape (sample,).
    middle
        What it swings about; None: the median of the later half, for the first may be held. A dead zone of a twentieth of the range
        about it keeps noise from counting as passages.
    """
    away = signal - (np.median(signal[len(signal) // 2 :]) if middle is None else middle)
    low, high = np.percentile(signal, (0.5, 99.5))  # a spike is no swing
    zone = DEAD_ZONE * float(high - low)
    outside = np.flatnonzero((away > zone) | (away < -zone))
    side = (away > 0)[outside]
    starts = outside[np.concatenate(([True], side[1:] != side[:-1]))] if len(outside) else outside
    if not len(starts):
        return Swings(starts, np.empty(0))
    top, bottom = np.maximum.reduceat(signal, starts), np.minimum.reduceat(signal, starts)
    return Swings(starts, np.where(away[starts] > 0, top, bottom))


def passages(times: Floats, signal: Floats, middle: float) -> Floats:
    """When (s) the signal passes its ``middle``, between the samples on its two sides; one time for each half-swing after the first."""
    swings = half_swings(signal, middle)
    away = signal - middle
    found = []
    for before, now in zip(swings.starts, swings.starts[1:], strict=False):
        other = before + np.flatnonzero(away[before : now + 1] * np.sign(away[now]) < 0)
        if len(other):
            k = int(other[-1])
            found.append(times[k] + (times[k + 1] - times[k]) * away[k] / (away[k] - away[k + 1]))
    return np.array(found)
