"""Sheets of a workbook, read in a process of its own: one stray cell far out can ask for more memory than there is."""

import csv
import io
import json
import subprocess
import sys
from typing import BinaryIO

from ...errors import InputError
from ...extras import needed

# bytes that reading may take: a sheet of a million rows and ten columns takes a quarter
MEMORY = 4_000_000_000
_SECONDS = 120
_NO_ROOM = 17  # the exit code for want of memory; below 0 where the system ends it for that
# Prints the sheets' names in the first line, then the rows of the one asked for.
_READING = """
import csv, io, json, sys
try:
    import resource
    resource.setrlimit(resource.RLIMIT_AS, (int(sys.argv[1]), int(sys.argv[1])))
except (ImportError, ValueError, OSError):
    pass
from python_calamine import CalamineWorkbook
try:
    with CalamineWorkbook.from_filelike(io.BytesIO(sys.stdin.buffer.read())) as book:
        names = book.sheet_names
        wanted = sys.argv[2] or (names[0] if names else "")
        print(json.dumps(names))
        if wanted in names:
            cells = lambda row: [" ".join(cell.split()) if isinstance(cell, str) else cell for cell in row]
            rows = book.get_sheet_by_name(wanted).to_python(skip_empty_area=False)
            csv.writer(sys.stdout, delimiter="\\t", lineterminator="\\n").writerows(map(cells, rows))
except MemoryError:
    sys.exit(int(sys.argv[3]))
"""


def sheet(source: BinaryIO, name: str, wanted: str = "") -> tuple[list[str], bytes]:
    """The names of a workbook's sheets, and as text between tabs the rows of the one ``wanted``, of the first for "".

    InputError for a file that is no workbook, and for a sheet that cannot be held.
    """
    needed("python_calamine")
    source.seek(0)
    try:
        done = subprocess.run(
            [sys.executable, "-X", "utf8", "-c", _READING, str(MEMORY), wanted, str(_NO_ROOM)],
            input=source.read(), capture_output=True, timeout=_SECONDS, check=False,
        )  # fmt: skip
    except subprocess.TimeoutExpired as error:
        raise _too_large(name, f"it was not read within {_SECONDS} s") from error
    said = done.stderr.decode(errors="replace").strip().splitlines()
    if done.returncode < 0 or done.returncode == _NO_ROOM:
        raise _too_large(name, "its sheet asks for more memory than a table of numbers does")
    if done.returncode:
        problem = f"it cannot be read as a workbook ({said[-1] if said else 'no reason is given'})"
        raise InputError(name, problem, "a sheet of Excel or OpenDocument", "save it as CSV")
    first, _, rows = done.stdout.partition(b"\n")
    return json.loads(first), rows


def cells(source: BinaryIO, name: str, wanted: str) -> list[list[str]]:
    """The rows of a sheet as text; none where there is no such sheet. InputError as of ``sheet``."""
    names, rows = sheet(source, name, wanted)
    return list(csv.reader(io.StringIO(rows.decode()), delimiter="\t")) if wanted in names else []


def _too_large(name: str, why: str) -> InputError:
    mend = "delete what stands far below or beside the table, or save the sheet as CSV"
    return InputError(name, f"it is too large to be read ({why})", "a sheet of the recording alone", mend)
