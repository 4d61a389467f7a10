"""The experiment study: models fitted to measured swings, one by one and all swings of a pendulum together."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import xarray as xr

from .. import dataset
from ..arrays import Floats, Swing, standard_errors, swing_under
from ..engine.trajectory import TrajectoryError, simulate
from ..errors import InputError
from ..fitting.course import TOLD, Courses
from ..fitting.guess import first_guess
from ..fitting.least_squares import fit_jointly
from ..fitting.nested import fit_nested, stand_ins, unseen
from ..fitting.result import Begin, Fit
from ..fitting.slack import allowing
from ..fitting.uncertainty import Uncertainty, uncertainty
from ..measurement.driven import drive_of, driven
from ..measurement.plausibility import in_step_and_steady
from ..measurement.points_recording import are_points
from ..measurement.slack import of_angles
from ..pendulum.catalogue import ANGLE
from ..pendulum.model import Model, as_model
from ..pendulum.slack import Slack
from . import turning_points
from .left_over import MUCH, share_left
from .norms import Coordinate, Variable, labelled, model_coords, spread
from .unscaled import of_first_swings, pace_of, without_scale

_ENOUGH = 3  # half-swings: two give a frequency, a decay needs the next
_DIMS: dict[str, tuple[str, ...]] = {
    "fit": ("fitted", "time"),
    "residual": ("fitted", "time"),
    **dict.fromkeys(("correlation", "covariance"), ("fitted", "parameter", "parameter_2")),
    **dict.fromkeys(
        ("value", "standard_error", "random_standard_error", "systematic_standard_error", "coverage_factor"),
        ("fitted", "parameter"),
    ),
    "systematic": ("fitted", "parameter", "source"),
    "course_shift": ("fitted", "course"),
    "course_covariance": ("fitted", "course", "course_2"),
    "time_residual": ("fitted", "time"),
    **dict.fromkeys(("nuisance_value", "nuisance_standard_error"), ("fitted", "nuisance")),
}


def fit_recording(
    angle: xr.Dataset, fitted: Sequence[Model | str], start: str = "free", bounded: bool = False
) -> xr.Dataset:
    """A Dataset (fitted, parameter, parameter_2, time) of models fitted to one swing by trajectory least squares.

    What the calibration leaves open of the reading is fitted with the model: ``nuisance_value``, ``nuisance_standard_error``, and
    ``nuisance_prior``, its prior. ``norm`` (degrees) is the RMS of the residual, ``error_bound_norm`` (degrees) that of the angle's
    bound. ``standard_error`` is random (with the colour of the residuals, ``fitting.uncertainty``) and systematic together;
    ``systematic`` has it by source. ``reduced_chi2`` uses the *random* uncertainty, NaN where it is unknown. BIC and AICc take
    residuals for independent; ``variance_inflation`` is by how much that is too good.

    Parameters
    ----------
    angle
        A Dataset of ``results/angles``: ``angle(time)`` in rad with its random uncertainty and its bound.
    fitted
        Labels or models. A larger model starts from the optima of those inside it, too.
    start
        ``free`` (release angle and velocity fitted) or ``rest``.
    bounded
        Whether parameters keep within the catalogue's bounds.

    Raises
    ------
    InputError
        For a swing too short to fit.
    """
    if are_points(angle):
        return _of_points(angle, [as_model(one) for one in fitted], start, bounded)
    name, times, series = _swing(angle)
    models = _reading([as_model(one) for one in fitted], [angle])
    drive = drive_of(angle)
    pairs = [swing_under(drive, times, series)]

    slack = of_angles([angle])
    fits = _fits(models, pairs, slack, start, bounded)
    coords = model_coords(models)
    names = coords["parameter"][1]

    def row_of(fit: Fit) -> dict[str, Any]:
        row = _row(fit, pairs, [angle], names)
        return row | {
            "norm": np.degrees(fit.rms), "largest_angle": row["largest_angle"][0],
            "release_angle": fit.only.release_angle, "release_velocity": fit.only.release_velocity,
            "fit": fit.angle, "residual": series - fit.angle, "share_left": share_left(series - fit.angle, series),
        }  # fmt: skip

    rows = _rows(fits, row_of)
    variables: dict[str, Variable] = {
        key: (_DIMS.get(key, ("fitted",)), [row[key] for row in rows]) for key in rows[0]
    }
    bound = _known(angle, "bound")
    variables["error_bound_norm"] = ((), np.nan if bound is None else np.degrees(np.sqrt(np.mean(bound**2))))
    variables |= {"samples": ((), times.size), "record_s": ((), float(times[-1] - times[0]))}
    badly = [one["share_left"] > MUCH for one in rows]
    if drive is not None:
        paces = {}
    elif without_scale(angle) and not all(badly):
        paces = pace_of(angle, times, series)
    elif any(badly):
        paces = of_first_swings(times, series)
    else:
        paces = {}
    if any(badly) and paces:
        paces |= {"steady": float(in_step_and_steady(times, series))}
    variables |= {key: (("fitted",), [value] * len(fits)) for key, value in paces.items()}
    variables |= _prior(slack)
    coords |= _slack_of(_any(fits)) | _of_recording(angle, names)
    attrs = _options(models, start, bounded) | {"emulated": coords["emulated"][1]}
    return _in_units(labelled(xr.Dataset(variables, coords, attrs)), models[0].reading)


def _of_points(angle: xr.Dataset, models: Sequence[Model], start: str, bounded: bool) -> xr.Dataset:
    """The Dataset of ``fit_recording`` of turning points alone, with how their times scatter as well."""
    coords = model_coords(models)
    names = coords["parameter"][1]
    rows = turning_points.rows_of(angle, models, names)
    variables: dict[str, Variable] = {
        key: (_DIMS.get(key, ("fitted",)), [row[key] for row in rows]) for key in rows[0]
    }
    variables |= {
        "error_bound_norm": ((), np.nan),
        "samples": ((), angle.sizes["time"]),
        "record_s": ((), turning_points.record_of(angle)),
        "points_scale": ((), angle.attrs["points_scale"]),
    }
    variables |= _prior(Slack())
    coords |= _of_slack((), (), ("clock",)) | _of_recording(angle, names)
    attrs = _options(models, start, bounded) | {"emulated": coords["emulated"][1]}
    return labelled(xr.Dataset(variables, coords, attrs))


def fit_campaign(
    angles: Sequence[xr.Dataset], fitted: Sequence[Model | str], start: str = "free", bounded: bool = False
) -> xr.Dataset:
    """A Dataset (fitted, recording, parameter, parameter_2) of models fitted to all swings of a campaign together.

    The parameters are shared, each swing has its own release. ``rms`` (rad) and ``norm`` (degrees) are by swing.

    Parameters
    ----------
    angles
        Datasets as ``fit_recording`` takes them.
    fitted, start, bounded
        As in ``fit_recording``.

    Raises
    ------
    InputError
        If there is no swing, or one too short to fit.
    """
    if not angles:
        raise InputError(
            "campaign",
            "there is no swing to fit",
            "at least one",
            "add swings to the sample sheet",
        )
    swings = [_swing(angle) for angle in angles]
    series = [
        swing_under(drive_of(angle), times, values)
        for angle, (_, times, values) in zip(angles, swings, strict=True)
    ]
    models = _reading([as_model(one) for one in fitted], angles)
    slack = of_angles(angles)
    fits = _fits(models, series, slack, start, bounded)
    coords = model_coords(models)
    names = coords["parameter"][1]
    by_swing = ("rms", "norm", "largest_angle", "release_angle", "release_velocity")
    rows = _rows(fits, lambda fit: _row(fit, series, angles, names) | {
        "rms": np.array([swing.rms for swing in fit.swings]),
        "norm": np.array([np.degrees(swing.rms) for swing in fit.swings]),
        "release_angle": np.array([swing.release_angle for swing in fit.swings]),
        "release_velocity": np.array([swing.release_velocity for swing in fit.swings]),
    })  # fmt: skip
    dims = _DIMS | dict.fromkeys(by_swing, ("fitted", "recording"))
    variables: dict[str, Variable] = {
        key: (dims.get(key, ("fitted",)), [row[key] for row in rows]) for key in rows[0]
    }
    variables["samples"] = ("recording", [times.size for times, _ in series])
    variables["record_s"] = ("recording", [float(times[-1] - times[0]) for times, _ in series])
    about = [_about(angle) for angle in angles]
    variables |= _prior(slack)
    coords |= _slack_of(_any(fits)) | {
        "parameter_2": ("parameter_2", names, {"long_name": "other parameter"}),
        "recording": ("recording", [name for name, *_ in swings], {"long_name": "recording"}),
        **{
            key: ("recording", [one[key][0] for one in about], {"long_name": text})
            for key, (_, text) in about[0].items()
        },
    }
    emulated = "yes" if "yes" in coords["emulated"][1] else "no"
    attrs = _options(models, start, bounded) | {"emulated": emulated, "campaign": coords["campaign"][1][0]}
    return _in_units(labelled(xr.Dataset(variables, coords, attrs)), models[0].reading)


def with_drive(models: Sequence[Model], angles: Sequence[xr.Dataset]) -> list[Model]:
    """The models with the effect by which a measured drive acts; the same models where the recordings swing freely.

    Parameters
    ----------
    models
        Without a drive.
    angles
        The recordings, as ``measurement.angle.to_angle`` returns them.
    """
    drive = driven(angles)
    return [model.under(drive) for model in models]


def _fits(
    models: Sequence[Model], swings: Sequence[Swing], slack: Slack, start: str, bounded: bool
) -> list[Fit | None]:
    """The fits of these models to swings of one pendulum, with what the measurement leaves open; None of a model that cannot be fitted.

    TrajectoryError where none can.
    """
    failed: list[TrajectoryError] = []

    def fit_one(model: Model, guess: list[Any]) -> Fit | None:
        known = not (unseen(model) and guess)
        try:
            return fit_jointly(
                model, swings, guess=guess, start=start, bounded=bounded, seen=known, grown=known
            )
        except TrajectoryError as problem:
            failed.append(problem)
            return None

    def in_place(model: Model, fit: Fit | None) -> list[Begin]:
        if fit is None:
            return []
        begun = fit.begin.swings
        return [
            Begin(model, tuple(one._replace(values=values) for one in begun))
            for values in stand_ins(model, fit.model)
        ]

    def allowed(fit: Fit | None) -> Fit | None:
        if fit is None or not slack.names:  # the clock is in the fit already
            return fit
        try:
            return allowing(fit, swings, slack, start=start, bounded=bounded)
        except TrajectoryError as problem:
            failed.append(problem)
            return None

    clocked = models if slack.names else [model.with_slack(slack) for model in models]
    found: list[Fit | None] = fit_nested(clocked, fit_one, in_place)
    fits = [allowed(fit) for fit in found]
    if not any(fits):
        raise failed[0]
    return fits


def _any(fits: Sequence[Fit | None]) -> Fit:
    return next(fit for fit in fits if fit is not None)


def _rows(fits: Sequence[Fit | None], row_of: Callable[[Fit], dict[str, Any]]) -> list[dict[str, Any]]:
    """The row of each fit; of a model that cannot be fitted one of NaN, and not converged."""
    rows = [None if fit is None else row_of(fit) for fit in fits]
    one = next(row for row in rows if row is not None)
    nothing = {
        key: np.zeros_like(value) if np.asarray(value).dtype.kind in "bi" else np.full_like(value, np.nan)
        for key, value in one.items()
    }
    return [nothing if row is None else row for row in rows]


def _reading(models: Sequence[Model], angles: Sequence[xr.Dataset]) -> list[Model]:
    """The models with a sensor that reads what these recordings hold; InputError where some hold angles and some rates."""
    kinds = {str(dataset.series_of(angle).name) for angle in angles}
    if len(kinds) > 1:
        raise InputError(
            f"campaign {angles[0].attrs.get('campaign', '')}", "some of its recordings are of angles and some of angular rates",
            "one of the two", "make two campaigns of it in the sample sheet",
        )  # fmt: skip
    return [model.of(*kinds) for model in models]


def largest_angles(fit: Fit, swings: Sequence[Swing], courses: Courses | None = None) -> list[float]:
    """The largest angle (rad) of each fitted swing's motion; of a sensor of angles the largest that it reads.

    Parameters
    ----------
    fit
        Of the swings together.
    swings
        Times (s) and readings.
    courses
        What free courses do beside the fit: the angles are then those of both together.
    """
    begins = courses.begins if courses else [0.0] * len(fit.swings)
    if fit.model.reading == ANGLE:
        found = [float(np.abs(one.angle).max()) for one in fit.swings]
    else:
        found = [
            float(np.abs(simulate(one.model.motion, times, one.release_angle, one.release_velocity)).max())
            for (times, _), one in zip(swings, fit.swings, strict=True)
        ]
    return [angle * float(np.exp(more)) for angle, more in zip(found, begins, strict=True)]


def _in_units(found: xr.Dataset, reading: str) -> xr.Dataset:
    """The dataset with the units of what was read: of rates rad/s and degrees/s where angles have rad and degrees."""
    if reading == ANGLE:
        return found
    for name in ("fit", "residual", "rms", "norm", "error_bound_norm"):
        if name in found:
            about = found[name].attrs
            about |= {
                "units": f"{about['units']}/s",
                "long_name": about["long_name"].replace("angle", "angular rate"),
            }
    return found


def _options(models: Sequence[Model], start: str, bounded: bool) -> dict[str, Any]:
    """What a dataset says of how its models were fitted."""
    options = {"restoring": models[0].restoring, "form": models[0].form}
    return {"start": start, **options, "bounded": int(bounded)}


def _swing(angle: xr.Dataset) -> tuple[str, Floats, Floats]:
    """The recording's name, times (s) and angle (rad); InputError if it is too short to fit."""
    name = str(angle.attrs.get("recording", "recording"))
    times, series = angle["time"].values, dataset.series_of(angle).values
    if drive_of(angle) is not None and times.size >= 4 * _ENOUGH:
        return name, times, series
    crossings = np.count_nonzero(np.diff(np.signbit(series - np.median(series))))
    if times.size < 4 * _ENOUGH or crossings < _ENOUGH + 1:
        raise InputError(
            f"recording {name}",
            f"too few swings to fit: the angle crosses its middle {crossings} times",
            f"at least {_ENOUGH} whole half-swings",
            "record longer, or widen ⟨start_s⟩ and ⟨stop_s⟩",
        )
    try:
        first_guess(times, series, reading=str(dataset.series_of(angle).name))
    except InputError as problem:
        raise InputError(f"recording {name}", problem.problem, problem.expected, problem.mend) from problem
    return name, times, series


