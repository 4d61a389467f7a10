"""g with its budget, and how the pendulums' quantities go with what was varied between them."""

import math
from collections.abc import Iterator

import pandas as pd

from ...language import capital
from .. import numbers
from ..material import Material
from ..page import Cell, Column, Figure, Item, Section, Table, Text
from . import FEW


def series(material: Material) -> Section | None:
    """The sentence of each law and the figures, then g of each pendulum; of a few pendulums with the budget of its uncertainty."""
    laws, budget = (material.tables.get(name) for name in ("laws", "g_budget"))
    items: list[Item] = []
    campaigns = tuple(dict.fromkeys(str(one["campaign"]) for one in material.recordings))
    if laws is not None and len(laws):
        items += [Text(f"{capital(str(one))}.") for one in laws["sentence"]]
        for name in ("series", "groups"):
            if name in material.figures:
                told = *material.figures[name], f"figures/{name}.svg", "series_figure"
                items.append(Figure(name.capitalize(), *told, campaigns))
    if budget is not None and len(budget):
        items += _of_g(budget, campaigns)
    return Section("g and series", items) if items else None


def _of_g(budget: pd.DataFrame, campaigns: tuple[str, ...]) -> Iterator[Table]:
    several = budget["recording"].nunique() > FEW
    rows: list[list[Cell]] = [
        [
            *([str(one["recording"])] if budget["recording"].nunique() > 1 else []),
            str(one["quantity"]),
            numbers.plain(one["value"]) if math.isnan(one["standard_uncertainty"]) else numbers.brief(one["value"], one["standard_uncertainty"]),
            "" if one["unit"] == "1" else str(one["unit"]),
            "" if math.isnan(one["contribution_m_per_s2"]) else f"{1e3 * one['contribution_m_per_s2']:.2g}",
            str(one["note"]) if isinstance(one["note"], str) else "",
        ]
        for one in budget.to_dict("records")
        if not several or one["quantity"] == "g"
    ]  # fmt: skip
    head = [Column("recording")] if budget["recording"].nunique() > 1 else []
    columns = [
        *head,
        Column("quantity"),
        Column("value", style="n"),
        Column("unit"),
        Column("contribution", "mm/s²", "n"),
        Column(""),
    ]
    caption = "Each input, and what it contributes to the standard uncertainty of g."
    if several:
        caption = "g of each pendulum; the table behind it has each budget."
    yield Table("g", caption, columns, rows, (), (), "tables/g_budget.csv", "series", campaigns)
