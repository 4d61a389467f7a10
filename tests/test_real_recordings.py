"""The study's functions, from sample sheet to joint fit, on recordings of real pendulums that come beside the project."""

import re

import numpy as np
import pandas as pd
import pytest

from swingdown.discovery.data.campaign import Swing, campaign
from swingdown.discovery.search import discover
from swingdown.discovery.tell.files import summary
from swingdown.discovery.tell.verdict import verdict
from swingdown.fitting.least_squares import fit_trajectory
from swingdown.measurement.angle import to_angle
from swingdown.measurement.recording import ingest
from swingdown.measurement.sheet import read_sheet
from swingdown.pendulum.catalogue import SHIPPED
from swingdown.pendulum.model import PAPER_MODELS
from swingdown.studies import norms
from swingdown.studies import paper_tables as tables
from swingdown.studies.experiment import fit_campaign, fit_recording

# The link is still being lifted when the trigger fires, and is at its highest 0.12, 0.25 and 0.13 s later. No start_s is stated: the
# release is found. Windows chosen by eye (0.35, 0.45, 0.35 s) leave the same 0.0044, 0.0115 and 0.0157 rad of the joint fit.
SHEET = """recording,campaign,file,time_column,signal_column,start_s
free_swing_large,dynamicslab,{folder}/real/dynamicslab_single/free_swing_large.csv,t_s,theta_rad,
rel45,jensen,{folder}/real/jensen_rotary/rel45.csv,t_s,theta_rad,
rel90,jensen,{folder}/real/jensen_rotary/rel90.csv,t_s,theta_rad,
rel135,jensen,{folder}/real/jensen_rotary/rel135.csv,t_s,theta_rad,
"""
ALL_THREE = "viscous+quadratic_drag+load_coulomb"


@pytest.fixture(scope="module")
def angles(shared_data, tmp_path_factory):
    sheet = tmp_path_factory.mktemp("real") / "recordings.csv"
    sheet.write_text(SHEET.format(folder=shared_data))
    rows = read_sheet(sheet)
    return {name: to_angle(ingest(row, str(sheet))) for name, row in rows.iterrows()}


@pytest.fixture(scope="module")
def jensen(angles):
    return [angles[name] for name in ("rel45", "rel90", "rel135")]


@pytest.mark.parametrize("coulomb", ["constant_coulomb", "load_coulomb"])
def test_one_arm_over_55_s_is_fitted_to_three_milliradians(angles, coulomb):
    angle = angles["free_swing_large"]
    assert float(angle["time"][-1] - angle["time"][0]) == pytest.approx(55, abs=0.01)
    model = f"viscous+quadratic_drag+{coulomb}"
    fit = fit_recording(angle, [model]).sel(fitted=model)
    assert np.radians(float(fit["norm"])) <= 3.0e-3
    assert bool(fit["converged"])
    assert float(fit["value"].sel(parameter="natural_frequency")) == pytest.approx(8.005, abs=0.002)


def test_what_that_fit_lacks_is_told(angles, root):
    """The fit is close only with a viscous coefficient below 0, which no damper has, and ten times above the noise."""
    fits = fit_recording(angles["free_swing_large"], PAPER_MODELS)
    combined = norms.combine_recordings([fits])
    published = pd.read_csv(root / "resources/paper/table3.csv")
    table = tables.table3(combined, published).set_index("fitted")
    assert "viscous_ratio below 0 in 1 of 1" in table.loc[ALL_THREE, "note"]
    assert "emulated" not in table.loc[ALL_THREE, "note"]
    assert table.loc[ALL_THREE, "reduced_chi2"] > 10
    swing = angles["free_swing_large"]
    bounded = fit_trajectory(ALL_THREE, swing["time"].values, swing["angle"].values, bounded=True)
    assert bounded.model.values["viscous_ratio"] == 0 and bounded.rms > 3.0e-3


def test_three_swings_of_a_link_are_fitted_together(jensen):
    joint = fit_campaign(jensen, PAPER_MODELS)
    best = joint.sel(fitted=ALL_THREE)
    assert list(joint["recording"].values) == ["rel45", "rel90", "rel135"]
    assert best["converged"]
    # of swings of 60 to 140 degrees; 0.0044, 0.0115 and 0.0157 rad were found
    assert (best["rms"] < [0.006, 0.013, 0.018]).all()
    assert float(best["value"].sel(parameter="natural_frequency")) == pytest.approx(10.97, abs=0.01)
    first = [float(angle["angle"][0]) for angle in jensen]
    assert best["release_angle"].values == pytest.approx(
        first, abs=0.04
    )  # each has its own, near its first sample


def test_adding_a_term_never_raises_the_norm_of_a_real_swing(angles):
    fits = norms.combine_recordings([fit_recording(angle, PAPER_MODELS) for angle in angles.values()])
    for small in PAPER_MODELS:
        for large in PAPER_MODELS:
            if set(small.split("+")) < set(large.split("+")):
                rise = fits["norm"].sel(fitted=large) / fits["norm"].sel(fitted=small) - 1
                assert (rise <= 1e-9).all(), (small, large)
    assert set(fits["campaign"].values) == {"dynamicslab", "jensen"}
    assert (fits["converged"]).all()


