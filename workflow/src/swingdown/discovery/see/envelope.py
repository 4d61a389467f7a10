"""What the envelope of the swings shows of what takes energy, without any model of what does not.

A torque over the angle takes nothing round a whole swing, and a zero, a gain or a bend of the sensor is the same at every turn: the amplitude
that is lost from swing to swing is the work of friction and drag alone. The everyday laws lose it as the amplitude's power 0, 1 and 2
(at large angles as they do round the ideal pendulum's orbit). Whether one of them is there is asked by how well the amplitudes are
followed with it and without, beside what may look like it: a drag that changes in time, as any of them on one recording, and under a
weight a friction that goes with the load, which takes more of a larger swing.
"""

from collections.abc import Collection, Sequence
from functools import cache
from itertools import combinations, pairwise
from typing import NamedTuple

import numpy as np
from scipy.linalg import block_diag
from scipy.optimize import lsq_linear
from scipy.special import expit, softmax

from ...arrays import Bools, Floats
from ...pendulum.half_swings import steps_between
from ..criterion import USUAL
from ..data.campaign import Campaign, Swing
from .linear import orthonormal
from .losses import half_swings

# powers of the amplitude that are lost: by friction, viscous and quadratic drag
_LAWS = (0, 1, 2)
_FRICTION, _VISCOUS = 0, 1
# the losses by a viscous drag that grows in time, and by a friction that goes with the load: there are none without these laws
_DRIFT, _LOAD = 3, 4
_LEAST = 3  # amplitudes of a stretch that is looked at
_BROKEN = 4  # half-swings between two: what is longer begins anew
_NODES = 6  # amplitudes between which a loss of any law goes straight
_TURNS = 181  # at which an orbit is computed


class Stretch(NamedTuple):
    """Amplitudes (rad) of successive half-swings, what has been lost of each by each law of size one (amplitude, law), the last laws a drag
    that grows in time and a friction that goes with the load; how many half-swings there are from each to the next, and which are
    ``fitted``."""

    sizes: Floats
    lost: Floats
    steps: Floats
    fitted: Bools


class Seen(NamedTuple):
    """What losses of some laws do for the envelope: the ``gain`` of the log-evidence with them (BIC), NaN where nothing can be told, the
    ``share`` of the RMS that is left with them of what is left without, of fitted and of ``held_out`` amplitudes, and those of the
    ``laws`` that may be the one that is there."""

    gain: float
    share: float
    held_out: float
    laws: frozenset[int] = frozenset()

    @property
    def chance(self) -> float:
        """The probability that such a loss is there; NaN where nothing can be told."""
        return float(expit(self.gain))


NOT_SEEN = Seen(np.nan, np.inf, np.inf)


def amplitudes(campaign: Campaign, natural_frequency: float, restoring: str) -> tuple[Stretch, ...]:
    """The amplitudes of a campaign's swings, which in one recording go on from part to part, from turns or from whole half-swings, whichever
    err less beside all laws; none where a drive acts on them: what it gives is no loss."""
    if any(one.drive is not None for one in (*campaign.fit, *campaign.holdout)):
        return ()
    found = [_told(campaign, natural_frequency, restoring, sine) for sine in (False, True)]
    return min(found, key=_errs)


def _told(campaign: Campaign, natural_frequency: float, restoring: str, sine: bool) -> tuple[Stretch, ...]:
    """The same, from whole half-swings or not."""
    swings = (*campaign.fit, *campaign.holdout)

    def of(one: Swing) -> Floats:
        table = half_swings(one.times, one.angle, natural_frequency, restoring, campaign.reading, sine)
        return table[["time_s", "amplitude_rad"]].to_numpy()

    found = [(of(one), one.times[0]) for one in swings]
    fitted = [np.full(len(rows), k < len(campaign.fit)) for k, (rows, _) in enumerate(found)]
    if len(campaign.whole) == 1:
        whole = campaign.whole[0]
        rows = _with_those_between([rows for rows, _ in found], of(whole))
        found = [(rows, whole.times[0])]
        fitted = [_within(rows[:, 0], campaign.fit)]
    longest = max(one.times[-1] - one.times[0] for one in campaign.whole or swings)
    return tuple(
        _stretch((rows[a:b, 0] - begin) / longest, rows[a:b, 1], steps[a : b - 1], of_fit[a:b], restoring)
        for (rows, begin), of_fit in zip(found, fitted, strict=True)
        for steps in [steps_between(np.diff(rows[:, 0]))]
        for a, b in pairwise([0, *(np.flatnonzero(steps > _BROKEN) + 1), len(rows)])
        if b - a >= _LEAST
    )


