"""What a study makes follows from its plan and settings alone."""

import pytest

from swingdown.planning.made import made
from swingdown.planning.plan import plan
from swingdown.planning.settings import complete

SHEET = """recording,campaign,file,length
a,one,a.csv,0.5 m
b,one,b.csv,0.6 m
c,two,c.csv,0.7 m
"""


@pytest.fixture
def whole(tmp_path, monkeypatch):
    """A function that lays down what a study of three swings makes."""
    monkeypatch.chdir(tmp_path)
    for name in "abc":
        (tmp_path / f"{name}.csv").write_text("time_s,angle_rad\n")
    (tmp_path / "sheet.csv").write_text(SHEET)

    def found(own=True, **more):
        settings = complete({"recordings": "sheet.csv", "simulation": {"simulated": []}} | more)
        return made(plan(settings), settings, own)

    return found


def test_a_study_of_one_s_own_shows_its_pendulums_and_what_was_varied(whole):
    shown = whole()
    assert [path.split("/")[-1] for path in shown.tables] == [
        f"{name}.csv"
        for name in ("table3", "comparison", "parameters", "parameter_budget", "left_out", "pendulums", "g_budget", "series", "laws")
    ]  # fmt: skip
    assert [path for path in shown.figures if path.endswith("svg")] == [
        f"results/figures/{name}.svg" for name in ("pendulums", "series")
    ]
    assert shown.stated["b"] == {"length": "0.6 m"}
    assert "results/curves/two/laws.png" in shown.curves and set(shown.curves) < set(shown.study)
    papers = whole(own=False)
    assert not papers.figures and not papers.curves and "results/tables/series.csv" not in papers.tables


def test_pendulums_are_drawn_side_by_side_where_there_are_two_swings(whole):
    """As those of one campaign, or of two."""
    two, one = (
        whole(experiment={"campaigns": [name]}, discovery={"campaigns": ["two"]}) for name in ("one", "two")
    )
    assert (
        "results/figures/pendulums.svg" in two.figures and "results/figures/pendulums.svg" not in one.figures
    )


def test_what_follows_a_change_is_drawn_where_something_was_changed(whole, tmp_path):
    changed = SHEET.replace("length", "length,changed,changed_value").replace(" m\n", " m,magnet,0.1\n")
    (tmp_path / "sheet.csv").write_text(changed.replace("0.7 m,magnet,0.1", "0.7 m,,"))
    drawn = [path for path in whole().seen if "/difference.svg" in path]
    assert drawn == ["results/discovery/one/figures/difference.svg"]


def test_a_pendulum_of_one_swing_has_no_joint_fit_and_a_search_has_its_first_and_last_round(whole):
    shown = whole(discovery={"campaigns": ["two"], "rounds": 3})
    assert shown.joint == ["results/experiment/joint/one.nc"]
    assert shown.verdicts == ["results/discovery/two/verdict.json"]
    fits = [
        path for path in shown.searched if path.startswith("results/discovery") and path.endswith("/fit.nc")
    ]
    assert fits == ["results/discovery/two/first/fit.nc", "results/discovery/two/last/fit.nc"]
    models = [path for path in shown.searched if "/round-" in path]
    assert models == [f"results/discovery/two/round-{number}/model.yaml" for number in range(4)]
    assert "results/experiment/fits/a.nc" in shown.searched  # it tells whether a swing is free


def test_a_study_without_recordings_makes_its_simulations_alone(whole):
    shown = whole(own=False, recordings=None, simulation={"simulated": ["viscous"]})
    assert shown.tables == ["results/tables/table2.csv"] and not shown.verdicts and not shown.searched
    assert "results/simulation/norms_viscous.nc" in shown.study
