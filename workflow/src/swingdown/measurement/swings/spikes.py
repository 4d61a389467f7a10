"""Spikes: samples, or short runs of them, that lie beside the swing on both sides of them; they are no measurement of it."""

from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ...arrays import Bools, Floats, runs
from ...pendulum.half_swings import half_swings
from ...quantisation import quantisation_step
from .even import Even, evenly

SIDE = 6  # samples on each side of a place that is looked at
ODD = 12.0  # local standard deviations, beyond which a jump or spike is told; measured on recordings that have none
SEEN = 0.004  # of the range; smaller ones are not told
MOST = 0.01  # of the samples; more are no accidents, and are not left out
LONGEST = 6  # samples: a run of more is something that happened to the pendulum or the sensor
# in chi-square, by which samples left out explain a place better than a break in the swing does
BETTER = 60.0
# samples on each side that tell how the swing goes on: fewer where they are more than a swing
BESIDE = (12, 8)
ALIKE = 3.0  # local standard deviations, below which a sample goes on as those about it
SURE = 1.5  # times as unsure as a sample is by its noise: less is well told by the flanks
FLANKS = 4.0  # local standard deviations, up to which the swing beside a spike is as it should be
ORDERS = ((0.5, 5), (0.8, 7), (1.25, 9))  # periods up to which a polynomial of this order follows a swing
_PASSES = 3  # a large spike hides a small one beside it


class Spikes(NamedTuple):
    """Which samples are spikes, and the signal with what the swing about them says in their place."""

    where: Bools
    healed: Floats

    def within(self, part: slice) -> "Spikes":
        """Those of a part of the signal."""
        return Spikes(self.where[part], self.healed[part])


class Cluster(NamedTuple):
    """Samples near one another that stand out, and the deviation of the white noise that would do as the samples about them."""

    samples: NDArray[np.integer]
    noise: float


def find_spikes(times: Floats, signal: Floats) -> Spikes:
    """The ``Spikes`` of a swing sampled at a rate (``times`` in s): single samples and runs of up to six.

    A place stands out where a spike on a cubic swing is far larger than those that noise and swing make nearby. There a
    polynomial through the swing about it says which samples are beside it, by 12 local standard deviations and 0.4 % of the
    range. It is no spike where the swing does not go on behind it as before (a jump, a kink, samples lost), and the first
    and the last six samples are not looked at. Where more than 1 % of the samples would be spikes, none is. What lies further
    from all others than these lie from each other is no measurement either, however few samples a swing has.
    """
    if (far := _far(signal)).any():
        rest = find_spikes(times, np.interp(times, times[~far], signal[~far]))
        return Spikes(far | rest.where, rest.healed)
    none = Spikes(np.zeros(signal.size, dtype=bool), signal)
    even = evenly(times, signal)
    if not even.kept:
        return none
    period = half_swings(signal).period(times)
    grid, where = even.signal, np.zeros(even.times.size, dtype=bool)
    unknown = beside_holes(even, period)
    for _ in range(_PASSES):
        clusters = standing_out(grid, kernel(True), period / even.interval, unknown)
        least = max(SEEN * float(np.ptp(signal)), 2 * quantisation_step(signal)) if clusters else 0.0
        joined = _joined(clusters)
        open_ = unknown.copy()
        for first, last, _ in joined:  # a long run stands out in its middle alone
            open_[max(0, first - SIDE) : last + SIDE + 1] = True
        found = [_beside(grid, open_, *one, period / even.interval, least) for one in joined]
        places = np.array([place for one in found for place in one], dtype=int)
        if not places.size:
            break
        where[places] = True
        grid = heal(grid, where)
    own = where[even.place]
    return Spikes(own, grid[even.place]) if 0 < np.count_nonzero(own) <= MOST * own.size else none


