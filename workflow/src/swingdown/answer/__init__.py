"""From somebody's arrays to an answer in one call: ``fit`` for the damping, ``explain`` for what is missing as well."""

import warnings
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from os import PathLike
from typing import Any, Literal, TypeAlias, Unpack, cast

import numpy as np
import pandas as pd
import xarray as xr
from numpy.typing import ArrayLike

from ..arrays import Shown
from ..dataset import series_of
from ..discovery.data.campaign import Campaign, Swing, campaign
from ..discovery.search import discover
from ..discovery.state import Round
from ..discovery.tell.conclusion import concluded
from ..discovery.tell.files import summary, swing_of
from ..discovery.tell.verdict import verdict
from ..engine.trajectory import TrajectoryWarning, engine
from ..errors import InputError, told_to
from ..fitting.result import SwingFit
from ..measurement.driven import driven
from ..measurement.second_reading import may_be_read_once_more, readings
from ..measurement.sharing import in_one_step, sharing
from ..measurement.slack import of_angles
from ..own_unit import own_of
from ..pendulum.catalogue import catalogue
from ..pendulum.model import BASES, Model, everyday, models
from ..status import Status
from ..studies.described import described_by, reading_of, values_of
from ..studies.doubt import (
    Moved,
    NotFree,
    ask_counted,
    breaks_off,
    fit_any,
    fit_free,
    followed,
    unit_in_doubt,
)
from ..studies.experiment import fit_campaign, read_alike, with_drive
from ..studies.norms import combine_recordings
from ..studies.pendulums import NOT_DYING, SEARCH, joined, pendulums
from ..studies.quantities import Quantity
from ..studies.unscaled import without_scale
from .given import Said, asked, swings
from .options import TO_FIT
from .recorded import OfAFile, Recording, Restoring, Told, as_one, read, shown_with
from .result import Answer, Begin
from .simulation import simulate

__all__ = ["Answer", "Quantity", "Recording", "explain", "fit", "read", "simulate"]

Swings: TypeAlias = (
    ArrayLike | pd.Series | pd.DataFrame | xr.DataArray | xr.Dataset | Recording | PathLike[str]
)
"""What holds times, angles, or both: arrays (masked ones too, and quantities of pint), tables and labelled arrays; a recording; a path."""
Unit = Literal["rad", "deg", "rad/s", "deg/s", "V"]
Kind = Literal["", "swing", "turning_points", "half_swings", "passages", "periods"]


class More(Said, OfAFile, total=False):
    """What ``fit`` and ``explain`` take beside."""


BASE = BASES["sine"]
NO_UNIT = "no unit is stated, and as angles these are not a pendulum's"


@told_to(TO_FIT)
def fit(  # noqa: PLR0913
    times: Swings | Sequence[Swings],
    angles: Swings | Sequence[Swings] | None = None,
    *,
    unit: Unit | None = None,
    fitted: str | Sequence[str] | None = None,
    effects: Mapping[str, Any] | None = None,
    names: str | Sequence[str] | None = None,
    restoring: Restoring = "sine",
    kind: Kind = "",
    **more: Unpack[More],
) -> Answer:
    """The ``Answer`` of models of damping fitted to one swing or several of one pendulum: period, quality, decay, the best model.

    Parameters
    ----------
    times
        Times in s (in their own unit where they bring one along), as an array, a list or a Series. Without ``angles``: a Series
        whose index is the time, a DataFrame with columns of time and angle, a DataArray or Dataset, a ``Recording``, or a path.
        A list of these is several swings. Masked samples, NaN and ``pd.NA`` are missing samples.
    angles
        The angle at each time, of the same shape as ``times``; of passages the speeds, where they are known.
    unit
        Unit of the angles (``rad``, ``deg``) or angular rates (``rad/s``, ``deg/s``), or ``V``, of which period and decay
        alone are told. Default: that of a header, of the attribute
        ``units`` or of a quantity of pint, else rad.
    fitted
        Labels of the models to fit, such as ``viscous+load_coulomb``. Default: the laws of damping of ``pendulum.model.everyday``.
    effects
        Effects of your own, as the settings' key ``effects`` has them.
    names
        Names of the swings.
    restoring
        ``sine`` for a pendulum; ``linear`` for a wheel on a spring or a torsion pendulum.
    kind
        ``swing`` (samples), ``turning_points`` (one a period), ``half_swings`` (turning points of both sides), ``passages`` (two a
        period) or ``periods`` (one). Default: the values decide between the first three.
    **more
        ``zero_tolerance``, how far the zero may be off (rad); by default 0.1, and the swings tell it. Of a driven pendulum ``input``, the values of its drive at each time, and ``input_kind``, what it is: ``torque``,
        ``pivot_acceleration``, ``pivot_position`` or ``pivot_angle``. Also ``input_unit``, ``input_free`` and ``input_between``
        (``given.Said`` tells them). The drive acts in every model, and the swing need not be a free one. Of a path whatever ``read``
        takes: ``column``, ``rate``, ``length`` and so on (``recorded.Told`` lists all).

    Returns
    -------
    Answer
        Without a verdict.

    Raises
    ------
    InputError
        If the arguments cannot be read, or a swing is too short.
    NotFree
        An InputError: if no model of damping follows the motion.
    """
    if (recorded := _recorded(times, angles, unit, kind, restoring, more)) is not None:
        return recorded.fit(fitted=fitted, effects=effects)
    said = asked(more)
    return of_swings(swings(times, angles, unit, names, kind, restoring, said), fitted, effects, restoring)


