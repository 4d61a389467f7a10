"""What the report says of sweeps: a table of each, by what it computes, without its axes that stand still."""

import pandas as pd

from swingdown.report.page import Figure, Findings, Table, Text
from swingdown.report.sweeps import Made, made, section
from swingdown.sealed import write_csv

WORDS = ("named", "among_others", "nothing", "failed", "unknown", "unnamed", "wrong")
COMMON = {"draws": 10, "made": 10, "independent": 10, "reason": ""}


def tables(**sweeps):
    """The tables of the section, by label."""
    rows = {name: Made(pd.DataFrame(one), []) for name, one in sweeps.items()}
    return {one.label: one for one in section(rows).items if isinstance(one, Table)}


def test_how_often_the_right_model_is_told_stands_by_what_was_simulated():
    axes = {"snr": [20, 50] * 2, "simulated": ["viscous"] * 2 + ["load_coulomb"] * 2, "start": "rest"}
    shares = {
        "true_by_norm": [0.5, 0.9, 1.0, 1.0],
        "true_by_bic": [0.7, 0.9, 1.0, 1.0],
        "true_by_ten": float("nan"),
    }
    (table,) = tables(by_noise=axes | COMMON | shares).values()
    assert table.label == "Sweep by noise"
    assert [column.head for column in table.columns] == ["simulated", "cells", "by norm", "by BIC"]
    assert [list(map(str, row[1:])) for row in table.rows] == [
        ["2", "70 · 1", "80 · 2"],
        ["2", "100 · 2", "100 · 2"],
    ]
    assert len(table.notes) == 1  # ten runs are explained where they were compared


def test_a_sweep_over_one_thing_alone_has_a_row_for_each_of_its_values():
    shares = {"true_by_norm": [0.5, 0.9], "true_by_bic": 0.9, "true_by_ten": 0.8}
    (table,) = tables(small={"simulated": "viscous", "snr": [20, 50]} | COMMON | shares).values()
    assert [column.head for column in table.columns][0] == "simulated" and len(table.rows) == 1
    assert len(table.notes) == 2


def test_what_a_search_said_is_a_table_of_its_own():
    said = {f"said_{word}": 0.0 for word in WORDS}
    more = {
        "found": 0.9,
        "named": 0.8,
        "left_by_base": 2.0,
        "mean_gap": 2.0,
        "size_of_effect": 0.1,
        "reached": 1,
    }
    (table,) = tables(search={"effect": "magnet", "size": [1.3, 2.0]} | COMMON | more | said).values()
    assert [column.head for column in table.columns][:2] == ["effect", "left by the base model"]
    assert len(table.rows) == 2


def test_what_a_search_found_is_told_where_nothing_was_hidden_and_of_the_largest_effects():
    rows = {"effect": "magnet", "size": [0.0, 1.3, 2.0], "found": [0.1, 0.5, 0.9], "named": [0.0, 0.4, 0.8]}
    said = {f"said_{word}": 0.0 for word in WORDS} | {"said_wrong": [0.1, 0.3, 0.2]}
    more = {"left_by_base": 2.0, "mean_gap": 2.0, "size_of_effect": 0.1, "reached": [1, 0, 1]}
    one = Made(pd.DataFrame(rows | COMMON | more | said), [])
    (found,) = [item for item in section({"small": one}).items if isinstance(item, Findings)]
    short, null, largest = found.lines
    assert short.startswith("small: in 1 of 3 cells no size of the hidden effect leaves what was asked for")
    assert null == "small: where nothing was hidden, the search reports something in 1 of 10 campaigns."
    assert largest == (
        "small: of effects that leave 2 times the noise, 90 % are reported, 80 % named alone, and 20 % named wrongly."
    )


def said(**sweeps):
    """What a reader in a hurry is told."""
    items = section({name: Made(pd.DataFrame(one), []) for name, one in sweeps.items()}).items
    return items[0].lines if items else []


def test_how_often_the_right_model_is_told_is_told_over_all_cells():
    """Norm: (50 + 90 + 68) / 3 = 69.3 %, of which 68 % is as good as the paper's; BIC: (60 + 70 + 80) / 3 = 70 %."""
    shares = {"true_by_norm": [0.5, 0.9, 0.68], "true_by_bic": [0.6, 0.7, 0.8], "true_by_ten": float("nan")}
    one = {"simulated": "viscous", "snr": [20, 50, 90]} | COMMON | shares
    assert said(small=one) == [
        "small: averaged over all cells the true model has the lowest norm in 69 % of the swings and the lowest BIC in 70 %. "
        "The paper's 68 % is reached in 2 of 3 cells by norm, in 2 of 3 by BIC."
    ]
    (line,) = said(small=one | {"true_by_ten": [0.67, 0.7, float("nan")]})
    assert line.endswith(
        "by BIC, and in the paper's own comparison (mean norm of ten runs, four models) in 1 of 2."
    )


