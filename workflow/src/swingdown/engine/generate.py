"""The catalogue as C source: each formula and its exact partial derivatives, one loop over the points each."""

import sympy
from sympy.printing.c import C99CodePrinter

from ..pendulum.formula import symbol
from . import collocation
from .rows import entries

_THETA, _VELOCITY, _ACCELERATION = symbol("theta"), symbol("thetadot"), symbol("thetaddot")
_TIME, _DIRECTION, _OMEGA = symbol("t"), symbol("direction"), symbol("omega_n")
_SINE, _COSINE, _SPEED = symbol("sine_theta"), symbol("cosine_theta"), symbol("speed")
_POINTS = {
    _THETA: "q->th",
    _VELOCITY: "q->v",
    _ACCELERATION: "q->a",
    _TIME: "q->t",
    _SINE: "q->sn",
    _COSINE: "q->cs",
}
_VALUES = "(const Points *q, const double *p, const double *sign, double *out, Part at)"
_DERIVATIVES = "(const Points *q, const double *p, const double *sign, const Slopes *d, Part at)"


class _Printer(C99CodePrinter):
    """C that vectorises: the engine's own sine and cosine, and products for whole powers."""

    def _print_Symbol(self, name):
        return f"s_{name.name}"  # whatever a formula calls its symbols, they collide with nothing in C

    def _print_Pi(self, _):
        return "3.141592653589793"

    def _print_sin(self, call):
        return f"sine({self._print(call.args[0])})"

    def _print_cos(self, call):
        return f"cosine({self._print(call.args[0])})"

    def _print_Pow(self, power):
        if power.exp.is_Integer and 2 <= abs(power.exp) <= 8:
            product = "*".join([f"({self._print(power.base)})"] * abs(int(power.exp)))
            return f"({product})" if power.exp > 0 else f"(1.0/({product}))"
        return super()._print_Pow(power)


_printer = _Printer()


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


def _function(name, signature, effect, assignments):
    """A C function that does each (target, operator, expression) at every point, subexpressions shared."""
    assignments = [
        (target, operator, _with_shared_points(formula)) for target, operator, formula in assignments
    ]
    shared, reduced = sympy.cse(
        [e for *_, e in assignments], symbols=sympy.numbered_symbols("x", real=True), list=True
    )
    used = set().union(*(e.free_symbols for e in reduced), *(e.free_symbols for _, e in shared))
    arrays = _POINTS | {
        symbol(state.symbol): f"(q->z + {k} * q->stride)" for k, state in enumerate(effect.states)
    }
    scalars = {_OMEGA: "q->omega_n", symbol("duration"): "q->duration", _DIRECTION: "q->direction"}
    scalars |= {symbol(parameter.symbol): f"p[{k}]" for k, parameter in enumerate(effect.parameters)}
    scalars |= {symbol(f"sign_{k}"): f"sign[{k}]" for k in range(8)}
    lines = [f"static void {name}{signature} {{", "(void)q; (void)p; (void)sign; (void)at;"]
    lines += [
        f"const double {_printer.doprint(key)} = {value};" for key, value in scalars.items() if key in used
    ]
    lines += [
        f"const double *restrict in{k} = {array};"
        for k, (key, array) in enumerate(arrays.items())
        if key in used
    ]
    lines += [f"double *restrict out{k} = {target};" for k, (target, *_) in enumerate(assignments)]
    if assignments:
        lines.append("for (int i = 0; i < q->n; i++) {")
        lines += [
            f"const double {_printer.doprint(key)} = in{k}[i];" for k, key in enumerate(arrays) if key in used
        ]
        if _SPEED in used:
            lines.append("const double s_speed = fmax(q->direction * q->v[i], 1e-300);")
        lines += [
            f"const double {_printer.doprint(key)} = {_printer.doprint(value)};" for key, value in shared
        ]
        lines += [
            f"out{k}[i] {assignments[k][1]} {_printer.doprint(value)};" for k, value in enumerate(reduced)
        ]
        lines.append("}")
    else:
        lines.append("(void)" + ("d;" if "Slopes" in signature else "out;"))
    return [*lines, "}"]