def _recorded(
    times: Any, angles: Any, unit: Unit | None, kind: Kind, restoring: Restoring, more: Mapping[str, Any]
) -> Recording | None:
    """The recording that stands for the times of a call, that the file has whose path does, or that a list of either makes; None where they
    are numbers.
    """
    each = list(times) if isinstance(times, list | tuple) else [times]
    files = [isinstance(one, str | PathLike) for one in each]
    if angles is not None or not any(files) and not any(isinstance(one, Recording) for one in each):
        return None
    if all(files):
        told = {name: value for name, value in more.items() if value is not None}
        told |= {name: value for name, value in (("unit", unit), ("kind", kind)) if value}
        return read(each, restoring=restoring, **cast(Told, told))
    if not all(isinstance(one, Recording) for one in each):
        raise InputError("argument times", "not all of them are of one kind", "recordings, paths or arrays alone", "read the files by swingdown.read, and give the recordings")  # fmt: skip
    if said := [*asked(more), *(name for name, value in (("unit", unit), ("kind", kind)) if value)]:
        raise InputError("arguments", "a recording has its unit and kind already", "a recording alone", f"give {said[0]}= to swingdown.read")  # fmt: skip
    return as_one(each)


def of_swings(
    given: Sequence[xr.Dataset],
    fitted: str | Sequence[str] | None = None,
    effects: Mapping[str, Any] | None = None,
    restoring: str = "sine",
    checked: bool = True,
) -> Answer:
    """The ``Answer`` of ``fit`` on angle datasets (``measurement.angle.to_angle``) of one pendulum, one a recording.

    ``fitted``, ``effects`` and ``restoring`` are as in ``fit``. If ``checked``, NotFree where no model of damping follows the motion; before
    a search it is not asked.
    """
    try:
        return _of_swings(given, fitted, effects, restoring, checked)
    except Moved:
        raise
    except InputError as problem:
        for other in readings(given[0]) if checked and len(given) == 1 else ():
            try:
                # passages that are even and swings that die are judged without a model, which need not follow them
                answer = _of_swings([other], fitted, effects, restoring, checked=not without_scale(other))
            except InputError:
                continue
            remarks = [joined(problem.problem, one) for one in answer.table["remark"]]
            return replace(answer, table=answer.table.assign(remark=remarks))
        raise


