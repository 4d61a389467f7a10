"""From a port to a file and a row: what a fault leaves behind, and that nothing is ever overwritten."""

import contextlib
import errno
import os
import resource
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
import yaml
from traffic import SETTINGS, Line, frame, frames

from swingdown import dataset
from swingdown.capture import job as jobs
from swingdown.capture import recording, take
from swingdown.capture.journal import Journal, read_journal
from swingdown.errors import InputError
from swingdown.measurement.recording import ingest
from swingdown.measurement.sheet import read_sheet

NC, RAW = Path("resources/recordings/a.nc"), Path("resources/recordings/a.raw")
SWING = [int(500 + 300 * np.cos(k / 15)) for k in range(100)]


@pytest.fixture
def line(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    made = Line()
    yield made
    made.close()


@pytest.fixture
def record(line):
    """A function that records what ``pieces`` of (pause, bytes) send, and returns what the experimenter is told."""

    def run(pieces=(), unplug=False, stop=None, name="a", **capture):
        config = {
            "recording": name,
            "recordings": "sheet.csv",
            "capture": {**SETTINGS, "port": line.port, **capture},
        }
        line.play(pieces, unplug)
        return recording.capture(jobs.job(config), stop=stop)

    return run


def swing(values=SWING, first=0, piece=10):
    """Pieces of ten frames at their pace: 100 samples a second."""
    return [(piece / 100, frames(values[k : k + piece], first + k)) for k in range(0, len(values), piece)]


def row(name="a"):
    return read_sheet("sheet.csv").loc[name]


def test_a_recording_lands_in_its_file_and_in_the_sheet(record):
    told = record(swing())
    assert "a: complete: 100 of 100 samples" in told and "0 lost, 0 damaged" in told and "sheet.csv" in told
    recording = ingest(row(), "sheet.csv")
    assert recording["signal"].values == pytest.approx(SWING)
    assert recording["time"].values == pytest.approx(np.arange(100) / 100)
    assert recording.attrs["emulated"] == "yes" and recording.attrs["campaign"] == "mine"
    assert not RAW.exists() and [path.name for path in NC.parent.iterdir()] == ["a.nc"]


def test_lines_as_an_arduino_prints_them(record):
    """``Serial.print(millis()); Serial.print(","); Serial.println(angle)`` of a sketch that greets and is not quite regular."""
    late = [10 * k + (k % 3 == 0) for k in range(110)]
    text = [b"%d,%.2f\r\n" % (5000 + late[k], SWING[k % 100] / 10) for k in range(110)]
    pieces = [(0, b"pendulum 1.0\r\n"), *((0.1, b"".join(text[k : k + 10])) for k in range(0, 110, 10))]
    told = record(pieces, format="csv", columns=["time_ms", "angle"], signal_unit="deg")
    assert "a: complete: 100 of 100 samples" in told
    recording = ingest(row(), "sheet.csv")
    assert recording["signal"].attrs["units"] == "deg"
    assert recording["signal"].values == pytest.approx(np.array(SWING) / 10, abs=0.01)
    assert recording["time"].values == pytest.approx(
        (np.array(late[:100]) - 1) / 1000
    )  # the device's own clock


def test_unplugged_in_the_middle_of_a_frame(record):
    with pytest.raises(InputError, match="kept and marked partial: disconnected") as caught:
        record([*swing()[:4], (0.1, frame(40, 400)[:5])], unplug=True)
    assert "40 came" in str(caught.value) and "allow" in str(caught.value)
    data = dataset.read(NC)
    assert data.attrs["status"] == "disconnected" and data.attrs["expected"] == 100
    assert list(data["sent"].values) == SWING[:40]


def test_partial_recordings_are_refused_unless_the_sheet_allows_them(record):
    with pytest.raises(InputError):
        record(swing()[:4], unplug=True)
    with pytest.raises(
        InputError, match=r"sheet.csv, line 2, a, column partial.*the recording is partial.*40 of 100.*allow"
    ):
        ingest(row(), "sheet.csv")
    text = Path("sheet.csv").read_text()
    Path("sheet.csv").write_text(text.rstrip("\n") + "allow\n")
    recording = ingest(row(), "sheet.csv")
    assert recording.sizes["time"] == 40 and recording.attrs["partial"] == "yes"


def test_a_gap_of_lost_frames_is_partial_and_keeps_its_place_in_time(record):
    pieces = swing()
    with pytest.raises(InputError, match="10 frames lost and 0 damaged of 100"):
        record([*pieces[:4], (0.1, b""), *pieces[5:]])
    Path("sheet.csv").write_text(Path("sheet.csv").read_text().rstrip("\n") + "allow\n")
    recording = ingest(row(), "sheet.csv")
    assert recording["time"].values == pytest.approx(np.r_[0:40, 50:100] / 100)


def test_silence_from_the_beginning(record, line):
    with pytest.raises(
        InputError, match=r"nothing was recorded: timed out: for 0\.[5-9] s nothing came.*resources/firmware"
    ):
        record()
    assert not NC.exists() and not RAW.exists() and not Path("sheet.csv").exists()


def test_bytes_that_are_no_frames(record):
    with pytest.raises(InputError, match=r"400 bytes arrived and no whole frames sample.*capture.format"):
        record([(0.1, b"12,512\r\n" * 50)])


def test_a_stop_before_the_end(record):
    stop = threading.Event()
    threading.Timer(0.5, stop.set).start()
    told = record(swing(), stop=stop)
    assert "a: stopped, PARTIAL" in told and "early" in told
    assert dataset.read(NC).attrs["status"] == "stopped"


def test_a_stop_where_no_duration_is_fixed_is_a_whole_recording(record):
    stop = threading.Event()
    threading.Timer(1.8, stop.set).start()
    told = record(swing(), stop=stop, duration_s=None, timeout_s=2)
    assert "a: stopped: 100 of 100 samples" in told
    ingest(row(), "sheet.csv")


def test_a_recording_is_never_overwritten(record):
    record(swing())
    before = NC.read_bytes()
    with pytest.raises(
        InputError, match=r"a\.nc: there is a recording of this name, and .* never overwritten"
    ):
        record(swing())
    assert NC.read_bytes() == before


def test_not_even_one_that_appears_while_it_is_recorded(record):
    threading.Timer(0.5, lambda: NC.write_text("mine")).start()
    with pytest.raises(InputError, match="never overwritten"):
        record(swing())
    assert NC.read_text() == "mine"
    assert sum(len(data) for _, data in read_journal(RAW)[1]) == 800  # and what was recorded is kept


def test_nor_one_that_appears_in_the_last_moment(record, monkeypatch):
    record(swing())
    before = NC.read_bytes()
    monkeypatch.setattr(take, "check_absent", lambda path: None)
    with pytest.raises(InputError, match="never overwritten"):
        take.write_new(dataset.read(NC), NC)
    assert NC.read_bytes() == before and [path.name for path in NC.parent.iterdir()] == ["a.nc"]


@pytest.mark.parametrize(
    ("sheet", "told"),
    [
        ("recording,file\na,x.csv\n", "has a row 'a' already"),
        ("recording,fiel\nb,x.csv\n", "column fiel: unknown column"),
    ],
)
def test_a_sheet_that_cannot_take_the_row_is_told_before_the_swing(record, sheet, told):
    Path("sheet.csv").write_text(sheet)
    with pytest.raises(InputError, match=told):
        record(swing())
    assert not NC.exists() and Path("sheet.csv").read_text() == sheet


def test_a_folder_one_may_not_write_is_told_before_the_swing(record, tmp_path):
    root = os.geteuid() == 0
    os.chmod(tmp_path, 0o555)
    if root:
        os.seteuid(65534)
    try:
        with pytest.raises(InputError, match="may not be written by you"):
            record(swing())
    finally:
        if root:
            os.seteuid(0)
        os.chmod(tmp_path, 0o755)


def test_a_full_disk_before_the_recording(record, monkeypatch):
    usage = type("usage", (), {"free": 5000})
    monkeypatch.setattr(jobs.shutil, "disk_usage", lambda _: usage)
    with pytest.raises(OSError, match="the disk is full.*0.0 MB are free.*make room"):
        record(swing())
    assert not NC.exists()


def test_a_disk_that_fills_up_during_the_recording(record, monkeypatch):
    """The raw stream ends there, what had arrived is still made a recording, and it says that it is partial."""
    written, write = [], os.write

    def full(file, data):
        if len(written) > 30 and data.find(b"\xa5\x5a") == 12:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        written.append(len(data))
        return write(file, data)

    monkeypatch.setattr("swingdown.capture.journal.os.write", full)
    told = record(swing(piece=1), duration_s=1.0)
    assert "PARTIAL" in told and "No space left on device" in told
    assert 10 < dataset.read(NC).attrs["received"] < 100


def test_a_disk_without_room_for_the_recording_keeps_the_raw_stream(record, monkeypatch):
    def full(*_):
        raise OSError(errno.ENOSPC, "the disk is full: a.nc needs 1 MB. Mend: make room")

    monkeypatch.setattr(take.dataset, "write", full)
    with pytest.raises(OSError, match=r"the disk is full.*kept in resources/recordings/a\.raw.*recover=true"):
        record(swing())
    assert not NC.exists() and RAW.exists()


def test_a_limit_on_the_size_of_files_keeps_the_raw_stream(record):
    """``ulimit -f``: there is room, and the netCDF library says no more than that it failed."""
    limit = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (4000, limit[1]))
    try:
        with pytest.raises(InputError, match=r"it cannot be written.*a\.raw.*ulimit -f.*recover=true"):
            record(swing())
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limit)
    assert not NC.exists() and [path.name for path in NC.parent.iterdir()] == ["a.raw"]
    assert "100 of 100 samples" in recover()