def _with_those_between(parts: Sequence[Floats], whole: Floats) -> Floats:
    """The half-swings (half-swing, time and amplitude) of a recording's parts, each to where its own noise hides them, and those of the
    ``whole`` across the cuts."""
    rows = np.concatenate(parts)
    if len(whole) > 1:
        near = 0.5 * np.median(np.diff(whole[:, 0]))
        apart = np.abs(whole[:, :1] - rows[:, 0]).min(axis=1, initial=np.inf)
        rows = np.concatenate([rows, whole[apart > near]])
    return rows[np.argsort(rows[:, 0])]


def _within(times: Floats, swings: Sequence[Swing]) -> Bools:
    """Which times are within one of these swings."""
    return np.any([(one.times[0] <= times) & (times <= one.times[-1]) for one in swings], axis=0)


def seen(of: Sequence[Stretch], laws: Collection[int], possible: float = USUAL.possible) -> Seen:
    """What losses as these powers of the amplitude do for the envelope, beside losses as the others. A law is none of theirs below
    this probability."""
    fitted = np.concatenate([one.fitted for one in of]) if of else np.zeros(0, bool)
    count, free = int(np.count_nonzero(fitted)), _free(of)
    if count <= free or fitted.all():
        return NOT_SEEN
    left, lacked = _left(of, ()), _left(of, laws)
    now = left[fitted]
    alike = _alike(now)
    counts = (count - free) / alike

    def evidence(without: Collection[int]) -> float:
        """The logarithm of that of all laws but these, against all."""
        more = np.sum(_left(of, without)[fitted] ** 2) / np.sum(now**2)
        return float(0.5 * len(without) * np.log(count) - 0.5 * counts * np.log(more))

    some = [gone for k in range(len(laws)) for gone in combinations(sorted(laws), k)]
    chances = softmax([evidence(gone) for gone in some])
    there = {law: sum(p for p, gone in zip(chances, some, strict=True) if law not in gone) for law in laws}
    may_be = frozenset(law for law, chance in there.items() if chance >= possible)
    of_loss = np.hstack([_firsts(of), _of_any_law(of)])
    share, held_out = (
        _ratio(of_loss[which], left[which], lacked[which], alike) for which in (fitted, ~fitted)
    )
    return Seen(-evidence(laws), share, held_out, may_be)


def _free(of: Sequence[Stretch]) -> int:
    """How many values are fitted to amplitudes."""
    return sum(bool(one.fitted.any()) for one in of) + (of[0].lost.shape[1] if of else 0)


def _errs(of: Sequence[Stretch]) -> float:
    """The RMS by which amplitudes err beside all laws, if what errs as one counts once; infinite where nothing tells."""
    fitted = np.concatenate([one.fitted for one in of]) if of else np.zeros(0, bool)
    if np.count_nonzero(fitted) <= _free(of):
        return np.inf
    now = _left(of, ())[fitted]
    return float(np.sqrt(np.mean(now**2) * _alike(now)))


def _alike(left: Floats) -> float:
    """How many amplitudes err as one, by what is left of them: so much more of their noise is slow."""
    memory = max(float(np.sum(left[1:] * left[:-1]) / np.sum(left**2)), 0.0)
    return (1 + memory) / (1 - memory)


def _ratio(of_loss: Floats, now: Floats, then: Floats, alike: float) -> float:
    """The RMS that is left of amplitudes now over that of then, of both what a loss could be (amplitude, loss): what comes and goes where
    the amplitude is the same is none, nor what noise of which so many err ``alike`` does."""
    space = orthonormal(of_loss)
    free = now.size - space.shape[1]

    def lost(one: Floats) -> float:
        within = space.T @ one
        noise = alike * (one @ one - within @ within) / free if free else 0.0
        return max(float(within @ within - space.shape[1] * noise), 0.0)

    left, lacked = lost(now), lost(then)
    return float(np.sqrt(left / lacked)) if lacked > 0 else np.inf


