"""The simulation study."""

from ...studies.simulation import INFERRED_NOTE
from .. import numbers
from ..material import Material
from ..page import Cell, Column, Section, Table
from ..wording import groups, model_symbol


def simulation(material: Material) -> Section | None:
    """The simulation study: Table 2 and its figures."""
    table = material.tables.get("table2")
    if table is None:
        return None
    settings = material.settings["simulation"]
    columns = [
        Column("simulated"),
        Column("fitted"),
        Column("norm, Nelder–Mead", "degrees", "n"),
        Column("norm, least squares", "degrees", "n"),
        Column("paper", "degrees", "n"),
        Column("n", style="n"),
    ]
    rows: list[list[Cell]] = [
        [
            model_symbol(row.simulated),
            model_symbol(row.fitted),
            numbers.spread(row.mean, row.std),
            numbers.spread(row.mean_least_squares, row.std_least_squares),
            numbers.spread(row.published_mean, row.published_std),
            int(row.n),
        ]
        for row in table.itertuples()
    ]
    caption = (
        f"Simulated swings ({settings['realizations']} noisy copies of each, signal to noise {settings['snr']:g}): norm of fit "
        "less noise-free swing, mean ± standard deviation over the copies."
    )
    notes = (INFERRED_NOTE.replace("_", " "),)
    shown = Table(
        "Table 2", caption, columns, rows, notes, groups(table["simulated"]), "tables/table2.csv", "table2"
    )
    return Section("Simulation", [shown, *material.shown("fig02", "fig03", "fig04", "fig05")])
