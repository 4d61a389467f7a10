"""The simulation study against the paper's seed run through real R, and what its settings change."""

import numpy as np
import pandas as pd
import pytest
import yaml

from swingdown import dataset
from swingdown.errors import InputError
from swingdown.pendulum.model import PAPER_MODELS
from swingdown.studies import norms, simulation
from swingdown.studies import paper_tables as tables

# mean and std of ten norms (degrees) with seed 150 and the optim() of R 4.2.2, computed outside this project
REAL_R = {
    ("viscous", "viscous"): (0.093, 0.074),
    ("viscous", "quadratic_drag"): (0.467, 0.056),
    ("viscous", "load_coulomb"): (0.512, 0.087),
    ("viscous", "quadratic_drag+load_coulomb"): (0.091, 0.056),
    ("quadratic_drag", "viscous"): (0.544, 0.074),
    ("quadratic_drag", "quadratic_drag"): (0.073, 0.046),
    ("quadratic_drag", "load_coulomb"): (1.225, 0.112),
    ("quadratic_drag", "viscous+load_coulomb"): (0.119, 0.030),
    ("load_coulomb", "viscous"): (0.710, 0.061),
    ("load_coulomb", "quadratic_drag"): (1.171, 0.042),
    ("load_coulomb", "load_coulomb"): (0.126, 0.070),
    ("load_coulomb", "viscous+quadratic_drag"): (0.169, 0.033),
}


@pytest.fixture(scope="module")
def settings(root):
    """The shipped study's simulation settings."""
    config = yaml.safe_load((root / "config/config.yaml").read_text())
    chosen = {key: value for key, value in config["simulation"].items() if key not in ("fitted", "start")}
    return chosen | {"seed": config["seed"]} | config["model"]


def realizations(settings):
    chosen = dict(settings)
    return simulation.realizations(chosen.pop("simulated"), chosen.pop("realizations"), chosen)


@pytest.fixture(scope="module")
def study(settings):
    drawn = realizations(settings)
    parts = [simulation.simulation_norms(drawn, label, PAPER_MODELS) for label in settings["simulated"]]
    return norms.combine_simulated(parts)


@pytest.fixture(scope="module")
def published(root):
    return pd.read_csv(root / "resources/paper/table2.csv")


@pytest.mark.parametrize("method", ["", "_least_squares"])
def test_table_2_is_that_of_real_r_with_the_papers_seed(study, published, method):
    table = tables.table2(study, published).set_index(["simulated", "fitted"])
    assert list(table.index) == list(REAL_R)  # the order of the paper
    for cell, (mean, std) in REAL_R.items():
        assert table.loc[cell, f"mean{method}"] == pytest.approx(mean, abs=0.002), cell
        assert table.loc[cell, f"std{method}"] == pytest.approx(std, abs=0.002), cell


def test_table_2_is_near_the_printed_one_and_says_what_was_inferred(study, published):
    table = tables.table2(study, published)
    away = (table["mean"] - table["published_mean"]) / table["published_std"]
    assert np.abs(away).max() < 1.1
    for told in (
        "inferred",
        "quadratic_coefficient",
        "load_friction",
        "release_angle_deg",
        "duration_s",
        "no independent",
    ):
        assert table["note"].str.contains(told).all()
    assert not table["note"].str.contains("Other settings").any()
    assert np.allclose(table["standard_error_of_std"], table["std"] / np.sqrt(18))
    assert (table["n"] == 10).all()


def test_simplex_and_least_squares_end_at_the_same_optimum(study):
    """To 1e-6 of the residual norm: the simplex stops there, well below what a table shows."""
    both = study["residual_norm"] / study["least_squares_residual_norm"] - 1
    assert np.abs(both).max() < 1e-6
    assert study["converged"].all()
    assert study["least_squares_converged"].all()


