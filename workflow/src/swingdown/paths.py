"""Where a file named in the config or a sheet is found, and how a file comes to be: whole, or not at all."""

import errno
import hashlib
import json
import os
import re
import socket
import time
import unicodedata
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from .errors import InputError, Unwritten


def _project() -> Path:
    """The folder with the Snakefile: the clone around this package, or the package's own copy where it was installed by itself."""
    package = Path(__file__).resolve().parent
    clone = package.parents[2]
    inside = clone / "workflow" / "src" / "swingdown" / "paths.py"
    return clone if inside.is_file() and (clone / "Snakefile").is_file() else package / "project"


PROJECT = _project()
_HOST = re.sub(r"[^A-Za-z0-9_-]", "_", socket.gethostname())
_PARTIAL = re.compile(r"\..+\.(?:(?P<host>[A-Za-z0-9_-]+)-)?(?P<process>\d+)\.part")
_A_DAY = 86400.0  # s
_SCHEMES = ("http://", "https://", "file://")


def is_url(name: object) -> bool:
    """True for an http, https or file address, False for a path."""
    return str(name).startswith(_SCHEMES)


def find(name: str | Path) -> Path:
    """The path of ``name``: in the working directory (or absolute) if it is there, else in the project's folder.

    A study run with ``--directory elsewhere`` finds its own files first and the shipped ones after. A name
    found in neither place comes back unchanged, so that the caller's message shows what was written.
    """
    path = Path(name)
    try:
        path.stat()
    except ValueError:  # a character that no name can hold
        return path
    except OSError as error:
        if error.errno == errno.ENAMETOOLONG:
            problem = f"no file can have so long a name ({len(str(name))} characters)"
            raise InputError(f"{str(name)[:40]}…", problem, "a path", "correct the path") from None
    if not path.is_absolute() and not path.exists() and (PROJECT / path).exists():
        return PROJECT / path
    return path


def printable(text: str) -> str:
    """The text with every character that commands a terminal, turns the direction of writing or is none as ``\\x1b``; lines and tabs stay."""
    return _COMMANDS.sub(lambda found: found[0].encode("unicode_escape").decode(), text)


_COMMANDS = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u2028-\u202e\u2066-\u2069\ud800-\udfff\ufffe\uffff]")


def safe_name(label: str) -> str:
    """``label`` as a name that every system takes for a file: ASCII letters, digits, ``.``, ``_`` and ``-``, a letter or digit first.

    Accents are left out (``Jürgen``: ``Jurgen``) and anything else becomes ``-`` (``Gruppe 3/a``: ``Gruppe-3-a``). A label of which
    letters are lost, one that is too long, and one that Windows keeps for itself are told apart by the start of their SHA-256.
    """
    if _NAME.fullmatch(label) and len(label) <= _LONGEST and not _RESERVED.fullmatch(label):
        return label
    spelt = label.translate(_SPELT)
    parts = [unicodedata.normalize("NFKD", letter).encode("ascii", "ignore").decode() for letter in spelt]
    name = re.sub(r"[^A-Za-z0-9._]+", "-", "".join(parts)).strip("-._")
    digest = hashlib.sha256(label.encode()).hexdigest()[:8]
    lost = not name or any(letter.isalnum() and not part for letter, part in zip(spelt, parts, strict=True))
    if lost or len(name) > _LONGEST or _RESERVED.fullmatch(name):
        name = f"{name[: _LONGEST - 9] or 'recording'}-{digest}"
    return name


_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]*")
_LONGEST = 100  # characters; a file's name may have 255 bytes, and endings follow
_RESERVED = re.compile(r"(?i)(con|prn|aux|nul|com\d|lpt\d)(\..*)?")
_SPELT = str.maketrans("øØłŁđĐ", "oOlLdD") | str.maketrans({"ß": "ss", "æ": "ae", "Æ": "Ae", "œ": "oe", "Œ": "Oe"})  # fmt: skip


@contextmanager
def written_whole(path: str | Path, replace: bool = True) -> Iterator[Path]:
    """A path to write to, beside ``path``: what is there at the end takes its name, on disk and whole.

    Where writing fails, ``path`` is as it was before and nothing is left behind. Unwritten where the disk is full or the folder cannot be
    written; FileExistsError, unless it may ``replace``, where there is a file of that name.
    """
    path = Path(path)
    partial = path.with_name(f".{path.name}.{_HOST}-{os.getpid()}.part")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        yield partial
        _to_disk(partial)
        (os.replace if replace else _named)(partial, path)
        _to_disk(path.parent)
    except Unwritten:
        raise
    except OSError as error:
        if told := in_words(error.errno, path):
            raise Unwritten(error.errno, told) from error
        raise
    finally:
        with suppress(OSError):
            partial.unlink(missing_ok=True)


