"""Noisy swings for tests of the fitter and for the benchmark: the cases that all fitters are timed and judged on.

1001 samples in 10 s with white noise of a fiftieth of the swing's root mean square. ``five`` and ``seven`` swing to the
end of the record; ``sticking`` is the paper's pendulum, which friction stops after 3 s.
"""

from dataclasses import dataclass

import numpy as np

from swingdown.engine.trajectory import simulate
from swingdown.fitting.least_squares import fit_trajectory
from swingdown.fitting.result import Begin, SwingStart
from swingdown.pendulum.model import Model

TIMES = np.arange(1001) / 100
SHORT = TIMES[:501]
SNR = 50
PAPER = {
    "natural_frequency": 7.25,
    "viscous_ratio": 0.03,
    "quadratic_coefficient": 0.05,
    "load_friction": 0.012,
}


@dataclass(frozen=True)
class Swing:
    """A true model with its release (rad, rad/s)."""

    model: Model
    release_angle: float
    release_velocity: float

    def clean(self):
        """The angle without noise, rad."""
        return simulate(self.model, TIMES, self.release_angle, self.release_velocity)

    def noisy(self, seed):
        """The angle with noise, rad, and the noise's standard deviation."""
        clean = self.clean()
        noise = float(np.sqrt(np.mean(clean**2))) / SNR
        return clean + noise * np.random.default_rng([150, seed]).standard_normal(clean.size), noise


def _swing(label, degrees, **values):
    return Swing(
        Model(label, {"natural_frequency": 7.25, "sensor_zero": 0.01} | values),
        float(np.radians(degrees)),
        0.1,
    )


FULL = "viscous+quadratic_drag+load_coulomb+sensor_zero"
CASES = {
    "five": _swing("viscous+sensor_zero", 20, viscous_ratio=0.03),
    "seven": _swing(FULL, 90, viscous_ratio=0.005, quadratic_coefficient=0.005, load_friction=0.012),
    "sticking": _swing(FULL, 20, viscous_ratio=0.03, quadratic_coefficient=0.05, load_friction=0.012),
}


def fit_from(case, angle, values, release_angle, release_velocity, **options):
    """The fit from these values and this release alone: no start from what is seen in the data."""
    start = Begin(case.model, (SwingStart(values, release_angle, release_velocity),))
    return fit_trajectory(case.model.label, TIMES, angle, guess=start, seen=False, **options)


def random_start(case, rng):
    """Values, release angle and velocity far from the truth: frequency within 10 %, coefficients from none to three times."""
    values = {
        name: value * (rng.uniform(0.9, 1.1) if name == "natural_frequency" else rng.uniform(0.0, 3.0))
        for name, value in case.model.values.items()
    }
    return values, case.release_angle * rng.uniform(0.8, 1.2), float(rng.uniform(-0.5, 0.5))


def paper_model(label):
    """A model with coefficients as large as the paper's pendulum has."""
    return Model(label, {name: PAPER[name] for name in Model(label).parameters})
