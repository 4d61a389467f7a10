"""The fitted parameters as a DataFrame, with their uncertainty and where it comes from."""

from collections.abc import Iterable, Iterator, Sequence
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr
from scipy.special import stdtrit

from ..arrays import Floats
from ..measurement.angle import UNSCALED
from ..own_unit import has_size
from ..rounding import value_with_uncertainty
from .norms import as_text

COVERAGE = 1.959963984540054  # standard errors either side: 95 %, where it is not told otherwise
_NEGLIGIBLE = 1e-3  # of a variance
_ERRORS = ("standard_error", "random_standard_error", "systematic_standard_error")
_TOLD = (*_ERRORS, "coverage_factor")


def parameters(norms: xr.Dataset, joint: Iterable[xr.Dataset] = ()) -> pd.DataFrame:
    """A DataFrame with a row for each fitted value of ``results/experiment/norms.nc``, and of the datasets of ``results/experiment/joint``.

    Columns campaign, recording, fitted, parameter, value, standard_error with its random and systematic part, low, high (95 %), unit,
    text. After a campaign's recordings comes ``(mean)``, where there are two or more: its random part is from the scatter between
    recordings, its systematic part the root mean square of theirs. For each dataset of ``joint`` follows ``(joint)``. Readings without a
    scale have no value of a parameter whose size depends on it.
    """
    units = dict(zip(as_text(norms["parameter"]), as_text(norms["parameter_unit"]), strict=True))
    together = {str(one.attrs["campaign"]): one for one in joint}
    rows = []
    for campaign, chosen in norms.groupby("campaign", squeeze=False):
        names = as_text(chosen["recording"])
        unscaled = bool((chosen["uncertainty"] == UNSCALED).all())
        told = _arrays(chosen, ("fitted", "parameter", "recording"))
        for k, label in enumerate(as_text(chosen["fitted"])):
            for n, name in enumerate(units):
                if unscaled and has_size(name, units[name]):
                    continue
                where = {"campaign": campaign, "fitted": label, "parameter": name, "unit": units[name]}
                rows += [row | where for row in _estimates(names, *(every[k, n] for every in told))]
                if campaign in together:
                    shared = together[campaign].sel(fitted=label, parameter=name)
                    errors = (float(shared[key]) if key in shared else np.nan for key in _TOLD)
                    rows.append(_estimate("(joint)", float(shared["value"]), *errors) | where)
    rows = [row for row in rows if np.isfinite(row["value"])]
    order = ("campaign", "recording", "fitted", "parameter", "value", *_ERRORS, "low", "high", "unit", "text")
    return pd.DataFrame(rows, columns=list(order))


def _arrays(fits: xr.Dataset, dims: tuple[str, ...]) -> list[Floats]:
    """Values and what is told of their errors, NaN where nothing is: a selection by name for each row is a thousand times slower."""
    values = fits["value"].transpose(*dims).values
    unknown = np.full(values.shape, np.nan)
    return [values, *(fits[key].transpose(*dims).values if key in fits else unknown for key in _TOLD)]


def _estimates(names: Sequence[str], values: Floats, *errors: Floats) -> Iterator[dict[str, Any]]:
    """A parameter's rows: each recording's, then their mean."""
    for row in zip(names, values, *errors, strict=True):
        yield _estimate(*row)
    if len(names) > 1:
        scatter = values.std(ddof=1) / np.sqrt(values.size)
        shared = np.sqrt(np.mean(errors[2] ** 2))
        whole = np.hypot(scatter, np.nan_to_num(shared))
        dof = (values.size - 1) * (whole / scatter) ** 4 if scatter > 0 else np.inf  # Welch and Satterthwaite
        factor = float(stdtrit(min(dof, 1e9), 0.975))
        yield _estimate("(mean)", values.mean(), whole, scatter, shared, factor)


def _estimate(
    recording: str, value: float, error: float, random: float, systematic: float, factor: float
) -> dict[str, Any]:
    known = dict(zip(_ERRORS, map(float, (error, random, systematic)), strict=True))
    text = value_with_uncertainty(float(value), float(error)) if np.isfinite(value) else ""
    half = (factor if np.isfinite(factor) else COVERAGE) * error
    ends = {"low": float(value - half), "high": float(value + half)}
    return {"recording": recording, "value": float(value), **known, **ends, "text": text}


def parameter_budget(fits: Iterable[xr.Dataset]) -> pd.DataFrame:
    """A DataFrame of where the uncertainty of each campaign's values comes from, a row for each value and source.

    Columns: campaign, fitted, parameter, source, contribution (in the value's unit), share (of the variance), unit. ``random`` is
    noise and what the model misses. Sources of less than a thousandth of the variance are left out. Fits are those of
    ``results/experiment/joint``, and for pendulums of one swing of ``experiment/fits``.
    """
    rows = []
    for one in fits:
        units = dict(zip(as_text(one["parameter"]), as_text(one["parameter_unit"]), strict=True))
        campaign = one.attrs["campaign"] if "campaign" in one.attrs else str(one["campaign"].item())
        errors = {key: one[key].transpose("fitted", "parameter").values for key in _ERRORS[:2]}
        systematic = one["systematic"].transpose("fitted", "parameter", "source").values
        names = as_text(one["source"])
        for k, label in enumerate(as_text(one["fitted"])):
            for n, name in enumerate(units):
                variance = float(errors["standard_error"][k, n]) ** 2
                sources = {"random": float(errors["random_standard_error"][k, n])}
                sources |= dict(zip(names, map(float, systematic[k, n]), strict=True))
                rows += [
                    (campaign, label, name, source, size, size**2 / variance, units[name])
                    for source, size in sources.items()
                    if size**2 > _NEGLIGIBLE * variance
                ]
    columns = ["campaign", "fitted", "parameter", "source", "contribution", "share", "unit"]
    return pd.DataFrame(rows, columns=columns)
