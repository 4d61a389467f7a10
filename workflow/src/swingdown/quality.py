"""Checks of a series before anything is computed from it: its times, and whether the sensor was at its rail."""

import numpy as np

from .errors import InputError

GAP = 1.5  # times the usual interval: a sample is missing
PLATEAU = 5  # equal samples at an extreme before it is looked at
CORNER = 8  # quantisation steps that a smooth turning point cannot fall in the time given


def check_times(times, lines, place):
    """None if the times (s) rise evenly enough; InputError if one repeats, runs back, or a sample is missing.

    ``lines`` are the file's line numbers of the samples.
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
            window,
        )
    if len(bad := np.flatnonzero(steps > GAP * usual)):
        k = bad[0]
        raise InputError(
            f"{place}, line {lines[k + 1]}",
            f"a gap of {steps[k]:.6g} s after {times[k]:.9g} s ({len(bad)} in the file)",
            f"a sample every {usual:.6g} s",
            window,
        )


def check_signal(times, signal, place, static=False):
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
                f"the signal is saturated: {length} samples at its {word} value {signal[first]:g}, "
                f"with corners ({len(runs)} such flat tops)",
                "rounded turning points",
                "record with a wider range, or leave the part out with start_s and stop_s",
            )


def saturated_runs(signal):
    """The flat tops cut off by a rail, as (first sample, length) pairs; empty if every top is rounded.

    A flat top of a coarsely quantised swing is a parabola seen in steps: half a plateau further out on either
    side it has fallen by at most four steps. A signal cut off at a rail falls much further, and leaves the
    rail in a straight line. Tops at the signal's highest value are looked at. A plateau that touches the
    first or last sample is judged by its other side alone, and one that starts the record with a release from
    rest is none.
    """
    top, span = signal.max(), np.ptp(signal)
    values = np.unique(np.round(signal / span, 9)) * span
    step = np.diff(values).min()
    at_top = np.concatenate(([0], (signal >= top - 1e-9 * span).astype(int), [0]))
    edges = np.diff(at_top)
    starts, stops = np.flatnonzero(edges == 1), np.flatnonzero(edges == -1)
    found = []
    for start, stop in zip(starts, stops, strict=True):
        length = stop - start
        if length < PLATEAU:
            continue
        whole = start == 0 or stop == len(signal)
        sides = [side for side in (signal[:start][::-1], signal[stop:]) if len(side)]
        if sides and all(_corner(top, side, length if whole else length // 2, step) for side in sides):
            found.append((int(start), int(length)))
    return found


def _corner(top, side, half, step):
    """True if the samples beyond a plateau fall away from it faster than a turning point can."""
    fallen = top - side[: max(half, 4)]
    if len(fallen) < 4 or fallen[min(half, len(fallen)) - 1] <= CORNER * step:
        return False
    second, third = fallen[1] - fallen[0], fallen[2] - fallen[1]  # the first step is cut short by the rail
    return second > 3 * abs(third - second) and second > 2 * step
