"""What a recording's calibration, and the tolerances in its row of the sheet, leave open of its reading and its clock."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import sqrt
from typing import Any

import numpy as np
import xarray as xr

from ..errors import InputError
from ..pendulum.slack import Slack, reading_slack
from .gyroscope import GAIN_TOLERANCE, TO_RAD_PER_S, ZERO_TOLERANCE
from .plausibility import CENTRED
from .sheet import Row

CLOCK_TOLERANCE = 5e-5
"""The share by which a recorder's seconds may be wrong where the sheet says nothing: that of a quartz. A board with a ceramic
resonator has a hundred times as much."""
_OF_ANGLES = {"gain_tolerance": 0.0, "zero_tolerance_rad": 0.0, "clock_tolerance": CLOCK_TOLERANCE}
_OF_RATES = {
    "gain_tolerance": GAIN_TOLERANCE, "zero_tolerance_rad_per_s": ZERO_TOLERANCE, "clock_tolerance": CLOCK_TOLERANCE,
}  # fmt: skip


def tolerances(row: Row, unit: str, upright: bool = True) -> dict[str, float]:
    """The limits of error in a row of the sample sheet, by key, with the usual ones where it has none.

    An angle sensor's gain and zero are taken for right where nothing is said; those of a gyroscope never are.

    Parameters
    ----------
    row
        Of the sample sheet.
    unit
        Of the signal.
    upright
        False where nobody knows which way is down, as of a camera's picture: the zero is then open.
    """
    usual = _OF_RATES if unit in TO_RAD_PER_S else _OF_ANGLES
    stated = {key: float(row.get(key, float("nan"))) for key in usual}
    known = {key: value if (value := stated[key]) == value else usual[key] for key in usual}
    if upright or unit in TO_RAD_PER_S:
        return known
    return known | {"zero_tolerance_rad": max(known["zero_tolerance_rad"], CENTRED)}


def zero_unstated(row: Row, unit: str) -> dict[str, float]:
    """The cell of the sheet that leaves the zero of an angle open, where a ``row`` does not state how far it may be off: no file says where
    its pendulum hangs. Of a rate none. InputError for a limit that is none."""
    stated = float(row.get("zero_tolerance_rad", float("nan")))
    if stated == stated and not 0 <= stated <= 1:
        raise InputError("zero_tolerance_rad", f"it is {stated:g} rad", "a limit from 0 to 1 rad", "leave it out: the swings tell their zero")  # fmt: skip
    return {} if unit in TO_RAD_PER_S or stated == stated else {"zero_tolerance_rad": CENTRED}


def zero_is_fitted(recording: xr.Dataset) -> bool:
    """True of angles whose zero is open as far as that of one whose zero nobody states (``zero_unstated``): the swings tell it."""
    return float(recording.attrs.get("zero_tolerance_rad", 0.0)) >= CENTRED


def with_rate(known: Mapping[str, float], rate: float) -> dict[str, float]:
    """The tolerances with the clock's widened by the standard uncertainty of its ``rate`` (a share) that the stamps leave."""
    if not rate:
        return dict(known)
    wider = float(np.hypot(known["clock_tolerance"], sqrt(3) * rate))
    return {**known, "clock_tolerance": wider, "clock_rate": rate}


def of_tolerances(recording: xr.Dataset) -> Slack:
    """The ``Slack`` that a recording's own tolerances leave: limits, taken for those of uniform distributions."""
    known = tolerances(recording.attrs, str(recording["signal"].attrs["units"]))
    zero = known.get("zero_tolerance_rad_per_s", known.get("zero_tolerance_rad", 0.0))
    values = {
        "sensor_gain": {"gain_tolerance": known["gain_tolerance"] / sqrt(3)},
        "sensor_zero": {"zero_tolerance": zero / sqrt(3)},
    }
    clock = known["clock_tolerance"] / sqrt(3)
    rate = float(recording.attrs.get("clock_rate", 0.0))  # of scattered stamps: nothing limits it
    limited = sqrt(max(0.0, 1 - (rate / clock) ** 2)) if rate else 1.0
    return replace(reading_slack(values, clock), limited=limited)


def of_calibration(calibration: xr.Dataset, stated: Slack) -> Slack:
    """The ``Slack`` of readings in volts: what each source does to slope and rest voltage, the encoder's curvature, and what is
    ``stated`` beside it.

    The reading m (V - V0) of an angle theta is (m / m_true) theta + m (V0_true - V0): an error of the slope is a gain, one of
    the rest voltage a zero, of opposite signs. An encoder whose errors are systematic may be bent as far as its limit at the
    end of its range. First order, JCGM 100.
    """
    line = calibration.sel(mode="gum")
    slope, zero = float(line["line"].sel(coefficient="slope")), float(line["rest_voltage"])
    sources = [str(name) for name in calibration["source"].values]
    by_slope, by_zero = calibration["contribution"].sel(quantity=["slope", "rest_voltage"]).values
    values = {
        "sensor_gain": dict(zip(sources, map(float, -by_slope / slope), strict=True)),
        "sensor_zero": dict(zip(sources, map(float, slope * by_zero), strict=True)),
    }
    if calibration.attrs["encoder_kind"] == "systematic":
        top, limit = float(calibration["encoder_up_to"][-1]), float(calibration["encoder_limit"][-1])
        farthest = abs(slope) * abs(top - zero)
        values["sensor_curvature"] = {"encoder_curvature": abs(slope) * limit / sqrt(3) / farthest**2}
    for name, row in zip(stated.names, stated.contributions, strict=True):
        values[name] = {**values.get(name, {}), **dict(zip(stated.sources, map(float, row), strict=True))}
    return replace(reading_slack(values, stated.clock), limited=stated.limited)


def as_variables(slack: Slack) -> tuple[dict[str, Any], dict[str, Any]]:
    """The variables and the coordinates that keep a slack in a dataset of angles; none where nothing is open."""
    if not slack.names:
        return {}, {}
    attrs = {
        "units": "1",
        "comment": "numbers of 1 for the gain, of rad (a rate's: rad/s) for the zero, of rad-1 for the curvature",
        "long_name": "what a standard uncertainty of a source does to the reading",
    }
    names = {"long_name": "what the measurement leaves open of the reading"}
    return {"reading_slack": (("nuisance", "source"), slack.contributions, attrs)}, {
        "nuisance": ("nuisance", list(slack.names), names),
        "source": ("source", list(slack.sources), {"long_name": "source of uncertainty"}),
    }


def of_angles(angles: Sequence[xr.Dataset]) -> Slack:
    """The ``Slack`` that the swings of one campaign share: where they state different ones, the widest, and the worst clock."""
    found = [_read(angle) for angle in angles]
    worst = max(found, key=lambda one: one.clock, default=Slack())
    widest = max(found, key=lambda one: (len(one.names), *one.deviations.values()), default=Slack())
    return replace(widest, clock=worst.clock, limited=worst.limited)


def _read(angle: xr.Dataset) -> Slack:
    clock = float(angle.attrs.get("clock_uncertainty", 0.0))
    limited = float(angle.attrs.get("clock_limited", 1.0))
    if "reading_slack" not in angle:
        return Slack(clock=clock, limited=limited)
    table = angle["reading_slack"]
    names, sources = (tuple(map(str, table[dim].values)) for dim in ("nuisance", "source"))
    return Slack(names, sources, table.values, clock, limited)
