"""What the experimenter sees in the terminal while a swing is recorded: samples, their rate and losses, the trace, the swing in numbers."""

import os
import re
import shutil
import sys
import time
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from ..pendulum.half_swings import middle_crossings
from .order import losses

MANY = 10  # swings that the loss is told over
_CLEAR = 6  # standard deviations of the noise that a swing's amplitude must have to be one
SECONDS = 10.0  # of the trace
LATELY = 20.0  # s that amplitude, period and loss are told from
MOST = 3000  # samples of them that are looked at
_ROWS = 6  # lines of the trace, four dots each
_QUIET = 5.0  # s between lines where there is no terminal
# of a braille character: column, row from the top
_DOTS = ((0x01, 0x02, 0x04, 0x40), (0x08, 0x10, 0x20, 0x80))
_DRAWN = re.compile("[\u2800-\u28ff]")  # a line of the trace
WORDS = {
    "opening": "opening the port ...",
    "waiting": "HOLD THE BOB STILL where you will let it go",
    "armed": "ARMED: let go",
    "recording": "RECORDING (Ctrl-C stops)",
    "ended": "ended",
}


def status(recorder):
    """One line: what is going on, samples, rate by the host's clock, lost and damaged frames."""
    rows = recorder.rows
    parts = [WORDS[recorder.state] + (f": {recorder.status}" if recorder.status else "")]
    if rows:
        of = f" of {recorder.expected}" if recorder.duration is not None else ""
        parts.append(f"{rows[-1].time - recorder.zero:.1f} s")
        parts.append(f"{len(rows)}{of} samples")
    if rate := recorder.measured_rate():
        parts.append(f"{rate:.1f} S/s")
    if rows:
        parts.append("{} lost, {} damaged".format(*losses(recorder.missing)))
    return " | ".join(parts)


def hint(recorder):
    """A second line: why it does not arm, or the swing in numbers; "" where there is nothing to say."""
    if recorder.state == "waiting":
        unit = recorder.settings["signal_unit"]
        trigger = recorder.trigger
        moved = f"it moves by {recorder.watch.spread:.3g} {unit}; still is below {trigger['threshold']:g} for {trigger['pre_s']:g} s"
        return recorder.unarmed() or (moved if recorder.order.rows else "")
    return measured(recorder, LATELY) if recorder.rows else ""


def measured(recorder, seconds):
    """Amplitude, period and the loss a swing over the last ``seconds``, in a line; "" where nothing swings."""
    times, values = recent(recorder, seconds)
    swing = measure(times, values, recorder.noise()) if times else None
    if swing is None:
        return ""
    unit = recorder.settings["signal_unit"]
    parts = [f"amplitude {swing.amplitude:.4g} {unit}", f"period {swing.period:.4f} s"]
    if swing.loss is not None:
        parts.append(f"each swing loses {swing.loss:.2%}, over the last {MANY}")
    return " | ".join(parts)


class Swing(NamedTuple):
    """The last whole swing, to and fro."""

    amplitude: float  # half of highest less lowest, in the signal's unit
    period: float  # s, mean of the last swings, ten at most
    swings: int  # whole ones so far
    loss: float | None  # part of the amplitude that a swing loses, over the last ten; None before


def measure(times: npt.ArrayLike, values: npt.ArrayLike, noise: float = 0.0) -> Swing | None:
    """The amplitude and period of a swing, or None where nothing swings clearly above the noise.

    Parameters
    ----------
    times, values
        In s and the signal's unit, both of shape (sample,).
    noise
        Standard deviation, in the signal's unit.
    """
    times, values = np.asarray(times, float), np.asarray(values, float)
    if len(values) < 8:
        return None
    away = values - (np.max(values) + np.min(values)) / 2
    if np.max(np.abs(away)) < max(_CLEAR * noise, 1e-12):
        return None
    crossings, extremes = middle_crossings(times, away)
    count = (len(crossings) - 1) // 2
    if count < 1:
        return None
    at, halves = crossings[::-2][::-1], extremes[len(extremes) - 2 * count :].reshape(count, 2)
    sizes, last = halves.mean(axis=1), min(count, MANY)
    loss = float(1 - (sizes[-1] / sizes[-1 - MANY]) ** (1 / MANY)) if count > MANY else None
    return Swing(float(sizes[-1]), float((at[-1] - at[-1 - last]) / last), count, loss)


def recent(recorder, seconds=SECONDS):
    """Times (s before the last) and values (in the signal's unit) of the last ``seconds``, as two lists; of very many a part."""
    rows = recorder.order.rows[-int(seconds * recorder.rate) - 1 :]
    rows = rows[:: -(len(rows) // MOST + 1)][::-1]
    return [row.time - rows[-1].time for row in rows], [row.value * recorder.scale for row in rows]


def trace(times, values, width, rows=_ROWS):
    """The trace as ``rows`` lines of ``width`` braille characters, the newest sample at the right."""
    low, high = min(values), max(values)
    span = (high - low) or 1.0
    cells = [[0] * width for _ in range(rows)]
    for t, value in zip(times, values, strict=True):
        x = round((1 + t / SECONDS) * (2 * width - 1))
        y = round((high - value) / span * (4 * rows - 1))
        if 0 <= x < 2 * width:
            cells[y // 4][x // 2] |= _DOTS[x % 2][y % 4]
    return ["".join(chr(0x2800 + dots) for dots in line) for line in cells]


def trace_of(recorder, width):
    """The lines of the recorder's trace, with the highest and the lowest value at their ends."""
    times, values = recent(recorder)
    if not values:
        return []
    unit = recorder.settings["signal_unit"]
    lines = trace(times, values, max(width - 12, 10))
    lines[0] += f" {max(values):.4g} {unit}"
    lines[-1] += f" {min(values):.4g} {unit}"
    return lines


class TerminalView:
    """Draws over itself in a terminal; elsewhere writes a line now and then."""

    def __init__(self, stream=None):
        self._stream = stream or sys.stderr
        self._drawn, self._told, self._state = 0, 0.0, None
        self._terminal = self._stream.isatty() and os.environ.get("TERM") != "dumb"

    def show(self, recorder):
        """Draws the recorder as it stands."""
        width = self._width()
        lines = [status(recorder), *filter(None, [hint(recorder)])]
        if self._terminal:
            lines += trace_of(recorder, width)
        fresh = recorder.state != self._state
        bell = "\a" if recorder.state == "armed" and fresh else ""  # eyes are on the bob
        self._write(lines, fresh, bell)
        self._state = recorder.state
        if recorder.state == "ended":
            self._drawn = 0  # the picture stays, and the next one is drawn below

    def lines(self, lines):
        """Draws lines."""
        self._write(lines, False, "")

    def _width(self):
        return min(shutil.get_terminal_size().columns - 1, 120)

    def _write(self, lines, fresh, bell):
        if self._terminal:
            up = bell + (f"\x1b[{self._drawn}F" if self._drawn else "")
            width = self._width()
            drawn = [f"\x1b[2K{line[:width]}\n" for line in lines]
            blank = self._drawn - len(lines)
            below = "\x1b[2K\n" * blank + f"\x1b[{blank}F" if blank > 0 else ""
            self._stream.write(up + "".join(drawn) + below)
            self._drawn = len(lines)
        elif fresh or time.monotonic() - self._told > _QUIET:
            self._stream.write(" | ".join(line for line in lines if not _DRAWN.search(line)) + "\n")
            self._told = time.monotonic()
        self._stream.flush()

    def close(self):
        """Leaves the last picture where it is."""
