"""How often what was told as so probable was there: the reliability table of trials."""

import pandas as pd
import pytest

from swingdown_trials.score import reliability


def test_the_reliability_table_counts_what_was_told_and_what_was_there():
    def trial(kind, hidden, **told):
        return {"kind": kind, "hidden": hidden}, {"verdict": {"probabilities": told}}

    table = reliability(
        [
            trial("single", ("viscous",), viscous=0.95, stribeck=0.05),
            trial("single", ("viscous",), stribeck=0.95, viscous=0.04),
            trial("null", ()),
            trial("removed", ("viscous",), stribeck=1.0, viscous=0.001),
        ]
    )
    assert isinstance(table, pd.DataFrame)
    known = table[table["hidden"] == "one in the catalogue"].set_index("from")
    assert known.loc[0.9, ["n", "there"]].tolist() == [2, 0.5]
    assert known.loc[0.01, ["n", "there"]].tolist() == [2, 0.5]
    assert known.loc[0.9, "told"] == pytest.approx(0.95)
    lacking = table[table["hidden"] == "one that it lacks"]
    assert lacking[["from", "n", "there"]].to_numpy().tolist() == [[0.99, 1, 0.0]]
