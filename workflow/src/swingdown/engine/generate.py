"""The catalogue as C source: each formula and its exact partial derivatives, one loop over the points each."""

import numpy as np
import sympy
from sympy.printing.c import C99CodePrinter

from ..pendulum.effect import INPUTS
from ..pendulum.formula import symbol
from . import collocation
from .rows import entries
from .state_methods import localisation, state_methods

_THETA, _VELOCITY, _ACCELERATION = symbol("theta"), symbol("thetadot"), symbol("thetaddot")
_TIME, _DIRECTION, _OMEGA = symbol("t"), symbol("direction"), symbol("omega_n")
# of the measured drive: it and its derivatives by time
_INPUTS = [symbol(name) for name in (*INPUTS, "input_jerk")]
_SINE, _COSINE, _SPEED = symbol("sine_theta"), symbol("cosine_theta"), symbol("speed")
_POINTS = {
    _THETA: "q->th",
    _VELOCITY: "q->v",
    _ACCELERATION: "q->a",
    _TIME: "q->t",
    _SINE: "q->sn",
    _COSINE: "q->cs",
    **{one: f"(q->u + {k} * q->stride)" for k, one in enumerate(_INPUTS)},
}
_FORMULA = "(const Points *q, const double *p, const double *sign, double *out, PlacedEffect at)"
_PARTIALS = "(const Points *q, const double *p, const double *sign, const Partials *d, PlacedEffect at)"


class _Printer(C99CodePrinter):
    """C that vectorises: the engine's own functions (c/elementary.h), and products for whole powers."""

    def _print_Symbol(self, name):
        return f"s_{name.name}"  # whatever a formula calls its symbols, they collide with nothing in C

    def _print_Pi(self, _):
        return "3.141592653589793"

    def _print_Exp1(self, _):
        return "2.718281828459045"

    def _print_sin(self, call):
        return f"sine({self._print(call.args[0])})"

    def _print_cos(self, call):
        return f"cosine({self._print(call.args[0])})"

    def _print_exp(self, call):
        return f"exponential({self._print(call.args[0])})"

    def _print_log(self, call):
        own = call.args[0] == _SPEED  # which is above zero
        return f"logarithm({self._print(_SPEED)})" if own else super()._print_Function(call)

    def _print_Pow(self, power):
        if power.base == _SPEED and not power.exp.is_Integer:
            return f"power_of({self._print(_SPEED)}, {self._print(power.exp)})"
        if power.exp.is_Integer and 2 <= abs(power.exp) <= 8:
            product = "*".join([f"({self._print(power.base)})"] * abs(int(power.exp)))
            return f"({product})" if power.exp > 0 else f"(1.0/({product}))"
        return super()._print_Pow(power)


class _LockstepPrinter(_Printer):
    """The same for a number of each fit."""

    def _print_sin(self, call):
        return f"sines({self._print(call.args[0])})"

    def _print_cos(self, call):
        return f"cosines({self._print(call.args[0])})"


# constants as numbers: M_PI_2 and its like are not of C99
_printer, _lockstep_printer = (one({"math_macros": {}}) for one in (_Printer, _LockstepPrinter))


def switches(*expressions):
    """The arguments of abs and sign in the formulas, the velocity apart: where a slope or value jumps."""
    calls = set().union(*(expression.atoms(sympy.Abs, sympy.sign) for expression in expressions))
    return sorted({call.args[0] for call in calls} - {_VELOCITY}, key=sympy.default_sort_key)


def _frozen(expression, arguments):
    """The formula with each abs and sign replaced by its frozen sign: smooth between switches."""
    signs = {_VELOCITY: _DIRECTION} | {argument: symbol(f"sign_{k}") for k, argument in enumerate(arguments)}
    for argument, sign in signs.items():
        expression = expression.subs({sympy.Abs(argument): sign * argument, sympy.sign(argument): sign})
    return expression


def _with_shared_points(expression):
    """The formula in the sine and cosine of the angle, and in the speed where it is raised to a broken power: past the
    reversal, where the direction is still frozen, such a power is no number, and it counts as zero there."""

    def broken(part):
        return part.is_Pow and not part.exp.is_Integer and part.base == _DIRECTION * _VELOCITY

    expression = expression.subs({sympy.sin(_THETA): _SINE, sympy.cos(_THETA): _COSINE})
    expression = expression.replace(broken, lambda part: _SPEED**part.exp)
    return expression.replace(sympy.log(_DIRECTION * _VELOCITY), sympy.log(_SPEED))


