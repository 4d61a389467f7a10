"""The sections' tables, cell by cell: what a reader sees of a number is as many digits as it has, and its unit."""

import subprocess
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
import yaml

from swingdown.report import provenance
from swingdown.report.page import Listing, Table, Text
from swingdown.report.sections import (
    apparatus,
    experiment,
    missing,
    origin,
    own,
    series,
    settings,
    simulation,
)


def material(own=False, emulated=(), **tables):
    """What the sections read, without a figure."""
    whole = {"simulation": {"realizations": 10, "snr": 50.0}, "seed": 7, "sweeps": {}, "calibration": {}, "recordings": "r.csv"}  # fmt: skip
    rows = [{"recording": "a", "file": "a.csv", "sha256": "0" * 64, "campaign": "bench"}]
    return SimpleNamespace(
        tables=tables, own=own, emulated=list(emulated), shown=lambda *_: [], settings=whole, inputs=[], recordings=rows, figures={},
        verdicts=[], seen=[],
    )  # fmt: skip


def cells(table):
    return [[str(cell) for cell in row] for row in table.rows]


def heads(table):
    return [(column.head, column.unit) for column in table.columns]


TABLE3 = {
    "campaign": ["bench", "bench"], "fitted": ["viscous", "error_bounds"], "mean": [0.13149, 0.2], "std": [0.0104, 0.02],
    "reduced_chi2": [1.2345, np.nan], "delta_bic_effective": [1234.4, np.nan], "variance_inflation": [3.6, np.nan], "n": [10, 10],
    "published_mean": [0.3, np.nan], "published_std": [0.1, np.nan], "note": ["load friction below 0 in 2 of 10; slow", ""],
}  # fmt: skip


def test_table_3_has_the_papers_column_only_in_the_papers_study():
    table = experiment.table3(pd.DataFrame(TABLE3), material(emulated=["bench"]))
    assert cells(table) == [
        ["κ<sub>v</sub>", "0.131 ± 0.010", "1.23", "1234", "4", "10", "0.30 ± 0.10"],
        ["error bounds", "0.200 ± 0.020", "–", "–", "–", "10", "–"],
    ]
    assert heads(table)[1] == ("norm", "degrees") and table.label == "Table 3" and table.of == ("bench",)
    told = " ".join(map(str, table.notes))
    assert "load friction below 0 in 2 of 10" in told and "slow" not in told
    assert "its pendulum is another" in told and "Emulated: bench." in told
    own = experiment.table3(pd.DataFrame(TABLE3), material(own=True))
    assert [row[:-1] for row in cells(table)] == cells(own) and own.label == "Models of damping"
    assert "another" not in " ".join(map(str, own.notes)) and "Emulated" not in " ".join(map(str, own.notes))


def test_several_campaigns_have_a_column_and_a_group_each():
    both = pd.concat([pd.DataFrame(TABLE3), pd.DataFrame(TABLE3 | {"campaign": "other"})])
    table = experiment.table3(both, material())
    assert [row[0] for row in cells(table)] == ["bench", "bench", "other", "other"]
    assert table.groups == (2,) and table.of == ("bench", "other")


def test_a_paired_comparison_tells_the_difference_with_its_error():
    pairs = pd.DataFrame({
        "campaign": ["bench"], "model_a": ["viscous"], "model_b": ["viscous+quadratic_drag"], "mean_difference": [0.01234],
        "standard_error": [0.00056], "p_holm": [0.0321], "delta_bic_effective": [-3.6], "verdict": ["κv,q is closer"],
    })  # fmt: skip
    table = experiment.paired(pairs)
    assert cells(table) == [
        [
            "κ<sub>v</sub>\u00a0−\u00a0κ<sub>v,q</sub>",
            "0.01234(56)",
            "0.032",
            "−4",
            "κ<sub>v,q</sub> is closer",
        ]
    ]


@pytest.mark.parametrize(("recordings", "compared"), [(1, False), (2, True)])
def test_models_are_compared_in_pairs_where_a_campaign_has_two_recordings(recordings, compared):
    pairs = pd.DataFrame({
        "campaign": ["bench"], "model_a": ["viscous"], "model_b": ["viscous+quadratic_drag"], "mean_difference": [0.01234],
        "standard_error": [0.00056], "p_holm": [0.0321], "delta_bic_effective": [-3.6], "verdict": ["κv,q is closer"],
    })  # fmt: skip
    given = material(own=True, table3=pd.DataFrame(TABLE3 | {"n": [recordings] * 2}), comparison=pairs)
    found = own.damping(given)
    assert (
        any(
            "−\u00a0κ<sub>v,q</sub>" in str(row[0])
            for item in found.items
            for row in getattr(item, "rows", ())
        )
        == compared
    )


def parameters(*rows):
    keys = ("recording", "value", "standard_error")
    same = {"campaign": "bench", "fitted": "viscous", "parameter": "viscous_ratio", "unit": "1"}
    return pd.DataFrame([same | dict(zip(keys, row, strict=True)) for row in rows])


