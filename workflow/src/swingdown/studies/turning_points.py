"""Turning points alone: models of damping fitted to them, as one dataset like that of a sampled swing, and what is told of them."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from ..arrays import Floats
from ..errors import InputError
from ..fitting.nested import fit_nested, stand_ins
from ..fitting.passages import Pace, both_ways, pace
from ..fitting.turning_points import Turns, TurnsFit, Unmet, fit_turns
from ..measurement.points.points_recording import COUNTED, NOT_IN_IT, PASSED, READ
from ..measurement.points.turning_points import BOTH_SIDES, PASSAGES, PERIODS
from ..measurement.slack import of_angles
from ..pendulum.half_swings import lengthening
from ..pendulum.model import Model, model_words
from ..rounding import value_with_uncertainty
from . import fit_rows
from .fit_rows import over_names
from .norms import spread

_OF_PACE = {
    "period_first": "first",
    "period_first_u": "u_first",
    "period_change": "change",
    "period_change_u": "u_change",
}
NOT_DAMPED = "not in the data"  # stands for a model
NO_DAMPING = "damping is not in the data: passages are timed, and neither speeds nor the times that the gate was dark are given"
# standard uncertainty of the share below which the dependence on the amplitude is told: it is then seen three times over
_SEEN = 1 / 3
_DROPPED = {"time": ("period", "natural_frequency", "quadratic_coefficient", "constant_friction"),
            "angle": ("quadratic_coefficient", "constant_friction", "load_friction")}  # fmt: skip


def fits_of(angle: xr.Dataset, models: Sequence[Model]) -> list[TurnsFit | None]:
    """The ``TurnsFit`` of each model to a dataset of turning points (``measurement.points.turning_points``); None of one that meets them nowhere.

    InputError where none does.
    """
    turns, clock = turns_of(angle), of_angles([angle]).clock
    unmet: list[Unmet] = []

    def fit_one(model: Model, guesses: Sequence[TurnsFit | Mapping[str, float]]) -> TurnsFit | None:
        values = [one.known if isinstance(one, TurnsFit) else one for one in guesses]
        try:
            return fit_turns(model, turns, values, clock)
        except Unmet as problem:
            unmet.append(problem)
            return None

    def in_place(model: Model, fit: TurnsFit | None) -> list[Mapping[str, float]]:
        return [fit.known | values for values in stand_ins(model, fit.model)] if fit else []

    try:
        found = fit_nested(models, fit_one, in_place)
        if not any(found):
            raise unmet[0]
        return found
    except InputError as problem:
        name = f"recording {angle.attrs.get('recording', '')}"
        raise InputError(name, problem.problem, problem.expected, problem.mend) from problem


def turns_of(angle: xr.Dataset) -> Turns:
    """The ``Turns`` of an angle dataset of turning points."""
    about, halves, timed = angle.attrs, _halves(angle), angle.attrs["points"] == READ
    return Turns(
        _times(angle) if timed else halves / 2, halves, angle["angle"].values, timed, about["kind"] == BOTH_SIDES,
        about["u_times"], about["u_angles"], about["time_step"], about["angle_step"],
    )  # fmt: skip


def _halves(angle: xr.Dataset) -> np.ndarray:
    return angle["half_swings"].values.astype(int)


def _times(angle: xr.Dataset) -> Floats:
    """The times (s) of a dataset of points; of passages without what every second one is late."""
    times = angle["time"].values
    return both_ways(times, _halves(angle)) if angle.attrs["kind"] == PASSAGES else times


def record_of(angle: xr.Dataset) -> float:
    """The time (s) from the first of the points to the last; nan of those that are only counted."""
    times = angle["time"].values
    return float("nan") if angle.attrs["points"] == COUNTED else float(times[-1] - times[0])


def rows_of(angle: xr.Dataset, models: Sequence[Model], names: Sequence[str]) -> list[dict[str, Any]]:
    """What is kept of the fit of each model to a dataset of points, by name (``row_of``); of passages without speeds the period alone."""
    if angle.attrs["points"] == PASSED:
        return [_passed(angle, names)] * len(models)
    found = _pace(angle) if angle.attrs["kind"] in (PASSAGES, PERIODS) else None
    more = {name: np.nan if found is None else getattr(found, field) for name, field in _OF_PACE.items()}
    return fit_rows.rows_of(fits_of(angle, models), lambda fit: row_of(fit, names) | more)


def _pace(angle: xr.Dataset) -> Pace:
    return pace(_times(angle), _halves(angle), of_angles([angle]).clock, angle.attrs["time_step"])


def _passed(angle: xr.Dataset, names: Sequence[str]) -> dict[str, Any]:
    """The variables of ``row_of`` of passages without speeds: a frequency, and nan for all that they do not hold."""
    found, size, count = _pace(angle), len(names), angle.sizes["time"]
    frequency = 2 * np.pi / found.period
    known = spread({"natural_frequency": frequency}, names)
    error = spread({"natural_frequency": frequency * found.u_period / found.period}, names)
    of_each = dict.fromkeys(
        ("random_standard_error", "systematic_standard_error", "coverage_factor"), spread({}, names)
    )
    nothing = ("condition_number", "reduced_chi2", "norm", "largest_angle", "release_angle",
               "angle_scatter", "amplitude_share", "amplitude_share_u")  # fmt: skip
    return {
        "value": known, "standard_error": error, **of_each, "systematic": np.full((size, 1), np.nan), "nuisance_value": np.empty(0),
        "nuisance_standard_error": np.empty(0), "correlation": np.full((size, size), np.nan), "covariance": np.full((size, size), np.nan),
        **dict.fromkeys(nothing, np.nan), "bic": 0.0, "aicc": 0.0, "variance_inflation": 1.0, "converged": True, "evaluations": 1, "share_left": 0.0, "release_velocity": np.nan,
        "fit": np.full(count, np.nan), "residual": np.full(count, np.nan), "time_residual": found.residuals, "time_scatter": found.scatter,
        **{name: getattr(found, field) for name, field in _OF_PACE.items()},
    }  # fmt: skip


def period_of_passages(norms: xr.Dataset) -> tuple[float, float]:
    """The period (s) of passages without speeds and its standard uncertainty, from their part of the norms."""
    return _small_swings(norms.isel(fitted=0))


def _small_swings(own: xr.Dataset) -> tuple[float, float]:
    """The period (s) of a fit's natural frequency, and its standard uncertainty."""
    frequency, u = (float(own[key].sel(parameter="natural_frequency")) for key in ("value", "standard_error"))
    period = 2 * np.pi / frequency
    return period, period * u / frequency


