"""An answer on one pendulum: it prints itself, draws itself, and goes to a dict."""

import base64
import io
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from html import escape
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from ..arrays import Shown
from ..discovery.verdict import noise_rms
from ..rounding import value_with_uncertainty
from ..studies.pendulums import by_verdict, in_order, residual_of
from ..studies.words import lines, quantity_rows


@dataclass(frozen=True)
class Answer:
    """What was found of one pendulum.

    ``swings``: its angles (rad) as datasets, the release cut off where it was held in a hand. ``fits``: every model of damping
    fitted to each swing (``studies.experiment``). ``table``: a row for each swing, and one for all together where there are
    several, as ``studies.pendulums`` makes them. ``verdict``: as verdict.json has it; None after ``fit``.
    """

    swings: tuple[xr.Dataset, ...]
    fits: xr.Dataset = field(repr=False)
    table: pd.DataFrame = field(repr=False)
    shown: tuple[Shown, ...] = field(repr=False)
    verdict: Mapping[str, Any] | None = field(default=None, repr=False)

    @property
    def row(self) -> Mapping[str, Any]:
        """The table's row of the pendulum: of its swing, or of all its swings together."""
        return self.table.iloc[-1].to_dict()

    @property
    def model(self) -> str:
        """The label of the model of damping that describes the pendulum."""
        return str(self.row["model"])

    @property
    def quantities(self) -> dict[str, tuple[float, float, str]]:
        """Value, standard uncertainty and unit of each quantity by name; at the amplitude ``row["amplitude_rad"]``."""
        return {
            one.name: (one.value, one.uncertainty, one.unit) for one in quantity_rows(self.row, self.verdict)
        }

    @property
    def remarks(self) -> list[str]:
        """What is to be known of the swings as given, a line each."""
        told = [
            (one.attrs["recording"], one.attrs["remarks"]) for one in self.swings if one.attrs.get("remarks")
        ]
        return [f"{name}: {text}" for name, text in told]

    def with_verdict(self, found: Mapping[str, Any], shown: tuple[Shown, ...]) -> "Answer":
        """The same answer with a verdict, and with what its last model makes of the swings."""
        table = self.table.copy().astype(object)
        row = by_verdict(self.table.iloc[-1].to_dict(), found)
        table = pd.concat([table.iloc[:-1], pd.DataFrame([row])], ignore_index=True)
        return replace(self, verdict=found, shown=shown, table=in_order(table))

    def __str__(self) -> str:
        return "\n".join([*self.remarks, *lines(self.row, self.verdict)])

    def __repr__(self) -> str:
        return str(self)

    def plot(self) -> Any:
        """A matplotlib Figure: the swings with the fit, and what it leaves."""
        from ..plots.answer import swings_with_fit

        noise = noise_rms(self.verdict) if self.verdict else None
        return swings_with_fit(self.shown, noise, {"emulated": self.row["emulated"]})

    def to_dict(self) -> dict[str, Any]:
        """Plain numbers, texts and lists: quantities, model, verdict."""
        row = self.row
        return {
            "recordings": [str(one.attrs["recording"]) for one in self.swings],
            "amplitude_rad": float(row["amplitude_rad"]),
            "quantities": {
                one.name: {
                    "value": one.value,
                    "standard_uncertainty": one.uncertainty if np.isfinite(one.uncertainty) else None,
                    "unit": one.unit,
                    "text": value_with_uncertainty(one.value, one.uncertainty),
                }
                for one in quantity_rows(row, self.verdict)
            },
            "model": self.model,
            "residual": {"value": residual_of(row)[0], "unit": residual_of(row)[1]},
            "residual_rad": float(row["residual_rad"]) if residual_of(row)[1] == "rad" else None,
            "emulated": row["emulated"] == "yes",
            "remarks": self.remarks,
            "verdict": dict(self.verdict) if self.verdict else None,
        }

    def _repr_html_(self) -> str:
        picture = io.BytesIO()
        self.plot().savefig(picture, format="png", dpi=110)
        source = base64.b64encode(picture.getvalue()).decode()
        rows = "".join(
            f"<tr><td style='text-align:left'>{escape(one.words)}</td>"
            f"<td>{escape(value_with_uncertainty(one.value, one.uncertainty))}</td>"
            f"<td style='text-align:left'>{escape('' if one.unit == '1' else one.unit)} {escape(one.condition)}</td></tr>"
            for one in quantity_rows(self.row, self.verdict)
        )
        said = [*self.remarks, *lines(self.row, self.verdict)[-1:]] if self.verdict else self.remarks
        return (
            "".join(f"<p>{escape(line)}</p>" for line in said)
            + f"<table>{rows}</table><img alt='the swings with the fit' src='data:image/png;base64,{source}'>"
        )
