"""Whether the model that describes a swing is one of a pendulum that swings by itself; if not, no number of it is told."""

import warnings
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace

import numpy as np
import pandas as pd
import xarray as xr

from ..arrays import Swing
from ..dataset import quiet_of, series_of
from ..errors import InputError
from ..measurement.driven import drive_of
from ..measurement.plausibility import (
    KEPT,
    free_part,
    in_step_and_dying,
    in_step_and_steady,
    late_stamps,
    narrowing,
)
from ..measurement.second_reading import may_be_read_once_more, readings
from ..pendulum.catalogue import SHIPPED, Catalogue
from ..pendulum.model import Model, everyday
from ..rounding import value_with_uncertainty
from .described import describes
from .experiment import fit_recording
from .scale import DEGREE, Scale, scale_of
from .unexplained import MUCH, doubt
from .unscaled import COURSE, SHOWN, of_first_swings, of_last_swings, without_scale

LEFT = 0.25  # of the swing (RMS of means over a part of a period): what a damping without a name leaves of a pendulum's is less
SURE = 3.0  # standard errors from 0
UNSURE = 0.1  # of the period: its standard uncertainty, or how far it may be from what is counted
UNEVEN = 0.1  # of the period: its standard uncertainty from the first swings of what no model follows
BETTER = 0.8  # of what is left in rad: with so little left in degrees these may be the unit
MEND = (
    "leave out what a hand moves or a motor drives (⟨start_s⟩ and ⟨stop_s⟩), and check the column of the angle and its unit; for a wheel on a spring or a torsion "
    "pendulum write ⟨restoring=linear⟩"
)


class DoubtfulFit(UserWarning):
    """A model that follows a swing badly: its values may be further from the truth than their uncertainties say."""


class NotFree(InputError):
    """No model of damping follows it, or only one that gains energy."""


class Moved(NotFree):
    """It does not die away, or gains energy: something drives it, and no part of it is a free swing for sure."""


def _not_free(
    angle: xr.Dataset, problem: str, expected: str, more: str = "", kind: type[NotFree] = NotFree
) -> NotFree:
    """The refusal of a swing that no pendulum makes by itself; its mend ends in ``more``, or names the columns that mean the same."""
    where, mend = f"recording {angle.attrs['recording']}", MEND + (more or other_columns(angle))
    return kind(where, problem, expected, mend)


def other_columns(angle: xr.Dataset) -> str:
    """Words that name the columns of which each may be the swing, to follow a mend; none where one alone may be."""
    others = str(angle.attrs.get("columns_alike", ""))
    return f"; or name the column of the swing ⟨in signal_column⟩: {others}" if others else ""


def fit_free(angle: xr.Dataset, fitted: Sequence[Model]) -> xr.Dataset:
    """The fits of ``fit_any``, of a swing that a pendulum makes by itself or under a measured drive.

    NotFree where no model of damping follows it, or only with friction that gives energy.
    """
    fits = fit_any(angle, fitted)
    ask(fits, angle, fitted)
    return fits


def ask_free(fits: xr.Dataset, angle: xr.Dataset, fitted: Sequence[Model], start: str = "free") -> None:
    """None for a swing that a pendulum makes by itself; NotFree for what no model of damping follows.

    The question is asked of the models ``fitted``, with the ``fits`` of ``fit_any``, and where they do not follow the swing, of those of
    damping in general: a short list may lack the right one.
    """
    known, restoring = fitted[0].catalogue, fitted[0].restoring
    try:
        check_free(fits, angle, label := describes(fits, known), known)
    except NotFree:
        usual = everyday(restoring)
        if {model.label for model in fitted} >= set(usual):
            raise
        named = [tuple(label.split("+")) for label in usual]
        general = [Model(one, {}, {}, restoring, fitted[0].form, known) for one in named]
        more = fit_any(angle, general, start)
        check_free(more, angle, label := describes(more, known), known)
        fits = more
    if restoring == "sine":
        ask_pull(fits, angle, label)