def _of_swings(
    given: Sequence[xr.Dataset],
    fitted: str | Sequence[str] | None,
    effects: Mapping[str, Any] | None,
    restoring: str,
    checked: bool,
) -> Answer:
    """The ``Answer`` of ``of_swings`` on these recordings as they are; of several each that no model follows by its free stretch."""
    given = in_one_step(given)
    known = with_drive(models(fitted or everyday(restoring), effects, restoring), given)
    drive = known[0].drive
    unit = "" if drive else unit_in_doubt(given, restoring)
    fit_one = fit_free if checked or drive else fit_any
    try:
        with _of_none_compared():
            each_way = [followed(one, known, fit_one, len(given) == 1) for one in given]
            given, each = [angle for angle, _ in each_way], [fits for _, fits in each_way]
            together = each[0] if len(given) == 1 else fit_campaign(given, known)
    except NotFree as problem:
        told = joined(problem.problem, unit)
        raise type(problem)(problem.where, told, problem.expected, problem.mend) from problem
    except (ArithmeticError, np.linalg.LinAlgError) as problem:
        raise breaks_off("swing") from problem
    norms = combine_recordings(each)
    entries = catalogue(effects)
    label = described_by(norms, entries)
    table = pendulums(norms, [] if len(given) == 1 else [together], catalogue=entries)
    if courses := ask_counted(table, given) if checked else {}:
        own = table.get("note", pd.Series("", index=table.index)).astype(object).fillna("")
        goes = [courses[name][1] if name in courses else "" for name in table["recording"]]
        table["note"] = list(map(joined, own, goes))
        last = {name: period for name, (period, _) in courses.items()}
        table["last_period_s"] = table["recording"].map(last).fillna(table.get("last_period_s", np.nan))
    # a motor's period is that of its swings, whatever their unit
    steady = (table["model"] == NOT_DYING).any()
    table["remark"] = [joined("" if steady else unit, remark) for remark in table["remark"]]
    shown = [
        shown_with(data, one["fit"].sel(fitted=label).values)
        for one, data in zip(each, given, strict=True)
        if np.isfinite(series_of(data).values).any()  # passages without speeds have nothing to show
    ]
    model, begins = _fitted(together, each, next(one for one in known if one.label == label))
    return Answer(
        tuple(given),
        norms,
        table,
        tuple(shown),
        catalogue=entries,
        fitted_model=model,
        begins=begins,
        fitted=values_of(together, label, entries),
    )


def _fitted(
    together: xr.Dataset, each: Sequence[xr.Dataset], model: Model
) -> tuple[Model | None, dict[str, Begin]]:
    """The model with the values of its fit to all swings together, and how each begins; None of passages, which hold no angle."""
    own = together.sel(fitted=model.label)
    model = model.of(reading_of(own))
    at = {"parameter": list(model.parameters)}
    values, errors = (
        dict(zip(model.parameters, map(float, own[key].sel(at).values), strict=True))
        for key in ("value", "standard_error")
    )
    if not np.isfinite(list(values.values())).all():
        return None, {}
    begins = {}
    for one in each:
        times, fit = one["time"].values, one.sel(fitted=model.label)
        release = float(fit["release_angle"]), float(fit["release_velocity"])
        begins[str(one["recording"].item())] = Begin(float(times[0]), *release, float(times[-1] - times[0]))
    return model.with_values(values, errors), begins


@told_to(TO_FIT)
def explain(  # noqa: PLR0913
    times: Swings | Sequence[Swings],
    angles: Swings | Sequence[Swings] | None = None,
    *,
    unit: Unit | None = None,
    base: str | Sequence[str] = BASE,
    rounds: int = 4,
    fitted: str | Sequence[str] | None = None,
    effects: Mapping[str, Any] | None = None,
    names: str | Sequence[str] | None = None,
    restoring: Restoring = "sine",
    **more: Unpack[More],
) -> Answer:
    """The ``Answer`` of ``fit`` with a verdict: what the model ``base`` lacks.

    The search takes seconds where an effect of the catalogue explains the swings, and up to minutes where none does. A single
    swing needs nine half-swings, so that some can be held out.

    Parameters
    ----------
    times, angles, unit, fitted, effects, names, restoring
        As in ``fit``.
    base
        Names of the effects that the search starts from.
    rounds
        The most moves of the search: additions, exchanges, drops.
    **more
        The same as in ``fit``.

    Returns
    -------
    Answer
        ``answer.verdict`` has the contents of ``verdict.json``. Model and quantities are those of the search's last model, after
        ``unknown`` those of ``fit``.

    Raises
    ------
    InputError
        As in ``fit``; a motion that no damping follows only if the search names nothing, or if nothing is stated of a recording and it
        does not swing freely in any unit.
    EngineError
        If there is no compiled engine and no C compiler.
    """
    if (recorded := _recorded(times, angles, unit, "", restoring, more)) is not None:
        return recorded.explain(base=base, rounds=rounds, fitted=fitted, effects=effects)
    said = asked(more)
    given = swings(times, angles, unit, names, restoring=restoring, said=said)
    return explained(given, base, rounds, fitted, effects, restoring)


