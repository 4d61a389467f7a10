"""The sentences that open the report."""

import pandas as pd
from markupsafe import Markup

from ...fitting.nested import contains
from ...studies.comparison import WORTH
from ...studies.words import model_words
from .. import numbers
from ..material import Material
from ..page import Findings, Section
from ..wording import model_symbol, with_symbols


def findings(material: Material) -> Section:
    """The sentences that open the report."""
    lines = [f"{found['campaign']}: {found['sentence']}" for found in material.verdicts]
    table, comparison = material.tables.get("table3"), material.tables.get("comparison")
    for campaign, rows in table.groupby("campaign", sort=False) if table is not None else ():
        lines += _experiment_findings(campaign, rows, comparison)
    if (table := material.tables.get("table2")) is not None:
        compared = table.dropna(subset=["published_mean", "published_std"])
        inside = (compared["mean"] - compared["published_mean"]).abs() <= compared["published_std"]
        lines.append(
            f"Simulation: {inside.sum()} of the {len(compared)} mean norms of the paper's Table 2 are reproduced within its own "
            "standard deviation, with settings inferred from that table."
            if len(compared)
            else f"Simulation: {len(table)} mean norms, which the paper does not report."
        )
    return Section("Findings", [Findings(lines)] if lines else [])


def _experiment_findings(campaign: str, rows: pd.DataFrame, comparison: pd.DataFrame) -> list[str]:
    models = rows[rows["fitted"] != "error_bounds"].set_index("fitted")
    if models.empty:
        return []
    pairs = comparison[comparison["campaign"] == campaign]
    lowest = models["bic"].idxmin()
    label = simplest(lowest, pairs)
    best, swings = models.loc[label], int(models.loc[label, "n"])
    them = "swing" if swings == 1 else f"{swings} swings"
    words = f"{campaign}: {{}} ({model_words(label)}) describes the {them} best; it leaves {{}}° RMS."
    lines: list[str] = [Markup(words).format(model_symbol(label), numbers.spread(best["mean"], best["std"]))]
    if label != lowest:
        further = "{}: {} comes closer still, by terms that are not worth their parameters."
        lines.append(Markup(further).format(campaign, model_symbol(lowest)))
    for row in pairs[(pairs["model_a"] == label) | (pairs["model_b"] == label)].itertuples():
        if "indistinguishable" in row.verdict:
            lines.append(with_symbols(f"{campaign}: {row.verdict}."))
    if pd.notna(best["reduced_chi2"]):
        words = f"{campaign}: what it leaves is {numbers.plain(best['reduced_chi2'])} times the variance that the angle's random "
        lines.append(f"{words}uncertainty explains (reduced χ²); a complete model leaves 1.")
    bound = rows[rows["fitted"] == "error_bounds"]
    if bound["mean"].notna().any():
        mean, std = bound["mean"].iloc[0], bound["std"].iloc[0]
        within, size = "within" if best["mean"] <= mean else "above", f"{numbers.spread(mean, std)}°"
        lines.append(
            f"{campaign}: it is {within} the paper's benchmark, the bounds of the measured angle ({size})."
        )
    return lines


def simplest(label: str, pairs: pd.DataFrame) -> str:
    """The smallest model inside ``label`` that its further terms do not improve by more than they cost."""
    enough = [
        (row.model_a, row.mean_difference)
        for row in pairs.itertuples()
        if row.model_b == label and contains(label, row.model_a) and row.delta_bic_effective <= WORTH
    ]
    return min(enough, key=lambda found: (found[0].count("+"), found[1]))[0] if enough else label
