"""What phyphox tells of a recording beside its tables: the telephone, when the recording began, and where it was paused."""

import csv
import io
import zipfile
from collections.abc import Iterator, Mapping
from typing import Any, BinaryIO

import numpy as np

from ...errors import InputError
from .elements import DAMAGED, number
from .workbook import cells, sheet

DEVICE, EVENTS = ("meta/device.csv", "Metadata Device"), ("meta/time.csv", "Metadata Time")
KEPT = ("device", "begun")  # of what is told, kept with the recording


def told(source: BinaryIO) -> tuple[dict[str, str], tuple[str, ...]]:
    """``device`` (model) and ``begun`` (date and time of the phone's clock) of an open zip archive or workbook, as far as it tells
    them, and what is said of pauses.

    Empty for files of other programs; what cannot be read tells nothing.
    """
    source.seek(0)
    try:
        tables = _in_archive(source)
        if not tables:
            names, _ = sheet(source, "", DEVICE[1])
            asked = (("device", DEVICE[1]), ("events", EVENTS[1]))
            tables = {key: cells(source, "", name) for key, name in asked if name in names}
    except (InputError, OSError, ValueError, LookupError, csv.Error, *DAMAGED):
        return {}, ()
    finally:
        source.seek(0)
    device = {str(row[0]): str(row[1]) for row in tables.get("device", []) if len(row) > 1}
    model = " ".join(filter(None, (device.get("deviceBrand"), device.get("deviceModel"))))
    events = [row for row in tables.get("events", []) if len(row) > 3]
    begun = next((str(row[3]) for row in events if row[0] == "START"), "")
    # after the last pause nothing follows unless it is started again
    pauses = [row for row, following in zip(events, events[1:], strict=False) if (row[0], following[0]) == ("PAUSE", "START")]  # fmt: skip
    at = ", ".join(f"{seconds:.2f}" for row in pauses if np.isfinite(seconds := number(str(row[1]))))
    paused = (f"phyphox was paused at {at} s and its time goes on as if it had not been",) if at else ()
    return {key: value for key, value in (("device", model), ("begun", begun)) if value}, paused


def _in_archive(source: BinaryIO) -> Mapping[str, list[list[Any]]]:
    if not zipfile.is_zipfile(source):
        return {}
    with zipfile.ZipFile(source) as archive:
        found = {}
        for key, (path, _) in (("device", DEVICE), ("events", EVENTS)):
            if path in archive.namelist() and archive.getinfo(path).file_size < 1_000_000:
                found[key] = list(_rows(archive.read(path).decode("utf-8-sig")))
        return found


def _rows(text: str) -> Iterator[list[str]]:
    """The cells of a small table, separated by what stands behind its first, quoted cell."""
    separator = next((one for one in text.partition("\n")[0] if one in ",;\t"), ",")
    return csv.reader(io.StringIO(text), delimiter=separator)
