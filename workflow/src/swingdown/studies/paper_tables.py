"""The paper's Tables 2 and 3 as DataFrames at full precision.

Norms are in degrees. The paper's printed numbers stand beside the computed ones (``resources/paper``).
"""

from collections.abc import Iterator, Sequence

import numpy as np
import pandas as pd
import xarray as xr

from ..arrays import Floats
from ..measurement.angle import UNSCALED
from .comparison import bic_effective
from .norms import as_text, over

PAPER = {"snr": 50, "noise": "proportional", "stream": "R", "seed": 150, "natural_frequency": 7.25, "viscous_ratio": 0.03,
         "quadratic_coefficient": 0.05, "load_friction": 0.012, "release_angle_deg": 20, "sampling_rate_hz": 100,
         "duration_s": 5, "start": "rest", "restoring": "sine", "form": "consistent"}  # fmt: skip
OTHER_APPARATUS = "published: the paper's own apparatus, not this"


def table2(norms: xr.Dataset, published: pd.DataFrame) -> pd.DataFrame:
    """Table 2 of the paper, computed and published.

    Mean and std (n - 1) are over realisations, by the paper's Nelder-Mead and by trajectory least squares; the std itself is known to
    std/sqrt(2 (n - 1)).

    Parameters
    ----------
    norms
        The dataset ``results/simulation/norms.nc``.
    published
        The paper's twelve cells.

    Returns
    -------
    pandas.DataFrame
        Columns simulated, fitted, mean, std, n, published_mean, published_std, mean_least_squares, std_least_squares,
        standard_error_of_std, unit, note. Rows are those of the paper's cells that were computed, or every cell if none was. The note names
        what was inferred, and which settings are not those of the paper.
    """
    printed = published.set_index(["simulated", "fitted"])
    computed = [(s, f) for s in norms["simulated"].values for f in norms["fitted"].values]
    cells = [cell for cell in printed.index if cell in computed] or computed
    settings, count = norms.attrs, norms.sizes["realization"]
    unlike = [key for key, usual in PAPER.items() if key in settings and settings[key] != usual]
    changed = [f"{key} {settings[key]}" for key in unlike] + (
        [f"{count} realisations"] if count != 10 else []
    )
    other = f" Other settings than for the published table: {', '.join(changed)}." if changed else ""
    note, rows = settings.get("inferred", "") + other, []
    for simulated, fitted in cells:
        chosen = norms.sel(simulated=simulated, fitted=fitted)
        mean, std, n = statistics(chosen["norm"].values)
        mean_ls, std_ls, _ = statistics(chosen["least_squares_norm"].values)
        known = printed.loc[(simulated, fitted)] if (simulated, fitted) in printed.index else {}
        rows.append({
            "simulated": simulated, "fitted": fitted, "mean": mean, "std": std, "n": n,
            "published_mean": known.get("mean_degrees", np.nan), "published_std": known.get("std_degrees", np.nan),
            "mean_least_squares": mean_ls, "std_least_squares": std_ls,
            "standard_error_of_std": std / np.sqrt(2 * (n - 1)) if n > 1 else np.nan, "unit": "degrees", "note": note,
        })  # fmt: skip
    return pd.DataFrame(rows)


def table3(norms: xr.Dataset, published: pd.DataFrame) -> pd.DataFrame:
    """Table 3 of the paper, computed and published.

    Parameters
    ----------
    norms
        The dataset ``results/experiment/norms.nc``.
    published
        The paper's eight rows.

    Returns
    -------
    pandas.DataFrame
        Columns campaign, fitted, mean, std, n, reduced_chi2, bic, delta_bic, delta_bic_effective, variance_inflation, published_mean,
        published_std, unit, note. A campaign's first row is ``error_bounds``, the RMS of the angle's 95 % bound. Mean and std (n - 1) of the
        norm are over recordings, as is the mean of reduced chi-squared; ``bic`` is the sum over recordings, ``delta_bic`` that above the
        campaign's lowest. Both take residuals for independent. ``variance_inflation`` (mean) says how far from it they are, and
        ``delta_bic_effective`` counts as many samples as are. The note counts recordings in which a coefficient came out negative, and says
        what was emulated.
    """
    printed = published.set_index("fitted")
    rows = []
    for campaign, chosen in norms.groupby("campaign", squeeze=False):
        unscaled = (chosen["uncertainty"] == UNSCALED).values
        modes = ", ".join(sorted(set(as_text(chosen["uncertainty"]))))
        about = ["emulated recordings"] if "yes" in chosen["emulated"].values else []
        about += [f"uncertainty of the angle: {modes}", OTHER_APPARATUS]
        norm, chi2, bics, inflation = (
            over(chosen, key, "fitted", "recording")
            for key in ("norm", "reduced_chi2", "bic", "variance_inflation")
        )
        bic, effective = bics.sum(axis=1), bic_effective(chosen)
        mean, std, n = statistics(np.where(unscaled, np.nan, chosen["error_bound_norm"].values))
        rows.append({"campaign": campaign, "fitted": "error_bounds", "mean": mean, "std": std, "n": n, "note": "; ".join(about)})  # fmt: skip
        values, parameter = over(chosen, "value", "fitted", "parameter"), as_text(chosen["parameter"])
        for k, label in enumerate(as_text(chosen["fitted"])):
            mean, std, n = statistics(np.where(unscaled, np.nan, norm[k]))
            rows.append({
                "campaign": campaign, "fitted": label, "mean": mean, "std": std, "n": n,
                "reduced_chi2": float(chi2[k].mean()), "bic": float(bic[k]), "delta_bic": float(bic[k] - bic.min()),
                "delta_bic_effective": float(effective[k] - effective.min()), "variance_inflation": float(np.nanmean(inflation[k])),
                "note": "; ".join([*_negative(parameter, values[k]), *about]),
            })  # fmt: skip
    table = pd.DataFrame(rows)
    for column in ("mean", "std"):
        table[f"published_{column}"] = table["fitted"].map(printed[f"{column}_degrees"])
    table["unit"] = "degrees"
    order = ("campaign", "fitted", "mean", "std", "n", "reduced_chi2", "bic", "delta_bic", "delta_bic_effective", "variance_inflation",
             "published_mean", "published_std", "unit", "note")  # fmt: skip
    return table.reindex(columns=list(order))


def _negative(parameters: Sequence[str], values: Floats) -> Iterator[str]:
    """A remark for each damping coefficient that came out negative: no such damper exists, it stands in for another."""
    for name, found in zip(parameters, values, strict=True):
        if name != "natural_frequency" and (count := int(np.sum(found < 0))):
            yield f"{name} below 0 in {count} of {found.size}: it stands in for something the model lacks"


def statistics(values: Floats) -> tuple[float, float, int]:
    """Mean, standard deviation (n - 1; NaN for a single value) and n."""
    deviation = float(np.std(values, ddof=1)) if values.size > 1 else np.nan
    return float(np.mean(values)), deviation, int(values.size)
