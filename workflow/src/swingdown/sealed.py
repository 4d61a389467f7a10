"""Results that are text (CSV, JSON, YAML, SVG), sealed: damage and edits show when a later step reads them.

The seal of ``table2.csv`` is the file ``.table2.csv.sha256`` beside it, in the form of the command ``sha256sum``; the result itself
is plain. A file without a seal is taken as it is: it is older than seals are, or was copied alone. netCDF has a seal of its own
(``seal_behind``).
"""

import io
import json
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from hashlib import sha256
from pathlib import Path
from typing import Any

from .errors import MAKE_ANEW, InputError
from .paths import checksum, for_spreadsheets, from_spreadsheets, written_whole

ENDING = ".sha256"
_BEHIND = b"\nswingdown sha256 "
_CARRIED = ".snakemake"  # where Snakemake keeps what it carries to a storage and back; a seal would stay here and grow old


def seal_of(path: str | Path) -> Path:
    """Where the seal of a result is."""
    path = Path(path)
    return path.with_name(f".{path.name}{ENDING}")


def remove_orphans(folder: str | Path) -> list[Path]:
    """The seals below ``folder`` that were removed, as what they sealed is gone."""
    found = []
    for path in sorted(Path(folder).rglob(f".*{ENDING}")):
        with suppress(OSError):  # a folder that cannot be written is no reason to stop a run
            if not path.with_name(path.name[1 : -len(ENDING)]).exists():
                path.unlink()
                found.append(path)
    return found


def is_seal(path: Path) -> bool:
    """Whether a file is the seal of another, which need not be there any more."""
    return path.name.startswith(".") and path.name.endswith(ENDING)


@contextmanager
def writing(path: str | Path) -> Iterator[Path]:
    """A path to write a result to: what is there at the end takes the name ``path``, whole (``written_whole``), and its seal.

    Whoever is killed on the way leaves a result without a seal, never one that the seal of another belies.
    """
    path, seal = Path(path), seal_of(path)
    if _CARRIED in path.parts:
        with written_whole(path) as partial:
            yield partial
        return
    with written_whole(path) as partial:
        yield partial
        digest = checksum(partial)
        seal.unlink(missing_ok=True)
    with written_whole(seal) as partial:
        partial.write_bytes(_seal(path, digest))


def _seal(path: Path, digest: str) -> bytes:
    return f"{digest}  {path.name}\n".encode()


def agrees(path: Path, digest: str) -> bool:
    """Whether the seal beside a result is that of the SHA-256 ``digest``, or there is none."""
    try:
        return seal_of(path).read_bytes() == _seal(path, digest)
    except FileNotFoundError:
        return True
    except OSError:
        return False


def is_whole(path: Path, digest: str) -> bool:
    """Whether a result, whose SHA-256 is ``digest``, is what was written: by its seal, which a netCDF file must have."""
    if path.suffix != ".nc":
        return agrees(path, digest)
    try:
        return check_behind(path)
    except InputError:
        return False


def write_text(path: str | Path, text: str) -> Path:
    """The path written, whole and sealed, in UTF-8."""
    with writing(path) as partial:
        partial.write_text(text, encoding="utf-8")
    return Path(path)


def write_json(path: str | Path, content: Any) -> Path:
    """The path written, whole and sealed: ``content`` as JSON, a key a line."""
    return write_text(path, json.dumps(content, indent=1, ensure_ascii=False) + "\n")


def write_csv(table: Any, path: str | Path, **told: Any) -> Path:
    """The path written, whole and sealed: a table (pandas) as CSV without its index, unless ``told`` to ``to_csv`` otherwise."""
    with writing(path) as partial:
        for_spreadsheets(table).to_csv(partial, **({"index": False, "lineterminator": "\n"} | told))
    return Path(path)


def read_bytes(path: str | Path) -> bytes:
    """The content of a result. InputError where it is missing, or not what was written."""
    path = Path(path)
    try:
        content = path.read_bytes()
    except FileNotFoundError:
        told = "there is no such file", "a result of an earlier step", "give the same command again"
        raise InputError(path, *told) from None
    except OSError as error:
        raise InputError(path, f"it cannot be read ({error.strerror})", "a file", MAKE_ANEW) from error
    if not agrees(path, sha256(content).hexdigest()):
        problem = f"it or its seal {seal_of(path).name} was damaged or edited: they do not agree"
        raise InputError(path, problem, "the bytes that were sealed", MAKE_ANEW)
    return content


def seal_behind(path: Path) -> None:
    """The netCDF file with the SHA-256 of its bytes behind its end, where readers of netCDF do not look.

    A damaged book of the format can make its library crash rather than complain, so damage must show before that is asked.
    A file that is carried or copied takes this seal along. A program that changes the file cuts it off.
    """
    digest = checksum(path)
    with path.open("ab") as file:
        file.write(_BEHIND + digest.encode())


def check_behind(path: Path) -> bool:
    """Whether a netCDF file has a seal; InputError where its bytes are not those that this was taken of."""
    with path.open("rb") as file:
        size = file.seek(0, os.SEEK_END) - len(_BEHIND) - 64
        file.seek(max(size, 0))
        tail = file.read()
        if size <= 0 or not tail.startswith(_BEHIND):
            return False
        found, left = sha256(), size
        file.seek(0)
        while left:
            piece = file.read(min(left, 1 << 20))
            found.update(piece)
            left -= len(piece)
    if tail[len(_BEHIND) :] != found.hexdigest().encode():
        problem = "it cannot be read (its bytes are not those that were written)"
        raise InputError(path, problem, "an undamaged netCDF file", MAKE_ANEW)
    return True


def read_text(path: str | Path) -> str:
    """The text of a result; InputError as ``read_bytes``, or where it is no UTF-8."""
    try:
        return read_bytes(path).decode("utf-8")
    except UnicodeDecodeError as error:
        raise _unreadable(path, "text in UTF-8", error) from error


def read_json(path: str | Path) -> Any:
    """What a result in JSON holds; InputError as ``read_text``, or where it is no JSON."""
    text = read_text(path)
    try:
        return json.loads(text)
    except (ValueError, RecursionError) as error:
        raise _unreadable(path, "JSON", error) from error


def read_csv(path: str | Path, **told: Any) -> Any:
    """The table (pandas) of a result in CSV, ``told`` to ``read_csv``; InputError as ``read_text``, or where it is no table."""
    import pandas as pd  # most of what reads or writes here has no table, and some of it starts often

    text = read_text(path)
    try:
        return from_spreadsheets(pd.read_csv(io.StringIO(text), **told))
    except (ValueError, pd.errors.ParserError) as error:
        raise _unreadable(path, "a table in CSV", error) from error


def _unreadable(path: str | Path, expected: str, error: Exception) -> InputError:
    return InputError(path, f"it cannot be read ({' '.join(str(error).split())})", expected, MAKE_ANEW)
