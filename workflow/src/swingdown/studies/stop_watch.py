"""What a stop-watch would show: the mean period of the first swings of a recording, and of its last."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from ..arrays import Floats, Shown, finite_or_none
from ..calmed import calmed
from ..pendulum.half_swings import half_swings, passages
from .unscaled import HIDES, counted_passages, course_seen, of_first_swings

SWINGS = 10  # that are timed; of a shorter recording all
_FEWEST = 2
_ENOUGH = 5  # passages that have a scatter about a line


class Timed(NamedTuple):
    """The mean period (s) of so many swings, and the amplitude in their middle, in the unit of the curve."""

    swings: int
    period: float
    amplitude: float


def timed(times: Floats, series: Floats, curve: Floats | None = None) -> tuple[Timed, Timed] | None:
    """The first and the last swings of a recording, each timed together as with a stop-watch; None where fewer than two whole ones are seen.

    The times (s), the ``series`` as recorded and the fitted ``curve`` are of shape (sample,). The curve tells when the middle is passed. Where
    passages of the recording run away from these, they tell the mean. None where no model follows the swing: then each passage of the
    recording counts, so that one at an end that noise moved matters less. Passages that a hole hides are counted by the time between the others.
    """
    swings = half_swings(course := series if curve is None else curve)
    passed, halves = counted_passages(times, course, HIDES)
    if passed.size < 2 * _FEWEST + 1:
        return None
    late = _late(times, series, passed)
    away = np.abs(swings.turns[1:-1] - swings.centre())
    count = int(min(SWINGS, halves[-1] // 2))

    def of(first: int, last: int, other: int) -> Timed:
        """Of these half-swings; both ways through the middle count alike, so that one beside the true one moves nothing."""
        sides = [k for k in (0, other) if first + k >= 0 and last + k <= halves[-1]]
        ways = [np.searchsorted(halves, (first + k, last + k)) for k in sides]
        each = slice(np.min(ways), np.max(ways) + 1)
        if curve is None:
            mean = _apart(halves[each], passed[each])
        else:
            whole = [(passed[end] - passed[begin]) / (halves[end] - halves[begin]) for begin, end in ways]
            mean = np.mean(whole) + _run_away(halves[each], late[each])
        return Timed(count, float(2 * mean), float(np.median(away[slice(*ways[0])])))

    return of(0, 2 * count, 1), of(halves[-1] - 2 * count, halves[-1], -1)


def _apart(halves: np.ndarray, passed: Floats) -> float:
    """How long (s) a half-swing takes by all of these passages: a line through those of each way through the middle, the mean of both."""
    ways = [way for side in (0, 1) if (way := halves % 2 == side).sum() > 1] or [halves >= 0]
    return float(np.mean([np.polyfit(halves[way], passed[way], 1)[0] for way in ways]))


def _late(times: Floats, series: Floats, passed: Floats) -> Floats:
    """How much later (s) than each of the times ``passed`` the recording passes its middle; nan where it does not within a quarter period."""
    seen = passages(times, series, half_swings(series).centre())
    if not seen.size:
        return np.full(passed.size, np.nan)
    after = np.searchsorted(seen, passed).clip(1, max(seen.size - 1, 1))
    both = seen[np.array([after - 1, after.clip(max=seen.size - 1)])] - passed
    late = np.where(np.abs(both[0]) < np.abs(both[1]), *both)
    late[np.abs(late) > np.median(np.diff(passed)) / 2] = np.nan
    return late


def _run_away(halves: np.ndarray, late: Floats) -> float:
    """How much later (s) passages are with each half-swing: the median slope, weighed by AIC beside none, as laws of damping are."""
    known = np.isfinite(late)
    at, late = halves[known].astype(float), late[known]
    if late.size < _ENOUGH:
        return 0.0
    from scipy.stats import theilslopes  # takes as long to load as a recording to be fitted

    slope, middle = theilslopes(late, at)[:2]
    # standard deviation, of normal numbers
    scatter = 1.4826 * float(np.median(np.abs(late - middle - slope * at)))
    u = scatter / float(np.sqrt(np.sum((at - at.mean()) ** 2)))
    doubt = np.exp(min(1 - (slope / u) ** 2 / 2, 700.0)) if u > 0 else 0.0
    return float(slope / (1 + doubt))


def by_stop_watch(shown: Sequence[Shown], table: pd.DataFrame) -> list[dict[str, Any]]:
    """By recording, for JSON, the mean period of its first and of its last ten swings, with the amplitude (rad) in their middle where it is
    known; and the period of the first whole swing by its passages of the middle alone. The last row of the ``table`` of
    ``studies.pendulums`` is that of a recording without one of its own."""
    rows = {one["recording"]: one for one in table.to_dict("records")}
    told = []
    for name, parts in Shown.by_recording(shown).items():
        row = rows.get(name, table.iloc[-1].to_dict())
        times, series, fit = (
            np.concatenate([getattr(one, key) for one in parts]) for key in ("times", "angle", "fit")
        )
        if parts[0].unit == "rad/s":
            series = calmed(times, series, ends_quiet=False)
        found = timed(times, series, None if course_seen(row) else fit)
        if not found:
            continue
        scaled = parts[0].unit == "rad" and np.isfinite(row["amplitude_rad"])
        first, last = (
            {"period_s": finite_or_none(one.period), "amplitude_rad": one.amplitude if scaled else None}
            for one in found
        )
        alone = of_first_swings(times, series)
        period, u = (finite_or_none(alone[key]) for key in ("period_first", "period_first_u"))
        whole = {"period_s": period, "standard_uncertainty": u}
        many = {"swings": found[0].swings, "first": first, "last": last}
        told.append({"recording": name, "first_swing": whole} | many)
    return told
