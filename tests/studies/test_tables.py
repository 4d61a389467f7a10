"""Table 3, the paired comparison and the parameters, from norms whose answers are known."""

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from scipy import stats

from swingdown.pendulum.model import PAPER_MODELS, Model
from swingdown.sealed import write_csv
from swingdown.studies import norms
from swingdown.studies import paper_tables as tables
from swingdown.studies.comparison import comparison, holm
from swingdown.studies.parameters import parameter_budget, parameters

SAMPLES = 3000


def made_norms(means, count=12, campaign="bench", inflation=1.0, noise=0.002, seed=1, negative=()):
    """A norms dataset: every model's norm (degrees) as given, with scatter that runs share and a little of its own."""
    rng = np.random.default_rng(seed)
    shared = 0.01 * rng.standard_normal(count)
    coords = norms.model_coords(means)
    names = coords["parameter"][1]
    norm = np.array([mean + shared + noise * rng.standard_normal(count) for mean in means.values()])
    own = np.array([[name in Model(label).parameters for name in names] for label in means])
    size = own.sum(axis=1)[:, np.newaxis] + 2
    value = np.where(own, [-1.0 if name in negative else 1.0 for name in names], np.nan)
    value = value[:, np.newaxis] * (1 + 0.01 * rng.standard_normal(count))[:, np.newaxis]
    by = ("fitted", "recording")
    variables = {
        "norm": (by, norm),
        "bic": (by, SAMPLES * np.log(np.radians(norm) ** 2) + size * np.log(SAMPLES)),
        "reduced_chi2": (by, (norm / 0.1) ** 2),
        "variance_inflation": (by, np.full(norm.shape, inflation)),
        "value": ((*by, "parameter"), value),
        "standard_error": ((*by, "parameter"), np.full(value.shape, 0.001)),
        "random_standard_error": ((*by, "parameter"), np.full(value.shape, 0.0006)),
        "systematic_standard_error": ((*by, "parameter"), np.full(value.shape, 0.0008)),
        "error_bound_norm": ("recording", 0.09 + 0.001 * rng.standard_normal(count)),
        "samples": ("recording", np.full(count, SAMPLES)),
    }
    texts = {"campaign": campaign, "emulated": "yes" if campaign == "bench" else "no", "uncertainty": "gum"}
    coords |= {key: ("recording", [text] * count) for key, text in texts.items()}
    coords["recording"] = ("recording", [f"{campaign}_{k}" for k in range(count)])
    return norms.labelled(xr.Dataset(variables, coords))


THREE = {"viscous": 0.8, "viscous+load_coulomb": 0.132, "quadratic_drag+load_coulomb": 0.131}


@pytest.fixture(scope="module")
def published(root):
    return pd.read_csv(root / "resources/paper/table3.csv")


def test_table_3_has_error_bounds_first_and_the_papers_numbers_beside(published):
    both = xr.concat([made_norms(THREE), made_norms(THREE, 3, "mine")], "recording")
    table = tables.table3(both, published)
    assert list(table["fitted"]) == ["error_bounds", *THREE] * 2
    bench = table[table["campaign"] == "bench"].set_index("fitted")
    one = both["norm"].sel(fitted="viscous").values[:12]
    assert bench.loc["viscous", "mean"] == pytest.approx(np.mean(one))
    assert bench.loc["viscous", "std"] == pytest.approx(np.std(one, ddof=1))
    assert bench.loc["viscous", "published_mean"] == 0.82469
    assert bench.loc["error_bounds", "published_mean"] == 0.09418
    assert bench.loc["viscous", "reduced_chi2"] == pytest.approx(np.mean((one / 0.1) ** 2))
    assert bench.loc["viscous", "delta_bic"] > 10 * SAMPLES
    assert np.nanmin(bench["delta_bic"]) == 0
    assert list(table.groupby("campaign")["n"].unique().str[0]) == [12, 3]
    assert bench["note"].str.contains("emulated").all()
    assert not table[table["campaign"] == "mine"]["note"].str.contains("emulated").any()
    assert table["note"].str.contains("apparatus, not this").all()


def test_a_negative_coefficient_is_told(published):
    table = tables.table3(made_norms(THREE, negative=("load_friction",)), published).set_index("fitted")
    assert "load_friction below 0 in 12 of 12" in table.loc["viscous+load_coulomb", "note"]
    assert "below 0" not in table.loc["viscous", "note"]


