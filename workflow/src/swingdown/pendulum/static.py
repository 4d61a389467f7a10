"""What a model does at rest, and where it hangs: its torques by formula, without the engine."""

from collections.abc import Callable

import numpy as np

from ..arrays import Floats
from .effect import NATURAL_FREQUENCY
from .formula import evaluate, names_in
from .model import Model

_NEAR = 1e-4  # rad
_SLOW = 1e-9  # rad/s


def static(model: Model) -> Callable[[Floats], Floats]:
    """The torque over inertia (rad/s²) of a model at rest at an angle (rad), its friction left out."""
    torque = _torque(model)

    def at(angle: Floats) -> Floats:
        slow = np.full_like(angle, _SLOW)  # at none a low power of the speed has no value
        with np.errstate(invalid="ignore"):
            return (torque(angle, slow) + torque(angle, -slow)) / 2

    return at


def drag(model: Model) -> Callable[[Floats], Floats]:
    """The friction over inertia (rad/s²) of a model at a speed (rad/s) where it is a function of that alone, at none that of the slowest; zero
    where an angle or a state is in it."""
    torque = _torque(model)
    alone = not any(one.states or {"theta", "thetadot"} <= names_in(one.term) for one in model.effects)

    def at(speed: Floats) -> Floats:
        if not alone:
            return np.zeros_like(speed)
        fast, middle = np.maximum(speed, _SLOW), np.zeros_like(speed)
        return (torque(middle, -fast) - torque(middle, fast)) / 2

    return at


def _torque(model: Model) -> Callable[[Floats, Floats], Floats]:
    given = {"thetaddot": 0.0, "t": 0.0, "duration": 1.0}
    given |= {"omega_n": model.values[NATURAL_FREQUENCY.name]}
    given |= {one.symbol: model.values[one.name] for one in model.definitions}
    given |= {state.symbol: 0.0 for effect in model.effects for state in effect.states}
    terms = [model.gravity.term, *(effect.term for effect in model.effects if effect.acts_on == "torque")]

    def torque(angle: Floats, speed: Floats) -> Floats:
        with np.errstate(all="ignore"):  # of values that no pendulum has
            each = [evaluate(term, theta=angle, thetadot=speed, **given) for term in terms]
            return np.sum(np.broadcast_arrays(angle, *each)[1:], axis=0)

    return torque


def resting(model: Model) -> float:
    """Where a model hangs (rad): the zero of its static torque beside 0."""
    torque = static(model)
    place = 0.0
    for _ in range(20):  # Newton's steps
        about = torque(np.array([place - _NEAR, place, place + _NEAR]))
        slope = (about[2] - about[0]) / (2 * _NEAR)
        if not slope < 0:
            return 0.0
        place -= float(about[1] / slope)
        if abs(about[1] / slope) < 1e-12:
            break
    return place if abs(place) < 1 else 0.0
