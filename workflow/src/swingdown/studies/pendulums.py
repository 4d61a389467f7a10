"""The pendulums of a study side by side: of each the model of damping that describes it, its quantities, and the verdict."""

import re
import warnings
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from ..engine.trajectory import TrajectoryWarning
from ..measurement.angle import UNSCALED
from ..measurement.plausibility import KEPT
from ..measurement.points.points_recording import PASSED
from ..measurement.refused import NOT_LOOKED_AT
from ..paths import printable
from ..pendulum.catalogue import ANGLE, RATE, READINGS, SHIPPED, Catalogue
from ..pendulum.effect import NATURAL_FREQUENCY
from ..pendulum.half_swings import lengthening
from ..pendulum.slack import ZERO, is_open
from ..rounding import value_with_uncertainty
from ..status import REMAINING, Status
from .described import described, described_by, over_laws, probability, reading_of, rivals, weights
from .norms import as_text
from .quantities import UNITS, Quantity, loss_seen
from .scale import IN_DOUBT
from .turning_points import NOT_DAMPED, as_told, passages_told, period_of_passages
from .unexplained import MUCH, doubt
from .unscaled import as_seen, at_first_swing, meets

_SUFFIX = {
    "1": "", "rad/s": "_rad_per_s", "rad/s^2": "_rad_per_s2", "m/s^2": "_m_per_s2", "1/s": "_per_s", "1/s^2": "_per_s2", "s": "_s",
    "rad": "_rad",
}  # fmt: skip
TOGETHER = "(joint)"  # stands for all recordings of a pendulum
REFUSED = "refused"  # stands where a verdict would, for a file that could not be read


def pendulums(
    norms: xr.Dataset,
    joint: Iterable[xr.Dataset] = (),
    verdicts: Iterable[Mapping[str, Any]] = (),
    left_out: pd.DataFrame | None = None,
    catalogue: Catalogue = SHIPPED,
) -> pd.DataFrame:
    """A row for each recording, and where a campaign has several a row for all of them together, ``(joint)``.

    Parameters
    ----------
    norms
        The dataset ``results/experiment/norms.nc``.
    joint
        The datasets of ``results/experiment/joint``.
    verdicts
        The contents of each campaign's verdict.json.
    left_out
        As ``left_out.left_out`` returns it: why a recording was not searched, and a row with the verdict ``refused`` for each file that
        could not be used.
    catalogue
        The effects that the models are made of.

    Returns
    -------
    pandas.DataFrame
        Columns: campaign, recording, label (its name as it was written), amplitude_rad, then each quantity with its unit in the name
        (``period_s``, ``quality``, ``decay_time_s``, ``natural_frequency_rad_per_s``, and the parameters of damping where the model has them),
        each followed by its standard uncertainty (``period_s_u``) and both as a text (``period_s_text``). ``model`` is the label of
        ``described_by``, or of the model that a search ended with (``model_of``: damping or search); ``or_model`` others that describe it as
        well; ``residual_rad`` the RMS that it leaves (of an angular rate ``residual_rad_per_s``); ``record_s`` the length of the longest
        record; ``verdict`` the status of the campaign's search, ``missing`` what that names; ``emulated``; ``remark``: why its values are in
        doubt, where they are.
    """
    together = {str(one.attrs["campaign"]): one for one in joint}
    rows = []
    campaigns = as_text(norms["campaign"])
    for campaign in dict.fromkeys(campaigns):  # in the order of the sample sheet
        chosen = norms.isel(recording=[k for k, one in enumerate(campaigns) if one == campaign])
        for name in as_text(chosen["recording"]):
            own = chosen.sel(recording=[name])
            rows.append(_row(campaign, name, own, own.isel(recording=0), catalogue))
        if chosen.sizes["recording"] > 1 and campaign in together:
            shared = chosen.sel(recording=as_text(together[campaign]["recording"]))
            rows.append(_row(campaign, TOGETHER, shared, together[campaign], catalogue))
    return judged(rows, verdicts, left_out)