def _inputs(effect):
    """Where a function finds what formulas name: arrays over the points, and numbers, as {symbol: C expression}."""
    states = {symbol(state.symbol): f"(q->z + {k} * q->stride)" for k, state in enumerate(effect.states)}
    numbers = {_OMEGA: "q->omega_n", symbol("duration"): "q->duration", _DIRECTION: "q->direction"}
    numbers |= {symbol(parameter.symbol): f"p[{k}]" for k, parameter in enumerate(effect.parameters)}
    numbers |= {symbol(f"sign_{k}"): f"sign[{k}]" for k in range(8)}
    return _POINTS | states, numbers


def _declare(name, value):
    return f"const double {_printer.doprint(name)} = {value};"


def _shared(formulas):
    """The subexpressions that formulas share, as (symbol, expression), what is left of each, and the symbols of all."""
    shared, reduced = sympy.cse(formulas, symbols=sympy.numbered_symbols("x", real=True), list=True)
    used = set().union(*(e.free_symbols for e in reduced), *(e.free_symbols for _, e in shared))
    return shared, reduced, used


def _function(name, signature, effect, assignments):
    """A C function that does each (target, operator, expression) at every point, subexpressions shared."""
    head = [f"static void {name}{signature} {{", "(void)q; (void)p; (void)sign; (void)at;"]
    if not assignments:
        return [*head, "(void)" + ("d;" if "Partials" in signature else "out;"), "}"]
    targets, operators, formulas = zip(*assignments, strict=True)
    shared, reduced, used = _shared([_with_shared_points(formula) for formula in formulas])
    if _SPEED in used:
        used |= {_DIRECTION, _VELOCITY}
    arrays, numbers = _inputs(effect)
    arrays = {key: (f"in{k}", array) for k, (key, array) in enumerate(arrays.items()) if key in used}
    forwards = _printer.doprint(_DIRECTION * _VELOCITY)
    speed = {_SPEED: f"{forwards} < 1e-300 ? 1e-300 : {forwards}"} if _SPEED in used else {}
    return [
        *head,
        *(_declare(key, value) for key, value in numbers.items() if key in used),
        *(f"const double *restrict {local} = {array};" for local, array in arrays.values()),
        *(f"double *restrict out{k} = {target};" for k, target in enumerate(targets)),
        "for (int i = 0; i < q->n; i++) {",
        *(_declare(key, f"{local}[i]") for key, (local, _) in arrays.items()),
        *(_declare(key, value) for key, value in speed.items()),
        *(_declare(key, _printer.doprint(value)) for key, value in shared),
        *(f"out{k}[i] {operators[k]} {_printer.doprint(value)};" for k, value in enumerate(reduced)),
        "}",
        "}",
    ]


def _by_parameter(expression, parameter):
    """The derivative by a parameter; by a delay of the measured drive: what is later is changed by its own rate, backwards."""
    if parameter.role != "delay":
        return expression.diff(symbol(parameter.symbol))
    return -sum(expression.diff(one) * rate for one, rate in zip(_INPUTS, _INPUTS[1:], strict=False))


def _partials(outputs, inputs, parameters):
    """The assignments of all derivatives that are not zero: outputs and inputs as {row: expression or symbol}."""
    found = []
    for row, expression in outputs.items():
        found += [(f"PARTIAL({row}, {column})", "+=", expression.diff(of)) for column, of in inputs.items()]
        found.append((f"PARTIAL_BY_PARAMETER({row}, 0)", "+=", expression.diff(_OMEGA)))
        for k, parameter in enumerate(parameters):
            target = f"PARTIAL_BY_PARAMETER({row}, at.first_parameter + {k})"
            found.append((target, "=", _by_parameter(expression, parameter)))
    return [(target, operator, derivative) for target, operator, derivative in found if derivative != 0]


def _values(outputs, operator="+="):
    """The assignments of outputs as {row: expression}."""
    return [(f"out + ({row}) * q->stride", operator, expression) for row, expression in outputs.items()]


