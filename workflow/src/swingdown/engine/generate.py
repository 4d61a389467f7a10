"""The catalogue as C source: each formula and its exact partial derivatives, one loop over the nodes each."""

import sympy
from sympy.printing.c import C99CodePrinter

from ..formula import symbol
from . import tables
from .rows import entries

_THETA, _VELOCITY = symbol("theta"), symbol("thetadot")
_DIRECTION, _TRUE_TIME = symbol("direction"), symbol("t")
_SINE, _COSINE = symbol("sine_theta"), symbol("cosine_theta")


def switches(expression):
    """The arguments of abs and sign in a formula, the velocity apart: where its slope or value jumps."""
    arguments = {call.args[0] for call in expression.atoms(sympy.Abs, sympy.sign)} - {_VELOCITY}
    return sorted(arguments, key=sympy.default_sort_key)


def _frozen(expression):
    """The formula with each abs and sign replaced by its frozen sign: smooth between switches."""
    signs = {_VELOCITY: _DIRECTION} | {argument: symbol(f"sign_{k}") for k, argument in enumerate(switches(expression))}
    for argument, sign in signs.items():
        expression = expression.subs({sympy.Abs(argument): sign * argument, sympy.sign(argument): sign})
    return expression


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


def _loop(assignments, count="q->n"):
    """C lines of one loop over the points that computes each (target, expression) with shared subexpressions."""
    targets = [target for target, _ in assignments]
    expressions = [
        expression.subs({sympy.sin(_THETA): _SINE, sympy.cos(_THETA): _COSINE}) for _, expression in assignments
    ]
    shared, reduced = sympy.cse(expressions, symbols=sympy.numbered_symbols("x", real=True), list=True)
    lines = [f"for (int i = 0; i < {count}; i++) {{"]
    used = set().union(*(e.free_symbols for e in reduced), *(e.free_symbols for _, e in shared)) if reduced else set()
    for name, array in ((_THETA, "th"), (_VELOCITY, "v"), (_TRUE_TIME, "t"), (_SINE, "sn"), (_COSINE, "cs")):
        if name in used:
            lines.append(f"    const double {_printer.doprint(name)} = {array}[i];")
    lines += [f"    const double {_printer.doprint(name)} = {_printer.doprint(value)};" for name, value in shared]
    lines += [f"    {target} {_printer.doprint(value)};" for target, value in zip(targets, reduced, strict=True)]
    return [*lines, "}"]


def _function(signature, effect, body, signs=0):
    head = [f"static void {signature} {{"]
    head += [
        "const double *restrict th = q->th, *restrict v = q->v, *restrict t = q->t, *restrict sn = q->sn, *restrict cs = q->cs;",
        "const double s_omega_n = q->omega_n, s_duration = q->duration, s_direction = q->direction;",
    ]
    head += [f"const double s_{parameter.symbol} = p[{k}];" for k, parameter in enumerate(effect.parameters)]
    head += [f"const double s_sign_{k} = sign[{k}];" for k in range(signs)]
    unused = ["th", "v", "t", "sn", "cs", "s_omega_n", "s_duration", "s_direction", "p", "sign"]
    unused += [f"s_{parameter.symbol}" for parameter in effect.parameters] + [f"s_sign_{k}" for k in range(signs)]
    head.append(" ".join(f"(void){name};" for name in unused))
    return [*head, *body, "}"]


def _effect(number, effect, form):
    """C source of one entry and the initialiser of its row in the table of effects."""
    expression = effect.expression(form)
    arguments = switches(expression)
    smooth = _frozen(expression)
    parameters = [symbol(parameter.symbol) for parameter in effect.parameters]
    name = f"e{number}"
    common = "const Points *restrict q, const double *restrict p, const double *restrict sign"
    value_target = "out[i] +=" if effect.acts_on == "torque" else "out[i] ="
    value = _function(f"{name}_value({common}, double *restrict out)", effect, _loop([(value_target, smooth)]), len(arguments))
    base = {"torque": _THETA, "sensor": _THETA, "clock": _TRUE_TIME}[effect.acts_on]
    add = "+=" if effect.acts_on == "torque" else "="
    partials = [(f"d_theta[i] {add}", smooth.diff(base))]
    if effect.acts_on == "torque":
        partials += [("d_v[i] +=", smooth.diff(_VELOCITY)), ("d_wn[i] +=", smooth.diff(symbol("omega_n")))]
    partials = [(target, derivative) for target, derivative in partials if derivative != 0 or add == "="]
    partials += [(f"d_p[{k} * stride + i] =", smooth.diff(parameter)) for k, parameter in enumerate(parameters)]
    slopes = _function(
        f"{name}_partials({common}, double *restrict d_theta, double *restrict d_v, double *restrict d_wn, double *restrict d_p, int stride)",
        effect,
        ["(void)d_theta; (void)d_v; (void)d_wn; (void)d_p; (void)stride;", *(_loop(partials) if partials else [])],
        len(arguments),
    )  # fmt: skip
    body = []
    for k, argument in enumerate(arguments):
        body += _loop([(f"out[{k} * stride + i] =", argument)])
    where = _function(f"{name}_switches({common}, double *restrict out, int stride)", effect, ["(void)out; (void)stride;", *body], 0)
    timed = int(bool(expression.has(_TRUE_TIME)))
    row = f"{{{name}_value, {name}_partials, {name}_switches, {len(parameters)}, {len(arguments)}, {timed}}},"
    return [*value, *slopes, *where], row


def source(catalogue, gravity):
    """The generated C header: collocation tables, then every effect's functions and the table of effects."""
    lines = ["/* Generated from the catalogue of effects; edit that instead. */", f"#define N {tables.NODES}"]
    for name, values in tables.collocation().items():
        matrix = isinstance(values[0], list)
        # stored by column, so that the loop over the nodes is the inner, contiguous one
        flat = [value for column in zip(*values, strict=True) for value in column] if matrix and name != "tail" else values
        flat = [value for row in values for value in row] if name == "tail" else flat
        lines.append(f"static const double T_{name}[] = {{{', '.join(value.hex() for value in flat)}}};")
    rows = []
    for number, (effect, form) in enumerate(entries(catalogue, gravity)):
        code, row = _effect(number, effect, form)
        lines += code
        rows.append(row)
    return "\n".join([*lines, "static const Effect EFFECTS[] = {", *rows, "};", ""])
