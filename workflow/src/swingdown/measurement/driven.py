"""A recording of a driven pendulum: what its input is, in which unit, and the swing, of which nothing is asked that only a free one has."""

from collections.abc import Mapping, Sequence
from functools import lru_cache
from math import pi
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from ..arrays import Floats
from ..errors import InputError
from ..pendulum.drive import BETWEEN, FREE, KINDS, Drive, drive
from .judge import Judged, Reading
from .plausibility import hanging
from .swings.quality import check_signal
from .swings.release import WHOLE
from .swings.spikes import Spikes
from .units import NO_SCALE, TURNS, unwrapped

GRAVITY = 9.80665  # m/s^2, that an acceleration in units of g goes by
UNITS: dict[str, dict[str, float]] = {
    "torque": {"rad/s^2": 1.0, "deg/s^2": pi / 180},
    "pivot_acceleration": {"m/s^2": 1 / GRAVITY, "g": 1.0},
    "pivot_position": {"m": 1.0, "cm": 1e-2, "mm": 1e-3},
    "pivot_angle": {"rad": 1.0, "deg": pi / 180},
}
"""By kind the units of an input and what they are worth in those of ``KINDS``; the first is taken where none is stated, but of a torque."""
CURVES = "curves against the amplitude are of free swings"
LAWS = "laws of damping are compared by free swings"
_DIMENSION = "input_time"


class Stated(NamedTuple):
    """What is stated of an input: a key of ``KINDS``, its unit (empty: none), what it does between samples, and what of its sensor is to be found."""

    kind: str
    unit: str = ""
    between: str = "curve"
    free: tuple[str, ...] = ()

    def __str__(self) -> str:
        what = f"a {self.kind.replace('_', ' ')}"
        if self.unit:
            return f"{what} in {self.unit}"
        if self.kind == "torque":
            return f"{what} in a unit of its own"
        return f"{what} in {next(iter(UNITS[self.kind]))} (no unit is stated)"

    @property
    def factor(self) -> float:
        """What a unit of it is worth in that of ``KINDS``; of a torque in a unit of its own 1."""
        known = UNITS[self.kind]
        return known.get(self.unit, 1.0) if self.kind == "torque" else known[self.unit or next(iter(known))]


def stated(given: Mapping[str, Any], where: str) -> Stated:
    """What a row of the sheet, or a call, states of its input.

    Parameters
    ----------
    given
        ``input_kind``, ``input_unit``, ``input_between`` and ``input_free``. Of a torque whose unit is not that of an angular acceleration
        the gain is always fitted.
    where
        What an error names as its place.

    Raises
    ------
    InputError
        If a cell holds none of the known words; it names the mend.
    """
    kind, unit = str(given.get("input_kind") or ""), str(given.get("input_unit") or "")
    if not kind:
        problem = "an input is named, and its kind is not stated"
        raise InputError(f"{where}, input_kind", problem, " or ".join(KINDS), "say what it is")
    for key, known in (("input_kind", tuple(KINDS)), ("input_between", BETWEEN)):
        if (found := str(given.get(key) or "")) and found not in known:
            raise InputError(f"{where}, {key}", f"unknown {key} {found!r}", " or ".join(known))
    if unit and kind != "torque" and unit not in UNITS[kind]:
        raise InputError(f"{where}, input_unit", f"{unit!r} is no unit of a {kind}", " or ".join(UNITS[kind]))
    said = given.get("input_free")
    parts = (
        said.replace(",", " ").split() if isinstance(said, str) else list(said) if said is not None else []
    )
    if unknown := [name for name in parts if name not in (*FREE, "nothing")]:
        raise InputError(f"{where}, input_free", f"unknown {unknown[0]!r}", " or ".join((*FREE, "nothing")))
    if not parts and kind == "torque" and unit not in UNITS[kind]:
        parts = ["gain"]
    free = tuple(name for name in FREE if name in parts)
    return Stated(kind, unit, str(given.get("input_between") or "curve"), free)


