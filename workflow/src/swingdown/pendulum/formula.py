"""Formulas as text, read against a whitelist: the only road from a catalogue entry or a config file to code."""

import ast
from functools import lru_cache

import sympy

from ..errors import InputError

FUNCTIONS = {
    "sin": sympy.sin, "cos": sympy.cos, "tan": sympy.tan, "exp": sympy.exp, "log": sympy.log, "sqrt": sympy.sqrt,
    "tanh": sympy.tanh, "abs": sympy.Abs, "sign": sympy.sign,
}  # fmt: skip
CONSTANTS = {"pi": sympy.pi}
_BINARY = {
    ast.Add: lambda a, b: a + b, ast.Sub: lambda a, b: a - b, ast.Mult: lambda a, b: a * b,
    ast.Div: lambda a, b: a / b, ast.Pow: lambda a, b: a**b,
}  # fmt: skip
_LONGEST = 400
_LARGEST = 1e300  # of a number on its own, as a double still holds it with room to spare


def symbol(name):
    """The sympy symbol that stands for ``name`` in every formula (real, so that abs and sign differentiate)."""
    return sympy.Symbol(name, real=True)


def parse(text, names, where="formula"):
    """The sympy expression that ``text`` states, built from ``names`` and the whitelisted functions alone.

    Numbers, + - * / **, parentheses, the functions in ``FUNCTIONS``, ``pi`` and the given names are allowed;
    anything else raises InputError naming ``where``. Nothing is ever evaluated as Python.
    """
    if not isinstance(text, str) or not text.strip():
        raise InputError(where, f"formula {text!r} is not a text", "a formula such as -k*sin(5*theta + phi)")
    if len(text) > _LONGEST:
        raise InputError(where, f"the formula is {len(text)} characters long", f"at most {_LONGEST}")
    try:
        tree = ast.parse(text, mode="eval")
    except (SyntaxError, ValueError, RecursionError, MemoryError) as problem:
        raise InputError(
            where, f"formula {text!r} cannot be read ({problem})", "ordinary arithmetic"
        ) from None
    try:
        return _convert(tree.body, frozenset(names), text, where)
    except RecursionError:
        raise InputError(
            where, f"formula {text!r} is nested too deep", "a formula a person would write"
        ) from None


def _convert(node, names, text, where):
    found = _converted(node, names, text, where)
    if found.is_number:
        fine = found.is_extended_real and found.is_finite
        if not fine or abs(found.evalf(5)) > _LARGEST:
            raise InputError(
                where, f"{ast.unparse(node)!r} in formula {text!r} is no number", "real, finite numbers"
            )
    return found


def _converted(node, names, text, where):
    def refuse(what):
        allowed = f"names {', '.join(sorted(names))}; functions {', '.join(FUNCTIONS)}; + - * / ** ( )"
        return InputError(where, f"{what} is not allowed in formula {text!r}", allowed)

    def convert(part):
        return _convert(part, names, text, where)

    if isinstance(node, ast.Constant) and type(node.value) in (int, float):
        if abs(node.value) > _LARGEST:
            raise refuse("a number that large")
        whole = type(node.value) is int and abs(node.value) < 10**15
        return sympy.Integer(node.value) if whole else sympy.Float(node.value, 17)
    if isinstance(node, ast.Name):
        if node.id in names:
            return symbol(node.id)
        if node.id in CONSTANTS:
            return CONSTANTS[node.id]
        raise refuse(f"the name {node.id!r}")
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, (ast.USub, ast.UAdd)):
        return -convert(node.operand) if isinstance(node.op, ast.USub) else convert(node.operand)
    if isinstance(node, ast.BinOp) and type(node.op) in _BINARY:
        left, right = convert(node.left), convert(node.right)
        if isinstance(node.op, ast.Pow) and right.is_number and abs(right) > 20:
            raise refuse(f"the power {right}")
        if isinstance(node.op, ast.Div) and right == 0:
            raise refuse("division by zero")
        return _BINARY[type(node.op)](left, right)
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in FUNCTIONS:
        if len(node.args) != 1 or node.keywords:
            raise refuse(f"{node.func.id} with other than one argument")
        return FUNCTIONS[node.func.id](convert(node.args[0]))
    raise refuse(f"{ast.unparse(node)!r}")


def evaluate(text, **values):
    """The number or array that the formula ``text`` takes at these values (numbers or arrays) of all its names."""
    names = tuple(sorted(values))
    return _compiled(text, names)(*(values[name] for name in names))


@lru_cache(maxsize=100)
def _compiled(text, names):
    return sympy.lambdify([symbol(name) for name in names], parse(text, names), "numpy")