def _about(angle: xr.Dataset) -> dict[str, tuple[str, str]]:
    """What is to be known of a recording's angle, as {name: (value, long_name)}."""
    return {
        "campaign": (str(angle.attrs.get("campaign", "")), "pendulum the recording belongs to"),
        "emulated": (str(angle.attrs.get("emulated", "no")), "whether the recording is emulated"),
        "label": (
            str(angle.attrs.get("label", angle.attrs.get("recording", ""))),
            "the recording's name as it was written",
        ),
        "reading": (str(dataset.series_of(angle).name), "what the sensor reads: angle or rate"),
        "uncertainty": (str(angle.attrs.get("mode", "unknown")), "what the angle's uncertainty is from"),
        "points": (
            str(angle.attrs.get("points", "")),
            "what the points are, where they are no samples of the motion",
        ),
        "points_unit": (str(angle.attrs.get("points_unit", "rad")), "unit of the amplitudes as read"),
    }


def _row(
    fit: Fit, swings: Sequence[Swing], angles: Sequence[xr.Dataset], names: Sequence[str]
) -> dict[str, Any]:
    """What is kept of every fit, by name."""
    known = uncertainty(fit, swings, free=True)
    systematic = np.sqrt(np.sum(known.systematic**2, axis=1))
    parts = {
        "standard_error": standard_errors(known.covariance),
        "random_standard_error": standard_errors(known.random),
        "systematic_standard_error": systematic,
        "coverage_factor": known.factors,
    }
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
        "correlation": _over(_correlated(known.covariance), fit, names),
        "covariance": _over(known.covariance, fit, names),
        "condition_number": _condition(known.covariance),
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


