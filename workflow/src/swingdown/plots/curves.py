"""What a recording shows against the amplitude, and what the laws of damping make of its envelope."""

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.ticker import LogLocator, MaxNLocator

from ..arrays import Floats
from ..pendulum.model import in_words
from . import style

FREE, MODEL = "#0072B2", "#D55E00"
_DOTS = 60  # single swings beyond which means of neighbours are drawn
_GROUPS = 16
_APART = 0.12  # of a panel's height: between two marks of a scale that is not even
_REACH = 1.35  # of the free curve's range that single swings, which scatter more, may widen a panel to
_SEEN = 0.01  # of the largest torque: nearer than this, one line hides the other


@style.styled
def backbone(data: xr.Dataset) -> style.Drawn:
    """A figure of frequency, loss and damping ratio against amplitude, restoring torque over angle and friction over speed.

    Each (``curves.dataset.curves``) is free of a model, of the model with what it lacks, and of the model alone. Single swings are drawn as
    dots, of many the means of neighbours with two standard errors.
    """
    torques = bool(np.isfinite(data["friction"].sel(source="free")).any())
    timed = bool(np.isfinite(data["period"].sel(source="free")).any())
    figure = style.new_figure(11.0 if torques else 6.0)
    grid = figure.add_gridspec(2 if torques else 1, 6)
    first, second, third = (figure.add_subplot(grid[0, k : k + 2]) for k in (0, 2, 4))
    angles = data["amplitude"].attrs["units"] == "rad"
    amplitude = style.degrees(data["amplitude"]) if angles else data["amplitude"].values
    size = style.degrees(data["swing_amplitude"]) if angles else data["swing_amplitude"].values
    unit = "amplitude (°)" if angles else f"amplitude ({data['amplitude'].attrs['units']})"
    _curve(second, amplitude, data, "loss", 100.0)
    _swings(second, size, 100 * data["swing_loss"].values, 100 * data["swing_loss_u"].values)
    second.set(xlabel=unit, ylabel="loss a swing (%)")
    _curve(third, amplitude, data, "damping_ratio", 100.0)
    third.set(xlabel=unit, ylabel="damping ratio (%)")
    _quality(third)
    if timed:
        _curve(first, amplitude, data, "frequency", 1.0, upright=True)
        with np.errstate(divide="ignore"):
            frequency = 1 / data["swing_period"].values
        _swings(first, size, frequency, data["swing_period_u"].values * frequency**2, upright=True)
    else:
        _untimed(first)
    first.set(xlabel="frequency (Hz)", ylabel=unit)
    first.ticklabel_format(axis="x", useOffset=False)
    low, high = first.get_xlim()
    marks = MaxNLocator(4, steps=[1, 2, 5, 10]).tick_values(low, high)
    inside = [mark for mark in marks if low <= mark <= high]
    first.set_xticks(inside[:: max(len(inside) - 1, 1)])  # of so many digits two fill a panel
    if torques:
        left, right = figure.add_subplot(grid[1, :3]), figure.add_subplot(grid[1, 3:])
        _restoring(left, data, timed)
        _curve(right, data["speed"].values, data, "friction", 1.0)
        right.set(xlabel="speed (rad/s)", ylabel="friction (rad/s²)")
        right.set_ylim(bottom=min(0.0, right.get_ylim()[0]))
    for axes in figure.axes:
        axes.grid(True)
    figure.legend(handles=style.handles_of(figure), loc="outside upper left", ncols=3)
    of_model = f"model: {style.name(data.attrs['model'])}" if data.attrs["model"] else ""
    over = "torques over inertia; 95 % bands, the model's with what it lacks"
    return style.footnote(figure, of_model, over, style.emulated_note(data))


def _quality(axes: Axes) -> None:
    """The quality on the right of an axes of damping ratios (%), marked where the numbers have room."""
    axis = axes.secondary_yaxis("right", functions=(_of_ratio, _of_ratio))
    axis.set_ylabel("Q")
    low, high = axes.get_ylim()
    if high <= 0:
        return  # a ratio of zero, or below, has no quality
    least, most = 50 / high, 50 / max(low, high / 50)
    wide = most > 5 * least
    places = LogLocator(subs=(1.0, 2.0, 5.0), numticks=20) if wide else MaxNLocator(4)
    marks: list[float] = []
    for mark in places.tick_values(least, most):
        if marks and 50 / marks[-1] - 50 / mark < _APART * (high - low):
            break  # those above are nearer still
        if least <= mark <= most:
            marks.append(float(mark))
    axis.set_yticks(marks, [f"{mark:g}" for mark in marks])


