"""What a job says to the person watching: what it found, or which input cannot be used and how to mend it."""

import sys
import traceback
from contextlib import contextmanager, suppress
from pathlib import Path

from .errors import InputError

_INDENT = "        "  # under the "[ 3/48] " that starts a job's line


@contextmanager
def job(log=None):
    """A function ``say(text)`` that prints a finding in the terminal and in the file ``log``.

    An input that cannot be used, or a full disk, is told in one block in both places and ends the process with exit
    code 1. Any other error is a fault of the program: its traceback goes to both places.
    """
    told = []

    def say(text):
        told.append(str(text))
        for line in str(text).splitlines():
            print(_INDENT + line, file=sys.stderr, flush=True)
        _keep(log, told)

    _keep(log, told)
    try:
        yield say
    except InputError as error:
        _stop(block(error), log, told)
    except OSError as error:
        if "the disk is full" not in str(error):
            _keep(log, [*told, traceback.format_exc()])
            raise
        _stop(_framed("The results cannot be written.", str(error)), log, told)
    except Exception:
        _keep(log, [*told, traceback.format_exc()])
        raise


def block(error):
    """The text of an InputError laid out for the eye: a line each for where, problem, expected and mend."""
    parts = ("where", "problem", "expected", "mend")
    lines = [f"{part + ':':10} {getattr(error, part)}" for part in parts if getattr(error, part)]
    return _framed("This input cannot be used.", *lines)


def _framed(*lines):
    rule = "-" * 78
    return "\n".join(["", rule, *(f"  {line}" for line in lines), rule, ""])


def _stop(text, log, told):
    print(text, file=sys.stderr, flush=True)
    _keep(log, [*told, text])
    sys.exit(1)


def _keep(log, lines):
    if log:
        with suppress(OSError):  # on a full disk the terminal has it all the same
            Path(log).parent.mkdir(parents=True, exist_ok=True)
            Path(log).write_text("\n".join([*lines, ""]), encoding="utf-8")
