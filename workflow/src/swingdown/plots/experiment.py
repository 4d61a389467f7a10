"""Figures 10 to 15: what each damping model makes of the recorded swings."""

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..arrays import Floats
from ..dataset import series_of
from ..pendulum.model import symbol
from . import style
from .calibration import recording_note

EARLY_AND_LATE = 3.0  # seconds enlarged at each end of a swing
ERROR_BOUNDS = "error_bounds"


def fit_of_pair(rank: int, fits: xr.Dataset, angles: xr.Dataset, norms: xr.Dataset) -> Figure:
    """The fit of the pair of effects with the lowest mean norm, or of rank 1 the second lowest (the paper's Figures 13 and 14)."""
    mean = _of_campaign(norms, angles.attrs.get("campaign"))["norm"].mean("recording").to_series()
    pairs = mean[[label for label in mean.index if label.count("+") == 1]].sort_values(kind="stable")
    if len(pairs) <= rank:
        return style.absent("This study fits too few models with two effects.")
    return fit_of(pairs.index[rank], fits, angles, ("best pair", "second best pair")[rank] + " of effects")


def _of_campaign(norms: xr.Dataset, campaign: str | None) -> xr.Dataset:
    """The runs of one campaign; all of them where the dataset does not tell campaigns apart."""
    if campaign is None or "campaign" not in norms.coords:
        return norms
    return norms.isel(recording=np.flatnonzero(norms["campaign"].values == campaign))


@style.styled
def fit_of(label: str, fits: xr.Dataset, angles: xr.Dataset, remark: str = "") -> Figure:
    """A figure of one model's best fit on one swing: the whole, both ends enlarged, and the residual (the paper's Figures 10 to 12).

    ``fits`` holds ``fit`` and ``residual`` (fitted, time; rad) and ``norm`` (fitted; degrees), ``angles`` the same
    swing's ``angle``, ``angle_bound`` and, where known, ``angle_random_uncertainty`` (time; rad), the bands behind the
    residual.
    """
    if label not in fits["fitted"].values:
        return style.absent(f"This study does not fit the {style.name(label)} model.")
    one = fits.sel(fitted=label)
    time = fits["time"].values
    time = time - time[0]
    angle, bound = style.degrees(series_of(angles)), style.degrees(series_of(angles, "bound"))
    what = r"angle $\theta$ (°)" if "angle" in angles else r"angular rate (°/s)"
    fit, residual = style.degrees(one["fit"]), style.degrees(one["residual"])
    colour = style.colour(label)

    figure = style.new_figure(12)
    grid = figure.add_gridspec(3, 2, height_ratios=(1.1, 1.25, 0.95))
    whole, strip = figure.add_subplot(grid[0, :]), figure.add_subplot(grid[2, :])
    early, late = figure.add_subplot(grid[1, 0]), figure.add_subplot(grid[1, 1])
    shown = min(EARLY_AND_LATE, 0.4 * time[-1])
    for axes in (whole, early, late):
        # each sample is a ring that the fit's line goes through, or misses; a band would hide both
        size, edge = (1.4, 0.3) if axes is whole else (3.4, 0.5)
        axes.plot(time, angle, "o", ms=size, mfc="none", mew=edge, color=style.GREY, rasterized=axes is whole)
        axes.plot(time, fit, color=colour, lw=0.7 if axes is whole else 1.1)
        axes.grid(True, axis="y")
        axes.set_ylabel(what)
    whole.set_xlim(time[0], time[-1])
    early.set(xlim=(0, shown), title=f"(a) first {shown:g} s")
    late.set(xlim=(time[-1] - shown, time[-1]), title=f"(b) last {shown:g} s", ylabel="")
    for axes in (early, late):
        inside = (time >= axes.get_xlim()[0]) & (time <= axes.get_xlim()[1])
        style.symmetric(axes, np.concatenate([angle[inside], fit[inside]]))
    bands = _residual(strip, time, residual, bound, angles, colour)
    figure.align_ylabels((whole, early, strip))
    handles = [
        style.mark("o", style.GREY, "samples", hollow=True),
        whole.plot([], [], color=colour, label="fit")[0],
        *bands,
    ]
    legend = figure.legend(
        handles=handles, loc="outside upper left", ncols=len(handles), title_fontsize=10.5, alignment="left"
    )
    norm = f"norm {float(one['norm']):#.3g}° (RMS)"
    words = f"{symbol(label, mathtext=True)}  {style.name(label)} damping: {norm}"
    legend.set_title(words + (f" — {remark}" if remark else ""))
    return style.footnote(figure, recording_note(angles))