def test_a_single_swing_has_no_scatter_and_still_a_table(published):
    one = made_norms(THREE, 1)
    assert tables.table3(one, published)["std"].isna().all()
    verdicts = comparison(one)["verdict"]
    assert verdicts.str.contains("one swing cannot tell").any()
    assert "(mean)" not in set(parameters(one)["recording"])


def test_paired_comparison_is_students_and_counts_the_swings():
    data = made_norms(THREE)
    table = comparison(data).set_index(["model_a", "model_b"])
    row = table.loc[("viscous+load_coulomb", "quadratic_drag+load_coulomb")]
    a, b = (data["norm"].sel(fitted=label).values for label in list(THREE)[1:])
    expected = stats.ttest_rel(a, b)
    assert (row["t"], row["p"]) == pytest.approx((expected.statistic, expected.pvalue))
    assert row["wilcoxon_p"] == pytest.approx(stats.wilcoxon(a, b).pvalue)
    assert row["n"] == 12
    # far below the scatter of the norms themselves (0.01 degrees), which the pairs share
    assert row["standard_error"] < 0.0015


def test_indistinguishable_models_are_called_so():
    data = made_norms(THREE)
    scatter = np.tile([1.0, -1.0], 6) * 0.0012 * np.sqrt(11)  # standard error of the mean of twelve: 0.0012
    data["norm"].loc[{"fitted": "viscous+load_coulomb"}] = (
        data["norm"].sel(fitted="quadratic_drag+load_coulomb") + 0.001 + scatter
    )
    verdict = comparison(data)["verdict"].iloc[-1]
    assert (
        verdict
        == "κv,c and κq,c are indistinguishable: mean paired difference 0.0010 ± 0.0012 degrees over 12 swings"
    )
    data["norm"].loc[{"fitted": "viscous+load_coulomb"}] += 0.0019  # 2.4 standard errors apart: p = 0.035
    assert comparison(data)["verdict"].iloc[-1].startswith("κq,c is closer to the data than κv,c: ")
    apart = made_norms(THREE | {"viscous+load_coulomb": 0.135})
    verdict = comparison(apart)["verdict"].iloc[-1]
    assert verdict.startswith("κq,c is closer to the data than κv,c: mean paired difference 0.0")


@pytest.mark.parametrize(
    ("gain", "inflation", "told"),
    [
        (0.00000, 1, "does not earn its parameter"),
        (0.00200, 1, "the added term earns its parameter"),
        (0.00200, 300, "does not earn its parameter"),  # the same gain, of residuals that hang together
        (0.00200, 17, "the data do not say whether the added term earns its parameter"),
    ],
)
def test_a_larger_model_must_earn_its_parameter(gain, inflation, told):
    """Its norm is lower whatever happens, so neither the norm nor its t is asked."""
    nested = {"load_coulomb": 0.131, "viscous+load_coulomb": 0.131 - gain}
    row = comparison(made_norms(nested, inflation=inflation, noise=1e-7)).iloc[0]
    assert told in row["verdict"], (row["verdict"], row["delta_bic_effective"])
    assert row["verdict"].startswith("κv,c against κc: ")


def test_table_3_ranks_by_independent_samples_too(published):
    """A gain that counts every sample, and none once residuals that hang together are counted once."""
    nested = {"load_coulomb": 0.131, "viscous+load_coulomb": 0.129}
    table = tables.table3(made_norms(nested, inflation=300, noise=1e-7), published).set_index("fitted")
    assert table.loc["viscous+load_coulomb", "delta_bic"] == 0
    assert table.loc["load_coulomb", "delta_bic"] > 100
    assert table.loc["load_coulomb", "delta_bic_effective"] == 0
    # 12 swings, each with ln 10 for a parameter and 2 x 10 x ln of the norms' ratio against it
    gain = 2 * 10 * np.log(0.131 / 0.129)
    assert table.loc["viscous+load_coulomb", "delta_bic_effective"] == pytest.approx(
        12 * (np.log(10) - gain), rel=0.05
    )
    gained = comparison(made_norms(nested, inflation=300, noise=1e-7))["delta_bic_effective"].iloc[0]
    assert table.loc["viscous+load_coulomb", "delta_bic_effective"] == pytest.approx(-gained)


