"""The picture of what a model still lacks: a torque over angle and speed together, and when it acts."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..arrays import Floats
from ..own_unit import axis, small, speed
from ..own_unit import shown as shown_in
from . import style

_KNOWN = 0.3  # of a torque on the map must be determined by the data for it to be drawn
_PLAIN = 2.0  # standard errors from nothing
_LITTLE = 0.01  # of the largest kind: a smaller one is nothing beside it
_WORDS = {"time": "time-dependent"}
_COLOURS = "RdBu_r"


@style.styled
def remainder(
    table: pd.DataFrame, course: pd.DataFrame, told: Mapping[str, Any], unit: str = "rad"
) -> Figure:
    """The missing torque over angle and speed, how large each kind of it is, and its course in the swing that has most of it.

    ``table`` (``angle_rad``, ``speed_rad_per_s``, ``torque``, ``band``, ``known``, ``seen``) and ``course`` (``swing``, ``time_s``,
    ``torque``, ``band``) are those of a round, ``told`` its entry in ``rounds.json``, ``unit`` that of the angle. Where there is none the picture says so.
    """
    if table.empty:
        return style.absent("no torque is left to draw")
    figure = style.new_figure(12.0)
    halves: Any = figure.subfigures(2, 1, height_ratios=(1.25, 1))
    upper, lower = halves
    left, right = upper.subplots(1, 2, width_ratios=(1.6, 1))
    drawn = _map(left, table, unit)
    upper.colorbar(drawn, ax=left, label=f"missing torque ({unit}/s²)", pad=0.02)
    _sizes(right, told["lacks"], unit + "/s" * (told.get("reading") == "rate"))
    _course(lower.subplots(), course, unit)
    blank = "blank: not determined; small points: less than two standard errors"
    torque = "torque over inertia; what the model's own values imitate is open"
    return style.footnote(figure, f"campaign {told['campaign']}", blank, torque)


def _map(axes: Axes, table: pd.DataFrame, unit: str) -> Any:
    """Torque over angle and speed, blank where the data do not determine it; for either direction of motion its own."""
    shown = table["torque"].where((table["known"] > _KNOWN) & (table["seen"] > 0))
    largest = float(np.nanmax(np.abs(shown))) if shown.notna().any() else 1.0
    drawn = None
    for forward in (True, False):
        side = np.signbit(table["speed_rad_per_s"]) != forward
        one = table.assign(shown=shown)[side]
        grid = one.pivot_table("shown", "speed_rad_per_s", "angle_rad", dropna=False)
        drawn = axes.pcolormesh(
            shown_in(grid.columns, unit)[0], grid.index, np.ma.masked_invalid(grid.to_numpy()), cmap=_COLOURS,
            vmin=-largest, vmax=largest, shading="gouraud" if grid.notna().all(axis=None) else "nearest", rasterized=True,
        )  # fmt: skip
    weak = shown.notna() & (table["torque"].abs() < _PLAIN * table["band"])
    angle, fast = shown_in(table["angle_rad"][weak], unit)[0], table["speed_rad_per_s"][weak]
    axes.plot(angle, fast, ".", color=style.GREY, ms=2)
    axes.axhline(0, color=style.INK, lw=0.6)
    axes.set(xlabel=axis(unit), ylabel=speed(unit), title="where it acts")
    return drawn


def _sizes(axes: Axes, sizes: Mapping[str, float], unit: str) -> None:
    """How large what is missing is in the readings, by its kind."""
    names = list(sizes)[::-1]
    values = [sizes[name] for name in names]
    most = max(values) or 1.0
    axes.barh(range(len(names)), values, color=style.FAINT, height=0.6)
    for k, value in enumerate(values):
        told = small(value if value > _LITTLE * most else 0.0, unit, "{:.2g}".format)
        axes.annotate(told, (value, k), (4, 0), textcoords="offset points", va="center", fontsize=9)
    axes.set(xlim=(0, 1.6 * most), xticks=(), xlabel="RMS of the readings", title="how much")
    axes.set_yticks(range(len(names)), [_WORDS.get(name, name) for name in names])


def _course(axes: Axes, course: pd.DataFrame, unit: str) -> None:
    """The torque over time of the swing in which it is largest, with what is plainly not nothing marked."""
    size = (course["torque"] ** 2).groupby(course["swing"]).mean()
    one = course[course["swing"] == size.idxmax()]
    time, torque, band = (one[name].to_numpy() for name in ("time_s", "torque", "band"))
    time = time - time[0]
    low, high = torque - 2 * band, torque + 2 * band
    axes.fill_between(time, low, high, color=style.FAINT, lw=0, label="± 2 standard errors")
    axes.plot(time, torque, color="#0072B2", lw=0.8, label="missing torque")
    _marked(axes, time, np.abs(torque) > _PLAIN * band)
    axes.axhline(0, color=style.GREY, lw=0.6)
    title = f"when it acts: {one['swing'].iloc[0]}"
    axes.set(xlabel=style.TIME, ylabel=f"({unit}/s²)", title=title, xlim=(time[0], time[-1]))
    axes.margins(y=0.2)
    axes.legend(loc="upper left", ncols=3)


def _marked(axes: Axes, time: Floats, plain: Floats) -> None:
    """Ticks along the lower edge at the times of a torque that is plainly not nothing."""
    axes.plot(
        time[plain], np.full(np.count_nonzero(plain), 0.03), "|", color="#D55E00", ms=5, mew=0.6,
        transform=axes.get_xaxis_transform(), label="plainly not nothing",
    )  # fmt: skip
