"""Whether an effect is the same everywhere, and of the form that it is said to be, to first order.

What is fitted as one effect and is another like it has another size on one side than on the other, when fast or when slow,
early or late: its torque is let change so. Or a torque of the same kind and of a general form remains beside it: over the
angle beside what depends on the angle, a friction or a drag from place to place beside what damps. Where one of these
explains what remains, the name is doubted; and what is added beside an effect must do better than such a change would.
"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import NamedTuple

import numpy as np

from ..arrays import Floats
from ..pendulum.effect import NATURAL_FREQUENCY, Effect
from ..pendulum.formula import evaluate
from ..pendulum.model import Model
from .campaign import Noise
from .green import Motion, hats, motions_of, responses
from .linear import Frame, explained, orthonormal

_SLOW = 0.03  # of the largest speed; slower, no exponent is told apart
_ALIKE = 1e-3  # of two changes: what tells them apart, over what they share
_PIECES = 8  # of a torque of a general form, over the angle or the speed
_DETERMINED = 0.05  # of a piece's work: what less of it is left beyond the fit says nothing of its size


@dataclass(frozen=True)
class Change:
    """One way for an effect not to be of one size: with what it changes, by how much of its size (RMS along the motion) and
    at most which standard error that has, and the squares (rad^2) that the change explains beyond the fit."""

    of: str
    change: float
    error: float
    squares: float


@dataclass(frozen=True)
class Form:
    """A torque of a general form beside an effect: over what, its size (RMS along the motion) over the effect's own, and the
    squares (rad^2) that it explains beyond the fit."""

    over: str
    size: float
    squares: float


def changes(frame: Frame, effect: Effect, noise: Noise) -> list[Change]:
    """The ``Change``s of one of a fit's effects, with one shape or with two, that which explains most first; empty for one that
    is no torque of angle, speed and time alone, or of which there is nothing."""
    ways, found = list(_ways(frame, motions_of(frame), effect)), []
    for count in (1, 2):
        for some in combinations(ways, count):
            columns = np.column_stack([one.column for one in some])
            left, size, right = np.linalg.svd(columns, full_matrices=False)
            if size[-1] <= _ALIKE * size[0]:
                continue
            inverse = (right.T / size) @ left.T
            squares = float(np.sum((left.T @ frame.residual) ** 2))
            shapes = np.column_stack([one.shape for one in some])
            # how much it changes along the motion, where its torque is large
            spread = np.linalg.qr(shapes, mode="r")
            change = spread @ (inverse @ frame.residual)
            error = float(np.sqrt(noise.slow_variance) * np.linalg.norm(spread @ inverse, 2))
            found.append(
                Change(" and ".join(one.of for one in some), float(np.linalg.norm(change)), error, squares)
            )
    return sorted(found, key=lambda one: -one.squares)


def by_changing(frame: Frame, noise: Noise, names: Iterable[str]) -> float:
    """The evidence (as a difference of BIC, to first order) that is gained most by letting one of these effects change, with one
    shape or with two; 0 where nothing is gained."""
    best, penalty = 0.0, float(np.log(noise.effective(frame.samples)))
    names = list(names)
    motions = motions_of(frame) if names else []
    for name in names:
        columns = [one.column for one in _ways(frame, motions, frame.fit.model.catalogue[name])]
        for count in (1, 2):
            for some in combinations(columns, count):
                squares, freedom = explained(frame, np.column_stack(some))
                best = max(best, _evidence(frame, noise, squares) - freedom * penalty)
    return best


def forms(frame: Frame, effect: Effect) -> list[Form]:
    """The ``Form``s of a torque of the effect's kind that may remain beside it, that which explains most first; empty as ``changes`` is.

    Beside what depends on the angle alone one over the angle; beside what depends on the velocity one over the speed, a
    friction and a drag from place to place.
    """
    motions = motions_of(frame)
    torques = torques_along(frame, motions, effect)
    if torques is None or not any(np.any(one) for one in torques):
        return []
    largest = max(float(np.max(np.abs(one.angle))) for one in motions)
    fastest = max(float(np.max(np.abs(one.speed))) for one in motions)
    own, found = _rms(torques), []
    for over, shape in _FORMS.items():
        if (over == "the angle") == ("thetadot" in effect.term):
            continue
        pieces = [shape(one.angle / largest, one.speed / fastest) for one in motions]
        columns = responses(motions, pieces)
        work = np.linalg.norm(columns, axis=0)
        work[work == 0] = 1.0
        left, size, right = np.linalg.svd(frame.outside(columns) / work, full_matrices=False)
        seen = size > _DETERMINED
        along = left[:, seen].T @ frame.residual
        values = (right[seen].T / size[seen]) @ along / work
        found.append(Form(over, _rms([one @ values for one in pieces]) / own, float(along @ along)))
    return sorted(found, key=lambda one: -one.squares)


def _over_angle(x: Floats) -> Floats:
    return hats(x, np.linspace(-1, 1, _PIECES))


# by what they are over: a column for each piece, of angle and speed over their largest values
_FORMS: dict[str, Callable[[Floats, Floats], Floats]] = {
    "the angle": lambda x, v: _over_angle(x),
    "the speed": lambda x, v: np.sign(v)[:, np.newaxis] * hats(np.abs(v), np.linspace(0, 1, _PIECES)),
    "the place, as friction": lambda x, v: np.sign(v)[:, np.newaxis] * _over_angle(x),
    "the place, as drag": lambda x, v: v[:, np.newaxis] * _over_angle(x),
}


def _rms(torques: Sequence[Floats]) -> float:
    return float(np.sqrt(np.mean(np.concatenate(torques) ** 2)))


def _evidence(frame: Frame, noise: Noise, squares: float) -> float:
    """n effective ln(rss before / rss after)."""
    before = float(np.sum(frame.residual**2))
    return float(noise.effective(frame.samples) * np.log(before / max(before - squares, 1e-300)))


class _Way(NamedTuple):
    """With what an effect may change, the shape of that (its mean square along the motion, weighed by the torque's, is the square
    of its length), and what the change does to the angles beyond the fit."""

    of: str
    shape: Floats
    column: Floats


def _ways(frame: Frame, motions: Sequence[Motion], effect: Effect) -> Iterator[_Way]:
    torques = torques_along(frame, motions, effect)
    if torques is None or not any(np.any(one) for one in torques):
        return
    joined = np.concatenate(torques)
    weight = joined**2 / np.sum(joined**2)
    ends = np.cumsum([one.times.size for one in motions])[:-1]
    pushed = _pushed(frame, motions)
    for name, shape in _shapes(motions).items():
        centred = shape - float(weight @ shape)
        moved = [one[:, np.newaxis] for one in np.split(joined * centred, ends)]
        column = frame.outside(responses(motions, moved))[:, 0]
        if name == "direction":
            column = column - pushed @ (pushed.T @ column)
        if np.any(column):
            yield _Way(name, np.sqrt(weight) * centred, column)


def _pushed(frame: Frame, motions: Sequence[Motion]) -> Floats:
    """What a constant torque and a sensor's zero do beyond the fit, orthonormal: all that moves the middle imitates in part a drag that
    is stronger one way than the other."""
    torque = responses(motions, [np.ones((one.times.size, 1)) for one in motions])
    whole = np.hstack([torque, np.ones_like(torque)])
    both = frame.outside(whole)
    work = np.linalg.norm(both, axis=0)
    kept = work > _DETERMINED * np.linalg.norm(whole, axis=0)
    return orthonormal(both[:, kept] / work[kept]) if kept.any() else np.zeros((both.shape[0], 0))


def torques_along(frame: Frame, motions: Sequence[Motion], effect: Effect) -> list[Floats] | None:
    """The torque (rad/s^2) of one of a fit's effects along each swing's motion; None for one that has a memory, inertia, or acts
    on the reading."""
    if effect.acts_on != "torque" or effect.states or effect.inertia:
        return None
    pairs = zip(motions, frame.fit.swings, strict=True)
    return [_torque_along(motion, effect, swing.model) for motion, swing in pairs]


def _torque_along(motion: Motion, effect: Effect, model: Model) -> Floats:
    values = {p.symbol: model.values[p.name] for p in effect.parameters}
    values[NATURAL_FREQUENCY.symbol] = model.values[NATURAL_FREQUENCY.name]
    since = motion.times - motion.times[0]
    duration = model.record or float(since[-1])
    torque = evaluate(
        effect.term, theta=motion.angle, thetadot=motion.speed, t=since, duration=duration, **values
    )
    return np.broadcast_to(torque, since.shape)


def _shapes(motions: Sequence[Motion]) -> dict[str, Floats]:
    """With what an effect may change, a number of the order of 1 at each time of the grid."""
    angle, velocity = (np.concatenate([getattr(one, what) for one in motions]) for what in ("angle", "speed"))
    since = np.concatenate([(one.times - one.times[0]) / (one.times[-1] - one.times[0]) for one in motions])
    x, v = angle / np.max(np.abs(angle)), np.abs(velocity) / np.max(np.abs(velocity))
    # the logarithm is what a slightly other exponent of the speed makes of a torque
    return {
        "side": x,
        "direction": np.sign(velocity),
        "angle": x**2,
        "speed": v,
        "slowness": np.log(v + _SLOW),
        "time": since,
    }
