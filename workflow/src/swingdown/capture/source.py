"""Where samples come from: a serial port, or a converter (DAQ) with a clock of its own. One interface for all.

A source has ``name`` (what it is, with the port that was found), ``rate`` (samples a second that its own clock really gives, or
None where only the config knows), ``read()`` (the bytes that came, b"" after some 50 ms of silence; it raises one of ``GONE``
when the device went away) and ``close()``. The bytes are those of the wire format that ``format_of`` names, so that journal,
recovery and all that follows are the same for every source. Another kind is a module here and a line in ``KINDS``.
"""

from . import labjack, port

GONE = port.GONE
KINDS = {"labjack": labjack.connect}  # scheme of capture.port: what opens it


def _kind(settings):
    return KINDS.get(str(settings.get("port") or "").partition("://")[0])


def format_of(settings: dict) -> str:
    """The wire format of the source that ``settings`` (the config's ``capture``) name."""
    return "readings" if _kind(settings) else settings["format"]


def connect(settings):
    """The source that ``settings`` name, open; InputError where it cannot be used."""
    if kind := _kind(settings):
        return kind(settings)
    return port.connect(settings.get("port"), settings["baud"])
