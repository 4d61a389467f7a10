"""A recording on an even grid, for what needs equal steps: where samples are missing, what the swing beside them says."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...arrays import Bools, Floats, runs
from .clock import UNEVEN

FOLLOWED = 0.25  # of a period: across a longer hole no polynomial follows a swing
ODD = 0.05  # of the steps: more that are no whole number of intervals, and the samples keep no rate


@dataclass(frozen=True)
class Even:
    """A swing on an even grid: ``times`` (s), ``signal``, the ``place`` of each sample there, and which places no sample has.

    ``kept`` tells whether the samples keep a rate; of a recording without holes that does, all is as given.
    """

    times: Floats
    signal: Floats
    place: NDArray[np.integer] | slice
    missing: Bools
    kept: bool

    @property
    def interval(self) -> float:
        """The step of the grid, s."""
        return float((self.times[-1] - self.times[0]) / (self.times.size - 1))

    def holes(self) -> list[tuple[int, int]]:
        """The first place that is missing, and the one after the last, of each hole."""
        return runs(self.missing)

    def deep(self, period: float) -> list[tuple[float, float]]:
        """From when to when (s) a hole is too long for the swing across it to be known, for a ``period`` (s)."""
        found = [(float(self.times[a - 1]), float(self.times[b])) for a, b in self.holes()]
        return [(a, b) for a, b in found if b - a > FOLLOWED * period]


def evenly(times: Floats, signal: Floats) -> Even:
    """The ``Even`` view of a recording with rising ``times`` (s): the same arrays where nothing is missing and all steps are equal."""
    if times.size < 4:  # too few for a hole, or a cubic
        return Even(times, signal, slice(None), np.zeros(times.size, dtype=bool), True)
    steps = np.diff(times)
    usual = float(np.median(steps))
    relative = steps / usual
    away = np.abs(relative - np.round(relative))
    kept = bool(np.mean(away > UNEVEN) <= ODD)
    if kept and relative.max() < 1.5:
        return Even(times, signal, slice(None), np.zeros(times.size, dtype=bool), True)
    if kept:
        place = np.concatenate(([0], np.cumsum(np.maximum(1, np.round(relative)).astype(np.int64))))
        grid = np.interp(np.arange(place[-1] + 1), place, times)
    else:
        grid = np.linspace(times[0], times[-1], round((times[-1] - times[0]) / usual) + 1)
        place = np.searchsorted(grid, times).clip(0, grid.size - 1)
    missing = np.ones(grid.size, dtype=bool)
    missing[place] = False
    filled = _through(times, signal, grid)
    if kept:
        filled[place] = signal
    return Even(grid, filled, place, missing, kept)


def _through(times: Floats, signal: Floats, grid: Floats) -> Floats:
    """The signal at the times of a grid: a cubic through the four samples about each (Lagrange's), by divided differences."""
    at = np.clip(np.searchsorted(times, grid, side="right") - 2, 0, times.size - 4)
    points = at[:, None] + np.arange(4)
    x, y = times[points], signal[points]
    found = np.zeros(grid.size)
    for k in range(4):
        others = [n for n in range(4) if n != k]
        weight = np.prod([(grid - x[:, n]) / (x[:, k] - x[:, n]) for n in others], axis=0)
        found += weight * y[:, k]
    low, high = np.minimum(y[:, 1], y[:, 2]), np.maximum(y[:, 1], y[:, 2])
    room = high - low  # a cubic across a long hole runs away
    return np.clip(found, low - room, high + room)
