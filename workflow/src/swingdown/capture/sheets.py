"""The new recording's entry in the sample sheet or, for a tower height, in the apparatus sheet.

What stands in a sheet is never changed: lines are added, the result is held against the old, and it takes the old one's place
in one step.
"""

import contextlib
import csv
import fcntl
import io
import os
import re
from pathlib import Path

import yaml

from ..errors import InputError
from ..measurement.sheet import TWICE, read_sheet
from ..paths import PROJECT, find
from ..schema import parse_yaml

HEADER = (
    "recording", "campaign", "file", "time_column", "time_unit", "signal_column", "signal_unit", "start_s", "role", "sha256",
    "partial",
)  # fmt: skip


def own(path, key):
    """The sheet's path in the working directory, there or not; InputError if it is one of the project's and we are elsewhere."""
    found = find(path)
    if found != Path(path) and Path.cwd() != PROJECT:
        problem = f"{path} is the project's own; what is recorded here does not belong in it"
        mend = f"name one of your own in `{key}` (it is made if it is not there)"
        raise InputError(f"config, key {key}", problem, "a sheet in the working directory", mend)
    return Path(path)


def mentions(path, file):
    """True if the sheet, or the apparatus sheet, has an entry for ``file``."""
    text = readable(path).decode("utf-8-sig") if Path(path).exists() else ""
    return re.search(rf"(?<![^\s,:\"']){re.escape(file)}(?![^\s,\"'}}])", text) is not None


def add_row(path, row, rehearse=False):
    """The sheet's path, with a row more as its last line. The sheet is made if it is not there.

    Parameters
    ----------
    path
        The sample sheet.
    row
        Cells by column. Columns that the sheet lacks are added to its header.
    rehearse
        Do all but the change itself, so that what stands against it is known before a swing is recorded in vain.

    Raises
    ------
    InputError
        If the row cannot be added; the sheet is left as it was.
    """
    path = Path(path)
    row = {key: cell for key, cell in row.items() if cell not in ("", None)}
    with _alone(path):
        old = readable(path) if path.exists() else b""
        _check_commas(path, old)
        lines = csv.reader(io.StringIO(old.decode("utf-8-sig"), newline=""))
        header = [cell.strip() for cell in next(lines)] if old.strip() else list(HEADER)
        end = b"\r\n" if b"\r\n" in old else b"\n"
        lacking = [name for name in row if name not in header]
        if not old.strip():
            new = _line([*header, *lacking]) + end
        else:
            first, newline, rest = old.partition(b"\n")
            first = first.removesuffix(b"\r")
            new = first + b"".join(b"," + name.encode() for name in lacking)
            new += (end if newline else b"") + rest
            new += b"" if new.endswith(b"\n") else end
        new += _line([row.get(name, "") for name in [*header, *lacking]]) + end
        _replace(path, old, new, rehearse, lambda made: _check_rows(made, path, row))
    return path


def add_point(path, point, rehearse=False):
    """The apparatus sheet's path, with a point more as the last of its ``points``.

    Parameters
    ----------
    path
        The apparatus sheet.
    point
        Values by key.
    rehearse
        As of ``add_row``.

    Raises
    ------
    InputError
        If lines cannot be added safely to a sheet laid out so; it holds the lines to add by hand.
    """
    path = Path(path)
    with _alone(path):
        old = readable(path)
        new = with_point(old.decode("utf-8"), point, path)
        _replace(path, old, new.encode("utf-8"), rehearse)
    return path


def readable(path: str | Path) -> bytes:
    """The bytes of a sheet; InputError, with its mend, where it is no text that could be added to, or may not be changed."""
    path = Path(path)
    if path.is_dir():
        raise InputError(path, "it is a folder", "a file", "name the sheet itself, such as recordings.csv")
    if not path.stat().st_mode & 0o222:
        problem = "it is read-only, and a recording adds a line to it"
        expected = "a sheet that may be written"
        raise InputError(path, problem, expected, f"chmod u+w {path}, or name another sheet")
    old = path.read_bytes()
    said = "it is in UTF-16" if old[:2] in (b"\xff\xfe", b"\xfe\xff") or b"\0" in old[:200] else ""
    try:
        old.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        said = said or f"it is not in UTF-8 (byte {error.start} is {old[error.start]:#04x})"
    if not said and b"\r" in old.replace(b"\r\n", b""):
        said = "its lines end in CR alone, as those of old Macintosh programs, or within a line"
    if said:
        mend = "save it again as `CSV UTF-8`"
        raise InputError(path, said, "text in UTF-8 with lines that end in LF or CRLF", mend)
    return old


