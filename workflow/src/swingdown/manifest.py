"""Which files a study left, and their checksums: written at the end of a run, held against the folder at any time after."""

import json
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

from .errors import MAKE_ANEW, InputError
from .paths import checksum, write_json
from .sealed import agrees, is_seal, is_whole, seal_of

NAME = "manifest.json"
_LEFT_OUT = {"logs", "benchmarks"}  # they tell of the run, and differ from one to the next
_MEND = "run the study again, which writes it"


def write_manifest(
    results: str | Path, output: str | Path, parts: Sequence[str] = (".",), without: Sequence[str] = ()
) -> int:
    """How many files the manifest lists.

    An entry is path (relative to the folder ``results``), size in bytes and SHA-256, sorted by path. ``parts`` are files or folders
    relative to ``results``, of which those ``without`` are left out; what is not there has no files. Manifests, seals, logs, benchmarks and
    unfinished files are not listed. InputError if a file is not what its seal was taken of; no ``output`` is written then.
    """
    results = Path(results)
    outside = [results / part for part in without]
    inside = [path for path in _files(results, parts) if not any(map(path.is_relative_to, outside))]
    digests = {path: checksum(path) for path in inside}
    if broken := [str(path) for path, digest in digests.items() if not is_whole(path, digest)]:
        more = f" (and so are {', '.join(broken[1:])})" if broken[1:] else ""
        problem = f"it or its seal was damaged or edited{more}"
        raise InputError(broken[0], problem, "results that a manifest lists", MAKE_ANEW)
    entries = [
        {"path": path.relative_to(results).as_posix(), "size": path.stat().st_size, "sha256": digest}
        for path, digest in digests.items()
    ]
    write_json(output, {"files": entries})
    return len(entries)


def verify(results: str | Path) -> tuple[dict[str, list[str]], int]:
    """How a folder differs from all manifests below it (the paths that are ``missing``, ``changed`` or ``unknown``), and how many files these
    list.

    Each target writes its own manifest, so a file that two of them list is as it should be when either agrees. A seal that does not
    belong to what is listed counts as changed. InputError where there is no manifest, or one that cannot be read.
    """
    results = Path(results)
    manifests = sorted(results.rglob(NAME)) if results.is_dir() else []
    if not manifests:
        raise InputError(results, f"there is no {NAME} in it", "the results of a study that ended", _MEND)
    listed: dict[str, set[tuple[int, str]]] = {}
    for manifest in manifests:
        for path, size, digest in _entries(manifest):
            listed.setdefault(path, set()).add((size, digest))
    there = {path.relative_to(results).as_posix(): path for path in _files(results, ["."])}
    both = sorted(listed.keys() & there.keys())
    changed = [there[name] for name in both if not _agrees(there[name], listed[name])]
    changed += [
        seal_of(there[name])
        for name in both
        if not any(agrees(there[name], digest) for _, digest in listed[name])
    ]
    return {
        "missing": sorted(listed.keys() - there.keys()),
        "changed": sorted(path.relative_to(results).as_posix() for path in changed),
        "unknown": sorted(there.keys() - listed.keys()),
    }, len(listed)


def _agrees(path: Path, entries: set[tuple[int, str]]) -> bool:
    size = path.stat().st_size
    return any(size == wanted for wanted, _ in entries) and (size, checksum(path)) in entries


def _entries(manifest: Path) -> Iterator[tuple[str, int, str]]:
    try:
        for entry in json.loads(manifest.read_text(encoding="utf-8"))["files"]:
            yield str(entry["path"]), int(entry["size"]), str(entry["sha256"])
    except (ValueError, KeyError, TypeError) as error:
        problem = f"it cannot be read ({error!r})"
        raise InputError(manifest, problem, "path, size and sha256 of each file", _MEND) from error


def _files(results: Path, parts: Iterable[str]) -> list[Path]:
    """The files of ``parts`` that a manifest lists, sorted by path."""
    found = set()
    for part in parts:
        inside = results / part
        found |= {inside} if inside.is_file() else set(inside.rglob("*"))
    return sorted(
        path
        for path in found
        if path.is_file()
        and path.name != NAME
        and not path.name.endswith(".part")
        and not is_seal(path)
        and not _LEFT_OUT & set(path.relative_to(results).parts[:-1])
        and not path.name.startswith(".snakemake")
    )
