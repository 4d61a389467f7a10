"""The maps of a sweep: how often the true model is told, over the settings; and what discovery says of a hidden effect."""

import numpy as np
import xarray as xr
from matplotlib.colors import LinearSegmentedColormap, TwoSlopeNorm
from matplotlib.figure import Figure

from . import style

CLAIM = 0.68  # the confidence that the paper names
_MOST_ROWS = 8
_SCALE = LinearSegmentedColormap.from_list(
    "seldom_often", ["#8268a8", "#cfc6e0", "#ffffff", "#b5dccb", "#1b9471"]
)
_WORDS = {
    "nothing": ("nothing is missing", "#d3d7db"),
    "unknown": ("something, without a name", "#9aa1a8"),
    "named": ("the hidden effect, alone", "#009E73"),
    "among_others": ("the hidden effect, tied or with another", "#8fd0b8"),
    "wrong": ("another effect", "#D55E00"),
    "failed": ("failed", "#1f2328"),
}
_CRITERIA = {
    "true_by_norm": "The true model has the lowest norm: RMS of fit − truth, one swing, all models fitted",
    "true_by_bic": "The true model has the lowest BIC: one swing, all models fitted",
    "true_by_ten": "The true model has the lowest mean norm of ten swings, of the paper's four models",
}
_AXES = {
    "snr": "SNR",
    "duration_s": "duration (s)",
    "release_angle_deg": "release angle (°)",
    "sampling_rate_hz": "sampling rate (Hz)",
}


def by_norm(maps: xr.Dataset) -> Figure:
    """How often the true model has the lowest norm; see ``probability``."""
    return probability(maps, "true_by_norm")


def by_bic(maps: xr.Dataset) -> Figure:
    """How often the true model has the lowest BIC; see ``probability``."""
    return probability(maps, "true_by_bic")


def by_ten(maps: xr.Dataset) -> Figure:
    """How often the true model has the lowest mean norm of ten runs, as the paper compares; see ``probability``."""
    return probability(maps, "true_by_ten")


@style.styled
def probability(maps: xr.Dataset, name: str) -> Figure:
    """A map for each simulated model and further setting: one probability (per cent) over the last two numeric axes.

    ``maps`` is what ``sweep.combine.read_maps`` returns, ``name`` one of its probabilities over the axes. White is the
    paper's 68 %. Axes that would make more rows than a page has are shown at their first value, and the figure says so.
    """
    data = maps[name]
    if not np.isfinite(data.values).any():
        return style.absent(
            "This sweep has fewer than ten draws a cell, or leaves one of the paper's models out."
        )
    axes = maps.attrs["axes"].split()
    numeric = [dim for dim in axes if maps[dim].dtype.kind in "fi"]
    x, y = (numeric[-1], numeric[-2]) if len(numeric) > 1 else (numeric[-1] if numeric else axes[-1], None)
    column = "simulated" if "simulated" in axes and "simulated" not in (x, y) else None
    rest = [dim for dim in axes if dim not in (x, y, column)]
    fixed = []
    while np.prod([maps.sizes[dim] for dim in rest]) > _MOST_ROWS:
        widest = max(rest, key=lambda dim: maps.sizes[dim])
        fixed.append(_told(widest, maps[widest].values[0]))
        data = data.isel({widest: 0})
        rest.remove(widest)
    rows = list(np.ndindex(*(maps.sizes[dim] for dim in rest)))
    columns = [str(label) for label in maps[column].values] if column else [None]
    tall = maps.sizes[y] if y else 1
    figure = style.new_figure(2.6 + len(rows) * max(1.9, 0.52 * tall + 0.55))
    panels = figure.subplots(len(rows), len(columns), squeeze=False, sharex=True, sharey=True)
    scale = TwoSlopeNorm(CLAIM, 0.0, 1.0)
    for row, place in zip(panels, rows, strict=True):
        chosen = data.isel(dict(zip(rest, place, strict=True)))
        for panel, label in zip(row, columns, strict=True):
            one = chosen.sel({column: label}) if column else chosen
            values = one.transpose(y, x).values if y else one.values[np.newaxis]
            shown = panel.imshow(
                100 * values,
                origin="lower",
                aspect="auto",
                cmap=_SCALE,
                norm=TwoSlopeNorm(100 * CLAIM, 0, 100),
            )
            for (j, i), value in np.ndenumerate(values):
                strong = abs(scale(value) - 0.5) > 0.36 if np.isfinite(value) else False
                text = f"{100 * value:.0f}" if np.isfinite(value) else "–"
                panel.text(
                    i, j, text, ha="center", va="center", fontsize=7.5, color="white" if strong else style.INK
                )
            panel.set_xticks(range(maps.sizes[x]), [_text(v) for v in maps[x].values])
            panel.set_yticks(*((range(tall), [_text(v) for v in maps[y].values]) if y else ([], [])))
            panel.tick_params(length=0)
            panel.spines[:].set_visible(False)
        told = ", ".join(_told(dim, maps[dim].values[k]) for dim, k in zip(rest, place, strict=True))
        row[0].set_title(told, fontsize=9, color=style.GREY, pad=3)
    for panel, label in zip(panels[0], columns, strict=True):
        if label:
            panel.annotate(f"{style.name(label)} simulated", (0.5, 1), xytext=(0, 17), xycoords="axes fraction",
                           textcoords="offset points", ha="center", fontsize=10, color=style.colour(label))  # fmt: skip
    for panel in panels[-1]:
        panel.set_xlabel(_label(x))
    for row in panels:
        row[0].set_ylabel(_label(y) if y else "")
    bar = figure.colorbar(
        shown, ax=panels, location="right", shrink=min(1.0, 6.0 / (len(rows) * 2)), aspect=28, pad=0.02
    )
    bar.set_ticks([0, 25, 50, 68, 85, 100], labels=["0", "25", "50", "68 %\n(paper)", "85", "100 %"])
    bar.outline.set_visible(False)
    figure.suptitle(_CRITERIA[name], x=0.012, ha="left", fontsize=10.5)
    seed = f"seed {maps.attrs['seed']}" if "seed" in maps.attrs else ""
    return style.footnote(
        figure,
        "share of draws, in per cent",
        f"{maps.attrs['realizations']} draws a cell",
        seed,
        f"shown at {', '.join(fixed)}" if fixed else "",
    )


