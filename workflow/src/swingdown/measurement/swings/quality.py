"""Whether a sensor was at its rail, or moves at all."""

import numpy as np

from ...arrays import Floats
from ...errors import InputError
from ...rounding import moment

PLATEAU = 4  # samples at the highest value of one top before it is looked at
# samples that noise may put on the other side of a step, one where a top begins and one where it ends
EDGES = 2
STEPS = 8  # quantisation steps below it that are compared with it
CLEAR = 16  # quantisation steps that a stretch beside it falls by, in which rounding is little


def check_signal(times: Floats, signal: Floats, place: str, computed: bool = False) -> None:
    """None if the signal moves and is not cut off at a rail; InputError otherwise. What is ``computed`` has no rail."""
    if np.ptp(signal) == 0:
        problem = f"the signal is constant ({signal[0]:g})"
        raise InputError(place, problem, "a swing", "check the sensor, or set the role to static")
    for word, sign in () if computed else (("highest", 1), ("lowest", -1)):
        if len(runs := saturated_runs(sign * signal)):
            first, length = runs[0]
            problem = f"the signal is saturated: {length} samples at its {word} value {signal[first]:g} ({len(runs)} such tops)"
            mend = "record with a wider range, or leave the part out with ⟨start_s⟩ and ⟨stop_s⟩"
            raise InputError(f"{place}, {moment(times[first])} s", problem, "rounded turning points", mend)


def saturated_runs(signal: Floats) -> list[tuple[int, int]]:
    """The flat tops cut off by a rail, as (first sample, samples at the rail) pairs; empty if every top is
    rounded.

    A rounded top seen in steps spends at least twice as long in the eight steps below the highest as at the
    highest itself, for its distance from the turning point grows with the square of the time. A rail gathers
    the samples that would lie above it, so the highest value has more than the eight below it together, noise
    or not. Two such tops are a rail; a single one may be a bob held before its release, and is a rail only if
    the signal comes to it and leaves it in a straight line, where a release starts from rest; with what the recording begins or ends is no top.
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
        return cut if len(sides) == 2 and all(_corner(side, step) for side in sides) else []
    return cut


def _smallest_step(levels: Floats) -> float:
    """The smallest difference between two of the levels, to nine decimals; they are sorted in place, for a long recording fills the memory."""
    np.round(levels, 9, out=levels)
    levels.sort()
    gaps = np.diff(levels)
    return float(np.min(gaps, where=gaps > 0, initial=np.inf))


def _corner(side: Floats, step: float) -> bool:
    """True if the samples beyond a plateau leave it in a straight line, whatever the ``step`` of the sensor took from each or gave it.

    From rest the first of two stretches of n samples falls by less than 1 + 2/n of how much more the second falls: the release is up to
    a sample before the first, and by a third of a stretch where its step hides it.
    """
    clear = np.flatnonzero(side[0] - side > CLEAR * step)
    n = int(clear[0]) if clear.size else side.size
    # by half of all it goes as fast as it ever does, from rest as well
    if 2 * n >= side.size or side[0] - side[2 * n] > np.ptp(side) / 2:
        return False
    first, second = -np.diff(side[: 2 * n + 1 : n])
    return bool(first - step > (1 + 2 / n) * (abs(second - first) + 2 * step))
