"""What the envelope of the swings shows of what takes energy, without any model of what does not.

A torque over the angle takes nothing round a whole swing, and a zero, a gain or a bend of the sensor is the same at every turn: the amplitude
that is lost from swing to swing is the work of friction and drag alone. The everyday laws lose it as the amplitude's power 0, 1 and 2
(at large angles as they do round the ideal pendulum's orbit). Whether one of them is there is asked by how well the amplitudes are
followed with it and without, beside a drag that changes in time, which on one recording looks like any of them.
"""

from collections.abc import Collection, Sequence
from functools import cache
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from scipy.linalg import block_diag
from scipy.optimize import lsq_linear
from scipy.special import expit

from ...arrays import Floats
from ..data.campaign import Campaign, Swing
from .linear import orthonormal
from .losses import half_swings

# powers of the amplitude that are lost: by friction, viscous and quadratic drag
_LAWS = (0, 1, 2)
_VISCOUS = 1
_DRIFT = 3  # the loss by a viscous drag that grows in time
_LEAST = 4  # amplitudes of a swing that is looked at
_BROKEN = 1.5  # half-swings between two: what is longer begins anew
_NODES = 6  # amplitudes between which a loss of any law goes straight
_TURNS = 181  # at which an orbit is computed


class Stretch(NamedTuple):
    """Amplitudes (rad) of successive half-swings without a break, and what has been lost of each by each law of size one (amplitude, law), the
    last law a drag that grows in time."""

    sizes: Floats
    lost: Floats


class Amplitudes(NamedTuple):
    """The amplitudes of a campaign's swings."""

    fitted: tuple[Stretch, ...]
    held_out: tuple[Stretch, ...]


class Seen(NamedTuple):
    """What losses of some laws do for the envelope: the ``gain`` of the log-evidence with them (BIC), NaN where nothing can be told, and the
    ``share`` of the RMS that is left with them of what is left without, of fitted and of ``held_out`` swings."""

    gain: float
    share: float
    held_out: float

    @property
    def chance(self) -> float:
        """The probability that such a loss is there; NaN where nothing can be told."""
        return float(expit(self.gain))


NOT_SEEN = Seen(np.nan, np.inf, np.inf)


def amplitudes(campaign: Campaign, natural_frequency: float, restoring: str) -> Amplitudes:
    """The ``Amplitudes`` of a campaign's swings; none where a drive acts on them: what it gives is no loss."""
    swings = (*campaign.fit, *campaign.holdout)
    if any(one.drive is not None for one in swings):
        return Amplitudes((), ())
    # the parts of one recording go on in its time
    begin = min(one.times[0] for one in swings) if len(campaign.whole) == 1 else None
    longest = max(one.times[-1] - (one.times[0] if begin is None else begin) for one in swings)

    def of(one: Swing) -> list[Stretch]:
        table = half_swings(one.times, one.angle, natural_frequency, restoring, campaign.reading)
        when, sizes = table["time_s"].to_numpy(), table["amplitude_rad"].to_numpy()
        if when.size < _LEAST:
            return []
        apart = np.diff(when)
        edges = [0, *(np.flatnonzero(apart > _BROKEN * np.median(apart)) + 1), when.size]
        when = (when - (one.times[0] if begin is None else begin)) / longest
        return [_stretch(when[a:b], sizes[a:b], restoring) for a, b in pairwise(edges) if b - a >= _LEAST]

    fitted, held_out = (
        tuple(stretch for one in part for stretch in of(one)) for part in (campaign.fit, campaign.holdout)
    )
    return Amplitudes(fitted, held_out)


def seen(of: Amplitudes, laws: Collection[int]) -> Seen:
    """What losses as these powers of the amplitude do for the envelope, beside losses as the others."""
    count, free = sum(one.sizes.size for one in of.fitted), len(of.fitted) + len(_LAWS) + 1
    if count < 2 * free or not of.held_out:
        return NOT_SEEN
    losses, left = _followed(of.fitted)
    without, lacked = _followed(of.fitted, {*laws, *([_DRIFT] if _VISCOUS in laws else [])})
    memory = max(float(np.sum(left[1:] * left[:-1]) / np.sum(left**2)), 0.0)
    counts = (count - free) * (1 - memory) / (1 + memory)
    gain = 0.5 * counts * np.log(np.sum(lacked**2) / np.sum(left**2)) - 0.5 * len(laws) * np.log(count)
    held = [np.concatenate([_released(one, each) for one in of.held_out]) for each in (losses, without)]
    return Seen(float(gain), _ratio(of.fitted, left, lacked), _ratio(of.held_out, *held))


def _ratio(of: Sequence[Stretch], now: Floats, then: Floats) -> float:
    """The RMS that is left of amplitudes now over that of then, of both what a loss of any law could be: what comes and goes where the
    amplitude is the same is none."""
    space = orthonormal(np.hstack([_firsts(of), _of_any_law(of)]))
    free = now.size - space.shape[1]
    if free < 1:
        return np.inf

    def lost(one: Floats) -> float:
        within = space.T @ one
        return max(float(within @ within - space.shape[1] * (one @ one - within @ within) / free), 0.0)

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
        each = np.array([np.interp(middle, nodes, row) for row in np.eye(_NODES)])
        hats.append(np.concatenate([np.zeros((1, _NODES)), np.cumsum(each, axis=1).T]))
    return np.hstack([np.concatenate([one.lost for one in of]), np.concatenate(hats)])


def _followed(stretches: Sequence[Stretch], but: Collection[int] = ()) -> tuple[Floats, Floats]:
    """(the size of each law ``but`` these, by least squares; what is left of the amplitudes, rad)."""
    sizes, lost = (np.concatenate([one[k] for one in stretches]) for k in range(2))
    laws = [law for law in range(lost.shape[1]) if law not in but]
    columns = np.hstack([-lost[:, laws], _firsts(stretches)])
    scale = np.linalg.norm(columns, axis=0)
    low = np.full(columns.shape[1], -np.inf)
    low[[k for k, law in enumerate(laws) if law in _LAWS]] = 0.0
    values = lsq_linear(columns / scale, sizes, (low, np.inf)).x / scale
    found = np.zeros(lost.shape[1])
    found[laws] = values[: len(laws)]
    return found, columns @ values - sizes


def _released(one: Stretch, losses: Floats) -> Floats:
    """What is left of the amplitudes of a stretch of which only the first is fitted."""
    left = -one.lost @ losses - one.sizes
    return left - left.mean()


def _stretch(when: Floats, sizes: Floats, restoring: str) -> Stretch:
    """The ``Stretch`` of amplitudes at these times, what is lost between two being that at their mean."""
    each = _work((sizes[1:] + sizes[:-1]) / 2, restoring)
    steps = np.array([*each, each[_VISCOUS] * (when[1:] + when[:-1]) / 2])
    return Stretch(sizes, np.concatenate([np.zeros((1, len(steps))), np.cumsum(steps, axis=1).T]))


def _work(at: Floats, restoring: str) -> Floats:
    """What each law of size one loses of these amplitudes (rad) in half a swing (law, amplitude)."""
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
    work = np.array([np.trapezoid(speed**power * at[:, None] * np.cos(u), u, axis=1) for power in _LAWS])
    return at, work / np.sin(at)