@pytest.mark.skipif(os.geteuid() != 0, reason="NOT TESTED: a disk that is really full takes root")
@pytest.mark.parametrize("left", [0, 20_000])
def test_a_full_disk_is_told_in_one_block(snakemake, tmp_path, left):
    """Also where not even the logs can be written: no traceback, neither ours nor Snakemake's."""
    mounted = subprocess.run(
        ["mount", "-t", "tmpfs", "-o", "size=2m", "tmpfs", tmp_path], capture_output=True, text=True
    )
    if mounted.returncode:
        pytest.skip(f"NOT TESTED: no file system can be mounted here: {mounted.stderr}")
    try:
        (tmp_path / "study.yaml").write_text("recordings: recordings.csv\ncapture: {port: /dev/null}\n")
        with open(tmp_path / "other", "wb", buffering=0) as file, contextlib.suppress(OSError):
            while True:
                file.write(bytes(1000))
        os.truncate(tmp_path / "other", (tmp_path / "other").stat().st_size - left)
        done = snakemake(
            "capture", "--configfile", tmp_path / "study.yaml", "--config", "recording=a",
            directory=tmp_path, check=False,
        )  # fmt: skip
        assert done.returncode != 0 and "the disk is full" in done.stdout
        assert "Traceback" not in done.stdout and len(done.stdout.splitlines()) < 20, done.stdout
    finally:
        subprocess.run(["umount", "-l", tmp_path], check=True)


