"""One recording: a row of the sample sheet becomes a dataset with units, provenance and a checked count."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from .. import dataset
from ..errors import InputError, as_told
from .choice import SeveralSwings, Uncalibrated, may_be_it
from .driven import UNITS, Stated, as_variables, judge_driven, stated
from .files import phyphox
from .files.columns import place_of
from .files.known_units import in_known_units, with_stated_length
from .files.runs import SeveralRuns
from .files.source import Table, check_sha256, opened, table_of
from .interpret import interpret
from .judge import Judged, Reading, check_used, judge, used_part
from .points.passages import ask_periods, passages
from .points.points_recording import about_file
from .points.points_table import turning_points
from .second_reading import OPEN, may_be_read_again
from .sheet import Row
from .signal import RELATIVE, Interpreted
from .slack import tolerances, with_rate
from .swings.release import SeveralReleases, several_releases, within
from .swings.spikes import Spikes, as_variable
from .units import NO_SCALE

LONG_NAMES = {
    "V": "voltage of the angle sensor",
    "rad": "angle as recorded",
    "deg": "angle as recorded",
    "counts": "encoder counts as recorded",
    "rad/s": "angular rate as recorded",
    "deg/s": "angular rate as recorded",
    NO_SCALE: "reading of unknown scale as recorded",
}
_NAMED = 12  # columns in an error
STATIC = Judged(np.empty(0), Reading("rad", False), Spikes(np.empty(0, dtype=bool), np.empty(0)), [])


def ingest(
    row: Row | pd.Series, sheet: str = "sample sheet", restoring: str = "sine", calibrated: bool = True
) -> xr.Dataset:
    """The dataset of one recording: ``signal(time)`` as recorded, ``time`` in s, provenance.

    Rows out of order are put in order, rows without a number are missing samples; the attribute ``remarks`` reports it. Leading
    lines ``# key: value`` of a CSV file are kept: ``emulated`` and ``source``.

    Parameters
    ----------
    row
        A row of ``sheet.read_sheet``, or a mapping of the same with the key ``recording``.
    sheet
        The sheet's name, for errors.
    restoring
        ``sine`` or ``linear``.
    calibrated
        Whether an apparatus tells the angle of readings in volts; else they have no scale unless the row states one.

    Raises
    ------
    InputError
        With file and row, column or time: a missing file or column, a wrong checksum, a clock that starts anew, a hole that hides
        an unknown number of swings, a partial recording, fewer than 10 samples, a constant or saturated signal.
    """
    row = {"recording": getattr(row, "name", None), **row}
    if calibrated or row["scale"] or row["role"] == "static":
        return _ingest(row, sheet, restoring)
    bare = {**row, "scale": RELATIVE, "signal_unit": "V"}
    try:
        return _ingest(bare if row["signal_unit"] == "V" else row, sheet, restoring)
    except Uncalibrated:
        return _ingest(bare, sheet, restoring)


def _ingest(row: dict[str, Any], sheet: str, restoring: str) -> xr.Dataset:
    line = f"line {row['line']}, " if "line" in row else ""
    place = f"{sheet}, {line}{row['recording']}"
    with opened(row["file"], place) as source:
        digest = check_sha256(source, row["sha256"], row["file"], place)
        table, row = with_stated_length(table_of(source, row), row, place)
        table, points = passages(in_known_units(table, row), row, place)
        if points is None:
            table, points = turning_points(table, row, place)
        if points is not None:
            return points.assign_attrs(sha256=digest)
        table = ask_periods(table, row, place)
        partial = _check_whole(table.about, row, row["file"], place)
        about = {"partial": "yes" if partial else "no", "sha256": digest}
        try:
            found = interpret(table, row, place, restoring)
            about |= {OPEN: "yes"} if may_be_read_again(row, found.guessed) else {}
            if others := may_be_it(table, row):
                about["columns_alike"] = ", ".join(others)
            return _dataset(row, table, found, about, place)
        except (SeveralRuns, SeveralReleases, SeveralSwings):
            raise
        except InputError as problem:
            # what is taken for the swing may be another column
            if not (others := may_be_it(table, row)):
                raise
            also = f"; or name the column of the angle ⟨in signal_column⟩: {', '.join(others[:_NAMED])}"
            also += f" and {len(others) - _NAMED} more" if len(others) > _NAMED else ""
            raise type(problem)(
                problem.where, problem.problem, problem.expected, problem.mend + also, problem.code
            ) from None


def _dataset(row: Row, table: Table, found: Interpreted, about: dict[str, Any], place: str) -> xr.Dataset:
    where, said = f"{row['file']}, {place_of(found.column)} ({place})", None
    if row["role"] == "static":
        judged, kept = STATIC, dict[str, float]()
        signal, reading, remarks = found.signal, found.reading, found.remarks
    elif (said := driven_so(row, found, place)) is not None:
        judged, kept = judge_driven(found.times, found.signal, found.reading, where), dict[str, float]()
        signal, reading, remarks = judged.signal, judged.reading, found.remarks + judged.remarks
        remarks.append(f"driven by `{row['input_column']}`, {said}: it is not asked whether it swings freely")
    else:
        judged = judge(found.times, found.signal, found.reading, where)
        kept, told = _by_itself(found, judged, row, where)
        signal, reading, remarks = judged.signal, judged.reading, found.remarks + judged.remarks + told
    unit = reading.unit
    unscaled = np.isnan(found.reading.scale) or (unit == NO_SCALE and not reading.stated)
    turned = {"zero_rad": judged.zero} if judged.zero else {}
    scaled = unit == NO_SCALE or (unit in ("V", "counts") and reading.scale)
    scale = {"rad_per_unit": reading.scale} if scaled else {}
    drive = {} if said is None or found.input is None else as_variables(found.times, found.input, said, where)
    counted = "counts_per_revolution" in found.about
    # the cells that are usual for such a file where the sheet has none
    usual = {key: value for key, value in table.usual.items() if np.isnan(row.get(key, np.nan))}
    stamp = table.about.get("time_standard_uncertainty_s")
    attributes = {
        **about_file(table, row, found.taken(reading)),
        **about,
        **{key: table.about[key] for key in phyphox.KEPT if key in table.about},
        "expected_samples": len(found.times),
        "unit_told": reading.told,
        "unit_stated": "yes" if reading.stated else "no",
        **with_rate(
            tolerances({**row, **usual}, unit, upright=not ("pivot_x" in found.about or turned)), found.rate
        ),
        **({"remarks": as_told("; ".join(remarks))} if remarks else {}),
        **({"time_standard_uncertainty_s": float(stamp)} if stamp is not None else {}),
        **({} if counted and not np.isfinite(found.about["counts_per_revolution"]) else found.about),
        **turned,
        **scale,
        **(reading.unscaled if unscaled else {}),
        **kept,
    }
    return xr.Dataset(
        {
            "signal": ("time", signal, {"units": unit, "long_name": LONG_NAMES[unit]}),
            **as_variable(judged.spikes.where),
            **drive,
        },
        {"time": ("time", found.times, {"units": "s", "long_name": "time as recorded"})},
        attributes,
    )


def driven_so(row: Row, found: Interpreted, place: str) -> Stated | None:
    """What is stated of a recording's input, by the sheet or else by the file; None of a free swing."""
    if found.input is None:
        return None
    if row.get("input_unit"):
        return stated(row, place)
    said = stated({**row, "input_unit": ""}, place)
    usable = found.input_unit in UNITS[said.kind] or (said.kind == "torque" and found.input_unit)
    return stated({**row, "input_unit": found.input_unit}, place) if usable else said


