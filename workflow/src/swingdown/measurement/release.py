"""When the hand let go: beginnings in which a pendulum is held or still being lifted are told from those that swing."""

from typing import NamedTuple

import numpy as np

from ..arrays import Floats
from .noise_level import noise_level
from .plausibility import half_swings

HALF = 0.5  # of a turning point: the level at which the width of a top is measured
LONG = 1.5  # times the width of the next top; a free first top is wider only by what its amplitude adds
LOW = 0.9  # of the next top: no hand holds a pendulum lower than it swings afterwards
UNEVEN = 0.03  # of the amplitude, beyond what later tops are uneven by


class Release(NamedTuple):
    """When the pendulum was let go (s), about, and from when on it surely swings by itself (s): past the middle."""

    released: float
    free: float


def find_release(times: Floats, signal: Floats) -> Release | None:
    """The Release of a recording that begins in a hand; None for one that swings from its first sample on.

    Free motion about a turning point is nearly the same forwards and backwards in time, and its tops are about
    equally wide. A lift is uneven about its highest point, in comparison with the tops that follow; a bob that is held makes
    the first top wide. A lift that moves as a free swing would (rel45 and rel135 of the rotary link that the tests read nearly
    do) is not seen. A recording with fewer than five half-swings says too little, and gives None.
    """
    swings = half_swings(signal)
    if len(swings.starts) < 5 or len(signal) < 64:
        return None
    away = signal - swings.centre()
    bounds = [0, *map(int, swings.starts[1:5])]
    tops = [np.abs(away[a:b]) for a, b in zip(bounds, bounds[1:], strict=False)]
    highest = [int(np.argmax(top)) for top in tops]
    widths = [_width(top) for top in tops]
    noise = noise_level(times, signal)
    free = float(times[bounds[1]])
    if tops[0].max() < LOW * tops[1].max() or len(signal) - bounds[1] < 64:
        return None  # it begins close to the middle, or little is left
    if widths[0] > LONG * max(widths[1:3]):
        held = int(np.flatnonzero(tops[0] >= 0.98 * np.median(tops[0][tops[0] >= 0.9 * tops[0].max()]))[-1])
        return Release(float(times[held]), free)
    reach, slack = highest[0], max(widths[1] / 8, 1.0)
    later = max(_unevenness(away, bounds[k] + highest[k], reach, slack) / tops[k].max() for k in (1, 2))
    own = _unevenness(away, highest[0], reach, slack)
    if own > (UNEVEN + 1.5 * later) * tops[0].max() + 5 * noise:
        return Release(float(times[highest[0]]), free)
    return None


def _width(top: Floats) -> int:
    """Samples above half the top's height."""
    return int(np.sum(top > HALF * top.max()))


def _unevenness(away: Floats, middle: int, reach: int, slack: float) -> float:
    """How far the motion before a turning point is from that after it, mirrored in time.

    The mirror stands where they are closest, at most ``slack`` samples from ``middle``: noise and sampling move the highest one.
    """
    k = np.arange(len(away))
    found = []
    for mirror in middle + slack * np.linspace(-1, 1, 33):
        steps = np.arange(0, min(reach, mirror, len(away) - 1 - mirror))
        before, after = np.interp(mirror - steps, k, away), np.interp(mirror + steps, k, away)
        found.append(float(np.abs(before - after).max(initial=0)))
    return min(found)
