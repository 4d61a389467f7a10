"""A class of thirty: files as thirty students leave them, one of them bad, in a folder. What the command takes for them is CPU time.

    .venv/bin/python tests/benchmarks/class_of_thirty.py FOLDER

Writes the files and runs ``swingdown FOLDER --quick``, with a column of lengths beside them. Prints the CPU time until the first table and the
first figure are there, and to the end.

Twenty-six are swings of the second pendulum, in the formats of several programs, three of them of a gyroscope; three are real
recordings (../shared/data/real); one is no recording.
"""

import os
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pandas as pd

from swingdown_trials.second_pendulum import trajectory

REAL = Path(os.environ.get("SWINGDOWN_SHARED", Path(__file__).parents[3] / "shared/data")) / "real"
NAMES = ("Jürgen", "swing 1", "swing 2", "swing 10", "Anna-Lena", "Zoë", "groupe é", "Gruppe 3 a", "Gruppe 3 b", "Łukasz",
         "ben", "Ben", "José (2)", "05", "trial.final", "mesure n°4", "Müller & Söhne", "x", "long name of a pendulum that nobody needs",
         "pendel_07", "pendel_08", "pendel_09", "A1", "A2", "A3", "schön")  # fmt: skip
BASE = ("viscous", "load_coulomb")
HIDDEN = {
    "presliding": {"presliding_friction": 0.1, "presliding_angle": 0.006},
    "quadratic_drag": {"quadratic_coefficient": 0.08},
}


def swing(rng: np.random.Generator, extra: str, reading: str = "angle"):
    """Natural frequency (rad/s), times (s) and angles (rad) or rates (rad/s) of one pendulum, with noise."""
    values = {"natural_frequency": rng.uniform(4, 9), "viscous_ratio": rng.uniform(0.001, 0.006), "load_friction": rng.uniform(5e-4, 4e-3)}  # fmt: skip
    names = (*BASE, *([extra] if extra else []))
    times = np.arange(0, 20, 1 / rng.choice([50, 60, 100]))
    exact = trajectory(names, values | HIDDEN.get(extra, {}), times, rng.uniform(0.2, 0.7), reading=reading).reading  # fmt: skip
    return (
        values["natural_frequency"],
        times,
        exact + rng.normal(0, 3e-3 if reading == "rate" else 6e-4, times.size),
    )


def write(folder: Path) -> None:
    """The files."""
    folder.mkdir(parents=True, exist_ok=True)
    rng, lengths = np.random.default_rng(30), []
    for k, name in enumerate(NAMES):
        reading = "rate" if k % 9 == 4 else "angle"
        frequency, times, values = swing(rng, ("", "", "presliding", "", "quadratic_drag")[k % 5], reading)
        rows = zip(times, values, strict=True)
        if reading == "rate":
            text = '"Time (s)";"Gyroscope x (rad/s)";"Gyroscope y (rad/s)";"Gyroscope z (rad/s)"\n' + "".join(
                f"{t:.9E};{0.001:.9E};{v:.9E};{0.002:.9E}\n".replace(".", ",") for t, v in rows
            )
        elif k % 3 == 0:
            text = "Time (s),Angle (°)\n" + "".join(f"{t:.4f},{np.degrees(v):.4f}\n" for t, v in rows)
        elif k % 3 == 1:
            text = "t\ttheta [rad]\n" + "".join(f"{t:.4f}\t{v:.6f}\n".replace(".", ",") for t, v in rows)
        else:
            text = "time_ms,angle_deg\n" + "".join(f"{1e3 * t:.0f},{np.degrees(v):.3f}\n" for t, v in rows)
        place = folder / f"{name}.csv"
        if any(one.name.lower() == place.name.lower() for one in folder.iterdir()):
            place = folder / f"{name}.tsv"
        place.write_text(text, encoding="latin-1" if name.isascii() else "utf-8")
        lengths.append((place.name, round(9.81 / frequency**2, 4), 0.001))
    for one in (
        "dynamicslab_single/free_swing_small.csv",
        "jensen_rotary/rel45.csv",
        "jensen_rotary/rel90.csv",
    ):
        (folder / Path(one).name).write_bytes((REAL / one).read_bytes())
    pd.DataFrame(lengths, columns=["file", "length (m)", "u_length"]).to_csv(
        folder / "lengths.csv", index=False
    )
    (folder / "holiday.csv").write_bytes(b"\x89PNG\r\n\x1a\n" + bytes(range(256)) * 40)


def used(process: int) -> float:
    """CPU time (s) of a process and of its children that have ended."""
    fields = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
    return sum(map(int, fields[11:15])) / os.sysconf("SC_CLK_TCK")


def first(folder: Path, into: Path) -> None:
    """Prints what the command takes until its first table, its first figure and its end."""
    command = [Path(sys.executable).parent / "swingdown", folder, "--quick", "--into", into]
    before, seen = os.times(), {}
    with subprocess.Popen(command, stdout=subprocess.DEVNULL) as running:
        while running.poll() is None:
            for name, pattern in (("table", "*.csv"), ("figure", "*.png")):
                if name not in seen and any(one.name != "recordings.csv" for one in into.glob(pattern)):
                    seen[name] = used(running.pid)
            time.sleep(0.01)
    after = os.times()
    seen["end"] = after.children_user + after.children_system - before.children_user - before.children_system
    print(", ".join(f"{name} {taken:.1f} s" for name, taken in seen.items()))


if __name__ == "__main__":
    write(Path(sys.argv[1]))
    first(Path(sys.argv[1]), Path(f"{sys.argv[1]}-swingdown"))