@style.styled
def detection(maps: xr.Dataset) -> Figure:
    """What discovery said of a hidden effect, as shares of the campaigns, over the effect's size: a panel for each effect.

    ``maps`` is what ``sweep.combine.read_maps`` returns for a sweep that computes detection. Bars carry the standard
    error of the share that was named.
    """
    axes = maps.attrs["axes"].split()
    fixed = [dim for dim in axes if dim not in ("effect", "size")]
    share = maps["share"].isel(dict.fromkeys(fixed, 0))
    effects = [str(name) for name in np.atleast_1d(maps["effect"].values)] if "effect" in axes else [None]
    sizes = maps["size"].values if "size" in axes else np.array([np.nan])
    n = int(maps.attrs["realizations"])
    wide = min(4, len(effects))
    tall = -(-len(effects) // wide)
    figure = style.new_figure(2.4 + 4.6 * tall)
    panels = figure.subplots(tall, wide, squeeze=False, sharey=True).ravel()
    for panel in panels[len(effects) :]:
        panel.set_visible(False)
    order = [
        word
        for word in _WORDS
        if word in maps["said"].values and (word != "failed" or float(share.sel(said=word).max()) > 0)
    ]
    for panel, effect in zip(panels, effects, strict=False):
        one = share.sel(effect=effect) if effect is not None else share
        below = np.zeros(sizes.size)
        for word in ("named", "among_others", "unknown", "wrong", "failed", "nothing"):
            if word not in order:
                continue
            part = np.atleast_1d(one.sel(said=word).values)
            panel.bar(
                range(sizes.size), 100 * part, bottom=100 * below, width=0.78, color=_WORDS[word][1], lw=0
            )
            if word == "named":
                error = 100 * np.sqrt(part * (1 - part) / n)
                panel.errorbar(
                    range(sizes.size),
                    100 * part,
                    error,
                    fmt="none",
                    ecolor=style.INK,
                    elinewidth=0.8,
                    capsize=2,
                )
            below = below + part
        panel.set_xticks(range(sizes.size), [_text(v) for v in sizes])
        panel.set(ylim=(0, 100), xlabel="size (σ of the noise)")
        panel.set_title((effect or "").replace("_", " "), pad=4)
        panel.tick_params(axis="x", length=0)
    for row in range(tall):
        panels[row * wide].set_ylabel("share of campaigns (%)")
    handles = [style.mark("s", _WORDS[word][1], _WORDS[word][0]) for word in order]
    figure.legend(handles=handles, loc="outside upper left", ncols=3, handletextpad=0.4, columnspacing=1.4)
    seed = f"seed {maps.attrs['seed']}" if "seed" in maps.attrs else ""
    at = ", ".join(_told(dim, maps[dim].values[0]) for dim in fixed)
    return style.footnote(
        figure,
        "size: RMS that the hidden effect leaves in the base model's fit, over the noise; 0: nothing is hidden",
        f"{n} campaigns a bar",
        seed,
        f"shown at {at}" if at else "",
    )


MAPS = {function.__name__: function for function in (by_norm, by_bic, by_ten, detection)}


def _told(dim: str, value: object) -> str:
    """A setting in words: ``release angle 20°``."""
    label, _, unit = _label(dim).partition(" (")
    unit = unit.rstrip(")")
    return f"{label} {_text(value)}" + (unit if unit == "°" else f" {unit}" if unit else "")


def _label(dim: str) -> str:
    return _AXES.get(dim, str(dim).replace("_", " "))


def _text(value: object) -> str:
    return (
        f"{value:g}"
        if isinstance(value, (float, np.floating, int, np.integer))
        else str(value).replace("_", " ")
    )
