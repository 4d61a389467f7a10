"""The experiment study: models fitted to measured swings, one by one and all swings of a pendulum together."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr

from .. import dataset
from ..arrays import Floats, Swing, swing_under
from ..engine.trajectory import TrajectoryError
from ..errors import InputError
from ..fitting.guess import first_guess
from ..fitting.least_squares import fit_jointly
from ..fitting.nested import fit_nested, stand_ins, unseen
from ..fitting.result import Begin, Fit
from ..fitting.slack import allowing, begun_with
from ..measurement.driven import drive_of, driven
from ..measurement.plausibility import in_step_and_steady, narrowing
from ..measurement.points.points_recording import are_points
from ..measurement.sharing import in_one_step, sharing
from ..measurement.slack import of_angles
from ..pendulum.model import Model, as_model
from ..pendulum.slack import Slack
from . import turning_points
from .fit_rows import (  # fmt: skip
    any_of,
    coords_of,
    facts_of,
    in_units,
    known_part,
    open_coords,
    options_of,
    over_fits,
    prior_of,
    row_of_fit,
    rows_of,
    slack_of,
)
from .norms import labelled, model_coords
from .unexplained import MUCH, share_left
from .unscaled import of_first_swings, pace_of, without_scale

_ENOUGH = 3  # half-swings: two give a frequency, a decay needs the next


def fit_recording(angle: xr.Dataset, fitted: Sequence[Model | str], start: str = "free") -> xr.Dataset:
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

    Raises
    ------
    InputError
        For a swing too short to fit.
    """
    if are_points(angle):
        return _of_points(angle, [as_model(one) for one in fitted], start)
    name, times, series = _swing(angle)
    reading = read_alike(name, [angle])
    models = [as_model(one).of(reading) for one in fitted]
    drive = drive_of(angle)
    pairs = [swing_under(drive, times, series)]

    slack = of_angles([angle])
    fits = _fits(models, pairs, slack, start)
    coords = model_coords(models)
    names = coords["parameter"][1]

    def row_of(fit: Fit) -> dict[str, Any]:
        row = row_of_fit(fit, pairs, [angle], names)
        return row | {
            "norm": np.degrees(fit.rms), "largest_angle": row["largest_angle"][0],
            "release_angle": fit.only.release_angle, "release_velocity": fit.only.release_velocity,
            "fit": fit.angle, "residual": series - fit.angle, "share_left": share_left(series - fit.angle, series),
        }  # fmt: skip

    rows = rows_of(fits, row_of)
    variables = over_fits(rows)
    bound, seen = known_part(angle, "bound"), dataset.quiet_of(angle)
    variables["error_bound_norm"] = ((), np.nan if bound is None else np.degrees(np.sqrt(np.mean(bound**2))))
    variables |= {"samples": ((), times.size), "record_s": ((), float(times[-1] - times[0]))}
    variables["narrowing"] = ((), narrowing(seen) if drive is None else np.nan)
    badly = [one["share_left"] > MUCH for one in rows]
    if drive is not None:
        paces = {}
    elif without_scale(angle) and not all(badly):
        paces = pace_of(angle, times, seen)
    else:
        paces = of_first_swings(times, seen)
    if any(badly) and paces:
        paces |= {"steady": float(in_step_and_steady(times, seen))}
    variables |= {key: (("fitted",), [value] * len(fits)) for key, value in paces.items()}
    variables |= prior_of(slack)
    coords |= slack_of(any_of(fits)) | coords_of(angle, names)
    attrs = options_of(models, start) | {"emulated": coords["emulated"][1]}
    return in_units(labelled(xr.Dataset(variables, coords, attrs)), models[0].reading)


def _of_points(angle: xr.Dataset, models: Sequence[Model], start: str) -> xr.Dataset:
    """The Dataset of ``fit_recording`` of turning points alone, with how their times scatter as well."""
    coords = model_coords(models)
    names = coords["parameter"][1]
    rows = turning_points.rows_of(angle, models, names)
    variables = over_fits(rows)
    variables |= {
        "error_bound_norm": ((), np.nan),
        "samples": ((), angle.sizes["time"]),
        "record_s": ((), turning_points.record_of(angle)),
        "points_scale": ((), angle.attrs["points_scale"]),
    }
    variables |= prior_of(Slack())
    coords |= open_coords((), (), ("clock",)) | coords_of(angle, names)
    attrs = options_of(models, start) | {"emulated": coords["emulated"][1]}
    return labelled(xr.Dataset(variables, coords, attrs))


