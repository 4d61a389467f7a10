"""Disks that are full or fill up: what is kept of a recording, and that it is told in one block."""

import contextlib
import errno
import os
import resource
import subprocess
import threading

import pytest
from one_recording import NC, RAW, SWING, recover, swing
from traffic import SETTINGS

from swingdown import dataset
from swingdown.capture import job as jobs
from swingdown.capture import recording, take
from swingdown.errors import InputError


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
    def full(*_, **__):
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
            directory=tmp_path, check=False, environment={},
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
