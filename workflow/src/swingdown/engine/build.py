"""Compiling the engine once and loading it: a shared library kept under the hash of all that went into it."""

import ctypes
import hashlib
import os
import platform
import shutil
import subprocess
import tempfile
from functools import lru_cache
from pathlib import Path

import platformdirs

_HERE = Path(__file__).parent
# No fast-math and no contraction: every machine gives the same bits.
_FLAGS = ("-O3", "-std=c99", "-fPIC", "-shared", "-ffp-contract=off", "-fno-math-errno", "-fno-trapping-math")


class EngineError(RuntimeError):
    """The engine could not be compiled or loaded; the message says what to install."""


def _compiler():
    command = os.environ.get("CC") or next(
        (name for name in ("gcc", "cc", "clang") if shutil.which(name)), None
    )
    if command is None:
        raise EngineError(
            "no C compiler found. Install gcc (or set CC to a C compiler); it is needed once, at the first use."
        )
    return command


def _processor():
    """What distinguishes processors that cannot run each other's native code."""
    try:
        flags = next(
            line
            for line in Path("/proc/cpuinfo").read_text().splitlines()
            if line.startswith(("flags", "Features"))
        )
    except (OSError, StopIteration):
        flags = platform.processor()
    return f"{platform.machine()} {flags}"


def folder():
    """The folder that keeps compiled engines: SWINGDOWN_CACHE if set, else the user's cache folder."""
    return Path(os.environ.get("SWINGDOWN_CACHE") or platformdirs.user_cache_dir("swingdown"))


def library(catalogue, gravity):
    """The path of the engine compiled for these effects, from the cache or compiled now (about two seconds).

    EngineError where there is no compiler or it fails.
    """
    parts = {name: (_HERE / "c" / name).read_text() for name in ("swing.h", "points.h", "swing.c", "fit.c")}
    header = _header(tuple(catalogue), tuple(gravity))
    flags = (*_FLAGS, "-march=native")
    key = hashlib.sha256("\0".join([header, *parts.values(), *flags, _processor()]).encode()).hexdigest()[:20]
    path = folder() / f"engine-{key}.so"
    if not path.exists():
        _compile(path, parts | {"catalogue.h": header}, flags)
    return path


def _header(catalogue, gravity):
    """The generated header, kept beside the libraries under the formulas' hash: sympy is imported only when they change."""
    writers = [
        (_HERE / name).read_text()
        for name in ("generate.py", "collocation.py", "rows.py", "../pendulum/formula.py")
    ]
    key = hashlib.sha256(
        "\0".join([repr([effect.numerics for effect in (*catalogue, *gravity)]), *writers]).encode()
    ).hexdigest()[:20]
    path = folder() / f"catalogue-{key}.h"
    if path.exists():
        return path.read_text()
    from . import generate  # here, because sympy takes half a second and only a changed catalogue needs it

    text = generate.source(catalogue, gravity)
    path.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.NamedTemporaryFile("w", dir=path.parent, delete=False) as file:
        file.write(text)
    os.replace(file.name, path)
    return text


def _compile(path, parts, flags):
    path.parent.mkdir(parents=True, exist_ok=True)
    compiler = _compiler()
    with tempfile.TemporaryDirectory(dir=path.parent) as work:
        for name, text in parts.items():
            (Path(work) / name).write_text(text)
        command = [*compiler.split(), *flags, "-o", "engine.so", "swing.c", "fit.c", "-lm"]
        done = subprocess.run(command, cwd=work, capture_output=True, text=True)
        if done.returncode:
            raise EngineError(f"the C compiler failed: {' '.join(command)}\n{done.stderr[-2000:]}")
        os.replace(Path(work) / "engine.so", path)


class CPart(ctypes.Structure):
    _fields_ = [(name, ctypes.c_int) for name in ("row", "first_parameter", "first_state")]


class CModel(ctypes.Structure):
    _fields_ = [
        (name, ctypes.c_int) for name in ("n_motions", "n_sensors", "n_clocks", "n_parameters", "n_states")
    ]
    _fields_ += [(name, ctypes.POINTER(CPart)) for name in ("motions", "sensors", "clocks")]
    _fields_ += [("play", ctypes.c_int), ("duration", ctypes.c_double)]


class CReport(ctypes.Structure):
    _fields_ = [(name, ctypes.c_int) for name in ("status", "panels", "rejected", "evaluations", "reversals")]
    _fields_ += [("error", ctypes.c_double), ("stuck_after", ctypes.c_double)]


class COutcome(ctypes.Structure):
    _fields_ = [
        ("converged", ctypes.c_int),
        ("evaluations", ctypes.c_int),
        ("predicted", ctypes.c_double),
        ("stops", ctypes.c_int),
    ]


COST = ctypes.CFUNCTYPE(
    ctypes.c_double, ctypes.c_void_p, *[ctypes.POINTER(ctypes.c_double)] * 3
)  # of, x, gradient, hessian


@lru_cache
def load(catalogue, gravity):
    """The loaded engine for a tuple of effects and a tuple of gravities, its functions typed."""
    engine = ctypes.CDLL(str(library(catalogue, gravity)))
    number, real, numbers, reals = (
        ctypes.c_int,
        ctypes.c_double,
        ctypes.POINTER(ctypes.c_int),
        ctypes.POINTER(ctypes.c_double),
    )
    model, several = ctypes.POINTER(CModel), ctypes.POINTER(reals)
    engine.swing_trajectory.restype = number
    engine.swing_trajectory.argtypes = (
        model, reals, real, real, reals, number, real, number, numbers, reals, reals, ctypes.POINTER(CReport)
    )  # fmt: skip
    engine.minimise.restype = real
    engine.minimise.argtypes = (
        COST, ctypes.c_void_p, number, reals, reals, reals, number, real, reals, ctypes.POINTER(COutcome)
    )  # fmt: skip
    engine.fit_swings.restype = real
    engine.fit_swings.argtypes = (
        model, number, numbers, several, several, reals, numbers, number, number, reals, reals, reals, number, real, number,
        reals, reals, reals, ctypes.POINTER(COutcome),
    )  # fmt: skip
    engine.fit_batch.restype = number
    engine.fit_batch.argtypes = (
        model, number, reals, number, reals, reals, numbers, number, reals, reals, number, real, reals, reals, numbers, numbers
    )  # fmt: skip
    return engine
