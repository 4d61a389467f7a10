"""Fits of all models to swings whose truth is known, one by one and together."""

import numpy as np
import pytest
import xarray as xr

from swingdown import dataset
from swingdown.engine.trajectory import simulate
from swingdown.errors import InputError
from swingdown.pendulum.model import PAPER_MODELS, Model
from swingdown.studies import norms
from swingdown.studies.experiment import fit_campaign, fit_recording

NOISE = 2e-4  # rad
TRUTH = {"natural_frequency": 7.25, "quadratic_coefficient": 0.0012, "load_friction": 0.0018}
TRUE_MODEL = "quadratic_drag+load_coulomb"


def swing(number, truth=TRUTH, duration=20.0, rate=50, campaign="bench"):
    """An angle dataset of a swing that starts a little after its release, with white noise."""
    rng = np.random.default_rng([2017, number])
    times = np.arange(round(duration * rate)) / rate
    release = 0.35 + 0.05 * number
    clean = simulate(Model(TRUE_MODEL, truth), times, release * np.cos(0.02), -release * 7.25 * np.sin(0.02))
    angle = clean + NOISE * rng.standard_normal(times.size)
    return xr.Dataset(
        {
            "angle": ("time", angle),
            "angle_random_uncertainty": ("time", np.full(times.size, NOISE)),
            "angle_bound": ("time", np.full(times.size, 1e-3)),
        },
        {"time": times},
        {"recording": f"swing_{number}", "campaign": campaign, "emulated": "yes", "mode": "gum"},
    )


@pytest.fixture(scope="module")
def angles():
    return [swing(number) for number in range(4)]


@pytest.fixture(scope="module")
def fits(angles):
    return [fit_recording(angle, PAPER_MODELS) for angle in angles]


@pytest.fixture(scope="module")
def joint(angles):
    return fit_campaign(angles, PAPER_MODELS)


def test_the_truth_is_found_within_its_standard_errors(fits):
    for fit in fits:
        found = fit.sel(fitted=TRUE_MODEL)
        for name, true in TRUTH.items():
            one = found.sel(parameter=name)
            assert abs(float(one["value"]) - true) < 4 * float(one["standard_error"])
        assert np.isnan(found["value"].sel(parameter="viscous_ratio"))
        assert float(found["norm"]) == pytest.approx(np.degrees(NOISE), rel=0.1)
        assert float(found["reduced_chi2"]) == pytest.approx(1, abs=0.15)
        assert float(found["variance_inflation"]) < 2
        assert float(fit["error_bound_norm"]) == pytest.approx(np.degrees(1e-3))


def test_a_wrong_model_is_told_by_chi2_and_by_residuals_that_hang_together(fits):
    wrong = fits[0].sel(fitted="viscous")
    assert float(wrong["reduced_chi2"]) > 10
    assert float(wrong["variance_inflation"]) > 10
    right = fits[0].sel(fitted=TRUE_MODEL)
    errors = (wrong["standard_error"] / right["standard_error"]).dropna("parameter")
    assert (errors > 2).all()


def assert_nested(norm):
    """Adding a term never raises a run's own norm (the paper's Table 3 violates this)."""
    for small in PAPER_MODELS:
        for large in PAPER_MODELS:
            if set(small.split("+")) < set(large.split("+")):
                assert (norm.sel(fitted=large) <= norm.sel(fitted=small) * (1 + 1e-9)).all(), (small, large)


def test_adding_a_term_never_raises_a_runs_own_norm(fits, joint):
    assert_nested(norms.combine_recordings(fits)["norm"])
    total = (joint["norm"] ** 2 * joint["samples"]).sum("recording")
    assert_nested(total)


def test_a_larger_model_starts_from_its_sub_models(angles, monkeypatch):
    """Held apart from luck: without the own starts, the sub-models' optima must be where a fit begins."""
    from swingdown.studies import experiment

    begun = {}

    def spy(model, swings, guess=None, **options):
        fit = real(model, swings, guess=guess, **options)
        begun[model.label] = {one.model.label for one in guess or ()}
        return fit

    real = experiment.fit_jointly
    monkeypatch.setattr(experiment, "fit_jointly", spy)
    fit_recording(angles[0], PAPER_MODELS[::-1])  # in whatever order they are asked for
    assert begun["viscous+load_coulomb"] == {"viscous", "load_coulomb"}
    assert begun["viscous+quadratic_drag+load_coulomb"] == set(PAPER_MODELS[:-1])


def test_a_joint_fit_shares_parameters_and_gives_each_swing_its_release(joint, fits, angles):
    found = joint.sel(fitted=TRUE_MODEL)
    for name, true in TRUTH.items():
        one = found.sel(parameter=name)
        assert abs(float(one["value"]) - true) < 4 * float(one["standard_error"])
        alone = [float(fit["standard_error"].sel(fitted=TRUE_MODEL, parameter=name)) for fit in fits]
        assert float(one["standard_error"]) < min(alone)
    released = [0.35 + 0.05 * number for number in range(4)]
    assert found["release_angle"].values == pytest.approx(np.array(released) * np.cos(0.02), abs=1e-4)
    assert np.degrees(found["rms"].values) == pytest.approx(found["norm"].values)
    assert float(found["reduced_chi2"]) == pytest.approx(1, abs=0.1)


