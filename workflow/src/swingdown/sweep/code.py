"""Which code computed a draw: a few digits that change when a formula or the numerics change, and with nothing else."""

import ast
import hashlib
import json
import re
from functools import cache
from importlib.metadata import PackageNotFoundError
from importlib.metadata import version as installed
from pathlib import Path

import yaml

from ..planning.sources import PACKAGE, sources

# The rooms whose code makes the numbers, and the files beside them; what reads, writes and prints changes no number.
_ROOMS = ("pendulum", "engine", "fitting", "discovery")
_FILES = (
    "studies/noise.py",
    "sweep/draws.py",
    "sweep/identification.py",
    "sweep/noise_free.py",
    "sweep/detection.py",
)
_C_COMMENT = re.compile(r'//[^\n]*|/\*.*?\*/|("(?:\\.|[^"\\])*")', re.DOTALL)


@cache
def version(computes: str) -> str:
    """8 hexadecimal digits that stand for the code of a computation: its syntax, less comments and docstrings."""
    module = Path(__file__).with_name(f"{computes}.py")
    digest = hashlib.sha256()
    for file in [str(module), *sources(module)]:
        name = Path(file).resolve().relative_to(PACKAGE).as_posix()
        if name.split("/")[0] in _ROOMS or name in _FILES:
            digest.update(f"{name}\n{_meaning(Path(file))}\n".encode())
    return digest.hexdigest()[:8]


def project() -> str:
    """The project's version, as installed."""
    try:
        return installed("swingdown")
    except PackageNotFoundError:
        return "unknown"


def _meaning(file):
    """What a source file says to the machine: no comment, no docstring, no layout."""
    text = file.read_text(encoding="utf-8")
    if file.suffix == ".py":
        return _syntax(text)
    if file.suffix == ".yaml":
        return json.dumps(yaml.safe_load(text), sort_keys=True, default=str)
    return " ".join(_C_COMMENT.sub(lambda found: found[1] or " ", text).split())


def _syntax(text):
    tree = ast.parse(text)
    for node in ast.walk(tree):
        with_docstring = isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef)
        if with_docstring and ast.get_docstring(node) is not None:
            node.body[0].value.value = ""
    return ast.dump(tree)