def _reduced_chi2(fit: Fit, swings: Sequence[Swing], angles: Sequence[xr.Dataset]) -> float:
    total = 0.0
    for (_, series), angle, fitted in zip(swings, angles, fit.swings, strict=True):
        random = _known(angle, "random_uncertainty")
        if random is None:
            return np.nan
        total += float(np.sum(((series - fitted.angle) / random) ** 2))
    return total / (fit.n - len(fit.free))


def _prior(slack: Slack) -> dict[str, Variable]:
    """What was known of the nuisance values: standard uncertainties about zero."""
    return {"nuisance_prior": ("nuisance", list(slack.deviations.values()))}


def _of_recording(angle: xr.Dataset, names: Sequence[str]) -> dict[str, Coordinate]:
    """The coordinates of a recording's fits: its times, and what is to be known of it."""
    return {
        "parameter_2": ("parameter_2", names, {"long_name": "other parameter"}),
        "time": ("time", angle["time"].values, {}),
        "recording": ((), str(angle.attrs.get("recording", "recording")), {"long_name": "recording"}),
        **{key: ((), value, {"long_name": text}) for key, (value, text) in _about(angle).items()},
    }


def _slack_of(fit: Fit) -> dict[str, Coordinate]:
    """The coordinates of what a fit leaves open."""
    parameters = fit.model.slack.parameters
    return _of_slack(parameters, [fit.model.units[name] for name in parameters], fit.sources)


