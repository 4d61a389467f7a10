"""Arrays, tables of pandas and arrays of xarray as swings in radians, checked as a file's are."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Literal, NamedTuple, TypedDict

import numpy as np
import pandas as pd
import xarray as xr

from ..arrays import Floats
from ..errors import InputError, as_told
from ..measurement.angle import to_angle
from ..measurement.choice import SHORTEST
from ..measurement.driven import as_variables, judge_driven, stated
from ..measurement.files.columns import ANGLE, RATE, choose, meaning
from ..measurement.files.series import MOST_EMPTY
from ..measurement.gyroscope import TO_RAD_PER_S
from ..measurement.judge import Judged, Reading, check_used, judge, used_part
from ..measurement.points.passages import Gate, as_passages, counted
from ..measurement.points.points_recording import as_recording
from ..measurement.points.points_recording import to_angle as points_to_angle
from ..measurement.points.points_table import unit_of
from ..measurement.points.turning_points import KINDS, PASSAGES, PERIODS, SWING, points_in
from ..measurement.slack import tolerances, with_rate, zero_unstated
from ..measurement.swings.clock import in_order, parts
from ..measurement.swings.even import evenly
from ..measurement.swings.gaps import missing_samples
from ..measurement.swings.release import within
from ..measurement.swings.spikes import as_variable
from ..measurement.units import NO_SCALE, in_rad, time_factor
from ..own_unit import UNNAMED
from ..pendulum.drive import Drive, drive
from .array_units import ANGLES, known_in, numbers, unit_named
from .array_units import angles as in_one_unit
from .array_units import times as seconds

# What a file's owner mends in the sample sheet, the caller of a function mends in the call: by the settings that a mend names.
_MENDS = {
    "restoring": "if a spring pulls it back say restoring='linear'; if these are degrees say unit='deg'",
    "signal_unit": "say unit='deg' or unit='rad'",
    "time_unit": "give the times in s",
    "start_s": "leave that part out of the arrays",
}


ZERO = "zero_tolerance_rad"  # the cell of the sheet


class Driven(TypedDict, total=False):
    """What can be said of a measured drive."""

    input: Any
    """Its values at the times of the swing, or a pair (times in s, values) of its own; of several swings a list."""
    input_kind: Literal["torque", "pivot_acceleration", "pivot_position", "pivot_angle"]
    """What it is: a torque over the inertia, or of the pivot the horizontal acceleration or position, or of a wheel the angle of its spring's other end."""
    input_unit: str
    """Of a torque rad/s^2, or any other with a gain to be found; of an acceleration m/s^2 or g; of a position m, cm or mm; of an angle rad or deg."""
    input_free: Sequence[str] | str
    """What of its sensor is to be found: gain, delay, or nothing."""
    input_between: Literal["curve", "line", "hold"]
    """What it does between its samples: a smooth curve through them, straight lines, or it keeps its last value."""


class Said(Driven, total=False):
    """What can be said of a swing beside its times and angles."""

    zero_tolerance: float
    """How far the zero of an angle may be off, in rad; by default 0.1, and the swings tell it."""


class Series(NamedTuple):
    """A swing as given: times (s), values, the unit that they state ("" for none) and attributes."""

    times: Floats
    values: Floats
    stated: str
    about: dict[str, Any]


def swings(
    times: Any,
    angles: Any = None,
    unit: str | None = None,
    names: str | Sequence[str] | None = None,
    kind: str = "",
    restoring: str = "sine",
    said: Mapping[str, Any] | None = None,
) -> list[xr.Dataset]:
    """Datasets of the angle in rad over the time in s, as ``measurement.angle.to_angle`` gives them: one a swing, of several releases one each.

    ``said`` is what else is said of them (``Said``), of swings by themselves nothing of an input; all other arguments are as of
    ``answer.fit``. InputError names the swing and what is wrong with it.
    """
    told, worth = unit_named(unit or "")
    if unit and told not in ANGLES:
        units = " or ".join(ANGLES)
        raise InputError("argument unit", f"unknown unit {unit!r}", units, "convert the angles first")
    unit = told or None
    if kind not in ("", *KINDS):
        raise InputError("argument kind", f"unknown kind {kind!r}", " or ".join(KINDS), "leave it out")
    if kind in (PASSAGES, PERIODS):
        return [_passages(times, angles, names, kind)]
    found = list(_each(times, angles))
    if worth != 1:
        if stated := next((one.stated for one in found if one.stated), ""):
            raise InputError(
                "argument unit", f"the angles themselves say {stated}", "one unit", "leave unit out"
            )
        found = [one._replace(values=worth * one.values) for one in found]
    names = [names] if isinstance(names, str) else names
    names = list(names or [f"swing {k + 1}" if len(found) > 1 else "swing" for k in range(len(found))])
    if len(names) != len(found):
        problem = f"names given: {len(names)}, swings: {len(found)}"
        raise InputError("argument names", problem, "one name each")
    if twice := next((name for name in names if names.count(name) > 1), None):
        raise InputError(
            "argument names", f"the name {twice!r} is there twice", "one name each", "rename one"
        )
    said = dict(said or {})
    if "zero_tolerance" in said:
        known = {ZERO: float(said.pop("zero_tolerance"))}
        found = [one._replace(about=one.about | known) for one in found]
    if said:
        inputs = _inputs(said["input"], len(found))
        each = zip(names, found, inputs, strict=True)
        return [_driven(name, one, drive, said, unit, restoring) for name, one, drive in each]
    return [
        swing
        for name, one in zip(names, found, strict=True)
        for swing in _swings_in(name, one, unit, kind, restoring)
    ]