def _of_ratio(value: Any) -> Any:
    """The quality of a damping ratio in %, and the other way round."""
    with np.errstate(divide="ignore"):
        return 50 / np.asarray(value, dtype=float)


def _curve(axes: Axes, at: Floats, data: xr.Dataset, name: str, scale: float, upright: bool = False) -> None:
    """Both curves of a quantity with their bands, the model alone, and the panel as wide as the free curve's."""
    for source, colour, words, dashes in (
        ("free", FREE, "free of a model", "-"),
        ("model", MODEL, "model", (0, (4, 1.5))),
        ("alone", MODEL, "model alone", ":"),
    ):
        value, low, high = (
            scale * data[name + end].sel(source=source).values for end in ("", "_low", "_high")
        )
        if not np.isfinite(value).any():
            continue
        fill = axes.fill_betweenx if upright else axes.fill_between
        fill(at, low, high, color=colour, alpha=0.25, lw=0)
        axes.plot(*((value, at) if upright else (at, value)), color=colour, ls=dashes, label=words)
    free = data.sel(source="free")
    values = scale * free[name].values
    ends = []
    for function, end in ((np.min, "_low"), (np.max, "_high")):
        band = scale * free[name + end].values
        known = np.isfinite(band)  # a band without an end reaches to infinity
        ends.append(float(function(band[known] if known.any() else values[np.isfinite(values)])))
    spread = float(np.ptp(values[np.isfinite(values)]))  # of widest swings the period may not be known
    reach = _REACH * spread + 0.02 * abs(float(np.nanmean(values)))
    middle = (np.nanmin(values) + np.nanmax(values)) / 2
    if upright:  # a frequency changes by little
        reach = max(_REACH * spread, 4 * float(np.nanmedian(ends[1] - ends[0])) / 2, 1e-6)
    limits = max(ends[0], middle - reach), min(ends[1], middle + reach)
    room = 0.08 * (limits[1] - limits[0])
    (axes.set_xlim if upright else axes.set_ylim)(limits[0] - room, limits[1] + room)


def _swings(axes: Axes, size: Floats, value: Floats, error: Floats, upright: bool = False) -> None:
    """Single swings as dots, or means of neighbours in amplitude with two standard errors where there are many.

    Those whose bars would fill the panel, as its curves have it, tell nothing and are left out.
    """
    good = np.isfinite(value) & np.isfinite(size)
    size, value, error = size[good], value[good], error[good]
    words = "single swings"
    if size.size > _DOTS:
        parts = [(size[one], value[one]) for one in np.array_split(np.argsort(size), _GROUPS)]
        means = [(one.mean(), of.mean(), of.std(ddof=1) / np.sqrt(of.size)) for one, of in parts]
        size, value, error = np.array(means).T
        words = "means of single swings"
    low, high = axes.get_xlim() if upright else axes.get_ylim()
    told = 2 * error < high - low
    size, value, error = size[told], value[told], error[told]
    if not size.size:
        return
    x, y = (value, size) if upright else (size, value)
    bars = (None, 2 * error) if upright else (2 * error, None)
    axes.errorbar(x, y, bars[0], bars[1], ".", ms=4, mew=0, color=style.GREY, elinewidth=0.7, capsize=0, zorder=1, label=words)  # fmt: skip


def _untimed(axes: Axes) -> None:
    axes.text(0.5, 0.5, "no times", transform=axes.transAxes, ha="center", color=style.GREY)


def _restoring(axes: Axes, data: xr.Dataset, timed: bool) -> None:
    angle = style.degrees(data["angle"])
    if not timed:
        _untimed(axes)
        return
    _curve(axes, angle, data, "restoring", 1.0)
    value = data["restoring"].sel(source="free").values
    slope = value[1] / data["angle"].values[1]
    spring = slope * data["angle"].values
    if np.abs(value - spring).max() > _SEEN * spring[-1]:  # else it lies under the others
        axes.plot(angle, spring, color=style.GREY, lw=0.8, ls=":", label="a spring's")
    axes.set_ylim(0, 1.08 * max(value.max(), spring[-1]))
    axes.set(xlabel="angle (°)", ylabel="restoring torque (rad/s²)")
    axes.locator_params(axis="y", nbins=4)  # more have longer numbers as soon as the layout is settled


