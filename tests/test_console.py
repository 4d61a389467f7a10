"""A job tells the terminal and its log the same: what it found, or why it stopped."""

import errno
import io
import logging
import os
import warnings
from types import SimpleNamespace

import pandas as pd
import pytest
from snakemake_interface_logger_plugins.common import LogEvent

from snakemake_logger_plugin_swingdown import LogHandler
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


def test_one_refusal_of_two_jobs_is_printed_once(tmp_path, capsys, monkeypatch):
    monkeypatch.setenv("SWINGDOWN_PREFORK", str(tmp_path / "run" / "prefork"))
    (tmp_path / "run").mkdir()
    for job, file in (("one", "a.nc"), ("two", "a.nc"), ("three", "b.nc")):
        with pytest.raises(SystemExit), console.job(tmp_path / f"{job}.log"):
            raise InputError(file, "it cannot be read", mend="delete it")
        assert file in (tmp_path / f"{job}.log").read_text()
    shown = capsys.readouterr().err
    assert (shown.count("a.nc"), shown.count("b.nc")) == (1, 1)


def test_a_refusal_is_told_where_no_other_job_can_be_asked(tmp_path, capsys, monkeypatch):
    """As where the folder that the jobs share is gone: rather twice than never."""
    monkeypatch.setenv("SWINGDOWN_PREFORK", str(tmp_path / "gone" / "prefork"))
    for _ in range(2):
        with pytest.raises(SystemExit), console.job():
            raise InputError("a.nc", "it cannot be read", mend="delete it")
        assert "a.nc" in capsys.readouterr().err


def test_a_refusal_has_a_line_for_each_thing_it_tells():
    """Labels one below the other, texts too; what is not told has no line."""
    lines = console.block(InputError("a.nc", "it is damaged", mend="delete it")).splitlines()
    assert lines[1] == lines[-1] == console.RULE and lines[0] == ""
    told = [line.split(":", 1) for line in lines[3:-1]]
    assert [text.strip() for _, text in told] == ["a.nc", "it is damaged", "delete it"]
    assert len({len(text) - len(text.lstrip()) + len(label) for label, text in told}) == 1


@pytest.mark.filterwarnings("default:^.$")
def test_a_warning_is_told_alone_and_those_of_two_kinds_each(tmp_path):
    with console.job(tmp_path / "log"):
        for category, text in (
            (UserWarning, "a"),
            (UserWarning, "a"),
            (RuntimeWarning, "b"),
            (RuntimeWarning, "c"),
        ):
            warnings.warn(text, category, stacklevel=1)
    assert (tmp_path / "log").read_text().splitlines() == ["Beware: a", "Beware: b (1 more such)"]


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
    assert "Errno" not in told
    assert [path.name for path in tmp_path.iterdir()] == ["a.csv"]
    assert (tmp_path / "a.csv").read_text() == "as it was"


def test_words_alone_make_no_full_disk(tmp_path):
    """What a result could not be written for is known by the class of its error, whatever others say."""
    with pytest.raises(OSError, match="another"), console.job(tmp_path / "job.log"):
        raise OSError("another says that the disk is full")
    assert "Traceback" in (tmp_path / "job.log").read_text()


@pytest.mark.filterwarnings("default:model .* gains energy:UserWarning")
def test_a_kind_of_warning_is_told_once(tmp_path, capsys):
    with console.job(tmp_path / "log"):
        for k in range(300):
            warnings.warn(f"model {k} gains energy", UserWarning, stacklevel=1)
    said = (tmp_path / "log").read_text()
    assert said.splitlines() == ["Beware: model 0 gains energy (299 more such)"]
    assert capsys.readouterr().err.count("gains energy") == 1


@pytest.fixture
def shown(tmp_path, monkeypatch):
    """A function that gives what a run prints of a job of the cluster that failed, whose log holds a text (None: there is none)."""
    monkeypatch.chdir(tmp_path)
    handler = LogHandler(SimpleNamespace(stdout=False, dryrun=False, verbose=False), None)

    def line(text):
        if text is not None:
            (tmp_path / "job.log").write_text(text)
        told = logging.makeLogRecord(
            {"event": LogEvent.JOB_ERROR, "rule_name": "sweep_combine", "rule_msg": "SLURM-job '7' failed", "output": ["sweep.nc"],
             "log": ["job.log", "slurm.log"], "aux": {"external_jobid": "7"}}
        )  # fmt: skip
        printed = io.StringIO()
        handler.stream = printed
        handler.emit(told)
        return printed.getvalue()

    return line


def test_what_a_job_of_the_cluster_said_is_told_where_the_run_is_watched(shown):
    """Its own words reach no terminal."""
    said = console.block(InputError("chunks/a.nc", "it is damaged", "a whole one", "delete it"))
    told = shown("so far\n" + said)
    assert "FAILED: rule sweep_combine for sweep.nc" in told
    assert all(part in told for part in ("chunks/a.nc", "it is damaged", "mend:      delete it"))


def test_one_refusal_of_two_jobs_of_the_cluster_is_told_once(shown):
    said = console.block(InputError("chunks/a.nc", "it is damaged", "a whole one", "delete it"))
    assert "it is damaged" in shown("of the first\n" + said)
    again = shown("of the second\n" + said)
    assert "FAILED" in again and "it is damaged" not in again


def test_a_record_that_never_was_is_not_missed():
    """Of a chunk's job that fails Snakemake warns, beside the reason, that it finds no older record to put back."""
    handler = LogHandler(SimpleNamespace(stdout=False, dryrun=False, verbose=False), None)
    handler.stream = io.StringIO()
    for text in ("Cannot restore results/sweeps/a/jobs/1.json: no backup found.", "something else"):
        handler.emit(logging.makeLogRecord({"msg": text, "levelno": logging.WARNING}))
    assert handler.stream.getvalue() == "something else\n"


@pytest.mark.parametrize("text", [None, "\n"])
def test_a_job_of_the_cluster_that_said_nothing_is_told_by_what_slurm_says(shown, tmp_path, text):
    assert "SLURM-job '7' failed" in shown(text) and "Mend: see `scontrol show job 7`" in shown(text)
    (tmp_path / "slurm.log").write_text("error: Exceeded job memory limit\n")
    assert "Exceeded job memory limit" in shown(text)


def test_control_characters_reach_no_terminal_and_no_log(tmp_path, capsys):
    with pytest.raises(SystemExit), console.job(tmp_path / "job.log") as say:
        say("read \x1b[31mred\x1b]0;title\x07.csv\nand\ta tab, \u202e turned")
        raise InputError("\x9b2J.csv", "it is no file\r")
    shown = capsys.readouterr().err
    for text in (shown, (tmp_path / "job.log").read_text()):
        assert "\\x1b[31mred\\x1b]0;title\\x07.csv" in text and "\\x9b2J.csv" in text
        assert "and\ta tab, \\u202e turned" in text
        assert not set(text) & set("\x1b\x07\x9b\r\u202e")
