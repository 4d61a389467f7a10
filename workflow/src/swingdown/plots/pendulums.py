"""The pendulums of a study side by side."""

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from ..status import Status
from . import style

# Status of the verdict: marker, colour and words. Colours that any colour vision tells apart, and never the colour alone.
LOOKS = {
    Status.CONSISTENT: ("o", "#009E73", "nothing missing"),
    Status.NAMED: ("D", "#0072B2", "named"),
    Status.AMBIGUOUS: ("s", "#56B4E9", "tied"),
    Status.PARTIAL: ("^", "#CC79A7", "named in part"),
    Status.UNKNOWN: ("X", "#D55E00", "unknown"),
    "": ("o", style.GREY, "not searched"),
}
_COLUMNS = (("period_s", "period (s)"), ("quality", "quality Q"), ("decay_time_s", "decay time (s)"))


@style.styled
def side_by_side(table: pd.DataFrame) -> Figure:
    """Period, quality and decay time of every row, with bars of ± 2 standard uncertainties, and the verdict as the marker.

    ``table`` is ``results/tables/pendulums.csv``; rows without a model (files that could not be used) are named below.
    """
    table = table if "label" in table else table.assign(label=table["recording"])
    shown = table[table["model"].notna()].reset_index(drop=True)
    left = table.loc[table["model"].isna(), "label"].astype(str)
    figure = style.new_figure(3.4 + 0.42 * len(shown))
    grid = figure.subplots(1, len(_COLUMNS), sharey=True)
    status = shown["verdict"].astype(object).fillna("").astype(str)
    for axes, (column, label) in zip(grid, _COLUMNS, strict=True):
        each = zip(shown.index, shown[column], shown[f"{column}_u"], status, strict=True)
        for place, value, error, kind in each:
            marker, colour, _ = LOOKS.get(kind, LOOKS[""])
            reach = 2 * error if np.isfinite(error) else 0.0
            axes.errorbar(value, place, xerr=reach, fmt=marker, color=colour, ms=4.5, elinewidth=1.0)
        axes.set_xlabel(label)
        axes.grid(True, axis="x")
        axes.tick_params(axis="y", length=0)
        axes.margins(x=0.12)
    names = [
        f"{campaign}: together" if name == "(joint)" else str(name)
        for campaign, name in zip(shown["campaign"], shown["label"], strict=True)
    ]
    grid[0].set_yticks(shown.index, names)
    grid[0].set_ylim(len(shown) - 0.4, -0.6)
    kinds = [kind for kind in LOOKS if kind in set(status)]
    handles = [style.mark(*LOOKS[kind]) for kind in kinds]
    figure.legend(handles=handles, loc="outside upper left", ncols=len(handles))
    emulated = {"emulated": "yes" if (shown["emulated"] == "yes").any() else "no"}
    lost = f"could not be used: {', '.join(left)}" if len(left) else ""
    return style.footnote(figure, "bars: ± 2 standard uncertainties", lost, style.emulated_note(emulated))
