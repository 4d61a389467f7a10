"""The first picture of one's own recordings: each with its fit, and below it what the fit leaves."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from ..arrays import Floats, Shown, extremes
from ..dataset import series_of
from ..own_unit import axis
from ..own_unit import shown as told_in
from . import style

FITTED, HELD, DATA = "#0072B2", "#009E73", style.GREY
_RECORDINGS = 3  # side by side; more would be too narrow to read
# columns of a panel: more samples than twice that are drawn as their least and greatest in each
_PIXELS = 900


@style.styled
def swings_with_fit(
    shown: Sequence[Shown], noise: float | None, data: xr.Dataset | Mapping[str, Any], told: str = ""
) -> style.Drawn:
    """A figure of angle and fit over time, and below them the residual with the noise; a column each recording.

    Those ``shown`` of one recording come in the order of their times; of more than three recordings those with the largest, the middle and the
    smallest angle are drawn. ``noise`` is in rad (None: not measured), ``emulated`` of ``data`` says whether the recordings are, and
    ``told`` stands above, such as period and quality.
    """
    parts = Shown.by_recording(shown)
    order = sorted(parts, key=lambda name: -max(float(np.ptp(one.angle)) for one in parts[name]))
    chosen = order if len(order) <= _RECORDINGS else [order[0], order[len(order) // 2], order[-1]]
    figure = style.new_figure(9.0)
    grid = figure.subplots(2, len(chosen), sharex="col", sharey="row", squeeze=False, height_ratios=[3, 2])
    for (upper, lower), name in zip(grid.T, chosen, strict=True):
        _recording(upper, lower, parts[name], noise)
        if len(parts) > 1:
            upper.set_title(name)
        lower.set_xlabel("time (s)" if len(chosen) > 1 else style.TIME)
    grid[0, 0].set_ylabel(axis(shown[0].unit))
    grid[1, 0].set_ylabel(f"data − fit ({told_in(0.0, shown[0].unit)[1]})")
    handles = [style.mark(".", DATA, "measured"), *style.handles_of(figure)]
    heading: dict[str, Any] = {"title": told or None, "title_fontsize": 12, "alignment": "left"}
    figure.legend(handles=handles, loc="outside upper left", ncols=4, **heading)
    left = ""
    if len(chosen) < len(parts):
        left = f"{len(chosen)} of {len(parts)} recordings: largest, middle and smallest angle"
    return style.footnote(figure, left, style.emulated_note(data))


@style.styled
def swings_alone(shown: Sequence[Shown], data: xr.Dataset | Mapping[str, Any]) -> style.Drawn:
    """The swings over time, one below the other; arguments as of ``swings_with_fit``."""
    figure = style.new_figure(1.0 + 5.0 * len(shown))
    grid = figure.subplots(len(shown), 1, squeeze=False)[:, 0]
    for axes, one in zip(grid, shown, strict=True):
        style.dots(axes, *thinned(one.times, told_in(one.angle, one.unit)[0]), 2.6, DATA, rasterized=True)
        axes.set_ylabel(axis(one.unit))
        axes.grid(True, axis="y")
        if len(shown) > 1:
            axes.set_title(one.recording)
    grid[-1].set_xlabel("time (s)")
    return style.footnote(figure, style.emulated_note(data))


def _recording(upper: Axes, lower: Axes, parts: Sequence[Shown], noise: float | None) -> None:
    begin = float(parts[0].times[0])
    for one in parts:
        time, colour, what = one.times - begin, FITTED, "fit"
        if one.held_out:
            colour, what = HELD, "model, on a part held out of the fit"
        angle, fit = (told_in(each, one.unit)[0] for each in (one.angle, one.fit))
        left = angle - fit
        style.dots(upper, *thinned(time, angle), 2.6, DATA, rasterized=True)
        upper.plot(*thinned(time, fit), lw=0.7, color=colour, label=what)
        lower.plot(*thinned(time, left), lw=0.6, color=colour)
    if noise:
        style.noise_band(lower, float(told_in(noise, parts[0].unit)[0]))
    style.symmetric(lower, np.concatenate([told_in(one.angle - one.fit, one.unit)[0] for one in parts]))
    lower.set_xlim(0, float(parts[-1].times[-1]) - begin)
    for axes in (upper, lower):
        axes.grid(True, axis="y")


def shown_in(data: xr.Dataset) -> list[Shown]:
    """The swings of a round's fit dataset (``angle``, ``fit``, ``time``, ``swing`` over sample; ``name``, ``held_out`` over swings)."""
    found, read = [], series_of(data)
    for k, (name, held) in enumerate(zip(data["name"].values, data["held_out"].values, strict=True)):
        rows = data["swing"].values == k
        times, angle, fit = (one.values[rows] for one in (data["time"], read, data["fit"]))
        found.append(Shown(*Shown.named(str(name)), times, angle, fit, bool(held), str(read.attrs["units"])))
    return sorted(found, key=lambda one: (one.recording, float(one.times[0])))


def thinned(time: Floats, values: Floats) -> tuple[Floats, Floats]:
    """Times and values that look the same in a picture of ``_PIXELS`` columns: of each column the least and the greatest value."""
    if time.size <= 2 * _PIXELS:
        return time, values
    kept = extremes(values, _PIXELS)
    return time[kept], values[kept]