def test_fits_of_two_starts_are_told_apart_and_of_one_start_not():
    shares = {"true_by_norm": [0.5, 0.9], "true_by_bic": [0.6, 0.7], "true_by_ten": float("nan")}
    one = {"simulated": "viscous", "start": ["rest", "free"]} | COMMON | shares
    rest, free = said(small=one)
    assert "fits that start at rest at the first sample: averaged" in rest and "norm in 50 % of" in rest
    assert "fits with the release fitted: averaged" in free and "norm in 90 % of" in free
    (both,) = said(small=one | {"start": "rest"})
    assert "start" not in both and "norm in 70 % of" in both


def test_cells_that_could_not_be_made_are_counted_with_their_reasons():
    shares = {"true_by_norm": 0.5, "true_by_bic": 0.6, "true_by_ten": float("nan")}
    more = {"made": [0, 10, 0, 0], "reason": ["it stops at once", "", "it goes over", "it stops at once"]}
    first, _ = said(small={"simulated": list("abcd")} | COMMON | more | shares)
    assert first == "small: 3 of 4 cells could not be made (it goes over; it stops at once)."


SEARCH = {f"said_{word}": 0.0 for word in WORDS} | {
    "named": [0.4, float("nan")],
    "said_among_others": [0.25, 0.0],
}
SEARCH |= {
    "found": [0.5, 0.9],
    "left_by_base": [1.234, float("nan")],
    "said_unknown": 0.125,
    "said_wrong": [0.0, 0.05],
}


def test_a_search_s_row_has_its_shares_in_percent_and_no_number_where_there_is_none():
    made = {"draws": [20, 20], "made": [20, 18], "independent": 20, "reason": ""}
    one = {"effect": ["load_coulomb", "magnet"], "size": [2.0, 2.0], "snr": [20, 50]} | made | SEARCH
    (table,) = tables(search=one).values()
    assert [column.head for column in table.columns][:3] == ["effect", "snr", "left by the base model"]
    assert [list(map(str, row)) for row in table.rows] == [
        ["load Coulomb", "20", "1.2", "50", "40", "25", "12", "0"],
        ["magnet", "50", "–", "90", "–", "0", "12", "5"],
    ]
    assert table.groups == (1,) and table.notes == ("18 to 20 campaigns a row.",)


def test_false_alarms_are_counted_where_nothing_was_hidden():
    """A tenth of 20 campaigns and a half of 8: 6 of 28; a search of effects of one size is told by none."""
    said_of_it = {f"said_{word}": 0.0 for word in WORDS} | {"named": 0.5, "left_by_base": 3.0}
    one = {"effect": "magnet", "size": [0.0, 0.0, 3.0]} | COMMON | said_of_it
    one |= {"found": [0.1, 0.5, 1.0], "made": [20, 8, 10]}
    null, largest = said(small=one)
    assert "reports something in 6 of 28 campaigns" in null and "3 times the noise, 100 % are" in largest
    assert said(small=one | {"size": [1.0, 1.0, 3.0]}) == [largest]
    del one["size"]
    assert said(small=one) == []


def test_a_sweep_is_shown_where_its_table_and_a_map_are_there(tmp_path):
    captions = [tmp_path / f"sweep_{name}.rst" for name in ("by_norm", "by_bic")]
    for path in captions:
        path.write_text(f"Of {path.stem}.")
    table = pd.DataFrame({"simulated": ["viscous"], "true_by_norm": 0.5, "true_by_bic": 0.6, "true_by_ten": 0.7} | COMMON)  # fmt: skip
    for name in ("whole", "no_map", "no_table"):
        (tmp_path / name / "figures").mkdir(parents=True)
        if name != "no_table":
            write_csv(table, tmp_path / name / "summary.csv")
        if name != "no_map":
            (tmp_path / name / "figures" / "by_bic.svg").write_text("<svg/>")
    found = made(["whole", "no_map", "no_table", "never"], map(str, captions), tmp_path)
    assert list(found) == ["whole"] and list(found["whole"].table["true_by_norm"]) == [0.5]
    findings, shown, figure, text = section(found).items
    assert isinstance(findings, Findings) and isinstance(shown, Table) and isinstance(text, Text)
    assert figure == Figure(
        "Sweep whole, by BIC", str(tmp_path / "whole/figures/by_bic.svg"), "Of sweep_by_bic."
    )


def test_without_sweeps_nothing_is_said():
    assert section({}).items == []
