"""An emulated board: the real firmware in simavr behind a pseudo-terminal, with an emulated pendulum's voltage on its A0.

    python tests/firmware/board.py PORT swing [--release-deg 24] [--held 6]
    python tests/firmware/board.py PORT tower --height 0.035
    python tests/firmware/board.py PORT rest
    python tests/firmware/board.py PORT hands

PORT is the name that the port gets (a link to a pseudo-terminal). The pendulum and its lengths are those of
resources/bench/emulate.py; the sensor spreads 72 degrees over 5 V. A swing is held for some seconds after the port is opened,
then let go. With ``hands`` it does what is typed: ``tower 0.02385``, ``rest``, ``hold 24`` (degrees), ``go``. Needs gcc, avr-gcc and simavr (tools/install-test-tools). It proves firmware and protocol, not analogue noise or USB.
"""

import argparse
import contextlib
import importlib.util
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from math import radians
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
SKETCH = ROOT / "resources/firmware/sampler/sampler.ino"
VOLTS_PER_RADIAN, ZERO_VOLTAGE = 5.0 / radians(72.0) * 1.0012, 2.5033
STEP = 5.0 / 1024  # V, of the converter
NEEDED = ("gcc", "avr-gcc", "simavr")

_spec = importlib.util.spec_from_file_location("emulate", ROOT / "resources/bench/emulate.py")
emulate = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(emulate)


def lacking():
    """The programs that emulation needs and that are not here, and what of simavr's library is not."""
    found = [name for name in NEEDED if not shutil.which(name)]
    headers = ("/usr/include/simavr/sim_avr.h", "/usr/include/libelf.h", "/usr/lib/avr/include/avr/io.h")
    return found + [path for path in headers if not Path(path).exists()]


def build(folder, rate=100, mcu="atmega328p", language="c", **defined):
    """The emulator and the firmware, built in ``folder``: their paths. ``defined`` are the sketch's choices."""
    folder = Path(folder)
    firmware, host = folder / f"sampler-{rate}.elf", folder / "board"
    chosen = [f"-D{name}={value}" for name, value in {"RATE": rate, **defined}.items()]
    standard = ["-std=gnu11"] if language == "c" else []
    subprocess.run(
        ["avr-gcc", "-x", language, *standard, "-Wall", "-Wextra", "-Werror", f"-mmcu={mcu}", "-DF_CPU=16000000UL",
         *chosen, "-Os", SKETCH, "-o", firmware],
        check=True, capture_output=True, text=True,
    )  # fmt: skip
    if not host.exists():
        source = Path(__file__).with_name("board.c")
        libraries = ["-lsimavr", "-lelf", "-lutil", "-lm"]
        command = ["gcc", "-Wall", "-Wextra", "-O2", source, "-o", host, "-I/usr/include/simavr", *libraries]
        subprocess.run(command, check=True)
    return host, firmware


def volts(angle):
    """The sensor's voltage (V) at an angle (rad)."""
    return ZERO_VOLTAGE + VOLTS_PER_RADIAN * np.asarray(angle)


def swing(release_deg, held, seconds):
    """Times (s since the port was opened) and angles (rad) of a bob held, then let go from rest."""
    times = np.arange(round(1000 * seconds)) / 1000
    return np.concatenate([[0.0], held + times]), np.concatenate(
        [[radians(release_deg)], emulate.motion(times, radians(release_deg))]
    )


def towered(height):
    """Times and angles (rad) of a bob on a tower of that height (m)."""
    return [0.0], [emulate.tower_angle(height)]


class Hands:
    """Does with the pendulum what a line of words says, on a Board that runs; ``held`` is at what angle (degrees), or None."""

    SAYS = "tower HEIGHT (m), rest, hold DEGREES, go (lets go what is held), or Ctrl-C"

    def __init__(self, board):
        self._board, self.held = board, None

    def do(self, line):
        """What was done, in words; ValueError for what hands cannot do."""
        word, *more = line.split() or [""]
        held, self.held = self.held, None
        if word == "tower" and len(more) == 1:
            self._board.show(*towered(float(more[0])))
            return f"on the tower of {float(more[0]):g} m"
        if word == "rest" and not more:
            self._board.show([0.0], [emulate.REST_ANGLE])
            return "at rest"
        if word == "hold" and len(more) == 1:
            self.held = float(more[0])
            self._board.show([0.0], [radians(self.held)])
            return f"held still at {self.held:g} degrees"
        if word == "go" and not more and held is not None:
            self._board.show(*swing(held, 0.001, 120))
            return f"let go at {held:g} degrees"
        self.held = held
        raise ValueError(
            "nothing is held" if word == "go" else f"{line.strip()!r} is none of these: {self.SAYS}"
        )


