"""What a dataset of fits keeps of each: a row of values with their uncertainties, and the coordinates beside it."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, TypeVar

import numpy as np
import xarray as xr

from .. import dataset
from ..arrays import Floats, Swing, standard_errors
from ..engine.trajectory import TrajectoryError, simulate
from ..fitting.course import TOLD, Courses
from ..fitting.result import Fit
from ..fitting.uncertainty import Uncertainty, uncertainty
from ..measurement.second_reading import TOLD as AGAIN
from ..pendulum.catalogue import ANGLE
from ..pendulum.model import Model
from ..pendulum.slack import ZERO, Slack
from ..pendulum.static import resting
from .norms import Variable, spread
from .quantities import steady

One = TypeVar("One")

_OF_EACH = ("value", "coverage_factor", *(f"{kind}standard_error" for kind in ("", "random_", "systematic_")))
DIMS: dict[str, tuple[str, ...]] = {
    **dict.fromkeys(("fit", "residual", "time_residual"), ("fitted", "time")),
    **dict.fromkeys(("correlation", "covariance"), ("fitted", "parameter", "parameter_2")),
    **dict.fromkeys(_OF_EACH, ("fitted", "parameter")),
    "systematic": ("fitted", "parameter", "source"),
    "course_shift": ("fitted", "course"),
    "course_covariance": ("fitted", "course", "course_2"),
    **dict.fromkeys(("nuisance_value", "nuisance_standard_error"), ("fitted", "nuisance")),
}


def row_of_fit(
    fit: Fit, swings: Sequence[Swing], angles: Sequence[xr.Dataset], names: Sequence[str]
) -> dict[str, Any]:
    """What is kept of every fit, by name."""
    known = uncertainty(fit, swings, free=True)
    parts = {
        "standard_error": standard_errors(known.covariance),
        "random_standard_error": standard_errors(known.random),
        "systematic_standard_error": np.sqrt(np.sum(known.systematic**2, axis=1)),
        "coverage_factor": known.factors,
    }
    correlation = known.covariance / np.outer(parts["standard_error"], parts["standard_error"])
    errors = {key: dict(zip(fit.free, values, strict=True)) for key, values in parts.items()}
    nuisance = fit.model.slack.parameters
    by_source = dict(zip(fit.free, known.systematic, strict=True))
    absent = np.full(known.systematic.shape[1], np.nan)
    return {
        "value": spread(fit.model.values, names),
        **{key: spread(values, names) for key, values in errors.items()},
        "systematic": np.array([by_source[name] if name in fit.model.values else absent for name in names]),
        "nuisance_value": spread(fit.model.values, nuisance),
        "nuisance_standard_error": spread(errors["standard_error"], nuisance),
        "zero": fit.model.values.get(ZERO, np.nan) if ZERO in nuisance else np.nan,
        "zero_u": errors["standard_error"].get(ZERO, np.nan) if ZERO in nuisance else np.nan,
        "correlation": over_names(correlation, fit.free, names),
        "covariance": over_names(known.covariance, fit.free, names),
        "condition_number": float(np.linalg.cond(correlation)) if np.isfinite(correlation).all() else np.nan,
        "reduced_chi2": _reduced_chi2(fit, swings, angles),
        "bic": fit.bic,
        "aicc": fit.aicc,
        "variance_inflation": max(1.0, known.inflation),
        **_beside(known, fit, names),
        "largest_angle": np.array(largest_angles(fit, swings, known.courses)),
        "converged": fit.converged,
        "evaluations": fit.evaluations,
    }


def _beside(known: Uncertainty, fit: Fit, names: Sequence[str]) -> dict[str, Any]:
    """What the free courses beside a law say of its evidence, of its parameters ``names``, and of the quantities."""
    size, one = len(names) + len(TOLD), known.courses
    norm = fit.rms * (np.sqrt(one.left) if one else 1.0)
    shift, covariance = (
        one.over(fit.free, names) if one else (np.full(size, np.nan), np.full((size, size), np.nan))
    )
    return {
        "evidence_norm": np.degrees(norm),
        "evidence_inflation": max(1.0, one.inflation if one else known.inflation),
        "course_shift": shift,
        "course_covariance": covariance,
    }


def largest_angles(fit: Fit, swings: Sequence[Swing], courses: Courses | None = None) -> list[float]:
    """The largest angle (rad) of the motion of each of these swings (times in s, readings), fitted together, about where it hangs.

    ``courses`` is what free courses do beside the fit: the angles are then those of both together.
    """
    begins = courses.begins if courses else [0.0] * len(fit.swings)
    found = []
    for (times, _), one, more in zip(swings, fit.swings, begins, strict=True):
        motion = one.model.motion
        angle = simulate(motion, times, one.release_angle, one.release_velocity)
        found.append(float(np.abs(angle - resting(steady(motion))).max() * np.exp(more)))
    return found


def rows_of(fits: Sequence[One | None], row_of: Callable[[One], dict[str, Any]]) -> list[dict[str, Any]]:
    """The row of each fit; of a model that cannot be fitted, or followed around its fit, one of NaN, and not converged.

    TrajectoryError where there is no other.
    """
    rows: list[dict[str, Any] | None] = []
    broken: TrajectoryError | None = None
    for fit in fits:
        try:
            rows.append(None if fit is None else row_of(fit))
        except TrajectoryError as problem:
            rows.append(None)
            broken = problem
    one = next((row for row in rows if row is not None), None)
    if one is None:
        raise broken or TrajectoryError("no model can be fitted")
    nothing = {
        key: np.zeros_like(value) if np.asarray(value).dtype.kind in "bi" else np.full_like(value, np.nan)
        for key, value in one.items()
    }
    return [nothing if row is None else row for row in rows]


def over_fits(
    rows: Sequence[Mapping[str, Any]], others: Mapping[str, tuple[str, ...]] | None = None
) -> dict[str, Variable]:
    """The variables that the rows of fits make, over ``DIMS``, or ``others`` by name."""
    dims = DIMS | dict(others or {})
    return {key: (dims.get(key, ("fitted",)), [row[key] for row in rows]) for key in rows[0]}


def any_of(fits: Sequence[Fit | None]) -> Fit:
    """The first fit of those that could be made."""
    return next(fit for fit in fits if fit is not None)


def options_of(models: Sequence[Model], start: str) -> dict[str, Any]:
    """What a dataset says of how its models were fitted."""
    options = {"restoring": models[0].restoring, "form": models[0].form}
    return {"start": start, **options, "bounded": 0}


def facts_of(angle: xr.Dataset) -> dict[str, tuple[str, str]]:
    """What is to be known of a recording's angle, as {name: (value, long_name)}."""
    told, reading = angle.attrs, dataset.series_of(angle).name
    found = {
        "campaign": (told.get("campaign", ""), "pendulum the recording belongs to"),
        "emulated": (told.get("emulated", "no"), "whether the recording is emulated"),
        "label": (told.get("label", told.get("recording", "")), "the recording's name as it was written"),
        "reading": (reading, "what the sensor reads: angle or rate"),
        "uncertainty": (told.get("mode", "unknown"), "what the angle's uncertainty is from"),
        "points": (told.get("points", ""), "what the points are, where they are no samples of the motion"),
        "again": (told.get(AGAIN, ""), "how it was read once more, as no model followed it"),
        "points_unit": (told.get("points_unit", "rad"), "unit of the amplitudes as read"),
    }
    return {name: (str(value), text) for name, (value, text) in found.items()}