def judged(
    rows: Sequence[dict[str, Any]], verdicts: Iterable[Mapping[str, Any]], left_out: pd.DataFrame | None
) -> pd.DataFrame:
    """The table of ``pendulums`` from its rows before anything was searched, with the verdicts and what was left out."""
    found = {str(one["campaign"]): one for one in verdicts}
    told = {} if left_out is None else {str(one.recording): one for one in left_out.itertuples()}
    each = Counter(row["campaign"] for row in rows if row["recording"] not in told)
    table = []
    for row in rows:
        lost = told.pop(row["recording"], None)
        verdict = {} if lost else found.get(row["campaign"], {})
        if not lost and (each[row["campaign"]] == 1 or row["recording"] == TOGETHER):
            row = by_verdict(row, verdict)
        remark = joined(verdict.get("unit_doubt", ""), row["remark"], lost.problem if lost else "")
        row |= {"verdict": verdict.get("status", ""), "missing": _named(verdict), "remark": remark}
        table.append(row)
    for name, one in told.items():
        if getattr(one, "code", "") == NOT_LOOKED_AT:
            continue
        label = getattr(one, "label", "")
        label = printable(label if isinstance(label, str) and label else Path(str(one.file)).stem)
        row = {"campaign": str(one.campaign), "recording": name, "label": label, "verdict": REFUSED}
        table.append(row | {"remark": f"{one.file}: {one.problem}"})
    return in_order(pd.DataFrame(table))


def in_order(table: pd.DataFrame) -> pd.DataFrame:
    """The table with its columns in the order that ``pendulums`` tells."""
    first = [_column(name, unit) for name, unit in UNITS.items()]
    columns = [column + part for column in dict.fromkeys([*first, *_measured(table)]) for part in _CELLS]
    tail = [name for name in _TAIL if name in _ALWAYS or name in table]
    return table.reindex(columns=[*_HEAD, *columns, *tail])


def _measured(row: Iterable[Any]) -> list[str]:
    """The columns of a row, or of a table, that have a standard uncertainty beside them."""
    columns = list(row)
    return [str(one) for one in columns if f"{one}_u" in columns]


_CELLS = ("", "_u", "_text")  # of a quantity, what follows its column
_HEAD = ("campaign", "recording", "label", "amplitude_rad")
RESIDUALS = {ANGLE: "residual_rad", RATE: "residual_rad_per_s"}
_WITHOUT_SCALE = ("period", "quality", "decay_time")  # what readings without a scale tell
DAMPING, SEARCH = "damping", "search"  # where a row's model comes from
NOT_DYING = "cannot be told: it does not die away"  # stands for a model
NO_MODEL = (NOT_DAMPED, NOT_DYING)
# the last columns, and those of them that are there in any case, not only where a row has them
_TAIL = (
    "model", "or_model", "model_probability", "share_left", "model_of", "period_of", "last_period_s", RESIDUALS[ANGLE], RESIDUALS[RATE],
    "own_unit", "record_s", "verdict", "missing", "emulated", "amplitude_text", "g_of", "g_u_without_length_m_per_s2", "note", "remark",
)  # fmt: skip
_ALWAYS = ("model", "model_of", RESIDUALS[ANGLE], "record_s", "verdict", "missing", "emulated", "remark")


def _row(
    campaign: str, name: str, own: xr.Dataset, fitted: xr.Dataset, catalogue: Catalogue
) -> dict[str, Any]:
    only, kinds = own.isel(recording=0), as_text(own["points"]) if "points" in own.coords else []
    if PASSED in kinds:
        return _of_passages(campaign, name, only)
    label, points = described_by(own, catalogue), any(kinds)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", TrajectoryWarning)
        amplitude, derived = described(fitted, label, catalogue)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", TrajectoryWarning)  # of the model that is named they are told
        derived |= over_laws(fitted, weights(own, catalogue), amplitude, catalogue, {label: derived})
    doubts = dict.fromkeys(str(one.message) for one in caught)
    for text in doubts:
        warnings.warn(text, TrajectoryWarning, stacklevel=3)
    left = float(own["share_left"].sel(fitted=label).max()) if "share_left" in own else 0.0
    row: dict[str, Any] = {
        **({"share_left": left} if left > MUCH else {}),
        "or_model": "; ".join(rivals(own, label, catalogue)),
        "model_probability": probability(own, label, catalogue),
        "record_s": float(own["record_s"].max()) if "record_s" in own else np.nan,
        "campaign": campaign,
        "recording": name,
        "label": str(own["label"].values[0]) if "label" in own.coords and name != TOGETHER else name,
        "amplitude_rad": amplitude,
        "model": label,
        "model_of": DAMPING,
    }
    unscaled, linear = UNSCALED in own["uncertainty"].values, fitted.attrs.get("restoring") == "linear"
    if unscaled:
        period, more = at_first_swing(only)
        if period is None:
            period, more = as_seen(only)
            more |= {"amplitude_text": "the first swings"} if period else {}
        derived = {key: derived[key] for key in _WITHOUT_SCALE} | ({"period": period} if period else {})
        row |= {"amplitude_rad": np.nan, **more}
    elif name != TOGETHER and not points and (left > MUCH or not meets(own, derived.get("period"), left)):
        period, more = as_seen(only)
        if period:
            derived = _with_period(derived, period, 1.0 if linear else float(lengthening(amplitude)), left)
            row |= more
    for key, quantity in (derived | ({} if unscaled else _zero_of(fitted, label))).items():
        row |= cells_of(key, quantity)
    rms = np.nan if unscaled else np.radians(np.sqrt(np.mean(fitted["norm"].sel(fitted=label).values ** 2)))
    emulated = "yes" if "yes" in own["emulated"].values else "no"
    row |= {RESIDUALS[reading_of(fitted)]: float(rms), "emulated": emulated, "remark": joined(*doubts)}
    again = as_text(own["again"])[0] if "again" in own.coords and name != TOGETHER else ""
    row["remark"] = joined(again, row["remark"], _doubt_of(row))
    if points:
        row = as_told(row, only, rivals(own, label, catalogue))
    keeps_on = left > MUCH and "steady" in own and bool((own["steady"] == 1).any())
    # two laws of which one gives what the other takes fit a swing that keeps on
    keeps_on |= "narrowing" in own and float(own["narrowing"].min()) >= KEPT and _foretold(row) < KEPT**2
    dies = "narrowing" in own and bool((own["narrowing"] < KEPT).any())
    return _of_what_is_seen(row, keeps_on, dies)