def test_parameters_tell_the_mean_the_joint_fit_and_the_scatter():
    table = experiment.fitted_parameters(parameters(
        ("a", 0.030, 0.001), ("b", 0.034, 0.003), ("(mean)", 0.032, 0.002), ("(joint)", 0.031, 0.0005),
    ))  # fmt: skip
    assert cells(table) == [["κ<sub>v</sub>", "viscous ratio", "0.0320(20)", "0.03100(50)", "1", "0.0028", "0.0020"]]  # fmt: skip
    single = experiment.fitted_parameters(parameters(("a", 0.030, 0.001)))
    assert cells(single) == [["κ<sub>v</sub>", "viscous ratio", "0.0300(10)", "1"]]
    assert heads(single)[2] == ("value", "") and len(single.notes) == len(table.notes) - 1


def test_the_budget_is_that_of_the_angle_largest_share_first():
    row = {"limit": 0.001, "divisor": 1.732, "standard_uncertainty": 0.000577, "unit": "m", "sensitivity": 2.0, "kind": "systematic"}  # fmt: skip
    budget = pd.DataFrame([
        row | {"quantity": "angle_at_20_deg", "source": "arm", "contribution": 0.003, "share": 0.36},
        row | {"quantity": "slope", "source": "arm", "contribution": 9.0, "share": 1.0},
        row | {"quantity": "angle_at_20_deg", "source": "bob_diameter", "contribution": 0.004, "share": 0.64},
    ])  # fmt: skip
    (table,) = apparatus.apparatus(material(uncertainty_budget=budget)).items
    assert cells(table) == [
        ["bob diameter", "0.00100", "1.73", "0.000577", "m", "2.00", "4.0", "64.0", "systematic"],
        ["arm", "0.00100", "1.73", "0.000577", "m", "2.00", "3.0", "36.0", "systematic"],
    ]
    assert "one angle at 20 deg (5.00 mrad)" in table.caption
    assert heads(table)[6:8] == [("contribution", "mrad"), ("share", "%")]
    assert cells(apparatus.calibration(material(uncertainty_budget=budget)).items[0]) == cells(table)


def test_table_2_stands_beside_the_paper():
    found = pd.DataFrame({
        "simulated": ["viscous", "load_coulomb"], "fitted": ["viscous", "viscous"], "mean": [0.123, 0.4], "std": [0.01, 0.1],
        "mean_least_squares": [0.122, 0.39], "std_least_squares": [0.01, 0.1], "published_mean": [0.13, np.nan],
        "published_std": [0.02, np.nan], "n": [10, 10],
    })  # fmt: skip
    (table,) = simulation.simulation(material(table2=found)).items
    assert cells(table) == [
        ["κ<sub>v</sub>", "κ<sub>v</sub>", "0.123 ± 0.010", "0.122 ± 0.010", "0.130 ± 0.020", "10"],
        ["κ<sub>c</sub>", "κ<sub>v</sub>", "0.40 ± 0.10", "0.39 ± 0.10", "–", "10"],
    ]
    assert "(10 noisy copies of each, signal to noise 50)" in table.caption and table.groups == (1,)
    assert simulation.simulation(material()) is None


@pytest.mark.parametrize("calibrated", [False, True])
def test_the_settings_of_ones_own_are_those_that_something_rests_on(calibrated):
    tables = {"uncertainty_budget": pd.DataFrame()} if calibrated else {}
    whole = material(**tables)
    lead, listing, note = settings.settings(whole).items
    assert isinstance(lead, Text) and yaml.safe_load(listing.text) == whole.settings and "inferred" in note.text.lower()  # fmt: skip
    own = settings.settings(material(own=True, **tables)).items
    (shown,) = (item for item in own if isinstance(item, Listing))
    assert set(yaml.safe_load(shown.text)) == {"seed", "recordings"} | ({"calibration"} if calibrated else set())  # fmt: skip


def test_g_of_a_few_has_its_budget_and_of_many_is_one_table():
    row = {"value": 9.8123, "standard_uncertainty": 0.0045, "unit": "m/s^2", "contribution_m_per_s2": np.nan, "note": np.nan}  # fmt: skip
    length = row | {"quantity": "length", "value": 0.583, "standard_uncertainty": 0.001, "unit": "m", "contribution_m_per_s2": 0.0035}  # fmt: skip
    fixed = row | {"quantity": "factor", "value": 1.5, "standard_uncertainty": np.nan, "unit": "1", "note": "exact"}  # fmt: skip

    def g(*names):
        budget = pd.DataFrame([one | {"recording": name} for name in names for one in (row | {"quantity": "g"}, length, fixed)])  # fmt: skip
        return next(item for item in series.series(material(g_budget=budget)).items if isinstance(item, Table))  # fmt: skip

    assert cells(g("a")) == [
        ["g", "9.8123(45)", "m/s^2", "", ""],
        ["length", "0.5830(10)", "m", "3.5", ""],
        ["factor", "1.50", "", "", "exact"],
    ]
    assert [row[0] for row in cells(g("a", "b"))] == ["a"] * 3 + ["b"] * 3
    many = g("a", "b", "c")
    assert [row[:2] for row in cells(many)] == [[name, "g"] for name in "abc"]
    assert "the table behind it has each budget" in many.caption


