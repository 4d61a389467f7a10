"""The pendulum, what was measured of it, and its calibration."""

from dataclasses import replace

import pandas as pd

from .. import numbers
from ..material import Material
from ..page import Column, Item, Section, Table


def apparatus(material: Material) -> Section:
    """The pendulum, what was measured of it, and how voltage becomes angle."""
    items: list[Item] = list(material.shown("fig01", "fig06", "fig07", "fig08"))
    if (budget := material.tables.get("uncertainty_budget")) is not None:
        items.append(_budget(budget, material))
    return Section("Pendulum and calibration", [*items, *material.shown("fig09")])


def calibration(material: Material) -> Section:
    """How voltage becomes angle, of an apparatus of one's own."""
    items: list[Item] = [replace(one, label="Calibration") for one in material.shown("fig08")]
    if (budget := material.tables.get("uncertainty_budget")) is not None:
        items.append(_budget(budget, material))
    return Section("Calibration", items)


def _budget(budget: pd.DataFrame, material: Material) -> Table:
    quantity = budget["quantity"].iloc[-1]  # the angle of one sample, to which all else leads
    columns = [
        Column("source"),
        Column("limit", style="n"),
        Column("divisor", style="n"),
        Column("u", "standard", "n"),
        Column("unit"),
        Column("sensitivity", style="n"),
        Column("contribution", "mrad", "n"),
        Column("share", "%", "n"),
        Column("kind"),
    ]
    shown = budget[budget["quantity"] == quantity].sort_values("share", ascending=False)
    rows = [
        [
            row.source.replace("_", " "), numbers.plain(row.limit), numbers.plain(row.divisor), numbers.plain(row.standard_uncertainty),
            row.unit, numbers.plain(row.sensitivity), numbers.plain(1e3 * row.contribution, 2), f"{100 * row.share:.1f}", row.kind,
        ]
        for row in shown.itertuples()
    ]  # fmt: skip
    total = 1e3 * (shown["contribution"] ** 2).sum() ** 0.5
    caption = f"What each input contributes to the standard uncertainty of one {quantity.replace('_', ' ')} ({numbers.plain(total)} mrad)."
    notes = (
        "A limit over its divisor is the standard uncertainty; times the sensitivity it is the contribution.",
        "The budgets of the line, of the rest voltage and of the angle at rest are in the same file.",
    )
    place = "tables/uncertainty_budget.csv"
    return Table(
        "Uncertainty budget", caption, columns, rows, notes, (), place, "calibrate", tuple(material.emulated)
    )