def passages_told(norms: xr.Dataset) -> dict[str, str]:
    """The cells of a row of ``studies.pendulums`` of passages without speeds: where its period holds, and ``note``, what is to be known."""
    own = norms.isel(fitted=0)
    notes = [_scatter(own, 1.0, ""), _change(own), NO_DAMPING, NOT_IN_IT]
    return {"amplitude_text": "the middle of the recording", "note": "; ".join(filter(None, notes))}


def row_of(fit: TurnsFit, names: Sequence[str]) -> dict[str, Any]:
    """What is kept of a fit, by name: the variables of ``studies.experiment.fit_recording``, and how times and angles scatter."""
    covariance, size = fit.covariance, len(fit.free)
    errors = np.sqrt(np.diag(covariance))
    by_name = {
        "standard_error": errors,
        "random_standard_error": np.sqrt(np.diag(fit.random)),
        "systematic_standard_error": np.abs(fit.systematic),
        "coverage_factor": fit.factors,
    }
    kept = {key: spread(dict(zip(fit.free, values, strict=True)), names) for key, values in by_name.items()}
    whole = over_names(covariance, fit.free, names)
    own = np.sqrt(np.diag(whole))
    angles, n = fit.turns.angles, fit.turns.angles.size
    values = fit.known
    share, share_u = amplitude_share(fit)
    return {
        "value": spread(fit.model.values, names),
        **kept,
        "systematic": spread(dict(zip(fit.free, fit.systematic, strict=True)), names)[:, np.newaxis],
        "nuisance_value": np.empty(0),
        "nuisance_standard_error": np.empty(0),
        "correlation": whole / np.outer(own, own),
        "covariance": whole,
        "condition_number": np.nan if size < 2 else float(np.linalg.cond(covariance / np.outer(errors, errors))),
        "reduced_chi2": np.nan,
        "bic": fit.bic,
        "aicc": fit.bic + size * (2 - np.log(n)),
        "variance_inflation": fit.inflation,
        "converged": fit.converged,
        "evaluations": fit.evaluations,
        "share_left": float(np.sqrt(np.mean((angles - fit.angles) ** 2) / np.mean(angles**2))),
        "norm": np.degrees(np.sqrt(np.mean((angles - fit.angles) ** 2))),
        "largest_angle": float(np.abs(fit.angles - values.get("zero", 0.0)).max()),
        "release_angle": values["release_angle"],
        "release_velocity": 0.0,
        "fit": fit.angles,
        "residual": angles - fit.angles,
        "time_residual": fit.turns.times - fit.times if fit.turns.timed else np.full(n, np.nan),
        "time_scatter": fit.scatter[0] if fit.turns.timed else np.nan,
        "angle_scatter": fit.scatter[1],
        "amplitude_share": share,
        "amplitude_share_u": share_u,
    }  # fmt: skip


