"""A LabJack as a source, through LabJack's own Python package and an EMULATED library (ljm/ljm.c) in the place of LJM."""

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from traffic import SETTINGS

from swingdown import dataset

NC = "resources/recordings/a.nc"
CAPTURE = """
import json, sys
from swingdown.capture import job as jobs, recording
from swingdown.errors import InputError
try:
    print(recording.capture(jobs.job(json.loads(sys.argv[1]))))
except InputError as error:
    sys.exit(str(error))
"""


@pytest.fixture(scope="module")
def library(tmp_path_factory):
    """The folder of the emulated library."""
    if not shutil.which("gcc"):
        pytest.skip("NOT TESTED: gcc is not here")
    folder = tmp_path_factory.mktemp("ljm")
    source = Path(__file__).with_name("ljm") / "ljm.c"
    command = [
        "gcc",
        "-Wall",
        "-Wextra",
        "-Werror",
        "-shared",
        "-fPIC",
        source,
        "-o",
        folder / "libLabJackM.so",
        "-lm",
    ]
    subprocess.run(command, check=True)
    return folder


@pytest.fixture
def capture(library, tmp_path):
    """A function that records from ``labjack://`` in a process of its own: the process when it has ended."""

    def run(port="labjack://T7/ANY/AIN0", emulated=True, **more):
        said = {key: str(more.pop(key)) for key in ("LJM_LOSE", "LJM_UNPLUG") if key in more}
        settings = {**SETTINGS, "port": port, "rate_hz": 200, "duration_s": 2, **more}
        config = {"recording": "a", "recordings": "sheet.csv", "capture": settings}
        path = {"LD_LIBRARY_PATH": str(library)} if emulated else {}
        return subprocess.run(
            [sys.executable, "-c", CAPTURE, json.dumps(config)],
            cwd=tmp_path, env={**os.environ, **path, **said}, capture_output=True, text=True,
        )  # fmt: skip

    return run


def test_a_stream_is_recorded_on_the_devices_clock(capture, tmp_path):
    done = capture()
    assert "a: complete: 400 of 400 samples" in done.stdout, done.stderr
    data = dataset.read(tmp_path / NC)
    assert data["time"].values == pytest.approx(np.arange(400) / 200)
    at = data["sequence"].values
    assert data["voltage"].values == pytest.approx(2.5 + 1.5 * np.cos(7.25 * at / 200))
    assert data.attrs["partial"] == "no" and data.attrs["format"] == "readings"
    assert "labjack://T7/ANY/AIN0" in data.attrs["source"]


def test_the_rate_is_the_one_that_the_device_tells(capture, tmp_path):
    """It divides its clock by a whole number: asked for 333, it gives 333.0003."""
    assert "complete" in capture(rate_hz=333).stdout
    data = dataset.read(tmp_path / NC)
    assert data.attrs["rate_hz"] == pytest.approx(1e6 / 3003, rel=1e-12)


def test_scans_that_the_device_lost_are_told(capture, tmp_path):
    done = capture(LJM_LOSE=20)
    assert done.returncode and "20 frames lost and 0 damaged of 400" in done.stderr
    data = dataset.read(tmp_path / NC)
    assert list(data["missing_sequence"].values) == list(range(100, 120))
    assert data["voltage"].values.min() > 0


def test_a_device_that_goes_away_keeps_what_came(capture, tmp_path):
    done = capture(LJM_UNPLUG=150)
    assert done.returncode and "marked partial: disconnected" in done.stderr
    assert dataset.read(tmp_path / NC).sizes["time"] == 150


@pytest.mark.parametrize(
    ("port", "more", "told"),
    [
        ("labjack://T7/AIN0", {}, "is not complete.*labjack://T7/ANY/AIN0"),
        ("labjack://T4/ANY/AIN0", {}, "LJME_DEVICE_NOT_FOUND"),
        ("labjack://T7/ANY/FIO7", {}, "refuses the stream.*LJME_INVALID_NAME"),
        ("labjack://T7/ANY/AIN0", {"emulated": False}, "LJM library cannot be used.*install LJM"),
    ],
)
def test_what_cannot_be_opened_is_told_with_its_mend(capture, port, more, told):
    done = capture(port, **more)
    assert done.returncode

    assert re.search(told, done.stderr), done.stderr
    assert "Traceback" not in done.stderr


@pytest.mark.slow("a capture by the workflow")
def test_the_capture_rule_takes_a_labjack(library, snakemake, tmp_path, monkeypatch):
    monkeypatch.setenv("LD_LIBRARY_PATH", str(library))
    (tmp_path / "study.yaml").write_text(
        "recordings: recordings.csv\ncapture: {port: labjack://T7/ANY/AIN0, duration_s: 2, settle_s: 0, emulated: true}\n"
    )
    done = snakemake(
        "capture", "--configfile", tmp_path / "study.yaml", "--config", "recording=swing", directory=tmp_path, environment={},
    )  # fmt: skip
    assert "swing: complete: 200 of 200 samples" in done.stdout
