"""The apparatus sheet: the lengths, tower points and encoder limits that a calibration rests on, checked."""

import numpy as np
import yaml

from ..errors import InputError
from ..paths import find, is_url
from ..schema import check
from .line import FEWEST
from .uncertainty import from_limit

_SHARED = ("over_shaft", "shaft_diameter", "bob_diameter", "arm")


def read_apparatus(path, check_files=True):
    """The sheet as nested dicts, defaults filled in: campaigns, lengths (m), points, encoder (V), rest (rad).

    InputError with file and key for an unknown key, a limit that is not above 0, fewer than three points, a
    point whose record is not there (unless ``check_files`` is False), and a height at which the bob cannot
    rest: with the bob's centre above the shaft, or further below it than the arm is long.
    """
    found = find(path)
    if not found.is_file():
        raise InputError(
            path,
            "there is no such apparatus sheet",
            "a YAML file",
            "correct the key `apparatus` of the config",
        )
    try:
        content = yaml.safe_load(found.read_text(encoding="utf-8"))
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        raise InputError(path, f"it is not YAML ({error})", "keys and values", "correct the file") from error
    apparatus = check(content, "apparatus.schema.yaml", path)
    points = apparatus["points"]
    if len(points) < FEWEST:
        raise InputError(
            f"{path}, key points",
            f"{len(points)} calibration point(s)",
            f"at least {FEWEST}",
            "record more tower heights",
        )
    for number, point in enumerate(points, 1):
        _check_height(apparatus, point["height"], f"{path}, key points[{number}].height")
        if check_files and not is_url(point["file"]) and not find(point["file"]).is_file():
            raise InputError(
                f"{path}, key points[{number}].file",
                f"there is no file {point['file']}",
                "a path relative to the working directory, an absolute path or a URL",
                "correct the path",
            )
    bounds = [entry["up_to"] for entry in apparatus["encoder"]["limits"]]
    if bounds != sorted(set(bounds)):
        raise InputError(
            f"{path}, key encoder.limits", "up_to does not rise", "limits in rising order", "sort them"
        )
    apparatus["path"] = str(path)
    return apparatus


def _check_height(apparatus, height, place):
    size = {name: entry["value"] for name, entry in apparatus["lengths"].items()}
    below = size["over_shaft"] - size["shaft_diameter"] / 2 - height - size["bob_diameter"] / 2
    lowest = size["over_shaft"] - (size["shaft_diameter"] + size["bob_diameter"]) / 2 - size["arm"]
    if below <= 0:
        raise InputError(
            place,
            f"the tower is above the arm: at {height:g} m the bob's centre is {-below:.4g} m above the shaft's",
            f"a height between {lowest:.5g} and {lowest + size['arm']:.5g} m",
            "correct the height (in m) or the lengths",
        )
    if below >= size["arm"]:
        raise InputError(
            place,
            f"the arm of {size['arm']:g} m does not reach: at {height:g} m the bob's centre would be {below:.6g} m below "
            "the shaft's",
            f"a height between {lowest:.5g} and {lowest + size['arm']:.5g} m",
            "correct the height (in m) or the lengths",
        )


def length_inputs(apparatus):
    """The shared lengths (over_shaft, shaft_diameter, bob_diameter, arm) as Inputs, and the heights' (lists;
    m).
    """
    shared = [
        _length(name, apparatus["lengths"][name], apparatus["lengths"][name]["value"]) for name in _SHARED
    ]
    heights = [_length(f"height_{k}", p, p["height"]) for k, p in enumerate(apparatus["points"], 1)]
    return shared, heights


def _length(name, entry, value):
    return from_limit(name, value, entry["limit"], entry.get("distribution", "uniform"), unit="m")


def encoder_limit(apparatus, voltage, place="voltage"):
    """The manual's error limit (V) at each voltage (V); InputError for one beyond the encoder's range."""
    limits = apparatus["encoder"]["limits"]
    size = np.abs(np.asarray(voltage, dtype=float))
    if np.any(size > limits[-1]["up_to"]):
        raise InputError(
            place,
            f"{float(size.max()):.5g} V is beyond the encoder's range",
            f"at most {limits[-1]['up_to']:g} V ({apparatus['path']}, key encoder.limits)",
            "correct the signal's unit or the apparatus sheet",
        )
    index = np.searchsorted([entry["up_to"] for entry in limits], size)
    return np.array([entry["limit"] for entry in limits])[index]
