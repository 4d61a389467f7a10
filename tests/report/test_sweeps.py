"""What the report says of sweeps: a table of each, by what it computes, without its axes that stand still."""

import pandas as pd

from swingdown.report.page import Findings, Table
from swingdown.report.sweeps import Made, section

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
