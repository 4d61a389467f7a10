"""The period as the passages through the middle have it: of readings without a scale, and of swings that no model follows well."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr

from ..arrays import Floats
from ..errors import InputError
from ..fitting.passages import both_ways, pace
from ..measurement.angle import UNSCALED
from ..measurement.plausibility import KEPT
from ..measurement.slack import of_angles
from ..pendulum.half_swings import half_swings, passages
from ..rounding import value_with_uncertainty
from .quantities import Quantity, mixed

_STRAIGHT = 0.25  # of a half-swing about the middle: there a swing is a line to a hundredth of a half-swing
HIDES = 0.5  # of a half-swing: a hole that is longer may hide a passage
_FIRST = 8  # periods, each half a swing after the one before
_SEEN = 3.0  # standard errors of a slope
SHOWN = 0.01  # of the period: what a stop-watch shows
_LAST = 4  # of the last periods, each half a swing after the one before
_EARLY = 3  # periods, each half a swing after the one before: more may lie on a line
COURSE = "between the first and the last swing the period goes from {} to {} s"
PASSAGES = "passages"  # where a row's period comes from, if from no model
NOTE = "the period is that of its first swings, by passages of the middle, for the model lacks something"


def without_scale(angle: xr.Dataset) -> bool:
    """True for the dataset of a swing whose readings have no scale."""
    return str(angle.attrs.get("mode", "")) == UNSCALED


def counted_passages(times: Floats, series: Floats, hole: float = _STRAIGHT) -> tuple[Floats, np.ndarray]:
    """When (s) a swing passes its middle, and how many half-swings after the first passage; of a ``hole`` of more than that share of a
    half-swing, which hides when, none. What it hides is counted by the time between the others."""
    found = passages(times, series, half_swings(series).centre())
    if found.size:  # across a hole the middle is passed at no known time
        after = np.searchsorted(times, found).clip(1, times.size - 1)
        found = found[times[after] - times[after - 1] < hole * np.median(np.diff(found, prepend=times[0]))]
    gaps = np.diff(found)
    if not gaps.size:
        return found, np.zeros(0, int)
    return found, np.concatenate([[0], np.cumsum(np.round(gaps / np.median(gaps)))]).astype(int)


def pace_of(angle: xr.Dataset, times: Floats, series: Floats) -> dict[str, float]:
    """``period_first`` and ``period_change`` (s) of a swing from its passages through the middle, each with its standard uncertainty
    (``…_u``); nan for fewer than five. Passages that a hole hides are counted by the time between the others."""
    found, halves = counted_passages(times, series)
    names = ("period_first", "period_first_u", "period_change", "period_change_u")
    try:
        told = pace(both_ways(found, halves), halves, of_angles([angle]).clock)
    except InputError:
        return dict.fromkeys(names, np.nan)
    alone, u_alone, _ = _first_swing(times, series)
    if abs(alone - told.first) > 2 * np.hypot(told.u_first, u_alone):
        # a smooth course that misses the first periods is not theirs
        return dict.fromkeys(names, np.nan) | of_first_swings(times, series)
    # weighed by AIC, as the laws are: a course on which the period changes, and one on which it does not
    seen = (told.change / told.u_change) ** 2 if told.u_change > 0 else np.inf
    steady = 1 / (1 + np.exp(min(seen / 2 - 1, 700.0)))
    shares = steady, 1 - steady
    first = mixed(shares, (told.period, told.first), (told.u_period, told.u_first))
    change = mixed(shares, (0.0, told.change), (0.0, told.u_change))
    return dict(zip(names, (*first, *change), strict=True))


def of_first_swings(times: Floats, series: Floats) -> dict[str, float]:
    """``period_first`` (s) of the first whole swing, from the largest turning point on, with its standard uncertainty (``…_u``): by the first
    few periods between passages of the middle, as their mean or, where they surely change, on a line, and where that surely bends, on a
    parabola; nan for fewer than three. ``period_first_scatter`` is the part of that which their scatter has."""
    first, u_first, further = _first_swing(times, series)
    whole = float(np.hypot(u_first, further))
    return {"period_first": first, "period_first_u": whole, "period_first_scatter": u_first}


def _first_swing(times: Floats, series: Floats) -> tuple[float, float, float]:
    """The period (s) of ``of_first_swings``, its standard uncertainty by scatter, and how far it may bend further."""
    swings = half_swings(series)
    found = passages(times, series, swings.centre())
    whole = _without_hole(times, found)
    periods, since = (found[2:] - found[:-2])[whole][:_FIRST], np.flatnonzero(whole)[:_FIRST]
    if periods.size < 3:
        return np.nan, np.nan, np.nan
    away = np.abs(swings.turns[:2] - swings.centre())
    at = since + (0.5 if away[0] >= away[1] else -0.5)  # half-swings after the first whole swing
    twice = np.sqrt(2.0)  # each half-swing is in two of them
    scatter = float(np.std(periods, ddof=1) / np.sqrt(periods.size))
    told = float(periods.mean()), twice * scatter, 0.0
    for degree in (1, 2):
        if periods.size < _EARLY + degree:
            break
        course, covariance = np.polyfit(at, periods, degree, cov=True)
        errors = twice * np.sqrt(np.diag(covariance))
        if not abs(course[0]) > _SEEN * errors[0]:
            break
        # of what comes after the bend nothing is known: as much again as that does
        further = abs(float(course[-1]) - told[0]) if degree > 1 else 0.0
        told = float(course[-1]), float(errors[-1]), further
    return told


def _without_hole(times: Floats, found: Floats) -> np.ndarray:
    """Of each period between passages whether the samples show all of it."""
    if found.size < 3:
        return np.zeros(0, bool)
    holes = np.concatenate([[0], np.cumsum(np.diff(times) > HIDES * np.median(np.diff(found)))])
    after = np.searchsorted(times, found).clip(1, times.size - 1)
    return holes[after[2:]] == holes[after[:-2] - 1]


def of_last_swings(times: Floats, series: Floats) -> tuple[float, float]:
    """The mean of the last few periods (s) between passages of the middle, and its standard uncertainty; nan for fewer than three."""
    found = passages(times, series, half_swings(series).centre())
    periods = (found[2:] - found[:-2])[_without_hole(times, found)][-_LAST:]
    if periods.size < _LAST:
        return float("nan"), float("nan")
    return float(periods.mean()), float(np.std(periods, ddof=1) / np.sqrt(periods.size / 2))


def at_first_swing(own: xr.Dataset) -> tuple[Quantity | None, dict[str, Any]]:
    """The period of the first swing, and the cells of a row of ``studies.pendulums`` that say so: ``amplitude_text``, ``note``, ``period_of`` and
    ``last_period_s``.

    ``own`` is the recording's part of the norms. None and no cells where too few passages tell it.
    """
    first, u_first, change, u_change = (
        float(np.atleast_1d(own[name].values)[0]) if name in own else np.nan
        for name in ("period_first", "period_first_u", "period_change", "period_change_u")
    )
    if not np.isfinite([first, change]).all():
        return None, {}
    last = value_with_uncertainty(first + change, float(np.hypot(u_first, u_change)))
    note = COURSE.format(value_with_uncertainty(first, u_first), last)
    if own.attrs.get("restoring") != "linear":
        note += "; the period of small swings needs the scale"
    cells = {"period_of": PASSAGES, "last_period_s": first + change}
    return Quantity(first, u_first, "s"), {"amplitude_text": "the first swing", "note": note, **cells}


def as_seen(own: xr.Dataset) -> tuple[Quantity | None, dict[str, Any]]:
    """The period of the first swings of what a model of damping follows badly, and the cells that say so; None where too few passages tell it.

    A model that lacks something may have another period than the swing, and its uncertainty knows nothing of that.
    """
    if "period_first" not in own or not np.isfinite(own["period_first"].values).all():
        return None, {}
    first, u_first = (float(np.atleast_1d(own[key].values)[0]) for key in ("period_first", "period_first_u"))
    return Quantity(first, u_first, "s"), {"note": NOTE, "period_of": PASSAGES}


def meets(own: xr.Dataset, period: Quantity | None, left: float) -> bool:
    """False where the ``period`` of a model is surely another than that of the first swings by passages of the middle, as a stop-watch shows.

    ``own`` is the recording's part of the norms, ``left`` the share of the swing that the model does not follow. Of swings that grow the first
    ones need not be the widest. Of what dies away a model that is off by so much in its first swings alone would leave more: of wide swings,
    whose period falls steeply, passages tell less than it.
    """
    seen, _ = as_seen(own.isel(recording=0))
    if period is None or seen is None or not (own["narrowing"] < 1 / KEPT).any():
        return True
    scatter = float(own["period_first_scatter"].max()) if "period_first_scatter" in own else seen.uncertainty
    off = abs(period.value - seen.value)
    swings = float(own["record_s"].max()) / seen.value if "record_s" in own else 1.0
    would_leave = 2 * np.pi * off / seen.value / np.sqrt(max(swings, 1.0))
    far = off > max(_SEEN * float(np.hypot(period.uncertainty, scatter)), SHOWN * seen.value)
    return not far or (bool((own["narrowing"] < KEPT).any()) and would_leave > _SEEN * left)


def course_seen(row: Mapping[str, Any]) -> bool:
    """True for a row of ``studies.pendulums`` that tells by passages of the middle, and by no model, how its period goes."""
    return row.get("period_of") == PASSAGES or bool(np.isfinite(row.get("last_period_s", np.nan)))
