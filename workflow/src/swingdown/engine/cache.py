"""Files that are made once on a machine and kept: each under a name that tells all it was made from, with its checksum."""

import hashlib
import os
import tempfile
from collections.abc import Callable
from pathlib import Path

import platformdirs

from ..errors import EngineError


def folder() -> Path:
    """The folder that keeps compiled engines: SWINGDOWN_CACHE if set, else the user's cache folder."""
    return Path(os.environ.get("SWINGDOWN_CACHE") or platformdirs.user_cache_dir("swingdown"))


def key(*parts: str) -> str:
    """A short name for a content: 20 hexadecimal digits of the SHA-256 of all parts."""
    return hashlib.sha256("\0".join(parts).encode()).hexdigest()[:20]


def kept(name: str, make: Callable[[Path], None]) -> Path:
    """The path of a file of the folder, made by ``make(path)`` unless it is there and whole.

    A file that does not match the checksum beside it (a full disk, a crash, a copy that broke off) is made again. Any
    number of processes may ask at once: each makes its own and puts it in place in one step. EngineError where the folder
    cannot be written, and whatever ``make`` raises.
    """
    path = folder() / name
    if not is_whole(path):
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            put(path, make)
        except OSError as problem:
            raise EngineError(
                f"engine, folder {path.parent}",
                f"the compiled engine cannot be kept there ({problem.strerror or problem})",
                "a folder that can be written, with some MB free",
                "set SWINGDOWN_CACHE to one",
            ) from problem
    return path


def is_whole(path: Path) -> bool:
    """Whether a file is there and matches the checksum beside it."""
    try:
        return _checksum_file(path).read_text() == _checksum(path)
    except OSError:
        return False


def put(path: Path, make: Callable[[Path], object]) -> None:
    """Have a file made by ``make(draft)`` beside its place, in a folder that is there, and put it there with its checksum."""
    with tempfile.TemporaryDirectory(dir=path.parent, prefix="making-") as work:
        draft = Path(work) / path.name
        make(draft)
        _checksum_file(draft).write_text(_checksum(draft))
        # between the two the file does not match: whoever looks then makes it again, to the same content
        os.replace(draft, path)
        os.replace(_checksum_file(draft), _checksum_file(path))


def _checksum_file(path):
    return path.with_name(path.name + ".sha256")


def _checksum(path):
    return hashlib.sha256(path.read_bytes()).hexdigest()
