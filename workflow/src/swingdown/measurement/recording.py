"""One recording: a row of the sample sheet becomes a dataset with units, provenance and a checked count."""

import hashlib
import io
import math
import urllib.request
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import netCDF4
import numpy as np
import pandas as pd
import xarray as xr
from numpy.typing import NDArray

from .. import dataset
from ..arrays import Floats
from ..errors import InputError
from ..paths import find, is_url
from .quality import check_signal, check_times
from .sheet import SIGNAL_UNITS, TIME_UNITS, unit_of

NETCDF = (".nc", ".nc4", ".cdf", ".netcdf")
SHORTEST = 10  # samples; fewer tell nothing about a swing
LONG_NAMES = {
    "V": "voltage of the angle sensor",
    "rad": "angle as recorded",
    "deg": "angle as recorded",
    "counts": "encoder counts as recorded",
}


def ingest(row: Mapping[str, Any] | pd.Series, sheet: str = "sample sheet") -> xr.Dataset:
    """The dataset of one recording: ``signal(time)`` as recorded, ``time`` in seconds, provenance.

    ``row`` is a row of ``sheet.read_sheet``, or a mapping of the same with the key ``recording``. Leading
    lines ``# key: value`` of a CSV file are its own account of itself; ``emulated`` and ``source`` are kept.
    InputError names file and row, column or time for: a file or column that is missing, a checksum that does
    not match, cells that are not numbers, time that repeats, runs back or has a gap, a recording that says it is partial where
    the sheet's column ``partial`` does not allow it, fewer than 10 samples,
    and a signal that is constant (unless the role is static) or saturated.
    """
    row = {"recording": getattr(row, "name", None), **row}
    place = (
        f"{sheet}, line {row['line']}, {row['recording']}"
        if "line" in row
        else f"{sheet}, {row['recording']}"
    )
    payload = read_bytes(row["file"], place)
    digest = check_sha256(payload, row["sha256"], row["file"], place)
    return from_bytes(payload, row, place, digest)


def from_bytes(payload: bytes, row: Mapping[str, Any], place: str, digest: str) -> xr.Dataset:
    """The dataset of ``ingest`` from a file's content."""
    name = row["file"]
    table, about = (
        _netcdf(payload, name, row.get("time_column", ""))
        if name.lower().endswith(NETCDF)
        else _csv(payload, name)
    )
    partial = _check_whole(about, row, name, place)
    time_column = _column(table, row["time_column"], 0, name, place, "time_column")
    signal_column = _column(table, row["signal_column"], 1, name, place, "signal_column")
    time_unit = row["time_unit"] or unit_of(time_column, TIME_UNITS) or "s"
    signal_unit = row["signal_unit"] or unit_of(signal_column, SIGNAL_UNITS) or "rad"
    _check_unit(row, signal_column, signal_unit, name, place)

    lines = table.attrs["first_line"] + np.arange(len(table))
    times = _numbers(table[time_column], lines, name, time_column) * TIME_UNITS[time_unit]
    inside = np.ones(len(times), dtype=bool)
    if not math.isnan(row["start_s"]):
        inside &= times >= row["start_s"]
    if not math.isnan(row["stop_s"]):
        inside &= times <= row["stop_s"]
    times, lines = times[inside], lines[inside]
    if len(times) < SHORTEST:
        raise InputError(
            f"{name} ({place})",
            f"{len(times)} samples between start_s and stop_s, of {len(table)} in the file",
            f"at least {SHORTEST}",
            "correct start_s and stop_s, or the time unit",
        )
    signal = _numbers(table[signal_column][inside], lines, name, signal_column)
    check_times(times, lines, f"{name}, column {time_column} ({place})", gaps=partial)
    check_signal(times, signal, f"{name}, column {signal_column} ({place})", static=row["role"] == "static")

    counted = {"counts_per_revolution": row["counts_per_revolution"]} if signal_unit == "counts" else {}
    return xr.Dataset(
        {"signal": ("time", signal, {"units": signal_unit, "long_name": LONG_NAMES[signal_unit]})},
        {"time": ("time", times, {"units": "s", "long_name": "time as recorded", "axis": "T"})},
        {
            "recording": row["recording"],
            "campaign": row["campaign"],
            "role": row["role"],
            "file": name,
            "sha256": digest,
            "source": about.get("source", "as recorded by its owner"),
            "emulated": "yes" if str(about.get("emulated", "no")).lower() in ("yes", "true", "1") else "no",
            "partial": "yes" if partial else "no",
            "expected_samples": len(times),
            **counted,
        },
    )


def read_recording(path: str | Path) -> xr.Dataset:
    """The dataset of a recording on disk; InputError if it lost samples or was not finished."""
    recording = dataset.read(path)
    expected, found = recording.attrs.get("expected_samples"), recording.sizes.get("time", 0)
    if expected != found:
        raise InputError(
            path,
            f"{found} samples",
            f"{expected}, as counted when it was written",
            "delete it and ingest it again",
        )
    return recording


def read_bytes(name: str, place: str) -> bytes:
    """The content of a file or URL, as bytes; InputError with ``place`` if it cannot be had."""
    try:
        if is_url(name):
            with urllib.request.urlopen(name, timeout=30) as answer:
                return answer.read()
        return Path(find(name)).read_bytes()
    except OSError as error:
        reason = getattr(error, "strerror", None) or getattr(error, "reason", None) or error
        raise InputError(
            f"{place}, column file",
            f"{name} cannot be read ({reason})",
            "a path relative to the working directory, an absolute path or a URL",
            "correct the path",
        ) from error


