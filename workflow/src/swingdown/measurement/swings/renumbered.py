"""Samples that are lost, or written twice, at even distances while the time is numbered on: the samples then step unevenly."""

from functools import lru_cache

import numpy as np
from scipy.special import stdtr

from ...arrays import Floats
from ...quantisation import quantisation_step
from .even import Even

LONGEST = 50  # samples kept between two losses that are looked for
PART = 0.3  # of a period: a polynomial of fourth order follows the swing there
FEWEST = 7  # samples of such a polynomial, so that something is left of it
WIDEST = 2 * LONGEST + 1
ENOUGH = 100_000  # samples that are looked at
BY_CHANCE = 1e-3  # how often noise alone may be told of, over all distances, places and both signs


def lost_evenly(even: Even, period: float) -> list[str]:
    """A remark where samples are lost after every p-th one, p = 2 ... 50, or one of p is there twice, and the time numbered on; else none.

    ``period`` in samples. What a short polynomial leaves is regressed on the speed times a sawtooth of p samples, for each p and place of
    its teeth. A sawtooth of less than half a sample is no lost one, and that of a reading which is held for p samples is p high. Where
    the swing moves by less than a step of its readings between two samples (RMS), rounding itself makes sawteeth, and nothing is asked. Nor is
    anything told where a sine of p samples takes more: a bob that wobbles as it swings.
    """
    width = min(int((PART * period - 1) / 2) * 2 + 1, WIDEST) if np.isfinite(period) else 0
    if width < FEWEST or even.times.size < 4 * width:
        return []
    signal = even.signal[:ENOUGH]
    left = np.zeros(width)
    left[width // 2] = 1.0
    smoothed, sloped = _of_polynomial(width)
    left -= smoothed
    rest = np.correlate(signal, left, mode="valid")
    speed = np.correlate(signal, sloped, mode="valid")
    if np.sqrt(np.mean(speed**2)) < quantisation_step(even.signal):
        return []
    looks = LONGEST * (LONGEST + 1) - 2
    taken, size, student, draws, every = max(
        (*_sawtooth(rest, speed, left, every), every) for every in range(2, LONGEST + 1)
    )
    lost = round(size * every / (every - size)) if size <= every / 2 else 0
    if not lost or stdtr(draws - 1, -student) > BY_CHANCE / looks or _shaken(rest, speed, every) > taken:
        return []
    count, of = abs(lost), every + max(lost, 0)
    return [
        f"{count} of every {of} samples {'seems' if count == 1 else 'seem'} to be {'lost' if lost > 0 else 'there twice'}, and the time "
        f"numbered on: period and decay time are too {'short' if lost > 0 else 'long'} by {100 * count / (every + lost):.3g} % (the samples "
        "step unevenly; record slower, or keep the time at which each was taken)"
    ]


@lru_cache(maxsize=50)
def _of_polynomial(width: int) -> tuple[Floats, Floats]:
    """The weights of so many samples in the middle value of a polynomial of fourth order through them, and in its slope there."""
    place = np.arange(width) - width // 2
    weights = np.linalg.pinv(np.vander(place, 5, increasing=True).astype(float))
    return weights[0], weights[1]


def _shaken(rest: Floats, speed: Floats, every: int) -> float:
    """What a sine of ``every`` samples takes from the squares of ``rest``, as large as the speed: of what shakes it is more than a sawtooth takes."""
    turn = 2 * np.pi * np.arange(rest.size) / every
    columns = np.column_stack([speed * np.sin(turn), speed * np.cos(turn)])
    found, *_ = np.linalg.lstsq(columns, rest, rcond=None)
    return float(np.sum((columns @ found) ** 2))


def _sawtooth(rest: Floats, speed: Floats, left: Floats, every: int) -> tuple[float, float, float, float]:
    """What the likeliest sawtooth of ``every`` samples takes from the squares of ``rest``, its size in samples (below 0 where they come
    early), Student's t of it, and the teeth that tell it.

    Each tooth is a draw of its own, whatever the noise and the swing: the scatter of what they tell gives Student's t.
    """
    count = rest.size // every
    if count < 3:
        return 0.0, 0.0, 0.0, 2.0
    teeth = -np.correlate((np.arange(every + left.size - 1) % every) / every, left, mode="valid")
    places = teeth[(np.arange(every)[:, None] + np.arange(every)) % every].T
    part = slice(count * every)
    told = (rest * speed)[part].reshape(count, every) @ places
    worth = (speed**2)[part].reshape(count, every) @ places**2
    total, weight = told.sum(axis=0), worth.sum(axis=0)
    if not weight.all():
        return 0.0, 0.0, 0.0, 2.0
    # of two samples a sawtooth is its own mirror image
    taken = (np.maximum(total, 0) if every == 2 else total) ** 2 / weight
    best = int(np.argmax(taken))
    size = float(total[best] / weight[best])
    draws = weight[best] ** 2 / float(np.sum(worth[:, best] ** 2))  # teeth, each as much as it tells
    if draws < 3:
        return 0.0, 0.0, 0.0, 2.0
    scatter = np.sqrt(draws / (draws - 1) * np.sum((told[:, best] - size * worth[:, best]) ** 2))
    return float(taken[best]), size, abs(total[best]) / scatter if scatter else np.inf, draws