def asked(given: Mapping[str, Any]) -> dict[str, Any]:
    """The arguments of a call that say more of a swing, by name; InputError for an unknown one, and for words on an
    input without one."""
    known = ", ".join(Said.__annotations__)
    for name in given:
        if name not in Said.__annotations__:
            raise InputError(f"argument {name}", "there is no such argument", known, "leave it out")
    said = {name: value for name, value in given.items() if value is not None}
    if not isinstance(said.get("zero_tolerance", 0.0), int | float):
        raise InputError("argument zero_tolerance", f"it is {said['zero_tolerance']!r}", "a number of rad", "leave it out: the swings tell their zero")  # fmt: skip
    driven = [name for name in said if name in Driven.__annotations__]
    if driven and "input" not in said:
        told = "the drive is described, but its values are missing", "input=, the values of the drive"
        raise InputError(f"argument {driven[0]}", *told, "give them, or leave the description out")
    return said


def drive_over(times: Floats, driven: Mapping[str, Any]) -> Drive:
    """The ``Drive`` that a call's arguments give, whose values are those at ``times`` (s) unless they bring their own."""
    said = stated(driven, "arguments")
    clock, values = _clocked(_inputs(driven["input"], 1)[0], times)
    return drive(clock, said.factor * values, said.kind, said.between, said.free)


def _inputs(given: Any, count: int) -> list[Any]:
    """The input of each swing: one for all, or one each."""
    each = list(given) if _several(given) and not (len(given) == 2 and count == 1) else [given] * count
    if len(each) != count:
        problem = f"{len(each)} inputs for {count} swings"
        raise InputError("argument input", problem, "one for each swing, or one for all")
    return each


def _clocked(given: Any, times: Floats) -> tuple[Floats, Floats]:
    """The times (s) and values of an input: a pair of both, or values at the ``times`` of the swing."""
    if isinstance(given, tuple) and len(given) == 2:
        return seconds(given[0]), numbers(given[1], "the input")
    values = numbers(given, "the input")
    if values.shape != times.shape:
        raise InputError(
            "argument input", f"{values.size} values for {times.size} times", "one for each time, or a pair (times, values) of its own",
        )  # fmt: skip
    return times, values


def _driven(
    name: str, given: Series, drive: Any, driven: Mapping[str, Any], unit: str | None, restoring: str
) -> xr.Dataset:
    """The dataset of a swing under a measured drive."""
    said = stated(driven, name)
    times, values = given.times, given.values
    _check_alike(name, times, values)
    clock, force = _clocked(drive, times)
    there = np.isfinite(times) & np.isfinite(values)
    if there.sum() < SHORTEST:
        raise InputError(name, f"{there.sum()} samples", f"at least {SHORTEST}", "record longer")
    taken = unit or given.stated or "rad"
    reading = Reading(taken, bool(unit or given.stated), in_rad(taken), restoring)
    judged = judge_driven(times[there], values[there], reading, name)
    attributes, forced = _attributes(name, given.about), as_variables(clock, force, said, name)
    return _as_angle(times[there], judged, forced, attributes, judged.remarks)


def _check_alike(name: str, times: Floats, values: Floats) -> None:
    if times.ndim != 1 or values.shape != times.shape:
        raise InputError(name, f"{values.size} angles for {times.size} times", "one angle for each time")


