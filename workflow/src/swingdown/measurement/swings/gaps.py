"""What is reported of the gaps (holes) in a recording, where samples are missing, and whether the swings that they hide can be counted."""

from typing import NamedTuple

import numpy as np

from ...arrays import Floats
from ...errors import InputError
from ...pendulum.half_swings import half_swings, passages
from ...rounding import moment
from .even import Even, evenly

_NEAR = 12  # half-swings beside a hole that tell its period
COUNTED = 0.25  # swings: what lies in a hole is counted if it is known better than this


def missing_samples(even: Even, given: Floats) -> list[str]:
    """A remark on the samples that are missing, or on times that keep no rate; none where both are as they should be."""
    if not even.kept:
        steps = np.diff(given)
        return [
            f"the time between samples varies by {np.std(steps) / np.median(steps):.2g} of {np.median(steps):.4g} s (standard deviation); "
            "each is taken at its own time"
        ]
    holes = even.holes()
    if not holes:
        return []
    longest = max(even.times[b] - even.times[a - 1] for a, b in holes) - even.interval
    remark = f"{int(even.missing.sum())} of {even.times.size} samples are missing, the longest hole {longest:.2g} s; the others are taken at their times"
    return [remark]


class Uncounted(NamedTuple):
    """A hole (s) that hides so many swings, and the longest part (s) without one."""

    start: float
    stop: float
    swings: float
    part: tuple[float, float]

    def words(self) -> str:
        """The hole in words: how long it is, and how many swings it hides."""
        return f"a hole of {self.stop - self.start:.3g} s hides about {self.swings:.0f} swings; how many exactly is not known"


def check_countable(times: Floats, signal: Floats, place: str) -> None:
    """None where the swings in every hole can be counted from those on both sides; InputError with the longest whole part otherwise."""
    if hidden := uncounted(times, signal):
        first, last = hidden.part
        raise InputError(
            f"{place}, {moment(hidden.start)} s",
            hidden.words(),
            "holes in which swings can be counted",
            f"use a part: from {moment(first, 9)} to {moment(last, 9)} s there is no such hole (⟨start_s={moment(first, 9)}⟩, ⟨stop_s={moment(last, 9)}⟩)",
        )


def uncounted(times: Floats, signal: Floats) -> Uncounted | None:
    """The first hole in which the swings cannot be counted; None where there is none.

    The period before a hole and that after it, each with its standard uncertainty, tell how many swings it hides.
    """
    even = evenly(times, signal)
    swings = half_swings(signal)
    period, centre = swings.period(times), swings.centre()
    deep = even.deep(period)
    passed = passages(times, signal, centre if np.isfinite(centre) else float(np.median(signal)))
    middle = (passed[1:] + passed[:-1]) / 2
    halves = np.diff(passed)
    whole = np.ones(halves.size, dtype=bool)  # half-swings with no hole in them
    for start, stop in deep:
        whole &= (passed[1:] <= start) | (passed[:-1] >= stop)
    middle, halves = middle[whole], halves[whole]
    for start, stop in deep:
        if stop - start < period / 2:
            continue
        sides = [_period(halves[middle < start][-_NEAR:]), _period(halves[middle > stop][:_NEAR])]
        known = [one for one in sides if one is not None]
        (one, u_one), (other, u_other) = (known * 2)[:2] if known else ((period, np.inf), (period, np.inf))
        unsure = (abs(one - other) + 2 * np.hypot(u_one, u_other)) * (stop - start) / min(one, other) ** 2
        if unsure > COUNTED:
            edges = [times[0], *(edge for hole in deep for edge in hole), times[-1]]
            first, last = max(zip(edges[::2], edges[1::2], strict=True), key=lambda one: one[1] - one[0])
            return Uncounted(start, stop, (stop - start) / period, (float(first), float(last)))
    return None


def _period(halves: Floats) -> tuple[float, float] | None:
    """The period (s) that these half-swings tell and its standard uncertainty, whatever their middle; None of fewer than two."""
    if halves.size < 2:
        return None
    whole = halves[1:] + halves[:-1]
    usual = float(np.median(whole))
    spread = 1.4826 * float(np.median(np.abs(whole - usual))) if whole.size > 2 else float(np.ptp(halves))
    return usual, spread / np.sqrt(whole.size)
