"""Series: a quantity over what was varied with its power law and theory's, residuals below; groups side by side."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..rounding import value_with_uncertainty
from . import style

DATA, LAW, THEORY = style.INK, "#0072B2", "#D55E00"
_LABELS = {"period": "period $T$ (s)", "quality": "quality $Q$", "decay_rate": "decay rate $γ$ (1/s)"}


@style.styled
def over_what_was_varied(series: Sequence[Any], emulated: str = "no") -> Figure:
    """A column for each ``Series`` of one thing varied: above the points with both laws, below what the power law leaves."""
    figure = style.new_figure(9.5)
    grid = figure.subplots(2, len(series), sharex="col", squeeze=False, height_ratios=[3, 2])
    for (upper, lower), one in zip(grid.T, series, strict=True):
        _panel(upper, lower, one)
    figure.legend(handles=style.handles_of(figure), loc="outside upper left", ncols=3)
    widened = any(one.law.scatter.widening > 1 for one in series)
    return style.footnote(
        figure,
        "bars: ± 2 standard uncertainties",
        "in brackets those of the exponents, widened to the scatter of the points" if widened else "",
        "all lengths may be off by one amount" if any(one.told is not one.law for one in series) else "",
        "T of small swings" if any(one.quantity == "period" for one in series) else "",
        style.emulated_note({"emulated": emulated}),
    )


def _panel(upper: Axes, lower: Axes, one: Any) -> None:
    points, law, theory = one.table, one.told, one.law.theory
    reach = points["x"].max() - points["x"].min()
    at = np.linspace(max(points["x"].min() - 0.04 * reach, 0.0), points["x"].max() + 0.04 * reach, 300)
    at = at if np.isfinite(one.law.u_offset) or law.exponent > 0 else at[at > 0.5 * points["x"].min()]
    if np.isfinite(theory):
        upper.plot(at, one.by_theory(at), "--", color=THEORY, label="the law that theory says")
    upper.plot(at, law(at), color=LAW, label="power law through the points")
    bars: dict[str, Any] = {"fmt": "o", "color": DATA, "ms": 4, "elinewidth": 1.0, "zorder": 3}
    across = 2 * points["u_x"] if (points["u_x"] > 0).any() else None
    upper.errorbar(points["x"], points["y"], 2 * points["u_y"], across, label="recordings", **bars)
    here = law(points["x"])
    slope = np.gradient(law(at), at)
    spread = 200 * np.hypot(points["u_y"], np.interp(points["x"], at, slope) * points["u_x"]) / here
    left = 100 * (points["y"] - here) / here
    lower.errorbar(points["x"], left, spread, **bars)
    lower.axhline(0, color=LAW, lw=1.0)
    in_view = [left + spread, left - spread]
    if np.isfinite(theory):
        lower.plot(at, 100 * (one.by_theory(at) - law(at)) / law(at), "--", color=THEORY)
        in_view.append(100 * (one.by_theory(points["x"]) - here) / here)
    style.symmetric(lower, np.concatenate(in_view))
    unit = f" ({one.unit.replace('^2', '²')})" if one.unit else ""
    lower.set_xlabel(f"{one.by.replace('_', ' ')}{unit}")
    upper.set_ylabel(_LABELS[one.quantity])
    lower.set_ylabel("data − law (%)")
    for axes in (upper, lower):
        axes.grid(True, axis="y")
        axes.margins(x=0.04)
        axes.ticklabel_format(axis="y", useOffset=False)
    below = f"\ntheory {style.signed(f'{theory:g}')}" if np.isfinite(theory) else "\n"
    exponent = style.signed(value_with_uncertainty(law.exponent, law.u_exponent))
    upper.set_title(f"exponent {exponent}{below}", fontsize=9)


@style.styled
def groups_side_by_side(series: Sequence[Any], emulated: str = "no") -> Figure:
    """A panel for each quantity: recordings of each group, their mean with bars, and the mean of all; groups that stand apart in colour."""
    names = [str(one) for one in series[0].comparison.table["group"]]
    figure = style.new_figure(3.4 + 0.55 * len(names))
    grid = figure.subplots(1, len(series), sharey=True, squeeze=False)[0]
    for axes, one in zip(grid, series, strict=True):
        table = one.comparison.table.set_index("group")
        for place, name in enumerate(names):
            if name not in table.index:
                continue
            own, mean = one.table[one.table["group"] == name], table.loc[name]
            colour = THEORY if name in one.comparison.apart else LAW
            if len(own) > 1:
                values = own.get("y_at_equal", own["y"])
                axes.plot(values, np.full(len(own), place - 0.22), ".", color=style.GREY, ms=4)
            axes.errorbar(
                mean["value"], place, xerr=2 * mean["standard_uncertainty"], color=colour,
                fmt="D" if name in one.comparison.apart else "o", ms=4.5, elinewidth=1.0,
            )  # fmt: skip
        weight = table["standard_uncertainty"] ** -2
        axes.axvline(np.average(table["value"], weights=weight), color=style.FAINT, zorder=0)
        axes.set_xlabel(_LABELS[one.quantity])
        axes.grid(True, axis="x")
        axes.margins(x=0.12)
        axes.set_title(f"equal with {one.comparison.chance}", fontsize=9)
        axes.ticklabel_format(axis="x", useOffset=False)
        axes.locator_params(axis="x", nbins=4)
    grid[0].set_yticks(range(len(names)), names)
    grid[0].set_ylim(len(names) - 0.5, -0.6)
    handles = [style.mark("o", LAW, "mean of a group")]
    if any(one.table["group"].duplicated().any() for one in series):
        handles.append(style.mark(".", style.GREY, "its recordings"))
    if any(one.comparison.apart for one in series):
        handles.append(style.mark("D", THEORY, "stands apart"))
    figure.legend(handles=handles, loc="outside upper left", ncols=3)
    return style.footnote(
        figure,
        "bars: ± 2 standard uncertainties; grey line: mean of all",
        *dict.fromkeys(f"at equal {one}" for each in series for one in each.at_equal),
        *dict.fromkeys(f"the recordings differ in {one}" for each in series for one in each.mixed),
        style.emulated_note({"emulated": emulated}),
    )


def drawn(kind: str, series: Sequence[Any], emulated: str = "no") -> Figure:
    """The figure ``series`` (of the first thing varied) or ``groups``; one that says so where there is nothing to show."""
    chosen = [one for one in series if (one.law if kind == "series" else one.comparison)]
    chosen = [one for one in chosen if one.by == chosen[0].by]
    if not chosen:
        return style.absent("too few recordings have a value and a quantity")
    return (over_what_was_varied if kind == "series" else groups_side_by_side)(chosen, emulated)
