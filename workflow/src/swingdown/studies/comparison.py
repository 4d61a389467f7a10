"""Paired comparison of models over recordings: which is closer to the data, and by more than runs differ?"""

from collections.abc import Mapping
from itertools import combinations
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from ..arrays import Floats
from ..fitting.nested import contains
from ..measurement.angle import UNSCALED
from ..pendulum.model import symbol
from ..rounding import plus_minus
from .norms import as_text, over

_FEW = 5  # swings below which a scatter is hardly known
LEVEL = 0.05  # of the p-values after Holm's correction
_EACH = ("fitted", "recording")
_BY_MODEL = ("norm", "bic", "variance_inflation")
WORTH = 6.0  # "strong" evidence on the scale of Kass and Raftery, J. Am. Stat. Assoc. 90, 773 (1995)

_Model = tuple[str, Mapping[str, Floats]]  # a model's name, and its arrays over recordings


def comparison(norms: xr.Dataset) -> pd.DataFrame:
    """A DataFrame with a row for each campaign and pair of models.

    Columns: campaign, model_a, model_b, mean_difference, standard_error, t, p, p_holm, wilcoxon_p, delta_bic,
    delta_bic_effective, n, unit, verdict. ``mean_difference`` (degrees) is the mean of norm a minus norm b over recordings, with
    Student's t and p; ``p_holm`` is corrected for the number of pairs. ``delta_bic_effective`` counts n / variance_inflation
    samples. For nested models the verdict asks whether that BIC falls by more than 6. One recording gives NaN for t and p.
    """
    each = norms.groupby("campaign", squeeze=False)
    tables = [_campaign(str(name), _of_angles(chosen)) for name, chosen in each]
    return pd.concat(tables, ignore_index=True)


def _of_angles(norms: xr.Dataset) -> xr.Dataset:
    """The recordings of one campaign whose norms are of angles; all where none are: of points and of readings without a scale they are not."""
    alone = (norms["uncertainty"] == UNSCALED).values
    alone |= (norms["points"] != "").values if "points" in norms.coords else False
    return norms.isel(recording=~alone) if not alone.all() else norms


def _campaign(campaign: str, norms: xr.Dataset) -> pd.DataFrame:
    # arrays once, and not a selection by name for each pair, which of many pendulums takes most of a minute
    by_model = {key: over(norms, key, *_EACH) for key in _BY_MODEL}
    by_model["terms"] = terms_of(norms)
    samples = norms["samples"].values
    labels = enumerate(as_text(norms["fitted"]))
    models = [(label, {key: all[k] for key, all in by_model.items()}) for k, label in labels]
    rows = [_pair(a, b, samples) for a, b in combinations(models, 2)]
    table = pd.DataFrame(rows, columns=["model_a", "model_b", "mean_difference", "standard_error", "t", "p", "wilcoxon_p",
                                        "delta_bic", "delta_bic_effective", "n"])  # fmt: skip
    table.insert(6, "p_holm", holm(table["p"].to_numpy(float)))
    table["unit"] = "degrees"
    table["verdict"] = [_verdict(row) for row in table.itertuples()]
    table.insert(0, "campaign", campaign)
    return table


def _pair(a: _Model, b: _Model, samples: Floats) -> dict[str, Any]:
    from scipy import stats  # takes a second to load, which jobs that only write a table need not wait for

    first, second = a[1], b[1]
    difference = first["norm"] - second["norm"]
    n = difference.size
    mean = float(difference.mean())
    row = {"model_a": a[0], "model_b": b[0], "mean_difference": mean, "n": n}
    if n > 1 and np.ptp(difference) > 0:
        error = float(difference.std(ddof=1) / np.sqrt(n))
        t = mean / error
        row |= {
            "standard_error": error,
            "t": t,
            "p": float(2 * stats.t.sf(abs(t), n - 1)),
            "wilcoxon_p": float(stats.wilcoxon(difference).pvalue),
        }
    row["delta_bic"] = float(np.sum(first["bic"] - second["bic"]))
    row["delta_bic_effective"] = float(np.sum(_effective(first, second, samples)))
    return row


def bic_effective(norms: xr.Dataset) -> Floats:
    """BIC by model (fitted,), summed over the recordings of ``norms``, for as many samples as count as independent.

    The residual of the model with the lowest norm of a recording decides how many those are, for all models alike.
    """
    norm, inflation = (over(norms, name, *_EACH) for name in ("norm", "variance_inflation"))
    misfit, independent = _misfit(norm, inflation, norms["samples"].values)
    return np.sum(misfit + terms_of(norms) * np.log(independent), axis=1)