def ask_pull(fits: xr.Dataset, angle: xr.Dataset, label: str) -> None:
    """None where weight may pull a swing back; NotFree where the model ``label`` follows it badly, and a spring's pull explains it.

    What weight pulls back is the slower the wider it swings; a spring's period is the same, as that of swings much smaller.
    """
    left = float(fits["share_left"].sel(fitted=label))
    if not left > MUCH or angle.attrs.get("unit_told", "yes") != "yes" or "half_swings" in angle:
        return
    series = series_of(angle)
    if scale_of([(angle["time"].values, series.values)], "sine", str(series.name)).factor == DEGREE:
        raise NotFree(
            f"recording {angle.attrs['recording']}",
            f"its period does not depend on the amplitude, so weight does not pull it back: damping leaves {100 * left:.3g} % of it",
            "a pendulum that weight pulls back, or that something else does, as stated",
            "for a wheel on a spring or a torsion pendulum write ⟨restoring=linear⟩; otherwise correct the unit ⟨in signal_unit⟩",
        )


def unit_in_doubt(angles: Sequence[xr.Dataset], restoring: str = "sine") -> str:
    """What is to be said of the unit that a pendulum's swings (``measurement.angle.to_angle``) are taken for; empty where nothing is.

    A stated unit is never overruled. InputError where nobody stated it, and the swings are a pendulum's in another unit (``scale``).
    """
    kinds = {str(series_of(one).name) for one in angles}
    if len(kinds) > 1 or any(map(without_scale, angles)):
        return ""
    pairs = [(one["time"].values, series_of(one).values) for one in angles]
    told = all(one.attrs.get("unit_told", "yes") == "yes" for one in angles)
    found, unit = scale_of(pairs, restoring, *kinds, stated=told), str(series_of(angles[0]).attrs["units"])
    if told:
        return found.doubt(unit)
    doubt = found.doubt(unit) or _lacking(found, pairs).doubt(unit)
    if not doubt:
        if found.told or restoring != "sine":
            return ""
        return f"no unit is stated: taken for {unit}, and the swings are too small to tell it from {unit.replace('rad', 'deg')}"
    names = ", ".join(str(one.attrs["recording"]) for one in angles)
    raise InputError(
        f"recording {names}",
        f"no unit is stated, and {doubt}",
        f"swings in {unit} or in {unit.replace('rad', 'deg')}, and which of the two",
        "write the unit ⟨in signal_unit⟩; for a wheel on a spring or a torsion pendulum, whose period is "
        "the same for all swings, write ⟨restoring=linear⟩" + other_columns(angles[0]),
    )


def _lacking(found: Scale, swings: Sequence[Swing]) -> Scale:
    """What swings tell of a unit that nobody stated, in which much is left of them: where degrees leave less, these are asked about."""
    whole = np.sqrt(np.mean(np.concatenate([values - values.mean() for _, values in swings]) ** 2))
    asked = found.left_given > MUCH * whole and found.left < BETTER * found.left_given
    return replace(found, factor=DEGREE) if asked else Scale()


def fit_any(angle: xr.Dataset, fitted: Sequence[Model], start: str = "free") -> xr.Dataset:
    """The fits of a swing, whatever moves it; arguments and Dataset as of ``experiment.fit_recording``.

    InputError if the swing is too short, or the fit breaks off, as on what no pendulum does.
    """
    try:
        return fit_recording(angle, fitted, start=start)
    except (ArithmeticError, np.linalg.LinAlgError) as problem:
        raise breaks_off(f"recording {angle.attrs['recording']}", other_columns(angle)) from problem


def followed(
    angle: xr.Dataset,
    known: Sequence[Model],
    fit_one: Callable[..., xr.Dataset] = fit_free,
    alone: bool = False,
) -> tuple[xr.Dataset, xr.Dataset]:
    """The angles of a recording (``measurement.angle.to_angle``) with their fits of the models ``known``: of one that no model follows, those
    of its longest free stretch.

    ``fit_one`` is ``fit_free`` or ``fit_any``. One that is ``alone`` has no others beside it, and is read once more by who asks. InputError as
    of ``fit_one``, where no stretch is followed either.
    """
    try:
        return angle, fit_one(angle, known)
    except Moved:
        raise
    except (InputError, ArithmeticError, np.linalg.LinAlgError):
        for other in () if alone or fit_one is fit_any else readings(angle, in_rad=True):
            try:
                return other, fit_one(other, known)
            except InputError:
                continue
        raise


