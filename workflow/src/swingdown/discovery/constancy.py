"""Whether an effect is the same everywhere: its torque made to change with side, angle, speed and time, to first order.

What is fitted as one effect and is another like it has another size on one side than on the other, when fast or when slow,
early or late. Where letting it change so explains what remains, the name is doubted; and what is added beside it must do
better than such a change would.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import combinations
from typing import NamedTuple

import numpy as np

from ..arrays import Floats
from ..pendulum.effect import NATURAL_FREQUENCY, Effect
from ..pendulum.formula import evaluate
from .campaign import Noise
from .linear import Frame, explained

_SLOW = 0.03  # of the largest speed; slower, no exponent is told apart
_ALIKE = 1e-3  # of two changes: what tells them apart, over what they share
_STILL = 1e-3  # of its largest, below which the Wronskian of a motion that has died out tells nothing


@dataclass(frozen=True)
class Change:
    """One way for an effect not to be of one size: with what it changes, by how much of its size (RMS along the motion) and
    at most which standard error that has, and the squares (rad^2) that the change explains beyond the fit."""

    of: str
    change: float
    error: float
    squares: float


def changes(frame: Frame, effect: Effect, noise: Noise) -> list[Change]:
    """The ``Change``s of one of a fit's effects, with one shape or with two, that which explains most first; empty for one that
    is no torque of angle, speed and time alone, or of which there is nothing."""
    ways, found = list(_ways(frame, effect)), []
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
    for name in names:
        columns = [one.column for one in _ways(frame, frame.fit.model.catalogue[name])]
        for count in (1, 2):
            for some in combinations(columns, count):
                squares, freedom = explained(frame, np.column_stack(some))
                best = max(best, _evidence(frame, noise, squares) - freedom * penalty)
    return best


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


def _ways(frame: Frame, effect: Effect) -> Iterator[_Way]:
    torque = torque_along(frame, effect)
    if torque is None or not np.any(torque):
        return
    weight = torque**2 / np.sum(torque**2)
    for name, shape in _shapes(frame).items():
        centred = shape - float(weight @ shape)
        column = frame.outside(response(frame, (torque * centred)[:, np.newaxis]))[:, 0]
        if np.any(column):
            yield _Way(name, np.sqrt(weight) * centred, column)


def torque_along(frame: Frame, effect: Effect) -> Floats | None:
    """The torque (rad/s^2) of one of a fit's effects along the fitted motion, a value a sample; None for one that has a memory,
    inertia, or acts on the reading."""
    if effect.acts_on != "torque" or effect.states or effect.inertia:
        return None
    found = []
    for swing, one in zip(frame.swings, frame.fit.swings, strict=True):
        values = {p.symbol: one.model.values[p.name] for p in effect.parameters}
        since = swing.times - swing.times[0]
        values[NATURAL_FREQUENCY.symbol] = one.model.values[NATURAL_FREQUENCY.name]
        speed = np.gradient(one.angle, swing.times)
        torque = evaluate(
            effect.term,
            theta=one.angle,
            thetadot=speed,
            t=since,
            duration=one.model.record or float(since[-1]),
            **values,
        )
        found.append(np.broadcast_to(torque, since.shape))
    return np.concatenate(found)


def _shapes(frame: Frame) -> dict[str, Floats]:
    """With what an effect may change, a number of the order of 1 at each sample."""
    angle = frame.fit.angle
    series = list(zip(frame.fit.swings, frame.swings, strict=True))
    speed = np.concatenate([np.abs(np.gradient(one.angle, swing.times)) for one, swing in series])
    since = np.concatenate([(w.times - w.times[0]) / (w.times[-1] - w.times[0]) for w in frame.swings])
    x, v = angle / np.max(np.abs(angle)), speed / np.max(speed)
    # the logarithm is what a slightly other exponent of the speed makes of a torque
    return {"side": x, "angle": x**2, "speed": v, "slowness": np.log(v + _SLOW), "time": since}


def response(frame: Frame, torques: Floats) -> Floats:
    """What small torques (samples, any; rad/s^2) along the fitted motion do to the angles: an array as large.

    By variation of constants, with the fit's own sensitivities to angle and velocity of release as the two solutions of the
    equation of variation; their Wronskian falls as the damping has it (Abel), and what follows where the motion has died
    out is left at nothing.
    """
    found = np.zeros_like(torques)
    for k, (swing, rows) in enumerate(zip(frame.swings, frame.slices, strict=True)):
        first, second = (
            frame.slopes[
                rows,
                next(
                    i
                    for i, (name, of) in enumerate(zip(frame.names, frame.of, strict=True))
                    if name == wanted and of == k
                ),
            ]
            for wanted in ("release_angle", "release_velocity")
        )
        found[rows] = _varied(swing.times, first, second, torques[rows])
    return found


def _varied(times: Floats, first: Floats, second: Floats, torques: Floats) -> Floats:
    slopes = [np.gradient(one, times) for one in (first, second)]
    wronskian = first * slopes[1] - second * slopes[0]
    # at turning points dry friction makes them jump: the smooth course between is what counts
    size = np.abs(wronskian)
    live = size > _STILL * np.max(size)
    end = int(np.max(np.flatnonzero(live))) + 1 if live.any() else 0
    if end < 8:
        return np.zeros_like(torques)
    part = slice(0, end)
    at = np.linspace(-1, 1, end)
    course = np.log(np.maximum(size[part], _STILL * np.max(size)))
    kept = np.ones(end, dtype=bool)
    for _ in range(4):
        line = np.polynomial.Polynomial.fit(at[kept], course[kept], 3)
        off = course - line(at)
        kept = np.abs(off) <= 2.5 * 1.4826 * np.median(np.abs(off[kept])) + 1e-9
    smooth = np.exp(line(at))[:, np.newaxis]
    u1, u2 = first[part, np.newaxis], second[part, np.newaxis]
    one, other = (_summed(times[part], u * torques[part] / smooth) for u in (u1, u2))
    found = np.zeros_like(torques)
    found[part] = u2 * one - u1 * other
    return found


def _summed(times: Floats, series: Floats) -> Floats:
    """The integral from the first time on, by trapezoids."""
    steps = np.diff(times)[:, np.newaxis] * (series[1:] + series[:-1]) / 2
    return np.concatenate([np.zeros((1, series.shape[1])), np.cumsum(steps, axis=0)])
