"""Where a file named in the config or a sheet is found, and how a file comes to be: whole, or not at all."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


def _checkout() -> Path | None:
    """The folder with the workflow around this package; None where the package was installed by itself."""
    folder = Path(__file__).resolve().parents[3]
    inside = folder / "workflow" / "src" / "swingdown" / "paths.py"
    return folder if inside.is_file() and (folder / "Snakefile").is_file() else None


PROJECT = _checkout()
_SCHEMES = ("http://", "https://", "file://")


def is_url(name: object) -> bool:
    """True for an http, https or file address, False for a path."""
    return str(name).startswith(_SCHEMES)


def find(name: str | Path) -> Path:
    """The path of ``name``: in the working directory (or absolute) if it is there, else in the project's
    folder, where the package lies in one.

    A study run with ``--directory elsewhere`` finds its own files first and the shipped ones after. A name
    found in neither place comes back unchanged, so that the caller's message shows what was written.
    """
    path = Path(name)
    if PROJECT and not path.is_absolute() and not path.exists() and (PROJECT / path).exists():
        return PROJECT / path
    return path


@contextmanager
def written_whole(path: str | Path) -> Iterator[Path]:
    """A path to write to, beside ``path``: what is there at the end takes its name, on disk and whole.

    Where writing fails, ``path`` is as it was before and nothing is left behind.
    """
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    partial = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        yield partial
        _to_disk(partial)
        os.replace(partial, path)
        _to_disk(path.parent)
    finally:
        partial.unlink(missing_ok=True)


def _to_disk(path: Path) -> None:
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