class _Outputs:
    """What an entry of the catalogue computes, as {row in C: expression} with frozen signs."""

    def __init__(self, effect, form):
        formulas = effect.expressions(form)
        self.effect = effect
        self.switches = switches(*formulas.motion.values(), *formulas.rates)
        self.states = {
            f"3 + at.first_state + {k}": symbol(state.symbol) for k, state in enumerate(effect.states)
        }
        motion = {row: formulas.motion.get(kind) for row, kind in (("0", "torque"), ("1", "inertia"))}
        motion |= {f"2 + at.first_state + {k}": rate for k, rate in enumerate(formulas.rates)}
        there = {row: expression for row, expression in motion.items() if expression is not None}
        self.motion = {row: _frozen(expression, self.switches) for row, expression in there.items()}
        self.initial = {f"{k}": value for k, value in enumerate(formulas.initial)}
        self.reading = {}
        if formulas.reading is not None:  # it is taken point by point, so its signs are those of each point
            self.reading["0"] = formulas.reading.replace(sympy.sign, lambda x: 2 * sympy.Heaviside(x, 1) - 1)
        states = list(self.states.values())
        rates = [self.motion[f"2 + at.first_state + {k}"] for k in range(len(states))]
        self.methods = state_methods(formulas, rates, states, self.switches)
        self.linear = {
            f"{3 * k + j}": sympy.sympify(coefficient)
            for k, method in enumerate(self.methods)
            for j, coefficient in enumerate(method.coefficients)
        }

    def functions(self):
        """The C functions of the entry: {name in the table of effects: (signature, assignments)}."""
        parameters = self.effect.parameters
        moves = {"0": _THETA, "1": _VELOCITY, "2": _ACCELERATION} | self.states
        read = {"0": _TIME} if self.effect.acts_on == "clock" else {"0": _THETA} | self.states
        crossed = {f"{k}": argument for k, argument in enumerate(self.switches)}
        released = {"0": _THETA, "1": _VELOCITY}
        return {
            "motion": (_FORMULA, _values(self.motion)),
            "reading": (_FORMULA, _values(self.reading)),
            "initial": (_FORMULA, _values(self.initial)),
            "switches": (_FORMULA, _values(crossed, "=")),
            "linear": (_FORMULA, _values(self.linear)),
            "linear_partials": (_PARTIALS, _partials(self.linear, {}, parameters)),
            "motion_partials": (_PARTIALS, _partials(self.motion, moves, parameters)),
            "reading_partials": (_PARTIALS, _partials(self.reading, read, parameters)),
            "initial_partials": (_PARTIALS, _partials(self.initial, released, parameters)),
        }

    def in_lockstep(self):
        """Whether fits side by side can have this motion: a torque alone, smooth but for the velocity's sign."""
        told = self.properties()
        special = ("n_states", "n_switches", "inertial", "fractional_power", "localised")
        torque = self.motion.get("0")
        return torque is not None and _of_each(torque) and not any(told[name] for name in special)

    def _is_affine(self):
        reading = self.reading.get("0")
        if reading is None or self.effect.acts_on != "sensor":
            return False
        moving = {_VELOCITY, _ACCELERATION, _TIME, symbol("duration"), *self.states.values()}
        return reading.diff(_THETA, 2) == 0 and not reading.free_symbols & moving

    def properties(self):
        """The numbers in the entry's row of the table of effects, by name."""
        motion = self.motion.values()
        localised = [localisation(expression) for expression in motion]
        localised += [int(method.kind == "RATE_INDEPENDENT") for method in self.methods]
        return {
            "n_parameters": len(self.effect.parameters),
            "n_states": len(self.effect.states),
            "n_switches": len(self.switches),
            "timed": int(any(expression.has(_TIME, *_INPUTS) for expression in motion)),
            "inertial": int("1" in self.motion),
            "fractional_power": int(any(_with_shared_points(one).has(_SPEED) for one in motion)),
            "localised": max(localised, default=0),
            "directed": int(any(expression.has(_DIRECTION) for expression in motion)),
            "affine": int(self._is_affine()),
        }


def _of_each(expression):
    """Whether a formula has only what vectors of numbers have operators for: sums, whole powers, sines and cosines."""
    powers, calls = expression.atoms(sympy.Pow), expression.atoms(sympy.Function)
    whole = all(power.exp.is_Integer and abs(power.exp) <= 8 for power in powers)
    whole = whole and not expression.free_symbols & set(_INPUTS)
    return whole and all(isinstance(call, (sympy.sin, sympy.cos)) for call in calls)


