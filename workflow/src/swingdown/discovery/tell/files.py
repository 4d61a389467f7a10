"""The rounds of a search as files: what a search writes, and what verdict, figures and report read."""

from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from ... import dataset
from ...arrays import finite_or_none
from ...engine.trajectory import TrajectoryError
from ...errors import InputError
from ...measurement.driven import drive_of, driven
from ...measurement.refused import refuse
from ...measurement.sharing import in_one_step
from ...measurement.slack import of_angles
from ...own_unit import Own, own_of
from ...pendulum.model import Model
from ...pendulum.model_file import write_model
from ...sealed import write_csv, write_json, write_text
from ...studies.experiment import read_alike
from ...studies.fit_rows import largest_angles
from ..data.campaign import Campaign, Swing, campaign
from ..judge.confirm import gap, per_swing
from ..judge.findings import Finding
from ..move.own_frequency import frequencies
from ..see.course import NO_COURSE, Course, course
from ..see.linear import frame
from ..see.locate import kind
from ..see.losses import said
from ..state import Round
from .verdict import in_unit

ROUNDS = "rounds.json"
_RANKING = ["move", "added", "also", "dropped", "delta_bic", "gain_bic", "rms_rad", "tied", "refused", "effects"]  # fmt: skip


def read_campaign(name: str, paths: Sequence[Path | str], roles: Sequence[str]) -> tuple[Campaign, bool]:
    """The ``Campaign`` of angle files, and whether any is emulated.

    Parameters
    ----------
    name
        That of the campaign.
    paths
        The files that ``angle`` wrote, one a recording.
    roles
        The role of each in the sample sheet: fit, holdout, static or empty.
    """
    kinds: dict[str, list[Swing]] = {"fit": [], "holdout": [], "static": []}
    emulated, systematic = False, 0.0
    read = in_one_step([dataset.read(path) for path in paths])
    for data, role in zip(read, roles, strict=True):
        swing = swing_of(data)
        systematic = max(systematic, float(dataset.series_of(data, "systematic_uncertainty").max()))
        emulated |= str(data.attrs.get("emulated", "no")) == "yes"
        kinds[role or "fit"].append(swing)
    driven(read)
    static = [swing.pair for swing in kinds["static"]]
    known = campaign(name, kinds["fit"], kinds["holdout"], static)
    known = replace(
        known,
        systematic=systematic,
        slack=of_angles(read),
        reading=read_alike(name, read),
        own=own_of(read[0].attrs),
    )
    return known, emulated


def swing_of(angle: xr.Dataset) -> Swing:
    """The ``Swing`` of an angle dataset, under its measured drive where it has one."""
    return Swing(
        str(angle.attrs["recording"]), angle["time"].values, dataset.series_of(angle).values, drive_of(angle)
    )


def write_no_verdict(
    name: str, problem: InputError, members: Mapping[str, Any], outputs: Iterable[Path | str]
) -> None:
    """The files of a search written of a campaign in which nothing can be looked for: each says why, and none holds a number."""
    why = {key: getattr(problem, key) for key in ("where", "problem", "expected", "mend")}
    for path in map(Path, outputs):
        if path.name == ROUNDS:
            write_json(path, [{"campaign": name, "no_verdict": why} | dict(members)])
        elif path.suffix == ".nc":
            refuse(problem, {"campaign": name}, path)
        else:
            write_text(path, f"# no verdict: {problem.problem}\n")


