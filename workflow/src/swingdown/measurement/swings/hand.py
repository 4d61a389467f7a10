"""Where a hand is at the pendulum: stretches of a recording in which more acts on it than weight and friction."""

from typing import NamedTuple

import numpy as np

from ...arrays import Floats, runs
from ...pendulum.half_swings import half_swings
from .noise_level import noise_level

WINDOW = 0.25  # of a period: the stretch of samples from which an acceleration is told
LEARNED = 8  # half-swings from which weight and friction are learned
STRONG = 0.15  # of the largest pull of the weight in those; a hand that holds or lifts does not do less
# standard deviations of what weight and friction leave there, as noise and effects without a name do
ODD = 6.0
BRIEF = 0.08  # of a period: at the ends of a recording it is strong for longer
# windows: a spike or a jump is in no more of them, so a hand within a recording is strong for longer
SHORT = 1.2
CLOSE = 0.75  # of a period: what is strong twice within it is one hand


STILL = 0.02  # of the range of an angular rate: less is no motion
HIGHER = 1.15  # times as fast as in the period before it was held
HELD = 0.3  # of a period: at a turning point it is that slow for a hundredth


class Stretch(NamedTuple):
    """From when to when (s) a hand is at the pendulum, about; or of what is between two hands, nan where there is none."""

    start: float
    stop: float


def stretches(times: Floats, signal: Floats, scale: float = 0.0) -> list[Stretch]:
    """The stretches in which a hand holds, lifts or stops the pendulum, in order, for evenly spaced ``times`` (s).

    ``scale`` is rad per unit of ``signal``; 0 where that is not known, as of volts. The acceleration is that of a quartic
    through a quarter of a period. Weight and friction are what sine (or an odd polynomial) of the angle and the velocity tell of it in the eight
    half-swings after the largest; a hand is what that leaves, where it is strong for longer than a spike is.
    None is found where noise or an effect without a name leaves as much, in fewer than five half-swings, or with fewer than 12 samples a period.
    """
    swings = half_swings(signal)
    if len(swings.starts) < 5 or len(signal) < 64:
        return []
    sizes = np.abs(swings.turns - swings.centre())
    first = min(int(np.argmax(sizes[:-1])) + 1, len(sizes) - 4)  # after the largest
    last = min(first + LEARNED, len(sizes) - 1)
    samples = 2 * (swings.starts[last] - swings.starts[first]) / (last - first)  # a period
    half = max(2, round(WINDOW * samples / 2))
    inside = slice(swings.starts[first], min(swings.starts[last], len(signal) - half) - half)
    if samples < 12 or inside.stop - inside.start < 32:
        return []
    excess = _excess(signal - swings.centre(), scale, half, samples, inside)
    usual = float(np.median(np.abs(excess[inside]))) / 0.6745
    strong = np.sign(excess) * (np.abs(excess) > max(STRONG, ODD * usual))
    joined: list[tuple[int, int]] = []
    for start, stop in runs(strong):
        if stop - start < BRIEF * samples:
            continue
        if joined and start - joined[-1][1] < CLOSE * samples:
            joined[-1] = (joined[-1][0], stop)
        else:
            joined.append((start, stop))
    found = []
    for start, stop in joined:
        if start > 0 and stop < len(excess) and stop - start < SHORT * 2 * half:
            continue
        start, stop = _half_height(excess, start, stop)
        found.append((start + half if start else 0, stop + half if stop < len(excess) else len(signal) - 1))
    return [Stretch(float(times[start]), float(times[stop])) for start, stop in found]


def held_still(times: Floats, rate: Floats) -> list[Stretch]:
    """The stretches of an angular rate in which the pendulum is held still before it swings (on), in order.

    A hand that holds the angle leaves a rate of nothing, as rest does; but what comes to rest by itself does not swing higher
    afterwards. A hand that lifts and lets go at once is not seen in a rate.
    """
    swings = half_swings(rate)
    if len(swings.starts) < 5 or len(rate) < 64:
        return []
    still = np.abs(rate - swings.centre()) < max(STILL * np.ptp(rate), 5 * noise_level(times, rate))
    period = swings.period(times)
    usual = round(period / float(np.median(np.diff(times))))
    found = []
    for a, b in runs(still):
        before, after = np.abs(rate[max(0, a - usual) : a]), np.abs(rate[b:])
        held = b < len(rate) and times[b] - times[a] > HELD * period
        if held and after.max() > HIGHER * before.max(initial=0.0):
            found.append(Stretch(float(times[a]), float(times[b])))
    return found


def _excess(away: Floats, scale: float, half: int, samples: float, inside: slice) -> Floats:
    """What weight and friction leave of the acceleration, over the weight's largest pull; without ``half`` samples at each end."""
    x = np.arange(-half, half + 1) / samples
    weights = np.linalg.pinv(np.vander(x, 5 if half > 3 else 4, increasing=True))
    angle, velocity, acceleration = (np.correlate(away, weights[k], "valid") for k in range(3))
    size = float(np.abs(angle[inside]).max())
    x, v = angle / size, velocity / (2 * np.pi * size)
    pull = [x, np.sin(angle * scale) / scale / size] if scale else [x, x**3, x**5]
    terms = np.column_stack([*pull, v, v * np.abs(v), np.tanh(20 * v), np.ones_like(x)])
    known = np.linalg.lstsq(terms[inside], acceleration[inside], rcond=None)[0]
    weight = terms[inside][:, : len(pull)] @ known[: len(pull)]
    return (acceleration - terms @ known) / np.abs(weight).max()


def _half_height(excess: Floats, start: int, stop: int) -> tuple[int, int]:
    """The run without its flanks: a window smears what begins or ends at once, and half its height is where it did."""
    size = np.abs(excess[start:stop])
    high = np.flatnonzero(size > 0.5 * size.max())
    return (start + int(high[0]) if start else 0, start + int(high[-1]) + 1 if stop < len(excess) else stop)
