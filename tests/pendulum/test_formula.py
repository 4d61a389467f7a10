"""Formulas come from config files: what they may say is a whitelist, and nothing in one can run."""

import builtins
import contextlib
import math
import os

import pytest
import sympy
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from swingdown.errors import InputError
from swingdown.pendulum import formula

NAMES = ("theta", "thetadot", "t", "k", "w_b")


def test_arithmetic_means_what_it_says():
    theta, k = formula.symbol("theta"), formula.symbol("k")
    assert formula.parse("-k*sin(5*theta + pi)**2/2", NAMES) == -k * sympy.sin(5 * theta + sympy.pi) ** 2 / 2
    assert formula.parse("+k - -k", NAMES) == 2 * k
    assert formula.parse("abs(theta)*sign(theta)", NAMES).subs(theta, -3) == -3
    assert formula.parse("2**-3", NAMES) == sympy.Rational(1, 8)
    assert float(formula.parse("1e-3", NAMES)) == 1e-3
    taken = formula.evaluate("-k*sin(5*theta + pi/2)**2/2", k=2.0, theta=0.3)
    assert taken == pytest.approx(-(math.cos(1.5) ** 2))


@pytest.mark.parametrize("name", formula.FUNCTIONS)
def test_every_function_takes_one_argument(name):
    assert formula.parse(f"{name}(k)", NAMES).free_symbols <= {formula.symbol("k")}
    for text in (f"{name}()", f"{name}(k, 2)", f"{name}(x=k)", f"{name}(*k)", f"{name}(**k)", name):
        with pytest.raises(InputError):
            formula.parse(text, NAMES)


REFUSED = [
    "__import__('os').system('touch pwned')",
    "eval('1')",
    "exec('1')",
    "open('/etc/passwd')",
    "theta.__class__",
    "theta.real",
    "(1).__class__.__bases__[0].__subclasses__()",
    "sin.__globals__",
    "k[0]",
    "lambda: 1",
    "(lambda k: k)(1)",
    "[k for k in (1, 2)]",
    "{k: 1}",
    "{k}",
    "(k, k)",
    "[k]",
    "k if theta else 1",
    "k and theta",
    "not k",
    "~k",
    "k < 1",
    "k == 1",
    "k // 2",
    "k % 2",
    "k << 2",
    "k @ k",
    "k | k",
    "f'{k}'",
    "f'{__import__(\"os\")}'",
    "'k'",
    "b'k'",
    "True",
    "None",
    "...",
    "1j",
    "(k := 2)",
    "k = 2",
    "k; k",
    "import os",
    "await k",
    "yield",
    "*k",
    "unknown",
    "Symbol('k')",
    "sympy.sin(k)",
    "globals()",
    "sin(cos)",
    "sin(k)(k)",
    "gamma(k)",
    "nan",
    "inf",
    "oo",
    "zoo",
    "E",
    "I",
    "k**21",
    "k**-21",
    "k**(10*3)",
    "2**9**9",
    "9**9**9**9",
    "k/0",
    "k/(1 - 1)",
    "",
    "   ",
    "\n",
    "k +",
    ")(",
    "k\0",
]


@pytest.mark.parametrize("text", REFUSED)
def test_everything_else_is_refused(text):
    with pytest.raises(InputError) as refusal:
        formula.parse(text, NAMES, where="effect mine, torque")
    assert str(refusal.value).startswith("effect mine, torque: ")


def test_nothing_runs(tmp_path, monkeypatch):
    """Neither eval nor exec is called while formulas are read, and no file appears."""
    monkeypatch.chdir(tmp_path)
    called = []
    for name in ("eval", "exec"):
        monkeypatch.setattr(builtins, name, lambda *_, name=name, **__: called.append(name))
    for text in REFUSED:
        with pytest.raises(InputError):
            formula.parse(text, NAMES)
    monkeypatch.undo()
    assert called == [] and os.listdir(tmp_path) == []


@pytest.mark.parametrize("value", [None, 3, 2.0, ["k"], b"k", {"k": 1}])
def test_only_a_text_is_a_formula(value):
    with pytest.raises(InputError, match="not text"):
        formula.parse(value, NAMES)


@pytest.mark.parametrize(
    "text",
    [
        "(" * 190 + "k" + ")" * 190,
        "-" * 390 + "k",
        "sin(" * 70 + "k" + ")" * 70,
        "k" + "**2" * 100,
        "1+" * 199 + "1",
    ],
    ids=["parentheses", "signs", "calls", "powers", "terms"],
)
def test_depth_does_not_crash(text):
    with contextlib.suppress(InputError):
        formula.parse(text, NAMES)


def test_length_is_limited():
    with pytest.raises(InputError, match="characters long"):
        formula.parse("1+" * 200 + "1", NAMES)
    formula.parse("1+" * 199 + "10", NAMES)  # 400 characters


@pytest.mark.parametrize(
    "text",
    [
        "1e999",
        "-1e999",
        "1e308*10",
        "1e300**10",
        "0**-1",
        "0*1e999",
        "log(0)",
        "1/sin(0)",
        "sqrt(-1)",
        "log(-2)",
    ],
)
def test_numbers_that_are_none_are_refused(text):
    with pytest.raises(InputError):
        formula.parse(text, NAMES)


@pytest.mark.parametrize(
    "text", ["9" * 390, "20**20**2", "(20**20)**20", "((20**20)**20)**20", "exp(exp(exp(exp(9))))"]
)
def test_huge_numbers_end_soon(text):
    """Either refused or a finite number: never minutes of work, never digits by the million."""
    try:
        found = formula.parse(text, NAMES)
    except InputError:
        return
    assert len(str(found)) < 5000


ALPHABET = "thetadokw_b0123456789.+-*/() ,sincoexpabgqrlp'\"[]{}:=<>%!@#\\\n\t;~|&^"
_leaf = st.sampled_from([*NAMES, "pi", "1", "0", "2.5", "1e3", ".1"])
_grown = st.recursive(
    _leaf,
    lambda inner: st.one_of(
        st.tuples(inner, st.sampled_from("+-*/"), inner).map("".join),
        st.tuples(inner, st.integers(-6, 6)).map(lambda x: f"({x[0]})**({x[1]})"),
        st.tuples(st.sampled_from(sorted(formula.FUNCTIONS)), inner).map(lambda x: f"{x[0]}({x[1]})"),
        inner.map(lambda x: f"(-{x})"),
    ),
    max_leaves=8,
)
_quick = settings(
    max_examples=150, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.too_slow]
)


@given(st.one_of(st.text(max_size=60), st.text(ALPHABET, max_size=60), _grown))
@_quick
def test_any_text_is_an_expression_of_known_names_or_is_refused(text):
    try:
        found = formula.parse(text, NAMES)
    except InputError:
        return
    assert isinstance(found, sympy.Expr)
    assert {symbol.name for symbol in found.free_symbols} <= set(NAMES)
    assert not found.has(sympy.zoo, sympy.nan, sympy.oo, -sympy.oo, sympy.I)