def coords_of(angle: xr.Dataset, names: Sequence[str]) -> dict[str, dataset.Labelled]:
    """The coordinates of a recording's fits: its times, and what is to be known of it."""
    return {
        "parameter_2": dataset.variable("parameter_2", names, "other parameter"),
        "time": ("time", angle["time"].values, {}),
        "recording": dataset.variable((), str(angle.attrs.get("recording", "recording")), "recording"),
        **{key: dataset.variable((), value, text) for key, (value, text) in facts_of(angle).items()},
    }


def slack_of(fit: Fit) -> dict[str, dataset.Labelled]:
    """The coordinates of what a fit leaves open."""
    parameters = fit.model.slack.parameters
    return open_coords(parameters, [fit.model.units[name] for name in parameters], fit.sources)


def open_coords(
    parameters: Sequence[str], units: Sequence[str], sources: Sequence[str]
) -> dict[str, dataset.Labelled]:
    """The coordinates of what is left open, and of where the systematic uncertainty comes from."""
    variable, names = dataset.variable, np.array(parameters, dtype=str)
    return {
        "nuisance": variable("nuisance", names, "what the measurement leaves open"),
        "nuisance_unit": variable("nuisance", np.array(units, dtype=str), "unit of the nuisance value"),
        "source": variable("source", np.array(sources, dtype=str), "source of systematic uncertainty"),
    }


def prior_of(slack: Slack) -> dict[str, Variable]:
    """What was known of the nuisance values: standard uncertainties about zero."""
    return {"nuisance_prior": ("nuisance", list(slack.deviations.values()))}


def in_units(found: xr.Dataset, reading: str) -> xr.Dataset:
    """The dataset with the units of what was read: of rates rad/s and degrees/s where angles have rad and degrees."""
    if reading == ANGLE:
        return found
    for name in ("fit", "residual", "rms", "norm", "error_bound_norm", "zero", "zero_u"):
        if name in found:
            about = found[name].attrs
            about["units"] += "/s"
            about["long_name"] = about["long_name"].replace("angle", "angular rate")
    return found


def _reduced_chi2(fit: Fit, swings: Sequence[Swing], angles: Sequence[xr.Dataset]) -> float:
    total = 0.0
    for (_, series), angle, fitted in zip(swings, angles, fit.swings, strict=True):
        random = known_part(angle, "random_uncertainty")
        if random is None:
            return np.nan
        total += float(np.sum(((series - fitted.angle) / random) ** 2))
    return total / (fit.n - len(fit.free))


def over_names(matrix: Floats, free: Sequence[str], names: Sequence[str]) -> Floats:
    """A matrix over ``free`` values (a fit's correlation or covariance) over ``names``, NaN for those that are not free."""
    found = np.full((len(names), len(names)), np.nan)
    own = [name for name in names if name in free]
    where, at = [names.index(name) for name in own], [free.index(name) for name in own]
    found[np.ix_(where, where)] = matrix[np.ix_(at, at)]
    return found


def known_part(angle: xr.Dataset, name: str) -> Floats | None:
    """The values of this part of the reading where it is there and above 0 throughout, else None."""
    try:
        values = dataset.series_of(angle, name).values
    except KeyError:
        return None
    return np.broadcast_to(values, dataset.series_of(angle).shape) if np.all(values > 0) else None
