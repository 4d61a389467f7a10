"""The C compiler of the machine, and shared libraries by it."""

import os
import platform
import shlex
import shutil
import subprocess
from pathlib import Path
from typing import NamedTuple

from ..errors import EngineError

# No fast-math and no contraction: every machine gives the same bits.
FLAGS = ("-O3", "-std=c99", "-fPIC", "-shared", "-ffp-contract=off", "-fno-math-errno", "-fno-trapping-math")
NATIVE = "-march=native"  # several times faster where the compiler knows the processor
_NAMES = ("gcc", "cc", "clang")
MEND = "install gcc or clang, or set CC to a C compiler; it is needed once, at the first use on a machine"


class Compiler(NamedTuple):
    """A compiler's command, and what tells it from others and from its own older versions."""

    command: tuple[str, ...]
    identity: str


def find() -> Compiler | None:
    """The compiler that CC names, else the first of gcc, cc and clang on the PATH, else None.

    It is told by its file, size and date: to ask it for its version would take longer than most starts. EngineError where
    CC names a program that is not there.
    """
    asked = os.environ.get("CC", "")
    command = tuple(shlex.split(asked)) or tuple(name for name in _NAMES if shutil.which(name))[:1]
    if not command:
        return None
    if shutil.which(command[0]) is None:
        raise EngineError(
            f"engine, environment variable CC={asked}", f"there is no program {command[0]!r}", mend=MEND
        )
    programs = [Path(found).resolve() for word in command if (found := shutil.which(word))]
    about = [(str(path), path.stat().st_size, path.stat().st_mtime_ns) for path in programs]
    return Compiler(command, repr((command, about)))


def found() -> Compiler:
    """As ``find``, but EngineError where there is none."""
    compiler = find()
    if compiler is None:
        raise EngineError("engine", f"there is no C compiler ({', '.join(_NAMES)})", mend=MEND)
    return compiler


def processor() -> str:
    """What distinguishes processors that cannot run each other's native code."""
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
        flags = next(line for line in lines if line.startswith(("flags", "Features")))
    except (OSError, StopIteration):
        flags = platform.processor()
    return f"{platform.machine()} {flags}"


def compile_library(source: str, target: Path, cwd: Path, *processors: str) -> None:
    """Compile one C file of the folder ``cwd`` to the shared library ``target``.

    ``processors``: the flags to try for whom it is, the first that the compiler knows; by default this very processor, else any
    of its kind. EngineError with the compiler's words where it fails.
    """
    command = found().command
    for processor in processors or (NATIVE, ""):
        flags = (*FLAGS, processor) if processor else FLAGS
        line = [*command, *flags, "-o", str(target), source, "-lm"]
        try:
            done = subprocess.run(line, cwd=cwd, capture_output=True, text=True)
        except OSError as problem:
            raise EngineError(
                "engine", f"the C compiler {command[0]!r} does not start ({problem.strerror})", mend=MEND
            ) from problem
        if not done.returncode:
            return
    raise EngineError(
        "engine",
        f"the C compiler failed: {shlex.join(line)}\n{done.stderr[-2000:].strip()}",
        mend="install another C compiler, or set CC to one",
    )