def _narrow(expression):
    """2 where a formula can change all at once at some angle, 1 where only at some velocity or time, 0 where nowhere.

    Sums, whole powers, sines and cosines of what moves are smooth; anything else may be as narrow as its parameters say.
    """
    calls = expression.atoms(sympy.exp, sympy.log, sympy.tan, sympy.tanh, sympy.Pow)
    sharp = [
        call.free_symbols for call in calls if not (call.is_Pow and call.exp.is_Integer and call.exp > 0)
    ]
    if any(symbols & {_THETA, _ACCELERATION} for symbols in sharp):
        return 2
    return int(any(symbols & {_VELOCITY, _TIME} for symbols in sharp))


def _manners(formulas, rates, states, arguments):
    """How each state is found (points.h): a list of (kind, of, pull, push, lead), from the rates with their signs frozen."""
    found = []
    for k, (state, rate) in enumerate(zip(states, rates, strict=True)):
        others = [*formulas.motion.values(), *arguments, *(r for j, r in enumerate(rates) if j != k)]
        feeds = any(state in expression.free_symbols for expression in others)
        of = [
            j
            for j, other in enumerate(states)
            if other == rate and states[j] not in _positions(rates, states)
        ]
        moving = {_THETA, _VELOCITY, _ACCELERATION, _TIME, *states}
        along = sympy.cancel(rate / _VELOCITY)
        pull, pull_along = (sympy.expand(expression).diff(state) for expression in (rate, along))
        read = formulas.reading is not None and state in formulas.reading.free_symbols
        if of and not read:
            found.append(("POSITION", of[0], 0, 0, 0))
        elif (
            not feeds
            and pull != 0
            and not pull.free_symbols & moving
            and not rate.free_symbols & (set(states) - {state})
        ):
            lead = sympy.expand(rate).diff(_THETA)
            found.append(("FOLLOWER", k, pull, 0, 0 if lead.free_symbols & moving else lead))
        elif (
            pull_along != 0
            and not along.free_symbols & (moving - {state})
            and not pull_along.has(state)
            and not read
        ):
            found.append(("ALONG", k, pull_along, sympy.simplify(along - pull_along * state), 0))
        else:
            found.append(("RATE", k, 0, 0, 0))
    return found


def _positions(rates, states):
    return {state for state, rate in zip(states, rates, strict=True) if rate in states}


def _slopes(outputs, inputs, parameters):
    """The assignments of all derivatives that are not zero: outputs and inputs as {row: expression or symbol}."""
    found = []
    for row, expression in outputs.items():
        found += [(f"BY({row}, {column})", "+=", expression.diff(of)) for column, of in inputs.items()]
        found.append((f"BY_PARAMETER({row}, 0)", "+=", expression.diff(_OMEGA)))
        found += [
            (f"BY_PARAMETER({row}, at.first_parameter + {k})", "=", expression.diff(symbol(parameter.symbol)))
            for k, parameter in enumerate(parameters)
        ]
    return [(target, operator, derivative) for target, operator, derivative in found if derivative != 0]


