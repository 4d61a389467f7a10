"""From somebody's arrays to an answer in one call: ``fit`` for the damping, ``explain`` for what is missing as well."""

import warnings
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

import numpy as np
import xarray as xr

from ..arrays import Shown
from ..dataset import series_of
from ..discovery.campaign import Campaign, Swing, campaign
from ..discovery.conclusion import concluded
from ..discovery.files import reading_of, summary
from ..discovery.search import discover
from ..discovery.state import Round
from ..discovery.verdict import verdict
from ..engine.trajectory import TrajectoryWarning, engine
from ..errors import InputError
from ..measurement.slack import of_angles
from ..pendulum.catalogue import READINGS, catalogue
from ..pendulum.model import PAPER_MODELS, models
from ..studies.experiment import fit_campaign, fit_recording
from ..studies.norms import combine_recordings
from ..studies.pendulums import described_by, pendulums
from ..study.own import SPRUNG, SPRUNG_BASE
from .doubt import MEND, check_free
from .given import swings
from .result import Answer

__all__ = ["Answer", "explain", "fit"]

BASE = ("viscous", "load_coulomb")  # what the search starts from, as `discovery.base` of the settings


def fit(
    times: Any,
    angles: Any = None,
    *,
    unit: str | None = None,
    fitted: Sequence[str] = PAPER_MODELS,
    effects: Mapping[str, Any] | None = None,
    names: Sequence[str] | None = None,
    restoring: str = "sine",
) -> Answer:
    """The ``Answer`` of models of damping fitted to one swing or several of one pendulum: period, quality, decay, the best model.

    ``times`` (s) and ``angles`` are arrays, lists or pandas Series; or ``angles`` is left out and ``times`` is a Series (its
    index is the time), a DataFrame with a column of time and one of the angle, or a DataArray or Dataset of xarray. Lists of
    these are several swings. ``unit`` is ``rad`` or ``deg``, or of angular rates ``rad/s``
    or ``deg/s``; without it a header or the attribute ``units`` decides, else rad.
    ``fitted`` are labels of models, ``effects`` effects of one's own as the settings' key ``effects`` has them.
    ``restoring`` is ``sine`` of a pendulum, or ``linear`` of a wheel on a spring or a torsion pendulum, whose friction in a bearing is a
    constant one. InputError for what no pendulum does, and for a swing that is too short.
    """
    return of_swings(swings(times, angles, unit, names), fitted, effects, restoring)


def of_swings(
    given: Sequence[xr.Dataset],
    fitted: Sequence[str] = PAPER_MODELS,
    effects: Mapping[str, Any] | None = None,
    restoring: str = "sine",
    checked: bool = True,
) -> Answer:
    """The ``Answer`` of ``fit`` on angle datasets (``measurement.angle.to_angle``) of one pendulum.

    NotFree for what no model of damping follows; not where it is not to be ``checked``, as before a search for what is missing.
    """
    if restoring == "linear" and fitted is PAPER_MODELS:
        fitted = SPRUNG
    known = models(list(fitted), effects, restoring)
    try:
        with _of_none_compared():
            each = [fit_recording(one, known) for one in given]
            together = each[0] if len(given) == 1 else fit_campaign(given, known)
    except (ArithmeticError, np.linalg.LinAlgError) as problem:
        raise InputError(
            "swing",
            f"no pendulum moves so: its fit breaks off ({problem})",
            "the motion of a pendulum that swings by itself",
            MEND,
        ) from problem
    norms = combine_recordings(each)
    entries = catalogue(effects)
    label = described_by(norms, entries)
    for one, data in zip(each, given, strict=True):
        if checked:
            check_free(one, data, label, entries)
    table = pendulums(norms, [] if len(given) == 1 else [together], catalogue=entries)
    shown = [
        Shown(
            str(one["recording"].item()),
            "",
            one["time"].values,
            series_of(data).values,
            one["fit"].sel(fitted=label).values,
            unit=str(series_of(data).attrs["units"]),
        )
        for one, data in zip(each, given, strict=True)
    ]
    return Answer(tuple(given), norms, table, tuple(shown))


def explain(
    times: Any,
    angles: Any = None,
    *,
    unit: str | None = None,
    base: Sequence[str] = BASE,
    rounds: int = 4,
    fitted: Sequence[str] = PAPER_MODELS,
    effects: Mapping[str, Any] | None = None,
    names: Sequence[str] | None = None,
    restoring: str = "sine",
) -> Answer:
    """The ``Answer`` of ``fit`` with a verdict: what the model ``base`` lacks, found in at most ``rounds`` moves.

    The search takes some seconds for a swing that an effect of the catalogue explains, and up to minutes for one that none
    does. What no model of damping follows is refused only if the search names nothing. Other arguments and errors as in ``fit``, and EngineError where there is no C compiler; a single swing needs nine half-swings, so that some can be held out.
    """
    engine(catalogue(effects))  # without a compiled one even the fits before the search take minutes
    given = swings(times, angles, unit, names)
    first = of_swings(given, fitted, effects, restoring, checked=False)
    whole = searchable("pendulum", first.swings)
    begun = SPRUNG_BASE if restoring == "linear" and base is BASE else base
    (start,) = models(["+".join(begun)], effects, restoring)
    with _of_none_compared():
        states = concluded(discover(whole, start, rounds), whole)
        found = verdict([summary(state, whole) for state in states], catalogue(effects).of(whole.reading))
    if found["status"] == "unknown":  # then damping alone has to follow it, as it has in ``fit``
        of_swings(given, fitted, effects, restoring)
    return first.with_verdict(found, _shown(states[-1], whole.fit, whole.holdout))


@contextmanager
def _of_none_compared() -> Iterator[None]:
    """No word of what is wrong with the motions of models that are only compared; of the one that is told it is said."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", TrajectoryWarning)
        yield


def searchable(name: str, given: Sequence[xr.Dataset]) -> Campaign:
    """The ``Campaign`` of these angle datasets; InputError where they are too little to hold any out."""
    made = [Swing(str(one.attrs["recording"]), one["time"].values, series_of(one).values) for one in given]
    return replace(campaign(name, made), slack=of_angles(given), reading=reading_of(name, given))


def _shown(state: Round, fitted: Sequence[Swing], held: Sequence[Swing]) -> tuple[Shown, ...]:
    """The swings beside what the last model of a search makes of them, in the order of their times."""
    pairs = [*zip(fitted, state.fit.swings, strict=True), *zip(held, state.holdout.swings, strict=True)]
    found = [
        Shown(
            *Shown.named(swing.name),
            swing.times,
            swing.angle,
            one.angle,
            swing in held,
            READINGS[state.fit.model.reading],
        )
        for swing, one in pairs
    ]
    return tuple(sorted(found, key=lambda one: (one.recording, float(one.times[0]))))
