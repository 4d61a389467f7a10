"""Arrays, tables of pandas and arrays of xarray as swings in radians, checked as a file's are."""

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from ..arrays import Floats
from ..errors import InputError
from ..measurement.angle import to_angle
from ..measurement.columns import ANGLE, RATE, choose, meaning
from ..measurement.continuity import check_continuous
from ..measurement.gyroscope import TO_RAD_PER_S, check_rate
from ..measurement.plausibility import check_plausible, hanging
from ..measurement.quality import check_signal, check_times
from ..measurement.recording import SHORTEST
from ..measurement.release import find_windows, within
from ..measurement.slack import tolerances
from ..measurement.spikes import as_variable, find_spikes

UNITS = ("rad", "deg", *TO_RAD_PER_S)
_SCALE = {"rad": 1.0, "deg": np.pi / 180}  # of angles: a hand is told in another way from rates
# What a file's owner mends in the sample sheet, the caller of a function mends in the call.
_MENDS = {
    "signal_unit": "say unit='deg' (or unit='rad' for counted turns)",
    "time_unit": "give the times in s",
    "start_s": "leave that part out of the arrays",
    "role": "look at what was recorded",
}


def swings(
    times: Any, angles: Any = None, unit: str | None = None, names: Sequence[str] | None = None
) -> list[xr.Dataset]:
    """Datasets of the angle in rad over the time in s, as ``measurement.angle.to_angle`` gives them: one a swing, and of a series
    with several releases one a release.

    What the arguments may be: ``answer.fit``. InputError names the swing and what is wrong with it.
    """
    if unit not in (None, *UNITS):
        raise InputError(
            "argument unit", f"unknown unit {unit!r}", " or ".join(UNITS), "convert the angles before"
        )
    found = list(_each(times, angles))
    if not found:
        raise InputError("argument times", "no swing is given", "at least one")
    names = list(names or [f"swing {k + 1}" if len(found) > 1 else "swing" for k in range(len(found))])
    if len(names) != len(found) or len(set(names)) < len(names):
        raise InputError(
            "argument names", f"{len(set(names))} names for {len(found)} swings", "one name each"
        )
    return [swing for name, one in zip(names, found, strict=True) for swing in _swings_in(name, *one, unit)]


def _each(times: Any, angles: Any) -> Iterator[tuple[Any, Any, str, dict[str, Any]]]:
    """Times, values, the unit that they state ("" for none) and attributes of each swing."""
    if angles is None and _several(times):
        for one in times:
            yield _alone(one)
    elif angles is None:
        yield _alone(times)
    elif _several(angles):
        clocks = list(times) if _several(times) else [times] * len(angles)
        if len(clocks) != len(angles):
            raise InputError(
                "arguments", f"{len(clocks)} series of times for {len(angles)} of angles", "one each"
            )
        for clock, values in zip(clocks, angles, strict=True):
            yield _clock(clock), values, _stated(values), _about(values)
    else:
        yield _clock(times), angles, _stated(angles), _about(angles)


def _several(given: Any) -> bool:
    """True for a list or tuple of series, False for one series."""
    return (
        isinstance(given, list | tuple)
        and len(given) > 0
        and not np.isscalar(given[0])
        and np.ndim(given[0]) > 0
    )


def _alone(given: Any) -> tuple[Any, Any, str, dict[str, Any]]:
    """A swing that brings its time along."""
    if isinstance(given, tuple) and len(given) == 2:
        return _clock(given[0]), given[1], _stated(given[1]), _about(given[1])
    if isinstance(given, xr.Dataset):
        found = [str(name) for name in given.data_vars if meaning(str(name)).kind == ANGLE]
        name = "angle" if "angle" in found else next(iter(found), None)
        if name is None:
            raise InputError(
                "Dataset", f"no angle among {', '.join(map(str, given.data_vars))}", "a variable `angle`"
            )
        return _alone(given[name].assign_attrs(given.attrs | given[name].attrs))
    if isinstance(given, xr.DataArray):
        if given.ndim != 1 or given.dims[0] not in given.coords:
            raise InputError(
                "DataArray", f"its dimensions are {given.dims}", "one, with the times as its coordinate"
            )
        return _clock(given[given.dims[0]]), given.values, _stated(given), _about(given)
    if isinstance(given, pd.DataFrame) and given.shape[1] > 1:
        clock, chosen = choose(tuple(map(str, given.columns)), "", "", "DataFrame")
        if len(chosen) > 1 or chosen[0].kind not in (ANGLE, RATE, ""):
            raise InputError(
                "DataFrame", f"column {chosen[0].name!r} holds no angle", "a column of the angle"
            )
        columns = dict(zip(map(str, given.columns), given.columns, strict=True))
        scale = {"ms": 1e-3, "us": 1e-6}.get(clock.unit, 1.0)
        return scale * _clock(given[columns[clock.name]]), given[columns[chosen[0].name]], chosen[0].unit, {}
    if isinstance(given, pd.DataFrame):
        given = given.iloc[:, 0]
    if isinstance(given, pd.Series):
        return _clock(given.index), given.to_numpy(), _stated(given), {}
    array = np.asarray(given, dtype=float)
    if array.ndim != 2 or 2 not in array.shape:
        raise InputError(
            "argument angles", "it is left out, and the times bring no angle along", "times and angles"
        )
    pair = array.T if array.shape[1] == 2 else array
    return pair[0], pair[1], "", {}


