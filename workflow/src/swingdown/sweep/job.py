"""One job of a sweep: its chunk computed, unless it is whole already, and a small record of what that took.

Snakemake sees the record alone. It removes what a job makes before the job runs, and when it fails; a chunk it never touches.
So a job that was queued by a run long dead finds its chunk whole and leaves it.
"""

import json
import os
from importlib import import_module
from pathlib import Path

from .. import dataset
from ..errors import InputError
from ..sealed import write_text
from . import code
from .chunks import find_chunk
from .compute import compute


def work(book: str, stem: str, results: str) -> str:
    """In words what was done: the chunk ``stem`` (its name, and the code's version) of the book, in the file ``results``.

    InputError where the code is no longer the one that the run was started with.
    """
    if Path(results).exists():
        return f"{stem} is whole already"
    name, _, wanted = stem.partition("-")
    chunk = find_chunk(book, name)
    if wanted not in ("", code.version(chunk.computes)):
        raise InputError(f"sweep, code of {chunk.computes}", f"the code was changed since the run began (it was {wanted}, it is {code.version(chunk.computes)})",
                         "one code for a run", "give the same command again")  # fmt: skip
    data, told = compute(chunk, import_module(f".{chunk.computes}", __package__))
    try:
        dataset.write(data, results, replace=False)
    except FileExistsError:
        return f"{told}\nanother job was first; its results stay"
    return told


def record(results: str, path: str) -> str:
    """The path of the record written: what the chunk in the file ``results`` took, by whose code (JSON)."""
    told = dataset.attributes(results)
    kept = {key: told[key] for key in ("computes", "code", "swingdown", "cpu_s") if key in told}
    return str(write_text(path, json.dumps(kept | {"host": os.uname().nodename}) + "\n"))