def _residual(
    axes: Axes, time: Floats, residual: Floats, bound: Floats, angles: xr.Dataset, colour: str
) -> list[Artist]:
    """The legend entries of the bands behind a residual, which this draws into the axes."""
    bands: list[Artist] = [
        axes.fill_between(time, -bound, bound, color=style.FAINT, alpha=0.6, lw=0, label="error bound")
    ]
    random = f"{series_of(angles).name}_random_uncertainty"
    if random in angles and (angles[random] > 0).all():
        noise = 2 * style.degrees(angles[random])
        label = "± 2 random uncertainties"
        bands.append(axes.fill_between(time, -noise, noise, color=style.GREY, alpha=0.55, lw=0, label=label))
    axes.axhline(0, color=style.GREY, lw=0.6)
    axes.plot(time, residual, color=colour, lw=0.7)
    # A good fit leaves less than the error bound, most of which all samples share: then the residual sets the scale.
    small = style.symmetric(axes, residual).get_ylim()[1] < bound.min()
    if not small:
        style.symmetric(axes, np.concatenate([residual, bound]))
    title = "(c) residual: the error bound reaches beyond this strip" if small else "(c) residual"
    unit = "°" if "angle" in angles else "°/s"
    axes.set(xlim=(time[0], time[-1]), xlabel=style.TIME, ylabel=f"data − fit ({unit})", title=title)
    axes.grid(True, axis="y")
    return bands


@style.styled
def fig15(norms: xr.Dataset, table3: pd.DataFrame) -> Figure:
    """The norms of all models, run by run and as mean ± standard deviation (the paper's Figure 15).

    ``norms`` has ``norm`` (fitted, recording) and ``error_bound_norm`` (recording), in degrees; ``table3`` has the
    campaigns' mean and std, and the paper's, by fitted model and for ``error_bounds``. The first campaign is drawn.
    """
    campaign = table3["campaign"].iloc[0]
    norms, table = _of_campaign(norms, campaign), table3[table3["campaign"] == campaign].set_index("fitted")
    fitted = [str(label) for label in norms["fitted"].values]
    figure = style.new_figure(10)
    axes = figure.subplots()
    places = {ERROR_BOUNDS: 0} | {label: number + 1 for number, label in enumerate(fitted)}
    benchmark = table.loc[ERROR_BOUNDS] if ERROR_BOUNDS in table.index else None
    if benchmark is not None:
        low, high = benchmark["mean"] - benchmark["std"], benchmark["mean"] + benchmark["std"]
        axes.axhspan(low, high, color=style.FAINT, alpha=0.6, lw=0, zorder=0)
        axes.axhline(benchmark["mean"], color=style.GREY, lw=0.8, ls=(0, (4, 2)), zorder=1)
    for label, place in places.items():
        values, colour = norms["error_bound_norm"], style.GREY
        if label != ERROR_BOUNDS:
            values, colour = norms["norm"].sel(fitted=label), style.colour(label)
        style.runs(axes, place, values.values, colour, "o")
        if label in table.index:
            row = table.loc[label]
            style.published(axes, place - 0.24, row["published_mean"], row["published_std"])
    axes.set_yscale("log")
    axes.axvline(0.5, color=style.FAINT, lw=0.8)
    style.model_axis(axes, [(r"$\pm U$", "error\nbounds"), *fitted])
    axes.set_ylabel("norm: RMS of data − fit (°)")
    style.decimal_log(axes.yaxis)
    axes.grid(True, axis="y", which="major")
    handles = [
        style.mark("o", style.GREY, "mean ± standard deviation"),
        style.mark(".", style.FAINT, f"each of {norms.sizes['recording']} runs"),
        style.mark("s", style.INK, "paper's apparatus (another pendulum)", hollow=True),
    ]
    style.legend_above(axes, handles)
    dashed = "dashed: the error bounds, the benchmark for a fit"
    return style.footnote(figure, f"campaign {campaign}", style.emulated_note(norms), dashed)