def _as_angle(
    times: Floats,
    judged: Judged,
    beside: Mapping[str, Any],
    attributes: Mapping[str, Any],
    remarks: Sequence[str],
) -> xr.Dataset:
    """The dataset of a swing that was judged, with the variables ``beside`` its signal."""
    recording = xr.Dataset(
        {"signal": ("time", judged.signal, {"units": judged.reading.unit}), **beside},
        {"time": ("time", times, {"units": "s", "long_name": "time as given"})},
        {**attributes, "unit_told": judged.reading.told} | ({"zero_rad": judged.zero} if judged.zero else {}),
    )
    return to_angle(recording).assign_attrs(remarks=as_told("; ".join(remarks)))


def _passages(times: Any, speeds: Any, names: Sequence[str] | None, kind: str) -> xr.Dataset:
    """The dataset of passages through a light gate, with their speeds where these are given."""
    name = list(names or ["swing"])[0]
    clock = seconds(times)
    read = np.full(clock.shape, np.nan) if speeds is None else numbers(speeds, "the speeds")
    if clock.ndim != 1 or read.shape != clock.shape or not np.all(np.diff(clock) > 0):
        expected = "increasing times (s), and a speed for each or none"
        raise InputError(name, f"{clock.size} times and {read.size} speeds", expected)
    points, kind = counted(Gate(clock, read, "", kind, "", []), kind, name)
    unit = "" if speeds is None else "as given"
    return points_to_angle(as_passages(points, kind, unit, _attributes(name, {})))


def _each(times: Any, angles: Any) -> Iterator[Series]:
    """Each swing."""
    if angles is None and _several(times):
        for one in times:
            yield _alone(one)
    elif angles is None:
        yield _alone(times)
    elif _several(angles):
        clocks = list(times) if _several(times) else [times] * len(angles)
        if len(clocks) != len(angles):
            problem = f"{len(clocks)} series of times for {len(angles)} of angles"
            raise InputError("arguments", problem, "one each")
        for clock, values in zip(clocks, angles, strict=True):
            yield _series(clock, values)
    else:
        yield _series(times, angles)


def _several(given: Any) -> bool:
    """True for a list or tuple of series, False for one series."""
    return isinstance(given, list | tuple) and len(given) > 0 and np.ndim(given[0]) > 0


def _series(times: Any, angles: Any) -> Series:
    about = dict(angles.attrs) if isinstance(angles, xr.DataArray) else {}
    return Series(seconds(times), *in_one_unit(angles), about)


def _alone(given: Any) -> Series:
    """A swing that brings its time along."""
    if isinstance(given, tuple) and len(given) == 2:
        return _series(*given)
    if isinstance(given, xr.Dataset):
        found = [str(name) for name in given.data_vars if meaning(str(name)).kind == ANGLE]
        name = "angle" if "angle" in found else next(iter(found), None)
        if name is None:
            there = ", ".join(map(str, given.data_vars))
            raise InputError("Dataset", f"no angle among {there}", "a variable `angle`")
        return _alone(given[name].assign_attrs(given.attrs | given[name].attrs))
    if isinstance(given, xr.DataArray):
        if given.ndim != 1 or given.dims[0] not in given.coords:
            expected = "one, with the times as its coordinate"
            raise InputError("DataArray", f"its dimensions are {given.dims}", expected)
        return _series(given[given.dims[0]], given)
    if isinstance(given, pd.DataFrame) and not given.shape[1]:
        raise InputError("DataFrame", "it has no column", "columns of the time and the angle", "fill it")
    if isinstance(given, pd.DataFrame) and given.shape[1] > 1:
        return _of_columns(given)
    if isinstance(given, pd.DataFrame):
        given = given.iloc[:, 0]
    if isinstance(given, pd.Series):
        return _series(given.index, given)
    array = numbers(given, "argument times")
    if not array.size:
        raise InputError("argument times", "they are empty", "times and angles", "give both")
    if array.ndim != 2 or 2 not in array.shape:
        problem = "no angles are given, and the times bring none along"
        raise InputError("argument angles", problem, "times and angles")
    pair = array.T if array.shape[1] == 2 else array
    return Series(pair[0], pair[1], "", {})


def _of_columns(table: pd.DataFrame) -> Series:
    """The swing in a table with a column of the time and one of the angle."""
    names = tuple(map(str, table.columns))
    clock, chosen = choose(names, "", "", "DataFrame", beside=known_in(names))
    if len(chosen) > 1 or chosen[0].kind not in (ANGLE, RATE, ""):
        raise InputError("DataFrame", f"column {chosen[0].name!r} holds no angle", "a column of the angle")
    columns = dict(zip(map(str, table.columns), table.columns, strict=True))
    return _series(table[columns[clock.name]], table[columns[chosen[0].name]])


