"""Which of the package's files a script rests on, so that editing one of them runs its rules again.

Snakemake reruns a rule when its script changes, but knows nothing of what the script imports. It is told by a parameter of the rule: as
inputs of every job, some sixty files, they cost Snakemake more than many a job.
"""

import ast
import hashlib
import re
from collections.abc import Iterator, Sequence
from contextlib import suppress
from functools import cache
from pathlib import Path

PACKAGE = Path(__file__).resolve().parents[1]
TRIALS = "swingdown_trials"  # the package beside it


def sources(script: str | Path) -> list[str]:
    """The sorted paths of the package's files that ``script`` imports, directly or through one another.

    A sub-package counts with its ``__init__`` and what is imported of it, and with the C and YAML files that lie in it. Imports
    inside functions count.
    """
    seen, waiting = set(), list(imported(script))
    while waiting:
        file = waiting.pop()
        if file not in seen:
            seen.add(file)
            waiting += imported(file)
            if file.name == "__init__.py" and file.parent != PACKAGE:
                seen |= _data(file.parent)
    return sorted(map(str, seen))


@cache
def _data(folder: Path) -> frozenset[Path]:
    """The C and YAML files of a sub-package. To look through its folders takes longer than all else, and each script rests on many."""
    return frozenset(data for ending in ("c", "h", "yaml") for data in folder.rglob(f"*.{ending}"))


@cache
def fingerprint(script: str | Path) -> str:
    """16 hexadecimal digits that change when a file of the package that ``script`` rests on is edited, added or taken away."""
    digest = hashlib.sha256()
    for file in sources(script):
        digest.update(f"{Path(file).relative_to(PACKAGE.parent).as_posix()} {_content(file)}\n".encode())
    return digest.hexdigest()[:16]


@cache
def _content(file: str) -> str:
    return hashlib.sha256(Path(file).read_bytes()).hexdigest()


@cache
def imported(file: str | Path) -> tuple[Path, ...]:
    """The package's files that one Python file imports, as a tuple of paths."""
    file = Path(file).resolve()
    roots = {name: PACKAGE.with_name(name) for name in (PACKAGE.name, TRIALS)}
    inside = any(root in file.parents for root in roots.values())
    found: list[Path] = []
    for node in _imports(file.read_text(encoding="utf-8")):
        if isinstance(node, ast.Import):
            for alias in node.names:
                first, *rest = alias.name.split(".")
                if first in roots:
                    found += _files(roots[first], rest)
        elif isinstance(node, ast.ImportFrom):
            parts = (node.module or "").split(".") if node.module else []
            if node.level and inside:
                base = file.parents[node.level - 1]
            elif not node.level and parts and parts[0] in roots:
                base, parts = roots[parts[0]], parts[1:]
            else:
                continue
            for alias in node.names:
                found += _files(base, [*parts, alias.name])
    return tuple(dict.fromkeys(found))


# To parse whole files takes longer than all else that a run has to plan.
_IMPORT = re.compile(r"^[ \t]*((?:import|from)[ \t][^\n(]*(?:\([^)]*\))?)", re.MULTILINE)


def _imports(text: str) -> Iterator[ast.stmt]:
    """All import statements of a source, those inside functions too; a sentence that begins as one is none."""
    for statement in _IMPORT.findall(text):
        with suppress(SyntaxError):
            yield from ast.parse(statement).body


def _files(base: Path, parts: Sequence[str]) -> Iterator[Path]:
    """The files that ``import base.parts`` reads; a last part that is a name inside a module adds none."""
    for part in parts:
        module, package = base / f"{part}.py", base / part / "__init__.py"
        if module.is_file():
            yield module
            return
        if not package.is_file():
            return
        yield package
        base = base / part
