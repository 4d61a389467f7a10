"""Readings in steps: the step is found, and what rounding does to fitted values is what it does in simulations."""

import numpy as np
import pytest

from swingdown.engine.trajectory import sensitivities
from swingdown.pendulum.model import Model
from swingdown.quantisation import quantisation_step, rounding

MODEL = Model(
    ("quadratic_drag", "load_coulomb"),
    {"natural_frequency": 7.25, "quadratic_coefficient": 0.0012, "load_friction": 0.0018},
)


def test_steps_of_a_signal():
    x = np.sin(np.arange(5000) / 30)
    assert quantisation_step(np.round(x / 0.003) * 0.003) == pytest.approx(0.003, rel=1e-6)
    assert quantisation_step(x) == 0


@pytest.mark.parametrize("ratio", [0.0, 0.1, 0.25])
def test_the_spread_of_fitted_values_under_rounding_is_foretold(ratio):
    times, step, rng = np.arange(3000) / 200, 0.01, np.random.default_rng(3)
    free = [*MODEL.parameters, "release_angle", "release_velocity"]
    signal, slopes = sensitivities(MODEL, times, 0.47, 0.0, free=free)
    inverse = np.linalg.inv(slopes @ slopes.T)
    shifts = []
    for _ in range(1500):
        offset = rng.uniform(0, step)
        read = step * np.round((signal + ratio * step * rng.standard_normal(times.size) - offset) / step)
        shifts.append(inverse @ slopes @ (read + offset - signal))
    white = step**2 * (1 / 12 + ratio**2)
    foretold = np.diag(white * inverse + inverse @ rounding(slopes, signal, step, ratio * step) @ inverse)
    # where rounding does less than noise would, half of that is kept as a guard
    assert np.all((share := np.var(shifts, axis=0) / foretold) < 1.15)
    assert np.all(share > (0.5 if ratio < 0.1 else 0.85))
    # what independent errors would do is far off where steps are coarse, and about right where noise hides them
    alone = np.var(shifts, axis=0) / np.diag(white * inverse)
    assert (np.max(alone) > 1.5) == (ratio < 0.2)
