"""What follows a change: an effect's size in each recording over what was changed, and the law through them."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from ..rounding import value_with_uncertainty
from . import style

_DATA, _LAW = style.INK, "#0072B2"


@style.styled
def over_the_change(found: Mapping[str, Any] | None) -> Figure:
    """The sizes with bars over the values of what was changed, with their power law; a figure that says so where no effect follows."""
    if not found or not found["sizes"]:
        quantity = found["quantity_name"] if found else "change between the recordings"
        return style.absent(f"no effect follows the {quantity}")
    figure = style.new_figure(7.5)
    axes = figure.subplots()
    rows, law, name, in_unit = found["sizes"], found["law"], found["quantity_name"], found["quantity_unit"]
    names = any(isinstance(row["value"], str) for row in rows)
    order = sorted({row["value"] for row in rows})
    x = np.array([order.index(row["value"]) if names else row["value"] for row in rows], dtype=float)
    y = np.array([row["size"] for row in rows])
    bars = np.array([2 * (row["standard_error"] or np.nan) for row in rows])
    axes.errorbar(x, y, bars, fmt="o", color=_DATA, ms=4.5, elinewidth=1.0, zorder=3, label="recordings")
    if names:
        axes.set_xticks(range(len(order)), order)
    if law:
        reach = x.max() - x.min()
        at = np.linspace(max(x.min() - 0.04 * reach, 1e-3 * x.max()), x.max() + 0.04 * reach, 300)
        exponent = style.signed(value_with_uncertainty(law["exponent"], law["u_exponent"]))
        drawn = law["offset"] + law["factor"] * (at / law["at"]) ** law["exponent"]
        words = f"power {exponent}" + (", beside what stays" if law["u_offset"] else "")
        axes.plot(at, drawn, color=_LAW, label=words)
    unit = "" if found["unit"] == "1" else f" ({found['unit'].replace('^2', '²')})"
    axes.set_xlabel(f"{name} ({in_unit})" if in_unit else name)
    axes.set_ylabel(f"{found['parameter'].replace('_', ' ')}{unit}")
    axes.grid(True, axis="y")
    axes.margins(x=0.06)
    axes.ticklabel_format(axis="y", useOffset=False)
    figure.legend(loc="outside upper left", ncols=2)
    widened = "widened to the scatter of the points" if law and law["widened_by"] > 1 else ""
    return style.footnote(figure, "bars: ± 2 standard uncertainties", widened)
