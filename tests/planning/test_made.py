"""What a study makes follows from its plan and settings alone."""

import pytest

from swingdown.measurement.apparatus import read_apparatus
from swingdown.paths import PROJECT
from swingdown.planning.made import made, varied_in
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


def folder(paths):
    """The paths below the folder of results."""
    assert all(path.startswith("results/") for path in paths) and len(set(paths)) == len(paths)
    return [path.removeprefix("results/") for path in paths]


def test_a_study_rests_on_its_joint_fits_curves_and_simulations_alone(whole):
    """Of two swings together a joint fit; of each pendulum curves and laws, as tables and pictures."""
    shown = whole(simulation={"simulated": ["viscous", "load_coulomb"]})
    each = [f"curves/{name}/{kind}.{ending}" for name in ("one", "two") for kind in ("curves", "laws") for ending in ("csv", "svg", "png")]  # fmt: skip
    assert folder(shown.study) == [
        "simulation/realizations.nc", "simulation/norms.nc", "simulation/norms_viscous.nc", "simulation/norms_load_coulomb.nc",
        "experiment/joint/one.nc", "experiment/norms.nc", *each,
    ]  # fmt: skip
    assert folder(shown.curves) == each and folder(shown.joint) == ["experiment/joint/one.nc"]
    assert folder(shown.tables)[0] == "tables/table2.csv" and "tables/uncertainty_budget.csv" not in folder(shown.tables)  # fmt: skip


def test_what_searches_rest_on_is_what_they_read_and_write(whole):
    """Of one campaign of two: a swing that is not searched is measured and fitted too."""
    shown = whole(discovery={"campaigns": ["two"], "rounds": 1})
    found = folder(shown.searched)
    assert found[:9] == [f"{place}/{name}.nc" for place in ("recordings", "angles", "experiment/fits") for name in "abc"]  # fmt: skip
    files = ("model.yaml", "fit.nc", "groups.csv", "ranking.csv", "map.csv", "half_swings.csv", "remainder.csv", "course.csv")  # fmt: skip
    rounds = [f"{place}/{file}" for place in ("first", "last") for file in files]
    own = ["rounds.json", *rounds, "round-0/model.yaml", "round-1/model.yaml", "difference.json"]
    pictures = [f"figures/{name}.png" for name in ("answer", "remainder", "residuals", "map", "half_swings", "ranking", "gap")]  # fmt: skip
    assert found[9:] == [f"discovery/two/{one}" for one in (*own, *pictures)]
    assert folder(shown.seen) == [f"discovery/two/{one.replace('png', 'svg')}" for one in pictures]


@pytest.mark.parametrize(
    ("cells", "figures"),
    [
        ({"a": {"length": "1 m"}, "b": {"length": "2 m"}}, ()),
        ({"a": {"mass": "1 kg"}, "b": {"mass": "2 kg"}, "c": {"mass": "2 kg"}}, ()),
        ({name: {"current": name} for name in "abc"}, ("series",)),
        ({name: {"bob_diameter": name} for name in "abc"}, ()),
        ({"a": {"group": "x"}, "b": {"group": "y"}}, ("groups",)),
        ({"a": {"group": "x"}, "b": {"group": "x"}, "c": {}}, ()),
        ({name: {"area": name, "group": name} for name in "abc"}, ("series", "groups")),
    ],
)
def test_a_law_is_drawn_over_three_values_and_groups_beside_each_other(cells, figures):
    assert varied_in(cells) == figures


def test_recordings_in_volts_have_a_calibration_and_its_budget(whole, tmp_path):
    (tmp_path / "sheet.csv").write_text("recording,campaign,file,signal_unit\na,bob,a.csv,V\n")
    (tmp_path / "apparatus.yaml").write_text((PROJECT / "config" / "apparatus.yaml").read_text())
    campaign = next(iter(read_apparatus(str(tmp_path / "apparatus.yaml"))["campaigns"]))
    (tmp_path / "sheet.csv").write_text(f"recording,campaign,file,signal_unit\na,{campaign},a.csv,V\n")
    shown = whole(apparatus="apparatus.yaml")
    assert folder(shown.tables)[0] == "tables/uncertainty_budget.csv"
    assert "calibration/calibration.nc" in folder(shown.searched)
