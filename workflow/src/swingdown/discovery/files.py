"""A round of discovery as files: what a search writes, and what verdict, figures and report read."""

import json
from collections.abc import Iterable, Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from .. import dataset
from ..measurement.slack import of_angles
from ..paths import write_csv, write_text
from ..pendulum.model import Model, write_model
from .campaign import Campaign, Swing, campaign
from .confirm import gap, per_swing
from .half_swings import said
from .locate import kind
from .state import Round

_RANKING = ["move", "added", "also", "dropped", "delta_bic", "gain_bic", "rms_rad", "tied", "correlation", "out_of_sample", "refused", "effects"]  # fmt: skip


def read_campaign(name: str, paths: Sequence[Path | str], roles: Sequence[str]) -> tuple[Campaign, bool]:
    """The ``Campaign`` of angle files, and whether any is emulated: ``roles`` gives each one's role in the sample sheet
    (fit, holdout, static or empty).
    """
    kinds: dict[str, list[Swing]] = {"fit": [], "holdout": [], "static": []}
    emulated, systematic = False, 0.0
    read: list[xr.Dataset] = []
    for path, role in zip(paths, roles, strict=True):
        data = dataset.read(path)
        swing = Swing(str(data.attrs["recording"]), data["time"].values, data["angle"].values)
        systematic = max(systematic, float(data["angle_systematic_uncertainty"].max()))
        emulated |= str(data.attrs.get("emulated", "no")) == "yes"
        kinds[role or "fit"].append(swing)
        read.append(data)
    static = [swing.pair for swing in kinds["static"]]
    known = campaign(name, kinds["fit"], kinds["holdout"], static)
    return replace(known, systematic=systematic, slack=of_angles(read)), emulated


def write_round(state: Round, campaign: Campaign, folder: Path | str, emulated: bool) -> Path:
    """The folder written: round.json, model.yaml, fit.nc and the tables of one ``Round`` (groups, ranking, map, unnamed, half-swings)."""
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    told = summary(state, campaign)
    write_model(state.model, folder / "model.yaml")
    write_csv(pd.DataFrame(told["groups"]), folder / "groups.csv")
    write_csv(pd.DataFrame(told["ranking"], columns=_RANKING), folder / "ranking.csv")
    write_csv(state.curves, folder / "map.csv", float_format="%.6g")
    write_csv(state.kept, folder / "unnamed.csv", float_format="%.6g")
    write_csv(state.half_swings, folder / "half_swings.csv", float_format="%.6g")
    dataset.write(_series(state, campaign, emulated), folder / "fit.nc")
    write_text(folder / "round.json", json.dumps(told, indent=1) + "\n")
    return folder


def _series(state: Round, campaign: Campaign, emulated: bool) -> xr.Dataset:
    """Data and fit of every swing, fitted and held out, as one ragged dataset (swing index by sample)."""
    swings = [*campaign.fit, *campaign.holdout]
    series = [one.angle for one in (*state.fit.swings, *state.holdout.swings)]
    rad = {"units": "rad"}
    return xr.Dataset(
        {
            "angle": (
                "sample",
                np.concatenate([s.angle for s in swings]),
                rad | {"long_name": "measured angle"},
            ),
            "fit": ("sample", np.concatenate(series), rad | {"long_name": "fitted angle"}),
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
            "noise_rms_rad": state.noise.deviation,
            "model": state.fit.model.label,
        },
    )


def summary(state: Round, campaign: Campaign) -> dict[str, Any]:
    """What round.json holds of a ``Round``: the state in numbers and words, the groups, and the ranking."""
    chosen, swings = state.chosen, [s.name for s in (*campaign.fit, *campaign.holdout)]
    ratios = [*per_swing(state.fit, state.noise), *per_swing(state.holdout, state.noise)]
    best = state.ranked[0].bic if state.ranked else 0.0
    at = kind(state.groups) if state.missing else None
    return {
        "round": state.number,
        "campaign": campaign.name,
        "split": campaign.how,
        "effects": list(state.fit.model.names),
        "found": list(state.found),
        "parameters": _parameters(state.model),
        "nuisance": _nuisance(state.model),
        "systematic_rad": campaign.systematic,
        "largest_angle_rad": float(np.max(np.abs(state.fit.angle))),
        "noise_rms_rad": state.noise.deviation,
        "noise_correlation": state.noise.correlation,
        "gap": {"fit": gap(state.fit, state.noise), "holdout": gap(state.holdout, state.noise)},
        "gap_by_swing": dict(zip(swings, map(float, ratios), strict=True)),
        "missing": state.missing,
        "kind": at,
        "seen": said(state.half_swings, at),
        "groups": [vars(group) for group in state.groups],
        "ranking": [
            {"move": one.move, "added": one.added, "also": list(one.also), "dropped": one.dropped, "delta_bic": one.bic - best, "gain_bic": state.bic - one.bic,
             "rms_rad": one.fit.rms, "tied": any(one is tie for tie in state.ties), "correlation": state.alike.get(one.move),
             "out_of_sample": state.out_of_sample.get(one.move), "refused": one.refused, "effects": one.fit.model.label}
            for one in state.ranked
        ],
        "rivals": state.rivals,
        "reason": state.reason,
        "established": state.established,
        "established_in": state.established_in,
        "probabilities": dict(state.probabilities),
        "next_swing": None if state.next_swing is None else asdict(state.next_swing) | {"text": str(state.next_swing)},
        "spent": state.spent,
        "chosen": None if chosen is None else {"move": chosen.move, "added": chosen.added, "also": list(chosen.also),
                                               "dropped": chosen.dropped, "gain_bic": state.bic - chosen.bic},
    }  # fmt: skip


def _parameters(model: Model) -> dict[str, dict[str, Any]]:
    return {
        name: {
            "value": value,
            "standard_error": _finite(model.standard_errors.get(name)),
            "unit": model.units[name],
        }
        for name, value in model.values.items()
        if name not in model.slack.parameters
    }


def _nuisance(model: Model) -> dict[str, dict[str, Any]]:
    """What the measurement left open, as it came out, and the standard uncertainty it had before."""
    return {
        name: {"value": model.values[name], "standard_error": _finite(model.standard_errors.get(name)), "unit": model.units[name],
               "before": before}
        for name, before in model.slack.deviations.items()
    }  # fmt: skip


def _finite(value: float | None) -> float | None:
    return float(value) if value is not None and np.isfinite(value) else None


def read_rounds(folders: Iterable[Path | str]) -> list[dict[str, Any]]:
    """The round.json of each folder, in order."""
    return [json.loads((Path(folder) / "round.json").read_text()) for folder in folders]
