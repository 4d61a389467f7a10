"""What a board sends, made by hand, and a pseudo-terminal that sends it: written from the protocol, not from the parser."""

import os
import pty
import select
import threading
import time
import tty


def crc16(data):
    """CRC-16/CCITT-FALSE, bit by bit."""
    crc = 0xFFFF
    for byte in data:
        crc ^= byte << 8
        for _ in range(8):
            crc = (crc << 1 ^ 0x1021 if crc & 0x8000 else crc << 1) & 0xFFFF
    return crc


def frame(sequence, value):
    """One frame of the binary format."""
    body = (sequence % 65536).to_bytes(2, "little") + value.to_bytes(2, "little")
    return b"\xa5\x5a" + body + crc16(body).to_bytes(2, "little")


def frames(values, first=0):
    """Frames of consecutive sequence numbers, as one piece."""
    return b"".join(frame(first + k, value) for k, value in enumerate(values))


SETTINGS = {
    "format": "frames", "columns": [], "rate_hz": 100, "scale": 1, "signal_unit": "V", "duration_s": 1.0, "timeout_s": 0.5,
    "settle_s": 0, "baud": 115200, "operator": "", "apparatus": "", "notes": "", "campaign": "mine", "emulated": True,
    "still_s": 1.0, "height_limit": 5e-5,
}  # fmt: skip


class Line:
    """A pseudo-terminal: ``port`` is what a recording opens; ``send`` writes to it, ``unplug`` closes it."""

    def __init__(self):
        self._board, slave = pty.openpty()
        tty.setraw(slave)
        self.port = os.ttyname(slave)
        os.close(slave)
        self._thread, self._over, self.begun = None, threading.Event(), threading.Event()
        self._unplugging = threading.Lock()  # a timer may unplug it while the test ends

    def send(self, data):
        os.write(self._board, data)

    def play(self, pieces, unplug=False):
        """Sends (pause in s, bytes) in the background once the port is open, then unplugs; ``begun`` is set when it sends."""
        self._end()
        self._over.clear()
        self.begun.clear()

        def run():
            self._wait_until_open()
            if self._over.wait(0.2):  # whoever opens the port empties it
                return
            self.begun.set()
            due = time.monotonic()
            for pause, data in pieces:
                due += pause
                if self._over.wait(max(due - time.monotonic(), 0)):
                    return
                self.send(data)
            if unplug:
                time.sleep(0.1)
                self.unplug()

        self._thread = threading.Thread(target=run, daemon=True)
        self._thread.start()

    def _wait_until_open(self):
        """Until a recording has the port: the other end of a pseudo-terminal is hung up as long as nobody has it open."""
        line = select.poll()
        line.register(self._board, 0)
        while line.poll(0) and not self._over.wait(0.005):
            pass

    def unplug(self):
        with self._unplugging:
            if self._board is not None:
                os.close(self._board)
                self._board = None

    def _end(self):
        self._over.set()
        if self._thread:
            self._thread.join(10)

    def close(self):
        self._end()
        self.unplug()
