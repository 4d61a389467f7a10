"""An open source that is read all the time by a thread of its own, so that neither disk nor picture makes it late."""

import queue
import threading
import time

from . import source

LOOK = 0.05  # s between looks at the clock while nothing comes


class Listener:
    """Reads ``opened`` (a source) until ``close``; ``gone`` is why the source went away, or None."""

    def __init__(self, opened):
        self._opened = opened
        self.gone = None
        self.began = time.time()
        self._offset = self.began - time.monotonic()  # a clock that is set meanwhile must not make times jump
        self._pieces, self._done = queue.SimpleQueue(), threading.Event()
        self._thread = threading.Thread(target=self._read, daemon=True)
        self._thread.start()

    def _read(self):
        try:
            while not self._done.is_set():
                data = self._opened.read()
                self._pieces.put((self.now(), data))
        except source.GONE as error:
            self._pieces.put((self.now(), error))

    def now(self) -> float:
        """The host's time, in s since 1970."""
        return self._offset + time.monotonic()

    @property
    def behind(self) -> int:
        """How many pieces wait to be taken."""
        return self._pieces.qsize()

    def take(self):
        """(arrival, bytes or the error that ended it), or None if the thread said nothing for a while."""
        if self.gone is not None and not self._pieces.qsize():
            return self.now(), self.gone
        try:
            arrival, data = self._pieces.get(timeout=LOOK)
        except queue.Empty:
            return None
        if isinstance(data, Exception):
            self.gone = data
        return arrival, data

    def close(self) -> None:
        """Ends the reading and closes the source."""
        self._done.set()
        self._thread.join(1)
        self._opened.close()