def _before_others():
    """Where it may, the emulated board comes before other programs, as a board of its own does."""
    with contextlib.suppress(PermissionError):
        os.nice(-10)


class Board:
    """A board that runs while the ``with`` block does; ``port`` is its port's path, ``truth()`` what its converter saw.

    With ``counts`` (a revolution) an encoder is on its pins in place of the sensor; ``aref`` (V) is on its pin of that name,
    ``held_up`` is how many seconds after its reset it begins to fall behind, by two seconds in three, and ``defined`` are the
    sketch's choices.
    """

    def __init__(
        self,
        folder,
        times,
        angles,
        rate=100,
        boot=0.5,
        port=None,
        counts=None,
        aref=5,
        held_up=np.inf,
        **defined,
    ):
        self.folder, self.held_up = Path(folder), held_up
        self.port = Path(port or self.folder / "port")
        self._volts, self._truth = self.folder / "volts", self.folder / "truth"
        signal = volts(angles) if counts is None else counts / (2 * np.pi) * np.asarray(angles)
        self._write(times, signal)
        kind = "analog" if counts is None else "encoder"
        host, firmware = build(self.folder, rate, ENCODER=int(kind == "encoder"), **defined)
        self._command = [
            host,
            firmware,
            self._volts,
            self._truth,
            str(boot),
            self.port,
            kind,
            str(aref),
            str(held_up),
        ]

    def __enter__(self):
        with open(self.folder / "board.log", "w") as log:
            self.process = subprocess.Popen(
                list(map(str, self._command)), stdout=log, stderr=log, preexec_fn=_before_others
            )
        for _ in range(100):
            if self.port.exists():
                return self
            time.sleep(0.05)
        raise RuntimeError((self.folder / "board.log").read_text())

    def __exit__(self, *_):
        self.unplug()

    def _write(self, times, signal):
        np.savetxt(self._volts, np.column_stack([times, signal]), fmt="%.7f")

    def show(self, times, angles):
        """From now on the sensor sees these angles (rad) at these times (s from now)."""
        self._write(times, volts(angles))
        self.process.send_signal(signal.SIGUSR1)

    def unplug(self):
        """The board is gone, and its port with it."""
        self.process.kill()
        self.process.wait()
        self.port.unlink(missing_ok=True)

    def truth(self):
        """The voltage (V), the processor's cycle and the host's clock (s) at each conversion since the last reset, by sequence number."""
        rows = np.loadtxt(self._truth.read_text().rpartition("\n")[0].splitlines())
        last = rows[rows[:, 0] == rows[-1, 0]]
        return last[:, 2], last[:, 3], last[:, 4]


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("port")
    parser.add_argument("scene", choices=["swing", "tower", "rest", "hands"])
    parser.add_argument("--release-deg", type=float, default=24)
    parser.add_argument("--held", type=float, default=6, help="s between opening the port and letting go")
    parser.add_argument("--seconds", type=float, default=120, help="how long it swings")
    parser.add_argument("--height", type=float, default=0.03445, help="m")
    arguments = parser.parse_args()
    if missing := lacking():
        parser.exit(1, f"NOT HERE: {', '.join(missing)}. Mend: run tools/install-test-tools\n")
    if arguments.scene == "swing":
        scene = swing(arguments.release_deg, arguments.held, arguments.seconds)
    elif arguments.scene == "tower":
        scene = towered(arguments.height)
    else:
        scene = [0.0], [emulate.REST_ANGLE]
    with tempfile.TemporaryDirectory() as folder, Board(folder, *scene, port=arguments.port) as board:
        print(f"EMULATED board at {board.port}: {arguments.scene}. Ctrl-C unplugs it.", flush=True)
        with contextlib.suppress(KeyboardInterrupt):
            if arguments.scene == "hands":
                listen(Hands(board))
            board.process.wait()


def listen(hands):
    """None, when nothing more is typed: each line is done as it comes."""
    print(f"Type {hands.SAYS}.", flush=True)
    for line in sys.stdin:
        try:
            print(hands.do(line), flush=True)
        except ValueError as error:
            print(error, flush=True)


if __name__ == "__main__":
    main()