def free_stretch(angle: xr.Dataset, restoring: str = "sine") -> xr.Dataset:
    """The angles of a recording, or where no model of damping follows them those of its longest free stretch, if one follows that."""
    if angle.attrs.get("role") == "static" or not may_be_read_once_more(angle):
        return angle
    known = [Model(tuple(label.split("+")), restoring=restoring) for label in everyday(restoring)]
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # what is wrong with it is told where it is fitted
            return followed(angle, known)[0]
    except (InputError, ArithmeticError, np.linalg.LinAlgError):
        return angle


def ask(fits: xr.Dataset, angle: xr.Dataset, fitted: Sequence[Model], start: str = "free") -> None:
    """None for a swing that is what it is taken for: one that answers to its measured drive, or else a free one; NotFree otherwise."""
    if "input" in angle:
        ask_driven(fits, angle)
    else:
        ask_free(fits, angle, fitted, start)


def ask_driven(fits: xr.Dataset, angle: xr.Dataset) -> None:
    """None for a swing that answers to its measured drive as a pendulum does; NotFree where no model follows it, and a warning where one
    does so badly."""
    left = float(fits["share_left"].min())
    if not left <= LEFT:
        raise NotFree(
            f"recording {angle.attrs['recording']}",
            f"it does not answer to its input as a pendulum does: the best model of damping leaves {100 * left:.3g} % of it",
            f"at most {100 * LEFT:.0f} %",
            "check the columns and units of angle and input, and what the input is (⟨input_kind⟩)",
        )
    if words := doubt(left, angle.attrs["recording"]):
        warnings.warn(words, DoubtfulFit, stacklevel=2)


def breaks_off(where: str, more: str = "") -> InputError:
    """What is told of a fit that breaks off; its mend ends in ``more``."""
    return InputError(
        where,
        "no model of a pendulum follows this motion to its end, whatever its values",
        "the motion of a pendulum that swings by itself",
        MEND + more,
    )


def check_free(fits: xr.Dataset, given: xr.Dataset, label: str, catalogue: Catalogue = SHIPPED) -> None:
    """None where the model ``label`` follows a recording with friction that takes energy; NotFree where it does not, and a warning
    where it does so badly.

    ``fits`` are those of ``studies.experiment.fit_recording`` to the angles ``given``. What is moved by a hand or a motor, or is no
    angle at all, has a least squares fit like anything else, and its values are no pendulum's.
    """
    name = str(given.attrs["recording"])
    own = fits[["share_left", "value", "standard_error"]].sel(fitted=label)
    left = float(own["share_left"])
    if (drive := given.attrs.get("drive_beside", "")) and not left <= MUCH:
        raise Moved(
            f"recording {name}",
            f"the best model of damping leaves {100 * left:.3g} % of its swings, and the file holds what may drive them: {drive}",
            "a pendulum that swings by itself, or the drive that was measured",
            "name the column of the drive ⟨in input_column⟩, or leave out what it drives (⟨start_s⟩ and ⟨stop_s⟩)",
        )
    if not left <= LEFT:
        raise _not_followed(given, left)
    effects = [catalogue[one] for one in label.split("+")]
    sizes = [one.size.name for one in effects if one.size and one.one_sided]
    losses = {
        size: [float(own[key].sel(parameter=size)) for key in ("value", "standard_error")] for size in sizes
    }
    if left > MUCH:
        if "half_swings" not in given and in_step_and_steady(given["time"].values, quiet_of(given)):
            warnings.warn(doubt(left, name), DoubtfulFit, stacklevel=2)
            return  # even swings of one size tell their period, and no loss or gain is one of this model
        _check_dies(given, left, losses.values())
        _check_even(given)
        warnings.warn(doubt(left, name), DoubtfulFit, stacklevel=2)
    for size, (value, error) in losses.items():
        if value < -SURE * error:
            raise _not_free(
                given,
                f"it gains energy: a fit needs {size.replace('_', ' ')} below 0, {value:.3g} ± {error:.2g}",
                "a pendulum that dies away by itself",
                kind=Moved,
            )


