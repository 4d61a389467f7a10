"""The files that the tutorials begin with, computed and not measured: ``python docs/examples.py anna.csv`` or ``… class``.

``anna.csv``, which ``resources/example`` holds too, is a swing of 20 s with presliding friction hidden in it. ``class`` is a folder of thirty pendulums, each of another
length and friction, as a school's sensor exports them, and a file that is none. ``lengths``, ``sails`` and ``groups`` are series: eight
lengths in the names, sails in a table beside the files, and six groups of which one measured another pendulum. ``stopwatch.csv`` is a table
of three times of ten swings for each of six lengths. ``pohl.csv`` is a wheel on a
spring whose other end a motor turns, with the motor's angle.
"""

import sys
from pathlib import Path

import numpy as np
import pandas as pd

from swingdown.engine.trajectory import simulate
from swingdown.paths import write_csv, write_text
from swingdown.pendulum.drive import drive
from swingdown.pendulum.model import Model

TIMES = np.arange(2001) / 100  # s
NOISE = 0.001  # rad
ABOUT = "# emulated: yes\n# source: docs/examples.py, computed; no pendulum was recorded\n"


def export(path: Path, model: Model, release_angle: float, seed: int) -> None:
    """Writes a swing of the model from ``release_angle`` (rad) with noise, as time in s and angle in degrees."""
    noise = NOISE * np.random.default_rng(seed).standard_normal(TIMES.size)
    angle = np.degrees(simulate(model, TIMES, release_angle) + noise)
    path.parent.mkdir(parents=True, exist_ok=True)
    write_csv(pd.DataFrame({"Time (s)": TIMES, "Angle (°)": angle.round(4)}), path)


def anna(path: Path) -> None:
    """Writes one swing of a pendulum whose bearing winds up over 6 mrad before it slips."""
    values = {
        "natural_frequency": 7.25,
        "viscous_ratio": 0.004,
        "presliding_friction": 0.12,
        "presliding_angle": 0.006,
    }
    export(path, Model("viscous+presliding", values), np.radians(20), seed=1)
    write_text(path, ABOUT + path.read_text(encoding="utf-8"))


def pohl(path: Path) -> None:
    """Writes one record of a Pohl wheel that a motor turns the spring of, up and down through its resonance, with the motor's angle."""
    lever = np.radians(2.0) * np.sin(2 * np.pi * (0.8 * TIMES + 0.012 * TIMES**2))
    values = {"natural_frequency": 6.5, "viscous_ratio": 0.02, "constant_friction": 0.08}
    under = drive(TIMES, lever, "pivot_angle")
    wheel = Model(f"viscous+constant_coulomb+{under.effect}", values, restoring="linear", drive=under)
    noise = NOISE * np.random.default_rng(4).standard_normal(TIMES.size)
    angle = np.degrees(simulate(wheel, TIMES, 0.0) + noise)
    columns = {"Time (s)": TIMES, "Wheel (°)": angle.round(4), "Motor (°)": np.degrees(lever).round(4)}
    write_csv(pd.DataFrame(columns), path)
    write_text(path, ABOUT + path.read_text(encoding="utf-8"))


def school(folder: Path) -> None:
    """Writes thirty pendulums from 25 cm to 1 m, each with air and bearing of its own, and a file that is no recording."""
    draw = np.random.default_rng(2026)
    for number, length in enumerate(np.linspace(0.25, 1.0, 30), start=1):
        values = {
            "natural_frequency": np.sqrt(9.81 / length),
            "viscous_ratio": draw.uniform(0.002, 0.01),
            "load_friction": draw.uniform(0.001, 0.004),
        }
        export(
            folder / f"group {number}.csv",
            Model("viscous+load_coulomb", values),
            draw.uniform(0.2, 0.5),
            number,
        )
    (folder / "group 31.csv").write_text("our pendulum broke\n")


def viscous(path: Path, length: float, ratio: float, seed: int) -> None:
    """Writes one swing of a viscous pendulum of that length (m), let go at 20 degrees."""
    values = {"natural_frequency": np.sqrt(9.81 / length), "viscous_ratio": ratio}
    export(path, Model("viscous", values), np.radians(20), seed)


def lengths(folder: Path) -> None:
    """Writes pendulums from 20 cm to 1 m, whose lengths were read off a ruler with errors of a millimetre."""
    draw = np.random.default_rng(26)
    for seed, name in enumerate((20, 25, 30, 40, 50, 60, 80, 100)):
        viscous(folder / f"{name}cm.csv", name / 100 + draw.normal(0, 0.001), 0.006, seed)


def sails(folder: Path) -> None:
    """Writes a pendulum with five sails, one of them none, and their areas in a table."""
    rows = ["file,area (cm²),u_area"]
    for seed, area in enumerate((0, 20, 40, 60, 80)):
        viscous(folder / f"sail {seed}.csv", 0.4, 0.002 + 2e-4 * area, seed)
        rows.append(f"sail {seed}.csv,{area},{0.5 if area else 0}")
    (folder / "sails.csv").write_text("\n".join(rows) + "\n", encoding="utf-8")


def groups(folder: Path) -> None:
    """Writes six groups with two recordings each of one pendulum; the fourth has measured another."""
    rows = ["file,group"]
    for group in range(1, 7):
        for take in (1, 2):
            length = 0.4 if group != 4 else 0.396
            viscous(folder / f"{group}-{take}.csv", length, 0.005, 10 * group + take)
            rows.append(f"{group}-{take}.csv,group {group}")
    (folder / "who.csv").write_text("\n".join(rows) + "\n", encoding="utf-8")


def stopwatch(path: Path) -> None:
    """Writes times of ten swings, with the 0.1 s by which a hand is early or late, of bobs on strings of six lengths."""
    random = np.random.default_rng(6)
    table = pd.DataFrame({"Length (cm)": [20, 30, 45, 60, 80, 100]})
    for trial in (1, 2, 3):
        times = 20 * np.pi * np.sqrt(table["Length (cm)"] / 981)
        table[f"Time for 10 swings, trial {trial} (s)"] = (times + random.normal(0, 0.1, len(table))).round(2)
    write_text(path, ABOUT + table.to_csv(index=False))


def roll(path: Path) -> None:
    """Writes the roll of a hull after a push to 14 degrees: a linear restoring moment, wave-making (viscous) and eddies (quadratic)."""
    values = {"natural_frequency": 0.62, "viscous_ratio": 0.012, "quadratic_coefficient": 0.16}
    model = Model("viscous+quadratic_drag", values, restoring="linear")
    times = np.arange(1801) / 10  # s
    noise = NOISE * np.random.default_rng(7).standard_normal(times.size)
    angle = np.degrees(simulate(model, times, np.radians(14)) + noise)
    write_csv(pd.DataFrame({"t (s)": times, "roll (deg)": angle.round(4)}), path)
    write_text(path, ABOUT + path.read_text(encoding="utf-8"))


FILES = {"pohl": pohl, "roll": roll, "stopwatch": stopwatch}
FOLDERS = {"lengths": lengths, "sails": sails, "groups": groups}

if __name__ == "__main__":
    place = Path(sys.argv[1])
    make = FILES.get(place.stem, anna) if place.suffix == ".csv" else FOLDERS.get(place.name, school)
    make(place)
