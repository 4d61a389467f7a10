"""What a friction and a restoring torque do to a half-swing: its loss, its duration, when it passes the middle.

In units in which the natural frequency of small swings is 1 rad/s: angles in rad, speeds in rad, torques over inertia in rad. Friction
is a function of the speed alone, d(v); a restoring torque that differs from the ideal one, f(θ) (1 + r(θ)), is the same on both sides.
"""

from collections.abc import Callable
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from ..arrays import Floats
from ..pendulum.half_swings import lengthening

_ANGLES = 32  # of Gauss and Legendre, from the middle to the turning point
_INNER = 12  # from an angle to the turning point
_NODES = 20  # of a curve over the logarithm of speed or angle
_STEPS = 60  # of a half-swing, by Runge and Kutta: it ends within 1e-7 of where it does
_BELOW = 4.0  # times below the smallest swing where that curve begins; a smaller one is flat


class Ideal(NamedTuple):
    """The ideal restoring torque: ``sine`` of a pendulum, ``linear`` of a spring."""

    restoring: str

    def torque(self, angle: Floats) -> Floats:
        """The torque over inertia (rad) at an angle (rad)."""
        return np.sin(angle) if self.restoring == "sine" else np.asarray(angle, dtype=float)

    def slope(self, angle: Floats) -> Floats:
        """What the torque grows by for each rad at an angle (rad)."""
        return np.cos(angle) if self.restoring == "sine" else np.ones_like(angle)

    def energy(self, angle: Floats) -> Floats:
        """The potential energy over inertia (rad²) at an angle (rad)."""
        if self.restoring == "sine":
            return 2 * np.sin(angle / 2) ** 2
        return np.asarray(angle, dtype=float) ** 2 / 2

    def lengthening(self, amplitude: Floats) -> Floats:
        """The period at an amplitude (rad) over that of small swings."""
        return lengthening(amplitude) if self.restoring == "sine" else np.ones_like(amplitude)

    def widest(self, amplitude: float) -> float:
        """An amplitude (rad) halfway from this one to where a pendulum no longer swings back; none is too wide for a spring."""
        return (amplitude + np.pi) / 2 if self.restoring == "sine" else np.inf

    def speed(self, amplitude: Floats) -> Floats:
        """The largest speed (rad) of a swing of this amplitude (rad)."""
        return np.sqrt(2 * self.energy(amplitude))


class Basis(NamedTuple):
    """Curves that a torque is a sum of: ``powers`` over ``scale``, each times the unknown share of a law, and between the ``nodes`` (logarithm
    of speed or angle) a curve of any shape, times the argument to the power ``besides``."""

    powers: tuple[int, ...]
    scale: float
    nodes: Floats
    besides: int

    def at(self, argument: Floats) -> Floats:
        """The curves' values (argument, curve)."""
        x = np.atleast_1d(np.asarray(argument, dtype=float))
        share = x / self.scale
        laws = [share**power for power in self.powers]
        with np.errstate(divide="ignore"):
            place = np.clip(np.log(x), self.nodes[0], self.nodes[-1])
        step = self.nodes[1] - self.nodes[0]
        hats = np.maximum(0.0, 1 - np.abs(place[:, np.newaxis] - self.nodes) / step)
        return np.column_stack([*laws, hats * (share**self.besides)[:, np.newaxis]])

    def summed(self, argument: Floats, weight: Floats) -> Floats:
        """Sums of the curves' values over the last axis of ``argument``, each with its ``weight`` (…, curve)."""
        share, count = argument / self.scale, self.nodes.size
        laws = [np.sum(weight * share**power, axis=-1) for power in self.powers]
        with np.errstate(divide="ignore"):
            place = np.clip(np.log(argument), self.nodes[0], self.nodes[-1])
        step = (place - self.nodes[0]) / (self.nodes[1] - self.nodes[0])
        before = np.minimum(step.astype(np.int64), count - 2)
        part, own = step - before, weight * share**self.besides
        leading = argument.shape[:-1]
        rows = np.arange(int(np.prod(leading))).reshape(*leading, 1) * count + before
        cells = count * int(np.prod(leading))
        hats = np.bincount(rows.ravel(), ((1 - part) * own).ravel(), cells)
        hats += np.bincount(rows.ravel() + 1, (part * own).ravel(), cells)
        return np.concatenate([np.stack(laws, axis=-1), hats.reshape(*leading, count)], axis=-1)