def test_coefficients_are_free_to_be_negative(study):
    """Bounds at 0 contradict the published table (.12 and .18 of the pairs)."""
    pair = study["value"].sel(
        simulated="quadratic_drag", fitted="viscous+load_coulomb", parameter="load_friction"
    )
    assert (pair < 0).all()


@pytest.mark.parametrize("prefix", ["", "least_squares_"])
def test_a_model_with_more_terms_is_never_further_from_the_data(study, prefix):
    assert_nested(study[f"{prefix}residual_norm"])


def assert_nested(norm):
    for small in PAPER_MODELS:
        for large in PAPER_MODELS:
            if set(small.split("+")) < set(large.split("+")):
                assert (norm.sel(fitted=large) <= norm.sel(fitted=small) * (1 + 1e-9)).all(), (small, large)


def test_first_noisy_samples_are_those_of_r(settings):
    """R: set.seed(150); rnorm(3) is -1.6323, -0.0630, -0.7054; the eleventh swing goes on where the tenth ended."""
    drawn = realizations(settings)
    draws = (drawn["noisy"] / drawn["truth"] - 1) * 50 * np.sign(drawn["truth"])
    assert draws.sel(simulated="viscous", realization=1).values[:3] == pytest.approx(
        [-1.63231, -0.0629963, -0.705447], abs=1e-5
    )
    # rnorm(15030)[c(5011, 15030)] in R 4.2.2
    assert draws.sel(simulated="quadratic_drag", realization=1).values[0] == pytest.approx(
        -1.9695495053065306, abs=1e-9
    )
    assert draws.sel(simulated="load_coulomb", realization=10).values[-1] == pytest.approx(
        -1.1825440957724649, abs=1e-9
    )
    assert drawn.sizes == {"simulated": 3, "realization": 10, "time": 501}


def test_numpy_stream_gives_each_realisation_by_its_index(settings):
    few = realizations(settings | {"stream": "numpy", "realizations": 2, "simulated": ["load_coulomb"]})
    many = realizations(settings | {"stream": "numpy", "realizations": 4})
    same = many.sel(simulated=["load_coulomb"], realization=[1, 2])
    assert np.array_equal(few["noisy"], same["noisy"])
    assert not np.array_equal(few["noisy"], realizations(settings)["noisy"].sel(same.coords))


def test_settings_are_kept_and_other_ones_are_told_in_the_table(settings, published, tmp_path):
    changed = settings | {
        "snr": 20,
        "realizations": 3,
        "simulated": ["viscous"],
        "stream": "numpy",
        "noise": "additive",
    }
    drawn = dataset.read(dataset.write(realizations(changed), tmp_path / "realizations.nc"))
    part = simulation.simulation_norms(drawn, "viscous", ["viscous"], start="free")
    kept = dataset.read(dataset.write(norms.combine_simulated([part]), tmp_path / "norms.nc"))
    table = tables.table2(kept, published)
    assert len(table) == 1
    for told in ("snr 20", "stream numpy", "noise additive", "start free", "3 realisations"):
        assert told in table["note"][0]
    assert kept["norm"].attrs["units"] == "degrees"
    assert list(kept["parameter_unit"].values) == ["rad/s", "1"]


@pytest.mark.parametrize(
    ("key", "value"), [("stream", "fortran"), ("noise", "pink"), ("snr", 0), ("realizations", 0)]
)
def test_unusable_settings_are_refused_by_name(settings, key, value):
    with pytest.raises(InputError, match=f"simulation.{key}"):
        realizations(settings | {key: value})


def test_parts_that_do_not_fit_together_are_refused(settings):
    drawn = realizations(settings | {"realizations": 1})
    with pytest.raises(InputError, match="not simulated"):
        simulation.simulation_norms(drawn, "constant_coulomb", ["viscous"])
    parts = [
        simulation.simulation_norms(drawn, "viscous", [label]) for label in ("viscous", "quadratic_drag")
    ]
    with pytest.raises(InputError, match="different models"):
        norms.combine_simulated(parts)