def ask_counted(table: pd.DataFrame, angles: Sequence[xr.Dataset]) -> dict[str, tuple[float, str]]:
    """By recording the last period (s), and in words from where to where it goes, where a stop-watch shows that; NotFree where a period of a ``table`` of pendulums is not
    known, or disagrees with the passages of the middle that no model enters.

    Of swings so few, or so small beside the noise, that their period is known to a tenth alone, or of a model that counts other swings
    than there are, no number is told.
    """
    courses = {}
    longer = "; record longer; or name the column of the swing ⟨in signal_column⟩"
    rows = {row["recording"]: row for row in table.to_dict("records")}
    for one in angles:
        row = rows.get(name := str(one.attrs["recording"]))
        if row is None or "half_swings" in one or drive_of(one) is not None:
            continue
        told, u, left, last_told = (
            float(row.get(key, np.nan)) for key in ("period_s", "period_s_u", "share_left", "last_period_s")
        )
        if not np.isfinite(told):
            raise _not_free(
                one,
                "the model that comes nearest does not swing back and forth: it has no period",
                "a pendulum that swings by itself about where it hangs",
            )
        if u > UNSURE * told:
            raise _not_free(
                one,
                f"its few swings give a period of {value_with_uncertainty(told, u)} s, and no better: is it a free swing?",
                f"swings that give the period to {100 * UNSURE:.0f} %",
                longer,
            )
        passed = of_first_swings(one["time"].values, quiet_of(one))
        counted, spread = passed["period_first"], passed["period_first_u"]
        if np.isfinite(left) and not np.isfinite(counted):
            raise _not_free(
                one,
                f"the best model of damping leaves {100 * left:.2g} % of it, and its swings are too few to count a period without a model",
                "three whole swings or more, or a model that follows them",
                longer,
            )
        if abs(told - counted) > UNSURE * counted + SURE * spread:
            raise _not_free(
                one,
                f"a model of it has a period of {told:.4g} s, and its first swings pass the middle every {value_with_uncertainty(counted, spread)} s",
                "a swing whose model and passages agree",
            )
        last, unsure = of_last_swings(one["time"].values, quiet_of(one))
        if abs(last - told) > max(SURE * unsure, SHOWN * told) and not np.isfinite(last_told):
            ends = value_with_uncertainty(told, u), value_with_uncertainty(last, unsure)
            courses[name] = last, COURSE.format(*ends)
    return courses


def _not_followed(given: xr.Dataset, left: float) -> NotFree:
    """The refusal of what the best model leaves so large a share of: its times are wrong, or it is no free swing."""
    where = ""
    if "half_swings" not in given:
        times, values = given["time"].values, quiet_of(given)
        if late := late_stamps(times, values):
            return NotFree(
                f"recording {given.attrs['recording']}",
                f"its swings die away evenly, and their periods scatter by {100 * late:.0f} %: its times are not those of its samples, as where a "
                "program stamps them late",
                "the time at which each sample was taken",
                "let the board that reads the sensor count the time, or film it",
            )
        if part := free_part(times, values):
            where = f"; from {part[0]:.3f} to {part[1]:.3f} s alone its swings are in step and do not grow"
    return _not_free(
        given,
        f"it does not move as a pendulum that swings by itself: the best model of damping leaves {100 * left:.3g} % of it{where}",
        f"at most {100 * LEFT:.0f} %",
    )


def _check_even(given: xr.Dataset) -> None:
    """NotFree where no period is seen: the passages through the middle that a model follows badly are at uneven distances."""
    if "half_swings" in given:
        return
    first, error, _ = of_first_swings(given["time"].values, quiet_of(given)).values()
    if error > UNEVEN * first:
        raise _not_free(
            given,
            f"it passes its middle unevenly, each {value_with_uncertainty(first, error)} s of its first swings, and no model of damping follows it",
            "swings of one period",
        )


def _check_dies(given: xr.Dataset, left: float, losses: Iterable[Sequence[float]]) -> None:
    """NotFree where a swing keeps its size, and the model that leaves so large a share (``left``) of it has no loss that is seen."""
    seen = [abs(value) > SURE * error for value, error in losses if np.isfinite(error)]
    times, values = given["time"].values, quiet_of(given)
    if any(seen) or not seen or not narrowing(values) >= KEPT or in_step_and_dying(times, values):
        return
    raise _not_free(
        given,
        f"its swings do not shrink, and the best model of damping leaves {100 * left:.3g} % of them, as where a motor drives it",
        "a pendulum that dies away by itself",
        kind=Moved,
    )
