"""Checks of a series before anything is computed from it: its times, and whether the sensor was at its rail."""

import numpy as np
from numpy.typing import NDArray

from ..arrays import Floats
from ..errors import InputError

GAP = 1.5  # times the usual interval: a sample is missing
COARSE = 0.05  # of the samples have the time of the one before: it was rounded
PART = 0.1  # of the samples without a gap: of less no window is proposed
PLATEAU = 4  # samples at the highest value of one top before it is looked at
EDGES = (
    2  # samples that noise may put on the other side of a step, one where a top begins and one where it ends
)
STEPS = 8  # quantisation steps below it that are compared with it


def check_times(times: Floats, lines: NDArray[np.integer], place: str, gaps: bool = False) -> None:
    """None if the times (s) rise evenly enough; InputError if one repeats, runs back, or a sample is missing.

    ``lines`` are the file's line numbers of the samples. ``gaps`` lets missing samples pass.
    """
    steps = np.diff(times)
    usual = float(np.median(steps))
    window = "leave the part out with start_s and stop_s, or mend the file"
    if len(bad := np.flatnonzero(steps <= 0)):
        k = bad[0]
        problem = "the time repeats" if steps[k] == 0 else "the time runs back"
        raise InputError(
            f"{place}, line {lines[k + 1]}",
            f"{problem}: {times[k + 1]:.9g} s after {times[k]:.9g} s ({len(bad)} times in the file)",
            "time strictly increasing",
            "export the time with more digits, and once for each sample: many have the same one"
            if np.count_nonzero(steps == 0) > COARSE * len(steps)
            else window,
        )
    if not gaps and len(bad := np.flatnonzero(steps > GAP * usual)):
        k = bad[0]
        raise InputError(
            f"{place}, line {lines[k + 1]}",
            f"a gap of {steps[k]:.6g} s after {times[k]:.9g} s ({len(bad)} in the file)",
            f"a sample every {usual:.6g} s",
            _whole_part(times, bad, window),
        )


def _whole_part(times: Floats, gaps: NDArray[np.integer], window: str) -> str:
    """The mend of a recording with gaps after these samples: its longest part without one, where that is a good part of it."""
    edges = np.concatenate(([0], gaps + 1, [len(times)]))
    sizes = np.diff(edges)
    most = int(np.argmax(sizes))
    first, last = times[edges[most]], times[edges[most + 1] - 1]
    if sizes[most] < PART * len(times):
        return "export it at even times, as from a recorder that keeps a rate, or interpolate it to them"
    return f"{window}: from {first:.9g} to {last:.9g} s there is none (start_s = {first:.9g}, stop_s = {last:.9g})"


def check_signal(times: Floats, signal: Floats, place: str, static: bool = False) -> None:
    """None if the signal moves and is not cut off at a rail; InputError otherwise.

    A static record may be constant: a quantised sensor at rest is. A swing may end at rest.
    """
    if static:
        return
    if np.ptp(signal) == 0:
        raise InputError(
            place,
            f"the signal is constant ({signal[0]:g})",
            "a swing",
            "check the sensor, or set the role to static",
        )
    for word, sign in (("highest", 1), ("lowest", -1)):
        if len(runs := saturated_runs(sign * signal)):
            first, length = runs[0]
            raise InputError(
                f"{place}, {times[first]:.6g} s",
                f"the signal is saturated: {length} samples at its {word} value {signal[first]:g} ({len(runs)} such tops)",
                "rounded turning points",
                "record with a wider range, or leave the part out with start_s and stop_s",
            )


def saturated_runs(signal: Floats) -> list[tuple[int, int]]:
    """The flat tops cut off by a rail, as (first sample, samples at the rail) pairs; empty if every top is
    rounded.

    A rounded top seen in steps spends at least twice as long in the eight steps below the highest as at the
    highest itself, for its distance from the turning point grows with the square of the time. A rail gathers
    the samples that would lie above it, so the highest value has more than the eight below it together, noise
    or not. Two such tops are a rail; a single one may be a bob held before its release, and is a rail only if
    the signal also leaves it in a straight line, where a release starts from rest.
    """
    top, span = signal.max(), np.ptp(signal)
    step = float(_smallest_step(signal / span) * span)
    if span < 4 * (STEPS + 1) * step:  # too coarse to tell a rail from a step
        return []
    at_top = signal >= top - 1e-9 * span
    near = signal >= top - (STEPS + 0.5) * step
    away = np.cumsum(signal < top - span / 4, dtype=np.int32)  # counts up between one visit and the next
    cut = []
    for visit in np.unique(away[at_top]):
        own = away == visit
        here = np.flatnonzero(own & at_top)
        if len(here) >= PLATEAU and np.sum(own & near) < 2 * len(here) - EDGES:
            cut.append((int(here[0]), len(here)))
    if len(cut) == 1:
        here = np.flatnonzero(at_top & (away == away[cut[0][0]]))
        sides = [side for side in (signal[: here[0]][::-1], signal[here[-1] + 1 :]) if len(side) > 3]
        return cut if sides and all(_corner(side, step) for side in sides) else []
    return cut


def _smallest_step(levels: Floats) -> float:
    """The smallest difference between two of the levels, to nine decimals; they are sorted in place, for a long recording fills the memory."""
    np.round(levels, 9, out=levels)
    levels.sort()
    gaps = np.diff(levels)
    return float(np.min(gaps, where=gaps > 0, initial=np.inf))


def _corner(side: Floats, step: float) -> bool:
    """True if the samples beyond a plateau leave it in a straight line, faster than a few steps a sample."""
    second, third = side[0] - side[1], side[1] - side[2]  # the first step is cut short by the rail
    return second > 3 * abs(third - second) and second > 2 * step
