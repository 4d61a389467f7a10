"""What is told of passages through a light gate, by the command, by the function and by the workflow."""

import numpy as np
import pandas as pd
import pytest

import swingdown
from swingdown.__main__ import main

NUMBER = np.arange(80)
NOISE = np.random.default_rng(4).standard_normal((2, 80))
T = 0.3 + 0.7123 * NUMBER + 0.03 * (NUMBER % 2) + 0.001 * NOISE[0]
SPEEDS = 1.5 * np.exp(-0.01 * NUMBER) + 0.005 * NOISE[1]


def test_times_alone_tell_the_period_and_that_damping_is_not_in_them():
    answer = swingdown.fit(T, kind="passages")
    value, error, unit = answer.quantities["period"]
    assert unit == "s" and abs(value - 1.4246) < 3 * error and error < 2e-4
    assert list(answer.quantities) == ["period"]
    assert "period" in answer._repr_html_() and "<img" not in answer._repr_html_()
    assert "damping is not in the data" in str(answer) and "times scatter by 1 ms" in str(answer)


def test_a_period_that_changes_is_told():
    longer = np.cumsum(0.7 + 1e-4 * NUMBER) + 1e-4 * NOISE[0]
    note = str(swingdown.fit(longer, kind="passages"))
    change = float(note.partition("the period changes by ")[2].partition("(")[0])
    assert change == pytest.approx(15.8, abs=1.5)  # ms: 79 half-swings, each 0.1 ms longer


def test_uncertainties_of_the_period_hold():
    draws = np.random.default_rng(11)
    pulls = []
    for _ in range(100):
        found = swingdown.fit(0.7 * NUMBER + 0.01 * draws.standard_normal(80), kind="passages").quantities[
            "period"
        ]
        pulls.append((found[0] - 1.4) / found[1])
    assert 0.8 < np.std(pulls) < 1.25


def test_speeds_tell_the_damping():
    answer = swingdown.fit(T, SPEEDS, kind="passages")
    value, error, _ = answer.quantities["decay_time"]
    assert abs(value - 71.23) < 3 * error and error < 1
    assert answer.label == "viscous"
    assert "natural_frequency" not in answer.quantities


def test_a_study_of_passages_ends_with_its_report(tmp_path, monkeypatch, snakemake):
    monkeypatch.chdir(tmp_path)
    pd.DataFrame({"t (s)": T}).round(4).to_csv("gate.csv", index=False)
    assert main(["gate.csv", "--quick"]) == 0
    study = tmp_path / "gate-swingdown"
    snakemake("--configfile", study / "study.yaml", directory=study)
    row = pd.read_csv(study / "results" / "tables" / "pendulums.csv").iloc[0]
    assert abs(row["period_s"] - 1.4246) < 3 * row["period_s_u"]
    report = (study / "results" / "report.html").read_text()
    assert (
        "Damping is not in the data" in report and "best" not in report.partition("Quantities, gate")[2][:300]
    )