def _lockstep_function(name, signature, effect, assignments):
    """A C function that does each (target, operator, expression) at every point of fits side by side."""
    slopes = (
        " (void)by_angle; (void)by_velocity; (void)by_omega; (void)by_own;" if "by_own" in signature else ""
    )
    head = [f"static void {name}{signature} {{", f"(void)q; (void)p;{slopes}"]
    targets, operators, formulas = zip(*assignments, strict=True)
    points = {sympy.sin(_THETA): _SINE, sympy.cos(_THETA): _COSINE}
    shared, reduced, used = _shared([formula.subs(points) for formula in formulas])
    numbers = {_OMEGA: "q->omega_n", symbol("duration"): "(Each){0.0} + q->duration"}
    numbers |= {_DIRECTION: "q->direction"}
    numbers |= {symbol(parameter.symbol): f"p[{k}]" for k, parameter in enumerate(effect.parameters)}
    printed = _lockstep_printer.doprint

    def of_each(value):
        return printed(value) if value.free_symbols else f"(Each){{0.0}} + {printed(value)}"

    return [
        *head,
        *(f"const Each {printed(key)} = {value};" for key, value in numbers.items() if key in used),
        "for (int i = 0; i < LOCKSTEP_NODES; i++) {",
        *(f"const Each {printed(key)} = {array}[i];" for key, array in _POINTS.items() if key in used),
        *(f"const Each {printed(key)} = {of_each(value)};" for key, value in shared),
        *(f"{targets[k]} {operators[k]} {of_each(value)};" for k, value in enumerate(reduced)),
        "}",
        "}",
    ]


def _lockstep(name, effect, torque):
    """The C functions of a torque for fits side by side (LockstepFormula and LockstepPartials in c/effect.h)."""
    value = [("torque[i]", "+=", torque)]
    slopes = [("by_angle[i]", "+=", torque.diff(_THETA)), ("by_velocity[i]", "+=", torque.diff(_VELOCITY)),
              ("by_omega[i]", "+=", torque.diff(_OMEGA))]  # fmt: skip
    own = [
        (f"by_own[{k} * LOCKSTEP_NODES + i]", "=", torque.diff(symbol(parameter.symbol)))
        for k, parameter in enumerate(effect.parameters)
    ]
    assigned = [one for one in slopes if one[2] != 0] + own
    signature = "(const LockstepPoints *q, const Each *p, Each *torque"
    by = ", Each *by_angle, Each *by_velocity, Each *by_omega, Each *by_own"
    return [
        *_lockstep_function(f"{name}_lockstep", f"{signature})", effect, value),
        *_lockstep_function(f"{name}_lockstep_partials", f"{signature}{by})", effect, value + assigned),
    ]


def _effect(number, effect, form):
    """C source of one entry and the initialiser of its row in the table of effects."""
    outputs = _Outputs(effect, form)
    lines, fields = [], {}
    for name, (signature, assignments) in outputs.functions().items():
        fields[name] = f"e{number}_{name}"
        lines += _function(fields[name], signature, effect, assignments)
    if outputs.methods:
        fields["method"] = f"{{{', '.join(f'{{{one.kind}, {one.of}}}' for one in outputs.methods)}}}"
    fields |= outputs.properties()
    if outputs.in_lockstep():
        lines += _lockstep(f"e{number}", effect, outputs.motion["0"])
        fields |= {name: f"e{number}_{name}" for name in ("lockstep", "lockstep_partials")}
    return lines, f"{{{', '.join(f'.{name} = {value}' for name, value in fields.items())}}},"


def _table(name, values):
    values = np.array(values, dtype=float)
    # stored by column, so that the loop over the nodes is the inner, contiguous one
    values = values if "tail" in name else values.T
    listed = ", ".join(value.hex() for value in values.ravel().tolist())
    return f"static const double {name}[] = {{{listed}}};"


def source(catalogue, gravity):
    """The generated C header: collocation tables, then every effect's functions and the table of effects."""
    lines = [
        "/* Generated from the catalogue of effects; edit that instead. */",
        f"#define N {collocation.NODES}",
        f"#define LOCKSTEP_NODES {collocation.LOCKSTEP_NODES}",
    ]
    for prefix, nodes in (("T", collocation.NODES), ("LOCKSTEP", collocation.LOCKSTEP_NODES)):
        for name, values in collocation.collocation(nodes).items():
            lines.append(_table(f"{prefix}_{name}", values))
    rows = []
    for number, (effect, form) in enumerate(entries(catalogue, gravity)):
        code, row = _effect(number, effect, form)
        lines += code
        rows.append(row)
    return "\n".join([*lines, "static const Effect EFFECTS[] = {", *rows, "};", ""])