def _far(signal: Floats) -> Bools:
    """True for short runs of samples beyond a gap that is wider than all others reach, as of an echo that a ranger lost."""
    order, few = np.sort(signal), int(MOST * signal.size)
    far = np.zeros(signal.size, dtype=bool)
    for side, ends in ((1, order), (-1, -order[::-1])):  # above the others, and below
        last = ends[-few - 1 :]
        reach = last[:-1] - ends[0]
        if len(over := np.flatnonzero((np.diff(last) > reach) & (reach > 0))):
            far |= side * signal > last[over[0]]
    return far if all(b - a <= LONGEST for a, b in runs(far)) else np.zeros_like(far)


def beside_holes(even: Even, period: float) -> Bools:
    """Which places lie in, or a few samples beside, a hole too long for the swing across it to be known, of a ``period`` (s)."""
    unknown = np.zeros(even.times.size, dtype=bool)
    for start, stop in even.deep(period):
        first, last = np.searchsorted(even.times, (start, stop))
        unknown[max(0, first - SIDE) : last + SIDE + 1] = True
    return unknown


def heal(signal: Floats, where: Bools) -> Floats:
    """The signal with what a quintic through a dozen samples on each side says in place of those that are marked."""
    healed, good = signal.copy(), np.flatnonzero(~where)
    for first, after in runs(where):
        at, run = int(np.searchsorted(good, first)), np.arange(first, after)
        near = good[max(0, at - 2 * SIDE) : at + 2 * SIDE]
        scale = max(1, int(near[-1] - near[0])) / 2
        powers = np.polynomial.chebyshev.chebvander((near - near.mean()) / scale, ORDERS[0][1])
        known = np.linalg.lstsq(powers, signal[near], rcond=None)[0]
        healed[run] = np.polynomial.chebyshev.chebval((run - near.mean()) / scale, known)
    return healed


def without(recording: xr.Dataset) -> tuple[xr.Dataset, Even]:
    """A recording without the samples that its variable ``spike`` marks, and all of it on an even grid, these healed."""
    signal, times = recording["signal"].values, recording["time"].values
    if "spike" not in recording:
        return recording, evenly(times, signal)
    where = recording["spike"].values.astype(bool)
    return recording.isel(time=~where), evenly(times, heal(signal, where))


def as_variable(where: Bools) -> dict[str, Any]:
    """The variable ``spike`` that marks them in a recording, by name; nothing where there is none."""
    words = {"long_name": "whether the sample is a spike, which is left out as missing"}
    flags = {"flag_values": np.array([0, 1], dtype=np.int8), "flag_meanings": "measured spike"}
    return {"spike": ("time", where.astype(np.int8), words | flags)} if where.any() else {}


def _joined(clusters: list[Cluster]) -> list[tuple[int, int, float]]:
    """First sample, last, and noise of the clusters, those together that are in one another's way."""
    joined: list[tuple[int, int, float]] = []
    for one in clusters:
        first, last = int(one.samples[0]), int(one.samples[-1])
        if joined and first - joined[-1][1] < 3 * SIDE:
            joined[-1] = (joined[-1][0], last, max(joined[-1][2], one.noise))
        else:
            joined.append((first, last, one.noise))
    return joined


