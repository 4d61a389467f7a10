"""The raw stream on disk as it arrives, so that a capture that is killed loses nothing that had arrived.

One file: a line of JSON (what is needed to read the rest), then for each piece of bytes that the port gave its arrival time
(s since 1970, 8 bytes), its length (4 bytes) and the bytes. The writer holds a lock, which ends with its process.
"""

import errno
import fcntl
import json
import os
import struct
import time
from pathlib import Path

from ..errors import InputError

RUNNING = "still running"  # the code of the refusal while another process records under this name
_HEAD = struct.Struct("<dI")
_SYNC = 1.0  # s between writes that are forced to the disk


class Journal:
    """A new journal, open for writing; InputError if there is one of that name already."""

    def __init__(self, path, settings):
        self.path = Path(path)
        self.path.parent.mkdir(parents=True, exist_ok=True)
        try:
            self._file = os.open(self.path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o644)
        except FileExistsError:
            raise in_the_way(self.path) from None
        fcntl.flock(self._file, fcntl.LOCK_EX)
        self._synced = time.monotonic()
        self._write(json.dumps(settings).encode() + b"\n")

    def add(self, data, arrival):
        """Keep bytes that came at ``arrival``; OSError (ENOSPC) where the disk is full."""
        self._write(_HEAD.pack(arrival, len(data)) + data)
        if time.monotonic() - self._synced > _SYNC:
            os.fsync(self._file)
            self._synced = time.monotonic()

    def _write(self, data):
        while data:
            done = os.write(self._file, data)
            data = data[done:]

    def close(self):
        """Ends the lock; the file stays."""
        os.close(self._file)

    def remove(self):
        """The recording is on disk: the journal has done its work."""
        self.path.unlink()


def read_journal(path):
    """The settings of a capture that was killed, and its pieces: (arrival in s since 1970, bytes), of one that is cut off as far as it goes.

    InputError where no journal is at ``path``, what is there is none, or it is still being written.
    """
    path = Path(path)
    try:
        with open(path, "rb") as file:
            try:
                fcntl.flock(file, fcntl.LOCK_SH | fcntl.LOCK_NB)
            except OSError as error:
                if error.errno not in (errno.EWOULDBLOCK, errno.EACCES):
                    raise
                problem = "a capture of this name is still running"
                mend = "wait for it, or stop it with Ctrl-C"
                raise InputError(path, problem, "one at a time", mend, RUNNING) from None
            settings = json.loads(file.readline())
            pieces = []
            while len(head := file.read(_HEAD.size)) == _HEAD.size:
                arrival, length = _HEAD.unpack(head)
                pieces.append((arrival, file.read(length)))
    except FileNotFoundError:
        problem = "there is no raw stream to recover"
        expected = "the raw stream that a killed capture leaves"
        raise InputError(path, problem, expected, "nothing has to be recovered") from None
    except InputError:
        raise
    except ValueError:
        problem = "it does not begin as a raw stream does"
        raise InputError(path, problem, "what a capture wrote", "delete it") from None
    return settings, pieces


def in_the_way(path: Path) -> InputError:
    """Why there can be no new journal at ``path`` while the one that is there stays."""
    try:
        read_journal(path)
    except InputError as error:
        if error.code == RUNNING:
            return error
    problem = "an earlier capture of this name did not finish; this file holds what had arrived"
    mend = f"{recovery(path)} makes a recording of it; or delete the file"
    return InputError(path, problem, "no raw stream of that name", mend)


def recovery(path: Path) -> str:
    """What asks on the command line for the recording of a journal."""
    return f"`--config recording={path.stem} recover=true`"
