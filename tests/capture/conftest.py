"""A line to a board that is played, and a capture from it."""

import pytest
from traffic import SETTINGS, Line

from swingdown.capture import job as jobs
from swingdown.capture import recording


@pytest.fixture
def line(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    made = Line()
    yield made
    made.close()


@pytest.fixture
def record(line):
    """A function that records what ``pieces`` of (pause, bytes) send, and returns what the experimenter is told."""

    def run(pieces=(), unplug=False, stop=None, name="a", role="", **capture):
        config = {
            "recording": name,
            "role": role,
            "recordings": "sheet.csv",
            "capture": {**SETTINGS, "port": line.port, **capture},
        }
        line.play(pieces, unplug)
        return recording.capture(jobs.job(config), stop=stop)

    return run
