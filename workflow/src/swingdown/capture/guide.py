"""What the experimenter is asked for between recordings: a line that says what to do, Enter, and a countdown."""

import contextlib
import os
import select
import sys
import time

_BEEP = 3  # s before the end of a countdown, from which each second is heard


class Keyboard:
    """The terminal's Enter key, where there is a terminal."""

    def __init__(self, path="/dev/tty"):
        self._file = None
        with contextlib.suppress(OSError):
            self._file = os.open(path, os.O_RDONLY | os.O_NONBLOCK)

    @property
    def there(self) -> bool:
        """True if someone could press a key."""
        return self._file is not None

    def enter(self) -> bool:
        """True if a line was entered since the last look."""
        if self._file is None or not select.select([self._file], [], [], 0)[0]:
            return False
        try:
            said = os.read(self._file, 4096)
        except OSError:
            said = b""
        if not said:  # the terminal is gone
            self.close()
        return b"\n" in said or b"\r" in said

    def close(self):
        """Lets the terminal go."""
        if self._file is not None:
            os.close(self._file)
            self._file = None


class Guide:
    """Asks, waits and counts down in the terminal; ``stop`` is an event that ends the waiting."""

    def __init__(self, seconds, stop, keyboard=None, stream=None):
        self._seconds, self._stop = seconds, stop
        self._keyboard, self._stream = keyboard or Keyboard(), stream or sys.stderr
        self._terminal = self._stream.isatty() and os.environ.get("TERM") != "dumb"

    def prompt(self, text, wait, look):
        """True once the experimenter is ready: Enter was pressed (if ``wait`` and there is a keyboard) and the countdown is over.

        Enter during the countdown ends it. ``look`` is called all the while, and returns what to show beside the prompt; it may
        raise. False if ``stop`` was set.
        """
        self._say(f"\n>>> {text}")
        if wait and self._keyboard.there:
            self._say("    Press Enter when it is so (Ctrl-C ends the session).")
            while not self._keyboard.enter():
                self._draw(look())
                if self._stop.is_set():
                    return False
        end, told = time.monotonic() + self._seconds, None
        while (left := end - time.monotonic()) > 0:
            seen, count = look(), int(left) + 1
            if self._terminal or count != told:
                bell = "\a" if self._terminal and count != told and count <= _BEEP else ""
                self._draw(f"{bell}in {count} s ... {seen}", plain=f"    in {count} s ...")
            told = count
            if self._stop.is_set():
                return False
            if self._keyboard.enter():
                break
        self._draw("", end="\r")
        return not self._stop.is_set()

    def _say(self, text):
        self._stream.write(text + "\n")
        self._stream.flush()

    def _draw(self, text, plain=None, end=""):
        if self._terminal:
            self._stream.write(f"\r\x1b[2K    {text}" + end)
        elif plain:
            self._stream.write(plain + "\n")
        self._stream.flush()

    def close(self):
        """Lets the keyboard go."""
        self._keyboard.close()
