"""Building the engine once and loading it: a shared library kept under the hash of all that went into it."""

import os
from functools import lru_cache, partial
from pathlib import Path
from typing import Any

from ..extras import needed
from ..pendulum.effect import Effect
from . import cache, compiler, interface, prebuilt

Effects = tuple[Effect, ...]

_HERE = Path(__file__).parent
_WRITERS = ("generate.py", "state_methods.py", "collocation.py", "rows.py", "../pendulum/formula.py")


def sources() -> dict[str, str]:
    """The engine's hand-written C files, by name."""
    return {path.name: path.read_text() for path in sorted((_HERE / "c").glob("*.[ch]"))}


def library(catalogue: Effects, gravity: Effects) -> Path:
    """The path of the engine compiled for these effects: that of the wheel unless CC is set, from the cache, or compiled now.

    EngineError where there is no compiler or it fails, or the cache cannot be written.
    """
    parts = _parts(catalogue, gravity)
    if not os.environ.get("CC") and (carried := prebuilt.library(_content(parts))):
        return carried
    content = _content(parts, compiler.processor())
    by = compiler.find()
    if by is None:  # then an engine that any compiler has made of the same is as good
        for path in cache.found(f"engine-{content}-*.so"):
            return path
        by = compiler.found()

    return cache.kept(f"engine-{content}-{cache.key(by.identity)}.so", partial(_compile, parts, ()))


def carry(folder: Path, catalogue: Effects, gravity: Effects) -> None:
    """Put into a folder what a wheel may carry of these effects: the header, and the engine for each level of ``prebuilt``.

    EngineError where there is no compiler, or it does not know a level.
    """
    parts = _parts(catalogue, gravity)
    folder.mkdir(parents=True, exist_ok=True)
    cache.put(folder / _header_name(catalogue, gravity), lambda path: path.write_text(parts["catalogue.h"]))
    for level, flags in prebuilt.built().items():
        path = folder / prebuilt.file_name(_content(parts), level)
        cache.put(path, partial(_compile, parts, flags))


def _parts(catalogue: Effects, gravity: Effects) -> dict[str, str]:
    return sources() | {"catalogue.h": header(tuple(catalogue), tuple(gravity))}


def _content(parts: dict[str, str], processor: str = "") -> str:
    return cache.key(*parts, *parts.values(), *compiler.FLAGS, processor)


def _compile(parts: dict[str, str], processors: tuple[str, ...], path: Path) -> None:
    for name, text in parts.items():
        (path.parent / name).write_text(text)
    compiler.compile_library("engine.c", path, path.parent, *processors)


def header(catalogue: Effects, gravity: Effects) -> str:
    """The generated header, kept beside the libraries under the formulas' hash: sympy is imported only when they change."""
    name = _header_name(catalogue, gravity)

    def make(path: Path) -> None:
        needed("sympy")  # it takes half a second, and only a changed catalogue needs it
        from . import generate

        path.write_text(generate.source(catalogue, gravity))

    return (prebuilt.header(name) or cache.kept(name, make)).read_text()


def _header_name(catalogue: Effects, gravity: Effects) -> str:
    content = cache.key(
        repr([effect.numerics for effect in (*catalogue, *gravity)]),
        *((_HERE / writer).read_text() for writer in _WRITERS),
    )
    return f"catalogue-{content}.h"


@lru_cache
def load(catalogue: Effects, gravity: Effects) -> Any:
    """The loaded engine for a tuple of effects and a tuple of gravities: what ``interface`` takes as its library."""
    return interface.ffi().dlopen(str(library(catalogue, gravity)))