@style.styled
def envelopes(data: xr.Dataset) -> style.Drawn:
    """A figure of a recording's amplitudes over time with what each law makes of them (``curves.laws.envelopes``), and below what each leaves."""
    figure = style.new_figure(10.0)
    upper, lower = figure.subplots(2, sharex=True, height_ratios=[3, 2])
    angles = data["amplitude"].attrs["units"] == "rad"
    scale = 180 / np.pi if angles else 1.0
    time, measured = data["time"].values, scale * data["amplitude"].values
    ring: dict[str, Any] = {"mfc": "white", "ms": 3.2, "mew": 0.7, "zorder": 5}
    upper.plot(time, measured, "o", color=style.GREY, label="turning points, measured", **ring)
    best = str(data.attrs["best"])
    left = []
    for k, label in enumerate(map(str, data["law"].values)):
        fitted = scale * data["fitted"].sel(law=label).values
        bold = {"lw": 1.3, "zorder": 6} if label == best else {"lw": 1.0, "ls": (0, (5, 1 + k % 3))}
        words, colour = " + ".join(map(in_words, label.split("+"))), _COLOURS.get(label, style.INK)
        upper.plot(time, fitted, color=colour, label=words, **bold)
        lower.plot(time, measured - fitted, color=colour, **bold)
        left.append(measured - fitted)
    upper.set_yscale("log")
    style.decimal_log(upper.yaxis)
    unit = "°" if angles else data["amplitude"].attrs["units"]
    upper.set_ylabel(f"amplitude ({unit})")
    lower.set(xlabel=style.TIME, ylabel=f"measured − law ({unit})")
    style.symmetric(lower, left)
    for axes in (upper, lower):
        axes.grid(True)
    figure.legend(loc="outside upper left", ncols=3)
    return style.footnote(figure, *str(data.attrs["said"]).split("; "), style.emulated_note(data))


_SINGLE = {label: one for label, one in style.COLOURS.items() if label.count("+") != 1}
_COLOURS = _SINGLE | {"constant_coulomb": "#CC79A7"}


@style.styled
def resonances(data: xr.Dataset) -> style.Drawn:
    """A figure of amplitude and phase of the steady swing against the frequency of a drive, with the backbone of the ring-down.

    What of it (``curves.resonance.resonance``) is free of a model is drawn. Dashed, where there is such a part: no pendulum stays.
    """
    figure = style.new_figure(11.0)
    upper, lower = figure.subplots(2, sharex=True, height_ratios=[3, 2])
    own = data.sel(source="free")
    size = style.degrees(data["backbone_amplitude"])
    upper.plot(own["backbone_frequency"], size, color=style.INK, lw=0.9, ls=":", label="backbone (ring-down)")
    lower.axhline(90, color=style.INK, lw=0.9, ls=":")
    folded = False
    for k, drive in enumerate(data["drive"].values):
        one, colour = own.isel(drive=k), _DRIVES[k % len(_DRIVES)]
        amplitude = style.degrees(one["amplitude"])
        for side in data["side"].values:
            half = one.sel(side=side)
            frequency, phase = half["frequency"].values, style.degrees(half["phase"])
            stays = half["stable"].values > 0.5
            folded |= bool((~stays & np.isfinite(frequency)).any())
            low, high = half["frequency_low"].values, half["frequency_high"].values
            upper.fill_betweenx(amplitude, low, high, color=colour, alpha=0.25, lw=0)
            for axes, value in ((upper, amplitude), (lower, phase)):
                axes.plot(np.where(stays, frequency, np.nan), value, color=colour)
                between = ~stays | np.roll(~stays, 1) | np.roll(~stays, -1)
                axes.plot(np.where(between, frequency, np.nan), value, color=colour, ls=(0, (2, 1.5)), lw=0.8)
        cut = not np.isfinite(one["peak_amplitude"])
        words = f"drive {drive:.3g} rad/s²" + (", cut" if cut else "")
        upper.plot([], [], color=colour, label=words)
    upper.set_ylabel("amplitude (°)")
    upper.set_ylim(bottom=0)
    lower.set(
        xlabel="frequency of the drive (Hz)", ylabel="phase lag (°)", ylim=(0, 180), yticks=[0, 90, 180]
    )
    for axes in (upper, lower):
        axes.grid(True)
    figure.legend(loc="outside upper left", ncols=4)
    beyond = "" if np.isfinite(own["peak_amplitude"]).all() else "cut: peaks beyond the ring-down"
    torque = data.attrs["kind"] == "torque"
    drive = f"drive: {'torque over inertia' if torque else 'acceleration of the pivot over the length'}"
    dashed = "dashed: no pendulum stays there" if folded else ""
    return style.footnote(figure, drive, dashed, beyond, "bands of 95 %", style.emulated_note(data))


_DRIVES = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