def amplitude_share(fit: TurnsFit) -> tuple[float, float]:
    """How much the period depends on the amplitude, over what weight makes of it, and its standard uncertainty; nan without times.

    One step of a fit with that share free, from the fit that holds it at what the model's restoring torque says.
    """
    turns = fit.turns
    if not turns.timed:
        return float("nan"), float("nan")
    size = np.abs(fit.angles)
    longer = lengthening((size[1:] + size[:-1]) / 2) - 1
    half = np.pi / fit.model.values["natural_frequency"]
    more = half * np.concatenate([[0.0], np.cumsum(np.diff(turns.halves) * longer)])
    # what a line in the count, as of time and frequency, takes away is not seen
    line = np.vander(turns.halves.astype(float), 2)
    own = more - line @ np.linalg.lstsq(line, more)[0]
    power = float(own @ own)
    if not power > 0:
        return float("nan"), float("nan")
    left = turns.times - fit.times
    held = 1.0 if fit.model.restoring == "sine" else 0.0
    return held + float(own @ left) / power, fit.scatter[0] / float(np.sqrt(power))


def as_told(row: Mapping[str, Any], norms: xr.Dataset, alike: Sequence[str]) -> dict[str, Any]:
    """A row of ``studies.pendulums`` of turning points: without what their scale or clock does not hold, and with ``note``, what is to be
    known of them.

    ``norms`` is the recording's part of the norms, ``alike`` the labels of models that describe the amplitudes as well.
    """
    kind, unit = (str(norms[key].values.item()) for key in ("points", "points_unit"))
    counted = kind == COUNTED
    dropped = (*(_DROPPED["time"] if counted else ()), *(_DROPPED["angle"] if unit != "rad" else ()))
    found = {key: value for key, value in row.items() if not str(key).startswith(dropped)}
    if counted:
        found = {str(key).replace("decay_time_s", "decay_swings"): value for key, value in found.items()}
    own = norms.sel(fitted=row["model"])
    scale = float(own["points_scale"])
    if unit != "rad":
        size = f"{scale * row['amplitude_rad']:.3g} {unit}"
        found |= {"amplitude_rad": np.nan, "residual_rad": np.nan, "amplitude_text": size}
    first, error = (float(own[key]) for key in ("period_first", "period_first_u"))
    if np.isfinite(first):  # of passages: a speed does not tell at which angle they are
        found = {key: value for key, value in found.items() if not str(key).startswith("natural_frequency")}
        text = value_with_uncertainty(first, error)
        found |= {"period_s": first, "period_s_u": error, "period_s_text": text}
    law, scatter = _law(str(row["model"]), alike), _scatter(own, scale, unit)
    notes = [law, scatter, _change(own), _dependence(own, unit), NOT_IN_IT]
    return found | {"or_model": "; ".join(alike), "note": "; ".join(filter(None, notes))}


def _law(model: str, alike: Sequence[str]) -> str:
    if not alike:
        return ""
    others = ", or ".join(model_words(one) for one in alike)
    return f"the data do not distinguish {model_words(model)} from {others}: period, quality and decay are means over the laws"


def _scatter(own: xr.Dataset, scale: float, unit: str) -> str:
    angle = 1e3 * float(own["angle_scatter"]) if unit == "rad" else scale * float(own["angle_scatter"])
    what = "speeds scatter by" if np.isfinite(float(own["period_first"])) else "amplitudes scatter by"
    parts = [f"{what} {angle:.2g} {'mrad' if unit == 'rad' else unit}"] if np.isfinite(angle) else []
    if np.isfinite(time := float(own["time_scatter"])):
        parts.append(f"{'times by' if parts else 'times scatter by'} {1e3 * time:.2g} ms")
    return " and ".join(parts)


def _change(own: xr.Dataset) -> str:
    """How the period changes from the first passage to the last."""
    change, error = (1e3 * float(own[key]) for key in ("period_change", "period_change_u"))
    if not np.isfinite(change):
        return ""
    return f"the period changes by {value_with_uncertainty(change, error)} ms from the first one to the last"


def _dependence(own: xr.Dataset, unit: str) -> str:
    """Period at small amplitude, and whether its dependence on the amplitude is that of a pendulum."""
    share, error = float(own["amplitude_share"]), float(own["amplitude_share_u"])
    if unit != "rad" or not np.isfinite(share):
        return ""
    told = f"small swings take {value_with_uncertainty(*_small_swings(own))} s"
    if error > _SEEN:
        return f"{told}; the period shows no dependence on the amplitude"
    return f"{told}; the period grows with the amplitude {value_with_uncertainty(share, error)} times as fast as weight makes it"
