"""The pendulums of a study side by side: of each the model of damping that describes it, its quantities, and the verdict."""

from collections import Counter
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from ..arrays import Floats
from ..pendulum.catalogue import ANGLE, RATE, READINGS, SHIPPED, Catalogue
from ..pendulum.model import Model
from ..rounding import value_with_uncertainty
from .comparison import WORTH, bic_effective
from .norms import as_text
from .quantities import UNITS, Quantity, quantities

_SUFFIX = {
    "1": "",
    "rad/s": "_rad_per_s",
    "rad/s^2": "_rad_per_s2",
    "1/s": "_per_s",
    "1/s^2": "_per_s2",
    "s": "_s",
    "rad": "_rad",
}
TOGETHER = "(joint)"  # stands for all recordings of a pendulum
REFUSED = "refused"  # stands where a verdict would, for a file that could not be read


def described_by(norms: xr.Dataset, catalogue: Catalogue = SHIPPED) -> str:
    """The label of the model of damping that describes these recordings: the smallest whose further terms are not worth it.

    ``norms`` (fitted, recording, parameter) as ``norms.combine_recordings`` gives them. Evidence is BIC for as many samples
    as count as independent; a model whose effect has a size below 0 that it cannot have (a damper that gives energy) is left out
    where there is another.
    """
    labels, evidence = as_text(norms["fitted"]), bic_effective(norms)
    effects = [catalogue[name] for name in dict.fromkeys("+".join(labels).split("+"))]
    sizes = norms["value"].sel(parameter=[one.size.name for one in effects if one.size and one.one_sided])
    sound = ~(sizes < 0).any([dim for dim in sizes.dims if dim != "fitted"]).values
    usable = [k for k in range(len(labels)) if sound[k] and np.isfinite(evidence[k])] or list(
        range(len(labels))
    )
    lowest = min(evidence[k] for k in usable)
    near = [k for k in usable if evidence[k] - lowest <= WORTH]
    return labels[min(near, key=lambda k: (labels[k].count("+"), evidence[k]))]


def described(
    norms: xr.Dataset, label: str, catalogue: Catalogue = SHIPPED
) -> tuple[float, dict[str, Quantity]]:
    """The amplitude (rad) at which the quantities of one recording hold, and these by name.

    ``norms`` (fitted, parameter, parameter_2) of one recording, or of several fitted together; the amplitude is the largest
    fitted angle.
    """
    one = norms.sel(fitted=label)
    options = {key: str(norms.attrs[key]) for key in ("restoring", "form") if key in norms.attrs}
    model = Model(tuple(label.split("+")), catalogue=catalogue, **options).of(reading_of(one))  # type: ignore[arg-type]
    at = {"parameter": list(model.parameters)}
    model = model.with_values(
        dict(zip(model.parameters, map(float, one["value"].sel(at).values), strict=True))
    )
    covariance: Floats = one["covariance"].sel(at | {"parameter_2": list(model.parameters)}).values
    amplitude = float(one["largest_angle"].max())
    return amplitude, quantities(model, amplitude, covariance)


def pendulums(
    norms: xr.Dataset,
    joint: Iterable[xr.Dataset] = (),
    verdicts: Iterable[Mapping[str, Any]] = (),
    left_out: pd.DataFrame | None = None,
    catalogue: Catalogue = SHIPPED,
) -> pd.DataFrame:
    """A row for each recording, and where a campaign has several one for all of them together, ``(joint)``.

    Columns: campaign, recording, label (its name as it was written), amplitude_rad, then each quantity with its unit in the name (``period_s``, ``quality``,
    ``decay_time_s``, ``natural_frequency_rad_per_s``, and the parameters of damping where the model has them), each followed by
    its standard uncertainty (``period_s_u``) and both as a text (``period_s_text``); ``model`` the label of ``described_by``, or of a
    pendulum of which a search established something of the model that it ended with (``model_of``: damping or search);
    ``residual_rad`` the RMS that it leaves (of an angular rate ``residual_rad_per_s``); ``verdict`` the status of the campaign's search, ``missing`` what that names;
    ``emulated``, ``remark``. ``left_out`` (recording, file, problem) tells in ``remark`` why a recording was not searched, and adds
    a row with the verdict ``refused`` for each file that could not be used.
    """
    found = {str(one["campaign"]): one for one in verdicts}
    together = {str(one.attrs["campaign"]): one for one in joint}
    rows = []
    campaigns = as_text(norms["campaign"])
    for campaign in dict.fromkeys(campaigns):  # in the order of the sample sheet
        chosen = norms.isel(recording=[k for k, one in enumerate(campaigns) if one == campaign])
        for name in as_text(chosen["recording"]):
            own = chosen.sel(recording=[name])
            rows.append(_row(campaign, name, own, own.isel(recording=0), catalogue))
        if chosen.sizes["recording"] > 1 and campaign in together:
            rows.append(_row(campaign, TOGETHER, chosen, together[campaign], catalogue))
    told = {} if left_out is None else {str(one.recording): one for one in left_out.itertuples()}
    each = Counter(row["campaign"] for row in rows)
    rows = [
        by_verdict(row, found.get(row["campaign"], {}))
        if each[row["campaign"]] == 1 or row["recording"] == TOGETHER
        else row
        for row in rows
    ]
    for row in rows:
        verdict = found.get(row["campaign"], {})
        remark = told.pop(row["recording"]).problem if row["recording"] in told else ""
        row |= {"verdict": verdict.get("status", ""), "missing": _named(verdict), "remark": remark}
    for name, one in told.items():
        rows.append(
            {
                "campaign": name,
                "recording": name,
                "label": Path(str(one.file)).stem,
                "verdict": REFUSED,
                "remark": f"{one.file}: {one.problem}",
            }
        )
    return in_order(pd.DataFrame(rows))