def _named(partial: Path, path: Path) -> None:
    """The file ``partial`` gets the name ``path``. FileExistsError where there is one of that name, made at the same moment included."""
    try:
        os.link(partial, path)  # unlike a rename it never replaces
    except OSError as error:
        if error.errno not in (errno.EPERM, errno.ENOTSUP, errno.EOPNOTSUPP):
            raise
        if path.exists():  # a file system without links
            raise FileExistsError(errno.EEXIST, os.strerror(errno.EEXIST), str(path)) from None
        os.rename(partial, path)


def in_words(number: int | None, path: str | Path) -> str:
    """What is wrong, where, and the mend, of the errno of a failed write; "" for one that is not the disk's or the folder's."""
    if number not in _IN_WORDS:
        return ""
    problem, mend = _IN_WORDS[number]
    return f"{problem}: {path}. Mend: {mend}"


_SHUT = "the folder cannot be written", "choose another with --directory, or allow writing there"
_IN_WORDS = dict.fromkeys((errno.EROFS, errno.EACCES, errno.EPERM), _SHUT) | {
    errno.ENOSPC: ("the disk is full", "make room and run again"),
    errno.EDQUOT: ("the disk is full for this user", "make room and run again"),
}


def checksum(path: Path) -> str:
    """The SHA-256 of a file, in hexadecimal."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def write_text(path: str | Path, text: str) -> Path:
    """The path written, whole, in UTF-8."""
    path = Path(path)
    with written_whole(path) as partial:
        partial.write_text(text, encoding="utf-8")
    return path


def for_spreadsheets(table: Any) -> Any:
    """A table (pandas) whose texts are text in a spreadsheet, too: what begins as a formula does gets an apostrophe before it.

    Numbers, and those with their uncertainty in parentheses, stay. ``from_spreadsheets`` takes the apostrophes away.
    """
    return _texts(
        table, lambda text: f"'{text}" if _FORMULA.match(text) and not _NUMBER.fullmatch(text) else text
    )


def from_spreadsheets(table: Any) -> Any:
    """The table that was given to ``for_spreadsheets``."""
    return _texts(table, from_cell)


def from_cell(text: str) -> str:
    """A text without the apostrophe that ``for_spreadsheets`` gave it."""
    return text[1:] if text[:1] == "'" and _FORMULA.match(text[1:]) else text


def _texts(table: Any, change: Callable[[str], str]) -> Any:
    def one(value: Any) -> Any:
        return change(value) if isinstance(value, str) else value

    texts = {name: column.map(one) for name, column in table.items() if column.dtype.kind not in "fiubcmM"}
    return table.assign(**texts).rename(columns=one)


_FORMULA = re.compile(r"'*[=@+\-\t\r]")
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)(\([\d.]+\))?([eE][+-]?\d+)?")


def write_csv(table: Any, path: str | Path, **told: Any) -> Path:
    """The path written, whole: a table (pandas) ``for_spreadsheets`` as CSV, without its index unless ``told`` to ``to_csv`` otherwise."""
    path = Path(path)
    with written_whole(path) as partial:
        for_spreadsheets(table).to_csv(partial, **({"index": False} | told))
    return path


def write_json(path: str | Path, content: Any) -> Path:
    """The path written, whole: plain numbers, texts, lists and mappings as JSON."""
    return write_text(path, json.dumps(content, indent=1, ensure_ascii=False) + "\n")


def remove_leftovers(folder: str | Path) -> list[Path]:
    """The unfinished files below ``folder`` that were removed: those of ``written_whole`` whose process was killed.

    A file of a process that runs stays. Of another machine's processes nothing is known, so theirs go after a day.
    """
    found = []
    for path in sorted(Path(folder).rglob(".*.part")):
        name = _PARTIAL.fullmatch(path.name)
        if not name:
            continue
        try:
            written = path.stat().st_mtime
            if name["host"] in (None, _HOST):
                writing = _was_running(int(name["process"]), written)
            else:
                writing = time.time() - written < _A_DAY
            if not writing:
                path.unlink()
                found.append(path)
        except OSError:
            continue  # its writer ended meanwhile, or the folder cannot be written: no reason to stop a run
    return found


def _was_running(process: int, moment: float) -> bool:
    """Whether the process of this number runs and began before ``moment`` (s since 1970): numbers are given again."""
    try:
        os.kill(process, 0)
    except (ProcessLookupError, OverflowError):
        return False
    except PermissionError:
        pass  # another user's
    try:
        return os.stat(f"/proc/{process}").st_mtime <= moment + 1.0
    except OSError:
        return True  # a system without /proc cannot tell


def _to_disk(path: Path) -> None:
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
