"""A swing in somebody's file, and what is true of it."""

import numpy as np

from swingdown.engine.trajectory import simulate
from swingdown.pendulum.model import Model

TRUTH = {"natural_frequency": 6.2, "viscous_ratio": 0.006}
TIMES = np.arange(900) / 60
NOISE = 0.002  # rad


def swing(release=0.25, seed=1):
    exact = simulate(Model("viscous", TRUTH), TIMES, release)
    return exact + NOISE * np.random.default_rng(seed).standard_normal(TIMES.size)


def written(path, header, *columns, separator=","):
    rows = [separator.join(f"{cell:.9g}" for cell in row) for row in zip(*columns, strict=True)]
    path.write_text("\n".join([*([header] if header else []), *rows, ""]))
    return path


def holds_the_truth(row):
    for name, unit in (("natural_frequency", "_rad_per_s"), ("viscous_ratio", "")):
        assert abs(row[name + unit] - TRUTH[name]) < 4 * row[f"{name}{unit}_u"], name
    assert row["natural_frequency_rad_per_s_u"] < 2e-3 and row["residual_rad"] < 1.2 * NOISE