def aic_effective(norms: xr.Dataset) -> Floats:
    """AIC by model as ``bic_effective`` has BIC, with free courses beside each law where there are some (``fitting.course``); the weights of
    models follow from it."""
    norm, inflation = (over(norms, name, *_EACH) for name in ("norm", "variance_inflation"))
    if "evidence_norm" in norms:
        own, its = (over(norms, name, *_EACH) for name in ("evidence_norm", "evidence_inflation"))
        norm, inflation = np.where(np.isnan(own), norm, own), np.where(np.isnan(its), inflation, its)
    misfit, _ = _misfit(norm, inflation, norms["samples"].values)
    return np.sum(misfit + 2 * terms_of(norms), axis=1)


def _misfit(norm: Floats, inflation: Floats, samples: Floats) -> tuple[Floats, Floats]:
    """-2 ln of the likelihood by model and recording but for a constant, and how many samples of each recording count as independent."""
    least = np.where(np.isfinite(norm), norm, np.inf).argmin(axis=0)
    independent = np.maximum(samples / np.take_along_axis(inflation, least[np.newaxis], axis=0), 2.0)
    return 2 * independent * np.log(np.radians(norm)), independent


def terms_of(norms: xr.Dataset) -> Floats:
    """How many values each model was fitted with, by model and recording."""
    return np.isfinite(over(norms, "value", *_EACH, "parameter")).sum(axis=-1)


def _effective(first: Mapping[str, Floats], second: Mapping[str, Floats], samples: Floats) -> Floats:
    """BIC of the first minus that of the second model by recording, for as many samples as count as independent.

    The residual of the better model decides how many those are: the other's is all the more correlated for being wrong.
    """
    better = first["norm"] < second["norm"]
    inflation = np.where(better, first["variance_inflation"], second["variance_inflation"])
    independent = np.maximum(samples / inflation, 2.0)
    more = first["terms"] - second["terms"]
    return 2 * independent * np.log(first["norm"] / second["norm"]) + more * np.log(independent)


def holm(p: Floats) -> Floats:
    """The p-values (comparison,) corrected for their number by Holm's step-down method (Scand. J. Stat. 6, 65 (1979)); NaN stays."""
    corrected = np.full(p.shape, np.nan)
    known = np.flatnonzero(np.isfinite(p))
    order = known[np.argsort(p[known])]
    factors = np.arange(order.size, 0, -1)
    corrected[order] = np.minimum(1.0, np.maximum.accumulate(factors * p[order]))
    return corrected


def _verdict(row: Any) -> str:
    a, b = symbol(row.model_a), symbol(row.model_b)
    over = f"over {row.n} swing{'s' if row.n != 1 else ''}"
    if contains(row.model_b, row.model_a):
        return _worth(row.model_b, row.model_a, row.delta_bic_effective, over)
    if contains(row.model_a, row.model_b):
        return _worth(row.model_a, row.model_b, -row.delta_bic_effective, over)
    lower, higher = (a, b) if row.mean_difference < 0 else (b, a)
    if not np.isfinite(row.p):
        by = f"{abs(row.mean_difference):.2g} degrees"
        return f"{lower} is closer to the data than {higher} by {by}, but one swing cannot tell whether by chance"
    by = f"mean paired difference {plus_minus(abs(row.mean_difference), row.standard_error)} degrees {over}"
    if row.p_holm >= LEVEL:
        if row.n < _FEW:
            return f"{a} and {b} are not distinguished by {row.n} swings: {by}"
        return f"{a} and {b} are indistinguishable: {by}"
    return f"{lower} is closer to the data than {higher}: {by}"


def _worth(large: str, small: str, gain: float, over: str) -> str:
    """Whether the terms that ``large`` has more than ``small`` earn their parameters; ``gain`` is BIC small minus large."""
    more = len(large.split("+")) - len(small.split("+"))
    terms, their = (
        ("the added term", "its parameter") if more == 1 else ("the added terms", "their parameters")
    )
    size = f"{abs(gain):.1f}" if abs(gain) < 100 else f"{abs(gain):.0f}"
    told = f"BIC {'falls' if gain > 0 else 'rises'} by {size} {over}, counting independent samples"
    if gain > WORTH:
        verdict = f"{terms} earn{'s' if more == 1 else ''} {their}"
    elif gain < 0:
        verdict = f"{terms} do{'es' if more == 1 else ''} not earn {their}"
    else:
        verdict = f"the data do not say whether {terms} earn{'s' if more == 1 else ''} {their}"
    return f"{symbol(large)} against {symbol(small)}: {verdict} ({told})"
