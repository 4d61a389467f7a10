"""What the report says of g and of a series."""

import numpy as np
import pandas as pd
import pytest

from swingdown.measurement.stated import Stated
from swingdown.planning.made import varied_in
from swingdown.plots import save
from swingdown.plots.series import drawn
from swingdown.report import page
from swingdown.report.material import Material
from swingdown.report.sections.series import series
from swingdown.series import as_laws, of_sheet
from swingdown.studies.gravity import budgets, gravity

LENGTHS = {"a": "0.200(1) m", "b": "0.400(1) m", "c": "0.800(1) m"}


@pytest.fixture
def stated():
    return {
        name: {"length": text, "group": "left" if name == "a" else "right"} for name, text in LENGTHS.items()
    }


@pytest.fixture
def table():
    omega = np.sqrt(9.81 / np.array([0.2, 0.4, 0.8]))
    known = {
        "label": list("abc"),
        "natural_frequency_rad_per_s": omega,
        "natural_frequency_rad_per_s_u": 1e-4 * omega,
    }
    return pd.DataFrame({"campaign": list("abc"), "recording": list("abc"), "emulated": "no"} | known)


def test_the_sentences_the_figures_and_the_budget_are_there(stated, table, tmp_path):
    assert varied_in(stated) == ("series", "groups")
    made = of_sheet(table, stated)
    figures = {}
    for kind in varied_in(stated):
        (path, _) = save(drawn(kind, made), tmp_path / kind)
        figures[kind] = (str(path), "A caption.")
    found = gravity(Stated(7.0, 0.001, "rad/s"), Stated(0.2, 0.001, "m"), bob_diameter=Stated(0.03, unit="m"))
    tables = {"laws": as_laws(made), "g_budget": budgets({"a": found})}
    section = series(Material(tables, figures, [{"campaign": "a"}], {}))
    told = [item for item in section.items if isinstance(item, page.Text)]
    assert told[0].text.startswith("T goes as the power 0.5000(")
    assert [item.label for item in section.items if isinstance(item, page.Figure)] == ["Series", "Groups"]
    budget = section.items[-1]
    assert ["length", "0.2000(10)", "m", "49", ""] in [list(row) for row in budget.rows]
    assert any("counts as none" in str(row[-1]) for row in budget.rows) and budget.rows[-1][0] == "g"


def test_without_lengths_there_is_no_section():
    assert series(Material({}, {}, [], {})) is None


def test_too_few_values_make_a_figure_that_says_so(table, tmp_path):
    made = of_sheet(table.iloc[:2], {"a": {"length": "0.2"}, "b": {"length": "0.4"}})
    assert not made and varied_in({"a": {"length": "0.2"}, "b": {"length": "0.4"}}) == ()
    assert varied_in({"a": {"group": "x"}, "b": {"group": "y"}, "c": {}}) == ("groups",)
    assert varied_in({"a": {"group": "x"}, "b": {"group": "x"}}) == ()
    assert save(drawn("series", made), tmp_path / "series")
