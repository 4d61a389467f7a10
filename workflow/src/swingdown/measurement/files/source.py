"""What a recording's file holds before any of it is read: a local file or one behind an address, text, netCDF, a workbook or a program's own."""

import errno
import hashlib
import io
import subprocess
import sys
import tempfile
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, BinaryIO

import numpy as np
import pandas as pd
import xarray as xr

from ...errors import InputError
from ...extras import needed
from ...paths import find, is_url
from ..refused import OTHER_BYTES
from ..sheet import Row
from . import phyphox
from .archive import unpacked
from .columns import TIME, meaning
from .delimited import delimited
from .elements import Columns
from .layout import CLOCKED
from .programs import saved_by_program
from .runs import by_name, clock_part, several_runs
from .sensor_logger import with_units
from .sensors import of_one_sensor
from .table import WHOLE, Table, prefixed

LARGEST = 2_000_000_000  # bytes that the variables of a netCDF file may take: it is held whole
MOST_BYTES = 5_000_000_000  # of a file: each is read twice, a minute for so many
_PIECE = 1 << 20  # bytes of it in memory
BESIDE_A_SIGNAL = ("sent", "sequence", "arrival")  # what a capture keeps of its device, which is no swing
NETCDF = (".nc", ".nc4", ".cdf", ".netcdf", ".h5", ".hdf5")


def runs(source: BinaryIO, row: Row) -> list[str]:
    """The names of the runs in an open file, in its order; none where it holds one recording. Errors are as of ``table_of``."""
    return [name for name in tables(source, row) if name]


def table_of(source: BinaryIO, row: Row) -> Table:
    """The table of an open file, or of one of its runs.

    Parameters
    ----------
    source
        As ``opened`` gives it.
    row
        Of the sample sheet; it asks for a run by its name, or by the columns that the run has.

    Raises
    ------
    InputError
        If the file cannot be read, or the run is not there.
    SeveralRuns
        If the row asks for none of several.
    """
    found = tables(source, row)
    named = {name: table for name, table in found.items() if name}
    if not named and WHOLE in found:
        return of_one_sensor(with_units(found[WHOLE], str(row.get("sheet", "") or row["file"])), row)
    asked = str(row.get("run", ""))
    if asked and (named or not clock_part(asked)):
        return named[by_name(named, asked, row["file"])]
    columns = {column for key in ("time_column", "signal_column") if (column := row.get(key))}
    able = [name for name, table in named.items() if columns <= set(table.names)]
    if len(able) == 1:
        return named[able[0]]
    if not able and WHOLE in found:
        return found[WHOLE]
    raise several_runs(tuple(able or named), row, row["file"])


def tables(source: BinaryIO, row: Row) -> dict[str, Table]:
    """The tables of an open file by the names of its runs, and by "" that of the whole file; errors as of ``table_of``."""
    name = row["file"]
    if name.lower().endswith(NETCDF):
        return {WHOLE: _netcdf(source, row)}
    rate = float(row.get("rate_hz", np.nan))
    if saved := saved_by_program(source, name):
        return {run: _of_program(columns, rate) for run, columns in saved.items()}
    if inside := unpacked(source, name, str(row.get("sheet", ""))):
        text, where, own = inside
        if own:  # what has a reader of its own is read as in a folder
            return prefixed(where, tables(text, {**row, "file": f"{name}, {own}", "sheet": ""}))
        about, paused = phyphox.told(source)
        return {
            run: table._replace(
                about=table.about | about,
                remarks=(*table.remarks, *paused),
                layout=table.layout.replace("tabs", where, 1)
                if "sheet" in where
                else f"{where}, {table.layout}",
            )
            for run, table in delimited(text, f"{name}, {where}", rate).items()
        }
    if row.get("sheet"):
        problem = f"the file has no sheets, and the sample sheet asks for {row['sheet']!r}"
        expected = "a workbook or a zip archive"
        raise InputError(f"{name} (column sheet)", problem, expected, "leave the cell `sheet` empty")
    return delimited(source, name, rate)


def _of_program(columns: Columns, rate: float) -> Table:
    """The Table of what a program saved; its times are made of the ``rate`` (Hz) where that is given and none are there."""
    frame = columns.frame.set_axis(range(1, len(columns.frame) + 1))
    if rate > 0 and not any(meaning(str(name)).kind == TIME for name in frame):
        frame.insert(0, CLOCKED, np.arange(len(frame)) / rate)
    return Table(
        tuple(frame.columns),
        columns.about,
        [frame],
        layout=columns.layout,
        units=columns.units,
        remarks=columns.remarks,
        usual=columns.usual,
        ordered=columns.ordered,
    )


@contextmanager
def opened(name: str, place: str) -> Iterator[BinaryIO]:
    """A file or URL, open for reading. A URL is kept on the disk meanwhile.

    InputError if it cannot be had, is larger than any recording, or fails while it is read.
    """
    try:
        source = _copied(name) if is_url(name) else _local(name)
    except OSError as error:
        reason = getattr(error, "strerror", None) or getattr(error, "reason", None) or error
        problem = f"{name} cannot be read ({reason})"
        expected = "a path relative to the working directory, an absolute path or a URL"
        raise InputError(f"{place}, column file", problem, expected, "correct the path") from error
    with source:
        if (size := source.seek(0, io.SEEK_END)) > MOST_BYTES:
            problem = f"it has {size / 1e9:.0f} GB"
            expected = f"a recording, of at most {MOST_BYTES / 1e9:.0f} GB"
            raise InputError(name, problem, expected, "write the part with the swing to a file of its own")
        source.seek(0)
        try:
            yield source
        except OSError as error:
            problem = f"it cannot be read to its end ({error.strerror or error})"
            mend = "copy it again: the disk, the card or the connection that it is on may fail"
            raise InputError(name, problem, "a file that can be read whole", mend) from error


