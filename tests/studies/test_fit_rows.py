"""What a dataset of fits keeps of each."""

import numpy as np
import pytest

from swingdown.answer.given import swings
from swingdown.engine.trajectory import TrajectoryError, simulate
from swingdown.fitting.least_squares import fit_trajectory
from swingdown.fitting.slack import allowing
from swingdown.fitting.uncertainty import uncertainty
from swingdown.pendulum.model import Model
from swingdown.pendulum.slack import reading_slack
from swingdown.studies.experiment import fit_recording
from swingdown.studies.fit_rows import options_of, row_of_fit, rows_of

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


def test_a_row_keeps_what_the_fit_and_its_uncertainty_say():
    """Of a sensor whose gain and zero the calibration leaves open; names that the model has not are nan."""
    slack = reading_slack({"sensor_gain": {"length": 1e-3}, "sensor_zero": {"volt": 1e-3}}, clock=1e-4)
    reading = simulate(TRUTH, TIMES, 0.3) + 1e-3 * np.random.default_rng(4).standard_normal(TIMES.size)
    own = [(TIMES, reading)]
    fit = allowing(fit_trajectory(TRUTH, *own[0], guess=TRUTH), own, slack)
    (angle,) = swings(*own[0])
    names = ["natural_frequency", "load_friction", "viscous_ratio"]
    row, known = row_of_fit(fit, own, [angle], names), uncertainty(fit, own, free=True)
    assert known.courses
    at = [fit.free.index(name) for name in (names[0], names[2])]
    whole = np.diag(known.random) + np.sum(known.systematic**2, axis=1)
    for key, right in {
        "value": fit.values,
        "standard_error": np.sqrt(whole),
        "random_standard_error": np.sqrt(np.diag(known.random)),
        "systematic_standard_error": np.sqrt(np.sum(known.systematic**2, axis=1)),
        "coverage_factor": known.factors,
    }.items():
        assert row[key][[0, 2]] == pytest.approx(right[at]) and np.isnan(row[key][1]), key
    assert (
        row["systematic"][[0, 2]] == pytest.approx(known.systematic[at])
        and np.isnan(row["systematic"][1]).all()
    )
    zero = fit.free.index("sensor_zero")
    assert (row["zero"], row["zero_u"]) == pytest.approx((fit.values[zero], np.sqrt(whole[zero])))
    assert (
        dict(zip(fit.model.slack.parameters, row["nuisance_value"], strict=True))["sensor_zero"]
        == row["zero"]
    )
    shared = known.covariance[at[0], at[1]]
    assert row["covariance"][0, 2] == pytest.approx(shared)
    assert row["correlation"][0, 2] == pytest.approx(shared / np.sqrt(whole[at[0]] * whole[at[1]]))
    sizes = np.linalg.eigvalsh(known.covariance / np.sqrt(np.outer(whole, whole)))
    assert row["condition_number"] == pytest.approx(sizes[-1] / sizes[0], rel=1e-6)
    assert row["evidence_norm"] == pytest.approx(np.degrees(fit.rms * np.sqrt(known.courses.left)))
    assert row["variance_inflation"] == max(1.0, known.inflation)
    assert row["evidence_inflation"] == max(1.0, known.courses.inflation)
    assert row["largest_angle"] == pytest.approx([0.3 * np.exp(known.courses.begins[0])], rel=0.01)
    plain = row_of_fit(fit_trajectory(TRUTH, *own[0]), own, [angle], names)
    assert np.isnan([plain["zero"], plain["zero_u"]]).all()


def test_fits_say_that_no_bound_was_set():
    assert options_of([TRUTH], "free") == {
        "start": "free",
        "restoring": "sine",
        "form": TRUTH.form,
        "bounded": 0,
    }
