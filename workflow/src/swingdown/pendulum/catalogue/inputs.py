"""How a measured drive acts: no candidates of a search, for a model has the one that was measured, or none."""

from itertools import chain, combinations
from math import inf

from ..drive import FREE, KINDS, effect_name
from ..effect import Effect, Parameter
from .sources import MECHANICS

_TERMS = {
    "torque": ("{}input", "rad/s^2", "torque over inertia for one unit of the input", "A measured torque drives it."),
    "pivot_acceleration": (
        "-{}omega_n**2*cos(theta)*input", "1", "acceleration over what the sensor said",
        "Its pivot is shaken sideways, and the acceleration (in units of gravity) was measured.",
    ),
    "pivot_position": (
        "-{}omega_n**2*cos(theta)*input_curve/9.80665", "s^2", "displacement over what the sensor said",
        "Its pivot is moved sideways, and where it is (in m) was measured.",
    ),
    "pivot_angle": (
        "{}omega_n**2*input", "1", "angle of the spring's other end over what the sensor said",
        "A lever or motor turns the other end of its spring, and the angle was measured.",
    ),
}  # fmt: skip
_LATER = "by how much the drive acts later than it is stamped"
_DELAY = Parameter("input_delay", "tau_u", "s", -inf, inf, _LATER, 0.01, role="delay")


def _effect(kind: str, free: tuple[str, ...]) -> Effect:
    term, unit, text, explanation = _TERMS[kind]
    gain = Parameter(f"{kind}_gain", "g_u", unit, -inf, inf, text, 1.0)
    parameters = [gain] if "gain" in free else []
    if "delay" in free:
        parameters.append(_DELAY)
    term = term.format("g_u*" if "gain" in free else "")
    return Effect(effect_name(kind, free), term, tuple(parameters), explanation, MECHANICS)


_WHICH = tuple(chain.from_iterable(combinations(FREE, k) for k in range(len(FREE) + 1)))
INPUTS = tuple(_effect(kind, free) for kind in KINDS for free in _WHICH)