def _beside(
    signal: Floats, open_: Bools, first: int, last: int, scale: float, period: float, least: float
) -> NDArray[np.integer]:
    """The samples about ``first`` to ``last`` that are spikes; of those that are ``open_`` elsewhere nothing is known yet."""
    none = np.empty(0, dtype=int)
    first, last = max(0, first - SIDE), min(signal.size - 1, last + SIDE)
    for flank in BESIDE:
        window = slice(max(0, first - flank), min(signal.size, last + flank + 1))
        own = signal[window]
        order = next((order for share, order in ORDERS if own.size <= share * period), 0)
        if order:
            break
    else:
        return none
    x = np.linspace(-1, 1, own.size)
    powers = np.polynomial.chebyshev.chebvander(x, order)
    inside = np.zeros(own.size, dtype=bool)
    inside[first - window.start : last - window.start + 1] = True
    elsewhere = open_[window] & ~inside
    beside = inside.copy()
    while True:  # from the flanks inwards, what goes on as they do joins them
        known = ~beside & ~elsewhere
        if np.count_nonzero(known) < order + SIDE:
            return none
        inverse = np.linalg.pinv(powers[known])
        left = own - powers @ (inverse @ own[known])
        unsure = np.sqrt(1 + np.sum((powers @ inverse) ** 2, axis=1))
        alike = beside & (np.abs(left) < ALIKE * scale * unsure)
        if not alike.any():
            break
        sure = alike & (unsure < SURE)
        beside &= ~(sure if sure.any() else alike & (unsure == unsure[alike].min()))
    beside &= np.abs(left) > np.maximum(ODD * scale * unsure, least)
    if not beside.any() or max(b - a for a, b in runs(beside)) > min(LONGEST, max(1.0, period / 8)):
        return none
    known = ~beside & ~elsewhere
    rest = float(np.sum(left[known] ** 2))
    if np.sqrt(rest / np.count_nonzero(known)) > max(FLANKS * scale, least / 4):
        return none
    places = range(first - window.start - 1, last - window.start + 2)
    here = ~elsewhere
    broken = _broken(x[here], own[here], powers[here], x[np.clip(places, 0, x.size - 1)])
    if broken - rest < BETTER * scale**2:
        return none
    return window.start + np.flatnonzero(beside)


def _broken(x: Floats, own: Floats, powers: Floats, places: Floats) -> float:
    """The least sum of squares that a swing leaves which goes on otherwise from one of these places on."""
    least = np.inf
    for k in places:
        late = (x > k)[:, None] * np.vander(x - k, 3)
        design = np.column_stack([powers, late])
        left = own - design @ np.linalg.lstsq(design, own, rcond=None)[0]
        least = min(least, float(left @ left))
    return least


def kernel(spike: bool) -> Floats:
    """Weights of the samples in a window that give the height of a spike, or of a jump, on a cubic swing."""
    n = 2 * SIDE + 1 if spike else 2 * SIDE
    x = (np.arange(n) - (n - 1) / 2) / SIDE
    # a kink, as samples lost at a turning point leave it, is no spike
    odd = [np.abs(x), np.arange(n) == SIDE] if spike else [x > 0]
    return np.linalg.pinv(np.column_stack([x**0, x, x**2, x**3, *odd]).astype(float))[-1]


def standing_out(signal: Floats, weights: Floats, period: float, unknown: Bools) -> list[Cluster]:
    """The ``Cluster``s of samples, none of them ``unknown``, where the height that the ``kernel`` tells stands out of those nearby.

    What swing and noise do to the height is told by its median over two periods, before, around and after; the noise is the
    white noise that would. ``period`` in samples.
    """
    if len(signal) < 8 * SIDE or not period > 4 * SIDE:  # too few samples a swing for a cubic
        return []
    height = np.correlate(signal, weights, mode="valid")
    np.abs(height, out=height)
    size = int(max(8 * SIDE, 2 * period))
    edges = np.linspace(0, len(height), max(1, len(height) // size) + 1).astype(int)
    own = np.array([np.median(height[a:b]) for a, b in zip(edges, edges[1:], strict=False)]) / 0.6745
    around = np.maximum(own, np.maximum(np.append(own[1:], 0), np.append(0, own[:-1])))
    seen = max(SEEN * float(np.ptp(signal)), 2 * quantisation_step(signal))
    least = np.maximum(ODD * around, seen)
    parts = zip(edges, edges[1:], least, strict=False)
    odd = np.concatenate([a + np.flatnonzero(height[a:b] > beyond) for a, b, beyond in parts])
    if not len(odd):
        return []
    noise = around / float(np.linalg.norm(weights))
    return [
        Cluster(one + SIDE, float(np.max(noise[np.searchsorted(edges, one, "right") - 1])))
        for one in np.split(odd, np.flatnonzero(np.diff(odd) > SIDE) + 1)
        if not unknown[one + SIDE].any()
    ]