@pytest.mark.parametrize(
    ("figure", "changed", "told"),
    [
        ("difference", {}, False), ("difference", {"difference": {"quantity": "area"}}, True), ("remainder", {}, False),
        ("remainder", {"where": {"groups": {}, "remaining": {"time": {}}}}, True), ("remainder", {"status": "unknown"}, False), ("map", {}, False),
        ("map", {"where": {"groups": {"speed": 1}}}, True), ("ranking", {"where": {"groups": {"speed": 1}}}, True),
        ("half_swings", {}, True), ("half_swings", {"driven": True}, False), ("gap", {}, False),
        ("gap", {"gap": {"fit": [2.0, 1.0]}}, True), ("gap", {"gap": {"fit": [2.0, 1.0]}, "dies_away": False}, False),
    ],
)  # fmt: skip
def test_a_figure_is_shown_where_it_tells_something(figure, changed, told):
    found = {
        "status": "named",
        "where": {"groups": {}, "remaining": {}},
        "gap": {"fit": [1.0]},
        "difference": None,
    }
    assert missing.tells(figure, found | changed) is told


def test_an_effect_is_told_with_its_evidence_and_its_doubt():
    effect = {
        "name": "magnet", "delta_bic": -123.4, "probability": 0.987, "tied_with": ["cubic_stiffness"], "law_open": False, "doubt": "too rare",
        "parameters": {"magnet_strength": {"value": -1.23456, "standard_error": 0.056, "unit": "rad/s^2"}, "lost": {"value": None, "standard_error": None, "unit": "m"}},
    }  # fmt: skip
    found = {
        "campaign": "bench", "status": "partial", "sentence": "It is so", "next_measurement": None, "effects": [effect | {"probability": None}],
        "stand_ins": [effect], "moves": ["magnet"], "split": "fitted on two, held out one", "stopped": True, "difference": None,
        "where": {"groups": {"speed": {"share": 0.456, "chi_square": 78.9, "freedom": 12}}, "remaining": {}}, "gap": {"fit": [1.0]},
    }  # fmt: skip
    whole = material()
    whole.verdicts = [found]
    lead, added, helping, where = missing.missing(whole).items
    assert str(lead.text) == "<b>bench</b> (partial): It is so"
    assert cells(added) == [["magnet", "magnet strength", "−1.235(56)", "rad/s^2", "−123", "–", "cubic stiffness"]]  # fmt: skip
    assert cells(helping)[0][5] == "99" and "magnet: too rare" in helping.notes[0]
    assert "discovery.budget_s" in added.notes[1] and len(helping.notes) == 1
    assert cells(where) == [["speed", "46", "79", "12", "–"]]


def test_where_numbers_come_from_is_told_with_seed_versions_and_checksums(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "sheet.csv").write_bytes(b"abc")
    (tmp_path / "inside").mkdir()
    whole = material()
    whole.inputs = [tmp_path / "sheet.csv"]
    about, files = origin.origin(whole).items
    assert ["seed", "7"] in cells(about) and {"python", "numpy", "swingdown"} <= {row[0] for row in cells(about)}  # fmt: skip
    digest = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"
    assert cells(files) == [["a", "a.csv", "0" * 64], ["", "sheet.csv", digest]]
    monkeypatch.chdir(tmp_path / "inside")  # a file elsewhere is told by its name alone
    assert provenance.checksums([tmp_path / "sheet.csv"]) == [("sheet.csv", digest)]


def test_the_commit_is_told_of_a_clone_and_whether_it_was_changed(tmp_path, monkeypatch):
    clone = tmp_path / "clone"
    (clone / "inside").mkdir(parents=True)
    (clone / "file").write_text("as committed")

    def git(*words):
        settings = ("-c", "user.name=A", "-c", "user.email=a@b.c", "-c", "commit.gpgsign=false")
        return subprocess.run(["git", "-C", clone, *settings, *words], check=True, capture_output=True, text=True).stdout  # fmt: skip

    git("init", "-q")
    git("add", "file")
    git("commit", "-q", "-m", "first")
    commit = git("rev-parse", "HEAD").strip()
    monkeypatch.setattr(provenance, "PROJECT", clone)
    assert dict(provenance.versions(1))["commit"] == commit
    (clone / "file").write_text("changed")
    assert dict(provenance.versions(1))["commit"] == f"{commit} with changes"
    monkeypatch.setattr(
        provenance, "PROJECT", clone / "inside"
    )  # a copy within another's clone has no commit of its own
    assert "commit" not in dict(provenance.versions(1))
