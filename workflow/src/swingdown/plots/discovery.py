"""What discovery saw and did: residuals before and after, the missing torque, half-swings, the ranking, the gap by round."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..arrays import Floats
from ..dataset import series_of
from ..own_unit import axis as axis_of
from ..own_unit import shown as shown_in
from ..own_unit import speed
from ..pendulum.model import in_words
from . import style

BEFORE, AFTER, HELD = "#D55E00", "#0072B2", "#009E73"
ANGLE = "rad"  # what readings are in, unless they are no angle
_ROWS = 12  # of a ranking
_MANY, _GROUPS = 80, 12  # half-swings beyond which means of groups are drawn, and so many groups


def no_verdict(campaign: str) -> Figure:
    """What stands in place of a figure of a campaign in which nothing could be looked for."""
    return style.absent(f"{campaign}: no verdict; its verdict.json says why")


@style.styled
def residuals(first: xr.Dataset, last: xr.Dataset) -> Figure:
    """Residuals of the fitted swing and the held-out swing that are worst at first, before and after, with the noise.

    ``first`` and ``last`` are the rounds' fit datasets: ``angle``, ``fit``, ``time``, ``swing`` (sample), ``held_out`` (swings).
    """
    figure = style.new_figure(10.5)
    shown = [one for one in (_worst(first, held=False), _worst(first, held=True)) if one is not None]
    grid = figure.subplots(len(shown), 1, squeeze=False)[:, 0]
    read = series_of(last)
    key = "noise_rms_rad_per_s" if read.name == "rate" else "noise_rms_rad"
    noise, unit = shown_in(last.attrs[key], read.attrs["units"])
    moved = "last model" if last.attrs["model"] != first.attrs["model"] else "(no move was made)"
    for axes, k in zip(grid, shown, strict=True):
        time, before = _residual(first, k)
        _, after = _residual(last, k)
        style.noise_band(axes, float(noise))
        axes.plot(time, before, color=BEFORE, lw=0.8, label="base model")
        axes.plot(time, after, color=AFTER, lw=0.8, label=moved)
        held = "held out" if bool(first["held_out"].values[k]) else "fitted"
        axes.set(xlim=(0, time[-1]), title=f"{first['name'].values[k]} ({held})")
        axes.set_ylabel(f"data − fit ({unit})")
        style.symmetric(axes, np.concatenate([before, [2 * noise]]))
        axes.grid(True, axis="y")
    grid[-1].set_xlabel(style.TIME)
    figure.legend(handles=grid[0].get_legend_handles_labels()[0], loc="outside upper left", ncols=3)
    return style.footnote(figure, f"campaign {first.attrs['campaign']}", style.emulated_note(first))


def _residual(data: xr.Dataset, k: int) -> tuple[Floats, Floats]:
    rows, read = data["swing"].values == k, series_of(data)
    time, left = data["time"].values[rows], read.values[rows] - data["fit"].values[rows]
    return time - time[0], shown_in(left, read.attrs["units"])[0]


def _worst(data: xr.Dataset, held: bool) -> int | None:
    swings = np.flatnonzero(data["held_out"].values == held).tolist()
    return max(swings, key=lambda k: float(np.mean(_residual(data, k)[1] ** 2)), default=None)


@style.styled
def missing_torque(
    first: pd.DataFrame, last: pd.DataFrame, rounds: Sequence[Mapping[str, Any]], unit: str = ANGLE
) -> Figure:
    """The torque that the base model and the last one lack, over angle, velocity and time, with bands of two standard errors.

    ``first`` and ``last`` are the rounds' map tables (``over``, ``part``, ``x``, ``torque``, ``band``), ``rounds`` the
    contents of ``rounds.json``, ``unit`` that of the angle.
    """
    figure = style.new_figure(8.8)
    grid = figure.subplots(1, 3)
    shown = [(first, BEFORE, "lacked by the base model"), (last, AFTER, "by the last model")][: len(rounds)]
    chosen = _largest(first[first["over"] == "time"])
    axis = {
        "position": (axis_of(unit), float(shown_in(1.0, unit)[0])),
        "velocity": (speed(unit), 1.0),
        "time": ("time (share of the record)", 1.0),
    }
    for axes, (over, (label, scale)) in zip(grid, axis.items(), strict=True):
        for table, colour, name in shown:
            part = table[table["over"] == over]
            if over == "time":
                part = part[part["part"] == chosen]
            if part.empty:
                continue
            x, torque, band = scale * part["x"].to_numpy(), part["torque"], 2 * part["band"]
            axes.fill_between(x, torque - band, torque + band, color=colour, alpha=0.25, lw=0)
            axes.plot(x, torque, color=colour, label=name)
        shares = {row["name"]: row["share"] for row in rounds[0]["groups"]}
        heading = f"time: {chosen}" if over == "time" else over
        # each as if it alone were missing, so that shares overlap; of an excess that is none there are none
        if not rounds[0]["missing"]:
            share = "nothing is missing"
        else:
            share = f"explains {100 * shares[over]:.0f} % alone" if over in shares else "not seen"
        axes.set(xlabel=label, title=f"{heading}\n{share}")
        axes.axhline(0, color=style.GREY, lw=0.6)
        axes.grid(True, axis="y")
    grid[0].set_ylabel(f"missing torque over inertia ({unit}/s²)")
    figure.legend(handles=style.handles_of(figure), loc="outside upper left", ncols=3)
    bands = "bands: ± 2 standard errors under the measured noise"
    time = "time: a change of drag or stiffness, or a push, as a torque at the largest velocity or angle"
    return style.footnote(figure, "each as if it alone were missing", bands, time)


def _largest(part: pd.DataFrame) -> str:
    """The part (drag, stiffness, push) that differs most from nothing, in units of its own band; of a search that broke off none."""
    size = (part["torque"].abs() / part["band"].clip(lower=1e-12)).groupby(part["part"]).max()
    return str(size.idxmax()) if len(size) else ""


@style.styled
def half_swings(first: pd.DataFrame, last: pd.DataFrame, unit: str = ANGLE) -> Figure:
    """Energy loss, period and mid-point of each half-swing against its amplitude: measured, base model and last model.

    ``first`` and ``last`` are the rounds' half-swing tables, ``unit`` that of the angle. Of many half-swings the lower row has means of groups, with bars of two
    standard errors.
    """
    figure = style.new_figure(11.5)
    upper, lower = figure.subplots(2, 3, sharex=True)
    quantities = (
        ("energy_loss", "energy lost (%)", 100.0),
        ("period_ratio", "half-period over ideal", 1.0),
        ("midpoint_rad", f"mid-point ({shown_in(0.0, unit)[1]})", float(shown_in(1.0, unit)[0])),
    )
    kinds = dict.fromkeys(("amplitude_rad", *(column for column, *_ in quantities)), float)
    first, last = first.astype(kinds), last.astype(kinds)  # a table without rows is read as text
    for axes, below, (column, label, scale) in zip(upper, lower, quantities, strict=True):
        measured = first[first["of"] == "measured"]
        at, values = shown_in(measured["amplitude_rad"], unit)[0], scale * measured[column].to_numpy()
        look: dict[str, Any] = {"marker": "o", "ms": 3.6, "mfc": "none", "mew": 0.7}
        if len(measured) > _MANY:
            look = {"marker": ".", "ms": 1.5, "mew": 0}
        axes.plot(at, values, ls="", color=style.GREY, label="measured", **look)
        for table, colour, name in ((first, BEFORE, "base model"), (last, AFTER, "last model")):
            modelled = table[table["of"] == "modelled"]
            at = shown_in(modelled["amplitude_rad"], unit)[0]
            style.dots(axes, at, scale * modelled[column], 3, colour, label=name)
            amplitude, left = _left(table, column)
            at, left = shown_in(amplitude, unit)[0], scale * np.asarray(left, float)
            if len(at) > _MANY:
                style.dots(below, at, left, 1.5, colour, alpha=0.5)
                _means(below, at, left, colour)
            else:
                style.dots(below, at, left, 4.5, colour)
            _reach(below, left)
        _reach(axes, scale * measured[column].to_numpy())
        below.axhline(0, color=style.GREY, lw=0.6)
        axes.set_title(label)
        below.set_xlabel(f"amplitude ({shown_in(0.0, unit)[1]})")
        if not np.isfinite(measured[column]).any():
            why = "not shown by a rate" if len(measured) else "no half-swing"
            axes.annotate(why, (0.5, 0.5), xycoords="axes fraction", ha="center")
        for one in (axes, below):
            one.grid(True, axis="y")
    upper[0].set_ylabel("each half-swing")
    lower[0].set_ylabel("measured − modelled")
    figure.legend(handles=upper[0].get_legend_handles_labels()[0], loc="outside upper left", ncols=3)
    return figure


def _means(axes: Axes, at: Floats, values: Floats, colour: str) -> None:
    """The means of so many half-swings that lie side by side, with two standard errors: of hundreds the eye sees none."""
    known = np.isfinite(values)
    order = np.argsort(at[known])
    for part in np.array_split(order, _GROUPS):
        x, y = at[known][part], values[known][part]
        if len(x) > 1:
            error = 2 * float(np.std(y, ddof=1)) / np.sqrt(len(y))
            axes.errorbar(x.mean(), y.mean(), error, fmt="o", color=colour, ms=3.4, elinewidth=1.0)


def _left(table: pd.DataFrame, column: str) -> tuple[pd.Series, pd.Series]:
    """Amplitude (rad) and measured less modelled of each half-swing that both have: those of a swing one after the other."""
    each = table.assign(number=table.groupby(["swing", "of"]).cumcount())
    each = each.set_index(["swing", "number"])
    measured, modelled = (each[each["of"] == of] for of in ("measured", "modelled"))
    left = (measured[column] - modelled[column]).reindex(measured.index.intersection(modelled.index))
    return measured["amplitude_rad"].reindex(left.index), left


def _reach(axes: Axes, values: Floats) -> None:
    """The axes widened so that all but a few strays are in view."""
    if not np.isfinite(values).any():
        return
    low, high = np.nanquantile(values, [0.02, 0.98])
    room = 0.25 * (high - low) + 1e-12
    before = (np.inf, -np.inf) if axes.get_autoscaley_on() else axes.get_ylim()
    axes.set_ylim(min(low - room, before[0]), max(high + room, before[1]))


@style.styled
def ranking(ranked: pd.DataFrame, move: str) -> Figure:
    """What each move would gain in the first round that looked, as evidence: the fall of BIC; refused ones are faint, with the reason.

    ``ranked`` is a ranking table with ``move``, ``gain_bic``, ``tied`` and ``refused``; ``move`` the one that was chosen.
    """
    if ranked.empty:
        return style.absent("Nothing was missing: no move was looked for.")
    table = ranked.head(_ROWS)
    figure = style.new_figure(1.8 + 0.55 * len(table))
    axes = figure.subplots()
    for place, row in enumerate(table.itertuples()):
        colour, said = style.GREY, ""
        if isinstance(row.refused, str) and row.refused:
            colour, said = style.FAINT, f"refused: {in_words(row.refused)}"
        elif row.move == move:
            colour, said = AFTER, "chosen"
        elif row.tied:
            colour, said = HELD, "tied"
        axes.barh(place, row.gain_bic, color=colour, height=0.62)
        told = f"{row.gain_bic:.0f}  {said}".rstrip()
        style.noted(axes, told, (max(row.gain_bic, 0), place), (4, 0), va="center", fontsize=8.5)
    axes.set_yticks(range(len(table)), [in_words(name) for name in table["move"]])
    axes.invert_yaxis()
    most = max(float(table["gain_bic"].max()), 1.0)
    axes.set_xlim(min(0.0, 1.05 * float(table["gain_bic"].min())), 1.5 * most)
    axes.axvline(0, color=style.GREY, lw=0.8)
    axes.tick_params(axis="y", length=0)
    axes.set_xlabel("evidence gained: fall of BIC, where nothing else is missing")
    return figure


@style.styled
def gap(verdict: Mapping[str, Any]) -> Figure:
    """The residual in units of the noise, round by round, on fitted and held-out swings; ``verdict`` is verdict.json's contents."""
    fit, held = verdict["gap"]["fit"], verdict["gap"]["holdout"]
    figure = style.new_figure(7.2)
    axes = figure.subplots()
    places = np.arange(len(fit))
    axes.axhline(1, color=style.GREY, lw=0.8, ls=(0, (4, 2)))
    axes.plot(places, fit, "o-", color=AFTER, ms=5, label="fitted swings")
    axes.plot(places, held, "s--", color=HELD, ms=5, label="held-out swings")
    for place, both in zip(places, zip(fit, held, strict=True), strict=True):
        for value, other, colour in zip(both, both[::-1], (AFTER, HELD), strict=True):
            # the larger stands above, each in its mark's colour
            above = value > other or (value == other and colour == HELD)
            away = (0, 7 if above else -14)
            style.noted(axes, f"{value:.3g}", (place, value), away, ha="center", fontsize=8.5, color=colour)
    axes.set_yscale("log")
    style.decimal_log(axes.yaxis)
    low, high = min(*fit, *held, 0.9), max(*fit, *held, 1.2)
    axes.set_ylim(low / 1.35, high * 1.35)
    axes.set_xticks(places, ["base model", *(in_words(move) for move in verdict["moves"])][: len(fit)])
    axes.set_xlim(-0.4, len(fit) - 0.6)
    axes.set_ylabel("residual over noise")
    axes.grid(True, axis="y")
    style.legend_above(axes)
    return figure
