"""The equations of motion in Python: the catalogue's formulas with the signs frozen, as the compiled engine has them."""

from collections.abc import Callable, Sequence
from functools import lru_cache
from typing import Any, NamedTuple

from ..arrays import Floats
from ..pendulum.effect import Effect
from ..pendulum.model import Model

_LEAST_SPEED = 1e-300  # where a broken power of the speed would be no number


class _Terms(NamedTuple):
    """Functions of one effect: torque, inertia, states' rates and first values, arguments whose sign is frozen, reading.

    Each takes (theta, thetadot, thetaddot, t, duration, omega_n, direction, *parameters, *states, *signs).
    """

    torque: Callable | None
    inertia: Callable | None
    rates: tuple[Callable, ...]
    initial: tuple[Callable, ...]
    switches: tuple[Callable, ...]
    reading: Callable | None
    timed: bool


_VARIABLES = ("theta", "thetadot", "thetaddot", "t", "duration", "omega_n", "direction")


@lru_cache(maxsize=200)
def _terms(effect: Effect, form: str) -> _Terms:
    import sympy  # here: only what has no compiler needs it at a run

    from ..pendulum.formula import symbol
    from .generate import switches

    formulas = effect.expressions(form)
    found = switches(*formulas.motion.values(), *formulas.rates)
    speed, direction, velocity = symbol("speed"), symbol("direction"), symbol("thetadot")
    frozen = {velocity: direction} | {argument: symbol(f"sign_{k}") for k, argument in enumerate(found)}
    names = [*_VARIABLES, *(p.symbol for p in effect.parameters), *(state.symbol for state in effect.states)]
    arguments = [*map(symbol, names), *(symbol(f"sign_{k}") for k in range(len(found)))]

    def function(expression: Any, modules: str = "math") -> Callable:
        for argument, sign in frozen.items() if modules == "math" else ():
            expression = expression.subs({sympy.Abs(argument): sign * argument, sympy.sign(argument): sign})
        # past a reversal, where the direction is still frozen, a broken power of the speed is no number
        broken = sympy.Max(direction * velocity, _LEAST_SPEED)
        expression = expression.replace(
            lambda part: part.is_Pow and not part.exp.is_Integer and part.base == direction * velocity,
            lambda part: speed**part.exp,
        ).subs(sympy.log(direction * velocity), sympy.log(speed))
        return sympy.lambdify(arguments, expression.subs(speed, broken), modules, cse=True)

    motion, moving = formulas.motion, [*formulas.motion.values(), *formulas.rates]
    return _Terms(
        function(motion["torque"]) if "torque" in motion else None,
        function(motion["inertia"]) if "inertia" in motion else None,
        tuple(map(function, formulas.rates)),
        tuple(map(function, formulas.initial)),
        tuple(map(function, found)),
        None if formulas.reading is None else function(formulas.reading, "numpy"),
        any(symbol("t") in one.free_symbols for one in moving),
    )


class Part(NamedTuple):
    """An effect with its values: where its states and its frozen signs begin."""

    effect: Effect
    terms: _Terms
    values: tuple[float, ...]
    states: slice
    signs: slice


class Pendulum:
    """The equations of motion of a model at some values, with the signs frozen that ``direction`` and ``signs`` hold."""

    def __init__(self, model: Model, values: Sequence[float] | Floats, duration: float) -> None:
        self.omega, self.duration, self.direction = float(values[0]), duration, 0.0
        self.parts, at, state, sign = [], 1, 0, 0
        for effect in (model.gravity, *model.acting):
            form = model.form if effect.printed else "consistent"
            terms, size = _terms(effect, form), len(effect.parameters)
            states, signs = slice(state, state + len(effect.states)), slice(sign, sign + len(terms.switches))
            self.parts.append(Part(effect, terms, tuple(map(float, values[at : at + size])), states, signs))
            at, state, sign = at + size, states.stop, signs.stop
        self.n_states, self.signs = state, [1.0] * sign
        self.timed = any(part.terms.timed for part in self.parts)

    def _call(self, function: Callable, part: Part, t: float, y: Sequence[float], a: float = 0.0) -> float:
        z = y[2:]
        return function(
            y[0], y[1], a, t, self.duration, self.omega, self.direction, *part.values, *z[part.states],
            *self.signs[part.signs],
        )  # fmt: skip

    def acceleration(self, t: float, y: Sequence[float]) -> float:
        torque, inertia = 0.0, 1.0
        for part in self.parts:
            if part.terms.torque is not None:
                torque += self._call(part.terms.torque, part, t, y)
            if part.terms.inertia is not None:
                inertia += self._call(part.terms.inertia, part, t, y)
        return torque / inertia

    def rates(self, t: float, y: Any, held: bool = False) -> list[float]:
        y = y.tolist()
        a = 0.0 if held else self.acceleration(t, y)
        found = [0.0 if held else y[1], a]
        for part in self.parts:
            found += [self._call(one, part, t, y, a) for one in part.terms.rates]
        return found

    def freed(self, t: float, y: Sequence[float]) -> tuple[float, float]:
        """Accelerations at rest, were the pendulum to move forwards or backwards."""
        kept, found = self.direction, []
        for self.direction in (1.0, -1.0):
            found.append(self.acceleration(t, [y[0], 0.0, *y[2:]]))
        self.direction = kept
        return found[0], found[1]

    def release(self, angle: float, velocity: float) -> list[float]:
        y = [angle, velocity, *[0.0] * self.n_states]
        for part in self.parts:
            first = [self._call(one, part, 0.0, y) for one in part.terms.initial]
            y[2 + part.states.start : 2 + part.states.stop] = first
        return y

    def switch_values(self, t: float, y: Sequence[float]) -> list[float]:
        return [self._call(one, part, t, y) for part in self.parts for one in part.terms.switches]

    def freeze(self, t: float, y: Sequence[float]) -> None:
        ahead = [y[0] + 1e-9 * (y[1] if y[1] else -y[0]), *y[1:]]
        values = zip(self.switch_values(t, y), self.switch_values(t, ahead), strict=True)
        self.signs = [-1.0 if (now if now else later) < 0 else 1.0 for now, later in values]