def _by_itself(
    found: Interpreted, judged: Judged, row: Row, place: str
) -> tuple[dict[str, float], list[str]]:
    """The attributes that keep the part in which the pendulum swings by itself, and remarks on it.

    The sheet's start_s and stop_s are the last word. InputError for several releases, with the rows that name each of them.
    """
    by_hand = bool(np.isfinite(row["start_s"])), bool(np.isfinite(row["stop_s"]))
    if len(judged.windows) > 1 and not any(by_hand):
        raise several_releases(judged.windows, row, place)
    window, told, kept = used_part(judged.windows, by_hand)
    used = within(window, found.times)
    return kept, told + check_used(found.times, judged, used, place, row.get("partial", "") == "allow")


def read_recording(path: str | Path) -> xr.Dataset:
    """The dataset of a recording on disk.

    Raises
    ------
    InputError
        If it lost samples or was not finished.
    """
    recording = dataset.read(path)
    expected, found = recording.attrs.get("expected_samples"), recording.sizes.get("time", 0)
    if expected != found:
        mend = "delete it and ingest it again"
        raise InputError(path, f"{found} samples", f"{expected}, as counted when it was written", mend)
    return recording


def _check_whole(about: Mapping[str, Any], row: Row, name: str, place: str) -> bool:
    """True for a recording that says it is partial and that the sheet allows; InputError if it does not."""
    if about.get("captured") == "yes" and about.get("complete") != 1:
        problem = "it has no completeness mark"
        raise InputError(name, problem, "a recording as capture wrote it", "capture or recover it again")
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
