"""Verdicts on the campaigns of a sample sheet, one after the other: what the scorer holds against the truth."""

import time
from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from swingdown import dataset
from swingdown.discovery.data.campaign import Swing, campaign
from swingdown.discovery.search import discover
from swingdown.discovery.tell.conclusion import concluded
from swingdown.discovery.tell.files import summary
from swingdown.discovery.tell.verdict import verdict
from swingdown.errors import InputError
from swingdown.measurement.angle import to_angle
from swingdown.measurement.recording import ingest
from swingdown.measurement.sheet import read_sheet
from swingdown.measurement.slack import of_angles
from swingdown.pendulum.model import Model

from .trial import calibration_of


def find(
    sheet: Path | str, base: Model, rounds: int, excluded: Mapping[str, Iterable[str]] | None = None
) -> dict[str, Any]:
    """A dict by campaign of the sample sheet: ``verdict``, ``seconds`` of CPU time, and of the first round the swings that
    were fitted and the residual (rad) that each effect leaves of them that could be added, by name; ``refused`` are the recordings
    that the import does not take, which are left out; ``duration_s``, the longest of those used.

    ``excluded`` names for a campaign the effects that its catalogue lacks. InputError where the import takes none of a campaign's
    recordings.
    """
    table, found = read_sheet(sheet), {}
    for name, rows in table.groupby("campaign", sort=False):
        started = time.process_time()
        swings, read, refused = [], [], {}
        beside = calibration_of(Path(rows["file"].iloc[0]).parent, str(name))
        calibration = dataset.read(beside) if beside.is_file() else None
        for recording, row in rows.iterrows():
            try:
                data = to_angle(ingest(row, str(sheet)), calibration)
            except InputError as problem:
                refused[str(recording)] = problem.problem
                continue
            swings.append(Swing(str(recording), data["time"].values, data["angle"].values))
            read.append(data)
        one = campaign(str(name), swings)
        if calibration is not None:
            systematic = max(float(data["angle_systematic_uncertainty"].max()) for data in read)
            one = replace(one, systematic=systematic, slack=of_angles(read))
        lacks = set((excluded or {}).get(name, ()))
        allowed = [name for name in base.catalogue.names if name not in lacks]
        states = concluded(discover(one, base, rounds, allowed), one)
        told = [summary(state, one) for state in states]
        ranked = [
            row for row in told[0]["ranking"] if not row["refused"] and row["added"] and not row["also"]
        ]
        found[str(name)] = {
            "verdict": verdict(told, base.catalogue),
            "seconds": time.process_time() - started,
            "fitted": [swing.name for swing in one.fit],
            "refused": refused,
            "duration_s": told[-1]["duration_s"],
            "rms_rad": {
                row["added"]: row["rms_rad"] for row in sorted(ranked, key=lambda row: -row["rms_rad"])
            },
        }
    return found
