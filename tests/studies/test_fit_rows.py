"""What a dataset of fits keeps of each."""

import numpy as np
import pytest

from swingdown.answer.given import swings
from swingdown.engine.trajectory import TrajectoryError, simulate
from swingdown.pendulum.model import Model
from swingdown.studies.experiment import fit_recording
from swingdown.studies.fit_rows import rows_of

TRUTH = Model("viscous", {"natural_frequency": 7.25, "viscous_ratio": 0.01})
TIMES = np.arange(600) / 100


@pytest.mark.parametrize("sigma", [1e-3, None])
def test_the_reduced_chi2_is_of_the_random_uncertainty_and_unknown_without_one(sigma):
    """With the noise as stated it is near 1: within four of its standard deviations."""
    noise = 1e-3 * np.random.default_rng(4).standard_normal(TIMES.size)
    (angle,) = swings(TIMES, simulate(TRUTH, TIMES, 0.3) + noise)
    told = np.full(TIMES.size, np.nan if sigma is None else sigma)
    angle["angle_random_uncertainty"] = angle["angle_random_uncertainty"].copy(data=told)
    fits = fit_recording(angle, ["viscous"])
    found = float(fits["reduced_chi2"].sel(fitted="viscous"))
    if sigma is None:
        assert np.isnan(found)
    else:
        left = fits["residual"].sel(fitted="viscous").values
        assert found == pytest.approx(np.sum(left**2) / sigma**2 / (TIMES.size - 5), rel=1e-9)
        assert abs(found - 1) < 4 * np.sqrt(2 / TIMES.size)


def test_a_model_that_breaks_off_around_its_fit_is_not_converged_and_the_others_are_told():
    def row(value):
        if value < 0:
            raise TrajectoryError("the accuracy could not be kept")
        return {"norm": value, "value": np.array([value, 1.0]), "converged": True}

    rows = rows_of([0.1, -1.0, None], row)
    assert [one["converged"] for one in rows] == [True, False, False]
    assert rows[0]["norm"] == 0.1 and np.isnan(rows[1]["norm"]) and np.isnan(rows[1]["value"]).all()
    with pytest.raises(TrajectoryError, match="accuracy"):
        rows_of([-1.0, None], row)


def test_the_largest_angle_is_counted_from_where_the_fitted_model_hangs():
    """A torque pulls it aside by torque/omega_n^2 on a spring: the largest swing is that far from there, not from the vertical."""
    hangs = -2.0 / 7.25**2
    model = TRUTH.with_effects(("viscous", "constant_torque")).with_values({**TRUTH.values, "constant_torque": -2.0})  # fmt: skip
    noise = 1e-4 * np.random.default_rng(4).standard_normal(TIMES.size)
    (angle,) = swings(TIMES, simulate(model, TIMES, hangs + 0.3) + noise)
    label = "viscous+constant_torque"
    found = fit_recording(angle, [label])
    assert float(found["largest_angle"].sel(fitted=label)) == pytest.approx(0.3, abs=2e-3)
