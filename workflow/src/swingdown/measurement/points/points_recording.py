"""Turning points as a dataset: as they were recorded, and as angles."""

from collections.abc import Mapping
from math import pi
from typing import Any

import numpy as np
import xarray as xr

from ...dataset import variable
from ...errors import as_told
from ...quantisation import quantisation_step
from ..files.source import Table
from ..sheet import Row
from ..slack import tolerances
from .turning_points import BOTH_SIDES, ONE_SIDE, Points

POINTS_ALONE = "points alone"  # the code of the refusal to search points of the motion
NOT_IN_IT = "points of the motion only: what a torque does between them is not in the data"
_CARRIED = (  # to its angles
    "recording", "campaign", "role", "file", "sha256", "source", "label", "emulated", "points", "kind", "remarks", "taken",
)  # fmt: skip
READ, COUNTED, PASSED = "turning points", "turning points without times", "passages without speeds"


def about_file(table: Table, row: Row, taken: str) -> dict[str, Any]:
    """What is to be known of a recording's file: names, source, and how it was ``taken``."""
    return {key: row[key] for key in ("recording", "campaign", "role", "file")} | {
        **({"label": row["label"]} if row.get("label") else {}),
        "source": table.about.get("source", "as recorded by its owner"),
        "emulated": "yes" if str(table.about.get("emulated", "no")).lower() in ("yes", "true", "1") else "no",
        "taken": taken,
    }


def as_recording(
    points: Points,
    unit: str,
    attrs: Mapping[str, Any],
    row: Row | None = None,
    stated_u: tuple[float, float] = (np.nan, np.nan),
) -> xr.Dataset:
    """The dataset of turning points as recorded: ``signal`` in ``unit`` over ``time``, ``half_swings``, and ``attrs`` beside what is known.

    ``row`` of the sample sheet states tolerances, ``stated_u`` are standard uncertainties of times (s) and readings, nan for none.
    """
    clock = "time as recorded" if points.timed else "number of the swing"
    return xr.Dataset(
        {
            "signal": variable("time", points.readings, "angle at a turning point, as read", unit),
            "half_swings": variable(
                "time", points.halves.astype(np.int32), "half-swings since the first turning point"
            ),
        },
        {"time": variable("time", points.times, clock, "s" if points.timed else "1")},
        {
            **attrs,
            "partial": "no",
            "expected_samples": points.times.size,
            "points": READ if points.timed else COUNTED,
            "kind": BOTH_SIDES if points.both else ONE_SIDE,
            "u_times": stated_u[0],
            "u_readings": stated_u[1],
            **({"remarks": as_told("; ".join(points.remarks))} if points.remarks else {}),
            **tolerances(row or {}, "rad"),
        },
    )


def to_angle(recording: xr.Dataset) -> xr.Dataset:
    """The angle dataset of a recording of turning points: ``angle`` (rad) over ``time``, ``half_swings``, and what is known of both.

    Readings in no unit of angles are made so small that weight pulls in proportion to them; ``points_scale`` is what 1 rad
    stands for, in ``points_unit``.
    """
    unit = recording["signal"].attrs["units"]
    readings = recording["signal"].values
    of_angles: dict[str, float] = {"rad": 1.0, "deg": 180 / pi}
    passed = recording.attrs["points"] == PASSED
    scale = of_angles[unit] if unit in of_angles else 1.0 if passed else 100 * float(np.abs(readings).max())
    step = 0.0 if passed else quantisation_step(np.abs(readings)) / scale
    timed = recording.attrs["points"] != COUNTED
    return xr.Dataset(
        {
            "angle": ("time", readings / scale, {"units": "rad", "long_name": "angle at a turning point"}),
            "half_swings": recording["half_swings"],
        },
        {"time": recording["time"]},
        {
            **{key: recording.attrs[key] for key in _CARRIED if key in recording.attrs},
            "expected_samples": readings.size,
            "clock_uncertainty": recording.attrs["clock_tolerance"] / np.sqrt(3),
            "mode": "scatter about the fit", "systematic": "not known: no calibration; set to 0",
            "u_times": recording.attrs["u_times"], "u_angles": recording.attrs["u_readings"] / scale,
            "angle_step": step, "time_step": quantisation_step(np.diff(recording["time"].values)) if timed else 0.0,
            "points_scale": scale, "points_unit": "rad" if unit in ("rad", "deg") else unit,
        },
    )  # fmt: skip


def are_points(data: xr.Dataset) -> bool:
    """True for a dataset of turning points, of a recording or of angles."""
    return "half_swings" in data
