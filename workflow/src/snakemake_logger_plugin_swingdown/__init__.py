"""What a person watching a run sees: a line when a job starts, how far the run is, and what stopped it.

Snakemake finds the module by its name (``--logger swingdown``; ``profiles/default`` asks for it). What a job found is
printed by the job itself, see ``swingdown.console``. The full story is in ``.snakemake/log``.
"""

import logging
import os
import re
import sys
import time
from contextlib import suppress
from pathlib import Path

from snakemake_interface_logger_plugins.base import LogHandlerBase
from snakemake_interface_logger_plugins.common import LogEvent

from swingdown.console import RULE, UNWRITTEN, block, framed
from swingdown.errors import InputError
from swingdown.paths import in_words

_ERRNO = re.compile(r"\[Errno (\d+)\]")
_OF_FILES = ("OSError", "PermissionError", "RuleException", "WorkflowError")
_LINES = 40  # of the log of a job on another machine
_QUIET = 5.0  # seconds between two lines that say how far the run is
# What asks nothing of the user, or is told in other words; the Slurm plugin (2.8) asks Slurm for an account even where it is told not to.
_KNOWN = (
    "No SLURM account given, trying to guess.",
    "No account was given, not able to get a SLURM account",
    "Unable to guess SLURM account. Trying to proceed without.",
    "Cannot restore ",  # the record of a job that failed, which there was none of before
    "Failed to setup log file",  # of a folder that cannot be written, which is told at the first result
)


def _of_config():
    """What is wrong with a config file that the command line names; empty where nothing is."""
    from swingdown.planning.settings import check_config  # which the Snakefile imports, too

    for path in _after(sys.argv, ("--configfile", "--configfiles")):
        try:
            check_config(Path(path))
        except InputError as problem:
            return block(problem)
    return ""


def _after(words, options):
    """The words of a command line that follow one of the options, up to the next option."""
    inside = False
    for word in words:
        name, equals, value = word.partition("=")
        if word.startswith("-"):
            inside = name in options
            if inside and equals:
                yield value
        elif inside:
            yield word


def _from_afar(record):
    """What a job that failed on another machine has said, of which nothing was printed here: the end of its log, or else of Slurm's."""
    for path in record.log:
        with suppress(OSError):
            if text := Path(path).read_text(encoding="utf-8", errors="replace").strip():
                return "\n".join(text.splitlines()[-_LINES:])
    return (
        f"Its logs hold nothing. {record.rule_msg or ''}\n"
        f"Mend: see `scontrol show job {record.aux['external_jobid']}`; a job that needs more takes --default-resources mem_mb=… runtime=…"
    )


class LogHandler(LogHandlerBase):
    """Snakemake's records, shortened; a dry run and ``--verbose`` are shown in full."""

    writes_to_stream = True
    writes_to_file = False
    has_filter = (
        False  # Snakemake then gives it its own filter and formatter, so that --quiet keeps its meaning
    )
    has_formatter = False
    needs_rulegraph = False

    def __post_init__(self):
        self.stream = sys.stdout if self.common_settings.stdout else sys.stderr
        self.done, self.total = 0, 0
        self.unwritten, self.failed = "", False
        self.said: set[str] = set()  # by jobs that failed on other machines
        # Before Snakemake reads it, which takes the last of two keys, and does not end with aliases of aliases.
        if told := _of_config():
            print(told, file=self.stream, flush=True)
            sys.exit(1)
        self.told = 0.0  # when a line last said how far the run is

    def emit(self, record):
        in_full = self.common_settings.dryrun or self.common_settings.verbose
        if line := self.format(record) if in_full else self._line(record):
            print(line, file=self.stream, flush=True)

    def _line(self, record):
        """The line that a record is worth, or nothing."""
        event, text = getattr(record, "event", None), record.getMessage()
        if event == LogEvent.RUN_INFO:
            self.total = record.stats.get("total", 0)
            return f"{self.total} jobs to run"
        if event == LogEvent.PROGRESS:
            self.done, self.total = record.done, record.total
            return self._progress()
        if event == LogEvent.JOB_INFO:
            width = len(str(self.total))
            doing = f"{record.rule_msg}" if record.rule_msg else ""
            self.told = time.monotonic() if doing else self.told
            return doing and f"[{self.done:{width}}/{self.total}] {doing}"
        if event == LogEvent.JOB_ERROR:
            self.failed = True
            logs = f" (log: {', '.join(record.log)})" if record.log else ""
            made = ", ".join(record.output).replace(" (update)", "")
            told = f"FAILED: rule {record.rule_name} for {made}{logs}"
            if "external_jobid" not in record.aux:
                return told
            said = _from_afar(record)
            refusal = said.partition(RULE)[2]
            if refusal and refusal in self.said:
                return told
            self.said.add(refusal)
            return f"{told}\n{said}"
        if event == LogEvent.ERROR:
            return self._error(text, getattr(record, "exception", ""))
        if text.startswith("Exiting because a job execution failed"):
            return ""  # the job and the line above have said so
        if text.startswith("Nothing to be done"):
            return "Nothing to do: everything asked for is up to date."
        if text.startswith(_KNOWN):
            return ""
        return text if record.levelno >= logging.WARNING else ""

    def _progress(self):
        """How far the run is, where no line has said so of late: on a cluster all jobs start at once, and then end one by one."""
        now = time.monotonic()
        if self.done < self.total and now - self.told < _QUIET:
            return ""
        self.told = now
        return f"{self.done} of {self.total} jobs done"

    def _error(self, text, exception):
        if exception == "LockException":
            return framed(
                "Another run is at work in this folder, and two would write the same files.",
                f"where:     {os.getcwd()}",
                "problem:   its lock is there; this run has done nothing and changed nothing",
                "mend:      wait until it has ended; where none runs (one was killed, or the power failed), give",
                "           this command with --unlock, which removes the lock, and then as before",
            )
        if self.failed and text.startswith("WorkflowError:\nError recording metadata"):
            return ""  # of a job that has said why it failed
        number = _ERRNO.search(text) if exception in _OF_FILES else None
        if number and (told := in_words(int(number[1]), os.getcwd())):
            said, self.unwritten = self.unwritten, told
            return framed(UNWRITTEN, told) if said != told else ""  # of the job, and then of the run
        if "CalledProcessError" in text and ".snakemake/scripts" in text:
            return ""  # the job has printed what went wrong; this only repeats the command
        if "At least one job did not complete successfully" in text:
            done = f"{self.done} of {self.total} jobs are done and kept"
            return f"Stopped. {done}; mend what is reported above and run the same command again."
        return text
