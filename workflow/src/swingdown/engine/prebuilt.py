"""Engines that a wheel may carry, so that the shipped catalogue needs no compiler: one for each level of processors.

They lie in the folder ``carried`` beside this file, each under the name of all that it was made from, with its
checksum, as in the cache; where one is older than the sources around it, it has another name and is not found. On Linux the levels
are those of the x86-64 psABI; any other machine has one. All give the same bits: a level changes how many numbers are computed at once, not how.
"""

import platform
from pathlib import Path

from . import cache, compiler

FOLDER = Path(__file__).parent / "carried"
# from the fastest on: what /proc/cpuinfo calls the instructions that each level has beyond the next
LEVELS = {
    "x86-64-v4": ("avx512f", "avx512bw", "avx512cd", "avx512dq", "avx512vl"),
    "x86-64-v3": ("avx2", "bmi1", "bmi2", "f16c", "fma", "abm", "movbe"),
    "x86-64": (),
}


def levels() -> list[str]:
    """The levels that this machine's processor has, from the fastest on."""
    if not _has_several():
        return [_only()]
    there, names = set(compiler.processor().split()), list(LEVELS)
    return [
        name for k, name in enumerate(names) if all(there.issuperset(LEVELS[below]) for below in names[k:])
    ]


def built() -> dict[str, tuple[str, ...]]:
    """The levels that a wheel of this kind of machine carries, each with the compiler's flags for it."""
    return {name: (f"-march={name}",) for name in LEVELS} if _has_several() else {_only(): ("",)}


def _has_several() -> bool:
    return platform.system() == "Linux" and platform.machine() == "x86_64"


def _only() -> str:
    return f"{platform.system()}-{platform.machine()}".lower()


def library(content: str) -> Path | None:
    """The engine made from this content that suits the processor best, or None where none lies here whole."""
    paths = [FOLDER / file_name(content, level) for level in levels()]
    return next(filter(cache.is_whole, paths), None)


def header(name: str) -> Path | None:
    """The generated header of this name, or None where it does not lie here whole."""
    path = FOLDER / name
    return path if cache.is_whole(path) else None


def file_name(content: str, level: str) -> str:
    """What the engine made from this content for a level is called."""
    return f"engine-{content}-{level}.so"
