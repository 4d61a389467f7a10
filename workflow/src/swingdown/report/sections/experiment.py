"""The experiment study."""

from collections.abc import Sequence
from dataclasses import replace

import pandas as pd
from markupsafe import Markup

from .. import numbers
from ..material import Material
from ..page import Cell, Column, Item, Section, Table, cells
from ..wording import groups, model_symbol, with_symbols


def experiment(material: Material) -> Section:
    """The experiment study: Table 3, which models differ, the parameters, and the figures."""
    items: list[Item] = []
    if (table := material.tables.get("table3")) is not None:
        items.append(table3(table, material))
    items += material.shown("fig15")
    if (table := material.tables.get("comparison")) is not None:
        items.append(paired(table))
    if (table := material.tables.get("parameters")) is not None:
        items.append(fitted_parameters(table))
    return Section("Experiment", [*items, *material.shown("fig10", "fig11", "fig12", "fig13", "fig14")])


def table3(table: pd.DataFrame, material: Material) -> Table:
    """The models fitted to each swing; in a study of one's own without the paper's column."""
    above = "above the lowest, independent samples"
    columns = [
        Column("campaign", cell=lambda row: row.campaign),
        Column("fitted", cell=lambda row: model_symbol(row.fitted)),
        Column("norm", "degrees", "n", lambda row: numbers.spread(row.mean, row.std)),
        Column("reduced χ²", "", "n", lambda row: numbers.plain(row.reduced_chi2)),
        Column("ΔBIC", above, "n", lambda row: numbers.whole(row.delta_bic_effective)),
        Column("variance inflation", "", "n", lambda row: numbers.whole(row.variance_inflation)),
        Column("n", "", "n", lambda row: int(row.n)),
        Column("paper", "degrees", "n", lambda row: numbers.spread(row.published_mean, row.published_std)),
    ]
    notes = [
        "Norm: RMS of data less fit, mean ± standard deviation over the n swings. BIC: summed over them, for as many samples as "
        "count as independent.",
        "Variance inflation: the factor by which dependent residuals enlarge the squares of the standard errors.",
    ]
    if material.own:
        columns = columns[:-1]
    elif table["published_mean"].notna().any():
        notes.append("The paper's column is for reference: its pendulum is another.")
    for row in table.itertuples():
        about = [part for part in str(row.note).split("; ") if "below 0" in part]
        notes += [
            Markup("{}: {}.").format(model_symbol(row.fitted), part.replace("_", " ")) for part in about
        ]
    if material.emulated:
        notes.append(f"Emulated: {', '.join(material.emulated)}.")
    label, rows = "Models of damping" if material.own else "Table 3", cells(columns, table.itertuples())
    return _by_campaign(label, "The models fitted to each swing.", columns, rows, notes, "table3")


def paired(table: pd.DataFrame) -> Table:
    """Which models differ by more than swings do."""
    pair = Markup("{}\u00a0−\u00a0{}")
    columns = [
        Column("campaign", cell=lambda row: row.campaign),
        Column("models", cell=lambda row: pair.format(model_symbol(row.model_a), model_symbol(row.model_b))),
        Column(
            "difference", "degrees", "n", lambda row: numbers.brief(row.mean_difference, row.standard_error)
        ),
        Column("p", "after Holm", "n", lambda row: numbers.plain(row.p_holm, 2)),
        Column("ΔBIC", "independent samples", "n", lambda row: numbers.whole(row.delta_bic_effective)),
        Column("verdict", cell=lambda row: with_symbols(row.verdict)),
    ]
    caption = "The difference of two models' norms on the same swing: mean (standard error) over the swings."
    notes = ["p: Student's for the mean difference, corrected for the number of pairs."]
    rows = cells(columns, table.itertuples())
    return _by_campaign("Paired comparison", caption, columns, rows, notes, "comparison")


def fitted_parameters(table: pd.DataFrame) -> Table:
    """The fitted parameters of every model."""
    keys = ["campaign", "fitted", "parameter", "unit"]
    columns = [
        Column("campaign"),
        Column("fitted"),
        Column("parameter"),
        Column("mean over swings", style="n"),
        Column("swings together", style="n"),
        Column("unit"),
        Column("std between swings", style="n"),
        Column("standard error of one fit", "median", "n"),
    ]
    rows = []
    for (campaign, fitted, parameter, unit), part in table.groupby(keys, sort=False, dropna=False):
        single = part[~part["recording"].isin(["(mean)", "(joint)"])]
        rows.append([
            campaign, model_symbol(fitted), parameter.replace("_", " "), _estimate(part, "(mean)") or _estimate(single),
            _estimate(part, "(joint)") or "–", unit, numbers.plain(single["value"].std(), 2),
            numbers.plain(single["standard_error"].median(), 2),
        ])  # fmt: skip
    caption = "Fitted parameters; in parentheses the standard error in units of the last digits."
    notes = [
        "Mean over swings: its standard error is from the scatter between swings. Swings together: one fit to all.",
        "Standard errors hold the colour of the residuals, what the calibration leaves open, and the clock: by source in "
        "tables/parameter_budget.csv. Each swing's values: tables/parameters.csv.",
    ]
    # of single swings there is one value and one standard error
    if not table["recording"].isin(["(mean)", "(joint)"]).any():
        columns = [*columns[:3], Column("value", style="n"), columns[5]]
        rows, notes = [[*row[:4], row[5]] for row in rows], notes[1:]
    return _by_campaign("Parameters", caption, columns, rows, notes, "parameters")


def _estimate(part: pd.DataFrame, recording: str | None = None) -> str:
    """``value(standard error)`` of the first row, of one kind of row; nothing where there is none."""
    chosen = part if recording is None else part[part["recording"] == recording]
    if chosen.empty:
        return ""
    row = chosen.iloc[0]
    return numbers.brief(row["value"], row["standard_error"])


def _by_campaign(
    label: str, caption: str, columns: list[Column], rows: list[list[Cell]], notes: Sequence[str], file: str
) -> Table:
    """A table whose first column is the campaign: grouped by it, or without it where there is only one."""
    campaigns = [str(row[0]) for row in rows]
    whole = Table(label, caption, columns, rows, tuple(notes), groups(campaigns), f"tables/{file}.csv", "table3",
                  tuple(dict.fromkeys(campaigns)))  # fmt: skip
    if len(whole.of) > 1:
        return whole
    opened = groups(row[1] for row in rows) if label == "Parameters" else ()
    return replace(whole, columns=columns[1:], rows=[row[1:] for row in rows], groups=opened)