def in_order(table: pd.DataFrame) -> pd.DataFrame:
    """The table with its columns in the order that ``pendulums`` tells."""
    first = [_column(name, unit) for name, unit in UNITS.items()]
    told = [column for column in table if f"{column}_u" in table]
    columns = [column + part for column in dict.fromkeys([*first, *told]) for part in ("", "_u", "_text")]
    tail = [name for name in _TAIL if name != RESIDUALS[RATE] or name in table]
    return table.reindex(columns=[*_HEAD, *columns, *tail])


_HEAD = ("campaign", "recording", "label", "amplitude_rad")
RESIDUALS = {ANGLE: "residual_rad", RATE: "residual_rad_per_s"}
DAMPING, SEARCH = "damping", "search"  # where a row's model comes from
_TAIL = ("model", "model_of", *RESIDUALS.values(), "verdict", "missing", "emulated", "remark")


def _row(
    campaign: str, name: str, own: xr.Dataset, fitted: xr.Dataset, catalogue: Catalogue
) -> dict[str, Any]:
    label = described_by(own, catalogue)
    amplitude, derived = described(fitted, label, catalogue)
    row: dict[str, Any] = {
        "campaign": campaign,
        "recording": name,
        "label": str(own["label"].values[0]) if "label" in own.coords and name != TOGETHER else name,
        "amplitude_rad": amplitude,
        "model": label,
        "model_of": DAMPING,
    }
    for key, quantity in derived.items():
        row |= _cells(key, quantity)
    rms = np.radians(np.sqrt(np.mean(fitted["norm"].sel(fitted=label).values ** 2)))
    emulated = "yes" if "yes" in own["emulated"].values else "no"
    return row | {RESIDUALS[reading_of(fitted)]: float(rms), "emulated": emulated}


def by_verdict(row: Mapping[str, Any], verdict: Mapping[str, Any]) -> dict[str, Any]:
    """The row with the quantities of the model that the search ended with, fitted to the whole of every recording, in place of those
    of a model of damping; as it is where the search has none, or established nothing: what imitates has no values."""
    concluded = verdict.get("conclusion")
    if not concluded or verdict["status"] == "unknown":
        return dict(row)
    ends = ("", "_u", "_text")
    old = {f"{key}{end}" for key in row if f"{key}_u" in row for end in ends}
    found = {key: value for key, value in row.items() if key not in old and key not in RESIDUALS.values()}
    for name, one in concluded["quantities"].items():
        value, error = (np.nan if one[key] is None else one[key] for key in ("value", "standard_uncertainty"))
        found |= _cells(name, Quantity(value, error, one["unit"]))
    rates = verdict.get("reading") == RATE
    return found | {
        "amplitude_rad": concluded["amplitude_rad"], "model": concluded["model"], "model_of": SEARCH,
        RESIDUALS[RATE if rates else ANGLE]: concluded["residual"],
    }  # fmt: skip


def _cells(name: str, one: Quantity) -> dict[str, Any]:
    column = _column(name, one.unit)
    return {
        column: one.value,
        f"{column}_u": one.uncertainty,
        f"{column}_text": value_with_uncertainty(one.value, one.uncertainty),
    }


def reading_of(norms: xr.Dataset) -> str:
    """What the sensor of these recordings reads: ``angle`` or ``rate``."""
    return str(np.atleast_1d(norms["reading"].values)[0]) if "reading" in norms.coords else ANGLE


def residual_of(row: Mapping[str, Any]) -> tuple[float, str]:
    """What the model of a row of ``pendulums`` leaves (RMS), and its unit: rad, or rad/s of an angular rate."""
    rate = float(row.get(RESIDUALS[RATE], np.nan))
    return (rate, READINGS[RATE]) if np.isfinite(rate) else (float(row[RESIDUALS[ANGLE]]), READINGS[ANGLE])


def quantities_of(row: Mapping[str, Any]) -> dict[str, Quantity]:
    """The quantities that a row of ``pendulums`` holds, by name, in the order of its columns."""
    found = {}
    for column in row:
        if f"{column}_u" in row and np.isfinite(row[column]):
            endings = [(unit, end) for unit, end in _SUFFIX.items() if str(column).endswith(end)]
            unit, ending = max(endings, key=lambda one: len(one[1]))
            name = str(column).removesuffix(ending)
            found[name] = Quantity(float(row[column]), float(row[f"{column}_u"]), unit)
    return found


def _column(name: str, unit: str) -> str:
    return name + _SUFFIX.get(unit, f"_{unit}")


def _named(verdict: Mapping[str, Any]) -> str:
    """The effects that a verdict asserts, with those tied with them: ``presliding; sensor_gain or torsion_spring``."""
    return "; ".join(" or ".join([one["name"], *one["tied_with"]]) for one in verdict.get("effects", ()))
