"""A broken line through points: where it bends and where it jumps, with as many breaks as the points' scatter establishes."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy import optimize, stats

from ..arrays import Floats

ALPHA = 1e-3  # how often a straight line may be taken for a broken one
SHORTEST = 3  # points of a part: through two a line always goes
_BREAK = 3  # numbers that a break adds: its place, and the level and slope of another part


class Part(NamedTuple):
    """A straight part of the line, from point ``first`` to before point ``end``."""

    first: int
    end: int
    middle: float  # the time that the level holds at
    level: float
    slope: float
    spread: float  # sum of squares of the times about the middle

    def at(self, time):
        """The line's value."""
        return self.level + self.slope * (time - self.middle)

    def variance(self, time: float) -> float:
        """That of the line's value at a time, for points with a variance of 1."""
        return 1 / (self.end - self.first) + (time - self.middle) ** 2 / self.spread


class Breaks(NamedTuple):
    """Times at which a line bends or jumps, and the sizes of the jumps that are too small to be taken for any."""

    bends: tuple[float, ...] = ()
    jumps: tuple[float, ...] = ()
    small: tuple[float, ...] = ()


STRAIGHT = Breaks()


class BrokenLine:
    """The line of least squares through (times, values) that bends and jumps at ``breaks``; ``scatter`` is a point's deviation."""

    def __init__(self, times: Floats, values: Floats, scatter: float, breaks: Breaks = STRAIGHT):
        self.first, self.end = float(times[0]), float(times[-1])
        self.scatter, self.count, self.breaks = scatter, len(times), breaks
        design = self._design(times)
        self._terms = np.linalg.lstsq(design, values, rcond=None)[0]
        self._covariance = scatter**2 * np.linalg.pinv(design.T @ design)

    def _design(self, times, before=False):
        times = np.atleast_1d(np.asarray(times, float))
        columns = [np.ones_like(times), times - self.first]
        columns += [np.maximum(times - at, 0.0) for at in self.breaks.bends]
        columns += [(times > at if before else times >= at).astype(float) for at in self.breaks.jumps]
        return np.column_stack(columns)

    def at(self, times, before: bool = False) -> Floats:
        """The line's values; at a jump those after it, or ``before``."""
        return self._design(times, before) @ self._terms

    def jumped(self) -> tuple[float, ...]:
        """The sizes of the jumps."""
        return tuple(map(float, self._terms[2 + len(self.breaks.bends) :]))

    def slopes(self) -> list[tuple[float, float, float]]:
        """(from, until, slope) of each straight part."""
        slope, since, found = float(self._terms[1]), self.first, []
        for at, more in sorted(zip(self.breaks.bends, self._terms[2:], strict=False)):
            found.append((since, at, slope))
            since, slope = at, slope + float(more)
        return [*found, (since, self.end, slope)]

    def uncertainty(self, times, since: float) -> Floats:
        """The standard uncertainty of the line at ``times`` against the line at ``since``."""
        away = self._design(times) - self._design(since)
        return np.sqrt(np.maximum(np.sum(away @ self._covariance * away, axis=1), 0.0))


def sure(looks: float) -> float:
    """Standard deviations that none of so many looks at noise exceeds, but in one of 1/ALPHA series."""
    return float(stats.norm.isf(ALPHA / (2 * looks)))


def break_price(count: int) -> float:
    """By how much the sum of squares (over the scatter's) must fall for a break among ``count`` points."""
    return float(stats.chi2.isf(ALPHA / count**2, _BREAK))


def parts(times: Floats, values: Floats, scatter: float) -> list[Part]:
    """The straight parts of the line through (times, values), whose points have the standard deviation ``scatter``.

    Of all divisions it is the one with the least sum of squares over the scatter's, where a break costs as much as chance lowers
    that sum by in one of 1/ALPHA straight lines. Optimal partitioning: Jackson et al., IEEE Signal Process. Lett. 12, 105 (2005).
    """
    count = len(times)
    t, v = times - times.mean(), values - values.mean()
    sums = [np.concatenate(([0.0], np.cumsum(one))) for one in (np.ones(count), t, v, t * t, t * v, v * v)]
    price = break_price(count)
    best, came = np.full(count + 1, np.inf), np.zeros(count + 1, int)
    best[0] = 0.0
    for end in range(SHORTEST, count + 1):
        first = np.arange(0, end - SHORTEST + 1)
        total = best[first] + _left(*(one[end] - one[first] for one in sums)) / scatter**2 + price
        k = int(np.argmin(total))
        best[end], came[end] = total[k], k
    found, end = [], count
    while end > 0:
        found.append(part(times, values, int(came[end]), end))
        end = int(came[end])
    return found[::-1]


def part(times: Floats, values: Floats, first: int, end: int) -> Part:
    """The straight line of least squares through the points from ``first`` to before ``end``."""
    t, v = times[first:end], values[first:end]
    middle, level = float(t.mean()), float(v.mean())
    spread = float(np.sum((t - middle) ** 2))
    return Part(first, end, middle, level, float((t - middle) @ (v - level)) / spread, spread)


def breaks(found: Sequence[Part], times: Floats, scatter: float, least: float) -> Breaks:
    """What happens between the parts ``found``: a jump where the lines do not meet by more than ``least``, else a bend."""
    bends, jumps, small = [], [], []
    beyond = scatter * sure(len(times))
    for before, after in zip(found[:-1], found[1:], strict=True):
        at, gap = _meeting(before, after, times)
        u_gap = float(np.sqrt(before.variance(at) + after.variance(at)))
        u_slope = float(np.sqrt(1 / before.spread + 1 / after.spread))
        turned = abs(after.slope - before.slope)
        if abs(gap) > least + beyond * u_gap:
            jumps.append(at)
            if turned > beyond * u_slope:
                bends.append(at)
        elif abs(gap) / u_gap > turned / u_slope:
            small.append(gap)
        else:
            bends.append(at)
    return Breaks(tuple(bends), tuple(jumps), tuple(small))


def band(times: Floats, values: Floats) -> float:
    """The width of the narrowest band between two parallel lines that holds all points."""
    steepest = float(np.ptp(values) / np.min(np.diff(times)))
    narrowest = optimize.minimize_scalar(
        lambda slope: np.ptp(values - slope * times),
        bounds=(-steepest, steepest),
        method="bounded",
        options={"xatol": 1e-9},
    )
    return float(narrowest.fun)


def _meeting(before, after, times):
    """(time, gap) of where two lines meet near the points on either side of the break, or how far they pass each other by."""
    middle = (times[before.end - 1] + times[after.first]) / 2
    gap, turned = after.at(middle) - before.at(middle), after.slope - before.slope
    near = times[before.end - 2], times[after.first + 1]
    crossing = middle - gap / turned if turned else np.inf
    if near[0] <= crossing <= near[1]:
        return float(crossing), 0.0
    return float(middle), float(min((after.at(at) - before.at(at) for at in (*near, middle)), key=abs))


def _left(n, t, v, tt, tv, vv):
    """What a straight line leaves, from sums over the points."""
    spread = np.maximum(tt - t * t / n, 1e-300)
    return np.maximum(vv - v * v / n - (tv - t * v / n) ** 2 / spread, 0.0)
