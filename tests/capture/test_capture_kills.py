"""Captures that are killed, and what is recovered from the raw stream that they leave."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
import yaml
from one_recording import NC, RAW, SWING, recover, row, swing
from traffic import SETTINGS

from swingdown import dataset
from swingdown.capture.journal import Journal
from swingdown.errors import InputError
from swingdown.measurement.recording import ingest

KILLED = """
import sys
from swingdown.capture import job as jobs
from swingdown.capture import recording
sys.path.insert(0, {here!r})
from traffic import SETTINGS
config = {{"recording": "a", "recordings": "sheet.csv", "capture": {{**SETTINGS, "port": {port!r}}}, **{more!r}}}
print("ready", flush=True)
recording.capture(jobs.job(config))
"""


def killed(line, after, **more):
    """A capture in a process of its own that is killed after some seconds of frames."""
    code = KILLED.format(here=str(Path(__file__).parent), port=line.port, more=more)
    process = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE)
    process.stdout.readline()
    line.play(swing())
    line.begun.wait(30)
    time.sleep(after)
    process.send_signal(signal.SIGKILL)
    process.wait()


def test_killed_during_the_recording(line, record):
    """The file is absent, the raw stream up to then is whole, and a recording is made of it."""
    killed(line, 0.75)
    assert not NC.exists() and RAW.exists() and not Path("sheet.csv").exists()
    with pytest.raises(
        InputError, match=r"a\.raw: an earlier capture of this name did not finish.*recover=true"
    ):
        record(swing())
    told = recover()
    assert "a: stopped, PARTIAL" in told and "recovered from the raw stream" in told
    data = dataset.read(NC)
    assert data.sizes["time"] >= 50 and list(data["sent"].values) == SWING[: data.sizes["time"]]
    assert data.attrs["partial"] == "yes" and not RAW.exists()
    assert row().file == str(NC)


def test_killed_when_all_had_arrived(line):
    """A torn write at the end of the raw stream is no harm, and a recording that has its full count is whole."""
    journal = Journal(
        RAW,
        {"settings": {**SETTINGS, "port": "x"}, "about": {"campaign": "mine", "role": ""}, "opened": 100.0},
    )
    for k, (_, data) in enumerate(swing([*SWING, *SWING])):
        journal.add(data, 100 + k / 10)
    journal.close()
    with open(RAW, "r+b") as file:
        file.truncate(RAW.stat().st_size - 3)
    assert "a: complete: 100 of 100" in recover()
    assert ingest(row(), "sheet.csv").attrs["partial"] == "no"


def test_recovery_gives_what_the_capture_itself_gave(record, monkeypatch):
    monkeypatch.setattr(Journal, "remove", lambda self: os.rename(self.path, "kept"))
    record(swing())
    live = dataset.read(NC)
    NC.unlink()
    os.rename("kept", RAW)
    Path("sheet.csv").unlink()
    recover()
    xr.testing.assert_identical(live, dataset.read(NC))


APPARATUS = "campaigns: [mine]\nlengths: {}\npoints: []\n"


def test_a_killed_tower_becomes_a_tower(line):
    """The raw stream keeps the height and the sheet, whatever the command that recovers it says."""
    Path("apparatus.yaml").write_text(APPARATUS)
    killed(line, 0.5, height=0.05, apparatus="apparatus.yaml")
    assert RAW.exists() and not NC.exists()
    told = recover()
    assert "apparatus.yaml" in told and not Path("sheet.csv").exists()
    (point,) = yaml.safe_load(Path("apparatus.yaml").read_text())["points"]
    assert point["height"] == 0.05 and point["file"] == str(NC)


def test_a_capture_that_still_runs_is_not_recovered(line):
    Journal(RAW, {"settings": {**SETTINGS, "port": "x"}, "about": {}, "opened": 100.0})
    with pytest.raises(InputError, match="still running"):
        recover()


def test_killed_between_the_file_and_the_row(record):
    record(swing())
    before = NC.read_bytes()
    Path("sheet.csv").unlink()
    Journal(RAW, {"settings": {**SETTINGS, "port": "x"}, "about": {}, "opened": 100.0}).close()
    assert "whole already" in recover()
    assert NC.read_bytes() == before and row().file == str(NC) and not RAW.exists()

    Journal(RAW, {"settings": {**SETTINGS, "port": "x"}, "about": {}, "opened": 100.0}).close()
    sheet = Path("sheet.csv").read_text()
    assert "whole already" in recover()  # killed after the row
    assert Path("sheet.csv").read_text() == sheet and not RAW.exists()


def test_nothing_to_recover(line):
    with pytest.raises(InputError, match="no raw stream to recover"):
        recover()


def test_one_flipped_bit_in_the_file_is_noticed(record):
    record(swing())
    whole = bytearray(NC.read_bytes())
    raised = 0
    places = np.random.default_rng(1).integers(0, len(whole) * 8, 60)
    for place in places:
        bad = bytearray(whole)
        bad[place // 8] ^= 1 << place % 8
        NC.write_bytes(bad)
        try:
            ingest(row(), "sheet.csv")
        except InputError:
            raised += 1
    assert raised == 60  # by its checksum in the sheet


def test_silence_that_could_hide_a_wrap_is_refused(record):
    with pytest.raises(InputError, match=r"could start again unnoticed.*at most 16\.4 s"):
        record(rate_hz=1000, timeout_s=20)


def test_no_release_keeps_the_raw_stream_for_the_swing_in_it(record):
    trigger = {"threshold": 500, "pre_s": 0.2, "wait_s": 0.8}
    with pytest.raises(
        InputError, match=r"no release within 0\.8 s; the signal was between 2\d\d and 800 V.*recover=true"
    ):
        record(swing(), trigger=trigger)
    told = recover()
    assert "a: stopped, PARTIAL" in told and "not known where the swing begins" in told
    assert list(dataset.read(NC)["sent"].values)[:30] == SWING[:30]
