"""A LabJack T4, T7 or T8 as a source: its stream mode, whose scans the device's own crystal times.

``capture.port: labjack://DEVICE/IDENTIFIER/CHANNEL``, such as ``labjack://T7/ANY/AIN0``; a differential channel is named as
``AIN0-AIN1``. It takes LabJack's LJM library and its Python package (``pip install labjack-ljm``, or the extra ``labjack``). LJM User's Guide, "Stream
functions": eStreamStart tells the rate it really gives, and a scan that was lost stands in the data as -9999.
"""

import contextlib
import math

from ..errors import InputError
from .formats import Readings

LOST = -9999.0  # what LJM puts in the place of a scan that it lost
_READS = 20  # a second


class Gone(OSError):
    """The device stopped answering."""


def known(settings: dict) -> dict:
    """What of the config's ``capture`` the device itself decides: the format."""
    return {"format": "readings"}


class Stream:
    """A stream that runs; see ``source``."""

    what, events = "", ()

    def __init__(self, ljm, handle, name, rate, scans):
        self._ljm, self._handle, self.name, self.rate, self._scans = ljm, handle, name, rate, scans
        self._next, self._lost = 0, 0

    def read(self) -> bytes:
        """The scans of the next twentieth of a second, in the format ``readings``; ``source.GONE`` when the device is gone."""
        try:
            data, _, _ = self._ljm.eStreamRead(self._handle)
        except self._ljm.LJMError as error:
            if error.errorCode == self._ljm.errorcodes.NO_SCANS_RETURNED:
                return b""
            raise Gone(f"the LabJack stopped streaming: {error}") from error
        numbers = range(self._next, self._next + len(data))
        self._next = numbers.stop
        return Readings.encoded(numbers, [math.nan if value == LOST else value for value in data])

    def close(self) -> None:
        """Stops the stream and lets the device go."""
        for end in (self._ljm.eStreamStop, self._ljm.close):
            with contextlib.suppress(self._ljm.LJMError):
                end(self._handle)


def connect(settings: dict) -> Stream:
    """The running Stream of ``settings`` (the config's ``capture``); InputError where it cannot be used."""
    where = settings["port"]
    parts = where.partition("://")[2].split("/")
    if len(parts) != 3 or not all(parts):
        raise _error(f"{where} is not complete", "write labjack://T7/ANY/AIN0: device, identifier, channel")
    device, identifier, channel = parts
    ljm = _library()
    try:
        handle = ljm.openS(device, "ANY", identifier)
    except ljm.LJMError as error:
        problem = f"{where} cannot be opened ({error})"
        raise _error(problem, "plug it in, close other programs that use it (Kipling)") from error
    try:
        positive, _, negative = channel.partition("-")
        if negative:
            ljm.eWriteName(handle, f"{positive}_NEGATIVE_CH", ljm.nameToAddress(negative)[0] // 2)
        if limits := settings.get("range"):
            ljm.eWriteName(handle, f"{positive}_RANGE", max(map(abs, limits)))
        scans = max(round(settings["rate_hz"] / _READS), 1)
        address, _ = ljm.nameToAddress(positive)
        rate = ljm.eStreamStart(handle, scans, 1, [address], settings["rate_hz"])
    except ljm.LJMError as error:
        ljm.close(handle)
        problem = f"{where} refuses the stream ({error})"
        raise _error(problem, "correct the channel, capture.rate_hz or capture.range") from error
    return Stream(ljm, handle, where, rate, scans)


def _library():
    try:
        from labjack import ljm

        ljm.readLibraryConfigS("LJM_LIBRARY_VERSION")
    except ImportError as error:
        problem = "LabJack's Python package is not here"
        raise _error(problem, "pip install labjack-ljm (and LabJack's LJM library)") from error
    except Exception as error:  # the package is there and finds no library: it is told at the first call
        problem = f"LabJack's LJM library cannot be used ({error})"
        raise _error(problem, "install LJM from LabJack's site") from error
    return ljm


def _error(problem, mend):
    return InputError("capture.port", problem, "labjack://DEVICE/IDENTIFIER/CHANNEL and LJM", mend)
