"""Building the engine once and loading it: a shared library kept under the hash of all that went into it."""

from functools import lru_cache
from pathlib import Path

from . import cache, compiler, interface

_HERE = Path(__file__).parent
_WRITERS = ("generate.py", "state_methods.py", "collocation.py", "rows.py", "../pendulum/formula.py")


def sources() -> dict[str, str]:
    """The engine's hand-written C files, by name."""
    return {path.name: path.read_text() for path in sorted((_HERE / "c").glob("*.[ch]"))}


def library(catalogue, gravity) -> Path:
    """The path of the engine compiled for these effects, from the cache or compiled now (about two seconds).

    EngineError where there is no compiler or it fails, or the cache cannot be written.
    """
    parts = sources() | {"catalogue.h": header(tuple(catalogue), tuple(gravity))}
    content = cache.key(*parts, *parts.values(), *compiler.FLAGS, compiler.processor())
    by = compiler.find()
    if by is None:  # then an engine that any compiler has made of the same is as good
        for path in sorted(cache.folder().glob(f"engine-{content}-*.so")):
            if cache.is_whole(path):
                return path
        by = compiler.found()

    def make(path):
        for name, text in parts.items():
            (path.parent / name).write_text(text)
        compiler.compile_library("engine.c", path, path.parent)

    return cache.kept(f"engine-{content}-{cache.key(by.identity)}.so", make)


def header(catalogue, gravity) -> str:
    """The generated header, kept beside the libraries under the formulas' hash: sympy is imported only when they change."""
    name = cache.key(repr((catalogue, gravity)), *((_HERE / writer).read_text() for writer in _WRITERS))

    def make(path):
        # here, because sympy takes half a second and only a changed catalogue needs it
        from . import generate

        path.write_text(generate.source(catalogue, gravity))

    return cache.kept(f"catalogue-{name}.h", make).read_text()


@lru_cache
def load(catalogue, gravity):
    """The loaded engine for a tuple of effects and a tuple of gravities: what ``interface`` takes as its library."""
    return interface.ffi().dlopen(str(library(catalogue, gravity)))