def write_rounds(
    states: Sequence[Round],
    campaign: Campaign,
    folder: Path | str,
    emulated: bool,
    members: Mapping[str, Any] | None = None,
) -> None:
    """The rounds written: each in ``rounds.json``, and in the folders ``first`` and ``last`` the model, the fit and the tables of these two.

    Parameters
    ----------
    states
        Of a search. Their tables are groups, ranking, map and half-swings, and of what is still lacking remainder and course.
    campaign
        Its swings.
    folder
        Where to.
    emulated
        Whether the files say that their numbers come from a computed pendulum.
    members
        Which recordings take part (``recordings``) and which were ``left_out``.
    """
    folder, told = Path(folder), []
    for state in states:
        when = NO_COURSE
        if state.missing:  # a motion that cannot be followed more finely is no reason to lose the verdict
            with suppress(TrajectoryError, np.linalg.LinAlgError):
                when = course(frame(state.fit, campaign.fit), state.noise)
        told.append(
            summary(state, campaign)
            | {"course": {"torque": when.size, "gain": when.gain}}
            | dict(members or {})
        )
        for place in ["first"] * (state is states[0]) + ["last"] * (state is states[-1]):
            _write_round(state, campaign, folder / place, emulated, when, told[-1])
    write_json(folder / ROUNDS, told)


def write_models(states: Sequence[Round], outputs: Sequence[Path | str]) -> None:
    """The model of each round written; where a search needed fewer than there are outputs, that of the last one again."""
    for number, path in enumerate(outputs):
        Path(path).parent.mkdir(parents=True, exist_ok=True)
        write_model(states[min(number, len(states) - 1)].model, path)


def _write_round(
    state: Round, campaign: Campaign, folder: Path, emulated: bool, when: Course, told: Mapping[str, Any]
) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    write_model(state.model, folder / "model.yaml")
    write_csv(pd.DataFrame(told["groups"]), folder / "groups.csv")
    write_csv(pd.DataFrame(told["ranking"], columns=_RANKING), folder / "ranking.csv")
    tables = {
        "map": state.curves,
        "half_swings": state.half_swings,
        "remainder": state.plane if state.missing else state.plane[:0],
        "course": when.table,
    }
    for name, table in tables.items():
        write_csv(_in_own_unit(table, campaign.own), folder / f"{name}.csv", float_format="%.6g")
    dataset.write(_series(state, campaign, emulated), folder / "fit.nc")


_OF_AN_ANGLE = ("torque", "band", "amplitude_rad", "midpoint_rad", "angle_rad", "speed_rad_per_s")


def _in_own_unit(table: pd.DataFrame, own: Own | None) -> pd.DataFrame:
    """A table of a round in the reading's own unit, where that is no angle."""
    if own is None:
        return table
    told = {name: own.step * table[name] for name in _OF_AN_ANGLE if name in table}
    if "over" in table:
        told["x"] = table["x"].where(table["over"] == "time", own.step * table["x"])
    return table.assign(**told)


def _series(state: Round, campaign: Campaign, emulated: bool) -> xr.Dataset:
    """Data and fit of every swing, fitted and held out, as one ragged dataset (swing index by sample)."""
    swings = [*campaign.fit, *campaign.holdout]
    series = [one.angle for one in (*state.fit.swings, *state.holdout.swings)]
    rad, what = (
        {"units": campaign.unit},
        "angular rate" if campaign.reading != "angle" else "reading" if campaign.own else "angle",
    )
    times = campaign.own.step if campaign.own else 1.0
    return xr.Dataset(
        {
            campaign.reading: (
                "sample",
                times * np.concatenate([s.angle for s in swings]),
                rad | {"long_name": f"measured {what}"},
            ),
            "fit": ("sample", times * np.concatenate(series), rad | {"long_name": f"fitted {what}"}),
            "time": (
                "sample",
                np.concatenate([s.times for s in swings]),
                {"units": "s", "long_name": "time"},
            ),
            "swing": ("sample", np.repeat(np.arange(len(swings)), [s.times.size for s in swings])),
        },
        {
            "name": ("swings", [s.name for s in swings]),
            "held_out": ("swings", [s in campaign.holdout for s in swings]),
        },
        {
            "campaign": campaign.name,
            "emulated": "yes" if emulated else "no",
            in_unit("noise_rms", campaign.reading): times * state.noise.deviation,
            "model": state.fit.model.label,
        },
    )


