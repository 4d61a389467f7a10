"""Stated intervals hold the truth of simulated measurements; the whole table is made by a target of its own."""

import numpy as np
import pytest

from swingdown.measurement.apparatus import read_apparatus
from swingdown_trials import coverage
from swingdown_trials.coverage import CASES, bench, calibrations, swings, table


@pytest.fixture(scope="module")
def apparatus(root):
    return read_apparatus(root / "config/apparatus.yaml")


def test_each_draw_is_another_bench_and_the_same_again(apparatus):
    slopes = [
        float(bench(apparatus, [1, k]).calibration["line"].sel(mode="gum", coefficient="slope"))
        for k in (0, 1, 0)
    ]
    assert slopes[0] == slopes[2] != slopes[1]
    assert slopes == pytest.approx([coverage.SLOPE] * 3, rel=0.03)


@pytest.mark.slow("many draws")
def test_stated_intervals_of_a_swing_hold_the_truth(apparatus):
    found = swings(apparatus, CASES["ar5"], 150, 7).set_index("quantity")
    assert {"natural frequency", "period", "quality", "decay time", "held-out end"} <= set(found.index)
    assert (found["high"] > 0.95).all()  # none is covered significantly less than it says


def test_intervals_that_leave_the_calibration_out_do_not(apparatus, monkeypatch):
    monkeypatch.setattr(coverage, "allowing", lambda fit, swings, slack: fit)
    found = swings(apparatus, CASES["together"], 20, 7).set_index("quantity")
    assert found.loc["natural frequency", "high"] < 0.5


@pytest.mark.slow("many draws")
def test_calibrations_hold_their_truth(apparatus):
    found = calibrations(apparatus, 100, 7).set_index("quantity")
    honest = found.drop("angle of a sample, mode paper")
    assert (honest["high"] > 0.95).all()


def test_limits_of_a_share_are_wilsons():
    row = table("case", {"a": [True] * 45 + [False] * 5}).iloc[0]
    assert (row["n"], row["inside"], row["share"]) == (50, 45, 0.9)
    assert (row["low"], row["high"]) == pytest.approx((0.7864, 0.9565), abs=2e-4)
    assert np.isclose(row["stated"], 0.95)