def _swings_in(name: str, given: Series, unit: str | None, kind: str, restoring: str) -> list[xr.Dataset]:
    times, values, stated, about = given
    _check_alike(name, times, values)
    if points := _points(name, times, values, unit or stated, about, kind):
        return points
    missing = ~(np.isfinite(times) & np.isfinite(values))
    if not missing.size:
        raise InputError(name, "it is empty", f"at least {SHORTEST} samples", "give its times and angles")
    if missing.mean() > MOST_EMPTY:
        raise InputError(f"{name}, sample {np.argmax(missing)}", f"not a finite number ({missing.sum()} of {times.size} samples)", "numbers (a few samples may be missing)")  # fmt: skip
    times, values = times[~missing], values[~missing]
    if times.size < SHORTEST:
        raise InputError(name, f"{times.size} samples", f"at least {SHORTEST}", "record longer")
    if unit and stated and unit != stated:
        problem = f"the argument unit says {unit}, but the angles themselves say {stated}"
        raise InputError(name, problem, "one unit", "leave unit out")
    remarks = [f"{missing.sum()} of {missing.size} samples hold no number: missing"] if missing.any() else []
    taken = unit or stated or "rad"
    own = ("V" if taken == "V" else UNNAMED) if restoring == "linear" and taken not in TO_RAD_PER_S else ""
    scale = np.nan if taken == "V" else in_rad(taken)
    reading = Reading(taken, bool(unit or stated), scale, restoring, own=own)
    pieces = parts(times)
    if len(pieces) > 1:
        found = [(times[piece], values[piece], f"{name}, part {k}") for k, piece in enumerate(pieces, 1)]
    else:
        try:
            ordered = in_order(times, values, name)
            times, values = ordered.times, values[ordered.kept]
            judged = judge(times, values, reading, name)
            used = [within(one, times) for one in judged.windows]
            found = [(times[one], values[one], f"{name}, release {k}") for k, one in enumerate(used, 1)]
            if len(found) < 2:
                found = []
                window, told, kept = used_part(judged.windows)
                told += check_used(times, judged, within(window, times), name)
        except InputError as problem:
            mend = next((text for key, text in _MENDS.items() if key in problem.settings), problem.mend)
            raise InputError(problem.where, problem.problem, problem.expected, mend) from None
    if found:
        return [
            swing
            for when, what, called in found
            for swing in _swings_in(called, given._replace(times=when, values=what), unit, kind, restoring)
        ]
    even = evenly(times, values)  # the same samples, seen as holes of the clock
    again = missing_samples(even, times) if even.missing.sum() == missing.sum() else []
    remarks += [one for one in ordered.remarks + judged.remarks + told if one not in again]
    remarks += time_factor(times, judged.signal, True, name)[1]  # a call's times are in s
    attributes = _attributes(name, about) | kept | with_rate(_tolerances(about, taken), ordered.rate)
    if judged.reading.unit in (NO_SCALE, "V"):
        attributes |= {"rad_per_unit": judged.reading.scale} | judged.reading.unscaled
    return [_as_angle(times, judged, as_variable(judged.spikes.where), attributes, remarks)]


def _points(
    name: str, times: Floats, values: Floats, unit: str, about: dict[str, Any], kind: str
) -> list[xr.Dataset]:
    """The dataset of a series of turning points; none where it is one of samples."""
    if kind == SWING or unit in ("V", *TO_RAD_PER_S) or not (np.isfinite(times) & np.isfinite(values)).all():
        return []
    unit, told = unit_of(values, unit)
    points = points_in(times, values, name, kind, in_rad=in_rad(unit))
    if points is None:
        return []
    points = points._replace(remarks=[f"taken as turning points, {points.each}", *told, *points.remarks])
    return [points_to_angle(as_recording(points, unit, _attributes(name, about)))]


def _tolerances(about: Mapping[str, Any], unit: str) -> dict[str, float]:
    """The limits of error of a swing in this unit; its zero is open unless a limit is stated."""
    cell = "zero_tolerance_rad_per_s" if unit in TO_RAD_PER_S else ZERO
    stated = {cell: about[ZERO]} if ZERO in about else {}
    return tolerances(stated | zero_unstated(stated, unit), unit)


def _attributes(name: str, about: dict[str, Any]) -> dict[str, Any]:
    return {
        "recording": name, "campaign": "pendulum", "role": "fit", "file": "", "sha256": "", "source": "given as arrays",
        "emulated": str(about.get("emulated", "no")),
    }  # fmt: skip
