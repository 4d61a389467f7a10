"""What was varied between recordings: read from the sample sheet, from a small table beside the files, or out of their names."""

import re
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from ..errors import InputError
from ..measurement.sheet import cells_of
from ..measurement.stated import UNITS, Stated, read

# columns of the sheet, and in what they are
KNOWN = {"length": "m", "mass": "kg", "area": "m^2", "current": "A"}
GROUP = "group"
_SHORT = {"l": "length", "len": "length", "m": "mass", "i": "current"}
_OF = {dimension: name for name, dimension in KNOWN.items()}
_SIDES = {"left": "left", "right": "right", "links": "left", "rechts": "right"}
_FILE = ("file", "recording", "name", "filename")
_NUMBER = r"\d+(?:[.,]\d+)?"
_UNIT = "|".join(
    sorted((re.escape(name) for name, (kind, _) in UNITS.items() if kind in _OF), key=len, reverse=True)
)
_NAMED = re.compile(
    rf"(?<![^\W\d_])(length|len|l|mass|m|area|current|i)\s*=\s*({_NUMBER})\s*({_UNIT})?(?![^\W\d_])", re.I
)
_BARE = re.compile(rf"(?<![\w.,=])({_NUMBER})\s?({_UNIT})(?!\w)")
_HEAD = re.compile(r"\s*(?P<name>.*?)\s*(?:[(\[](?P<unit>[^)\]]*)[)\]]|\s/\s*(?P<over>\S+))?\s*")

Values = dict[str, dict[str, Stated]]  # by recording, then by column


def from_names(labels: Mapping[str, str]) -> tuple[Values, dict[str, dict[str, str]], list[str]]:
    """Values and groups that file names state (``l=0.40``, ``500g``, ``left``), by recording, and how they were read.

    Parameters
    ----------
    labels
        The files' names without their endings, by recording. A name that states one column twice is not used for it.
    """
    values: Values = {}
    groups: dict[str, dict[str, str]] = {}
    for recording, label in labels.items():
        text = label.replace("_", " ").replace("-", " ")
        found: dict[str, list[Stated]] = {}
        for name, number, unit in _NAMED.findall(text):
            column = _SHORT.get(name.lower(), name.lower())
            one = Stated(float(number.replace(",", ".")), np.nan, _as_known(unit)).of(KNOWN[column])
            found.setdefault(column, []).extend([one] if one else [])
        for number, unit in _BARE.findall(_NAMED.sub(" ", text)):
            kind = UNITS[unit][0]
            if one := Stated(float(number.replace(",", ".")), np.nan, unit).of(kind):
                found.setdefault(_OF[kind], []).append(one)
        values[recording] = {column: each[0] for column, each in found.items() if len(each) == 1}
        sides = {_SIDES[word] for word in re.findall(r"[^\W\d_]+", text.lower()) if word in _SIDES}
        groups[recording] = {GROUP: sides.pop()} if len(sides) == 1 else {}
    told = []
    for column in dict.fromkeys(name for one in values.values() for name in one):
        some = [
            f"{labels[key]} → {one[column].value:g} {one[column].unit}"
            for key, one in values.items()
            if column in one
        ]
        told.append(f"{column} as the names say: {', '.join(some[:3])}{' …' if len(some) > 3 else ''}")
    return values, groups, told


def _as_known(unit: str) -> str:
    return next((name for name in UNITS if name == unit or name.lower() == unit.lower()), unit)


def from_rows(rows: Iterable[Mapping[str, Any]]) -> tuple[Values, dict[str, dict[str, str]]]:
    """What the cells of the sample sheet say of what was varied.

    Parameters
    ----------
    rows
        The sheet's rows, as mappings from column to cell.

    Returns
    -------
    values, groups
        By recording: values with uncertainty and unit by column, and words by column.

    Raises
    ------
    InputError
        If a cell is no quantity of its column.
    """
    values: Values = {}
    groups: dict[str, dict[str, str]] = {}
    for row in rows:
        name = str(row["recording"])
        own = {column: str(row.get(column) or "").strip() for column in (*KNOWN, GROUP)}
        values[name] = {
            column: cell(text, "", column, f"recording {name}, column {column}")
            for column, text in own.items()
            if text and column != GROUP and not text.endswith(("px", "pixel", "pixels"))
        }
        groups[name] = {GROUP: own[GROUP]} if own[GROUP] else {}
    return values, groups


def cell(text: str, unit: str, column: str, where: str) -> Stated:
    """The ``Stated`` of a cell in the SI's unit of its column; ``unit`` is the head's. InputError for what is no quantity of it."""
    found = read(text)
    dimension = KNOWN.get(column, "")
    if found and not found.unit and unit:
        found = found._replace(unit=unit)
    known = found
    if found and (dimension or found.unit in UNITS):
        known = found.of(dimension or UNITS[found.unit][0])
    if known is None:
        raise InputError(
            where, f"{text!r} is no {column}", f"a number{f' in {dimension}' if dimension else ''} or one with a unit, as 0.583, 0.583±0.001, 58.3(1) cm",
            "correct the cell",
        )  # fmt: skip
    return known