def explained(
    given: Sequence[xr.Dataset],
    base: str | Sequence[str] = BASE,
    rounds: int = 4,
    fitted: str | Sequence[str] | None = None,
    effects: Mapping[str, Any] | None = None,
    restoring: str = "sine",
) -> Answer:
    """The ``Answer`` of ``explain`` on angle datasets (``measurement.angle.to_angle``) of one pendulum, one a recording.

    The other arguments are as in ``explain``, and so are the errors.
    """
    engine(catalogue(effects))  # without a compiled one even the fits before the search take minutes
    first = before_search(given, fitted, effects, restoring)
    doubt = unit_doubt(given, first)
    whole = searchable("pendulum", given if doubt else first.swings, doubt)
    begun = BASES[restoring] if base is BASE else base
    label = begun if isinstance(begun, str) else "+".join(begun)
    (start,) = with_drive(models(label, effects, restoring), given)
    with _of_none_compared():
        states = concluded(discover(whole, start, rounds), whole)
        found = verdict([summary(state, whole) for state in states], catalogue(effects).of(whole.reading))
    # then damping alone has to follow it, as it has in ``fit``
    if found["status"] == Status.UNKNOWN and not found["unit_doubt"]:
        of_swings(given, fitted, effects, restoring)
    answer = first.with_verdict(found, _shown(states[-1], whole))
    if answer.row.get("model_of") != SEARCH:  # the quantities are those of damping, too
        return answer
    return replace(answer, **_ended(states[-1], whole, found["conclusion"], first.begins))


def _ended(
    state: Round, whole: Campaign, conclusion: Mapping[str, Any], first: Mapping[str, Begin]
) -> dict[str, Any]:
    """The model that a search ended with, with the values that are told of it, and how each swing begins in it."""
    model, told = state.fit.model, conclusion["quantities"]
    values, errors = dict(model.values), dict(model.standard_errors)
    for name in set(told) & set(model.parameters):
        values[name] = told[name]["value"]
        if told[name]["standard_uncertainty"] is not None:
            errors[name] = told[name]["standard_uncertainty"]
    begun = {(Shown.named(part.name)[0], float(part.times[0])): one for part, one in _with_fits(state, whole)}
    begins = {}
    for name, begin in first.items():
        one = begun[name, begin.time]
        begins[name] = begin._replace(angle=one.release_angle, velocity=one.release_velocity)
    return {"fitted_model": model.with_values(values, errors), "begins": begins}


def _with_fits(state: Round, whole: Campaign) -> list[tuple[Swing, SwingFit]]:
    """The swings of a search, those held out too, each with its part in the last model's fit."""
    swings, fits = (*whole.fit, *whole.holdout), (*state.fit.swings, *state.holdout.swings)
    return list(zip(swings, fits, strict=True))


@contextmanager
def _of_none_compared() -> Iterator[None]:
    """No word of what is wrong with the motions of models that are only compared; of the one that is told it is said."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", TrajectoryWarning)
        yield


def before_search(
    given: Sequence[xr.Dataset],
    fitted: str | Sequence[str] | None = None,
    effects: Mapping[str, Any] | None = None,
    restoring: str = "sine",
) -> Answer:
    """The ``Answer`` of ``of_swings`` whose swings are to be searched; damping need not follow them yet, but for a single recording of which
    nothing is stated: its unit and its stretch are guesses until it does, and NotFree is raised where it does not.
    """
    guessed = given[0].attrs.get("unit_stated") == "no" and may_be_read_once_more(given[0])
    return of_swings(given, fitted, effects, restoring, checked=guessed and len(given) == 1)


def unit_doubt(given: Sequence[xr.Dataset], first: Answer) -> str:
    """Why the unit of recordings is not to be believed: nobody stated it, and their ``first`` answer read them without one; else empty."""
    read = any(map(without_scale, first.swings)) and not any(map(without_scale, given))
    return NO_UNIT if read else ""


def searchable(name: str, given: Sequence[xr.Dataset], doubt: str = "") -> Campaign:
    """The ``Campaign`` of angle datasets, with some swings held out; ``doubt``: why their unit is not to be believed.

    InputError where the swings are too few or too short to hold any out, or one holds no angle.
    """
    for why in sharing(given)[1].values():
        raise why
    driven(given)
    given = in_one_step(given)
    whole, reading = campaign(name, [swing_of(one) for one in given]), read_alike(name, given)
    own = own_of(given[0].attrs)
    return replace(whole, slack=of_angles(given), reading=reading, own=own, unit_doubt=doubt)


def _shown(state: Round, whole: Campaign) -> tuple[Shown, ...]:
    """The swings beside what the last model of a search makes of them, in the order of their times."""
    times = whole.own.step if whole.own else 1.0
    found = []
    for swing, one in _with_fits(state, whole):
        read, fit, held_out = times * swing.angle, times * one.angle, swing in whole.holdout
        found.append(Shown(*Shown.named(swing.name), swing.times, read, fit, held_out, whole.unit))
    return tuple(sorted(found, key=lambda one: (one.recording, float(one.times[0]))))
