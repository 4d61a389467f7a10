"""The page of somebody's own recordings, section by section: one pendulum at length, many in a table, each cell as it is known."""

import math
from dataclasses import replace

import pandas as pd
import pytest
from markupsafe import Markup

from swingdown.language import language
from swingdown.planning.settings import complete
from swingdown.report.material import Material
from swingdown.report.page import Table, Text
from swingdown.report.sections import own
from swingdown.report.spoken import in_language
from swingdown.studies.pendulums import NOT_DYING, REFUSED, SEARCH, TOGETHER
from swingdown.studies.turning_points import NOT_DAMPED

ROW = {
    "campaign": "anna", "recording": "anna", "label": "anna's", "verdict": "", "model": "viscous", "period_s": 1.2345, "period_s_u": 0.0012,
    "quality": 123.4, "quality_u": 2.3, "decay_time_s": 48.5, "decay_time_s_u": 0.9, "natural_frequency_rad_per_s": 5.0896,
    "natural_frequency_rad_per_s_u": 0.0049, "amplitude_rad": math.radians(20), "residual_rad": 0.0021, "residual_rad_per_s": math.nan,
    "emulated": "no", "missing": "", "remark": "",
}  # fmt: skip
VERDICT = {
    "campaign": "anna", "status": "named", "sentence": "Load Coulomb friction is missing.", "next_measurement": "Swing it wider.",
    "effects": [{"name": "load_coulomb", "delta_bic": 57.4, "tied_with": []}], "gap": {"holdout": [3.21, 1.04], "fit": [3.0, 1.0]}, "where": {"remaining": [], "groups": []}, "noise_rms_rad": 0.002,
    "model": {"natural_frequency": {"value": 5.09, "standard_error": 0.01, "unit": "rad/s"}},
}  # fmt: skip


def material(*rows, **more):
    settings = complete({"recordings": "r.csv", "simulation": {"simulated": []}})
    recordings = [{"recording": "anna", "campaign": "anna", "file": "a.csv", "emulated": "no"}]
    table = pd.DataFrame([ROW | row for row in rows])
    return Material({"pendulums": table}, {}, recordings, settings, **more)


def several(count, **more):
    names = [f"p{k}" for k in range(count)]
    return [{"campaign": one, "recording": one, "label": f"pendulum {one}"} | more for one in names]


def cells(table):
    return [[str(cell) for cell in row] for row in table.rows]


def tables(section):
    return [item for item in section.items if isinstance(item, Table)]


def test_without_pendulums_there_is_nothing_to_answer():
    bare = replace(material({}), tables={})
    assert own.answer(bare) is None and own.amplitude(bare) is None and own.damping(bare) is None


def test_one_swing_is_told_quantity_by_quantity_with_units_and_amplitudes():
    section = own.answer(material({}))
    (table,) = tables(section)
    assert section.title == "The answer" and isinstance(section.items[0], Text)
    found = {row[0]: row[1:] for row in cells(table)}
    assert found["period"][:2] == ["1.2345(12)", "s"] and found["quality Q"][:2] == ["123.4(2.3)", ""]
    assert found["natural frequency"] == ["5.0896(49)", "rad/s", "of small undamped swings"]
    assert found["decay time (1/e)"][2] == "from 20°"
    assert (
        table.caption
        == "The model of damping with viscous describes the recording best; it leaves 2.10 mrad RMS."
    )
    assert len(table.notes) == 3 and table.of == ("anna",) and table.label == "Quantities, anna"


@pytest.mark.parametrize(
    ("row", "caption", "notes"),
    [
        ({"model_of": SEARCH}, "The last model of the search, viscous, fitted to the whole of every recording; it leaves 2.10 mrad RMS.", 2),
        ({"model": NOT_DYING}, f"What stops it {NOT_DYING}. The period is that of the best model, and it leaves 2.10 mrad RMS.", 1),
        ({"model": NOT_DAMPED}, "The period of passages through a light gate: nothing but their times was recorded.", 1),
        ({"residual_rad": math.nan}, "The model of damping with viscous describes the recording best; it leaves a scatter told below.", 3),
        ({"residual_rad_per_s": 0.05}, "The model of damping with viscous describes the recording best; it leaves 50.0 mrad/s RMS.", 3),
    ],
)  # fmt: skip
def test_what_a_model_leaves_is_told_in_its_unit_and_whose_model_it_is(row, caption, notes):
    (table,) = tables(own.answer(material(row)))
    assert table.caption == caption and len(table.notes) == notes


def test_several_swings_of_one_pendulum_are_rows_and_all_together_the_last():
    rows = [{"recording": "one", "label": "first"}, {"recording": "two", "label": "second"}, {"recording": TOGETHER, "amplitude_rad": math.nan}]  # fmt: skip
    (table,) = tables(own.answer(material(*rows)))
    assert table.label == "Quantities, anna" and [column.head for column in table.columns][:2] == [
        "recording",
        "period",
    ]
    assert [row[0] for row in cells(table)] == ["first", "second", "all together"]
    assert cells(table)[0][1:] == [
        "1.2345(12)",
        "123.4(2.3)",
        "48.50(90)",
        "20.0",
        "5.0896(49)",
        "κ<sub>v</sub>",
    ]
    assert cells(table)[2][4] == "–" and not table.sortable
    assert table.rows[0][4].value == math.radians(20) and table.rows[0][1].value == 1.2345