def table_beside(paths: Iterable[Path]) -> Path | None:
    """The CSV file among these that lists others of them in a column ``file``; None where there is none."""
    paths = list(paths)
    names = {one.name.casefold() for one in paths} | {one.stem.casefold() for one in paths}
    for path in paths:
        if path.suffix.lower() not in (".csv", ".tsv", ".txt"):
            continue
        with path.open("rb") as file:
            first = file.readline(2000).decode("utf-8-sig", "replace")
        heads = [cell.strip().strip('"').lower() for cell in re.split("[,;\t]", first)]
        if len(heads) < 2 or not set(heads) & set(_FILE):
            continue
        table = _opened(path)
        listed = table[next(name for name in table if name.strip().lower() in _FILE)]
        if (listed.str.strip().str.casefold().isin(names)).any():
            return path
    return None


def _opened(path: Path) -> pd.DataFrame:
    """The table, its cells as text, indexed by line; what follows the last head, and lines that begin with ``#``, are left out."""
    lines = enumerate(cells_of(path, path)[0], 1)
    filled = [(number, cells) for number, cells in lines if any(cells) and not cells[0].startswith("#")]
    (_, heads), *rows = filled or [(1, [""])]
    if len(set(heads)) < len(heads):
        raise InputError(path, "two of its columns have one name", "a name of its own for each column", "rename one of them")  # fmt: skip
    size, numbers = len(heads), [number for number, _ in rows]
    return pd.DataFrame([[*cells, *[""] * size][:size] for _, cells in rows], numbers, heads, dtype=str)


def from_table(path: Path, labels: Mapping[str, str]) -> tuple[Values, dict[str, dict[str, str]]]:
    """What a table beside the files says of what was varied.

    Parameters
    ----------
    path
        A table with a column ``file`` (names with or without endings) and a column for each value, its unit in the head (``length (cm)``,
        ``length_cm``) or in the cells. A column ``u_NAME`` holds standard uncertainties, a column of words groups.
    labels
        By recording, the file's name without its ending.

    Returns
    -------
    values, groups
        As of ``from_rows``.

    Raises
    ------
    InputError
        If it has no column ``file``, none of its files is there, or a cell in a column of numbers is no number.
    """
    table = _opened(path)
    files = next((name for name in table if name.strip().lower() in _FILE), None)
    if files is None:
        raise InputError(path, "it has no column `file`", "a column `file` and one for each value", "add it")
    by_label: dict[str, list[str]] = {}
    for key, label in labels.items():
        by_label.setdefault(label.casefold(), []).append(key)
    columns = {name: head(name) for name in table if name != files}
    values: Values = {}
    groups: dict[str, dict[str, str]] = {}
    for line, row in zip(table.index, table.to_dict("records"), strict=True):
        named = row[files].strip().casefold()
        for key in by_label.get(named, by_label.get(Path(named).stem, [])):
            own, words = _of_line(row, table, columns, f"{path}, line {line}")
            values[key], groups[key] = own, words
    if not values:
        raise InputError(path, "none of its files is here", "names of the files, as they stand in the folder", "correct its column `file`")  # fmt: skip
    return values, groups


def _of_line(
    row: Mapping[str, str], table: pd.DataFrame, columns: Mapping[str, tuple[str, str, bool]], where: str
) -> tuple[dict[str, Stated], dict[str, str]]:
    """The values and the words of a line of a table beside the files."""
    values: dict[str, Stated] = {}
    words: dict[str, str] = {}
    for name, (column, unit, error) in columns.items():
        text = row[name].strip()
        if not text or error:
            continue
        if column == GROUP or (column not in KNOWN and not any(map(read, table[name]))):
            words[column] = text
            continue
        one = cell(text, unit, column, f"{where}, column {name}")
        beside = next((other for other, (own, _, is_u) in columns.items() if is_u and own == column), None)
        if beside and row[beside].strip():
            given = columns[beside][1] or unit
            u = cell(row[beside].strip(), given, column, f"{where}, column {beside}")
            one = one._replace(uncertainty=u.value)
        values[column] = one
    return values, words


def head(name: str) -> tuple[str, str, bool]:
    """A head's column, its unit, and whether it holds standard uncertainties."""
    found = _HEAD.fullmatch(name)
    text, unit = (found["name"], found["unit"] or found["over"] or "") if found else (name, "")
    bare = re.sub(r"^(?:u_|u\s+|sd_|±\s*|d_)|_u$", "", text.strip(), flags=re.I)
    error = bare != text.strip()
    stem, _, end = bare.rpartition("_")
    if stem and end in UNITS and not unit:
        bare, unit = stem, end
    column = bare.strip().lower().replace(" ", "_")
    return _SHORT.get(column, column), unit, error


def merged(*sources: Mapping[str, Mapping[str, Any]]) -> dict[str, dict[str, Any]]:
    """What any source says, by recording.

    Parameters
    ----------
    *sources
        Each by recording and column; the first that says something of a column counts.
    """
    found: dict[str, dict[str, Any]] = {}
    for source in reversed(sources):
        for recording, own in source.items():
            found.setdefault(recording, {}).update(own)
    return found
