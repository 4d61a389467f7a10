"""How far verdicts can be trusted: what is named where one effect is hidden, and how often by size."""

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from . import style


@style.styled
def confusion(matrix: pd.DataFrame) -> Figure:
    """The confusion matrix of single hidden effects: rows what was hidden, columns what was said, shares of each row."""
    table = matrix.set_index("hidden")
    used = [name for name in table.columns if table[name].sum() > 0 or name in table.index]
    table = table[used]
    figure = style.new_figure(14.5)
    axes = figure.subplots()
    shown = np.ma.masked_equal(table.to_numpy(float), 0)
    axes.imshow(shown, cmap="Blues", vmin=0, vmax=1.25, aspect="auto")
    for (i, j), share in np.ndenumerate(table.to_numpy(float)):
        if share > 0:
            ink = "white" if share > 0.7 else style.INK
            axes.text(j, i, f"{100 * share:.0f}", ha="center", va="center", fontsize=7.5, color=ink)
    said, hidden = ([name.replace("_", " ") for name in names] for names in (used, table.index))
    axes.set_xticks(range(len(used)), said, rotation=60, ha="right", rotation_mode="anchor", fontsize=8)
    axes.set_yticks(range(len(table)), hidden, fontsize=8)
    axes.set(xlabel="named (the hidden one, if it is in the tie)", ylabel="hidden")
    axes.spines[:].set_visible(False)
    axes.tick_params(length=0)
    return style.footnote(figure, "percent of the campaigns of a row")


_TRIALS = (  # kind, what is right of it (or an alarm), and in words
    ("null", "alarm", "nothing hidden: false alarms"),
    ("own", "alarm", "own frequencies: false alarms"),
    ("calibrated", "alarm", "volts with a calibration: false alarms"),
    ("removed", "right", "taken out of the catalogue: unknown"),
    ("foreign", "right", "in no catalogue: unknown"),
    ("pair", "inside", "two hidden: both named"),
)
_SAID = (
    ("exact", "named exactly", "#0072B2", "o"),
    ("inside", "named, or in a tie of at most four", "#009E73", "s"),
    ("wrong", "a wrong name", "#D55E00", "D"),
)
_KINDS = {
    "null": "nothing hidden",
    "own": "own frequencies",
    "calibrated": "calibrated",
    "single": "one effect",
    "pair": "two effects",
    "removed": "taken out",
    "foreign": "in no catalogue",
}


@style.styled
def detection(scores: pd.DataFrame) -> Figure:
    """Shares of right verdicts against the effect's size, of false alarms and abstentions, and the time of each campaign."""
    figure = style.new_figure(12)
    grid = figure.add_gridspec(2, 2)
    left, right, below = (figure.add_subplot(place) for place in (grid[0, 0], grid[0, 1], grid[1, :]))
    _by_size(left, scores[scores["kind"] == "single"])
    _others(right, scores)
    _times(below, scores)
    return figure


def _by_size(axes: Axes, single: pd.DataFrame) -> None:
    sizes = sorted(single["ratio"].unique())
    for flag, label, colour, marker in _SAID:
        shares = [100 * single.loc[single["ratio"] == ratio, flag].astype(bool).mean() for ratio in sizes]
        axes.plot(sizes, shares, marker=marker, ms=5, color=colour, label=label)
    axes.set_xscale("log")
    axes.set_xticks(sizes, [f"{ratio:g}" for ratio in sizes], minor=False)
    axes.minorticks_off()
    axes.set(xlabel="residual of the base model over noise", ylabel="percent of campaigns")
    axes.set(ylim=(-4, 104), title="(a) one effect hidden")
    axes.legend(loc="center left")
    axes.grid(True, axis="y")


def _others(axes: Axes, scores: pd.DataFrame) -> None:
    """Bars with what they are written above each, for the words are long."""
    for place, (kind, flag, words) in enumerate(_TRIALS):
        part = scores.loc[scores["kind"] == kind, flag].astype(bool)
        if len(part):
            axes.barh(place, 100 * part.mean(), height=0.4, color="#D55E00" if flag == "alarm" else "#0072B2")
            told = f"{words}, {part.sum()} of {len(part)}"
            style.noted(axes, told, (0, place - 0.22), (2, 2), va="bottom", fontsize=8.5)
    axes.set_yticks([])
    axes.set(xlabel="percent of campaigns", title="(b) the other trials")
    axes.set(xlim=(0, 104), ylim=(len(_TRIALS) - 0.6, -0.75))


def _times(axes: Axes, scores: pd.DataFrame) -> None:
    """A dot for each campaign, moved up and down a little so that many can be seen, and the median."""
    kinds = [kind for kind in _KINDS if (scores["kind"] == kind).any()]
    for place, kind in enumerate(kinds):
        seconds = np.sort(scores.loc[scores["kind"] == kind, "seconds"].to_numpy(float))
        aside = 0.24 * np.sin(2.4 * np.arange(seconds.size))  # no two neighbours at one height
        axes.plot(seconds, place + aside, "o", ms=3, mew=0, color="#0072B2", alpha=0.5)
        axes.plot(np.median(seconds) * np.ones(2), (place - 0.36, place + 0.36), color=style.INK, lw=1.4)
    axes.set_xscale("log")
    style.decimal_log(axes.xaxis)
    axes.set_yticks(range(len(kinds)), [_KINDS[kind] for kind in kinds])
    axes.invert_yaxis()
    axes.set(xlabel="CPU time of a campaign (s); the line is the median", title="(c) time")
    axes.grid(True, axis="x")
