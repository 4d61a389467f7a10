"""The serial port: found by path, USB identity or pyserial URL, and opened for one reader alone."""

import contextlib
import errno
import re
import termios
import time
from pathlib import Path

import serial
from serial.tools import list_ports
from serial.urlhandler import protocol_socket

from ..errors import InputError

GONE = (serial.SerialException, OSError, termios.error, TypeError)  # what reading an unplugged port raises
_WAIT = 0.05  # s that a read waits for the first byte
_GATHER = 0.002  # s for what comes with it: a board sends byte by byte
_PIECE = 65536  # bytes, the most in one read
_SCHEMES = ("socket", "rfc2217")  # of pyserial's; its spy:// writes files
_USB = re.compile(r"([0-9a-fA-F]{4}):([0-9a-fA-F]{4})(?::(.+))?")


def listed():
    """The ports there are, as a person would name them."""
    named = []
    for port in list_ports.comports():
        usb = ""
        if port.vid:
            usb = f"{port.vid:04x}:{port.pid:04x}" + (f":{port.serial_number}" if port.serial_number else "")
        named.append(port.device + (f" ({', '.join(filter(None, (usb, port.product)))})" if usb else ""))
    return ", ".join(named) or "none (is the board plugged in, by a cable that carries data?)"


def find(name):
    """The path or URL to open for a port, named by a path, a URL, or ``VID:PID[:serial]``; of no name the one USB port that there is.

    InputError if there is no such port, or several and no name.
    """
    if not name:
        boards = [port.device for port in list_ports.comports() if port.vid]
        if len(boards) == 1:
            return boards[0]
        several = f"no port is named, and {len(boards) or 'no'} boards are plugged in"
        mend = "set capture.port in the config to one of them"
        raise _error(several, mend if boards else "plug it in, or name the port that it has (capture.port)")
    name = str(name)
    if "://" in name:
        if name.partition("://")[0] not in _SCHEMES:
            mend = f"name a path, VID:PID, or {' or '.join(f'{one}://HOST:PORT' for one in _SCHEMES)}"
            raise _error(f"{name} is no port that can be opened", mend)
        return name
    if usb := _USB.fullmatch(name):
        vid, pid, number = int(usb[1], 16), int(usb[2], 16), usb[3]
        alike = (port for port in list_ports.comports() if (port.vid, port.pid) == (vid, pid))
        found = [port.device for port in alike if number in (None, port.serial_number)]
        if len(found) > 1:
            raise _error(f"{len(found)} boards are {name}", "name its serial number too: VID:PID:serial")
        if not found:
            raise _error(f"no board {name} is plugged in", "plug it in, or correct capture.port")
        return found[0]
    if not Path(name).exists():
        raise _error(f"there is no port {name}", "plug the board in, or correct capture.port")
    return name


def connect(name, baud):
    """The open ``Port`` that a ``name`` means (``find``), at so many ``baud``; InputError if it cannot be opened."""
    url = find(name)
    try:
        return Port(url, serial.serial_for_url(url, baudrate=baud, timeout=_WAIT, exclusive=True))
    except ValueError as error:
        problem = f"{url} is no port that can be opened ({error})"
        raise _error(problem, "correct capture.port or capture.baud") from error
    except GONE as error:
        raise _refused(url, error) from error


class Port:
    """A port that is open, as a source (``source``); ``read`` raises one of ``GONE`` when it is unplugged."""

    rate = None  # a line knows no clock
    what, events = "", ()

    def __init__(self, name, opened):
        self.name, self._opened = name, opened
        # A socket's ``in_waiting`` tells only whether there is anything; asked for more than there is, it gives what there is.
        self._whole = isinstance(opened, protocol_socket.Serial)

    def read(self):
        """The bytes that are there, b"" after 50 ms without any."""
        if not (first := self._opened.read(1)):
            return b""
        time.sleep(_GATHER)
        try:
            return first + self._rest()
        except GONE:
            return first  # the next read raises it again

    def _rest(self):
        if not self._whole:
            return self._opened.read(self._opened.in_waiting)
        self._opened.timeout = 0
        try:
            return self._opened.read(_PIECE)
        finally:
            self._opened.timeout = _WAIT

    def close(self):
        """Closes the port; one that is gone is closed already."""
        with contextlib.suppress(*GONE):
            self._opened.close()


def _refused(url, error):
    number = getattr(error, "errno", None)
    if number in (errno.EACCES, errno.EPERM):
        mend = "join the group that owns it (sudo usermod -aG dialout $USER) and log in again"
        return _error(f"{url} may not be opened by you", mend)
    if number in (errno.EBUSY, errno.EWOULDBLOCK):
        problem = f"{url} is in use by another program"
        return _error(problem, f"close it (a serial monitor, another capture); `fuser {url}` names it")
    return _error(f"{url} cannot be opened ({error})", "check the cable and capture.port")


def _error(problem, mend):
    return InputError("capture.port", problem, f"one of the ports there are: {listed()}", mend)