def _of_slack(
    parameters: Sequence[str], units: Sequence[str], sources: Sequence[str]
) -> dict[str, Coordinate]:
    """The coordinates of what is left open, and of where the systematic uncertainty comes from."""
    return {
        "nuisance": (
            "nuisance",
            np.array(parameters, dtype=str),
            {"long_name": "what the measurement leaves open"},
        ),
        "nuisance_unit": (
            "nuisance",
            np.array(units, dtype=str),
            {"long_name": "unit of the nuisance value"},
        ),
        "source": (
            "source",
            np.array(sources, dtype=str),
            {"long_name": "source of systematic uncertainty"},
        ),
    }


def _correlated(covariance: Floats) -> Floats:
    errors = standard_errors(covariance)
    return covariance / np.outer(errors, errors)


def _over(matrix: Floats, fit: Fit, names: Sequence[str]) -> Floats:
    """A fit's matrix (its correlation or covariance) over ``names``, NaN for those the model lacks."""
    found = np.full((len(names), len(names)), np.nan)
    own = [name for name in fit.model.parameters if name in names]
    where, at = [names.index(name) for name in own], [fit.free.index(name) for name in own]
    found[np.ix_(where, where)] = matrix[np.ix_(at, at)]
    return found


def _condition(covariance: Floats) -> float:
    matrix = _correlated(covariance)
    return float(np.linalg.cond(matrix)) if np.all(np.isfinite(matrix)) else np.nan


def _known(angle: xr.Dataset, name: str) -> Floats | None:
    """The values of this part of the reading where it is there and above 0 throughout, else None."""
    try:
        values = dataset.series_of(angle, name).values
    except KeyError:
        return None
    return np.broadcast_to(values, dataset.series_of(angle).shape) if np.all(values > 0) else None
