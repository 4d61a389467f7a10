"""Formulas as text, read against a whitelist: the only road from a catalogue entry or a config file to code or a number."""

import ast
import operator
from collections.abc import Callable, Iterable, Mapping
from functools import lru_cache
from typing import Any

import numpy as np

from ..errors import InputError
from ..extras import needed

# what a formula may call, by its name there and in sympy; numpy has the same names but for abs
FUNCTIONS = {
    "sin": "sin", "cos": "cos", "tan": "tan", "exp": "exp", "log": "log", "sqrt": "sqrt", "tanh": "tanh", "abs": "Abs",
    "sign": "sign",
}  # fmt: skip
_BINARY: Mapping[type, Callable[[Any, Any], Any]] = {
    ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv, ast.Pow: operator.pow,
}  # fmt: skip
_LONGEST = 400
_HIGHEST_POWER = 20
_LARGEST = 1e300  # of a number on its own, as a double still holds it with room to spare


def symbol(name: str) -> Any:
    """The sympy symbol that stands for ``name`` in every formula (real, so that abs and sign differentiate)."""
    return needed("sympy").Symbol(name, real=True)


def parse(text: str, names: Iterable[str], where: str = "formula") -> Any:
    """The sympy expression that a formula states. Nothing is ever evaluated as Python.

    Parameters
    ----------
    text
        Numbers, ``+ - * / **``, parentheses, the functions in ``FUNCTIONS``, ``pi`` and the given names.
    names
        The variables and parameters that may stand in it.
    where
        What an error names as its place.

    Raises
    ------
    InputError
        If anything else stands in it, or it is nested too deep.
    """
    tree = _tree(text, frozenset(names), where)
    try:
        return _expression(tree, text, where)
    except RecursionError:
        raise _too_deep(text, where) from None


@lru_cache(maxsize=500)
def names_in(text: str) -> frozenset[str]:
    """The names of what a formula that was read before goes by: without its functions and ``pi``."""
    nodes = ast.walk(ast.parse(text, mode="eval"))
    return frozenset(node.id for node in nodes if isinstance(node, ast.Name)) - {*FUNCTIONS, "pi"}


def evaluate(text: str, /, **values: Any) -> Any:
    """The number or array that a formula takes.

    Parameters
    ----------
    text
        As of ``parse``.
    **values
        A number, or an array, for each of its names; arrays are of one shape, which the result has too.

    Raises
    ------
    InputError
        As of ``parse``.
    """
    return _compiled(text, frozenset(values))(values)


def _tree(text: str, names: frozenset[str], where: str) -> ast.expr:
    """The syntax tree of a formula, every node of it on the whitelist; InputError names ``where`` otherwise."""
    if not isinstance(text, str) or not text.strip():
        raise InputError(where, f"formula {text!r} is not text", "a formula such as -k*sin(5*theta + phi)")
    if len(text) > _LONGEST:
        raise InputError(where, f"the formula is {len(text)} characters long", f"at most {_LONGEST}")
    try:
        body = ast.parse(text, mode="eval").body
        _check(body, names, text, where)
    except (SyntaxError, ValueError, MemoryError) as problem:
        raise InputError(
            where, f"formula {text!r} cannot be read ({problem})", "ordinary arithmetic"
        ) from None
    except RecursionError:
        raise _too_deep(text, where) from None
    return body


def _too_deep(text: str, where: str) -> InputError:
    return InputError(where, f"formula {text!r} is nested too deep", "a formula a person would write")


def _check(node: ast.AST, names: frozenset[str], text: str, where: str) -> None:
    def refuse(what: str) -> InputError:
        allowed = f"names {', '.join(sorted(names))}; functions {', '.join(FUNCTIONS)}; + - * / ** ( )"
        return InputError(where, f"{what} is not allowed in formula {text!r}", allowed)

    match node:
        case ast.Constant(value=int() | float() as value) if type(value) in (int, float):
            if not abs(value) < _LARGEST:
                raise refuse("a number that large")
        case ast.Name(id=name):
            if name not in names and name != "pi":
                raise refuse(f"the name {name!r}")
        case ast.UnaryOp(op=ast.USub() | ast.UAdd(), operand=operand):
            _check(operand, names, text, where)
        case ast.BinOp(left=left, op=op, right=right) if type(op) in _BINARY:
            _check(left, names, text, where)
            _check(right, names, text, where)
        case ast.Call(func=ast.Name(id=name), args=arguments, keywords=keywords) if name in FUNCTIONS:
            if len(arguments) != 1 or keywords:
                raise refuse(f"{name} with other than one argument")
            _check(arguments[0], names, text, where)
        case _:
            raise refuse(repr(ast.unparse(node)))


def _expression(node: ast.expr, text: str, where: str) -> Any:
    """The sympy expression of a checked tree; InputError where a part of it is a number that is not real and finite."""
    sympy = needed("sympy")
    match node:
        case ast.Constant(value=int() as value) if abs(value) < 10**15:
            found = sympy.Integer(value)
        case ast.Constant(value=value):
            found = sympy.Float(value, 17)
        case ast.Name(id=name):
            found = sympy.pi if name == "pi" else symbol(name)
        case ast.UnaryOp(op=op, operand=operand):
            found = _expression(operand, text, where)
            found = -found if isinstance(op, ast.USub) else found
        case ast.BinOp(left=left, op=op, right=right):
            first, second = _expression(left, text, where), _expression(right, text, where)
            if isinstance(op, ast.Pow) and second.is_number and abs(second) > _HIGHEST_POWER:
                problem = f"the power {second} is not allowed in formula {text!r}"
                raise InputError(where, problem, f"at most {_HIGHEST_POWER}")
            if isinstance(op, ast.Div) and second == 0:
                problem = f"division by zero is not allowed in formula {text!r}"
                raise InputError(where, problem, "real, finite numbers")
            found = _BINARY[type(op)](first, second)
        case ast.Call(func=ast.Name(id=name), args=[argument]):
            found = getattr(sympy, FUNCTIONS[name])(_expression(argument, text, where))
    real = not found.is_number or (found.is_extended_real and found.is_finite)
    if not real or (found.is_number and abs(found.evalf(5)) > _LARGEST):
        problem = f"{ast.unparse(node)!r} in formula {text!r} is no number"
        raise InputError(where, problem, "real, finite numbers")
    return found


@lru_cache(maxsize=500)
def _compiled(text: str, names: frozenset[str]) -> Callable[[Mapping[str, Any]], Any]:
    return _function(_tree(text, names, "formula"))


def _function(node: ast.AST) -> Callable[[Mapping[str, Any]], Any]:
    """A checked tree as a function of its names' values."""
    match node:
        case ast.Constant(value=value):
            return lambda values: value
        case ast.Name(id=name):
            return (lambda values: np.pi) if name == "pi" else (lambda values: values[name])
        case ast.UnaryOp(op=op, operand=operand):
            inner = _function(operand)
            return (lambda values: -inner(values)) if isinstance(op, ast.USub) else inner
        case ast.BinOp(left=left, op=op, right=right):
            first, second, joined = _function(left), _function(right), _BINARY[type(op)]
            return lambda values: joined(first(values), second(values))
        case ast.Call(func=ast.Name(id=name), args=[argument]):
            inner, called = _function(argument), getattr(np, name)
            return lambda values: called(inner(values))
    raise TypeError(node)  # _check lets nothing else through
