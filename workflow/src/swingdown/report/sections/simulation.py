"""The simulation study."""

from ...studies.simulation import INFERRED_NOTE
from .. import numbers
from ..material import Material
from ..page import Column, Section, Table, cells
from ..wording import groups, model_symbol


def simulation(material: Material) -> Section | None:
    """The simulation study: Table 2 and its figures."""
    table = material.tables.get("table2")
    if table is None:
        return None
    settings = material.settings["simulation"]
    columns = [
        Column("simulated", cell=lambda row: model_symbol(row.simulated)),
        Column("fitted", cell=lambda row: model_symbol(row.fitted)),
        Column("norm, Nelder–Mead", "degrees", "n", lambda row: numbers.spread(row.mean, row.std)),
        Column(
            "norm, least squares",
            "degrees",
            "n",
            lambda row: numbers.spread(row.mean_least_squares, row.std_least_squares),
        ),
        Column("paper", "degrees", "n", lambda row: numbers.spread(row.published_mean, row.published_std)),
        Column("n", "", "n", lambda row: int(row.n)),
    ]
    rows = cells(columns, table.itertuples())
    caption = (
        f"Simulated swings ({settings['realizations']} noisy copies of each, signal to noise {settings['snr']:g}): norm of fit "
        "less noise-free swing, mean ± standard deviation over the copies."
    )
    notes = (INFERRED_NOTE.replace("_", " "),)
    shown = Table(
        "Table 2", caption, columns, rows, notes, groups(table["simulated"]), "tables/table2.csv", "table2"
    )
    return Section("Simulation", [shown, *material.shown("fig02", "fig03", "fig04", "fig05")])