def summary(state: Round, campaign: Campaign) -> dict[str, Any]:
    """What ``rounds.json`` holds of a ``Round``: the state in numbers and words, the groups, and the ranking."""
    chosen, swings = state.chosen, [s.name for s in (*campaign.fit, *campaign.holdout)]
    ratios = [*per_swing(state.fit, state.noise), *per_swing(state.holdout, state.noise)]
    best, step = state.ranked[0].bic if state.ranked else 0.0, campaign.own.step if campaign.own else 1.0
    at = kind(state.groups) if state.missing else None
    return {
        "round": state.number,
        "campaign": campaign.name,
        "reading": campaign.reading,
        "own": campaign.own and campaign.own._asdict(),
        "split": campaign.how,
        "effects": list(state.fit.model.names),
        "found": list(state.found),
        "duration_s": max((float(np.ptp(swing.times)) for swing in campaign.whole), default=None),
        "parameters": _parameters(state.model),
        "widened": {name: factor for name, factor in state.widened.items() if name in state.model.values},
        "nuisance": _nuisance(state.model),
        in_unit("systematic", campaign.reading): campaign.systematic,
        "own_frequency": frequencies(state.fit, state.holdout, campaign),
        "largest_angle_rad": max(largest_angles(state.fit, [swing.pair for swing in campaign.fit])),
        in_unit("noise_rms", campaign.reading): state.noise.deviation,
        "noise_correlation": state.noise.correlation,
        "gap": {"fit": gap(state.fit, state.noise), "holdout": gap(state.holdout, state.noise)},
        "gap_by_swing": dict(zip(swings, map(float, ratios), strict=True)),
        "missing": state.missing,
        in_unit("unnamed", campaign.reading): state.unnamed,
        "lacks": {name: step * size for name, size in state.sizes.items()},
        "kind": at,
        "seen": said(state.half_swings, at, campaign.own),
        "groups": [vars(group) for group in state.groups],
        "ranking": [
            {"move": one.move, "added": one.added, "also": list(one.also), "dropped": one.dropped, "delta_bic": one.bic - best, "gain_bic": state.bic - one.bic,
             "rms_rad": one.fit.rms, "tied": any(one is tie for tie in state.ties), "refused": one.refused, "effects": one.fit.model.label}
            for one in state.ranked
        ],
        "reason": state.reason,
        "findings": {name: _finding(one) for name, one in state.findings.items()},
        "probabilities": dict(state.probabilities),
        "nothing": state.nothing,
        "next_swing": None if state.next_swing is None else asdict(state.next_swing) | {"text": str(state.next_swing)},
        "spent": state.spent,
        "unit_doubt": state.unit_doubt,
        "driven": campaign.fit[0].drive is not None,
        "failed": state.failed,
        "criterion": asdict(state.criterion),
        "conclusion": state.concluded,
        "chosen": None if chosen is None else {"move": chosen.move, "added": chosen.added, "also": list(chosen.also),
                                               "dropped": chosen.dropped, "gain_bic": state.bic - chosen.bic},
    }  # fmt: skip


def _parameters(model: Model) -> dict[str, dict[str, Any]]:
    return {name: _estimate(model, name) for name in model.values if name not in model.slack.parameters}


def _nuisance(model: Model) -> dict[str, dict[str, Any]]:
    """What the measurement left open, as it came out, and the standard uncertainty it had before."""
    return {
        name: _estimate(model, name) | {"before": before} for name, before in model.slack.deviations.items()
    }


def _estimate(model: Model, name: str) -> dict[str, Any]:
    error = finite_or_none(model.standard_errors.get(name))
    return {"value": model.values[name], "standard_error": error, "unit": model.units[name]}


def _finding(one: Finding) -> dict[str, Any]:
    """A ``Finding`` for a file: a number that is none is null there."""
    told = {
        key: finite_or_none(value) if isinstance(value, float) else value
        for key, value in asdict(one).items()
    }
    return told | {"ties": list(one.ties), "doubt": one.why, "idle": one.idle}
