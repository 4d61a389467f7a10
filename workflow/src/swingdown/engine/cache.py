"""Files that are made once on a machine and kept: each under a name that tells all it was made from, with its checksum.

What is kept is run. So the folder and its files must be the user's or root's, and nobody else may write them: a checksum tells
damage, and not who wrote it.
"""

import hashlib
import os
import shlex
import sys
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path

from ..errors import EngineError
from ..paths import checksum


def folder() -> Path:
    """The folder that keeps compiled engines: SWINGDOWN_CACHE if set, else the user's cache folder, as each system has it."""
    if own := os.environ.get("SWINGDOWN_CACHE"):
        return Path(own)
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA") or Path.home() / "AppData/Local") / "swingdown" / "Cache"
    if sys.platform == "darwin":
        return Path.home() / "Library/Caches/swingdown"
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "swingdown"


def key(*parts: str) -> str:
    """A short name for a content: 20 hexadecimal digits of the SHA-256 of all parts."""
    return hashlib.sha256("\0".join(parts).encode()).hexdigest()[:20]


def kept(name: str, make: Callable[[Path], None]) -> Path:
    """The path of a file of the folder, made by ``make(path)`` unless it is there and whole.

    A file that does not match the checksum beside it (a full disk, a crash, a copy that broke off) is made again. Any
    number of processes may ask at once: each makes its own and puts it in place in one step. EngineError where the folder
    cannot be written or another user could have written there, and whatever ``make`` raises.
    """
    for path in found(name):
        return path
    path = folder() / name
    try:
        path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        put(path, make)
    except OSError as problem:
        raise EngineError(
            f"engine, folder {path.parent}",
            f"the compiled engine cannot be kept there ({problem.strerror or problem})",
            "a folder that can be written, with some MB free",
            "set SWINGDOWN_CACHE to one",
        ) from problem
    return path


def found(pattern: str) -> Iterator[Path]:
    """The files of the folder that match a pattern and are whole. EngineError where another user could have written one."""
    if folder().is_dir():
        _check_owner(folder())
        for path in sorted(folder().glob(pattern)):
            if is_whole(path):
                _check_owner(path)
                yield path


def _check_owner(path: Path) -> None:
    if not hasattr(os, "geteuid"):
        return  # a system with other kinds of rights
    about = path.stat()
    if about.st_uid not in (os.geteuid(), 0):
        problem = f"it belongs to another user (number {about.st_uid})"
        mend = "set SWINGDOWN_CACHE to a folder of your own, or to one that does not exist yet"
    elif about.st_mode & 0o022:
        problem = "others may write there, and what it holds is run"
        mend = f"chmod -R go-w {shlex.quote(str(folder()))}, if nobody else has; or set SWINGDOWN_CACHE to another folder"
    else:
        return
    raise EngineError(path, problem, "a cache that you or root alone can write", mend)


def is_whole(path: Path) -> bool:
    """Whether a file is there and matches the checksum beside it."""
    try:
        return _checksum_file(path).read_text() == checksum(path)
    except OSError:
        return False


def put(path: Path, make: Callable[[Path], object]) -> None:
    """Have a file made by ``make(draft)`` beside its place, in a folder that is there, and put it there with its checksum."""
    with tempfile.TemporaryDirectory(dir=path.parent, prefix="making-") as work:
        draft = Path(work) / path.name
        make(draft)
        draft.chmod(draft.stat().st_mode & ~0o022)
        _checksum_file(draft).write_text(checksum(draft))
        # between the two the file does not match: whoever looks then makes it again, to the same content
        os.replace(draft, path)
        os.replace(_checksum_file(draft), _checksum_file(path))


def _checksum_file(path):
    return path.with_name(path.name + ".sha256")
