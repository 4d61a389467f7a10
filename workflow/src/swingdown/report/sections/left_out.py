"""The recordings that were left out, each with its reason."""

from ...studies.left_out import OF_ALL
from ..material import Material
from ..page import Column, Section, Table


def left_out(material: Material) -> Section | None:
    """A row for each recording that could not be used, or whose campaign could not be searched; None where all could."""
    table = material.tables.get("left_out")
    if table is None or table.empty:
        return None
    rows = [
        [row["recording"], row["campaign"], row["file"], row["left_out_of"], row["problem"], row["mend"]]
        for row in table.astype(object).fillna("").astype(str).to_dict("records")
    ]
    columns = [Column(name) for name in ("recording", "campaign", "file", "left out of", "why", "mend")]
    caption = (
        "Recordings that the results leave out. Mend one and run the same command again: it then takes part."
    )
    shown = Table("Left out", caption, columns, rows, link="tables/left_out.csv", rule="left_out")
    return Section("Recordings left out", [shown])


def notice(material: Material) -> list[str]:
    """A line that a reader must see first, where recordings could not be used; else none."""
    table = material.tables.get("left_out")
    lost = [] if table is None else list(table.loc[table["left_out_of"] == OF_ALL, "recording"].astype(str))
    if not lost:
        return []
    were = "recordings were" if len(lost) > 1 else "recording was"
    return [f"{len(lost)} {were} left out: {', '.join(lost)}. “Recordings left out” says why."]
