"""Effects that a study brings of its own: a torque written as a formula in the settings, with its parameters."""

import re
from collections.abc import Mapping
from keyword import iskeyword
from math import inf
from typing import Any

from ..errors import InputError
from . import formula
from .effect import VARIABLES, Effect, Parameter

_NAME = re.compile(r"[a-z][a-z0-9_]*")
_SYMBOL = re.compile(r"[A-Za-z][A-Za-z0-9_]*")


def own_effects(entries: Mapping[str, Any], where: str = "config, key effects") -> tuple[Effect, ...]:
    """The effects of the settings' key ``effects``, in their order.

    Parameters
    ----------
    entries
        By name: ``torque`` (rad/s^2, in theta, thetadot, t, duration, omega_n and the parameters' symbols), ``parameters`` and
        ``explanation``. A parameter has a ``unit`` and may have ``lower``, ``upper``, ``typical`` and ``start``.
    where
        What errors call it.

    Raises
    ------
    InputError
        For a formula that is not whitelisted arithmetic, a symbol that it does not use, and a missing ``start``.
    """
    return tuple(_effect(name, entry, f"{where}.{name}") for name, entry in entries.items())


def _effect(name: str, entry: Mapping[str, Any], where: str) -> Effect:
    if not _NAME.fullmatch(name):
        problem = f"{name!r} is no name of an effect"
        raise InputError(where, problem, "small letters, digits and _", "rename it")
    parameters = tuple(
        _parameter(name, symbol, one or {}, where) for symbol, one in entry.get("parameters", {}).items()
    )
    explanation = entry.get("explanation", "An effect of this study's own.")
    found = Effect(name, entry["torque"], parameters, explanation, "this study's settings")
    _check_formula(found, where)
    return found


def _parameter(effect: str, symbol: str, entry: Mapping[str, Any], where: str) -> Parameter:
    place = f"{where}.parameters.{symbol}"
    taken = iskeyword(symbol) or symbol in formula.FUNCTIONS or symbol == "pi"
    if not _SYMBOL.fullmatch(symbol) or symbol in VARIABLES or taken:
        problem = "is a variable of every formula" if symbol in VARIABLES else "is no symbol"
        problem = "has a meaning of its own in formulas" if taken else problem
        raise InputError(place, f"{symbol!r} {problem}", "a letter, then letters, digits and _", "rename it")
    lower, upper = entry.get("lower", -inf), entry.get("upper", inf)
    starts = tuple(map(float, entry.get("start", ())))
    if not lower < upper:
        problem = f"the bounds {lower:g} and {upper:g} leave nothing between them"
        raise InputError(place, problem, "lower below upper")
    if outside := [value for value in starts if not lower <= value <= upper]:
        raise InputError(f"{place}.start", f"{outside[0]:g} is outside the bounds", f"{lower:g} to {upper:g}")
    typical = entry.get("typical", abs(starts[0]) if starts and starts[0] else 1.0)
    return Parameter(
        f"{effect}_{symbol}", symbol, entry.get("unit", "1"), float(lower), float(upper), "", float(typical),
        role="shape" if starts else "size", starts=starts, firm=True,
    )  # fmt: skip


def _check_formula(effect: Effect, where: str) -> None:
    torque = effect.expressions().motion["torque"]
    if not effect.parameters:
        raise InputError(f"{where}.parameters", "it has no parameter", "at least one, such as its size")
    for parameter in effect.parameters:
        at, place = formula.symbol(parameter.symbol), f"{where}.parameters.{parameter.symbol}"
        if not torque.has(at):
            problem = "the torque does not use it"
            raise InputError(place, problem, f"only what is in {effect.term!r}", "remove it")
        if parameter.role == "size" and torque.diff(at).has(at):
            raise InputError(place, "the torque is not linear in it", "values to start fits from",
                             "add a key `start` with a few")  # fmt: skip
    if effect.size is None:
        raise InputError(f"{where}.parameters", "all parameters have values to start from", "a parameter in which the torque is linear, such as its size",
                         "leave `start` out for the parameter to which the torque is in proportion")  # fmt: skip