def _with_period(
    derived: Mapping[str, Quantity], period: Quantity, longer: float, left: float
) -> dict[str, Quantity]:
    """The quantities with the period that the first swings show in place of a model's; the frequency of small swings follows.

    ``longer``: how much longer the first swings of an ideal pendulum take than small ones, as the square of an amplitude; that may be off by the
    share ``left`` of the swing that the model does not follow.
    """
    found = dict(derived) | {"period": period}
    if NATURAL_FREQUENCY.name in derived:
        frequency = 2 * np.pi * longer / period.value
        share = float(np.hypot(period.uncertainty / period.value, 2 * left * (longer - 1) / longer))
        found[NATURAL_FREQUENCY.name] = Quantity(frequency, frequency * share, NATURAL_FREQUENCY.unit)
    return found


def _of_what_is_seen(row: dict[str, Any], keeps_on: bool = False, dies: bool = False) -> dict[str, Any]:
    """The row; of a swing whose loss is not seen, as one that ``keeps_on``, without a damping, for its values would be those of noise. What
    ``dies`` in its turning points has one, however unsure the model's is."""
    # where much is left no loss is one of this model
    if not keeps_on and (doubted(row) or dies or loss_seen(quantities_of(row))):
        return row
    kept = {_column(name, UNITS[name]) + end for name in ("period", "natural_frequency") for end in _CELLS}
    lost = {column + end for column in _measured(row) for end in _CELLS} - kept
    lost |= {"or_model", "model_probability"}
    return {key: value for key, value in row.items() if key not in lost} | {"model": NOT_DYING}


def _foretold(row: Mapping[str, Any]) -> float:
    """How wide the last third of a row's swings is over the first third by its quality; 1.0 where it has none."""
    known = quantities_of(row)
    if not {"quality", "period"} <= known.keys() or not known["quality"].value > 0:
        return 1.0
    return float(np.exp(-2 / 3 * np.pi * row["record_s"] / known["period"].value / known["quality"].value))


def _zero_of(fitted: xr.Dataset, label: str) -> dict[str, Quantity]:
    """The reading where the pendulum hangs, as it was fitted, where that is surely not nothing; by its name, or none."""
    if "zero" not in fitted:
        return {}
    value, error = (float(fitted[key].sel(fitted=label)) for key in ("zero", "zero_u"))
    return {ZERO: Quantity(value, error, READINGS[reading_of(fitted)])} if is_open(value, error) else {}


def doubted(row: Mapping[str, Any]) -> bool:
    """True where the best model of damping leaves so much of a row's swings that it is not what stops them."""
    return float(row.get("share_left", 0.0)) > MUCH


def _doubt_of(row: Mapping[str, Any]) -> str:
    """What its remark says of a row that is ``doubted``; nothing of any other."""
    if not doubted(row):
        return ""
    name = row["campaign"] if row["recording"] == TOGETHER else row["recording"]
    return doubt(float(row["share_left"]), str(name))


def _of_passages(campaign: str, name: str, own: xr.Dataset) -> dict[str, Any]:
    """The row of passages without speeds: the period alone."""
    return {
        "campaign": campaign, "recording": name, "label": str(own["label"].values), "amplitude_rad": np.nan, "model": NOT_DAMPED, "model_of": DAMPING,
        **cells_of("period", Quantity(*period_of_passages(own), "s")), RESIDUALS[ANGLE]: np.nan, "emulated": str(own["emulated"].values), "remark": "",
        **passages_told(own),
    }  # fmt: skip


