"""Figures 8 and 9: from volts to degrees, and how far that can be trusted."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from numpy.typing import ArrayLike

from ..arrays import Bools, Floats
from . import style

LINE, EXTREME, FLAG = style.COLOURS["viscous"], style.COLOURS["load_coulomb"], style.COLOURS["quadratic_drag"]


@style.styled
def fig08(calibration: xr.Dataset) -> Figure:
    """The calibration line, the lowest point enlarged, and what is left beside the line (the paper's Figure 8).

    ``calibration`` is the calibration dataset; of its modes of uncertainty the one that its attribute ``mode`` names is drawn,
    else the first. Boxes reach one standard uncertainty to each side of a point (in mode
    ``paper`` one limit of error); a point that was left out of the line has none.
    """
    mode = calibration.attrs.get("mode", str(calibration["mode"].values[0]))
    data = calibration.sel(mode=mode)
    voltage, angle = data["voltage"].values, style.degrees(data["angle"])
    boxes = data["voltage_uncertainty"].values, style.degrees(data["angle_uncertainty"])
    flagged = data["flagged"].values.astype(bool)
    best = data["line"].values
    extreme = data["deviation_line"].sel(kind="extreme").transpose("side", "coefficient").values

    figure = style.new_figure(11)
    grid = figure.add_gridspec(2, 2, width_ratios=(1.5, 1), height_ratios=(2.1, 1))
    whole, rest, zoom = (figure.add_subplot(place) for place in (grid[0, 0], grid[1, 0], grid[:, 1]))
    boxed = "limit of error" if mode == "paper" else "standard uncertainty"
    reach = 0.06 * np.ptp(voltage)
    volts = np.array([voltage.min() - reach, voltage.max() + reach])
    lowest = int(np.nanargmin(np.where(np.isfinite(boxes[0] + boxes[1]), angle, np.nan)))
    near = voltage[lowest] + 2.4 * boxes[0][lowest] * np.array([-1, 1])
    for axes, span, about in ((whole, volts, 0), (zoom, near, 0), (rest, volts, best)):
        _lines(axes, span, best, extreme, about)
        _points(axes, voltage, angle - (_at(best, voltage) if axes is rest else 0), boxes, flagged)
        axes.set_xlim(*span)
        axes.grid(True)
    middle = angle[lowest]
    high = max(2.4 * boxes[1][lowest], 1.15 * np.abs(_at(best, near) - middle).max())
    zoom.set(xlabel="encoder voltage $V$ (V)", title="(c) the lowest point, enlarged")
    zoom.set_ylim(middle - high, middle + high)
    whole.set(ylabel=r"angle $\theta$ (°)", title="(a) calibration line")
    whole.tick_params(labelbottom=False)
    rest.set(xlabel="encoder voltage $V$ (V)", ylabel="point − line (°)", title="(b) beside the line")
    lines = [_at(line - best, volts) for line in extreme]
    style.symmetric(rest, np.concatenate([np.abs(angle - _at(best, voltage)) + boxes[1], *lines]))
    figure.align_ylabels((whole, rest))
    corner, wide = (near[0], middle - high), np.ptp(near)
    whole.add_patch(Rectangle(corner, wide, 2 * high, fill=False, edgecolor=style.GREY, lw=0.8))
    style.noted(whole, "(c)", (voltage[lowest], middle), (14, -3), fontsize=9, color=style.GREY)
    handles = [
        whole.plot([], [], color=LINE, label="best line")[0],
        whole.plot([], [], color=EXTREME, ls=(0, (4, 2)), label="maximum-deviation lines")[0],
        style.mark("o", style.INK, "tower height"),
    ]
    handles += [style.mark("X", FLAG, "tower height, flagged")] if flagged.any() else []
    figure.legend(handles=handles, loc="outside upper left", ncols=len(handles))
    factor = float(data["deviation_line_factor"])  # above 1 no line passes through all boxes as they are
    stretched = f"the dashed lines pass through boxes {factor:g} times as large" if factor > 1 else ""
    boxes_are = f"boxes: ± {boxed} (mode {mode})"
    return style.footnote(figure, style.emulated_note(calibration), boxes_are, stretched)


def _at(line: Floats, voltage: ArrayLike) -> Floats:
    """The angle (°) of a line (intercept in rad, slope in rad/V) at a voltage."""
    return style.degrees(line[0] + line[1] * np.asarray(voltage))


def _lines(axes: Axes, span: Floats, best: Floats, extreme: Floats, about: Floats | float) -> None:
    for line in extreme:
        axes.plot(span, _at(line - about, span), color=EXTREME, lw=1, ls=(0, (4, 2)))
    axes.plot(span, _at(best - about, span), color=LINE, lw=1.3)


def _points(axes: Axes, voltage: Floats, angle: Floats, boxes: tuple[Floats, Floats], flagged: Bools) -> None:
    for x, y, wide, high, flag in zip(voltage, angle, *boxes, flagged, strict=True):
        colour, marker, size = (FLAG, "X", 6.5) if flag else (style.INK, "o", 4)
        if np.isfinite(wide + high):
            axes.add_patch(Rectangle((x - wide, y - high), 2 * wide, 2 * high, facecolor=(colour, 0.13), edgecolor=colour,
                                     lw=0.8, zorder=3))  # fmt: skip
        axes.plot(x, y, marker, color=colour, ms=size, mec="white", mew=0.5, zorder=4)


@style.styled
def fig09(angles: xr.Dataset) -> Figure:
    """One swing in degrees between its upper and lower bounds, with two places enlarged (the paper's Figure 9).

    ``angles`` is one recording's angle dataset: ``angle`` and ``angle_bound`` (time), in rad.
    """
    time = angles["time"].values - angles["time"].values[0]
    angle, bound = style.degrees(angles["angle"]), style.degrees(angles["angle_bound"])
    figure = style.new_figure(10.4)
    grid = figure.add_gridspec(2, 2, height_ratios=(1.25, 1))
    whole, peak, crossing = (figure.add_subplot(place) for place in (grid[0, :], grid[1, 0], grid[1, 1]))
    for axes in (whole, peak, crossing):
        axes.fill_between(time, angle - bound, angle + bound, facecolor=(LINE, 0.2), edgecolor=LINE, lw=0.6,
                          label="between lower and upper bound")  # fmt: skip
        axes.plot(time, angle, color=style.INK, lw=0.7, label="scaled and shifted angle")
        axes.grid(True)
        axes.set(xlabel=style.TIME, ylabel=r"angle $\theta$ (°)")
    whole.set(xlim=(time[0], time[-1]))
    bottom, ceiling = whole.get_ylim()
    whole.set_ylim(bottom, ceiling + 0.16 * (ceiling - bottom))  # room for the names of the enlarged places
    style.legend_above(whole)
    titles = "(a) a turning point", "(b) a passage through zero"
    for axes, window, title in zip((peak, crossing), _windows(time, angle), titles, strict=True):
        axes.plot(time[window], angle[window], "o", color=style.INK, ms=3, mew=0)
        axes.set(xlim=time[[window.start, window.stop - 1]], title=title)
        low, high = (angle - bound)[window].min(), (angle + bound)[window].max()
        axes.set_ylim(low - 0.06 * (high - low), high + 0.06 * (high - low))
        start, stop = time[window.start], time[window.stop - 1]
        size = stop - start, high - low
        whole.add_patch(Rectangle((start, low), *size, fill=False, edgecolor=FLAG, lw=1.1, zorder=5))
        whole.annotate(title[:3], (0.5 * (start + stop), high), xytext=(0.5 * (start + stop), ceiling), ha="center",
                       va="bottom", color=FLAG, fontsize=9, arrowprops={"arrowstyle": "-", "color": FLAG, "lw": 0.8,
                       "shrinkA": 0, "shrinkB": 0})  # fmt: skip
    factor = angles.attrs.get("coverage_factor")
    expanded = f"bounds: angle ± expanded uncertainty (k = {float(factor):.3g})" if factor is not None else ""
    return style.footnote(figure, recording_note(angles), expanded)


def recording_note(data: xr.Dataset) -> str:
    """Which recording a figure shows and, where it was emulated, that it was."""
    named = f"recording {data.attrs['recording']}" if "recording" in data.attrs else ""
    return " · ".join(part for part in (named, style.emulated_note(data)) if part)


def _windows(time: Floats, angle: Floats) -> tuple[slice, slice]:
    """Two short stretches of samples worth enlarging: about the highest angle of the first half, and a later zero."""
    half = len(time) // 2
    reach, narrow = min(8, half - 1), min(3, half - 1)
    top = int(np.clip(np.argmax(angle[:half]), reach, len(time) - reach - 1))
    if top == reach:  # a swing that starts at its highest: look one period on, where both sides are there
        crossed = np.flatnonzero(np.diff(np.sign(angle)))
        if len(crossed) > 3:
            top = crossed[1] + int(np.argmax(angle[crossed[1] : crossed[2] + 1]))
    zeros = np.flatnonzero(np.diff(np.sign(angle[half:])))
    zero = int(np.clip(half + (zeros[0] if len(zeros) else 0), reach, len(time) - reach - 1))
    return slice(top - reach, top + reach + 1), slice(zero - narrow, zero + narrow + 1)
