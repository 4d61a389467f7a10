"""The sample sheet: a CSV file with a row for each recording. config/README.md tells columns and defaults."""

import codecs
import csv
import io
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from ..errors import InputError
from ..paths import find, from_cell, is_url, printable, safe_name
from ..schema import check, near, rules

TWICE = "name used twice"  # the code of the refusal of two rows with one name
SCHEMA = "recordings.schema.yaml"  # what a row may hold
COLUMNS: dict[str, Any] = {name: rule.get("default") for name, rule in rules(SCHEMA)["properties"].items()}
NUMBERS = tuple(name for name, rule in rules(SCHEMA)["properties"].items() if rule.get("type") == "number")
LENGTHS = ("m", "cm", "mm", "px")  # units of positions
SIGNAL_UNITS = tuple(one for one in rules(SCHEMA)["properties"]["signal_unit"]["enum"] if one not in LENGTHS)
Row = Mapping[str, Any]  # its cells by their columns, defaults filled in
TIME_UNITS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}


def read_sheet(path: str | Path, check_files: bool = True) -> pd.DataFrame:
    """A DataFrame indexed by recording: the sheet's columns with defaults filled in, and each row's ``line``.

    Text columns hold str ("" = none), numbers float (NaN = none). A unit of "" is that of the file's own column. ``file`` stays
    as written (``paths.find`` looks it up). ``.attrs["sheet"]`` is the sheet's path.

    Parameters
    ----------
    path
        The sample sheet.
    check_files
        Whether each file must be there.

    Raises
    ------
    InputError
        With sheet, line and column.
    """
    found = find(path)
    if not found.is_file():
        raise InputError(
            path,
            "there is no such sample sheet",
            f"a CSV file with a row for each recording, in {Path.cwd()} or given by its whole path",
            "correct the key `recordings` of the config, or add `--directory FOLDER`, the folder that it lies in",
        )
    lines = _cells(found, path)
    header = lines[0] if lines else []
    _check_header(path, header)
    filled = ((number, cells) for number, cells in enumerate(lines[1:], 2) if any(cells))
    rows = [_row(path, number, header, cells, check_files) for number, cells in filled]
    if not rows:
        raise InputError(path, "it has no row", "a row for each recording", "add the recordings")
    _check_names(path, rows)
    table = pd.DataFrame(rows).set_index("recording")
    table.attrs["sheet"] = str(path)
    return table


def _cells(found: Path, path: object) -> list[list[str]]:
    """The cells of each line, with a point as the decimal sign of numbers."""
    lines, separator = cells_of(found, path)
    if separator != "," and lines:  # there a comma in a number is its decimal sign
        numbers = {k for k, name in enumerate(lines[0]) if name in NUMBERS}
        lines[1:] = [
            [cell.replace(",", ".") if k in numbers else cell for k, cell in enumerate(cells)]
            for cells in lines[1:]
        ]
    return lines


def cells_of(found: Path, path: object) -> tuple[list[list[str]], str]:
    """The cells of each line of a table somebody wrote, and what stands between them; InputError for what is no text.

    Tables are saved with commas, semicolons or tabs, in UTF-8, UTF-16 or Latin-1, as the program likes.
    """
    try:
        raw = found.read_bytes()
        if raw.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
            text = raw.decode("utf-16")
        else:
            try:
                text = raw.decode("utf-8-sig")
            except UnicodeDecodeError:
                text = raw.decode("cp1252")
        if "\0" in text:
            raise csv.Error("it holds control characters")
        first = text.partition("\n")[0]
        separator = next((one for one in (";", "\t") if one in first and "," not in first), ",")
        rows = list(csv.reader(io.StringIO(text, newline=""), delimiter=separator))
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        problem = f"it cannot be read as text ({error})"
        raise InputError(path, problem, "a CSV file in UTF-8", "save it as CSV") from error
    return [[cell.strip() for cell in cells] for cells in rows], separator


def _check_names(path: object, rows: list[dict[str, Any]]) -> None:
    """InputError for two recordings that would have one file; some systems do not tell `a` from `A`."""
    seen: dict[str, dict[str, Any]] = {}
    for row in rows:
        other = seen.setdefault(row["recording"].casefold(), row)
        if other is row:
            continue
        both = f"{path}, lines {other['line']} and {row['line']}, column recording"
        names = [one["label"] or one["recording"] for one in (other, row)]
        if names[0] == names[1]:
            problem = f"the name {names[0]!r} is used twice"
            expected = "a name of its own for each recording"
            raise InputError(both, problem, expected, "rename one of them", TWICE)
        problem = f"{names[0]!r} and {names[1]!r} would be one file ({other['recording']})"
        expected = "names that differ in more than capitals, accents and signs"
        raise InputError(both, problem, expected, "rename one of them")


