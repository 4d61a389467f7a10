"""How the engine finds each state of an effect, and where an effect is narrow: told from the formulas (c/effect.h)."""

from typing import NamedTuple

import sympy

from ..pendulum.formula import symbol

_THETA, _VELOCITY, _ACCELERATION = symbol("theta"), symbol("thetadot"), symbol("thetaddot")
_TIME = symbol("t")


class StateMethod(NamedTuple):
    """A state's kind (``StateKind`` in c/effect.h), the state it is the integral of, and, of a state that is linear in
    itself, its coefficients: relaxation, drive and gain."""

    kind: str
    of: int
    coefficients: tuple = ()


def localisation(expression):
    """Where a formula can change all at once (``Localised`` in c/effect.h): 2 at some angle, 1 only at some velocity or
    time, 0 nowhere.

    Sums, whole powers, sines and cosines of what moves are smooth; anything else may be as narrow as its parameters say.
    """
    calls = expression.atoms(sympy.exp, sympy.log, sympy.tan, sympy.tanh, sympy.Pow)
    narrow = [
        call.free_symbols for call in calls if not (call.is_Pow and call.exp.is_Integer and call.exp > 0)
    ]
    if any(symbols & {_THETA, _ACCELERATION} for symbols in narrow):
        return 2
    return int(any(symbols & {_VELOCITY, _TIME} for symbols in narrow))


def state_methods(formulas, rates, states, switches):
    """The ``StateMethod`` of each state: ``rates`` with their signs frozen, ``states`` as symbols."""
    return [_method(k, formulas, rates, states, switches) for k in range(len(states))]


def _method(k, formulas, rates, states, switches):
    state, rate = states[k], rates[k]
    read = formulas.reading is not None and state in formulas.reading.free_symbols
    others = [*formulas.motion.values(), *switches, *rates[:k], *rates[k + 1 :]]
    fed_back = any(state in expression.free_symbols for expression in others)
    integrals = {one for one, its_rate in zip(states, rates, strict=True) if its_rate in states}
    integrated = [j for j, other in enumerate(states) if other == rate and other not in integrals]
    if integrated and not read:
        return StateMethod("INTEGRATED", integrated[0])
    if not fed_back and (coefficients := _lag(state, rate, states)):
        return StateMethod("LAG", k, coefficients)
    if not read and (coefficients := _rate_independent(state, rate, states)):
        return StateMethod("RATE_INDEPENDENT", k, coefficients)
    return StateMethod("COLLOCATED", k)


def _moving(states):
    return {_THETA, _VELOCITY, _ACCELERATION, _TIME, *states}


def _lag(state, rate, states):
    """The coefficients where z' = input - relaxation z with a constant relaxation and no other state in it."""
    relaxation = -sympy.expand(rate).diff(state)
    if relaxation == 0 or relaxation.free_symbols & _moving(states):
        return None
    if rate.free_symbols & (set(states) - {state}):
        return None
    gain = sympy.expand(rate).diff(_THETA)
    return relaxation, 0, 0 if gain.free_symbols & _moving(states) else gain


def _rate_independent(state, rate, states):
    """The coefficients where z' = (drive - relaxation z) theta' with constants for both."""
    by_angle = sympy.cancel(rate / _VELOCITY)
    relaxation = -sympy.expand(by_angle).diff(state)
    if relaxation == 0 or relaxation.has(state) or by_angle.free_symbols & (_moving(states) - {state}):
        return None
    return relaxation, sympy.simplify(by_angle + relaxation * state), 0
