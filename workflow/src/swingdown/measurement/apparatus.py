"""The apparatus sheet: the lengths, tower points and encoder limits that a calibration rests on, checked."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Floats
from ..errors import InputError
from ..paths import find, is_url
from ..schema import check, read_yaml
from .straight_line import FEWEST
from .uncertainty import Input, from_limit

# a sheet as ``apparatus.schema.yaml`` lets it through, with its ``path``; lengths in m, voltages in V
Apparatus = dict[str, Any]

_SHARED = ("over_shaft", "shaft_diameter", "bob_diameter", "arm")


def read_apparatus(path: str | Path, check_files: bool = True) -> Apparatus:
    """The content of an apparatus sheet, defaults filled in.

    Parameters
    ----------
    path
        The sheet (YAML).
    check_files
        Whether the records of the points must be there.

    Raises
    ------
    InputError
        With file and key: an unknown key, a limit that is not above 0, fewer than three points, a missing record, or a height
        at which the bob cannot rest.
    """
    found = find(path)
    if not found.is_file():
        problem = "there is no such apparatus sheet"
        raise InputError(path, problem, "a YAML file", "correct the key `apparatus` of the config")
    apparatus: Apparatus = check(read_yaml(found, path), "apparatus.schema.yaml", path) | {"path": str(path)}
    points = apparatus["points"]
    if len(points) < FEWEST:
        problem = f"{len(points)} calibration point(s)"
        raise InputError(f"{path}, key points", problem, f"at least {FEWEST}", "record more tower heights")
    for number, point in enumerate(points, 1):
        _check_height(apparatus, point["height"], f"{path}, key points[{number}].height")
        if check_files and not is_url(point["file"]) and not find(point["file"]).is_file():
            problem = f"there is no file {point['file']}"
            expected = "a path relative to the working directory, an absolute path or a URL"
            raise InputError(f"{path}, key points[{number}].file", problem, expected, "correct the path")
    for place, size, limit, unit in _limits(apparatus):
        wanted, why = f"a limit of error in {unit}", ""
        if limit > size:
            wanted, why = f"{wanted}, far below {size:g} {unit}", "larger than the readings themselves"
        elif not limit >= np.finfo(float).eps * size:
            why = f"less than the last digit of {size:g} {unit}"
        if why:
            told = f"a limit of error of {limit:g} {unit}, {why}"
            raise InputError(f"{path}, key {place}", told, wanted, "correct the limit")
    bounds = [entry["up_to"] for entry in apparatus["encoder"]["limits"]]
    if bounds != sorted(set(bounds)):
        problem = "up_to does not rise"
        raise InputError(f"{path}, key encoder.limits", problem, "limits in rising order", "sort them")
    return apparatus


def _limits(apparatus: Apparatus) -> Iterator[tuple[str, float, float, str]]:
    """The key of each limit of error, what is read there at most, the limit, and the unit of both."""
    for name, length in apparatus["lengths"].items():
        yield f"lengths.{name}", length["value"], length["limit"], "m"
    for number, point in enumerate(apparatus["points"], 1):
        yield f"points[{number}]", point["height"], point["limit"], "m"
    for entry in apparatus["encoder"]["limits"]:
        yield "encoder.limits", entry["up_to"], entry["limit"], "V"


def _check_height(apparatus: Apparatus, height: float, place: str) -> None:
    size = {name: entry["value"] for name, entry in apparatus["lengths"].items()}
    below = size["over_shaft"] - size["shaft_diameter"] / 2 - height - size["bob_diameter"] / 2
    lowest = size["over_shaft"] - (size["shaft_diameter"] + size["bob_diameter"]) / 2 - size["arm"]
    if 0 < below < size["arm"]:
        return
    raise InputError(
        place,
        f"the tower is above the arm: at {height:g} m the bob's centre is {-below:.4g} m above the shaft's"
        if below <= 0
        else f"the arm of {size['arm']:g} m does not reach: at {height:g} m the bob's centre would be {below:.6g} m below the shaft's",
        f"a height between {lowest:.5g} and {lowest + size['arm']:.5g} m",
        "correct the height (in m) or the lengths",
    )


def length_inputs(apparatus: Apparatus) -> tuple[list[Input], list[Input]]:
    """The shared lengths (over_shaft, shaft_diameter, bob_diameter, arm) as Inputs, and the heights' (lists; m)."""
    shared = [
        _length(name, apparatus["lengths"][name], apparatus["lengths"][name]["value"]) for name in _SHARED
    ]
    heights = [_length(f"height_{k}", p, p["height"]) for k, p in enumerate(apparatus["points"], 1)]
    return shared, heights


def _length(name: str, entry: dict[str, Any], value: float) -> Input:
    return from_limit(name, value, entry["limit"], entry.get("distribution", "uniform"), unit="m")


def encoder_limit(apparatus: Apparatus, voltage: ArrayLike, place: str = "voltage") -> Floats:
    """The manual's error limit (V) at each voltage (V); InputError for one beyond the encoder's range."""
    known = apparatus["encoder"]["limits"]
    up_to, limits = ([entry[key] for entry in known] for key in ("up_to", "limit"))
    return limit_at(voltage, up_to, limits, f"{apparatus['path']}, key encoder.limits", place)


def limit_at(
    voltage: ArrayLike,
    up_to: Sequence[float] | Floats,
    limits: Sequence[float] | Floats,
    source: str,
    place: str,
) -> Floats:
    """The error limit (V) at each voltage (V), of the ``limits`` that hold ``up_to`` rising voltages; InputError beyond the last.

    ``source`` is where they stand, ``place`` what an error names as its place.
    """
    size = np.abs(np.asarray(voltage, dtype=float))
    if np.any(size > up_to[-1]):
        problem = f"{float(size.max()):.5g} V is beyond the encoder's range"
        expected = f"at most {up_to[-1]:g} V ({source})"
        raise InputError(place, problem, expected, "correct the signal's unit or the apparatus sheet")
    return np.asarray(limits, dtype=float)[np.searchsorted(up_to, size)]