def friction(ideal: Ideal, amplitudes: Floats) -> Basis:
    """The ``Basis`` of a friction over speed for swings of these amplitudes (rad): constant, viscous, quadratic, and any other."""
    low, high = ideal.speed(np.array([amplitudes.min(), amplitudes.max()]))
    nodes = np.linspace(np.log(low / _BELOW), np.log(high * 1.05), _NODES)
    return Basis((0, 1, 2), float(np.sqrt(low * high)), nodes, 1)


def stiffness(amplitudes: Floats) -> Basis:
    """The ``Basis`` of the relative deviation of a restoring torque over angle: a constant, one that grows with the square, and any other."""
    low, high = float(amplitudes.min()), float(amplitudes.max())
    nodes = np.linspace(np.log(low / _BELOW), np.log(high * 1.05), _NODES)
    return Basis((0, 2), float(np.sqrt(low * high)), nodes, 0)


@lru_cache
def _gauss(size: int) -> tuple[Floats, Floats]:
    """Places from -1 to 1 and weights of Gauss and Legendre."""
    return np.polynomial.legendre.leggauss(size)


def _phases() -> tuple[Floats, Floats]:
    place, weight = _gauss(_ANGLES)
    return (place + 1) * np.pi / 4, weight * np.pi / 4


def losses(ideal: Ideal, basis: Basis, amplitudes: Floats) -> Floats:
    """What each curve of friction takes from the logarithm of the amplitude in a half-swing (amplitude, curve)."""
    return 2 * basis.summed(*_speeds(ideal, amplitudes)) / ideal.torque(amplitudes)[:, np.newaxis]


def lost(ideal: Ideal, drag: Callable[[Floats], Floats], amplitudes: Floats) -> Floats:
    """The same of the friction ``drag`` (rad) of a speed (rad)."""
    speed, weight = _speeds(ideal, amplitudes)
    return 2 * np.sum(weight * drag(speed), axis=1) / ideal.torque(amplitudes)


def _speeds(ideal: Ideal, amplitudes: Floats) -> tuple[Floats, Floats]:
    """Speeds (rad) from the middle to the turning point and their weights in the work over an angle (amplitude, place)."""
    phase, weight = _phases()
    angle = amplitudes[:, np.newaxis] * np.sin(phase)
    speed = np.sqrt(2 * np.maximum(ideal.energy(amplitudes)[:, np.newaxis] - ideal.energy(angle), 0.0))
    return speed, np.broadcast_to(weight * np.cos(phase), speed.shape)


def durations(ideal: Ideal, basis: Basis, amplitudes: Floats) -> Floats:
    """What each curve of stiffness does to the duration of a swing, as a share of the ideal one (amplitude, curve): to first order."""
    time, work = _works(ideal, basis, amplitudes)
    return -0.5 * np.einsum("aq,aqc->ac", time, work)


def beyond_durations(ideal: Ideal, basis: Basis, coefficients: Floats, amplitudes: Floats) -> Floats:
    """What the sum of the curves, with these coefficients, does to the duration beyond that (amplitude,)."""
    time, work = _works(ideal, basis, amplitudes)
    stiffer = np.maximum(work @ coefficients, -0.5)
    return np.sum(time * ((1 + stiffer) ** -0.5 - 1 + stiffer / 2), axis=1)


