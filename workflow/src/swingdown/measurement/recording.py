"""One recording: a row of the sample sheet becomes a dataset with units, provenance and a checked count."""

import math
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from .. import dataset
from ..arrays import Floats
from ..errors import InputError
from .columns import ANGLE, COUNTS, RATE, TIME, UNTOLD, VOLTAGE, Meaning, axes_beside, choose, known_unit
from .continuity import check_alive, check_continuous
from .gyroscope import TO_RAD_PER_S, check_rate, turning_most
from .plausibility import check_plausible, check_shrinks, half_swings, hanging
from .positions import Circle, check_no_positions, fit_circle, to_angles
from .quality import check_signal, check_times
from .release import Window, find_windows, several_releases, within
from .series import series
from .slack import tolerances
from .source import Table, check_sha256, opened, table_of
from .spikes import Spikes, as_variable, find_spikes

UNIT_WORDS = {
    "V": "volts", "rad": "rad", "deg": "degrees", "counts": "counts", "rad/s": "rad/s, an angular rate",
    "deg/s": "degrees a second, an angular rate",
}  # fmt: skip
SHORTEST = 10  # samples; fewer tell nothing about a swing
LONG_NAMES = {
    "V": "voltage of the angle sensor",
    "rad": "angle as recorded",
    "deg": "angle as recorded",
    "counts": "encoder counts as recorded",
    "rad/s": "angular rate as recorded",
    "deg/s": "angular rate as recorded",
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
    with opened(row["file"], place) as source:
        digest = check_sha256(source, row["sha256"], row["file"], place)
        table = table_of(source, row)
        return _recording(table, row, place, digest)


def _recording(table: Table, row: Mapping[str, Any], place: str, digest: str) -> xr.Dataset:
    name = row["file"]
    partial = _check_whole(table.about, row, name, place)
    for position, key in enumerate(("time_column", "signal_column")):
        _check_column(table.names, row[key], position, name, place, key)
    stated = row["time_unit"], row["signal_unit"]
    clock, found = choose(
        table.names, row["time_column"], row["signal_column"], f"{name} ({place})", stated, table.units
    )
    positions = len(found) == 2
    _check_own_unit(clock, row, "time", name, place)
    _check_own_unit(found[0], row, "signal", name, place)
    time_unit = known_unit(clock, row["time_unit"], (TIME,))
    told_unit = known_unit(found[0], row["signal_unit"], (ANGLE, VOLTAGE, COUNTS, RATE))
    signal_unit = "rad" if positions else told_unit or "rad"
    _check_unit(row, found[0].name, signal_unit, name, place)

    names = [one.name for one in found]
    if found[0].kind == RATE and not row["signal_column"]:
        names = axes_beside(table.names, found[0], table.units) or names
    unsaid = [] if row["signal_column"] else _unsaid(table, names)
    times, values, lines, total = series(table, row, clock.name, names, time_unit or "s", unsaid[:1])
    if len(times) < SHORTEST:
        raise InputError(
            f"{name} ({place})",
            f"{len(times)} samples between start_s and stop_s, of {total} in the file",
            f"at least {SHORTEST}",
            "correct start_s and stop_s, or the time unit",
        )
    check_times(times, lines, f"{name}, column {clock.name} ({place})", gaps=partial)
    del lines
    more: dict[str, float] = {}
    marked: dict[str, Any] = {}
    remarks = ["the last line has no end and was left out"] if table.cut else []
    if positions:
        circle = fit_circle(
            values[0], values[1], f"{name}, columns {found[0].name} and {found[1].name} ({place})"
        )
        signal = to_angles(values[0], values[1], circle)
        more = {f"pivot_{key}": value for key, value in circle._asdict().items()}
        remarks += [_pivot(circle, found[0].written)]
    else:
        beside = values[len(names) :]
        values = values[: len(names)]
        if unsaid:
            remarks += [
                f"the file has {len(table.names)} columns and no names of them: `{names[0]}` was taken (signal_column in the sheet says otherwise)"
            ]
            if not told_unit and np.isfinite(beside[0]).all():
                check_no_positions(values[0], beside[0], f"{name}, {names[0]} and {unsaid[0]} ({place})")
        taken, told = turning_most(names, values)
        found, signal, remarks = [replace(found[0], name=names[taken])], values[taken], remarks + told
    where = f"{name}, column {found[0].name} ({place})"
    check_signal(times, signal, where, static=row["role"] == "static")
    if row["role"] != "static":
        remarks += check_plausible(
            times, signal, signal_unit, bool(time_unit), bool(told_unit) or positions, where
        )
        if signal_unit in TO_RAD_PER_S:
            remarks += check_rate(times, signal, signal_unit, where)
        check_alive(times, signal, where)
        spikes = find_spikes(times, signal) if not partial else Spikes(np.zeros(signal.size, bool), signal)
        scale = _scale(signal_unit, row)
        hangs, told = hanging(spikes.healed, scale)
        more, remarks = more | ({"zero_rad": hangs} if hangs else {}), remarks + told
        hanging_down = spikes.healed - hangs / scale if hangs else spikes.healed
        used, told, more_told = _by_itself(times, hanging_down, signal_unit, row, where, partial)
        del hanging_down
        more, remarks, marked = more | more_told, remarks + told, as_variable(spikes.where)
        if not partial:
            _check_long_enough(spikes.healed[used], where)
            remarks += check_shrinks(spikes.healed[used], where)
        remarks += check_continuous(times[used], signal[used], where, spikes.within(used))

    counted = {"counts_per_revolution": row["counts_per_revolution"]} if signal_unit == "counts" else {}
    return xr.Dataset(
        {"signal": ("time", signal, {"units": signal_unit, "long_name": LONG_NAMES[signal_unit]}), **marked},
        {"time": ("time", times, {"units": "s", "long_name": "time as recorded"})},
        {
            "recording": row["recording"],
            **({"label": row["label"]} if row.get("label") else {}),
            "campaign": row["campaign"],
            "role": row["role"],
            "file": name,
            "sha256": digest,
            "source": table.about.get("source", "as recorded by its owner"),
            "emulated": "yes"
            if str(table.about.get("emulated", "no")).lower() in ("yes", "true", "1")
            else "no",
            "partial": "yes" if partial else "no",
            "expected_samples": len(times),
            "taken": _taken(table, clock, found, time_unit, told_unit, times),
            **tolerances(row, signal_unit, upright=not (positions or "zero_rad" in more)),
            **({"remarks": "; ".join(remarks)} if remarks else {}),
            **more,
            **counted,
        },
    )


def _unsaid(table: Table, names: list[str]) -> list[str]:
    """The columns after the swing's in a file without a header: what they hold nobody says, nor that the swing is not there."""
    if "no header" not in table.layout:
        return []
    return list(table.names[table.names.index(names[-1]) + 1 :])


def _by_itself(
    times: Floats, signal: Floats, unit: str, row: Mapping[str, Any], place: str, partial: bool
) -> tuple[slice, list[str], dict[str, float]]:
    """The samples in which the pendulum swings by itself, remarks on where that is, and the attributes that keep it.

    The sheet's start_s and stop_s are the last word. InputError for several releases, with the rows that name each of them.
    """
    if partial:  # across a gap nothing can be told
        return slice(None), [], {}
    windows, pushed = find_windows(times, signal, _scale(unit, row), unit in TO_RAD_PER_S)
    first, last = windows[0], windows[-1]
    by_hand = not math.isnan(row["start_s"]), not math.isnan(row["stop_s"])
    told = []
    if len(windows) > 1 and not any(by_hand):
        raise several_releases(windows, row, place)
    if len(windows) > 1:
        told = [f"the pendulum is released {len(windows)} times in it"]
        last = last._replace(ends=math.nan)
    found = Window(
        first.released,
        math.nan if by_hand[0] else first.begins,
        math.nan if by_hand[1] else last.ends,
        last.rests,
    )
    if pushed:
        told += [f"something other than the pendulum moves it at about {pushed[0]:.2f} s"]
    more: dict[str, float] = {}
    if not math.isnan(found.begins):
        more |= {"released_s": found.released, "begins_s": found.begins}
        told += [
            f"it begins in a hand and was released at about {found.released:.2f} s: "
            f"the swing is used from {found.begins:.3f} s on (start_s in the sheet says otherwise)"
        ]
    if not math.isnan(found.ends):
        more |= {"ends_s": found.ends}
        told += [
            f"{'it comes to rest and stays there' if found.rests else 'a hand stops it'}: "
            f"the swing is used until {found.ends:.3f} s (stop_s in the sheet says otherwise)"
        ]
    return within(found, times), told, more


def _scale(unit: str, row: Mapping[str, Any]) -> float:
    """Rad per unit of the signal; 0 where that is not known."""
    known = {"rad": 1.0, "deg": math.pi / 180, "counts": 2 * math.pi / row["counts_per_revolution"]}
    return known.get(unit, 0.0)


def _check_long_enough(signal: Floats, place: str) -> None:
    """InputError for less than a whole half-swing: no fit can tell a period of it, and it is better said before anything is computed."""
    if (count := len(half_swings(signal).starts)) < 3:
        raise InputError(
            place,
            f"the recording is too short: it passes its middle {max(count - 1, 0)} times",
            "three whole half-swings or more for a fit, nine for a search in one recording alone",
            "record longer, or widen start_s and stop_s",
        )


def _taken(
    table: Table, clock: Meaning, found: list[Meaning], time_unit: str, signal_unit: str, times: Floats
) -> str:
    """One line on how the file was read."""
    what = " and ".join(f"`{one.name}`" for one in found)
    if len(found) == 2:
        unit = "positions, the angle about a fitted pivot"
    else:
        unit = UNIT_WORDS[signal_unit] if signal_unit else "rad (no unit is stated)"
    rate = (len(times) - 1) / (times[-1] - times[0])
    parts = [
        f"took {what} as {unit}",
        f"`{clock.name}` as {time_unit or 's (no unit is stated)'}",
        f"{rate:.1f} samples a second",
        *([table.layout] if table.layout else []),
    ]
    return ", ".join(parts)


def _pivot(circle: Circle, unit: str) -> str:
    unit = f" {unit}" if unit else ""
    return (
        f"the pivot was fitted to the positions: x {circle.x:.6g} ± {circle.u_x:.2g}{unit}, "
        f"y {circle.y:.6g} ± {circle.u_y:.2g}{unit}, radius {circle.radius:.6g} ± {circle.u_radius:.2g}{unit}, "
        f"points {circle.residual:.2g}{unit} (RMS) from the circle"
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


def _check_own_unit(column: Meaning, row: Mapping[str, Any], key: str, name: str, place: str) -> None:
    """Refuses a unit in the sheet that is another than the one the file's attribute ``units`` tells."""
    said = row[f"{key}_unit"]
    if said and column.attribute and column.kind != UNTOLD and column.unit != said:
        raise InputError(
            f"{name} ({place}, column {key}_unit)",
            f"the sheet says {said!r} and the file says {column.written!r} of {column.name!r}",
            "one unit",
            f"correct {key}_unit in the sheet, or the file's own attribute `units`",
        )


def _check_column(
    columns: tuple[str, ...], wanted: str, position: int, name: str, place: str, key: str
) -> None:
    if (not wanted and len(columns) > position) or wanted in columns:
        return
    raise InputError(
        f"{name} ({place}, column {key})",
        f"the file has no column {wanted!r}" if wanted else f"the file has {len(columns)} column(s)",
        f"one of {', '.join(columns)}" if wanted else "a column of time and one of the signal",
        f"correct {key} in the sheet, or the file's header"
        if wanted or len(columns) > 1
        else "write the samples a second in the cell rate_hz of the sheet, if the file holds the signal alone",
    )


def _check_unit(row: Mapping[str, Any], column: str, unit: str, name: str, place: str) -> None:
    """Refuses units that need more than the file tells: they are stated in the sheet, where the workflow sees
    them.
    """
    if not row["signal_unit"] and unit == "V":
        raise InputError(
            f"{name} ({place}, column signal_unit)",
            f"the column {column!r} seems to be in V and the sheet does not say so",
            "an angle, or a calibration: recordings in volts need one",
            "calibrate it in a study with an apparatus sheet (docs/calibrate.md), or convert it to rad or deg",
        )
    turns = unit in TO_RAD_PER_S
    if (
        np.nan_to_num(row.get(other := "zero_tolerance_rad" if turns else "zero_tolerance_rad_per_s", 0.0))
        > 0
    ):
        raise InputError(
            f"{name} ({place}, column {other})",
            f"the signal is in {unit}",
            f"the limit of its zero in {'rad/s' if turns else 'rad'}",
            f"write it in the column {'zero_tolerance_rad_per_s' if turns else 'zero_tolerance_rad'}",
        )
    if unit == "counts" and not row["counts_per_revolution"] > 0:
        raise InputError(
            f"{name} ({place}, column counts_per_revolution)",
            f"the column {column!r} seems to be in counts and the sheet has no counts_per_revolution",
            "the encoder's counts per revolution",
            "fill it in, or write the unit in the cell signal_unit",
        )