def test_holms_correction_on_a_worked_case():
    """p = .01, .04, .03, .005 of four tests: .03, .06, .06, .02 (Holm 1979)."""
    assert holm(np.array([0.01, 0.04, np.nan, 0.03, 0.005])) == pytest.approx(
        [0.03, 0.06, np.nan, 0.06, 0.02], nan_ok=True
    )


def test_parameters_have_units_and_a_row_for_each_value():
    data = made_norms(THREE, 3)
    joint = data.isel(recording=0, drop=True).assign_attrs(campaign="bench")
    table = parameters(data, [joint])
    assert len(table) == (2 + 3 + 3) * 5  # three recordings, their mean, the joint fit
    row = table[(table["recording"] == "bench_0") & (table["fitted"] == "viscous")].iloc[0]
    assert (row["parameter"], row["unit"]) == ("natural_frequency", "rad/s")
    assert row["text"].endswith("(10)")
    assert (row["low"], row["high"]) == pytest.approx(
        (row["value"] - 0.00196, row["value"] + 0.00196), abs=1e-5
    )
    mean = table[(table["recording"] == "(mean)") & (table["fitted"] == "viscous")].iloc[0]
    values = data["value"].sel(fitted="viscous", parameter="natural_frequency").values
    assert mean["random_standard_error"] == pytest.approx(np.std(values, ddof=1) / np.sqrt(3))
    assert mean["systematic_standard_error"] == pytest.approx(
        0.0008
    )  # the same in all recordings: no mean takes it away
    assert mean["standard_error"] == pytest.approx(np.hypot(mean["random_standard_error"], 0.0008))
    assert (
        mean["high"] - mean["value"] > 1.96 * mean["standard_error"]
    )  # three recordings tell their scatter badly
    assert set(table["recording"]) == {"bench_0", "bench_1", "bench_2", "(mean)", "(joint)"}


def test_a_table_on_disk_is_whole_and_at_full_precision(tmp_path):
    table = tables.table3(
        made_norms(dict.fromkeys(PAPER_MODELS, 0.1)),
        pd.DataFrame({"fitted": [], "mean_degrees": [], "std_degrees": []}),
    )
    back = pd.read_csv(write_csv(table, tmp_path / "deep" / "table3.csv"))
    assert list(back["mean"]) == list(table["mean"])
    assert sorted(path.name for path in (tmp_path / "deep").iterdir()) == [".table3.csv.sha256", "table3.csv"]


def test_the_papers_printed_numbers_are_all_there(root, published):
    """Against slips of the pen: sums over what the paper prints."""
    table2 = pd.read_csv(root / "resources/paper/table2.csv")
    assert len(table2) == 12
    assert table2["mean_degrees"].sum() == pytest.approx(5.21)
    assert table2["std_degrees"].sum() == pytest.approx(0.74)
    assert len(published) == 8
    assert published["mean_degrees"].sum() == pytest.approx(3.19857)
    assert published["std_degrees"].sum() == pytest.approx(0.17184)


@pytest.mark.parametrize("joint", [True, False])
def test_the_budget_of_a_value_has_its_sources_and_their_shares_of_the_variance(joint):
    by = ("fitted", "parameter")
    fits = xr.Dataset(
        {
            "standard_error": (by, [[0.05, 0.02]]),
            "random_standard_error": (by, [[0.03, 0.02]]),
            "systematic": ((*by, "source"), [[[0.04, 0.001], [0.0, 0.0]]]),
        },
        {"fitted": ["viscous"], "parameter": ["a", "b"], "source": ["arm", "bob"], "parameter_unit": ("parameter", ["1", "rad"])},
    )  # fmt: skip
    told = fits.assign_attrs(campaign="bench") if joint else fits.assign_coords(campaign="bench")
    budget = parameter_budget([told])
    assert set(budget["campaign"]) == {"bench"} and set(budget["fitted"]) == {"viscous"}
    rows = budget[["parameter", "source", "contribution", "unit"]].to_numpy().tolist()
    assert rows == [["a", "random", 0.03, "1"], ["a", "arm", 0.04, "1"], ["b", "random", 0.02, "rad"]]
    np.testing.assert_allclose(budget["share"], [0.36, 0.64, 1.0])
