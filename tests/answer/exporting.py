"""Swings as a program exports them."""

import numpy as np
import pandas as pd

from swingdown.engine.trajectory import simulate
from swingdown.pendulum.model import Model

TIMES = np.arange(1001) / 100


def export(path, frequency=7.25, angle=0.3, seed=0, times=TIMES, header=("Time (s)", "Angle (°)")):
    """The path of a file of a viscous pendulum with that frequency (rad/s), let go at that angle (rad)."""
    model = Model("viscous", {"natural_frequency": frequency, "viscous_ratio": 0.008})
    noise = 0.002 * np.random.default_rng(seed).standard_normal(times.size)
    table = pd.DataFrame({header[0]: times, header[1]: np.degrees(simulate(model, times, angle) + noise)})
    path.parent.mkdir(parents=True, exist_ok=True)
    table.round(5).to_csv(path, index=False)
    return path