def _works(ideal: Ideal, basis: Basis, amplitudes: Floats) -> tuple[Floats, Floats]:
    """The share of a swing's time at each of some angles (amplitude, angle), and the work of each curve from there to the turning point, over
    that of the ideal torque (amplitude, angle, curve)."""
    phase, weight = _phases()
    angle = amplitudes[:, np.newaxis] * np.sin(phase)
    left = ideal.energy(amplitudes)[:, np.newaxis] - ideal.energy(angle)
    passed = amplitudes[:, np.newaxis] * np.cos(phase) / np.sqrt(2 * left) * weight  # time at each angle
    time = passed / passed.sum(axis=1, keepdims=True)
    # the work of each curve between the angle and the turning point, by Gauss and Legendre on every such stretch
    inner, share = _gauss(_INNER)
    stretch = (amplitudes[:, np.newaxis] - angle)[..., np.newaxis]
    place = angle[..., np.newaxis] + stretch * (inner + 1) / 2
    torque = ideal.torque(place) * share
    return time, basis.summed(place, torque) / torque.sum(axis=2)[..., np.newaxis]


class Swung(NamedTuple):
    """Half-swings from rest to rest by the middle amplitude (rad; the root of the product of both turning points): what each takes from the
    logarithm of the amplitude, how long it lasts, and when it passes the middle after its beginning (both in s times the frequency)."""

    amplitude: Floats
    loss: Floats
    duration: Floats
    passage: Floats


def swung(ideal: Ideal, drag: Callable[[Floats], Floats], amplitudes: Floats) -> Swung:
    """Half-swings under the ideal torque and the friction ``drag`` (rad) of a speed (rad), begun at ``amplitudes`` (rad): to all orders.

    Runge and Kutta's method, all amplitudes side by side; within a half-swing friction does not change its side.
    """
    half = np.pi * ideal.lengthening(amplitudes)
    step = half / _STEPS
    angle, speed = -amplitudes, np.zeros_like(amplitudes)

    def pull(at: Floats, fast: Floats) -> Floats:
        return -ideal.torque(at) - drag(np.abs(fast))

    passage, duration, reached = (np.full(amplitudes.size, np.nan) for _ in range(3))
    for k in range(int(1.3 * _STEPS)):
        a1 = pull(angle, speed)
        v2 = speed + step / 2 * a1
        a2 = pull(angle + step / 2 * speed, v2)
        v3 = speed + step / 2 * a2
        a3 = pull(angle + step / 2 * v2, v3)
        v4 = speed + step * a3
        a4 = pull(angle + step * v3, v4)
        next_angle = angle + step / 6 * (speed + 2 * v2 + 2 * v3 + v4)
        next_speed = speed + step / 6 * (a1 + 2 * a2 + 2 * a3 + a4)
        through = np.isnan(passage) & (angle < 0) & (next_angle >= 0)
        turned = np.isnan(duration) & (k > 0) & (speed > 0) & (next_speed <= 0)
        if through.any():
            part = _zero(angle, next_angle, speed * step, next_speed * step)
            passage = np.where(through, (k + part) * step, passage)
        if turned.any():
            part = _zero(speed, next_speed, a1 * step, pull(next_angle, next_speed) * step)
            duration = np.where(turned, (k + part) * step, duration)
            there = _hermite(angle, next_angle, speed * step, next_speed * step, part)
            reached = np.where(turned, there, reached)
        if np.isfinite(duration).all():
            break
        angle, speed = next_angle, next_speed
    with np.errstate(invalid="ignore", divide="ignore"):
        return Swung(np.sqrt(amplitudes * reached), np.log(amplitudes / reached), duration, passage)


def _hermite(begin: Floats, end: Floats, rise: Floats, rise_after: Floats, part: Floats) -> Floats:
    """The cubic between two values with these slopes over the step, at a part of it."""
    rest = 1 - part
    near = rest**2 * ((1 + 2 * part) * begin + part * rise)
    return near + part**2 * ((1 + 2 * rest) * end - rest * rise_after)


def _zero(begin: Floats, end: Floats, rise: Floats, rise_after: Floats) -> Floats:
    """The part of the step at which that cubic is zero, of those that change sign."""
    low, high = np.zeros_like(begin), np.ones_like(begin)
    for _ in range(40):
        middle = (low + high) / 2
        before = np.sign(_hermite(begin, end, rise, rise_after, middle)) == np.sign(begin)
        low, high = np.where(before, middle, low), np.where(before, high, middle)
    return (low + high) / 2
