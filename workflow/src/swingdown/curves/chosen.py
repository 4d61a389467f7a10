"""The model that a pendulum's curves are drawn of: that of its fit, or the one that a search ended with."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from ..arrays import Floats
from ..pendulum.catalogue import SHIPPED, Catalogue
from ..pendulum.model import Model
from ..status import Status

Fitted = tuple[Model, Floats]  # a model with its values, and the covariance of its parameters


def of_verdict(
    found: Mapping[str, Any], restoring: str = "sine", catalogue: Catalogue = SHIPPED
) -> Fitted | None:
    """The model of the motion that a verdict concludes with, and its covariance; None where it has none."""
    concluded = found.get("conclusion")
    if not concluded or found["status"] == Status.UNKNOWN:
        return None
    names = [name for name in concluded["model"].split("+") if name not in concluded["left_out"]]
    if any(name not in catalogue for name in names):
        return None
    model = Model(tuple(names), {}, {}, restoring, catalogue=catalogue).motion
    given = {name: concluded["quantities"].get(name, {}).get("value") for name in model.parameters}
    if list(model.parameters) != concluded["parameters"] or None in given.values():
        return None
    covariance = [[np.nan if cell is None else cell for cell in row] for row in concluded["covariance"]]
    return model.with_values(given), np.array(covariance, dtype=float)
