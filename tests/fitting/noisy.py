"""Noise that swings are read with: coloured, beside the mains, with samples missing."""

import numpy as np
from scipy.signal import lfilter

from swingdown.engine.trajectory import simulate
from swingdown.pendulum.model import Model

TIMES = np.arange(1000) / 50
CLEAN = simulate(Model("viscous", {"natural_frequency": 6.0, "viscous_ratio": 0.01}), TIMES, 0.3)

HUMMED = Model(
    "quadratic_drag+load_coulomb",
    {"natural_frequency": 7.25, "quadratic_coefficient": 0.02, "load_friction": 0.0018},
)


def noise(number, memory):
    rng = np.random.default_rng([5, number])
    white = rng.standard_normal(TIMES.size + 200)
    return 1e-3 * lfilter([np.sqrt(1 - memory**2)], [1, -memory], white)[200:]


def with_hum(rate, number, hum=7e-4):
    """Times, and the angle of a pendulum under a little white noise and the mains' 50 Hz at some phase."""
    rng, times = np.random.default_rng([9, number]), np.arange(15 * rate) / rate
    wave = np.sin(2 * np.pi * 50 * (1 + 1e-4 * rng.standard_normal()) * times + rng.uniform(0, 2 * np.pi))
    clean = simulate(HUMMED, times, rng.uniform(0.3, 0.6))
    return times, clean + hum * wave + 1e-4 * rng.standard_normal(times.size)


def lost(how, size, rng):
    """Which samples are there where a third is lost at random, in bursts of 0.6 s, or one of three."""
    kept = np.ones(size, dtype=bool)
    if how == "at random":
        kept = rng.random(size) > 0.3
    elif how == "in bursts":
        while np.count_nonzero(kept) > 0.7 * size:
            at = rng.integers(1, size - 30)
            kept[at : at + 30] = False
    elif how == "every third":
        kept[2::3] = False
    kept[0] = True
    return kept
