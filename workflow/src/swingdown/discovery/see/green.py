"""What small torques do to the reading: Green's function of a fitted motion.

A torque f(s) that a model lacks moves its reading at t by G(t, s) f(s) ds. Green's function G follows from the two slopes
of the motion by its release, which span all small motions about it (variation of parameters): no torque needs an equation
of variation of its own. With states of memory (presliding, a flexible pivot) this holds as far as they follow the motion.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import cumulative_trapezoid

from ...arrays import Floats
from ...engine.trajectory import sensitivities
from ...fitting.problem import RELEASE
from ...pendulum.effect import NATURAL_FREQUENCY
from ...pendulum.model import Model
from ..data.campaign import Swing
from .linear import Frame

_FINE = 96  # points a period, at which torques act
_STUCK = 1e-9  # a Wronskian below it: the pendulum is held, and no torque moves it


class Motion(NamedTuple):
    """A fitted swing on a fine grid of times: times (s), angle (rad), speed (rad/s), what a unit of torque adds to the two
    release coordinates per second (2, time), the slopes of the reading by these at the samples (2, sample), and where on the grid
    the samples are."""

    times: Floats
    angle: Floats
    speed: Floats
    pull: Floats
    slopes: Floats
    at: NDArray[np.intp]


def motions_of(frame: Frame) -> list[Motion]:
    """The ``Motion`` of each of a frame's swings."""
    pairs = zip(frame.swings, frame.fit.swings, strict=True)
    return [motion(one.model, swing, one.release_angle, one.release_velocity) for swing, one in pairs]


def motion(model: Model, swing: Swing, angle: float, velocity: float) -> Motion:
    """The ``Motion`` of a swing from its release (rad, rad/s)."""
    samples = swing.times
    period = 2 * np.pi / model.values[NATURAL_FREQUENCY.name]
    interval = (samples[-1] - samples[0]) / (samples.size - 1)
    each = max(1, int(np.ceil(_FINE * interval / period)))
    at = np.arange(samples.size) * each
    times = np.interp(np.arange(at[-1] + 1), at, samples)
    course, slopes = sensitivities(model.motion, times, angle, velocity, free=RELEASE)
    speed, rates = np.gradient(course, times), np.gradient(slopes, times, axis=1)
    wronskian = slopes[0] * rates[1] - slopes[1] * rates[0]
    moving = np.abs(wronskian) > _STUCK
    pull = np.where(moving, np.array([-slopes[1], slopes[0]]) / np.where(moving, wronskian, 1.0), 0.0)
    read = sensitivities(model, samples, angle, velocity, free=RELEASE)[1]
    return Motion(times, course, speed, pull, read, at)


def reach(motions: Sequence[Motion]) -> tuple[float, float]:
    """The largest angle (rad) and speed (rad/s) of these motions."""
    largest = max(float(np.max(np.abs(one.angle))) for one in motions)
    return largest, max(float(np.max(np.abs(one.speed))) for one in motions)


def response(one: Motion, torques: Floats) -> Floats:
    """What torques (time of the grid, any), in rad/s^2, do to the reading at the samples (sample, any), to first order."""
    moved = [
        cumulative_trapezoid(pull[:, np.newaxis] * torques, one.times, axis=0, initial=0.0)[one.at]
        for pull in one.pull
    ]
    return one.slopes[0][:, np.newaxis] * moved[0] + one.slopes[1][:, np.newaxis] * moved[1]


def responses(motions: Sequence[Motion], torques: Sequence[Floats]) -> Floats:
    """The same for all swings, one below the other: ``torques`` holds an array (time of the grid, any) for each."""
    return np.concatenate([response(one, torque) for one, torque in zip(motions, torques, strict=True)])


def hats(x: Floats, nodes: Floats) -> Floats:
    """Linear interpolation between nodes as columns (place, node)."""
    return np.column_stack([np.interp(x, nodes, unit) for unit in np.eye(nodes.size)])


class Plane(NamedTuple):
    """Torques over angle and speed: the places of their nodes (rad, rad/s), and by recording what each is over time (sample, torque)."""

    angles: Floats
    speeds: Floats
    torques: list[Floats]


def plane(motions: Sequence[Motion], angles: int, speeds: int) -> Plane:
    """The ``Plane`` with so many nodes, as far as these motions reach."""
    largest, fastest = reach(motions)
    nodes = np.linspace(-1, 1, angles), np.linspace(0, 1, speeds)
    torques = [over_both(one.angle / largest, one.speed / fastest, *nodes) for one in motions]
    return Plane(largest * nodes[0], fastest * nodes[1], torques)


def over_both(angle: Floats, speed: Floats, angles: Floats, speeds: Floats) -> Floats:
    """Interpolation between nodes over the angle and over the speed's size as columns (place, node), for either direction its own: a friction
    jumps where the motion turns."""
    either, side = hats(np.abs(speed), speeds), (speed >= 0)[:, np.newaxis]
    sides = np.hstack([either * side, either * ~side])
    return np.einsum("ta,ts->tas", hats(angle, angles), sides).reshape(angle.size, -1)
