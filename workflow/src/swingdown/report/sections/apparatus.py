"""The pendulum, what was measured of it, and its calibration."""

from collections.abc import Iterator
from dataclasses import replace

from .. import numbers
from ..material import Material
from ..page import Column, Section, Table, cells


def apparatus(material: Material) -> Section:
    """The pendulum, what was measured of it, and how voltage becomes angle."""
    drawn = material.shown("fig01", "fig06", "fig07", "fig08")
    return Section("Pendulum and calibration", [*drawn, *_budget(material), *material.shown("fig09")])


def calibration(material: Material) -> Section:
    """How voltage becomes angle, of an apparatus of one's own."""
    drawn = [replace(one, label="Calibration") for one in material.shown("fig08")]
    return Section("Calibration", [*drawn, *_budget(material)])


def _budget(material: Material) -> Iterator[Table]:
    """The budget of the angle, where there is one."""
    budget = material.tables.get("uncertainty_budget")
    if budget is None:
        return
    quantity = budget["quantity"].iloc[-1]  # the angle of one sample, to which all else leads
    columns = [
        Column("source", cell=lambda row: row.source.replace("_", " ")),
        Column("limit", "", "n", lambda row: numbers.plain(row.limit)),
        Column("divisor", "", "n", lambda row: numbers.plain(row.divisor)),
        Column("u", "standard", "n", lambda row: numbers.plain(row.standard_uncertainty)),
        Column("unit", cell=lambda row: row.unit),
        Column("sensitivity", "", "n", lambda row: numbers.plain(row.sensitivity)),
        Column("contribution", "mrad", "n", lambda row: numbers.plain(1e3 * row.contribution, 2)),
        Column("share", "%", "n", lambda row: f"{100 * row.share:.1f}"),
        Column("kind", cell=lambda row: row.kind),
    ]
    shown = budget[budget["quantity"] == quantity].sort_values("share", ascending=False)
    rows = cells(columns, shown.itertuples())
    total = 1e3 * (shown["contribution"] ** 2).sum() ** 0.5
    caption = f"What each input contributes to the standard uncertainty of one {quantity.replace('_', ' ')} ({numbers.plain(total)} mrad)."
    notes = (
        "A limit over its divisor is the standard uncertainty; times the sensitivity it is the contribution.",
        "The budgets of the line, of the rest voltage and of the angle at rest are in the same file.",
    )
    place = "tables/uncertainty_budget.csv"
    yield Table(
        "Uncertainty budget", caption, columns, rows, notes, (), place, "calibrate", tuple(material.emulated)
    )
