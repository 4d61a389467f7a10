"""What a recording's file holds before any of it is read: a local file or one behind an address, text, netCDF or a workbook."""

import hashlib
import io
import itertools
import shutil
import subprocess
import sys
import tempfile
import urllib.request
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any, BinaryIO, NamedTuple

import netCDF4
import numpy as np
import pandas as pd
import xarray as xr

from ..errors import InputError
from ..paths import find, is_url
from .archive import unpacked
from .table import PIECE, cut_short, encoding, layout, pieces

NETCDF = (".nc", ".nc4", ".cdf", ".netcdf")


class Table(NamedTuple):
    """A file's columns, before any of them is read."""

    names: tuple[str, ...]
    about: dict[str, Any]  # the file's own account of itself
    pieces: Iterable[pd.DataFrame]  # its rows, indexed by line
    decimal: str = "."
    layout: str = ""  # told to the user
    units: dict[str, str] = {}  # those that the file itself states apart from the names
    cut: bool = False  # the last line was cut while it was written


def table_of(source: BinaryIO, row: Mapping[str, Any]) -> Table:
    """The Table of an open file, by its ending; ``row`` is that of the sample sheet. InputError for one that cannot be read."""
    name = row["file"]
    if name.lower().endswith(NETCDF):
        return _netcdf(source, row)
    if row.get("rate_hz", float("nan")) > 0:
        return _one_column(source, name, row["rate_hz"])
    if inside := unpacked(source, name, str(row.get("sheet", ""))):
        text, where = inside
        table = _text(text, f"{name}, {where}")
        return table._replace(
            layout=table.layout.replace("tabs", where, 1) if "sheet" in where else f"{where}, {table.layout}"
        )
    if row.get("sheet"):
        raise InputError(
            f"{name} (column sheet)",
            f"the file has no sheets, and the sample sheet asks for {row['sheet']!r}",
            "a workbook or a zip archive",
            "leave the cell `sheet` empty",
        )
    return _text(source, name)


def _text(source: BinaryIO, name: str) -> Table:
    how = layout(source, encoding(source, name), name)
    cut = cut_short(source, how)
    return Table(how.names, how.about, pieces(source, how, name), how.decimal, str(how), cut=cut)


@contextmanager
def opened(name: str, place: str) -> Iterator[BinaryIO]:
    """A file or URL, open for reading; InputError with ``place`` if it cannot be had. A URL is kept on the disk meanwhile."""
    try:
        if not is_url(name):
            source: BinaryIO = open(find(name), "rb")  # noqa: SIM115 - closed below
        else:
            source = tempfile.TemporaryFile()  # noqa: SIM115
            with urllib.request.urlopen(name, timeout=30) as answer:
                shutil.copyfileobj(answer, source)
            source.seek(0)
    except OSError as error:
        reason = getattr(error, "strerror", None) or getattr(error, "reason", None) or error
        raise InputError(
            f"{place}, column file",
            f"{name} cannot be read ({reason})",
            "a path relative to the working directory, an absolute path or a URL",
            "correct the path",
        ) from error
    with source:
        yield source


def check_sha256(source: BinaryIO, expected: str, name: str, place: str) -> str:
    """The SHA-256 of a file; InputError if ``expected`` is another one (empty: anything goes)."""
    state = hashlib.sha256()
    while piece := source.read(1 << 20):
        state.update(piece)
    digest = state.hexdigest()
    source.seek(0)
    if expected and digest != expected.lower():
        raise InputError(
            f"{name} ({place}, column sha256)",
            f"the checksum does not match: the file has {digest}",
            expected,
            "fetch the file anew, or correct the sheet if the file was changed on purpose",
        )
    return digest


