"""Where a swing is not in step with itself: what swings by itself passes its middle evenly, whatever stops it."""

import numpy as np

from ...arrays import Floats
from ...pendulum.half_swings import half_swings, passages
from ..plausibility import STEADY
from .clock import UNEVEN

SLIP = 0.05  # of a period: of a fit through both sides it leaves 0.08 of the swing (RMS), and its values are doubtful
HIDES = 0.25  # of a period: a longer hole may hide a half-swing
SURE = 5.0  # times what periods beside it scatter
BESIDE = 6  # half-swings on either side that tell the period
FEWEST = BESIDE + 2  # periods


def out_of_step(times: Floats, signal: Floats) -> list[tuple[float, float]]:
    """From when to when (s) a swing takes another time than the swings before and after it do, in order.

    There samples are missing that nothing tells of, a tracker followed something else, or somebody touched the pendulum. A passage through
    the middle inside a hole is not known, and tells nothing; nor does a swing with a hole that may hide one.
    """
    centre = half_swings(signal).centre()
    if not np.isfinite(centre):
        return []
    passed = _known(passages(times, signal, centre), times)
    periods = passed[2:] - passed[:-2]
    steps = np.diff(times)
    deep = np.flatnonzero(steps > HIDES * np.nanmedian(periods)) if periods.size else np.empty(0, dtype=int)
    for start, stop in zip(times[deep], times[deep + 1], strict=True):
        periods[(passed[:-2] < stop) & (passed[2:] > start)] = np.nan
    if np.count_nonzero(np.isfinite(periods)) < FEWEST:
        return []
    found: list[tuple[float, float]] = []
    for k in np.flatnonzero(np.isfinite(periods)):
        # a hand that ends a swing moves the pendulum as it likes: then nothing but what was before it is even
        before, beside = periods[max(0, k - 2 * BESIDE) : k], periods[max(0, k - BESIDE) : k + BESIDE + 1]
        if _odd(periods[k], beside, BESIDE, SLIP) or _odd(periods[k], before, 2 * BESIDE, STEADY):
            start, stop = float(passed[k]), float(passed[k + 2])
            if found and start <= found[-1][1]:
                start, _ = found.pop()
            found.append((start, stop))
    return found


def _odd(period: float, others: Floats, fewest: int, least: float) -> bool:
    """Whether a period is none of the others, of which ``fewest`` have to be known, by the share ``least`` and by what they scatter."""
    others = others[np.isfinite(others)]
    if others.size < fewest:
        return False
    usual = float(np.median(others))
    scatter = 1.4826 * float(np.median(np.abs(others - usual)))
    return abs(period - usual) > max(least * usual, SURE * scatter)


def _known(passed: Floats, times: Floats) -> Floats:
    """The passages with nan for those that lie in a hole."""
    after = np.clip(np.searchsorted(times, passed), 1, times.size - 1)
    usual = float(np.median(np.diff(times)))
    return np.where(times[after] - times[after - 1] > (1 + UNEVEN) * usual, np.nan, passed)


def longest_between(slips: list[tuple[float, float]], times: Floats, signal: Floats) -> tuple[float, float]:
    """From when to when (s) the part without a slip lasts that holds most swings; nan for an end that is that of the recording."""
    passed = passages(times, signal, half_swings(signal).centre())
    edges = [times[0], *(edge for slip in slips for edge in slip), times[-1]]
    first, last = max(
        zip(edges[::2], edges[1::2], strict=True),
        key=lambda one: int(np.count_nonzero((passed >= one[0]) & (passed <= one[1]))),
    )
    return (float("nan") if first == times[0] else first), (float("nan") if last == times[-1] else last)
