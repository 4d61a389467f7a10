"""How far verdicts can be trusted: what is named where one effect is hidden, and how often by size."""

import numpy as np

from . import style


@style.styled
def confusion(matrix):
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
            axes.text(j, i, f"{100 * share:.0f}", ha="center", va="center", fontsize=7.5, color="white" if share > 0.7 else style.INK)
    axes.set_xticks(range(len(used)), [name.replace("_", " ") for name in used], rotation=60, ha="right", rotation_mode="anchor", fontsize=8)
    axes.set_yticks(range(len(table)), [name.replace("_", " ") for name in table.index], fontsize=8)
    axes.set(xlabel="named (the hidden one, if it is in the tie)", ylabel="hidden")
    axes.spines[:].set_visible(False)
    axes.tick_params(length=0)
    return style.footnote(figure, "percent of the campaigns of a row")


@style.styled
def detection(scores):
    """Shares of right verdicts against the effect's size, and of false alarms and abstentions, with 95 % limits."""
    figure = style.new_figure(8)
    left, right = figure.subplots(1, 2, width_ratios=(1.2, 1))
    single = scores[scores["kind"] == "single"]
    for flag, label, colour, marker in (("exact", "named exactly", "#0072B2", "o"), ("inside", "named, or in a tie of at most four", "#009E73", "s"), ("wrong", "a wrong name", "#D55E00", "D")):
        sizes = sorted(single["ratio"].unique())
        shares = [100 * single.loc[single["ratio"] == ratio, flag].astype(bool).mean() for ratio in sizes]
        left.plot(sizes, shares, marker=marker, ms=5, color=colour, label=label)
    left.set_xscale("log")
    left.set_xticks(sorted(single["ratio"].unique()), [f"{ratio:g}" for ratio in sorted(single["ratio"].unique())], minor=False)
    left.minorticks_off()
    left.set(xlabel="residual of the base model over noise", ylabel="percent of campaigns", ylim=(-4, 104), title="(a) one effect hidden")
    left.legend(loc="center left")
    left.grid(True, axis="y")
    bars = (("null", "alarm", "nothing hidden:\nfalse alarms"), ("removed", "right", "taken out of\nthe catalogue:\nunknown"),
            ("foreign", "right", "in no catalogue:\nunknown"), ("pair", "inside", "two hidden:\nboth named"))  # fmt: skip
    for place, (kind, flag, _) in enumerate(bars):
        part = scores.loc[scores["kind"] == kind, flag].astype(bool)
        if len(part):
            share = 100 * part.mean()
            right.bar(place, share, color="#D55E00" if kind == "null" else "#0072B2", width=0.6)
            right.annotate(f"{part.sum()} of {len(part)}", (place, share), xytext=(0, 3), textcoords="offset points", ha="center", fontsize=8.5)
    right.set_xticks(range(len(bars)), [label for *_, label in bars], fontsize=8)
    right.tick_params(axis="x", length=0)
    right.set(ylim=(0, 112), title="(b) the other trials")
    right.grid(True, axis="y")
    return figure