def fit_campaign(
    angles: Sequence[xr.Dataset], fitted: Sequence[Model | str], start: str = "free"
) -> xr.Dataset:
    """A Dataset (fitted, recording, parameter, parameter_2) of models fitted to all swings of a campaign together.

    The parameters are shared, each swing has its own release. ``rms`` (rad) and ``norm`` (degrees) are by swing. The arguments are as in
    ``fit_recording``, with a dataset for each swing. InputError if there is no swing, or one too short to fit, or without an angle.
    """
    for why in sharing(angles)[1].values():
        raise why
    if not angles:
        mend = "add swings to the sample sheet"
        raise InputError("campaign", "there is no swing to fit", "at least one", mend)
    angles = in_one_step(angles)
    swings = [_swing(angle) for angle in angles]
    pairs = zip(angles, swings, strict=True)
    series = [swing_under(drive_of(angle), times, values) for angle, (_, times, values) in pairs]
    reading = read_alike(str(angles[0].attrs.get("campaign", "")), angles)
    models = [as_model(one).of(reading) for one in fitted]
    slack = of_angles(angles)
    fits = _fits(models, series, slack, start)
    coords = model_coords(models)
    names = coords["parameter"][1]
    by_swing = ("rms", "norm", "largest_angle", "release_angle", "release_velocity")
    rows = rows_of(fits, lambda fit: row_of_fit(fit, series, angles, names) | {
        "rms": np.array([swing.rms for swing in fit.swings]),
        "norm": np.array([np.degrees(swing.rms) for swing in fit.swings]),
        "release_angle": np.array([swing.release_angle for swing in fit.swings]),
        "release_velocity": np.array([swing.release_velocity for swing in fit.swings]),
    })  # fmt: skip
    variables = over_fits(rows, dict.fromkeys(by_swing, ("fitted", "recording")))
    variables["samples"] = ("recording", [times.size for times, _ in series])
    variables["record_s"] = ("recording", [float(times[-1] - times[0]) for times, _ in series])
    about = [facts_of(angle) for angle in angles]
    variables |= prior_of(slack)
    told = {"recording": ([name for name, *_ in swings], "recording")}
    told |= {key: ([one[key][0] for one in about], text) for key, (_, text) in about[0].items()}
    coords |= slack_of(any_of(fits))
    coords["parameter_2"] = dataset.variable("parameter_2", names, "other parameter")
    coords |= {key: dataset.variable("recording", *one) for key, one in told.items()}
    emulated = "yes" if "yes" in coords["emulated"][1] else "no"
    attrs = options_of(models, start) | {"emulated": emulated, "campaign": coords["campaign"][1][0]}
    return in_units(labelled(xr.Dataset(variables, coords, attrs)), models[0].reading)


def with_drive(models: Sequence[Model], angles: Sequence[xr.Dataset]) -> list[Model]:
    """The models with the effect by which a measured drive of the recordings acts; the same models where these swing freely."""
    drive = driven(angles)
    return [model.under(drive) for model in models]


def _fits(models: Sequence[Model], swings: Sequence[Swing], slack: Slack, start: str) -> list[Fit | None]:
    """The fits of these models to swings of one pendulum, with what the measurement leaves open; None of a model that cannot be fitted.

    TrajectoryError where none can.
    """
    failed: list[TrajectoryError] = []

    def fit_one(model: Model, guess: list[Any]) -> Fit | None:
        known = not (unseen(model) and guess)
        try:
            return fit_jointly(model, swings, guess=guess, start=start, seen=known, grown=known)
        except TrajectoryError as problem:
            failed.append(problem)
            return None

    def in_place(model: Model, fit: Fit | None) -> list[Begin]:
        if fit is None:
            return []
        each = stand_ins(model, fit.model)
        return [Begin(model, tuple(one._replace(values=own) for one in fit.begin.swings)) for own in each]

    def allowed(fit: Fit | None) -> Fit | None:
        if fit is None or not slack.names:  # the clock is in the fit already
            return fit
        try:
            return allowing(fit, swings, slack, start=start)
        except TrajectoryError as problem:
            failed.append(problem)
            return None

    begun = begun_with(slack)
    opened = models if begun is None else [model.with_slack(begun) for model in models]
    found: list[Fit | None] = fit_nested(opened, fit_one, in_place)
    fits = [allowed(fit) for fit in found]
    if not any(fits):
        raise failed[0]
    return fits


def read_alike(campaign: str, angles: Sequence[xr.Dataset]) -> str:
    """What the sensor of a campaign reads, ``angle`` or ``rate``; InputError where its recordings differ."""
    kinds = {str(dataset.series_of(angle).name) for angle in angles}
    if len(kinds) > 1:
        raise InputError(
            f"campaign {campaign}", "some of its recordings are of angles and some of angular rates",
            "one of the two", "make two campaigns of it in the sample sheet",
        )  # fmt: skip
    return kinds.pop()


def _swing(angle: xr.Dataset) -> tuple[str, Floats, Floats]:
    """The recording's name, times (s) and angle (rad); InputError if it is too short to fit."""
    name = str(angle.attrs.get("recording", "recording"))
    times, series = angle["time"].values, dataset.series_of(angle).values
    if drive_of(angle) is not None and times.size >= 4 * _ENOUGH:
        return name, times, series
    crossings = np.count_nonzero(np.diff(np.signbit(series - np.median(series))))
    if times.size < 4 * _ENOUGH or crossings < _ENOUGH + 1:
        problem = f"too few swings to fit: the angle crosses its middle {crossings} times"
        mend = "record longer, or widen ⟨start_s⟩ and ⟨stop_s⟩"
        raise InputError(f"recording {name}", problem, f"at least {_ENOUGH} whole half-swings", mend)
    try:
        first_guess(times, series, reading=str(dataset.series_of(angle).name))
    except InputError as problem:
        raise InputError(f"recording {name}", problem.problem, problem.expected, problem.mend) from problem
    return name, times, series
