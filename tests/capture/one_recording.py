"""A swing that a board sends, and the files and the row that a recording of it leaves."""

from pathlib import Path

import numpy as np
from traffic import SETTINGS, frames

from swingdown.capture import job as jobs
from swingdown.capture import recording
from swingdown.measurement.sheet import read_sheet

NC, RAW = Path("resources/recordings/a.nc"), Path("resources/recordings/a.raw")
SWING = [int(500 + 300 * np.cos(k / 15)) for k in range(100)]


def swing(values=SWING, first=0, piece=10):
    """Pieces of ten frames at their pace: 100 samples a second."""
    return [(piece / 100, frames(values[k : k + piece], first + k)) for k in range(0, len(values), piece)]


def row(name="a"):
    return read_sheet("sheet.csv").loc[name]


def recover(**capture):
    config = {
        "recording": "a",
        "recordings": "sheet.csv",
        "recover": True,
        "capture": {**SETTINGS, "port": "gone", **capture},
    }
    return recording.recover(jobs.job(config))