def _effect(number, effect, form):
    """C source of one entry and the initialiser of its row in the table of effects."""
    formulas = effect.expressions(form)
    arguments = switches(*formulas.motion.values(), *formulas.rates)
    states = {f"3 + at.first_state + {k}": symbol(state.symbol) for k, state in enumerate(effect.states)}
    outputs = {
        row: formulas.motion[kind]
        for row, kind in (("0", "torque"), ("1", "inertia"))
        if kind in formulas.motion
    }
    outputs |= {f"2 + at.first_state + {k}": rate for k, rate in enumerate(formulas.rates)}
    outputs = {row: _frozen(expression, arguments) for row, expression in outputs.items()}
    moves = {"0": _THETA, "1": _VELOCITY, "2": _ACCELERATION} | states
    first = {f"{k}": value for k, value in enumerate(formulas.initial)}
    symbols = list(states.values())
    rates = [outputs[f"2 + at.first_state + {k}"] for k in range(len(symbols))]
    manners = _manners(formulas, rates, symbols, arguments)
    linear = {
        f"{3 * k + j}": manner[2 + j]
        for k, manner in enumerate(manners)
        for j in range(3)
        if manner[0] in ("FOLLOWER", "ALONG")
    }
    linear = {row: sympy.sympify(expression) for row, expression in linear.items()}
    reads = {} if formulas.reading is None else {"0": formulas.reading}
    read_inputs = {"0": _TIME} if effect.acts_on == "clock" else {"0": _THETA} | states

    def values(outputs):
        return [(f"out + ({row}) * q->stride", "+=", expression) for row, expression in outputs.items()]

    def signed(outputs):  # a reading is taken point by point, so its signs are those of each point
        return {
            row: expression.replace(sympy.sign, lambda x: 2 * sympy.Heaviside(x, 1) - 1)
            for row, expression in outputs.items()
        }

    functions = {
        "motion": (_VALUES, values(outputs)),
        "reading": (_VALUES, values(signed(reads))),
        "initial": (_VALUES, values(first)),
        "switches": (
            _VALUES,
            [(f"out + {k} * q->stride", "=", argument) for k, argument in enumerate(arguments)],
        ),
        "linear": (_VALUES, values(linear)),
        "linear_slopes": (_DERIVATIVES, _slopes(linear, {}, effect.parameters)),
        "motion_slopes": (_DERIVATIVES, _slopes(outputs, moves, effect.parameters)),
        "reading_slopes": (_DERIVATIVES, _slopes(signed(reads), read_inputs, effect.parameters)),
        "initial_slopes": (_DERIVATIVES, _slopes(first, {"0": _THETA, "1": _VELOCITY}, effect.parameters)),
    }
    lines = []
    for kind, (signature, assignments) in functions.items():
        lines += _function(f"e{number}_{kind}", signature, effect, assignments)
    timed = any(expression.has(_TIME) for expression in outputs.values())
    rough = any(_with_shared_points(expression).has(_SPEED) for expression in outputs.values())
    sharp = max(
        [manner[0] == "ALONG" for manner in manners]
        + [_narrow(expression) for expression in outputs.values()],
        default=0,
    )
    counts = (
        len(effect.parameters),
        len(effect.states),
        len(arguments),
        int(timed),
        int("1" in outputs),
        int(rough),
        int(sharp),
    )
    names = ", ".join(f".{kind} = e{number}_{kind}" for kind in functions)
    fields = ("n_parameters", "n_states", "n_switches", "timed", "inertial", "rough", "sharp")
    if manners:
        names += f", .manner = {{{', '.join(f'{{{kind}, {of}}}' for kind, of, *_ in manners)}}}"
    return (
        lines,
        f"{{{names}, {', '.join(f'.{key} = {value}' for key, value in zip(fields, counts, strict=True))}}},",
    )


def source(catalogue, gravity):
    """The generated C header: collocation tables, then every effect's functions and the table of effects."""
    lines = [
        "/* Generated from the catalogue of effects; edit that instead. */",
        f"#define N {collocation.NODES}",
    ]
    for name, values in collocation.collocation().items():
        if name != "tail" and isinstance(values[0], list):
            # stored by column, so that the loop over the nodes is the inner, contiguous one
            values = list(zip(*values, strict=True))
        flat = [value for row in values for value in row] if isinstance(values[0], (list, tuple)) else values
        lines.append(f"static const double T_{name}[] = {{{', '.join(value.hex() for value in flat)}}};")
    rows = []
    for number, (effect, form) in enumerate(entries(catalogue, gravity)):
        code, row = _effect(number, effect, form)
        lines += code
        rows.append(row)
    return "\n".join([*lines, "static const Effect EFFECTS[] = {", *rows, "};", ""])
