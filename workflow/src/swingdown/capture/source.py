"""Where samples come from: a serial port, a converter (DAQ) with a clock of its own, or a telephone. One interface for all.

A source has ``name`` (what it is, with the port that was found), ``rate`` (samples a second that its own clock really gives, or
None where only the config knows), ``read()`` (the bytes that came, b"" after some 50 ms of silence; it raises one of ``GONE``
when the device went away) and ``close()``; ``what`` says what of the device it is ("" where that is plain), ``events`` what
happened to it, as (s since 1970, sentence). The bytes are those of the wire format that ``completed`` names, so that journal,
recovery and all that follows are the same for every source. Another kind is a module here, with ``connect`` and ``known`` (what the
device itself decides of the settings), and a line in ``KINDS``.
"""

from . import labjack, port, telephone

GONE = port.GONE
KINDS = {"labjack": labjack, "phyphox": telephone}  # by scheme of capture.port


def _kind(settings):
    return KINDS.get(str(settings.get("port") or "").partition("://")[0])


def completed(settings: dict) -> dict:
    """``settings`` (the config's ``capture``) with what the source that they name decides itself, such as its wire format."""
    kind = _kind(settings)
    return {**settings, **kind.known(settings)} if kind else dict(settings)


def connect(settings):
    """The source that the settings (``completed``) name, open; InputError if it cannot be used."""
    if kind := _kind(settings):
        return kind.connect(settings)
    return port.connect(settings.get("port"), settings["baud"])
