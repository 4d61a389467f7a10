"""How many half-swings passed between turning points, by their times: gaps are whole multiples of one interval."""

import numpy as np

from ...arrays import Floats, longest
from ...pendulum.half_swings import lengthening

FEWEST = 6  # turning points: three terms of damping and a first angle, and two more to tell their scatter
_PARTS = 6  # into which the shortest gap is divided for an interval that all gaps are multiples of
_APART = 0.12  # of an interval (RMS): nearer to whole numbers than chance, which is 0.29
# terms of the line through many turning points at most, and points for each beyond the first
_BENDS, _EACH = 3, 30
_DOUBT = 0.25  # of an interval: beyond half of it the next whole number is as near


def counts(times: Floats, sizes: Floats) -> tuple[np.ndarray, slice] | None:
    """How many intervals after the first each point of the longest countable part is, and that part; None where none is.

    Gaps are whole multiples of one interval; the largest such is taken. ``sizes`` (rad; 0 where that is not known) tell how much
    longer it is at a large amplitude. A gap is counted where what is known of the interval by then leaves no doubt.
    """
    longer = lengthening((sizes[1:] + sizes[:-1]) / 2)
    for gaps in (np.diff(times) / longer, np.diff(times)):  # without a unit the sizes may be no angles
        for unit in (float(np.median(gaps)), *(float(np.min(gaps)) / part for part in range(1, _PARTS + 1))):
            counts = _multiples(gaps, unit)
            used = longest(counts != 0)
            if used.stop - used.start >= max(FEWEST, times.size / 2):
                return np.concatenate([[0], np.cumsum(counts[used][: used.stop - used.start - 1])]), used
    return None


def _multiples(gaps: Floats, unit: float) -> np.ndarray:
    """How many times a ``unit`` that is about right is in each gap; 0 where that cannot be told, or the gap is no multiple."""
    counts = np.zeros(gaps.size, dtype=int)
    sure = gaps < 1.5 * max(unit, float(np.min(gaps)))
    scatter = 0.0
    while True:
        off = np.abs(gaps / unit - np.round(gaps / unit))
        counts[:] = np.where(sure & (off < _DOUBT), np.round(gaps / unit), 0)
        if not counts.any():
            return counts
        unit, error, scatter = _line(gaps, counts)
        if scatter > _APART * unit:
            return np.zeros_like(counts)
        doubt = 3 * np.hypot(np.round(gaps / unit) * error, np.sqrt(2) * scatter)
        more = ~sure & (doubt < unit / 2)
        if not more.any():
            return counts
        sure |= more & (gaps <= 1.5 * float(np.min(gaps[more])))


def _line(gaps: Floats, counts: np.ndarray) -> tuple[float, float, float]:
    """Interval, its standard error and the scatter of the times, from lines of one slope through each part whose gaps are counted; of many
    points lines that bend alike, as a period changes a little in a long record: the error holds that change."""
    times, numbers_ = np.concatenate([[0.0], np.cumsum(gaps)]), np.concatenate([[0], np.cumsum(counts)])
    part = np.concatenate([[0], np.cumsum(counts == 0)])
    size = np.bincount(part)

    def about(values: Floats) -> Floats:
        """What is left of values without the mean of each part."""
        return np.asarray(values - (np.bincount(part, values) / size)[part])

    at = numbers_ - numbers_.mean()
    terms = min(_BENDS, 1 + times.size // _EACH)
    columns = np.column_stack([about(at**k) for k in range(1, terms + 1)])
    late = about(times)
    found = np.linalg.lstsq(columns, late)[0]
    left = late - columns @ found
    power = float(columns[:, 0] @ columns[:, 0])
    unit = float(columns[:, 0] @ late) / power
    slopes = sum(k * found[k - 1] * at ** (k - 1) for k in range(1, terms + 1))
    free = max(times.size - size.size - terms, 1)
    scatter = float(np.sqrt(left @ left / free))
    error = max(scatter / np.sqrt(power), 0.05 * unit / np.sqrt(power) / free)
    return unit, error + float(np.std(slopes)), scatter
