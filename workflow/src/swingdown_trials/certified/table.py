"""All published cases as one table, and what it says of each in a line."""

from pathlib import Path

import pandas as pd

from . import lines, nonlinear, propagation, univariate
from .case import Quantity

KINDS = (nonlinear, univariate, lines, propagation)


def quantities(folder: Path) -> list[Quantity]:
    """The Quantities of every case whose certified values lie in ``folder``; InputError where one is not there."""
    return [one for kind in KINDS for one in kind.quantities(folder)]


def table(found: list[Quantity]) -> pd.DataFrame:
    """Columns case, quantity, unit, certified (as printed), ours, digits, of (the digits printed), draws (of Monte Carlo), source."""
    return pd.DataFrame([
        {"case": one.case, "quantity": one.name, "unit": one.unit, "certified": str(one.certified), "ours": one.ours,
         "digits": one.digits, "of": one.stated, "draws": one.draws, "source": one.source}
        for one in found
    ])  # fmt: skip


def told(found: pd.DataFrame) -> str:
    """For every source the number of quantities, and the one of which ours meets the smallest part of the printed digits."""
    said = []
    for source, rows in found.groupby("source", sort=False):
        least = rows.loc[(rows["digits"] / rows["of"]).idxmin()]
        said.append(
            f"{source}: {len(rows)} quantities, digits met {least.digits:.1f} of {least.of} ({least.case}, {least.quantity})"
        )
    return "\n".join(said)