def check_sha256(payload: bytes, expected: str, name: str, place: str) -> str:
    """The SHA-256 of ``payload``; InputError if ``expected`` is another one (empty: anything goes)."""
    digest = hashlib.sha256(payload).hexdigest()
    if expected and digest != expected.lower():
        raise InputError(
            f"{name} ({place}, column sha256)",
            f"the checksum does not match: the file has {digest}",
            expected,
            "fetch the file anew, or correct the sheet if the file was changed on purpose",
        )
    return digest


def _csv(payload: bytes, name: str) -> tuple[pd.DataFrame, dict[str, str]]:
    try:
        text = payload.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(
            name, f"it is not text ({error})", "CSV in UTF-8, or netCDF", "convert it"
        ) from error
    about, skip = {}, 0
    for line in text.splitlines():
        if not line.startswith("#"):
            break
        key, colon, value = line.lstrip("# ").partition(":")
        if colon:
            about[key.strip().lower()] = value.strip()
        skip += 1
    try:
        table = pd.read_csv(io.StringIO(text), skiprows=skip, skip_blank_lines=False, skipinitialspace=True)
    except (pd.errors.ParserError, pd.errors.EmptyDataError) as error:
        raise InputError(
            name, f"it is not a table ({error})", "CSV with a header", "correct the file"
        ) from error
    table.columns = [str(column).strip() for column in table.columns]
    table.attrs["first_line"] = skip + 2
    return table, about


def _check_whole(about: Mapping[str, Any], row: Mapping[str, Any], name: str, place: str) -> bool:
    """True for a recording that says it is partial and that the sheet allows; InputError if it does not."""
    if about.get("captured") == "yes" and about.get("complete") != 1:
        raise InputError(
            name,
            "it has no completeness mark",
            "a recording as capture wrote it",
            "capture or recover it again",
        )
    if about.get("partial") != "yes":
        return False
    if row.get("partial", "") != "allow":
        raise InputError(
            f"{name} ({place}, column partial)",
            f"the recording is partial ({about.get('problems') or 'it does not say why'}): "
            f"{about.get('received', '?')} of {about.get('expected', '?')} samples",
            "a whole recording",
            "record it again, or write `allow` in the column partial to use what there is",
        )
    return True


def _netcdf(payload: bytes, name: str, time_column: str = "") -> tuple[pd.DataFrame, dict[str, Any]]:
    try:
        with netCDF4.Dataset(name, memory=payload) as file:
            store = xr.backends.NetCDF4DataStore(file)
            data = xr.open_dataset(store, decode_times=False, decode_timedelta=False).load()
    except MemoryError:
        raise
    except Exception as error:  # a damaged file makes the reader fail in ways that nobody listed
        raise InputError(name, f"it cannot be read ({error})", "a netCDF file", "convert it again") from error
    series = {key: data[key] for key in (*data.coords, *data.data_vars) if data[key].ndim == 1}
    # the columns are those along the time, or along the longest dimension where the sheet names no time
    sizes = {value.dims[0]: value.size for value in series.values()}
    along = (
        series[time_column].dims[0]
        if time_column in series
        else max(sizes, key=lambda name: sizes[name], default="")
    )
    table = pd.DataFrame({key: value.values for key, value in series.items() if value.dims[0] == along})
    table.attrs["first_line"] = 1
    return table, {str(key).lower(): value for key, value in data.attrs.items()}


def _column(table: pd.DataFrame, wanted: str, position: int, name: str, place: str, key: str) -> str:
    columns = [str(column) for column in table.columns]
    if not wanted and len(columns) > position:
        return columns[position]
    if wanted not in columns:
        raise InputError(
            f"{name} ({place}, column {key})",
            f"the file has no column {wanted!r}" if wanted else f"the file has {len(columns)} column(s)",
            f"one of {', '.join(columns)}" if wanted else "a column of time and one of the signal",
            f"correct {key} in the sheet, or the file's header",
        )
    return wanted


def _numbers(column: pd.Series, lines: NDArray[np.integer], name: str, key: str) -> Floats:
    values = pd.to_numeric(column, errors="coerce").to_numpy(dtype=float)
    bad = np.flatnonzero(~np.isfinite(values))
    if len(bad):
        first = bad[0]
        raise InputError(
            f"{name}, line {lines[first]}, column {key}",
            f"{column.iloc[first]!s} is not a finite number ({len(bad)} such cells)",
            "a number in every row",
            "mend the file, or leave the part out with start_s and stop_s",
        )
    return values


def _check_unit(row: Mapping[str, Any], column: str, unit: str, name: str, place: str) -> None:
    """Refuses units that need more than the file tells: they are stated in the sheet, where the workflow sees
    them.
    """
    if not row["signal_unit"] and unit == "V":
        raise InputError(
            f"{name} ({place}, column signal_unit)",
            f"the column {column!r} seems to be in V and the sheet does not say so",
            "V in signal_unit: recordings in volts need a calibration",
            "write the unit of the signal in the cell signal_unit",
        )
    if unit == "counts" and not row["counts_per_revolution"] > 0:
        raise InputError(
            f"{name} ({place}, column counts_per_revolution)",
            f"the column {column!r} seems to be in counts and the sheet has no counts_per_revolution",
            "the encoder's counts per revolution",
            "fill it in, or write the unit in the cell signal_unit",
        )
