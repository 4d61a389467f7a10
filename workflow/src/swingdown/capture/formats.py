"""The wire formats: bytes as they arrive become samples. A format is one class here and one entry of ``FORMATS``.

A parser takes bytes in pieces of any size, never raises, and never makes a sample out of damage it can see: what does not
check out is counted and skipped until the next sample that does.
"""

import binascii
import math
import re
import struct
from typing import NamedTuple

from ..errors import InputError
from ..measurement.sheet import TIME_UNITS, unit_of
from ..schema import near


class Sample(NamedTuple):
    """One sample as sent, and what was damaged between it and the one before."""

    sequence: int | None  # the device's own number, which wraps; None where it sends none
    ticks: float | None  # the device's own time, in ``tick`` seconds; None where it sends none
    value: float
    damaged: int = 0  # frames or lines that did not check out since the last sample
    claims: tuple = ()  # the sequence numbers that those seemed to have


class Frames:
    """Framed binary: two bytes that begin it, then sequence, value and CRC, low byte first.

    A5 5A: an unsigned 16-bit value (a converter's); A5 5C: a signed 32-bit one (an encoder's counts). Sequence and CRC are
    unsigned 16-bit numbers; the CRC is CRC-16/CCITT-FALSE (polynomial 0x1021, start 0xFFFF) over the bytes of sequence and value.
    """

    SYNC = b"\xa5"
    KINDS = {0x5A: (2, False), 0x5C: (4, True)}  # second byte: size of the value in bytes, signed
    SIZE = 8  # bytes of the shortest
    sequence_modulus = 1 << 16
    tick, tick_modulus, resolution = None, None, None

    def __init__(self, settings=None):
        self._rest, self._junk, self._claims = b"", 0, []

    def feed(self, data):
        """The samples that are whole now, as a list."""
        buffer, at, found = self._rest + data, 0, []
        while True:
            start = buffer.find(self.SYNC, at)
            if start < 0:
                start = len(buffer)
            self._junk += start - at
            at = start
            if len(buffer) - at < 2:
                break
            size, signed = self.KINDS.get(buffer[at + 1], (0, False))
            if not size:
                self._junk += 1
                at += 1
                continue
            if len(buffer) - at < size + 6:
                break
            body, sent = buffer[at + 2 : at + 4 + size], buffer[at + 4 + size : at + 6 + size]
            sequence = int.from_bytes(body[:2], "little")
            if binascii.crc_hqx(body, 0xFFFF) == int.from_bytes(sent, "little"):
                damaged, claims = self.pending
                value = int.from_bytes(body[2:], "little", signed=signed)
                found.append(Sample(sequence, None, value, damaged, claims))
                self._junk, self._claims = 0, []
                at += size + 6
            else:  # one byte on: if bytes were lost, the next frame begins inside these
                self._claims = [*self._claims[-999:], sequence]
                self._junk += 1
                at += 1
        self._rest = buffer[at:]
        return found

    @property
    def pending(self):
        """Damaged frames since the last sample, and the sequence numbers that they seemed to have."""
        return max(round(self._junk / self.SIZE), min(self._junk, 1)), tuple(self._claims)