def _check_commas(path, old):
    first = old.decode("utf-8-sig").strip().split("\n")[0]
    for mark, name in ((";", "semicolons"), ("\t", "tabs")):
        if mark in first and "," not in first:
            problem = f"its columns are separated by {name}"
            mend = "save it again with commas (a spreadsheet asks for the field separator)"
            raise InputError(f"{path}, line 1", problem, "commas between the columns", mend)


def with_point(text, point, path="apparatus sheet"):
    """The text of an apparatus sheet with one more point; all else as it was."""
    before = parse_yaml(text, path)
    if not isinstance(before, dict):
        expected, mend = "an apparatus sheet", "write the lengths first"
        raise InputError(path, "it is no mapping of keys to values", expected, mend)
    cells = yaml.safe_dump(point, sort_keys=False).splitlines()
    entry = [f"{'    ' if k else '  - '}{cell}" for k, cell in enumerate(cells)]
    lines = text.splitlines()
    places = [k for k, line in enumerate(lines) if line.startswith("points:")]
    if not places:
        lines += ["", "points:", *entry]
    else:
        at = places[0]
        if lines[at].split("#")[0].replace(" ", "") == "points:[]":
            lines[at] = "points:"
        last = at
        for k in range(at + 1, len(lines)):
            if lines[k][:1] not in ("", " ", "#", "-"):
                break
            if lines[k].strip() and lines[k][0] in " -":
                last = k
        listed = lines[at + 1 : last + 1]
        if any(line.startswith("- ") for line in listed) or (listed and listed[-1][0] == "-"):
            entry = [line[2:] for line in entry]
        lines[last + 1 : last + 1] = entry
    new = "\n".join(lines) + "\n"
    wanted = dict(before, points=[*(before.get("points") or []), point])
    try:
        fine = parse_yaml(new, path) == wanted
    except InputError:
        fine = False
    if not fine:
        raise InputError(
            f"{path}, key points",
            "the recording cannot be added without touching what stands there",
            "points as a list, an entry a paragraph",
            "add by hand: " + ", ".join(f"{key}: {value}" for key, value in point.items()),
        )
    return new


def _line(cells):
    text = io.StringIO()
    csv.writer(text, lineterminator="").writerow(cells)
    return text.getvalue().encode()


@contextlib.contextmanager
def _alone(path):
    """One capture at a time changes the sheets of a folder."""
    path.parent.mkdir(parents=True, exist_ok=True)
    folder = os.open(path.parent, os.O_RDONLY)
    try:
        fcntl.flock(folder, fcntl.LOCK_EX)
        yield
    finally:
        os.close(folder)


def _check_rows(made, path, row):
    """The sheet as it would be, read back; InputError names the sheet as it is called."""
    try:
        read_sheet(made, check_files=False)
    except InputError as error:
        if error.code == TWICE:
            problem = f"the sheet has a row {row['recording']!r} already"
            raise InputError(path, problem, "a name that is not taken", "choose another name") from None
        where = error.where.replace(str(made), str(path))
        raise InputError(where, error.problem, error.expected, error.mend) from None


def _replace(path, old, new, rehearse, check=None):
    real = Path(os.path.realpath(path))  # a link stays one
    temporary = real.with_name(f".{real.name}.{os.getpid()}.new")
    try:
        with open(temporary, "wb") as file:
            file.write(new)
            file.flush()
            os.fsync(file.fileno())
        if check:
            check(temporary)
        if real.exists() and real.read_bytes() != old:
            mend = "run the same command again with `recover=true`, its recording named"
            raise InputError(path, "another program changed it meanwhile", "no other writer", mend)
        if rehearse:
            return
        if real.exists() and not _alike(temporary, real.stat()):
            _write_into(real, new)
        else:
            os.replace(temporary, real)
    finally:
        temporary.unlink(missing_ok=True)


def _alike(temporary, state):
    """True if the new file could be given the old one's owner, group and rights."""
    try:
        if (os.stat(temporary).st_uid, os.stat(temporary).st_gid) != (state.st_uid, state.st_gid):
            os.chown(temporary, state.st_uid, state.st_gid)
        os.chmod(temporary, state.st_mode)
    except PermissionError:
        return False
    return True


def _write_into(path, new):
    """Another one's sheet that is ours to write: it stays that one's, at the price of not changing in one step."""
    with open(path, "r+b") as file:
        file.write(new)
        file.truncate()
        file.flush()
        os.fsync(file.fileno())