def judge_driven(times: Floats, signal: Floats, reading: Reading, place: str) -> Judged:
    """The ``Judged`` swing of a driven pendulum: ``times`` (s, rising) and ``signal``, of which no hand, hole or decay is asked.

    InputError for what is constant or clipped, and for a reading without a scale: a drive acts on an angle that is known.
    """
    remarks: list[str] = []
    if reading.unit in TURNS:
        signal, remarks = unwrapped(signal, reading.unit if reading.stated else "")
    check_signal(times, signal, place)
    if reading.unit == NO_SCALE or np.isnan(reading.scale):
        raise InputError(
            place, "its readings have no scale, and a measured drive acts on an angle", "an angle",
            "state the degrees that one unit is worth ⟨in scale⟩",
        )  # fmt: skip
    zero, told = hanging(signal, reading.scale, False) if reading.scale else (0.0, [])
    nothing = Spikes(np.zeros(signal.size, dtype=bool), signal)
    return Judged(signal, reading, nothing, [WHOLE], zero, remarks + told)


def as_variables(times: Floats, values: Floats, said: Stated, place: str) -> dict[str, Any]:
    """The variables of a recording that hold its input over a time of its own, in the unit of ``KINDS``; InputError as ``drive`` raises it."""
    try:
        drive(times, said.factor * values, said.kind, said.between, said.free)
    except InputError as problem:
        mend = problem.mend
        raise InputError(f"{place}, {problem.where}", problem.problem, problem.expected, mend) from problem
    unit = said.unit if said.kind == "torque" and said.unit not in UNITS["torque"] else KINDS[said.kind]
    about = {
        "units": unit or "as given", "long_name": f"measured input: {said.kind.replace('_', ' ')}",
        "kind": said.kind, "between": said.between, "free": " ".join(said.free),
    }  # fmt: skip
    return {
        "input": (_DIMENSION, said.factor * values, about),
        _DIMENSION: (_DIMENSION, times, {"units": "s", "long_name": "time of the input"}),
    }


def carried(recording: xr.Dataset) -> dict[str, Any]:
    """The same variables of another dataset, to hand on; none of a free swing."""
    return {name: recording[name] for name in ("input",) if name in recording}


def drive_of(recording: xr.Dataset) -> Drive | None:
    """The ``Drive`` that a recording's dataset, or its angle's, holds; None of a free swing. The same samples give the same object."""
    if "input" not in recording:
        return None
    own = recording["input"]
    free = tuple(str(own.attrs["free"]).split())
    raw = (np.ascontiguousarray(one, dtype=float).tobytes() for one in (own[_DIMENSION].values, own.values))
    return _drive(*raw, str(own.attrs["kind"]), str(own.attrs["between"]), free)


def check_free(recordings: Sequence[xr.Dataset], what: str) -> None:
    """None where no recording has an input; else InputError that ``what`` is of a pendulum that swings by itself."""
    if any("input" in one for one in recordings):
        name = str(recordings[0].attrs.get("campaign", ""))
        problem = f"it is driven, and {what}"
        expected = "a pendulum that swings by itself"
        raise InputError(f"campaign {name}", problem, expected, "record a ring-down too")


def driven(recordings: Sequence[xr.Dataset]) -> Drive | None:
    """The first drive of recordings of one pendulum; None where all are free. InputError where some are, or where they differ in kind."""
    found = [drive_of(one) for one in recordings]
    effects = {one.effect if one else None for one in found}
    if len(effects) > 1:
        raise InputError(
            f"campaign {recordings[0].attrs.get('campaign', '')}", "its recordings have different drives", "one kind of input, or none",
            "make a campaign for each drive",
        )  # fmt: skip
    return found[0]


@lru_cache(maxsize=20)
def _drive(times: bytes, values: bytes, kind: str, between: str, free: tuple[str, ...]) -> Drive:
    return drive(np.frombuffer(times), np.frombuffer(values), kind, between, free)