def test_a_verdict_stands_above_with_what_was_held_out_and_what_each_effect_gained():
    lead, said, sure, following, *rest = own.answer(material({}, verdicts=[VERDICT])).items
    assert (
        lead.style == said.style == "lead" and said.text == "<b>Named.</b> Load Coulomb friction is missing."
    )
    assert "The held-out residual is 1.04 times the noise of 2 mrad; a complete model leaves 1." in sure.text
    assert "With load Coulomb ΔBIC is 57; above 10 is very strong evidence." in sure.text
    assert '<a href="discovery/anna/verdict.json">' in sure.text
    assert following.text == "<b>Next measurement.</b> Swing it wider."
    silent = own.answer(material({}, verdicts=[VERDICT | {"next_measurement": None}])).items
    assert not any("Next measurement" in str(getattr(one, "text", "")) for one in silent)


def test_of_two_pendulums_each_sentence_begins_with_its_name_and_of_one_not():
    one, two = (own.answer(material(*several(count))) for count in (1, 2))
    assert not Markup(one.items[0].text).striptags().startswith("p0")
    leads = [
        Markup(item.text).striptags() for item in two.items if isinstance(item, Text) and item.style == "lead"
    ]
    assert [lead.split(":")[0] for lead in leads] == ["p0", "p1"]


def test_in_another_language_a_name_stays_and_its_sentence_is_said():
    """Of a recording that is called as a word of the page."""
    rows = [
        row | {"campaign": name, "recording": name}
        for row, name in zip(several(2), ("period", "rate"), strict=True)
    ]
    (spoken,) = in_language([own.answer(material(*rows))], language("de"))
    leads = [
        Markup(item.text).striptags()
        for item in spoken.items
        if isinstance(item, Text) and item.style == "lead"
    ]
    for name, lead in zip(("period", "rate"), leads, strict=True):
        assert lead.startswith(f"{name}: Luftwiderstand (viskos) bremst die Schwingung: T = 1,2345(12) s")


def test_more_than_two_pendulums_are_a_table_that_sorts_with_what_could_not_be_used():
    rows = several(3)
    rows[1] |= {"verdict": "named", "missing": "load_coulomb", "remark": "it is noisy"}
    rows[2] |= {"period_s": math.nan, "model": NOT_DAMPED, "amplitude_rad": math.nan}
    refused = {"campaign": "z", "recording": "z", "label": "z", "verdict": REFUSED, "remark": "it is empty"}
    found = material(*rows, refused)
    section = own.answer(replace(found, figures={"pendulums": ("p.svg", "Side by side.")}))
    lead, table, figure = section.items
    assert section.title == "All pendulums"
    assert lead.text == "3 pendulums. Not searched: 2, named: 1; 1 file could not be used."
    assert table.sortable and table.of == ("p0", "p1", "p2")
    first, named, gate, out = cells(table)
    assert first[:3] == ["pendulum p0", "Not searched", "1.2345(12)"]
    assert named[0] == '<a href="discovery/p1/figures/answer.svg">pendulum p1</a>'
    assert named[1] == '<a href="discovery/p1/verdict.json">Named: load coulomb: it is noisy</a>'
    assert gate[2] == "–" and gate[-1] == NOT_DAMPED and gate[5] == "–"
    assert out == ["z", "Not read: it is empty", *[""] * 6]
    assert (figure.path, figure.text, figure.link) == ("p.svg", "Side by side.", "figures/pendulums.svg")
    two = own.answer(material(*several(4), refused, refused | {"recording": "y"}))
    assert two.items[0].text.endswith("; 2 files could not be used.") and len(two.items) == 2


def test_evidence_of_many_is_where_it_lies_and_curves_are_of_few():
    many = material(*several(3), verdicts=[VERDICT | {"campaign": f"p{k}"} for k in range(3)])
    assert "the folder <code>discovery/</code>" in own.evidence(many).items[0].text
    assert own.amplitude(many) is None and own.damping(many) is None
    pictures = [f"results/discovery/p{k}/figures/{name}.svg" for k in range(2) for name in ("curves", "laws")]
    few = material(*several(2), seen=pictures)
    assert own.amplitude(few).title == "Against the amplitude" and own.evidence(few).title == "Evidence"


TABLE3 = {
    "campaign": "anna", "fitted": ["viscous", "error_bounds"], "mean": 0.13, "std": 0.01, "reduced_chi2": 1.2, "delta_bic_effective": 1234.4,
    "variance_inflation": 3.6, "n": [10, 12], "published_mean": math.nan, "published_std": math.nan, "note": "",
}  # fmt: skip


def test_models_of_damping_are_side_by_side_without_the_bounds():
    found = material({})
    section = own.damping(replace(found, tables=found.tables | {"table3": pd.DataFrame(TABLE3)}))
    (table,) = tables(section)
    assert section.title == "Models of damping" and len(section.items) == len(table.rows) == 1
    assert "κ with v for viscous" in table.notes[-1]
