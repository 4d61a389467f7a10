"""The capture rule as the experimenter runs it: in a terminal, with Ctrl-C, twice by mistake, killed."""

import contextlib
import os
import pty
import re
import select
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from traffic import Line, frame

from swingdown import dataset

STUDY = """\
recordings: recordings.csv
simulation: {{simulated: []}}
capture:
  port: {port}
  scale: 0.005
  duration_s: {duration}
  settle_s: 0
  timeout_s: 1
  emulated: true
  campaign: mine
  operator: A. Nobody
  apparatus: none
  notes: a pseudo-terminal
"""


class Session:
    """``snakemake capture`` in a terminal of its own, beside a line that sends a swing at 100 S/s."""

    def __init__(self, folder, root):
        self.folder, self.root, self.line = folder, root, Line()
        self.sent, self.shown, self.code = 0, b"", None

    def run(self, *config, duration=2, when=b"", then=None, name="swing-07"):
        """Runs it to its end; when the terminal shows ``when``, (a pattern) calls ``then`` once. Returns all that was shown."""
        (self.folder / "study.yaml").write_text(STUDY.format(port=self.line.port, duration=duration))
        command = [
            sys.executable, "-m", "snakemake", "-c1", "capture", "--configfile", self.folder / "study.yaml",
            "--directory", self.folder, "--config", *([f"recording={name}"] if name else []), *config,
        ]  # fmt: skip
        self.pid, self.terminal = pty.fork()
        if self.pid == 0:
            os.chdir(self.root)
            os.environ["TERM"] = "xterm"
            os.execv(sys.executable, list(map(str, command)))
        self.shown, begun, self.sent = b"", time.monotonic(), 0
        while time.monotonic() - begun < 60:
            ready, _, _ = select.select([self.terminal], [], [], 0.01)
            if ready:
                try:
                    piece = os.read(self.terminal, 65536)
                except OSError:
                    break
                if not piece:
                    break
                self.shown += piece
            while self.sent < 100 * (time.monotonic() - begun):
                with contextlib.suppress(BlockingIOError):
                    self.line.send(frame(self.sent, int(500 + 300 * np.cos(self.sent / 15))))
                self.sent += 1
            if then and re.search(when, self.shown):
                then, _ = None, then()
        self.code = os.waitstatus_to_exitcode(os.waitpid(self.pid, 0)[1])
        return self.shown.decode()

    def script(self):
        """The process id of the running capture script."""
        children = subprocess.run(
            ["ps", "-o", "pid=", "--ppid", str(self.pid)], capture_output=True, text=True
        ).stdout.split()
        return int(children[-1])


@pytest.fixture
def bench(tmp_path, root):
    made = Session(tmp_path, root)
    os.set_blocking(made.line._board, False)
    yield made
    made.line.close()


def test_in_a_terminal_one_sees_what_is_recorded_and_it_is_never_overwritten(bench, tmp_path):
    shown = bench.run("live=true")
    assert bench.code == 0, shown
    assert "RECORDING (Ctrl-C stops)" in shown and "S/s" in shown and "0 lost, 0 damaged" in shown
    assert any(0x2800 < ord(character) < 0x2900 for character in shown)  # the trace
    assert "swing-07: complete: 200 of 200 samples" in shown
    if not os.environ.get("DISPLAY"):
        assert "no live window: there is no screen" in shown
    data = dataset.read(tmp_path / "resources/recordings/swing-07.nc")
    assert data.attrs["operator"] == "A. Nobody" and data.attrs["notes"] == "a pseudo-terminal"
    assert data.attrs["apparatus"] == "none" and data.attrs["campaign"] == "mine"

    # A second time nothing changes, also with a script newer than the recording, for which Snakemake would run a rule again.
    recording, sheet = tmp_path / "resources/recordings/swing-07.nc", tmp_path / "recordings.csv"
    before = recording.read_bytes(), sheet.read_bytes()
    assert sheet.read_text().count("swing-07,mine,resources/recordings/swing-07.nc") == 1
    os.utime(recording, (0, 0))
    shown = bench.run()
    assert bench.code != 0 and "a recording is never overwritten" in shown and "Traceback" not in shown
    assert (recording.read_bytes(), sheet.read_bytes()) == before


def test_ctrl_c_ends_a_recording_and_keeps_it(bench, tmp_path):
    shown = bench.run(
        duration="null", when=rb" [1-9]\.\d s \|", then=lambda: os.write(bench.terminal, b"\x03")
    )
    assert bench.code == 0, shown
    assert "swing-07: stopped: " in shown and "1 of 1 jobs done" in shown
    data = dataset.read(tmp_path / "resources/recordings/swing-07.nc")
    assert data.attrs["status"] == "stopped" and data.attrs["partial"] == "no" and data.sizes["time"] > 100


def test_a_session_is_led_by_prompts_and_enter(bench, tmp_path):
    """Two records at rest, each after Enter in the terminal."""
    asked = []

    def answer():
        os.write(bench.terminal, b"\n\n")
        asked.append(1)

    shown = bench.run(
        "role=static",
        "capture={still_s: 0.5, countdown_s: 0}",
        name="rest-1,rest-2",
        when=rb"Press Enter",
        then=answer,
    )
    assert bench.code == 0 and asked, shown
    assert "rest-1 (1 of 2): let the bob hang at rest" in shown and "rest-2 (2 of 2)" in shown
    assert "2 of 2 recorded" in shown
    text = (tmp_path / "recordings.csv").read_text()
    assert text.count("static") == 2 and text.index("rest-1") < text.index("rest-2")
    for name in ("rest-1", "rest-2"):
        assert dataset.read(tmp_path / f"resources/recordings/{name}.nc").sizes["time"] == 50


@pytest.mark.slow("a terminal")
def test_the_monitor_records_nothing_and_ctrl_c_ends_it(bench, tmp_path):
    shown = bench.run(
        "monitor=true", name=None, when=rb"period \d", then=lambda: os.write(bench.terminal, b"\x03")
    )
    assert bench.code == 0, shown
    assert "noise" in shown and "S/s by this computer" in shown and "nothing was recorded" in shown
    assert not (tmp_path / "resources").exists() and not (tmp_path / "recordings.csv").exists()


@pytest.mark.slow("a terminal")
def test_killed_and_recovered_by_the_rule(bench, tmp_path):
    raw = tmp_path / "resources/recordings/swing-07.raw"
    shown = bench.run(
        duration=30, when=rb" [1-9]\.\d s \|", then=lambda: os.kill(bench.script(), signal.SIGKILL)
    )
    assert bench.code != 0, shown
    assert raw.exists() and not raw.with_suffix(".nc").exists() and not (tmp_path / "recordings.csv").exists()
    shown = bench.run("recover=true", duration=30)
    assert "recovered from the raw stream" in shown, shown
    assert dataset.read(raw.with_suffix(".nc")).sizes["time"] >= 90 and not raw.exists()
    assert "swing-07" in (tmp_path / "recordings.csv").read_text()


@pytest.mark.slow("a terminal")
def test_a_missing_port_is_told_in_one_block(bench, tmp_path):
    bench.line.port = "/dev/ttyACM99"
    shown = bench.run()
    assert bench.code != 0 and shown.count("This input cannot be used.") == 1
    assert "no port /dev/ttyACM99" in shown and "ports there are" in shown and "Traceback" not in shown
    assert not Path(tmp_path / "resources/recordings/swing-07.raw").exists()
