"""What a job says to the person watching: what it found, or which input cannot be used and how to mend it."""

import os
import sys
import traceback
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from hashlib import sha256
from pathlib import Path
from typing import NoReturn

from .errors import Refusal, Unwritten
from .paths import printable, write_text

RULE = "-" * 78
UNWRITTEN = "The results cannot be written."
_SHARED = "SWINGDOWN_PREFORK"  # the environment variable with a path in a folder that the jobs of a run on one machine share
_INDENT = "        "  # under the "[ 3/48] " that starts a job's line


@contextmanager
def job(log: str | Path | None = None) -> Iterator[Callable[[object], None]]:
    """A function ``say(text)`` that prints a finding in the terminal and in the file ``log``.

    A refusal (``errors``), or a full disk, is told in one block in both places and ends the process with exit
    code 1. Any other error is a fault of the program: its traceback goes to both places.
    """
    told = []

    def say(text: object) -> None:
        text = printable(str(text))
        told.append(text)
        for line in text.splitlines():
            print(_INDENT + line, file=sys.stderr, flush=True)
        _keep(log, told)

    _keep(log, told)
    try:
        with warnings_once(say):
            yield say
    except Refusal as error:
        _stop(block(error), log, told)
    except Unwritten as error:
        _stop(framed(UNWRITTEN, error.strerror or str(error)), log, told)
    except Exception:
        _keep(log, [*told, traceback.format_exc()])
        raise


@contextmanager
def warnings_once(say: Callable[[object], None]) -> Iterator[None]:
    """A block whose warnings are told at its end, one for each kind: a search meets the same odd motion in hundreds of models."""
    caught: list[warnings.WarningMessage] = []
    try:
        with warnings.catch_warnings(record=True) as caught:
            yield
    finally:
        kinds: dict[type[Warning], list[str]] = {}
        for one in caught:
            kinds.setdefault(one.category, []).append(str(one.message))
        for told in kinds.values():
            more = len(set(told)) - 1
            say(f"Beware: {told[0]}" + (f" ({more} more such)" if more else ""))


def block(error: Refusal) -> str:
    """The text of a refusal laid out for the eye: a line each for where, problem, expected and mend."""
    told = {label: getattr(error, part) for part, label in error.labels.items()}
    width = max(10, *(len(label) + 1 for label in told))
    lines = [f"{label + ':':{width}} {text}" for label, text in told.items() if text]
    return framed(error.heading, *lines)


def framed(*lines: str) -> str:
    """Lines between two rules, as what stops a run is told."""
    return "\n".join(["", RULE, *(f"  {printable(line)}" for line in lines), RULE, ""])


def _stop(text: str, log: str | Path | None, told: list[str]) -> NoReturn:
    if _is_news(text):
        print(text, file=sys.stderr, flush=True)
    _keep(log, [*told, text])
    sys.exit(1)


def _is_news(text: str) -> bool:
    """Whether no other job of this run has printed the text: two jobs side by side may stumble over one damaged file."""
    shared = os.environ.get(_SHARED)
    if not shared:
        return True
    mark = Path(shared).parent / sha256(text.encode("utf-8", "replace")).hexdigest()
    try:
        mark.touch(exist_ok=False)
    except FileExistsError:
        return False
    except OSError:  # a full disk, or a folder that is gone: rather twice than never
        pass
    return True


def _keep(log: str | Path | None, lines: list[str]) -> None:
    if log:
        with suppress(OSError):  # on a full disk the terminal has it all the same
            write_text(log, "\n".join([*lines, ""]))
