"""Calibration: tower heights and voltages to a line, with its uncertainty in three labelled modes.

- ``paper``: the limits themselves, added and propagated as the paper prints it (Eqs. 7-11 in absolute form);
- ``gum``: limits as distributions, first order, covariances and degrees of freedom (JCGM 100), U = k u;
- ``monte-carlo``: every input drawn once a draw and carried through the whole chain (JCGM 101).
"""

from collections.abc import Sequence

import numpy as np
import pandas as pd
import xarray as xr

from ..errors import InputError
from ..measurement.apparatus import Apparatus
from ..measurement.recording import ingest
from ..measurement.sheet import COLUMNS
from ..measurement.straight_line import FEWEST
from ..measurement.uncertainty import Mean, Propagation, mean_of_samples
from . import layout, modes
from .chain import measurement
from .modes import MODES
from .uncertainty_budget import budget

__all__ = ["MODES", "budget", "calibrate", "tower"]


def calibrate(
    apparatus: Apparatus,
    rest: xr.Dataset | None = None,
    draws: int = 200_000,
    seed: int = 150,
    mode: str = "gum",
) -> tuple[xr.Dataset, pd.DataFrame]:
    """The calibration dataset and the uncertainty budget (DataFrame) of an apparatus.

    A point is flagged where the intervals of GUM and Monte Carlo differ by more than a tenth of a standard uncertainty, or where
    some draws have the drop longer than the arm. Where more than 1 % have, it is left out of the line.

    Parameters
    ----------
    apparatus
        As ``read_apparatus`` returns it.
    rest
        The recording of the pendulum hanging still. Default: the line's own zero.
    draws, seed
        Of the Monte-Carlo mode.
    mode
        The one that is used downstream; all are computed.

    Raises
    ------
    InputError
        If fewer than three points are left, or a recording is not in volts.
    """
    towers = [tower(apparatus, number) for number in range(1, len(apparatus["points"]) + 1)]
    means = [mean_of_samples(record["signal"].values) for record in towers]
    if rest is not None and rest.attrs["campaign"] not in apparatus["campaigns"]:
        rest = None  # another pendulum's
    read = layout.Read(means, _mean_at_rest(rest), _noise(towers, rest))
    dataset, propagation = from_means(apparatus, read, draws, seed)
    emulated = apparatus["emulated"] or any(
        record.attrs["emulated"] == "yes" for record in [*towers, rest] if record is not None
    )
    dataset.attrs |= {
        "emulated": "yes" if emulated else "no",
        "source": f"{apparatus['path']} and the tower records it names",
        "mode": mode,
        "rest_voltage_from": rest.attrs["recording"] if rest is not None else "the line",
    }
    return dataset, budget(propagation)


def from_means(
    apparatus: Apparatus, read: layout.Read, draws: int, seed: int
) -> tuple[xr.Dataset, Propagation]:
    """The calibration dataset and the first-order propagation, from the mean voltages on the towers and at rest.

    Parameters
    ----------
    apparatus
        As ``read_apparatus`` returns it.
    read
        The mean voltages (V) with their uncertainties.
    draws, seed
        Of the Monte-Carlo mode.

    Raises
    ------
    InputError
        If fewer than three points can be used.
    """
    means = read.towers
    points = modes.judge(apparatus, draws, seed)
    used = [k for k in range(len(means)) if not points.refused[k]]
    if len(used) < FEWEST:
        raise InputError(
            f"{apparatus['path']}, key points",
            f"{len(used)} of {len(means)} points can be used: {'; '.join(r for r in points.reasons if r)}",
            f"at least {FEWEST}",
            "use higher towers, or measure the lengths more closely",
        )
    chosen = apparatus.copy()
    chosen["points"] = [apparatus["points"][k] for k in used]
    chain = measurement(chosen, [means[k] for k in used], read.rest, read.noise)
    results = {
        "paper": modes.paper(chosen, chain, read.rest),
        "gum": modes.gum(chain),
        "monte-carlo": modes.monte_carlo(chain, apparatus, read.noise, draws, seed),
    }
    dataset = layout.dataset(apparatus, points, results, read, chain, used)
    dataset.attrs |= {"apparatus": apparatus["name"], "campaigns": ",".join(apparatus["campaigns"])}
    dataset.attrs |= {"draws": draws, "seed": seed}
    return dataset, results["gum"].propagation


def tower(apparatus: Apparatus, number: int) -> xr.Dataset:
    """The recording dataset of one tower height.

    Parameters
    ----------
    apparatus
        As ``read_apparatus`` returns it.
    number
        The point's place in the sheet; the first is 1.

    Raises
    ------
    InputError
        If the recording cannot be used, or is not in volts.
    """
    point = apparatus["points"][number - 1]
    stated = {name: cell for name, cell in point.items() if name in COLUMNS}
    named = {"recording": f"tower_{number}", "campaign": apparatus["campaigns"][0]}
    row = COLUMNS | {"time_unit": "s"} | stated | named | {"signal_unit": "V", "role": "static"}
    return ingest(row, f"{apparatus['path']}, key points[{number}]")


def _mean_at_rest(rest: xr.Dataset | None) -> Mean | None:
    if rest is None:
        return None
    if (unit := rest["signal"].attrs["units"]) != "V":
        raise InputError(
            rest.attrs.get("file", "static record"),
            f"the pendulum at rest is recorded in {unit}",
            "volts, as the tower heights",
            "correct signal_unit, or the recording's campaign",
        )
    return mean_of_samples(rest["signal"].values)


def _noise(towers: Sequence[xr.Dataset], rest: xr.Dataset | None) -> float:
    """The standard deviation (V) of a sample about its mean, pooled over all records in which nothing moves."""
    records = [record["signal"].values for record in [*towers, rest] if record is not None]
    squares = sum(np.sum((x - x.mean()) ** 2) for x in records)
    return float(np.sqrt(squares / sum(len(x) - 1 for x in records)))