@pytest.mark.skipif(os.geteuid() != 0, reason="NOT TESTED: a disk that is really full takes root")
def test_a_disk_that_is_really_full(line, tmp_path):
    """A file system that another program fills while the swing is recorded: the recording waits in the raw stream."""
    NC.parent.mkdir(parents=True)
    mounted = subprocess.run(
        ["mount", "-t", "tmpfs", "-o", "size=2m", "tmpfs", NC.parent], capture_output=True, text=True
    )
    if mounted.returncode:
        pytest.skip(f"NOT TESTED: no file system can be mounted here: {mounted.stderr}")
    try:
        config = {"recording": "a", "recordings": "sheet.csv", "capture": {**SETTINGS, "port": line.port}}
        job = jobs.job(config)

        def fill():
            with open(NC.parent / "other", "wb", buffering=0) as file, contextlib.suppress(OSError):
                while True:
                    file.write(bytes(1000))

        threading.Timer(0.4, fill).start()
        line.play(swing())
        with pytest.raises(OSError, match="the disk is full"):
            recording.capture(job)
        assert not NC.exists()
        (NC.parent / "other").unlink()
        told = recording.recover(jobs.job(config | {"recover": True}))
        assert "a: complete: 100 of 100" in told
        assert list(dataset.read(NC)["sent"].values) == SWING
    finally:
        subprocess.run(["umount", "-l", NC.parent], check=True)


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
    time.sleep(0.2 + after)
    process.send_signal(signal.SIGKILL)
    process.wait()


def recover(**capture):
    config = {
        "recording": "a",
        "recordings": "sheet.csv",
        "recover": True,
        "capture": {**SETTINGS, "port": "gone", **capture},
    }
    return recording.recover(jobs.job(config))


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
    with pytest.raises(InputError, match=r"could come round unseen.*at most 16\.4 s"):
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
