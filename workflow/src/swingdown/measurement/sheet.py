"""The sample sheet: a CSV file with a row for each recording. config/README.md tells columns and defaults."""

import csv
import difflib
import math
import re

import pandas as pd

from ..errors import InputError
from ..paths import find, is_url

COLUMNS = {  # name: default; None = must be given
    "recording": None,
    "campaign": "pendulum",
    "file": None,
    "time_column": "",  # the file's first column
    "time_unit": "",  # as the time column's name ends (_s, _ms, _us), else s
    "signal_column": "",  # the file's second column
    "signal_unit": "",  # as the signal column's name ends (_V, _rad, _deg, _counts), else rad
    "counts_per_revolution": math.nan,
    "start_s": math.nan,
    "stop_s": math.nan,
    "role": "",
    "sha256": "",
    "partial": "",  # a recording that is marked partial is refused
}
TIME_UNITS = {"s": 1.0, "ms": 1e-3, "us": 1e-6}
SIGNAL_UNITS = ("V", "rad", "deg", "counts")
ROLES = ("fit", "holdout", "static")
PARTIAL = ("allow",)
_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]*")


def read_sheet(path, check_files=True):
    """A DataFrame indexed by recording: the sheet's columns with defaults filled in, and each row's ``line``.

    A unit that neither its cell nor the named column tells is "": the file's own column name then decides.
    Text columns hold str ("" = none), numbers float (NaN = none); ``file`` stays as written (``paths.find``
    finds it). ``.attrs["sheet"]`` is the sheet's path. Whatever is not as ``config/README.md`` says raises
    InputError with the sheet, line and column. ``check_files=False`` leaves out the check that each file is
    there.
    """
    found = find(path)
    if not found.is_file():
        raise InputError(
            path,
            "there is no such sample sheet",
            "a CSV file with a row for each recording",
            "correct the key `recordings` of the config",
        )
    try:
        with open(found, newline="", encoding="utf-8-sig") as file:
            lines = [[cell.strip() for cell in cells] for cells in csv.reader(file)]
    except (UnicodeDecodeError, csv.Error) as error:
        raise InputError(
            path, f"it cannot be read as text ({error})", "a CSV file in UTF-8", "save the sheet as CSV"
        ) from error
    header = lines[0] if lines else []
    _check_header(path, header)
    rows = [
        _row(path, number, header, cells, check_files)
        for number, cells in enumerate(lines[1:], 2)
        if any(cells)
    ]
    if not rows:
        raise InputError(path, "it has no row", "a row for each recording", "add the recordings")
    table = pd.DataFrame(rows).set_index("recording")
    for name in table.index[table.index.duplicated()]:
        at = " and ".join(str(line) for line in table.loc[name, "line"])
        raise InputError(
            f"{path}, lines {at}, column recording",
            f"the name {name!r} is used twice",
            "a name of its own for each recording",
            "rename one of them",
        )
    table.attrs["sheet"] = str(path)
    return table


def unit_of(column, known):
    """The unit that a column's name ends in (``theta_rad``: rad), or "" if that is none of the known ones."""
    return next((unit for unit in known if column.endswith(f"_{unit}")), "")


def _check_header(path, header):
    place = f"{path}, line 1"
    for name in header:
        if name not in COLUMNS:
            near = difflib.get_close_matches(name, COLUMNS, 1, 0.5)
            hint = f"did you mean {near[0]!r}?" if near else "remove the column"
            raise InputError(
                f"{place}, column {name or '(empty)'}", "unknown column", ", ".join(COLUMNS), hint
            )
        if header.count(name) > 1:
            raise InputError(
                f"{place}, column {name}", "the column is there twice", "each column once", "remove one"
            )
    for name, default in COLUMNS.items():
        if default is None and name not in header:
            raise InputError(
                place,
                f"no column {name!r}",
                "at least the columns recording and file",
                f"add the column {name}",
            )


def _row(path, number, header, cells, check_files):
    def fail(column, problem, expected, mend):
        raise InputError(f"{path}, line {number}, column {column}", problem, expected, mend)

    if len(cells) > len(header):
        fail(
            header[-1],
            f"{len(cells)} cells in a row of {len(header)} columns",
            "a cell for each column",
            "quote a cell that contains a comma",
        )
    given = {name: cell for name, cell in zip(header, cells, strict=False) if cell}
    row = {name: given.get(name, default) for name, default in COLUMNS.items()}
    row["line"] = number

    for column in ("recording", "file"):
        if not row[column]:
            fail(column, "the cell is empty", f"the {column} of the row", "fill it in")
    for column in ("recording", "campaign"):
        if not _NAME.fullmatch(row[column]):
            fail(column, f"{row[column]!r} cannot name a file", "letters, digits, . _ and -", "rename it")
    for column, known in (
        ("time_unit", TIME_UNITS),
        ("signal_unit", SIGNAL_UNITS),
        ("role", ROLES),
        ("partial", PARTIAL),
    ):
        if row[column] and row[column] not in known:
            near = difflib.get_close_matches(row[column].lower(), [k.lower() for k in known], 1, 0.6)
            hint = next(
                (f"did you mean {k!r}?" for k in known if near and k.lower() == near[0]), "use one of these"
            )
            fail(
                column,
                f"unknown {column.replace('_', ' ')} {row[column]!r}",
                f"{', '.join(known)}, or empty",
                hint,
            )
    row["time_unit"] = row["time_unit"] or unit_of(row["time_column"], TIME_UNITS)
    row["signal_unit"] = row["signal_unit"] or unit_of(row["signal_column"], SIGNAL_UNITS)
    for column in ("counts_per_revolution", "start_s", "stop_s"):
        try:
            row[column] = float(row[column])
        except ValueError:
            fail(column, f"{row[column]!r} is not a number", "a number, or empty", "correct the cell")
        if column in given and not math.isfinite(row[column]):
            fail(
                column, f"{given[column]!r} is not a finite number", "a number, or empty", "correct the cell"
            )
    if row["counts_per_revolution"] <= 0:
        fail(
            "counts_per_revolution",
            f"{row['counts_per_revolution']:g} counts a revolution",
            "a number above 0",
            "correct the cell",
        )
    if row["signal_unit"] == "counts" and math.isnan(row["counts_per_revolution"]):
        fail(
            "counts_per_revolution",
            "the cell is empty though the signal is in counts",
            "the encoder's counts per revolution",
            "fill it in",
        )
    if row["stop_s"] <= row["start_s"]:
        fail(
            "stop_s",
            f"the window ends at {row['stop_s']:g} s and starts at {row['start_s']:g} s",
            "stop_s after start_s",
            "correct the window",
        )
    if row["sha256"] and not re.fullmatch(r"[0-9a-fA-F]{64}", row["sha256"]):
        fail(
            "sha256",
            f"{row['sha256']!r} is not a SHA-256",
            "64 hexadecimal digits, or empty",
            "paste the output of sha256sum",
        )
    row["sha256"] = row["sha256"].lower()
    if check_files and not is_url(row["file"]) and not find(row["file"]).is_file():
        fail(
            "file",
            f"there is no file {row['file']}",
            "a path relative to the working directory, an absolute path or a URL",
            "correct the path",
        )
    return row