def _clock(times: Any) -> Floats:
    """Times in s; of dates and durations those since the first."""
    values = np.asarray(getattr(times, "values", times))
    if values.dtype.kind in "mM":
        return (values - values[0]) / np.timedelta64(1, "ns") * 1e-9
    return np.array(values, dtype=float)


def _stated(values: Any) -> str:
    """The unit that a series states: its attribute ``units``, or the end of its name."""
    if isinstance(values, xr.DataArray) and "units" in values.attrs:
        written = meaning("angle", str(values.attrs["units"]))
    else:
        written = meaning(str(getattr(values, "name", "") or ""))
    if written.written and written.unit not in UNITS:
        raise InputError(
            "angles", f"their unit is {written.written!r}", " or ".join(UNITS), "convert them before"
        )
    return written.unit


def _about(values: Any) -> dict[str, Any]:
    return dict(values.attrs) if isinstance(values, xr.DataArray) else {}


def _swings_in(
    name: str, times: Any, values: Any, stated: str, about: dict[str, Any], unit: str | None
) -> list[xr.Dataset]:
    values = np.array(values, dtype=float)
    if times.ndim != 1 or values.shape != times.shape:
        raise InputError(name, f"{values.size} angles for {times.size} times", "one angle for each time")
    if times.size < SHORTEST:
        raise InputError(name, f"{times.size} samples", f"at least {SHORTEST}", "record longer")
    if len(bad := np.flatnonzero(~(np.isfinite(times) & np.isfinite(values)))):
        raise InputError(f"{name}, sample {bad[0]}", f"not a finite number ({bad.size} such samples)", "numbers only", "leave them out at the ends")  # fmt: skip
    if unit and stated and unit != stated:
        raise InputError(
            name, f"unit={unit!r}, and the angles say that they are in {stated}", "one unit", "leave unit out"
        )
    taken = unit or stated or "rad"
    try:
        check_times(times, np.arange(times.size), name)
        check_signal(times, values, name)
        remarks = check_plausible(times, values, taken, True, bool(unit or stated), name)
        if taken in TO_RAD_PER_S:
            remarks += check_rate(times, values, taken, name)
        spikes = find_spikes(times, values)
        remarks += check_continuous(times, values, name, spikes)
    except InputError as problem:
        mend = next((text for key, text in _MENDS.items() if key in problem.mend), problem.mend)
        where = problem.where.replace(", line ", ", sample ")
        raise InputError(where, problem.problem, problem.expected, mend) from None
    hangs, told = hanging(spikes.healed, _SCALE.get(taken, 0.0))
    remarks += told
    more: dict[str, Any] = {"zero_rad": hangs, **tolerances({}, taken, upright=False)} if hangs else {}
    windows, _ = find_windows(
        times, spikes.healed - hangs / _SCALE.get(taken, 1.0), _SCALE.get(taken, 0.0), taken in TO_RAD_PER_S
    )
    if len(windows) > 1:
        parts = [within(one, times) for one in windows]
        return [
            swing
            for number, part in enumerate(parts, 1)
            for swing in _swings_in(
                f"{name}, release {number}", times[part], values[part], stated, about, unit
            )
        ]
    (window,) = windows
    if np.isfinite(window.begins):
        more |= {"released_s": window.released, "begins_s": window.begins}
        remarks.append(
            f"it begins in a hand and was released at about {window.released:.2f} s: used from {window.begins:.3f} s on"
        )
    if np.isfinite(window.ends):
        more |= {"ends_s": window.ends}
        remarks.append(
            f"used until {window.ends:.3f} s: {'then it rests' if window.rests else 'a hand stops it'}"
        )
    recording = xr.Dataset(
        {"signal": ("time", values, {"units": taken}), **as_variable(spikes.where)},
        {"time": ("time", times, {"units": "s", "long_name": "time as given"})},
        {
            "recording": name, "campaign": "pendulum", "role": "fit", "file": "", "sha256": "", "source": "given as arrays",
            "emulated": str(about.get("emulated", "no")), **more,
        },
    )  # fmt: skip
    return [to_angle(recording).assign_attrs(remarks="; ".join(remarks))]
