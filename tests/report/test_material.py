"""What a report is made from, and what of it is shown."""

import pandas as pd

from swingdown.report.material import Material, read_tables


def material(recordings=(), simulated=(), figures=(), **settings):
    pictures = {name: (f"results/{name}.svg", f"Caption of {name}.") for name in figures}
    return Material({}, pictures, list(recordings), {"simulation": {"simulated": list(simulated)}} | settings)


def test_recordings_without_the_papers_simulations_are_somebodys_own():
    one = {"campaign": "a"}
    assert material([one]).own and not material([one], ["viscous"]).own and not material().own


def test_the_language_is_asked_for_of_a_study_of_ones_own_alone():
    one = {"campaign": "a"}
    assert material([one], lang="de").spoken.code == "de" and material([one]).spoken.code == "en"
    assert material([one], ["viscous"], lang="de").spoken.code == "en"


def test_campaigns_of_an_emulated_apparatus_are_told_once():
    rows = [
        {"campaign": name, "emulated": told}
        for name, told in (("b", "yes"), ("a", "no"), ("b", "yes"), ("c", "yes"))
    ]
    assert material([*rows, {"campaign": "d"}]).emulated == ["b", "c"]


def test_figures_that_were_made_are_shown_and_those_of_data_say_what_is_emulated():
    one = material([{"campaign": "bench", "emulated": "yes"}], figures=("fig07", "fig08", "fig10"))
    shown = one.shown("fig10", "fig07", "fig08", "fig09")
    assert [figure.label for figure in shown] == ["Figure 10", "Figure 7", "Figure 8"]
    assert [("bench" in repr(figure)) for figure in shown] == [True, False, True]
    assert (
        "results/fig10.svg" in repr(shown[0])
        and "figures/fig10.svg" in repr(shown[0])
        and "Caption of fig10." in repr(shown[0])
    )


def test_tables_go_by_their_names(tmp_path):
    for name in ("a", "b.c"):
        pd.DataFrame({"x": [1.5]}).to_csv(tmp_path / f"{name}.csv", index=False)
    found = read_tables([tmp_path / "a.csv", str(tmp_path / "b.c.csv")])
    assert list(found) == ["a", "b.c"] and found["a"]["x"].tolist() == [1.5]
