"""The device's clock held against the host's, over a whole recording: a rate that is not the one said, a stall, a jump.

Arrivals are late at times and never early, and what a late host finds waiting comes in one piece: so only the last sample of
each piece counts, and of several pieces the promptest.
"""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

RATE = 0.005  # part; how far the clocks of host and device may part: a ceramic resonator is good to that
LATE = 0.05  # s; what the promptest arrivals may jitter by in any case
STALL = 0.15  # s; a shorter standstill of the device's clock cannot be told from a late host
BRIEF = 0.5  # s; the same where little was recorded before it, or after it
_SIDE = 3  # blocks before and after a standstill that are not little
_BLOCKS = 24  # of the recording; the promptest arrival of each counts
_FEWEST = 4  # blocks that tell anything
_SHORTEST = 0.1  # s, of a block


class Comparison(NamedTuple):
    """What the host's clock says of the device's."""

    ratio: float  # seconds by the host for one by the device
    jitter: float  # s; by how much the promptest arrivals spread
    stall: float  # s that the device's clock stood still (above 0) or jumped ahead (below 0) once
    at: float  # s; when, by the device's clock

    def off(self, duration: float) -> bool:
        """True if the clocks part by more over ``duration`` (s) than good clocks and jitter account for."""
        return abs(self.ratio - 1) * duration > RATE * duration + LATE + self.jitter


def compare(times: npt.ArrayLike, arrivals: npt.ArrayLike) -> Comparison | None:
    """The Comparison of device times (s) with arrivals (s by the host), or None where they are too few to tell anything."""
    times, arrivals = np.asarray(times, float), np.asarray(arrivals, float)
    last = np.flatnonzero(np.diff(arrivals) > 0)  # of each piece but the final one, which may be cut short
    if len(last) < _FEWEST:
        return None
    late = arrivals - times
    late, times = late[last] - late[last[0]], times[last]
    span = times[-1] - times[0]
    count = int(min(_BLOCKS, len(last) // 2, span / _SHORTEST))
    if count < _FEWEST:
        return None
    block = np.minimum(((times - times[0]) / span * count).astype(int), count - 1)
    prompt = [
        inside[np.argmin(late[inside])] for k in range(count) if len(inside := np.flatnonzero(block == k))
    ]
    if len(prompt) < _FEWEST:
        return None
    t, b = times[prompt], late[prompt]
    plain, left = _fitted(t, b)
    jitter = float(np.ptp(left))
    steps = [(k, *_fitted(t, b, np.arange(len(t)) >= k)) for k in range(1, len(t))]
    k, terms, off = min(steps, key=lambda step: float(step[2] @ step[2]))
    rest = float(np.ptp(off))
    sure = STALL if _SIDE <= k <= len(t) - _SIDE else BRIEF
    if abs(terms[2]) > sure + 2 * rest and rest < jitter / 3:
        return Comparison(1 + float(terms[1]), rest, float(terms[2]), float(t[k]))
    return Comparison(1 + float(plain[1]), jitter, 0.0, 0.0)


def jump(positions: npt.ArrayLike, times: npt.ArrayLike) -> tuple[float, int]:
    """(seconds too many, index) of the largest jump of the device's clock between samples whose numbers say otherwise.

    (0, 0) where there is none: all intervals agree with the usual one within half of it and 50 ms.
    """
    positions, times = np.asarray(positions), np.asarray(times, float)
    if len(times) < _FEWEST:
        return 0.0, 0
    steps = np.diff(positions)
    usual = float(np.median(np.diff(times) / steps))
    beyond = np.diff(times) - usual * steps
    k = int(np.argmax(np.abs(beyond)))
    if abs(beyond[k]) <= max(0.5 * usual * steps[k], LATE):
        return 0.0, 0
    return float(beyond[k]), k + 1


def _fitted(t, b, *steps):
    """Coefficients of a straight line (and a step, where one is given) through (t, b), and what it leaves."""
    terms = np.column_stack([np.ones_like(t), t, *steps])
    found, *_ = np.linalg.lstsq(terms, b, rcond=None)
    return found, b - terms @ found