def rows_of_parts(row: Row, parts: Sequence[Mapping[str, str]]) -> str:
    """The lines of a sheet, header first, that make a recording of each of several ``parts`` of a row's file: its cells, then the part's."""
    kept = [key for key, cell in row.items() if key != "line" and isinstance(cell, str) and cell]
    if np.isfinite(row.get("counts_per_revolution", np.nan)):
        kept.append("counts_per_revolution")
    text = io.StringIO()
    lines = csv.writer(text, lineterminator="\n")
    lines.writerow([*kept, *parts[0]])
    for number, part in enumerate(parts, 1):
        cells = [f"{row[key]}-{number}" if key == "recording" else row[key] for key in kept]
        lines.writerow([*cells, *part.values()])
    return text.getvalue().rstrip()


def unit_of(column: str, known: Iterable[str]) -> str:
    """The unit that a column's name ends in (``theta_rad``: rad), or "" if that is none of the known ones."""
    return next((unit for unit in known if column.endswith(f"_{unit}")), "")


def _check_header(path: object, header: list[str]) -> None:
    place = f"{path}, line 1"
    for name in header:
        if name not in COLUMNS:
            problem = "unknown column"
            expected = ", ".join(COLUMNS)
            raise InputError(f"{place}, column {name or '(empty)'}", problem, expected, near(name, COLUMNS))
        if header.count(name) > 1:
            problem = "the column is there twice"
            raise InputError(f"{place}, column {name}", problem, "each column once", "remove one")
    for name in rules(SCHEMA)["required"]:
        if name not in header:
            mend = f"add the column {name}"
            raise InputError(place, f"no column {name!r}", "at least the columns recording and file", mend)


def _row(path: object, number: int, header: list[str], cells: list[str], check_files: bool) -> dict[str, Any]:
    place = f"{path}, line {number}"
    if len(cells) > len(header):
        problem = f"{len(cells)} cells in a row of {len(header)} columns"
        mend = "quote a cell that contains a comma"
        raise InputError(f"{place}, column {header[-1]}", problem, "a cell for each column", mend)
    given: dict[str, Any] = {name: from_cell(cell) for name, cell in zip(header, cells, strict=False) if cell}
    for column, unit, known in (
        ("time_column", "time_unit", tuple(TIME_UNITS)),
        ("signal_column", "signal_unit", SIGNAL_UNITS),
    ):
        if unit not in given and (told := unit_of(given.get(column, ""), known)):
            given[unit] = told
    given |= {name: _number(given[name]) for name in NUMBERS if name in given}
    filled = check(given, SCHEMA, place, part="column")
    for name in ("recording", "campaign"):
        if (safe := safe_name(filled[name])) != filled[name]:
            filled |= {"label": filled["label"] or filled[name]} if name == "recording" else {}
            filled[name] = safe
    filled["label"] = printable(filled["label"])
    row = {name: filled[name] for name in COLUMNS} | {"line": number}
    row["sha256"] = row["sha256"].lower()
    if row["stop_s"] <= row["start_s"]:
        problem = f"the window ends at {row['stop_s']:g} s and starts at {row['start_s']:g} s"
        raise InputError(f"{place}, column stop_s", problem, "stop_s after start_s", "correct the window")
    own = row["file"].replace("\\", "/")  # of a path as it is written on Windows
    if own != row["file"] and not find(row["file"]).is_file() and find(own).is_file():
        row["file"] = own
    if check_files and not is_url(row["file"]) and not find(row["file"]).is_file():
        raise InputError(
            f"{place}, column file",
            f"there is no file {row['file']}",
            f"a path relative to the working directory ({Path.cwd()}), an absolute path or a URL",
            "correct the path, or add `--directory FOLDER`, the folder that it starts from",
        )
    return row


def _number(cell: str) -> float | str:
    """The number in a cell, or the cell's text where it holds none."""
    try:
        return float(cell)
    except ValueError:
        return cell
