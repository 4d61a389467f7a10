"""The sentences that open the report of the paper's study."""

from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from swingdown.report.sections.findings import findings, simplest

PAIRS = ["campaign", "model_a", "model_b", "mean_difference", "delta_bic_effective", "verdict"]


def rows(**changed):
    """Table 3 of a campaign: viscous, the pair with Coulomb, and the bounds."""
    columns = {
        "campaign": "bench", "fitted": ["viscous", "viscous+load_coulomb", "error_bounds"], "mean": [0.12, 0.11, 0.2],
        "std": [0.01, 0.01, 0.02], "bic": [10.0, 5.0, np.nan], "n": [10, 10, 10], "reduced_chi2": [1.3, 1.2, np.nan],
    }  # fmt: skip
    return pd.DataFrame(columns | changed)


def said(table3=None, pairs=(), table2=None, verdicts=()):
    tables = {"table3": table3, "comparison": pd.DataFrame(pairs, columns=PAIRS), "table2": table2}
    material = SimpleNamespace(
        tables={k: v for k, v in tables.items() if v is not None}, verdicts=list(verdicts)
    )
    return [str(line) for item in findings(material).items for line in item.lines]


def pair(difference, delta, verdict="they differ"):
    return ("bench", "viscous", "viscous+load_coulomb", difference, delta, verdict)


def test_the_lowest_bic_describes_the_swings_best():
    lines = said(rows(), [pair(0.01, 20.0)])
    assert (
        "bench: κ<sub>v,c</sub> (viscous and load Coulomb) describes the 10 swings best; it leaves 0.110 ± 0.010° RMS."
        in lines
    )
    assert "bench: what it leaves is 1.20 times the variance" in lines[1] and "closer still" not in "".join(
        lines
    )


@pytest.mark.parametrize(("delta", "best"), [(5.9, "κ<sub>v</sub> (viscous)"), (6.1, "κ<sub>v,c</sub>")])
def test_a_smaller_model_is_named_where_the_larger_is_not_worth_its_term(delta, best):
    lines = said(rows(), [pair(0.01, delta)])
    assert lines[0].startswith(f"bench: {best}")
    assert ("κ<sub>v,c</sub> comes closer still" in lines[1]) == (delta < 6)


def test_it_is_within_the_bounds_or_above_them():
    assert "it is within the paper's benchmark" in said(rows(), [pair(0.01, 20.0)])[-1]
    above = said(rows(mean=[0.12, 0.21, 0.2]), [pair(0.01, 20.0)])[-1]
    assert "it is above the paper's benchmark" in above and "(0.200 ± 0.020°)" in above
    assert "benchmark" not in "".join(said(rows(mean=[0.12, 0.11, np.nan]), [pair(0.01, 20.0)]))


def test_one_swing_is_one_and_what_is_not_told_apart_is_said():
    lines = said(
        rows(n=[1, 1, 1], reduced_chi2=np.nan), [pair(0.01, 20.0, "κv and κv,c are indistinguishable")]
    )
    assert "describes the swing best" in lines[0] and "variance" not in "".join(lines)
    assert "bench: κ<sub>v</sub> and κ<sub>v,c</sub> are indistinguishable." in lines


def test_the_simulation_counts_what_lies_within_the_papers_own_deviation():
    columns = {
        "mean": [1.0, 1.3, 1.0],
        "published_mean": [1.1, 1.1, np.nan],
        "published_std": [0.1001, 0.1, np.nan],
    }
    assert said(table2=pd.DataFrame(columns))[0].startswith("Simulation: 1 of the 2 mean norms")
    none = pd.DataFrame(columns | {"published_mean": np.nan})
    assert said(table2=none) == ["Simulation: 3 mean norms, which the paper does not report."]


def test_verdicts_stand_first_and_of_nothing_there_is_no_section():
    assert (
        said(rows(), [pair(0.01, 20.0)], verdicts=[{"campaign": "bench", "sentence": "Nothing is missing."}])[
            0
        ]
        == "bench: Nothing is missing."
    )
    assert findings(SimpleNamespace(tables={}, verdicts=[])).items == []


def test_the_smallest_of_several_is_the_one_with_the_fewest_terms_then_the_nearest():
    whole = "viscous+quadratic_drag+load_coulomb"
    pairs = pd.DataFrame(
        [
            ("bench", "viscous+load_coulomb", whole, 0.001, 1.0, ""),
            ("bench", "viscous", whole, 0.03, 2.0, ""),
            ("bench", "load_coulomb", whole, 0.02, 3.0, ""),
            ("bench", "quadratic_drag", whole, 0.01, 60.0, ""),
        ],
        columns=PAIRS,
    )
    assert simplest(whole, pairs) == "load_coulomb"
    assert simplest("viscous", pairs) == "viscous"
