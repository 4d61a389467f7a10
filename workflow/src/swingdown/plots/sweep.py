"""The maps of a sweep: how often the true model is told, over the settings; and what discovery says of a hidden effect."""

import textwrap
from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap, TwoSlopeNorm
from matplotlib.figure import Figure
from matplotlib.image import AxesImage

from . import style

CLAIM = 0.68  # the confidence that the paper names
_MOST_ROWS = 24
_MOST_PANELS = 48
_SCALE = LinearSegmentedColormap.from_list(
    "seldom_often", ["#8268a8", "#cfc6e0", "#ffffff", "#b5dccb", "#1b9471"]
)
_WORDS = {
    "nothing": ("nothing is missing", "#d3d7db"),
    "unknown": ("something, without a name", "#9aa1a8"),
    "named": ("the hidden effect, alone", "#009E73"),
    "among_others": ("the hidden effect, tied or with another", "#8fd0b8"),
    "wrong": ("another effect", "#D55E00"),
    "failed": ("the search failed", "#1f2328"),
}
_CRITERIA = {
    "true_by_norm": "The true model has the lowest norm: RMS of fit − truth, one swing, all models fitted",
    "true_by_bic": "The true model has the lowest BIC: one swing, all models fitted",
    "true_by_ten": "The true model has the lowest mean norm of ten swings, of the paper's four models",
}
_STARTS = {"rest": "fits start at rest at the first sample", "free": "the release is fitted too"}
_AXES = {"snr": "SNR"}