class Lines:
    """Lines of numbers between commas, as Arduino's ``Serial.println`` sends them; the config names the columns.

    ``sequence`` counts the samples; ``time_s``, ``time_ms`` or ``time_us`` is the device's clock (``millis()``, ``micros()``;
    32 bits); one of the two must be there. ``crc`` (last, four hexadecimal digits) is the CRC of ``Frames`` over the line up to
    the comma before it; without it a line that lost digits and keeps its commas goes unnoticed. One of the others is the
    signal. The first line after opening is left out: it may lack its beginning.
    """

    LONGEST = 512  # bytes; what has no line end by then is no line
    NUMBER = re.compile(rb"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d{1,2})?")
    WHOLE = re.compile(rb"\d{1,10}")
    sequence_modulus = None  # that of the counter's size, 16 or 32 bits, which its numbers tell

    def __init__(self, settings):
        self.columns = list(settings["columns"])
        where = "capture.columns"
        clocks = [name for name in self.columns if name.startswith("time_") and unit_of(name, TIME_UNITS)]
        self._clock = clocks[0] if clocks else None
        if not self._clock and "sequence" not in self.columns:
            problem = f"none of {', '.join(self.columns) or '(no column)'} says when a sample was taken"
            mend = "let the sketch print millis() before the value and name that column time_ms"
            raise InputError(where, problem, "a column sequence, time_s, time_ms or time_us", mend)
        others = [name for name in self.columns if name not in (*clocks, "sequence", "crc")]
        self._signal = settings.get("signal_column") or (others[0] if len(others) == 1 else None)
        if self._signal not in others:
            raise InputError(
                "capture.signal_column",
                f"the signal's column is {self._signal or 'not named'}",
                f"one of {', '.join(others)}" if others else "a column for the signal in capture.columns",
                "name the column that holds the signal",
            )
        if "crc" in self.columns[:-1]:
            raise InputError(where, "crc is not the last column", "crc last", "send the CRC at the end")
        self.tick = TIME_UNITS[unit_of(self._clock, TIME_UNITS)] if self._clock else None
        self.tick_modulus = 1 << 32 if self._clock and self._clock != "time_s" else None
        # s; the smallest step that the clock is sent in, None where it sends none
        self.resolution = self.tick if self.tick_modulus else None
        self._rest, self._damaged, self._begun = b"", 0, False

    def feed(self, data):
        """The samples that are whole now, as a list."""
        *lines, self._rest = (self._rest + data).split(b"\n")
        found = []
        if lines and not self._begun:
            self._begun, lines = True, lines[1:]
        for line in lines:
            if not (line := line.strip()):
                continue
            if (sample := self._sample(line)) is None:
                self._damaged += 1
            else:
                found.append(sample)
                self._damaged = 0
        if len(self._rest) > self.LONGEST:
            self._rest, self._begun = b"", False  # the end of it is no line either
            self._damaged += 1
        return found

    def _sample(self, line):
        if len(line) > self.LONGEST:
            return None
        if self.columns[-1] == "crc":
            text, _, sent = line.rpartition(b",")
            if sent.strip().lower() != b"%04x" % binascii.crc_hqx(text, 0xFFFF):
                return None
        cells = [cell.strip() for cell in line.split(b",")]
        if len(cells) != len(self.columns):
            return None
        row = dict(zip(self.columns, cells, strict=True))
        row.pop("crc", None)
        if not all(self.NUMBER.fullmatch(cell) for cell in row.values()):
            return None
        whole = [
            row[name] for name in ("sequence", self._clock if self.tick_modulus else None) if name in row
        ]
        if not all(self.WHOLE.fullmatch(cell) for cell in whole):
            return None
        sequence = int(row["sequence"]) if "sequence" in row else None
        ticks = float(row[self._clock]) if self._clock else None
        if self._clock == "time_s":
            self._note_decimals(row[self._clock])
        return Sample(sequence, ticks, float(row[self._signal]), self._damaged)

    def _note_decimals(self, text):
        """The step of a clock in seconds is told by the most decimals that it was sent with."""
        decimals = 9 if b"e" in text.lower() else len(text.partition(b".")[2])
        self.resolution = min(self.resolution or 1.0, 10.0**-decimals)

    @property
    def pending(self):
        """Damaged lines since the last sample, and nothing of what they seemed to be."""
        return self._damaged, ()


class Readings:
    """What a converter with a clock of its own gives (``daq``): for each reading a 64-bit sequence number and the value (V).

    Both low byte first, the value as an IEEE 754 double; it never leaves this computer, so there is nothing to check. A value
    that is not finite stands for a reading that the converter lost.
    """

    PAIR = struct.Struct("<Qd")
    sequence_modulus: int | None = 1 << 64
    tick: float | None = None
    tick_modulus, resolution, pending = None, None, (0, ())

    def __init__(self, settings=None):
        self._rest = b""

    @classmethod
    def encoded(cls, places, values):
        """The bytes of readings: their numbers, or their times (s), and values."""
        return b"".join(cls.PAIR.pack(*pair) for pair in zip(places, values, strict=True))

    def feed(self, data):
        """The samples that are whole now, as a list."""
        data = self._rest + data
        whole = len(data) // self.PAIR.size * self.PAIR.size
        self._rest = data[whole:]
        return [self.sample(*pair) for pair in self.PAIR.iter_unpack(data[:whole]) if all(map(math.isfinite, pair))]  # fmt: skip

    def sample(self, place, value):
        """The ``Sample`` of a reading."""
        return Sample(place, None, value)


class Timed(Readings):
    """What a device with a clock of its own gives, with the time of each reading: time (s) and value, both as IEEE 754 doubles, low byte first.

    Like ``Readings`` it never leaves this computer. A gap is told by the times alone.
    """

    PAIR = struct.Struct("<dd")
    sequence_modulus, tick = None, 1.0

    def sample(self, place, value):
        """The ``Sample`` of a reading."""
        return Sample(None, place, value)


FORMATS = {"frames": Frames, "csv": Lines, "readings": Readings, "timed": Timed}


def parser(settings):
    """A new parser of the wire format that the config's ``capture`` names; InputError if there is no such format."""
    name = settings["format"]
    if name not in FORMATS:
        problem = f"unknown wire format {name!r}"
        raise InputError("capture.format", problem, ", ".join(FORMATS), near(name, FORMATS))
    return FORMATS[name](settings)