def _local(name: str) -> BinaryIO:
    path = find(name)
    if path.exists() and not path.is_file():
        raise OSError(errno.EINVAL, "it is no file")
    return open(path, "rb")


def _copied(address: str) -> BinaryIO:
    copy = tempfile.TemporaryFile()  # noqa: SIM115 - closed by ``opened``
    with urllib.request.urlopen(address, timeout=30) as answer:
        while (piece := answer.read(_PIECE)) and copy.tell() <= MOST_BYTES:
            copy.write(piece)
    return copy


def check_sha256(source: BinaryIO, expected: str, name: str, place: str) -> str:
    """The SHA-256 of a file.

    Parameters
    ----------
    source
        As ``opened`` gives it.
    expected
        What it has to be; empty: anything.
    name, place
        What an error names.

    Raises
    ------
    InputError
        If it is another one.
    """
    state = hashlib.sha256()
    while piece := source.read(_PIECE):
        state.update(piece)
    digest = state.hexdigest()
    source.seek(0)
    if expected and digest != expected.lower():
        problem = f"the checksum does not match: the file has {digest}"
        mend = "fetch the file anew, or correct the sheet if the file was changed on purpose"
        raise InputError(f"{name} ({place}, column sha256)", problem, expected, mend, OTHER_BYTES)
    return digest


def _netcdf(source: BinaryIO, row: Row) -> Table:
    name, time_column = row["file"], row.get("time_column", "")
    library = needed("netCDF4")
    _check_opens(source, name)
    try:
        with library.Dataset(name, memory=source.read()) as file:
            store = xr.backends.NetCDF4DataStore(_with_variables(file))
            data = xr.open_dataset(store, decode_times=False, decode_timedelta=False).load()
            groups = ", ".join(file.groups)
    except MemoryError:
        raise
    except Exception as error:  # a damaged file makes the reader fail in ways that nobody listed
        raise InputError(name, f"it cannot be read ({error})", "a netCDF file", "convert it again") from error
    series = {str(key): data[key] for key in (*data.coords, *data.data_vars) if data[key].ndim == 1}
    if not series:
        raise InputError(
            name, "it holds no variable of one dimension" + (f", but the groups {groups}" if groups else ""),
            "a time and a swing of one recording, each a variable", "save each as its own array, and each recording as its own file",
        )  # fmt: skip
    # the columns are those along the time, or along the longest dimension where the sheet names no time
    sizes = {value.dims[0]: value.size for value in series.values()}
    along = max(sizes, key=lambda name: sizes[name], default="")
    if time_column in series:
        along = series[time_column].dims[0]
    series = {key: value for key, value in series.items() if value.dims[0] == along}
    if data.attrs.get("captured") == "yes":
        named = (time_column, row.get("signal_column", ""))
        series = {key: value for key, value in series.items() if key in named or key not in BESIDE_A_SIGNAL}
    table = pd.DataFrame({key: value.values for key, value in series.items()})
    table.index = table.index + 1
    units = {key: str(value.attrs["units"]) for key, value in series.items() if "units" in value.attrs}
    about = {str(key).lower(): value for key, value in data.attrs.items()}
    return Table(tuple(table.columns), about, [table], units=units)


def _with_variables(group: Any) -> Any:
    """The group of a file that holds its variables: the file itself, or what it holds as its only group."""
    while not group.variables and len(group.groups) == 1:
        (group,) = group.groups.values()
    return group


# Whatever a variable holds is asked for, in a process of its own: damage can make the library crash rather than complain.
_OPENING = """
import math
import sys
import netCDF4
def within(group):
    yield group
    for one in group.groups.values():
        yield from within(one)
with netCDF4.Dataset("in memory", memory=sys.stdin.buffer.read()) as file:
    variables = [one for group in within(file) for one in group.variables.values()]
    declared = sum(math.prod(map(int, one.shape)) * getattr(one.dtype, "itemsize", 8) for one in variables)
    if declared > int(sys.argv[1]):
        print(declared)
        sys.exit(3)
    for variable in variables:
        variable[...], variable.__dict__
    file.__dict__
"""
_SECONDS = 120  # that it may take: half a gigabyte takes 10


def _check_opens(source: BinaryIO, name: str) -> None:
    """None if the netCDF library survives the file; InputError if it crashes or hangs. What it complains of is told where it is read."""
    try:
        done = subprocess.run(
            [sys.executable, "-c", _OPENING, str(LARGEST)],
            stdin=source,
            capture_output=True,
            timeout=_SECONDS,
            check=False,
        )
        what = f"the netCDF library crashes at it, signal {-done.returncode}" if done.returncode < 0 else ""
        if done.returncode == 3:
            problem = f"its variables take {int(done.stdout) / 1e6:.0f} MB"
            expected = f"at most {LARGEST / 1e6:.0f} MB: a netCDF file is held whole"
            raise InputError(name, problem, expected, "write the recording to a file of its own")
    except subprocess.TimeoutExpired:
        what = f"the netCDF library has not read it within {_SECONDS} s"
    finally:
        source.seek(0)
    if what:
        problem = f"it cannot be read ({what})"
        raise InputError(name, problem, "an undamaged netCDF file", "copy or convert it again")
