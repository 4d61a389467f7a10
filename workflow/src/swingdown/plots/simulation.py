"""Figures 2 to 5: the simulated swings, and how well each model fits what another has made."""

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.figure import Figure

from ..pendulum.model import symbol
from . import style

INFERRED = r"release angle, duration, $\zeta_q$, $\gamma$, start of the fit, norm"
AGREE = 0.01  # of a norm: two methods that differ by less found the same optimum
PAPER, NELDER_MEAD, LEAST_SQUARES = -0.24, -0.05, 0.18  # where marks stand, from a model's place on the axis


@style.styled
def fig02(realizations: xr.Dataset) -> Figure:
    """The first noisy realisation of viscous damping on the noise-free series, the noise alone below (the paper's Figure 2).

    ``realizations`` has ``truth`` (simulated, time) and ``noisy`` (simulated, realization, time), in rad.
    """
    simulated = "viscous"
    if simulated not in realizations["simulated"].values:
        return style.absent(f"This study does not simulate {style.name(simulated)} damping.")
    data = realizations.sel(simulated=simulated).isel(realization=0)
    time, truth, noisy = data["time"].values, style.degrees(data["truth"]), style.degrees(data["noisy"])

    figure = style.new_figure(9)
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=(3, 1))
    damping = f"noise-free, {style.name(simulated)} damping"
    upper.plot(time, truth, color=style.colour(simulated), lw=1.6, label=damping)
    style.dots(upper, time, noisy, 2.8, style.INK, label="one noisy realisation")
    upper.set(ylabel=r"angle $\theta$ (°)", xlim=(time[0], time[-1]))
    style.legend_above(upper)
    lower.axhline(0, color=style.colour(simulated), lw=1)
    lower.vlines(time, 0, noisy - truth, color=style.GREY, lw=0.6)
    lower.set(xlabel="time $t$ (s)", ylabel="noise (°)")
    style.symmetric(lower, noisy - truth)
    for axes in (upper, lower):
        axes.grid(True, axis="y")
    figure.align_ylabels()
    inferred = _inferred(realizations, "release angle, duration")
    return style.footnote(figure, "simulated", _settings(realizations), inferred)


@style.styled
def norms_of(simulated: str, norms: xr.Dataset, table2: pd.DataFrame) -> Figure:
    """A figure of the norms of every fitted model, for one simulated model (the paper's Figures 3 to 5).

    ``norms`` has ``norm`` and ``least_squares_norm`` (simulated, fitted, realization), in degrees; ``table2`` has
    the paper's ``published_mean`` and ``published_std`` by simulated and fitted model, where the paper gives them.
    """
    if simulated not in norms["simulated"].values:
        return style.absent(f"This study does not simulate {style.name(simulated)} damping.")
    data = norms.sel(simulated=simulated)
    fitted = [str(label) for label in data["fitted"].values]
    published = table2[table2["simulated"] == simulated].set_index("fitted")

    figure = style.new_figure(9.4)
    axes = figure.subplots()
    apart = False
    for place, label in enumerate(fitted):
        colour = style.colour(label)
        if label == simulated:
            axes.axvspan(place - 0.5, place + 0.5, color=style.PALE, lw=0, zorder=0)
        one = data.sel(fitted=label)
        simplex, squares = one["norm"].values, one["least_squares_norm"].values
        style.runs(axes, place + NELDER_MEAD, simplex, colour, "o")
        # the same optimum needs no second mark
        if not np.allclose(simplex, squares, rtol=0, atol=AGREE * np.mean(squares)):
            apart = True
            style.runs(axes, place + LEAST_SQUARES, squares, colour, "D")
        if label in published.index:
            row = published.loc[label]
            style.published(axes, place + PAPER, row["published_mean"], row["published_std"])
    style.model_axis(axes, fitted)
    axes.set_ylabel("norm: RMS of fit − truth (°)")
    axes.set_ylim(bottom=min(0, axes.get_ylim()[0]))
    axes.grid(True, axis="y")
    if simulated in fitted:
        axes.text(fitted.index(simulated), 0.985, "the true model", transform=axes.get_xaxis_transform(), ha="center",
                  va="top", fontsize=9, color=style.GREY)  # fmt: skip
    count = int(data.sizes["realization"])
    handles = [
        style.mark("o", style.GREY, "Nelder–Mead" if apart else "Nelder–Mead and least squares alike"),
        *([style.mark("D", style.GREY, "least squares, where it differs")] if apart else []),
        style.mark("s", style.INK, "the paper", hollow=True),
        style.mark(".", style.FAINT, f"each of {count} realisations"),
    ]
    style.legend_above(axes, handles)
    title = f"{style.name(simulated).capitalize()} damping simulated ({symbol(simulated, mathtext=True)})"
    axes.set_title(title, pad=24)
    bars = "marks with bars: mean ± standard deviation; truth: the noise-free series"
    return style.footnote(figure, bars, _settings(norms), _inferred(norms, INFERRED))


def _settings(data: xr.Dataset) -> str:
    """The signal-to-noise ratio and seed that a simulation's dataset states."""
    parts = [f"SNR {data.attrs['snr']:g}:1"] if "snr" in data.attrs else []
    if "seed" in data.attrs:
        parts.append(f"seed {data.attrs['seed']}")
    return ", ".join(parts)


def _inferred(data: xr.Dataset, settings: str) -> str:
    """That ``settings`` were inferred, where the dataset says so (in full, in its attribute ``inferred``)."""
    return f"not in the paper, inferred from its Table 2: {settings}" if data.attrs.get("inferred") else ""
