"""What the experimenter sees in the terminal while a swing is recorded: how many samples, how fast, what is lost, the trace."""

import os
import shutil
import sys
import time

SECONDS = 10.0  # of the trace
_ROWS = 6  # lines of the trace, four dots each
_QUIET = 5.0  # s between lines where there is no terminal
_DOTS = (
    (0x01, 0x02, 0x04, 0x40),
    (0x08, 0x10, 0x20, 0x80),
)  # of a braille character: column, row from the top
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
        missing = recorder.missing
        damaged = sum(flag for _, flag in missing)
        parts.append(f"{len(missing) - damaged} lost, {damaged} damaged")
    return " | ".join(parts)


def recent(recorder):
    """Times (s before the last) and values (in the signal's unit) of the last seconds, as two lists."""
    rows = recorder.order.rows[-int(SECONDS * recorder.rate) - 1 :]
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


class TerminalView:
    """Draws over itself in a terminal; elsewhere writes a line now and then."""

    def __init__(self, stream=None):
        self._stream = stream or sys.stderr
        self._drawn, self._told, self._state = 0, 0.0, None
        self._terminal = self._stream.isatty() and os.environ.get("TERM") != "dumb"

    def show(self, recorder):
        """Draws the recorder as it stands."""
        if self._terminal:
            width = min(shutil.get_terminal_size().columns - 1, 120)
            lines = [status(recorder)[:width]]
            times, values = recent(recorder)
            if values:
                unit = recorder.settings["signal_unit"]
                lines += trace(times, values, max(width - 12, 10))
                lines[1] += f" {max(values):.4g} {unit}"
                lines[-1] += f" {min(values):.4g} {unit}"
            bell = "\a" if recorder.state == "armed" != self._state else ""  # eyes are on the bob
            up = bell + (f"\x1b[{self._drawn}F" if self._drawn else "")
            self._stream.write(up + "".join(f"\x1b[2K{line}\n" for line in lines))
            self._drawn = len(lines)
        elif recorder.state != self._state or time.monotonic() - self._told > _QUIET:
            self._stream.write(status(recorder) + "\n")
            self._told = time.monotonic()
        self._state = recorder.state
        self._stream.flush()

    def close(self):
        """Leaves the last picture where it is."""
