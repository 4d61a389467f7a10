"""Random pendulums for the engine's tests: drawn by seed and index, so that every one can be drawn again alone. And one with friction."""

import os
from dataclasses import dataclass
from zlib import crc32

import numpy as np

from swingdown.pendulum.catalogue import SHIPPED
from swingdown.pendulum.model import PAPER_MODELS, Model

# Pendulums of each model and effect. Where the C is changed: SWINGDOWN_DRAWS=50, as docs/engine.md says.
DRAWS = int(os.environ.get("SWINGDOWN_DRAWS", "12"))
# Wider than any bench: from a hundredth of the typical size to strong; the paper's terms up to where swings end at once.
RANGES = {
    "viscous_ratio": (1e-4, 0.5),
    "quadratic_coefficient": (1e-4, 0.3),
    "load_friction": (1e-4, 0.1),
    "constant_friction": (1e-3, 4.0),
    "stribeck_friction": (1e-3, 2.0),
    "stribeck_velocity": (0.05, 2.0),
    "presliding_friction": (1e-3, 2.0),
    "presliding_angle": (1e-3, 0.1),
    "power_law_coefficient": (1e-3, 1.0),
    "power_law_exponent": (0.2, 4.0),
    "structural_coefficient": (1e-2, 6.0),
    "added_mass": (1e-3, 0.3),
    "eddy_coefficient": (1e-2, 4.0),
    "eddy_width": (0.03, 1.0),
    "constant_torque": (-2.0, 2.0),
    "torsion_stiffness": (0.1, 20.0),
    "quadratic_stiffness": (-5.0, 5.0),
    "cubic_stiffness": (-10.0, 10.0),
    "detent_torque": (1e-2, 2.0),
    "detent_order": (4.0, 40.0),
    "detent_phase": (-3.0, 3.0),
    "magnet_depth": (-1.0, 1.0),
    "magnet_width": (0.03, 1.0),
    "pivot_mass_ratio": (1e-3, 0.5),
    "pivot_frequency": (5.0, 100.0),
    "pivot_damping_ratio": (1e-3, 0.5),
    "vibration_acceleration": (1e-2, 3.0),
    "vibration_frequency": (0.1, 20.0),
    "vibration_phase": (-3.0, 3.0),
    "damping_drift": (-0.003, 0.1),
    "wind_coefficient": (1e-3, 0.2),
    "wind_speed": (-2.0, 2.0),
    "backlash_width": (1e-4, 0.1),
    "lag_time": (1e-3, 0.2),
    "lag_start": (0.0, 1.5),
    "eccentricity": (1e-3, 0.1),
    "eccentricity_phase": (-3.0, 3.0),
    "sensor_gain": (-0.3, 0.3),
    "sensor_curvature": (-0.2, 0.2),
    "sensor_zero": (-0.5, 0.5),
    "clock_drift": (-0.1, 0.1),
}


TIMES = np.arange(501) / 100
SIXTY = float(np.radians(60))


@dataclass(frozen=True)
class Case:
    """A model with values, and a release (rad, rad/s) with sample times (s)."""

    model: Model
    times: np.ndarray
    release_angle: float
    release_velocity: float

    @property
    def arguments(self):
        """What ``simulate`` takes."""
        return self.model, self.times, self.release_angle, self.release_velocity


def generator(*key):
    """A random generator for a key of whole numbers and texts."""
    return np.random.default_rng([crc32(part.encode()) if isinstance(part, str) else part for part in key])


def value(rng, parameter):
    """A random value of a parameter: by its order of magnitude where it has a sign, else uniform."""
    low, high = RANGES.get(parameter.name) or _usual(parameter)
    return float(np.exp(rng.uniform(np.log(low), np.log(high))) if low > 0 else rng.uniform(low, high))


def _usual(parameter):
    """Where a parameter that is not in ``RANGES`` is drawn: about its typical size."""
    return max(parameter.lower, parameter.typical / 10), min(parameter.upper, parameter.typical * 3)


def draw(label, index, largest=SIXTY, seconds=4.0, restoring=None, form="consistent", **fixed):
    """A random ``Case`` of the model with that label; its swings would reach at most ``largest`` (rad) without friction.

    Half of the releases are at rest, some on the spot where friction may hold it; the samples are not evenly spaced.
    ``fixed`` sets parameters by name.
    """
    rng = generator(label, index, int(1e6 * largest))
    names = label.split("+")
    if restoring is None:
        restoring = (
            "linear" if "finite_amplitude" in names else str(rng.choice(["sine", "sine", "sine", "linear"]))
        )
    frequency = float(rng.uniform(2.0, 12.0))
    model = Model(label, restoring=restoring, form=form)
    values = {
        p.name: frequency if p.symbol == "omega_n" else value(rng, p) for p in model.definitions
    } | fixed
    amplitude = largest * (rng.uniform(0.02, 1.0) if index % 4 else rng.uniform(0.9, 1.0))
    angle, velocity = amplitude * rng.choice([-1.0, 1.0]), 0.0
    if index % 2:
        angle = float(rng.uniform(-1, 1)) * amplitude
        velocity = frequency * np.sqrt(2 * (np.cos(angle) - np.cos(amplitude))) * rng.choice([-1.0, 1.0])
    steps = rng.uniform(0.2, 1.8, 240)
    times = (
        rng.uniform(-1, 3)
        + np.concatenate([[0.0], np.cumsum(steps)]) * rng.uniform(0.5, 1.0) * seconds / steps.sum()
    )
    return Case(model.with_values(values), times, float(angle), float(velocity))


def friction(size):
    """A model whose friction (rad/s^2) is the same everywhere, so that it holds the pendulum near its rest."""
    values = {"natural_frequency": 7.0, "viscous_ratio": 0.005, "constant_friction": size}
    return Model("viscous+constant_coulomb", values)


def single_effects():
    """Labels of one model for each effect of the catalogue that is not of the paper's, on the paper's viscous pendulum."""
    return [
        "viscous+" + name
        for name in SHIPPED.names
        if name not in ("viscous", "quadratic_drag", "load_coulomb")
    ]


def paper_models():
    """The labels of the paper's seven models."""
    return list(PAPER_MODELS)