def _netcdf(source: BinaryIO, row: Mapping[str, Any]) -> Table:
    name, time_column = row["file"], row.get("time_column", "")
    _check_opens(source, name)
    try:
        with netCDF4.Dataset(name, memory=source.read()) as file:
            store = xr.backends.NetCDF4DataStore(file)
            data = xr.open_dataset(store, decode_times=False, decode_timedelta=False).load()
    except MemoryError:
        raise
    except Exception as error:  # a damaged file makes the reader fail in ways that nobody listed
        raise InputError(name, f"it cannot be read ({error})", "a netCDF file", "convert it again") from error
    series = {str(key): data[key] for key in (*data.coords, *data.data_vars) if data[key].ndim == 1}
    # the columns are those along the time, or along the longest dimension where the sheet names no time
    sizes = {value.dims[0]: value.size for value in series.values()}
    along = (
        series[time_column].dims[0]
        if time_column in series
        else max(sizes, key=lambda name: sizes[name], default="")
    )
    series = {key: value for key, value in series.items() if value.dims[0] == along}
    table = pd.DataFrame({key: value.values for key, value in series.items()})
    table.index = table.index + 1
    units = {key: str(value.attrs["units"]) for key, value in series.items() if "units" in value.attrs}
    about = {str(key).lower(): value for key, value in data.attrs.items()}
    return Table(tuple(table.columns), about, [table], units=units)


def _one_column(source: BinaryIO, name: str, rate: float) -> Table:
    """The Table of a file with one number a line and no times, as a serial monitor shows them; lines above the numbers are titles."""
    text = io.TextIOWrapper(source, encoding=encoding(source, name), errors="replace")
    first = next((k for k, line in enumerate(text) if _number(line) is not None), None)
    if first is None:
        raise InputError(
            f"{name} (column rate_hz)",
            "no line of the file is a single number",
            "one number a line where the sheet states rate_hz",
            "leave rate_hz empty: times are read from the file",
        )
    return Table(
        ("time (s)", "signal"),
        {},
        _numbered(text, first, name, rate),
        layout=f"one number a line at {rate:g} Hz",
    )


def _numbered(text: io.TextIOWrapper, first: int, name: str, rate: float) -> Iterator[pd.DataFrame]:
    text.seek(0)
    for _ in range(first):
        text.readline()
    count, ended = 0, 0
    while lines := list(itertools.islice(text, PIECE)):
        numbers = [_number(line) for line in lines]
        for k, (line, number) in enumerate(zip(lines, numbers, strict=True), first + count + 1):
            if line.strip() and (number is None or ended):
                raise InputError(
                    f"{name}, line {ended or k}",
                    f"{line.strip()[:40]!r} is not a number"
                    if number is None
                    else "the line is empty and rows follow it",
                    "one number in every line, where the sheet states rate_hz",
                    "mend the file, or leave rate_hz empty if it has times of its own",
                )
            ended = ended or (0 if line.strip() else k)
        values = [number for number in numbers if number is not None]
        index = first + count + 1 + np.arange(len(values))
        if values:
            yield pd.DataFrame(
                {"time (s)": (count + np.arange(len(values))) / rate, "signal": values}, index=index
            )
        count += len(lines)
    text.detach()


def _number(line: str) -> float | None:
    try:
        return float(line.strip().replace(",", "."))
    except ValueError:
        return None


# Whatever a variable holds is asked for, in a process of its own: damage can make the library crash rather than complain.
_OPENING = """
import sys
import netCDF4
with netCDF4.Dataset("in memory", memory=sys.stdin.buffer.read()) as file:
    for variable in file.variables.values():
        variable[...], variable.__dict__
    file.__dict__
"""
_SECONDS = 120  # that it may take: half a gigabyte takes 10


def _check_opens(source: BinaryIO, name: str) -> None:
    """None if the netCDF library survives the file; InputError if it crashes or hangs. What it complains of is told where it is read."""
    try:
        done = subprocess.run(
            [sys.executable, "-c", _OPENING], stdin=source, capture_output=True, timeout=_SECONDS, check=False
        )
        what = f"the netCDF library crashes at it, signal {-done.returncode}" if done.returncode < 0 else ""
    except subprocess.TimeoutExpired:
        what = f"the netCDF library has not read it within {_SECONDS} s"
    finally:
        source.seek(0)
    if what:
        raise InputError(
            name, f"it cannot be read ({what})", "an undamaged netCDF file", "copy or convert it again"
        )