def test_correlations_are_a_matrix_over_the_models_own_parameters(fits):
    found = fits[0].sel(fitted=TRUE_MODEL)
    matrix = found["correlation"]
    own = ["natural_frequency", "quadratic_coefficient", "load_friction"]
    inside = matrix.sel(parameter=own, parameter_2=own).values
    assert np.allclose(inside, inside.T)
    assert np.allclose(np.diag(inside), 1)
    assert inside[1, 2] < -0.8  # quadratic drag and load friction answer for one another
    assert np.isnan(matrix.sel(parameter="viscous_ratio")).all()
    assert float(found["condition_number"]) > 10


def test_everything_is_kept_with_units_on_disk(fits, joint, tmp_path):
    for name, data in {"fit": fits[0], "norms": norms.combine_recordings(fits), "joint": joint}.items():
        back = dataset.read(dataset.write(data, tmp_path / f"{name}.nc"))
        assert back.attrs["emulated"] == "yes"
        assert back["value"].attrs["units"] == "1" and "parameter_unit" in back["value"].attrs["comment"]
        assert list(back["parameter_unit"].values) == ["rad/s", "1", "s", "1"]
    table = norms.combine_recordings(fits)
    assert {"fitted", "recording", "parameter"} <= set(table.sizes)
    assert "time" not in table.sizes
    assert list(table["campaign"].values) == ["bench"] * 4
    assert fits[0]["residual"].dims == ("fitted", "time")
    again = norms.combine_recordings([dataset.read(tmp_path / "fit.nc"), *fits[1:]])
    xr.testing.assert_allclose(again["norm"], table["norm"])


def test_a_value_names_its_standard_errors_for_readers_of_cf(fits):
    named = fits[0]["value"].attrs["ancillary_variables"].split()
    assert "standard_error" in named and set(named) <= set(fits[0].variables)
    assert "ancillary_variables" not in fits[0]["norm"].attrs


def test_norms_of_angles_and_of_rates_side_by_side_say_which_is_in_what(fits):
    alike = norms.combine_recordings(fits)
    assert alike["norm"].attrs["units"] == "degrees" and "comment" not in alike["norm"].attrs
    rate = fits[1].copy()
    rate["norm"] = rate["norm"].assign_attrs(units="degrees/s", long_name="of rates")
    mixed = norms.combine_recordings([fits[0], rate])
    assert mixed["norm"].attrs["units"] == "degrees"
    assert "degrees/s of recordings whose reading is rate" in mixed["norm"].attrs["comment"]


def test_a_fitted_zero_of_angles_beside_one_of_rates_has_a_unit(fits):
    one, rate = (data.assign(zero=0.0 * data["norm"]) for data in fits[:2])
    for data, unit in ((one, "rad"), (rate, "rad/s")):
        data["zero"].attrs = {"units": unit, "long_name": f"at rest, in {unit}"}
    mixed = norms.combine_recordings([one, rate])
    assert mixed["zero"].attrs["units"] == "rad"
    assert mixed["zero"].attrs["comment"] == "rad/s of recordings whose reading is rate"


def test_too_few_swings_are_refused(angles, fits):
    short = angles[0].isel(time=slice(0, 60))  # 1.2 s of a period of 0.87 s
    with pytest.raises(InputError, match=r"swing_0: too few swings to fit.*widen start_s"):
        fit_recording(short, ["viscous"])
    with pytest.raises(InputError, match="there is no swing to fit"):
        fit_campaign([], ["viscous"])
    with pytest.raises(InputError, match="there is no swing to fit"):
        norms.combine_recordings([])
    with pytest.raises(InputError, match="twice"):
        norms.combine_recordings([fits[0], fits[0]])


def test_an_unknown_uncertainty_gives_no_chi2_rather_than_a_wrong_one(angles):
    bare = angles[0].drop_vars(["angle_random_uncertainty", "angle_bound"])
    fit = fit_recording(bare, ["viscous"])
    assert np.isnan(fit["reduced_chi2"]).all()
    assert np.isnan(fit["error_bound_norm"])


def test_a_swing_about_another_middle_is_no_short_one(angles):
    """Readings may lie anywhere: what counts as passed is their own middle."""
    angle = angles[0].isel(time=slice(300)).assign(angle=angles[0]["angle"].isel(time=slice(300)) + 0.8)
    fit = fit_recording(angle, [f"{TRUE_MODEL}+sensor_zero"])
    found = fit.sel(fitted=f"{TRUE_MODEL}+sensor_zero")
    assert float(found["value"].sel(parameter="sensor_zero")) == pytest.approx(0.8, abs=1e-4)


def test_fits_know_how_long_each_recording_lasts(fits, joint):
    assert all(float(one["record_s"]) == pytest.approx(19.98) for one in fits)
    assert joint["record_s"].values == pytest.approx([19.98] * 4)
    later = swing(0).assign_coords(time=swing(0)["time"] + 5.0)
    alone, both = fit_recording(later, ["viscous"]), fit_campaign([later, swing(1)], ["viscous"])
    assert float(alone["record_s"]) == pytest.approx(19.98)
    assert both["record_s"].values == pytest.approx([19.98] * 2)


def test_a_swing_is_seen_to_narrow(fits):
    """Of a swing that dies: its turning points shrink, which a measured drive's need not."""
    assert all(0 < float(one["narrowing"]) < 1 for one in fits)


def test_fit_and_residual_are_the_recording(angles, fits):
    for angle, fit in zip(angles, fits, strict=True):
        for label in (TRUE_MODEL, "viscous"):
            one = fit.sel(fitted=label)
            assert (one["fit"] + one["residual"]).values == pytest.approx(angle["angle"].values)
            left = np.sqrt(np.mean(one["residual"].values ** 2))
            assert float(one["norm"]) == pytest.approx(np.degrees(left), rel=1e-6)