@style.styled
def probability(maps: xr.Dataset, name: str) -> Figure:
    """A map for each simulated model and further setting: one probability (per cent) over the last two numeric axes.

    ``maps`` is what ``sweep.combine.read_maps`` returns, ``name`` one of its probabilities over the axes. White is the
    paper's 68 %, a cross a cell that could not be made. Axes that would make more rows than a page has are shown at their middle
    value, and the figure says so, as it says how many draws a cell has and how wide the widest 95 % interval is.
    """
    data = maps[name]
    if not np.isfinite(data.values).any():
        why = "This sweep has fewer than ten draws a cell, or leaves one of the paper's models out."
        return style.absent(why)
    axes = maps.attrs["axes"].split()
    numeric = [dim for dim in axes if maps[dim].dtype.kind in "fi"]
    x, y = (numeric[-1], numeric[-2]) if len(numeric) > 1 else (numeric[-1] if numeric else axes[-1], None)
    free = "simulated" in axes and "simulated" not in (x, y)
    column = "simulated" if free and maps.sizes["simulated"] < 5 else None
    rest = [dim for dim in axes if dim not in (x, y, column)]
    chosen, rest, fixed = _with_room(maps, rest, _MOST_ROWS)
    rows = list(np.ndindex(*(maps.sizes[dim] for dim in rest)))
    columns = [str(label) for label in maps[column].values] if column else [None]
    tall = maps.sizes[y] if y else 1
    height = len(rows) * max(2.5, 0.52 * tall + 0.75)
    figure = style.new_figure(3.3 + height)
    panels = figure.subplots(len(rows), len(columns), squeeze=False, sharex=True, sharey=True)
    crowded = len(columns) * maps.sizes[x]
    for row, place in zip(panels, rows, strict=True):
        here = chosen | dict(zip(rest, place, strict=True))
        for panel, label in zip(row, columns, strict=True):
            one = data.isel(here).sel({column: label}) if column else data.isel(here)
            values = one.transpose(y, x).values if y else one.values[np.newaxis]
            shown = _map(panel, values, 7.5 if crowded < 20 else 6)
            turned = crowded > 16 or max(len(_text(v)) for v in maps[x].values) * crowded > 60
            panel.set_xticks(range(maps.sizes[x]), [_text(v) for v in maps[x].values], rotation=90 if turned else 0,
                             fontsize=9 if crowded < 20 else 7)  # fmt: skip
            panel.set_yticks(*((range(tall), [_text(v) for v in maps[y].values]) if y else ([], [])))
        told = ", ".join(_told(maps, dim, k) for dim, k in zip(rest, place, strict=True))
        lines = textwrap.wrap(told, 96)
        # keeps the room; the text itself widens no panel
        row[0].set_title("\n".join(" " for _ in lines), fontsize=9, pad=3)
        style.noted(row[0], "\n".join(lines), (0, 1), (0, 4), xycoords="axes fraction", fontsize=9, color=style.GREY,
                    annotation_clip=False, in_layout=False)  # fmt: skip
    for panel, label in zip(panels[0], columns, strict=True):
        if label:
            words = "\n".join(textwrap.wrap(f"{style.name(label)} simulated", 64 // len(columns)))
            style.noted(panel, words, (0.5, 1), (0, 17 if rest else 4), xycoords="axes fraction", ha="center", va="bottom",
                        fontsize=10, color=style.colour(label))  # fmt: skip
    for panel in panels[-1]:
        panel.set_xlabel(_label(maps[x]))
    for row in panels:
        row[0].set_ylabel(_label(maps[y]) if y else "")
    _bar(figure, shown, panels, height)
    figure.suptitle(_CRITERIA[name], x=0.012, ha="left", fontsize=10.5)
    of = "sets of ten draws" if name == "true_by_ten" else "draws"
    return style.footnote(figure, "share of draws, in per cent", _counted(maps, name, of), _STARTS.get(str(maps.attrs.get("start")), ""), _seed(maps),
                          "×: cannot be made" if (maps["made"] == 0).any() else "", f"shown at {', '.join(fixed)}" if fixed else "")  # fmt: skip


def _map(panel: Axes, values: np.ndarray, size: float) -> AxesImage:
    """One map with its numbers."""
    scale, percents = TwoSlopeNorm(CLAIM, 0.0, 1.0), TwoSlopeNorm(100 * CLAIM, 0, 100)
    shown = panel.imshow(100 * values, origin="lower", aspect="auto", cmap=_SCALE, norm=percents)
    for (j, i), value in np.ndenumerate(values):
        text, colour = "×", style.INK
        if np.isfinite(value):
            text, strong = f"{100 * value:.0f}", abs(scale(value) - 0.5) > 0.36
            colour = "white" if strong else style.INK
        panel.text(i, j, text, ha="center", va="center", fontsize=size, color=colour)
    panel.tick_params(length=0)
    panel.spines[:].set_visible(False)
    return shown


def _bar(figure: Figure, shown: AxesImage, panels: np.ndarray, height: float) -> None:
    """The scale, with as many labels as a figure of that height (cm) has room for."""
    short = min(1.0, 6.0 / height)
    bar = figure.colorbar(shown, ax=panels, location="right", shrink=short, aspect=28, pad=0.02)
    ticks = [0, 25, 50, 68, 85, 100] if height > 4 else [0, 68, 100]
    words = {0: "0", 68: "68 %\n(paper)" if height > 4 else "68 % (paper)", 100: "100 %"}
    bar.set_ticks(ticks, labels=[words.get(tick, str(tick)) for tick in ticks])
    bar.outline.set_visible(False)


def _counted(maps: xr.Dataset, name: str, of: str) -> str:
    """How many independent draws a cell has, and how far its probability may be off."""
    n = maps["sets_of_ten" if name == "true_by_ten" else "independent"].where(maps["made"] > 0)
    low, high = int(n.min()), int(n.max())
    wide = float((0.5 * (maps[f"{name}_high_95"] - maps[f"{name}_low_95"])).max())
    told = f"{high}" if low == high else f"{low} to {high}"
    of = of.removesuffix("s") if told == "1" else of
    return f"{told} {of} a cell: 95 % intervals of up to ±{100 * wide:.0f} %"


def _with_room(
    maps: xr.Dataset, rest: Sequence[str], most: int
) -> tuple[dict[str, int], list[str], list[str]]:
    """The middle index of each axis that has no room, the axes that have, and the values shown of the others in words."""
    chosen, rest, fixed = {}, list(rest), []
    while np.prod([maps.sizes[dim] for dim in rest], dtype=int) > most:
        widest = max(rest, key=lambda dim: maps.sizes[dim])
        chosen[widest] = maps.sizes[widest] // 2
        fixed.append(_told(maps, widest, chosen[widest]))
        rest.remove(widest)
    return chosen, rest, fixed


def _seed(maps: xr.Dataset) -> str:
    return f"seed {maps.attrs['seed']}" if "seed" in maps.attrs else ""


@style.styled
def detection(maps: xr.Dataset) -> Figure:
    """What discovery said of a hidden effect, as shares of the campaigns, over the effect's size: a panel for each effect and
    value of the further axes.

    ``maps`` is what ``sweep.combine.read_maps`` returns for a sweep that computes detection. Bars carry the 95 % interval of
    the share that was named. Where no size of the effect leaves as much as was asked for, the bar is hatched and says what it
    does leave; where a campaign could not be made there is none.
    """
    axes = maps.attrs["axes"].split()
    column = "effect" if "effect" in axes else None
    rest = [dim for dim in axes if dim not in ("effect", "size")]
    effects = range(maps.sizes["effect"]) if column else [None]
    chosen, rest, fixed = _with_room(maps, rest, max(1, _MOST_PANELS // len(effects)))
    each = list(np.ndindex(*(maps.sizes[dim] for dim in rest)))
    places = [(effect, place) for effect in effects for place in each]
    wide = min(4, len(places))
    tall = -(-len(places) // wide)
    lines = 1 + len(rest)
    figure = style.new_figure(3.4 + (4.2 + 0.4 * lines) * tall)
    panels = figure.subplots(tall, wide, squeeze=False, sharey=True).ravel()
    for panel in panels[len(places) :]:
        panel.set_visible(False)
    order = [word for word in _WORDS if word in maps["said"].values]
    if "failed" in order and not float(maps["share"].sel(said="failed").max()) > 0:
        order.remove("failed")
    for panel, (effect, place) in zip(panels, places, strict=False):
        here = chosen | dict(zip(rest, place, strict=True)) | ({} if effect is None else {"effect": effect})
        _bars(panel, maps.isel(here), order)
        words = [] if effect is None else [str(maps["effect"].values[effect]).replace("_", " ")]
        words += [_told(maps, dim, k) for dim, k in zip(rest, place, strict=True)]
        panel.set_title("\n".join(words), pad=4, fontsize=9)
    for row in range(tall):
        panels[row * wide].set_ylabel("share of campaigns (%)")
    short, turned = bool((maps["reached"] == 0).any()), maps.sizes.get("size", 1) > 6
    # the panels share it: room for the numbers in each
    panels[0].set_ylim(0, (128 if turned else 112) if short else 100)
    handles = [style.mark("s", _WORDS[word][1], _WORDS[word][0]) for word in order]
    figure.legend(handles=handles, loc="outside upper left", ncols=3, handletextpad=0.4, columnspacing=1.4)
    return style.footnote(figure, "size: RMS that the hidden effect leaves in the base model's fit, over the noise; 0: nothing is hidden",
                          _counted(maps, "named", "campaigns").replace("a cell", "a bar"),
                          "hatched: no size of the effect leaves as much as asked for; the number is what it leaves" if short else "",
                          "×: cannot be made" if (maps["made"] == 0).any() else "", _seed(maps), f"shown at {', '.join(fixed)}" if fixed else "")  # fmt: skip


def _bars(panel: Axes, maps: xr.Dataset, order: Sequence[str]) -> None:
    """The shares of one effect over its sizes, one upon the other."""
    sizes = np.atleast_1d(maps["size"].values if "size" in maps.dims else maps.attrs.get("size", np.nan))
    places, below, turned = np.arange(sizes.size), np.zeros(sizes.size), sizes.size > 6
    for word in ("named", "among_others", "unknown", "wrong", "failed", "nothing"):
        if word in order:
            part = np.nan_to_num(np.atleast_1d(maps["share"].sel(said=word).values))
            panel.bar(places, 100 * part, bottom=100 * below, width=0.78, color=_WORDS[word][1], lw=0)
            below = below + part
    named, low, high = (np.atleast_1d(maps[key].values) for key in ("named", "named_low_95", "named_high_95"))
    made = np.isfinite(named)
    ends = 100 * np.array([(named - low)[made], (high - named)[made]]).clip(0)
    panel.errorbar(places[made], 100 * named[made], ends, fmt="none", ecolor=style.INK, elinewidth=0.8)
    left, reached = np.atleast_1d(maps["left_by_base"].values), np.atleast_1d(maps["reached"].values)
    rotation = 90 if turned else 0
    for k in range(sizes.size):
        if not made[k]:
            panel.text(k, 3, "×", ha="center", va="bottom", fontsize=9)
        elif reached[k] == 0:
            panel.bar(k, 100, width=0.78, fill=False, hatch="////", ec=style.INK, lw=0, alpha=0.45)
            told = f"{left[k]:.2g}"
            panel.text(k, 102.5, told, ha="center", va="bottom", fontsize=7, rotation=rotation)
    panel.set_xticks(places, [_text(v) for v in sizes], rotation=rotation, fontsize=8 if turned else 9)
    panel.set(xlabel="size (σ of the noise)", yticks=range(0, 101, 25))
    panel.tick_params(axis="x", length=0)


MAPS = {
    "by_norm": partial(probability, name="true_by_norm"),
    "by_bic": partial(probability, name="true_by_bic"),
    "by_ten": partial(probability, name="true_by_ten"),
    "detection": detection,
}


def _told(maps: xr.Dataset, dim: str, k: int) -> str:
    """A setting in words: ``release angle 20°``; of an axis that others are coupled to, theirs too."""
    beside = [name for name in maps.coords if maps[name].dims == (dim,) and name != dim]
    return ", ".join(_one_told(maps[name], maps[name].values[k]) for name in (dim, *beside))


def _one_told(coordinate: xr.DataArray, value: Any) -> str:
    label, _, unit = _label(coordinate).partition(" (")
    unit = unit.rstrip(")") if coordinate.dtype.kind in "fi" else ""
    return f"{label} {_text(value)}" + (unit if unit == "°" else f" {unit}" if unit else "")


def _label(coordinate: xr.DataArray) -> str:
    """An axis's name with its unit."""
    name, unit = str(coordinate.name), coordinate.attrs.get("units", "")
    unit = {"degrees": "°", "1": ""}.get(unit, unit)
    words = _AXES.get(name, coordinate.attrs.get("long_name", name.replace("_", " ")))
    return f"{words} ({unit})" if unit else words


def _text(value: Any) -> str:
    if isinstance(value, (float, np.floating, int, np.integer)):
        return f"{value:g}"
    return str(value).replace("_", " ")
