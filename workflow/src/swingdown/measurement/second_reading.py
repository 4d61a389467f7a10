"""A swing that no model follows to its end, read once more: its longest free stretch, or its period and decay alone."""

from collections.abc import Iterator
from typing import Any

import numpy as np
import xarray as xr

from ..dataset import quiet_of, series_of
from ..pendulum.half_swings import half_swings
from .angle import UNSCALED
from .apparent_scale import apparent_scale
from .driven import drive_of
from .plausibility import free_part, in_step_and_dying
from .points.points_recording import are_points
from .sheet import Row
from .signal import RELATIVE as RELATIVE_CELL

OPEN, TOLD = "read_again", "again"  # attributes: whether a recording may be read once more, and what was done
_CELLS = {"again_start_s": "start_s", "again_stop_s": "stop_s", "again_scale": "scale"}
_PARTS = ("", "_standard_uncertainty", "_random_uncertainty", "_bound")
ALONE = "PERIOD AND DECAY ALONE ARE REPORTED, by its passages of the middle, which need no model and no unit"


def may_be_read_again(row: Row, guessed: bool) -> bool:
    """True where the sheet's ``row`` states neither window, scale nor unit, which nothing overrules, and its column was not ``guessed``."""
    stated = (row.get(key) for key in ("start_s", "stop_s", "scale", "signal_unit", "input_column"))
    return not guessed and all(cell is None or cell == "" or cell != cell for cell in stated)


def may_be_read_once_more(angle: xr.Dataset) -> bool:
    """True for a dataset of angles of a free swing with samples of its own, of which nothing was stated that a second reading overrules."""
    return angle.attrs.get(OPEN) == "yes" and not are_points(angle) and drive_of(angle) is None


def readings(angle: xr.Dataset, in_rad: bool = False) -> Iterator[xr.Dataset]:
    """The datasets of angles with which a recording is read once more, the first one that is a free swing being its own.

    First the longest stretch whose half-swings are in step and do not grow. Then, unless ``in_rad``, swings without a scale: passages of the
    middle tell period and decay whatever the model and the unit. Both only where these passages are even and the swings die. What is to be said
    of it is the attribute ``again``, and the cells of the sheet that read it so are those of ``cells``. None of what has no samples of
    its own, is driven, or was stated.
    """
    if not may_be_read_once_more(angle):
        return
    used, told = angle, ""
    if part := free_part(angle["time"].values, quiet_of(angle)):
        first, last = (round(at, 6) for at in part)
        times = angle["time"].values
        told = f"USED FROM {first:.3f} TO {last:.3f} s ALONE: beside that its swings are out of step or grow"
        used = angle.isel(time=(times >= first) & (times <= last))
        used = used.assign_attrs({OPEN: "no", TOLD: told, "again_start_s": first, "again_stop_s": last})
    # what a motor drives does not die: its period would be told
    if not in_step_and_dying(used["time"].values, quiet_of(used)):
        return
    if used is not angle:
        yield used
    if not in_rad:
        told = "; ".join(filter(None, (told, ALONE)))
        yield without_unit(used).assign_attrs({OPEN: "no", TOLD: told, "again_scale": RELATIVE_CELL})


def cells(angle: xr.Dataset) -> dict[str, Any]:
    """The cells of the sample sheet that read a recording as this dataset of its angles does; none where it was not read once more."""
    return {cell: angle.attrs[key] for key, cell in _CELLS.items() if key in angle.attrs}


def without_unit(angle: xr.Dataset) -> xr.Dataset:
    """The dataset of a swing whose values are readings without a scale: so small that sine and angle are one, about its middle."""
    if angle.attrs.get("mode") == UNSCALED:
        return angle
    series = series_of(angle)
    scale = apparent_scale(angle["time"].values, series.values)
    centre = half_swings(series.values).centre()
    middle = centre if np.isfinite(centre) else 0.0
    made = angle.drop_dims([dim for dim in ("nuisance", "source") if dim in angle.dims])
    name = str(series.name)
    made = made.drop_vars(f"{name}_systematic_uncertainty", errors="ignore")
    for part in _PARTS:
        if (old := name + part) in made:
            values = scale * (made[old].values - (0.0 if part else middle))
            about = {**made[old].attrs, "units": "rad"}
            made = made.drop_vars(old).assign({"angle" + part: ("time", values, about)})
    if "angle_random_uncertainty" in made:
        made["angle_standard_uncertainty"] = made["angle_random_uncertainty"]
    return made.assign_attrs(mode=UNSCALED, unit_told="yes")
