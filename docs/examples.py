"""The files that the tutorials begin with, computed and not measured: ``python docs/examples.py anna.csv`` or ``… class``.

``anna.csv`` is a swing of 20 s with presliding friction hidden in it. ``class`` is a folder of thirty pendulums, each of another
length and friction, as a school's sensor exports them, and a file that is none.
"""

import sys
from pathlib import Path

import numpy as np
import pandas as pd

from swingdown.engine.trajectory import simulate
from swingdown.paths import write_csv
from swingdown.pendulum.model import Model

TIMES = np.arange(2001) / 100  # s
NOISE = 0.001  # rad


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


if __name__ == "__main__":
    place = Path(sys.argv[1])
    anna(place) if place.suffix == ".csv" else school(place)