def joined(*remarks: str) -> str:
    """The remarks that are not empty as one."""
    return "; ".join(filter(None, remarks))


def by_verdict(row: Mapping[str, Any], verdict: Mapping[str, Any]) -> dict[str, Any]:
    """The row with the quantities of the model that the search ended with, fitted to the whole of every recording, in place of those
    of a model of damping; as it is where the search has none, or established nothing: what imitates has no values. Nor have swings that do
    not die away, as the search sees them, a loss, by whichever model."""
    concluded = verdict.get("conclusion")
    if not verdict.get("dies_away", True):
        row = _of_what_is_seen(dict(row), keeps_on=True)
    open_still = REMAINING if row.get("model") == NOT_DYING else {Status.UNKNOWN}
    if not concluded or verdict["status"] in open_still:
        return dict(row)
    unit = verdict.get("unit", READINGS[ANGLE])
    own = {"own_unit": unit} if unit not in READINGS.values() else {}
    old = {"or_model", "model_probability", "share_left", "period_of", *RESIDUALS.values()}
    old |= {f"{key}{end}" for key in _measured(row) for end in _CELLS}
    found = {key: value for key, value in row.items() if key not in old}
    for name, one in concluded["quantities"].items():
        value, error = (np.nan if one[key] is None else one[key] for key in ("value", "standard_uncertainty"))
        found |= cells_of(name, Quantity(value, error, one["unit"]))
    zero = verdict.get("nuisance", {}).get(ZERO)
    if zero and is_open(zero["value"], zero["standard_error"]):
        found |= cells_of(ZERO, Quantity(zero["value"], zero["standard_error"], zero["unit"]))
    rates = verdict.get("reading") == RATE
    # what was missing is found in the unit that there is
    settled = verdict.get("effects") and not verdict.get("unit_doubt")
    remarks = [
        one for one in row.get("remark", "").split("; ")
        if one != _doubt_of(row) and not (settled and one.startswith(IN_DOUBT))
    ]  # fmt: skip
    return _of_what_is_seen(found | {
        "amplitude_rad": np.nan if own else concluded["amplitude_rad"], **own, "model": concluded["model"], "model_of": SEARCH,
        "remark": joined(*remarks),
        RESIDUALS[RATE if rates else ANGLE]: concluded["residual"],
    })  # fmt: skip


def cells_of(name: str, one: Quantity) -> dict[str, Any]:
    """The cells of a row of ``pendulums`` that a quantity has: its value, its standard uncertainty, and both as a text."""
    told = one.value, one.uncertainty, value_with_uncertainty(one.value, one.uncertainty)
    return {_column(name, one.unit) + end: cell for end, cell in zip(_CELLS, told, strict=True)}


def residual_of(row: Mapping[str, Any]) -> tuple[float, str]:
    """What the model of a row of ``pendulums`` leaves (RMS), and its unit: rad, rad/s of an angular rate, or that of a reading without a scale."""
    rate = float(row.get(RESIDUALS[RATE], np.nan))
    if np.isfinite(rate):
        return rate, READINGS[RATE]
    return float(row[RESIDUALS[ANGLE]]), _own_unit(row) or READINGS[ANGLE]


def _own_unit(row: Mapping[str, Any]) -> str:
    """The unit of what is no angle in a row; empty of angles and rates."""
    own = row.get("own_unit")
    return own if isinstance(own, str) else ""


def quantities_of(row: Mapping[str, Any]) -> dict[str, Quantity]:
    """The quantities that a row of ``pendulums`` holds, by name, in the order of its columns."""
    found, own = {}, _own_unit(row)
    of_own = re.compile(rf"(?<![A-Za-z]){re.escape(own)}(?![A-Za-z])") if own else None
    for column in _measured(row):
        if np.isfinite(row[column]):
            name, _, unit = column.rpartition("_")
            if not (of_own and of_own.search(unit)):
                endings = [(unit, end) for unit, end in _SUFFIX.items() if column.endswith(end)]
                unit, ending = max(endings, key=lambda one: len(one[1]))
                name = column.removesuffix(ending)
            found[name] = Quantity(float(row[column]), float(row[f"{column}_u"]), unit)
    return found


def _column(name: str, unit: str) -> str:
    return name + _SUFFIX.get(unit, f"_{unit}")


def _named(verdict: Mapping[str, Any]) -> str:
    """The effects that a verdict asserts, with those tied with them: ``presliding; sensor_gain or torsion_spring``."""
    return "; ".join(" or ".join([one["name"], *one["tied_with"]]) for one in verdict.get("effects", ()))
