"""A round of discovery as files: written by one job, read by the next."""

import json
from pathlib import Path

import numpy as np
import pandas as pd
import xarray as xr

from .. import dataset
from ..model import Model, write_model
from .campaign import Swing, campaign
from .confirm import gap, per_swing
from .half_swings import half_swings
from .linear import each_model


def read_campaign(name, paths, roles):
    """The ``Campaign`` of angle files: ``roles`` gives each one's role in the sample sheet (fit, holdout, static or empty)."""
    kinds = {"fit": [], "holdout": [], "static": []}
    emulated = False
    for path, role in zip(paths, roles, strict=True):
        with xr.open_dataset(path) as data:
            swing = Swing(str(data.attrs["recording"]), data["time"].values, data["angle"].values)
            emulated |= str(data.attrs.get("emulated", "no")) == "yes"
        kinds[role or "fit"].append(swing)
    static = [swing.pair for swing in kinds["static"]]
    return campaign(name, kinds["fit"], kinds["holdout"], static), emulated


def write_round(state, campaign, folder, emulated):
    """The folder written: model.yaml, fit.nc, groups.csv, ranking.csv and round.json of one ``Round``."""
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    write_model(state.fit.model, folder / "model.yaml")
    pd.DataFrame([vars(group) for group in state.groups]).to_csv(folder / "groups.csv", index=False)
    best = state.ranked[0].bic if state.ranked else 0.0
    rows = [
        {"move": one.move, "added": one.added, "dropped": one.dropped, "delta_bic": one.bic - best, "rms_rad": one.fit.rms,
         "tied": one in state.ties, "refused": one.refused, "effects": one.fit.model.label}
        for one in state.ranked
    ]  # fmt: skip
    columns = ["move", "added", "dropped", "delta_bic", "rms_rad", "tied", "refused", "effects"]
    pd.DataFrame(rows, columns=columns).to_csv(folder / "ranking.csv", index=False)
    dataset.write(_series(state, campaign, emulated), folder / "fit.nc")
    (folder / "round.json").write_text(json.dumps(_summary(state, campaign), indent=1) + "\n")
    return folder


def _series(state, campaign, emulated):
    """Data and fit of every swing, fitted and held out, as one ragged dataset (swing index by sample)."""
    swings = [*campaign.fit, *campaign.holdout]
    series = [*state.fit.angle, *state.holdout.angle]
    rad = {"units": "rad"}
    return xr.Dataset(
        {
            "angle": ("sample", np.concatenate([s.angle for s in swings]), rad | {"long_name": "measured angle"}),
            "fit": ("sample", np.concatenate(series), rad | {"long_name": "fitted angle"}),
            "time": ("sample", np.concatenate([s.times for s in swings]), {"units": "s", "long_name": "time"}),
            "swing": ("sample", np.repeat(np.arange(len(swings)), [s.times.size for s in swings])),
        },
        {"name": ("swings", [s.name for s in swings]), "held_out": ("swings", [s in campaign.holdout for s in swings])},
        {"campaign": campaign.name, "emulated": "yes" if emulated else "no"},
    )


def _summary(state, campaign):
    chosen = state.chosen
    return {
        "round": state.number,
        "campaign": campaign.name,
        "split": campaign.how,
        "effects": list(state.fit.model.effects),
        "noise_rms_rad": state.noise.deviation,
        "noise_correlation": state.noise.correlation,
        "gap": {"fit": gap(state.fit, state.noise), "holdout": gap(state.holdout, state.noise)},
        "gap_by_swing": dict(zip([s.name for s in (*campaign.fit, *campaign.holdout)],
                                 [*per_swing(state.fit, state.noise), *per_swing(state.holdout, state.noise)], strict=True)),
        "missing": state.missing,
        "reason": state.reason,
        "chosen": None if chosen is None else {"move": chosen.move, "added": chosen.added, "dropped": chosen.dropped},
        "next": None if chosen is None else _start(chosen.fit),
        "fit": _start(state.fit),
    }  # fmt: skip


def _start(fit):
    """What a fit of the same swings can begin from: effects, each swing's values, releases."""
    return {
        "effects": list(fit.model.effects),
        "values": [model.values for model in each_model(fit)],
        "release_angle": list(fit.release_angle),
        "release_velocity": list(fit.release_velocity),
    }


def read_rounds(folders):
    """The round.json of each folder, in order."""
    return [json.loads((Path(folder) / "round.json").read_text()) for folder in folders]


class Beginning:
    """A start read from a file, as the fitter takes a fit: model, own values, releases."""

    def __init__(self, start, restoring, form):
        model = Model(tuple(start["effects"]), restoring=restoring, form=form)
        self.model = model.with_values(start["values"][0])
        self.own = tuple(start["values"])
        self.release_angle, self.release_velocity = tuple(start["release_angle"]), tuple(start["release_velocity"])


def campaign_half_swings(fit_dataset, natural_frequency):
    """Half-swing tables of data and fit, with the swing's name: one table with a column ``of`` (measured or modelled)."""
    tables = []
    for k, name in enumerate(fit_dataset["name"].values):
        rows = fit_dataset["swing"].values == k
        times = fit_dataset["time"].values[rows]
        for of, variable in (("measured", "angle"), ("modelled", "fit")):
            table = half_swings(times, fit_dataset[variable].values[rows], natural_frequency)
            tables.append(table.assign(swing=str(name), of=of))
    return pd.concat(tables, ignore_index=True)
