"""A job tells the terminal and its log the same: what it found, or why it stopped."""

import errno
import os
import warnings

import pandas as pd
import pytest

from swingdown import console
from swingdown.errors import EngineError, InputError
from swingdown.paths import write_csv, write_text


def test_a_finding_is_printed_and_kept(tmp_path, capsys):
    with console.job(tmp_path / "logs" / "job.log") as say:
        say("swing_01: 0.131(12)°")
    assert "swing_01: 0.131(12)°" in capsys.readouterr().err
    assert (tmp_path / "logs" / "job.log").read_text() == "swing_01: 0.131(12)°\n"


def test_an_unusable_input_ends_the_job_with_one_block_and_no_traceback(tmp_path, capsys):
    log = tmp_path / "job.log"
    with pytest.raises(SystemExit) as stopped, console.job(log) as say:
        say("so far")
        raise InputError("sheet.csv, line 3", "no column 'angel'", "one of angle, time", "correct the sheet")
    assert stopped.value.code == 1
    shown = capsys.readouterr().err
    for part in ("sheet.csv, line 3", "no column 'angel'", "one of angle, time", "correct the sheet"):
        assert shown.count(part) == 1
        assert part in log.read_text()
    assert "Traceback" not in shown
    assert log.read_text().startswith("so far\n")


def test_a_missing_compiler_is_told_as_an_unusable_input_is(tmp_path, capsys):
    with pytest.raises(SystemExit), console.job(tmp_path / "job.log"):
        raise EngineError("engine", "there is no C compiler", mend="install gcc")
    shown = capsys.readouterr().err
    for part in ("The engine cannot be built.", "there is no C compiler", "install gcc"):
        assert part in shown and part in (tmp_path / "job.log").read_text()
    assert "Traceback" not in shown


def test_a_fault_of_the_program_keeps_its_traceback(tmp_path):
    with pytest.raises(ZeroDivisionError), console.job(tmp_path / "job.log"):
        1 / 0  # noqa: B018
    assert "Traceback" in (tmp_path / "job.log").read_text()


@pytest.mark.parametrize(
    ("number", "words", "mend"),
    [
        (errno.ENOSPC, "the disk is full", "make room"),
        (errno.EDQUOT, "the disk is full for this user", "make room"),
        (errno.EROFS, "cannot be written", "--directory"),
        (errno.EACCES, "cannot be written", "--directory"),
    ],
)
@pytest.mark.parametrize("write", ["text", "table"])
def test_a_disk_that_takes_no_results_is_told_without_a_traceback(
    tmp_path, capsys, monkeypatch, number, words, mend, write
):
    (tmp_path / "a.csv").write_text("as it was")
    monkeypatch.setattr("os.replace", lambda *_: (_ for _ in ()).throw(OSError(number, os.strerror(number))))
    with pytest.raises(SystemExit), console.job():
        if write == "text":
            write_text(tmp_path / "a.csv", "new")
        else:
            write_csv(pd.DataFrame({"x": [1.0]}), tmp_path / "a.csv")
    told = capsys.readouterr().err
    assert words in told and mend in told and "a.csv" in told and "Traceback" not in told
    assert [path.name for path in tmp_path.iterdir()] == ["a.csv"]
    assert (tmp_path / "a.csv").read_text() == "as it was"


def test_a_kind_of_warning_is_told_once(tmp_path, capsys):
    with console.job(tmp_path / "log"):
        for k in range(300):
            warnings.warn(f"model {k} gains energy", UserWarning, stacklevel=1)
    said = (tmp_path / "log").read_text()
    assert said.splitlines() == ["Beware: model 0 gains energy (299 more such)"]
    assert capsys.readouterr().err.count("gains energy") == 1
