"""The engine's own exponential, logarithm and powers: near the true values, and as told where there is none."""

import ctypes

import numpy as np
import pytest

from swingdown.engine import build, compiler

PROGRAM = """#include "elementary.h"
void exponentials(const double *x, double *out, int n) { for (int i = 0; i < n; i++) out[i] = exponential(x[i]); }
void logarithms(const double *x, double *out, int n) { for (int i = 0; i < n; i++) out[i] = logarithm(x[i]); }
void roots(const double *x, double *out, int n) { for (int i = 0; i < n; i++) out[i] = power_of(x[i], 0.3); }
"""
ULP = np.finfo(float).eps


@pytest.fixture(scope="module")
def evaluate(tmp_path_factory):
    folder = tmp_path_factory.mktemp("elementary")
    for name, text in build.sources().items():
        (folder / name).write_text(text)
    (folder / "functions.c").write_text(PROGRAM)
    compiler.compile_library("functions.c", folder / "functions.so", folder)
    library = ctypes.CDLL(str(folder / "functions.so"))

    def called(name, x):
        x, out = np.ascontiguousarray(x, dtype=float), np.empty(len(x))
        pointers = [array.ctypes.data_as(ctypes.POINTER(ctypes.c_double)) for array in (x, out)]
        getattr(library, name)(*pointers, x.size)
        return out

    return called


def off(found, true):
    """The largest error, in units in the last place of a number of that size."""
    return float(np.max(np.abs(found - true) / np.abs(true))) / ULP


def test_exponentials(evaluate):
    x = np.concatenate([np.linspace(-40, 40, 4001), np.linspace(-707, 708, 999), [0.0, 1e-300, -1e-17]])
    true = np.exp(x.astype(np.longdouble))
    assert off(evaluate("exponentials", x), true) < 1.2
    assert evaluate("exponentials", [0.0])[0] == 1.0


def test_exponentials_out_of_range(evaluate):
    found = evaluate("exponentials", [-1e6, -np.inf, 1e6, np.inf, np.nan])
    assert np.array_equal(found, [0.0, 0.0, np.inf, np.inf, np.nan], equal_nan=True)


def test_logarithms(evaluate):
    x = np.concatenate([np.geomspace(1e-300, 1e300, 4000), 1 + np.linspace(-0.41, 0.597, 1000), [0.5, 2.0]])
    true = np.log(x.astype(np.longdouble))
    assert off(evaluate("logarithms", x), true) < 1.2
    assert evaluate("logarithms", [1.0])[0] == 0.0


def test_powers(evaluate):
    x = np.geomspace(1e-4, 1e3, 4001)
    assert off(evaluate("roots", x), x.astype(np.longdouble) ** np.longdouble(0.3)) < 5
    assert evaluate("roots", [1e-300])[0] == pytest.approx(1e-90, rel=1e-13)