def test_a_window_that_begins_in_the_hand_is_seen_in_the_fit(shared_data, tmp_path):
    """From the first sample of the trigger on, the joint fit is five times worse: start_s matters."""
    sheet = tmp_path / "early.csv"
    early = re.sub(r"(rel.*),$", r"\1,0.10", SHEET.format(folder=shared_data), flags=re.MULTILINE)
    assert early.count(",0.10") == 3
    sheet.write_text(early)
    rows = read_sheet(sheet).query("campaign == 'jensen'")
    joint = fit_campaign([to_angle(ingest(row, str(sheet))) for _, row in rows.iterrows()], [ALL_THREE])
    assert float(np.sqrt((joint["rms"] ** 2).mean())) > 5 * 0.0115


BUDGET = 30  # CPU seconds a search: what these tests hold is there before


def verdict_on(name, angles, base):
    """The verdict on recordings of one real pendulum, from this base model."""
    swings = [Swing(str(one.attrs["recording"]), one["time"].values, one["angle"].values) for one in angles]
    one = campaign(name, swings)
    return verdict([summary(state, one) for state in discover(one, base, budget_s=BUDGET)])


@pytest.mark.slow("a search")
@pytest.mark.parametrize(
    ("base", "shrinks"), [(("viscous", "load_coulomb"), True), (("quadratic_drag", "load_coulomb"), False)]
)
def test_what_a_real_arm_lacks_is_told_and_its_gap_shrinks_on_what_was_held_out(angles, base, shrinks):
    """The catalogue has no name for all of it, and the verdict says so; beside quadratic drag something unnamed does better than any name."""
    found = verdict_on("dynamicslab_single", [angles["free_swing_large"]], base)
    assert found["status"] in ("unknown", "partial")
    first, last = found["gap"]["holdout"][0], found["gap"]["holdout"][-1]
    assert last > 10
    assert last < 0.7 * first if shrinks else (last == first and not found["effects"])
    assert "has no name in the catalogue" in found["sentence"]
    assert "every second held out" in found["split"]
    dissipations = {effect.size.name for effect in SHIPPED if effect.one_sided}
    for parameter, value in found["model"].items():
        assert parameter not in dissipations or value["value"] >= 0
    said = found["sentence"].lower()
    assert all(parameter.replace("_", " ") in said for parameter in found["misspecified"])


@pytest.fixture(scope="module")
def found(jensen):
    """The verdict on the link's three swings."""
    return verdict_on("jensen", jensen, ("viscous", "load_coulomb"))


@pytest.mark.slow("a search")
def test_three_swings_of_a_link_have_no_name_for_what_they_lack(found):
    """The trigger's jumps on return strokes are in no catalogue, and pass for slow noise: nothing is told, and nothing called complete."""
    assert found["status"] == "unknown" and found["effects"] == []
    assert found["noise_correlation"] > 0.9
    assert found["gap"]["holdout"][-1] > 1.5
    assert "not sure enough to be named" in found["sentence"]
    assert "missing of the fitted swings" in found["sentence"]  # the others are left with twice the noise
    assert found["split"] == "held out by amplitude: rel90"


@pytest.mark.slow("a search")
@pytest.mark.xfail(reason="2.2 of 3.1 times the noise, which the trigger's jumps make slow: nothing is sure")
def test_a_third_of_the_links_gap_is_explained(found):
    assert found["gap"]["holdout"][-1] < 0.7 * found["gap"]["holdout"][0]


@pytest.mark.slow("a search")
def test_a_magnet_below_a_rig_is_found(shared_data):
    """The rig's makers tell of a repelling magnet at its bottom; read off a figure, from 177° to rest on one side of it."""
    table = pd.read_csv(shared_data / "real/khasawneh_rig/fig13_digitised.csv", comment="#")
    rig = campaign("rig", [Swing("drop", table["t_s"].to_numpy(), table["theta_rad"].to_numpy())])
    states = discover(rig, "quadratic_drag+load_coulomb", budget_s=3 * BUDGET)  # half of it on a fast machine
    found = verdict([summary(state, rig) for state in states])
    magnet = next(one for one in found["effects"] if one["name"] == "magnet")
    assert magnet["probability"] > 0.99
    assert magnet["gap_without"] > 2 * found["gap"]["holdout"][-1]
    values = states[-1].fit.model.values
    push = -2 * values["magnet_depth"] / values["magnet_width"] ** 2
    assert push > values["natural_frequency"] ** 2  # it does not come to rest at the bottom
    assert 0.05 < values["magnet_width"] < 0.2
    assert found["gap"]["holdout"][-1] < 0.5 * found["gap"]["holdout"][0]


@pytest.mark.slow("a search")
def test_the_whole_workflow_runs_on_real_recordings(shared_data, snakemake, tmp_path):
    (tmp_path / "sheet.csv").write_text(SHEET.format(folder=shared_data.resolve()))
    (tmp_path / "mine.yaml").write_text(
        "recordings: sheet.csv\nsimulation: {simulated: []}\ndiscovery: {budget_s: 2, rounds: 2}\n"
    )
    snakemake("--configfile", tmp_path / "mine.yaml", directory=tmp_path)
    table = pd.read_csv(tmp_path / "results/tables/table3.csv").set_index(["campaign", "fitted"])
    assert np.radians(table.loc[("dynamicslab", ALL_THREE), "mean"]) <= 3.0e-3
    assert table.loc[("jensen", ALL_THREE), "n"] == 3
    report = tmp_path / "results/report.html"
    assert report.stat().st_size < 15e6  # 55 s at 1 kHz, and still a page that can be sent
