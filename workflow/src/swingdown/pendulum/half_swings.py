"""Half-swings: where a swing passes its middle and where it turns, and how long and how far the ideal pendulum swings, without friction.

A half-swing goes from one crossing of the middle to the next, with a turning point between them.
"""

from math import cos, sqrt
from typing import NamedTuple

import numpy as np
from scipy.special import ellipk

from ..arrays import Floats

LARGEST = 3.0  # rad; above it a swing takes as long as one likes
DEAD_ZONE = 0.05  # of the range: crossings of the middle by noise alone do not count
_SKIPPED = 1.6  # of the usual half-swing: what takes longer is more than one


def lengthening(amplitude: Floats | float) -> Floats:
    """The period of an undamped pendulum at an amplitude over that of small swings: 2 K(sin²(amplitude / 2)) / pi.

    Source: any text on the elliptic integral, as DLMF 22.19.

    Parameters
    ----------
    amplitude
        In rad, of any shape, which the result has too; more than 3 rad counts as 3 rad.
    """
    return ellipk(np.sin(np.minimum(np.abs(amplitude), LARGEST) / 2) ** 2) * 2 / np.pi


def reached(speed: Floats | float, restoring: str = "sine") -> Floats:
    """The angle (rad, with the sign of the speed) at which a pendulum turns that is so fast where it hangs; of one that goes over, pi.

    Parameters
    ----------
    speed
        In natural frequencies, of any shape, which the result has too.
    restoring
        ``sine`` or ``linear``.
    """
    if restoring == "linear":
        return np.asarray(speed, dtype=float)
    return 2 * np.arcsin(np.clip(np.asarray(speed, dtype=float) / 2, -1.0, 1.0))


def quickening(amplitude: float) -> float:
    """One over ``lengthening`` at one amplitude (rad), to the same digits in a part of the time: agm(1, cos(amplitude / 2))."""
    mean, root = 1.0, max(cos(min(abs(amplitude), 3.1) / 2), 1e-3)
    for _ in range(6):
        mean, root = (mean + root) / 2, sqrt(mean * root)
    return mean


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


def middle_crossings(times: Floats, angle: Floats) -> tuple[Floats, Floats]:
    """When (s) a swing crosses its middle, and the extremes (rad) between each two crossings; a tenth of the spread is hysteresis against noise."""
    band = 0.1 * np.sqrt(angle @ angle / angle.size)
    above = angle > band
    marks = (above | (angle < -band)).nonzero()[0]
    sides = above[marks]
    turns = (sides[1:] != sides[:-1]).nonzero()[0]
    first, last = marks[turns], marks[turns + 1]
    if first.size == 0:
        return np.array([]), np.array([])
    # the straight line through the samples from one side to the other, of all crossings at once
    size = last - first + 1
    begins, begun = size.cumsum() - size, times[first]
    inside = np.arange(begins[-1] + size[-1]) + (first - begins).repeat(size)
    after, part = times[inside] - begun.repeat(size), angle[inside]
    mean_after, mean = np.add.reduceat(after, begins) / size, np.add.reduceat(part, begins) / size
    centred = after - mean_after.repeat(size)
    rise, spread = np.add.reduceat(centred * part, begins), np.add.reduceat(centred * centred, begins)
    flat = rise == 0
    middle = np.where(flat, 0.0, mean_after - mean / np.where(flat, 1.0, rise / spread))
    crossings = begun + np.minimum(np.maximum(middle, 0.0), times[last] - begun)
    bounds = times.searchsorted(crossings)
    extremes = np.maximum.reduceat(np.abs(angle), bounds)[:-1]
    extremes[bounds[1:] == bounds[:-1]] = 0.0
    return crossings, extremes


def steps_between(half: Floats) -> Floats:
    """How many half-swings lie between passages ``half`` (s) apart: 1, but where some are missing."""
    usual = np.array([np.median(half[max(0, k - 3) : k + 4]) for k in range(half.size)])
    return np.where(half > _SKIPPED * usual, np.round(half / usual), 1.0)
