"""The uncertainty budget of a calibration: how much each source does to each output."""

import numpy as np
import pandas as pd

from ..measurement.uncertainty import Propagation
from .chain import OUTPUTS


def budget(propagation: Propagation) -> pd.DataFrame:
    """The uncertainty budget, a row for each output and source: limit, divisor, u, sensitivity, contribution, share.

    ``contribution`` is sensitivity times u, in the output's unit; ``share`` the source's part of the output's variance.

    Parameters
    ----------
    propagation
        The first-order propagation, as ``from_means`` returns it.
    """
    units = dict(zip(OUTPUTS, ("rad", "rad/V", "V", "rad", "rad"), strict=True))
    rows = []
    for k, quantity in enumerate(OUTPUTS):
        variance = np.sum(propagation.contributions[k] ** 2)
        for i, source in enumerate(propagation.inputs):
            contribution = propagation.contributions[k, i]
            if contribution == 0:
                continue
            rows.append(
                {
                    "quantity": quantity,
                    "source": source.name,
                    "limit": source.limit,
                    "unit": source.unit,
                    "distribution": source.distribution,
                    "divisor": source.divisor,
                    "standard_uncertainty": source.standard_uncertainty,
                    "dof": source.dof,
                    "sensitivity": propagation.sensitivity[k, i],
                    "contribution": contribution,
                    "contribution_unit": units[quantity],
                    "share": contribution**2 / variance,
                    "kind": source.kind,
                }
            )
    return pd.DataFrame(rows)