def _firsts(of: Sequence[Stretch]) -> Floats:
    """A one for the amplitudes of each stretch (amplitude, stretch)."""
    return np.asarray(block_diag(*(np.ones((one.sizes.size, 1)) for one in of)))


def _of_any_law(of: Sequence[Stretch]) -> Floats:
    """What has been lost by each law, and by what takes energy near each of some amplitudes alone (amplitude, law)."""
    sizes = np.concatenate([one.sizes for one in of])
    nodes = np.quantile(sizes, np.linspace(0, 1, _NODES))
    hats = []
    for one in of:
        middle = (one.sizes[1:] + one.sizes[:-1]) / 2
        each = one.steps * np.array([np.interp(middle, nodes, row) for row in np.eye(_NODES)])
        hats.append(np.concatenate([np.zeros((1, _NODES)), np.cumsum(each, axis=1).T]))
    return np.hstack([np.concatenate([one.lost for one in of]), np.concatenate(hats)])


def _left(of: Sequence[Stretch], but: Collection[int]) -> Floats:
    """What all laws ``but`` these leave of the amplitudes (rad), their sizes fitted by least squares; of a stretch that is held out only
    the mean is. Without viscous drag none grows in time, without friction none goes with the load."""
    sizes, lost = np.concatenate([one.sizes for one in of]), np.concatenate([one.lost for one in of])
    fitted = np.concatenate([one.fitted for one in of])
    gone = {*but, *([_DRIFT] if _VISCOUS in but else []), *([_LOAD] if _FRICTION in but else [])}
    laws = [law for law in range(lost.shape[1]) if law not in gone]
    known = [bool(one.fitted.any()) for one in of]
    columns = np.hstack([-lost[:, laws], _firsts(of)[:, known]])
    scale = np.linalg.norm(columns[fitted], axis=0)
    low = np.full(columns.shape[1], -np.inf)
    low[[k for k, law in enumerate(laws) if law != _DRIFT]] = 0.0
    largest = sizes.max()  # its search ends by how little is left, in what unit whatever
    values = lsq_linear(columns[fitted] / scale, sizes[fitted] / largest, (low, np.inf)).x * largest / scale
    left = columns @ values - sizes
    edges = np.cumsum([0, *(one.sizes.size for one in of)])
    for (a, b), with_fit in zip(pairwise(edges), known, strict=True):
        if not with_fit:
            left[a:b] -= left[a:b].mean()
    return left


def _stretch(when: Floats, sizes: Floats, steps: Floats, fitted: Bools, restoring: str) -> Stretch:
    """The ``Stretch`` of amplitudes at these times, what is lost in each half-swing between two being that at their mean."""
    each = _work((sizes[1:] + sizes[:-1]) / 2, restoring)
    drift = each[_VISCOUS] * (when[1:] + when[:-1]) / 2
    losses = steps * np.insert(each, _DRIFT, drift, axis=0)
    return Stretch(
        sizes, np.concatenate([np.zeros((1, len(losses))), np.cumsum(losses, axis=1).T]), steps, fitted
    )


def _work(at: Floats, restoring: str) -> Floats:
    """What each law of size one, but the drift, loses of these amplitudes (rad) in half a swing (law, amplitude)."""
    if restoring == "linear":
        return np.array([2 * np.ones_like(at), 0.5 * np.pi * at, 4 / 3 * at**2])
    known, lost = _round_the_orbit()
    return np.array([np.interp(at, known, law) for law in lost])


@cache
def _round_the_orbit() -> tuple[Floats, Floats]:
    """Amplitudes (rad) of a weight, and what each law loses of each."""
    at = np.linspace(1e-3, np.pi - 1e-3, 1000)
    # theta = A sin u takes the root's ends away
    u = np.linspace(-np.pi / 2, np.pi / 2, _TURNS)
    theta = at[:, None] * np.sin(u)
    speed = np.sqrt(np.maximum(2 * (np.cos(theta) - np.cos(at)[:, None]), 0.0))
    torques = [*(speed**power for power in _LAWS), np.cos(theta) + speed**2]
    work = np.array([np.trapezoid(torque * at[:, None] * np.cos(u), u, axis=1) for torque in torques])
    return at, work / np.sin(at)
