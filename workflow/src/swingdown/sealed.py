"""Results that are text (CSV, JSON, YAML, SVG), sealed: damage and edits show when a later step reads them.

The seal of ``table2.csv`` is the file ``.table2.csv.sha256`` beside it, in the form of the command ``sha256sum``; the result itself
is plain. A file without a seal is taken as it is: it is older than seals are, or was copied alone. netCDF has a seal of its own
(``dataset``).
"""

import io
import json
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from hashlib import file_digest, sha256
from pathlib import Path
from typing import Any

from .errors import InputError
from .paths import written_whole

ENDING = ".sha256"
_CARRIED = ".snakemake"  # where Snakemake keeps what it carries to a storage and back; a seal would stay here and grow old
_MEND = "delete it and give the same command again, which makes it anew"


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
        with partial.open("rb") as file:
            digest = file_digest(file, "sha256").hexdigest()
        seal.unlink(missing_ok=True)
    with written_whole(seal) as partial:
        partial.write_text(f"{digest}  {path.name}\n", encoding="utf-8")


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
        table.to_csv(partial, **({"index": False, "lineterminator": "\n"} | told))
    return Path(path)


def read_bytes(path: str | Path) -> bytes:
    """The content of a result. InputError where it is missing, or not what was written."""
    path = Path(path)
    try:
        content = path.read_bytes()
    except FileNotFoundError:
        raise InputError(
            path, "there is no such file", "a result of an earlier step", "run that step again"
        ) from None
    except OSError as error:
        raise InputError(path, f"it cannot be read ({error.strerror})", "a file", _MEND) from error
    seal = b""
    with suppress(OSError):
        seal = seal_of(path).read_bytes()
        if seal.partition(b" ")[0] != sha256(content).hexdigest().encode():
            raise InputError(
                path,
                "it is damaged, or was edited: its bytes are not those that were written",
                f"what its seal {seal_of(path).name} was taken of",
                _MEND,
            )
    return content


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
        return pd.read_csv(io.StringIO(text), **told)
    except (ValueError, pd.errors.ParserError) as error:
        raise _unreadable(path, "a table in CSV", error) from error


def _unreadable(path: str | Path, expected: str, error: Exception) -> InputError:
    return InputError(path, f"it cannot be read ({' '.join(str(error).split())})", expected, _MEND)
