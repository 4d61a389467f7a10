"""Tables inside other files: a sheet of a workbook (Excel, OpenDocument) as text, a file in a zip archive (phyphox), or one that is packed alone."""

import gzip
import io
import re
import shutil
import tempfile
import zipfile
import zlib
from typing import BinaryIO, NamedTuple

from ...errors import InputError
from .elements import DAMAGED, ZIP
from .text import HEAD, PIECE
from .workbook import sheet

OLD, GZIP = b"\xd0\xcf\x11\xe0", b"\x1f\x8b"
FEWEST_ROWS = 10  # of numbers in a sheet that holds a recording
_NUMBER = re.compile(rb"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?")
LARGEST = 500_000_000  # bytes, unpacked: a workbook is held whole
TEXT = (".csv", ".txt", ".tsv", ".dat")
OTHERS = (".xlsx", ".xls", ".ods", ".trk", ".trz", ".labx", ".lab", ".cmbl", ".mat")  # in a zip archive
UNPACK = "unpack the archive and name the file in it"
IN_PIECES = "a CSV file by itself is read in pieces"


class Inside(NamedTuple):
    """An open file from inside another, and a word on where that is; its own ``name``, where it is no text and has a reader of its own."""

    file: BinaryIO
    where: str
    name: str = ""


class SeveralFiles(InputError):
    """An archive with several files of numbers, none of which is asked for: ``names`` are theirs, ``others`` what else is in it."""

    names: tuple[str, ...] = ()
    others: tuple[str, ...] = ()


def unpacked(source: BinaryIO, name: str, part: str) -> Inside | None:
    """The ``Inside`` of a workbook or an archive; None for a file that is neither.

    ``part`` names the workbook's sheet or the archive's file; "" takes the first sheet, or the only file of numbers. InputError
    where there is no such part, none at all, several to choose from, or one too large to hold.
    """
    head = source.read(4)
    source.seek(0)
    if head.startswith(GZIP):
        return _alone(source, name)
    if head not in (ZIP, OLD):
        return None
    if head == ZIP:
        try:
            with zipfile.ZipFile(source) as archive:
                names = archive.namelist()
                size = sum(one.file_size for one in archive.infolist())
                if not {"xl/workbook.xml", "xl/workbook.bin", "content.xml"} & set(names):
                    return _member(archive, name, part)
        except (*DAMAGED, OSError) as error:
            problem = f"the archive cannot be read ({error})"
            raise InputError(name, problem, "a zip archive or a workbook", "export it again") from error
        _check_size(name, "the workbook", size, "save the sheet as CSV, which is read in pieces")
    return _sheet(source, name, part)


def _alone(source: BinaryIO, name: str) -> Inside:
    """The file that gzip packed, as far as it can be held."""
    inside, copy = name[:-3] if name.lower().endswith(".gz") else name, tempfile.TemporaryFile()  # noqa: SIM115 - closed with the last reference
    try:
        with gzip.GzipFile(fileobj=source) as packed:
            while piece := packed.read(PIECE):
                copy.write(piece)
                _check_size(name, "the file in it", copy.tell(), f"unpack it: {IN_PIECES}")
    except (OSError, EOFError, zlib.error) as error:
        problem = f"it cannot be unpacked ({error})"
        raise InputError(name, problem, "a whole file that gzip packed", "pack it again") from error
    copy.seek(0)
    return Inside(copy, "unpacked", inside if inside.lower().endswith(OTHERS) else "")


def _holds_numbers(rows: bytes, between: bytes = rb"\t") -> bool:
    """True for text with as many rows of two numbers or more as a recording has at least."""
    found = 0
    for line in rows.splitlines():
        numbers = [cell for cell in re.split(between, line) if _NUMBER.fullmatch(cell.strip(b"\"' "))]
        found += len(numbers) > 1
        if found >= FEWEST_ROWS:
            return True
    return False


def _sheet(source: BinaryIO, name: str, part: str) -> Inside:
    names, rows = sheet(source, name, part)
    stated = bool(part)
    for other in names[1:] if not part and not _holds_numbers(rows) else ():
        more = sheet(source, name, other)[1]
        if _holds_numbers(more):
            part, rows = other, more
            break
    if part and part not in names:
        raise _no_part(name, part, names, "sheet")
    taken = part or names[0]
    others = f" of {len(names)}" if len(names) > 1 and not stated else ""
    return Inside(io.BytesIO(rows), f"sheet `{taken}`{others}")


def _member(archive: zipfile.ZipFile, name: str, part: str) -> Inside:
    """The file of that name, or the only one of numbers; what stands in a folder `meta` tells of the device."""
    beside = {"meta", "__MACOSX"}
    all_ = [one for one in archive.namelist() if not (one.endswith("/") or beside & set(one.split("/")[:-1]))]
    files = [one for one in all_ if one.lower().endswith(TEXT + OTHERS)]
    if part and part not in archive.namelist():
        raise _no_part(name, part, files, "file")
    if not files:
        problem = "the archive holds no table of numbers"
        raise InputError(name, problem, "a CSV file in it, or a workbook", UNPACK)
    if not part and len(files) > 1:  # notes are no recording
        tables = []
        for one in files:
            with archive.open(one) as packed:
                text = one.lower().endswith(TEXT)
                tables += [one] if not text or _holds_numbers(packed.read(HEAD), rb"[\t;, ]") else []
        files = tables or files
    if not part and len(files) > 1:
        several = SeveralFiles(
            name,
            f"the archive holds {len(files)} files of numbers, and nothing says which one is meant",
            ", ".join(files),
            "name one of them ⟨in sheet⟩, or unpack it and give the folder: then each is a recording",
        )
        several.names, several.others = tuple(files), tuple(one for one in all_ if one not in files)
        raise several
    chosen = part or files[0]
    size = archive.getinfo(chosen).file_size
    _check_size(name, f"`{chosen}` in it", size, f"unpack the archive: {IN_PIECES}")
    copy = tempfile.TemporaryFile()  # noqa: SIM115 - closed with the last reference
    with archive.open(chosen) as packed:
        shutil.copyfileobj(packed, copy)
    copy.seek(0)
    return Inside(copy, f"`{chosen}` in the archive", chosen if chosen.lower().endswith(OTHERS) else "")


def _check_size(name: str, what: str, size: int, mend: str) -> None:
    if size > LARGEST:
        problem = f"{what} has {size / 1e6:.0f} MB when unpacked"
        raise InputError(name, problem, f"at most {LARGEST / 1e6:.0f} MB", mend)


def _no_part(name: str, part: str, there: list[str], what: str) -> InputError:
    problem = f"there is no {what} {part!r} in it"
    expected = ", ".join(there) or "none at all"
    return InputError(f"{name} (column sheet)", problem, expected, "correct ⟨sheet⟩, or leave it empty")
