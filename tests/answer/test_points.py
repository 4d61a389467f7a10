"""What is told of turning points alone, by the command and by the function."""

import json

import numpy as np
import pandas as pd
import pytest
from turning import turning_points

import swingdown
from swingdown.__main__ import main
from swingdown.errors import InputError
from swingdown.studies.described import described, over_laws

VALUES = {"natural_frequency": 4.4, "viscous_ratio": 0.004}
TIMES, ANGLES = turning_points(VALUES, 0.6, 80)
SCATTER = np.random.default_rng(3).standard_normal((2, 80))
T, A = TIMES + 1 + 0.01 * SCATTER[0], ANGLES + 0.002 * SCATTER[1]


def test_the_command_tells_period_law_and_what_is_not_in_the_data(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    table = pd.DataFrame({"t (s)": T[::2], "amplitude (°)": np.degrees(A[::2])})
    table.round(3).to_csv("peaks.csv", index=False)
    assert main(["peaks.csv", "--quick"]) == 0
    told = capsys.readouterr().out
    assert told.startswith(
        "peaks.csv: took `amplitude (°)` as turning points, one a period, in degrees, `t (s)` as s"
    )
    for words in (
        "damping            viscous",
        "small swings take 1.42",
        "as weight makes it",
        "amplitudes scatter by 2",
        "times by",
    ):
        assert words in told
    assert told.count("what a torque does between them is not in the data") == 1
    row = pd.read_csv("peaks-swingdown/first_answer.csv").iloc[0]
    for column, value in (("natural_frequency_rad_per_s", 4.4), ("viscous_ratio", 0.004)):
        assert abs(row[column] - value) < 3 * row[f"{column}_u"]


def test_the_kind_that_is_said_settles_it(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    pd.DataFrame({"t": T, "amplitude": np.abs(np.degrees(A))}).round(3).to_csv("peaks.csv", index=False)
    assert main(["peaks.csv", "--quick", "--kind", "half_swings"]) == 0
    row = pd.read_csv("peaks-swingdown/first_answer.csv").iloc[0]
    assert row["natural_frequency_rad_per_s"] == pytest.approx(4.4, abs=0.005)


def test_laws_that_cannot_be_told_apart_are_named_and_widen_what_is_told():
    few = swingdown.fit(T[:12], A[:12])
    sentence, *rest = str(few).splitlines()
    assert "the data do not distinguish" in str(few)
    assert " or " in sentence.partition(" stops it")[0]
    assert any(line.startswith("damping") and " or " in line for line in rest)
    assert any("if it is" in line for line in rest if "coefficient" in line or "ratio" in line)
    alone = described(few.fits.isel(recording=0), few.label)[1]["decay_time"]
    value, error, _ = few.quantities["decay_time"]
    assert error > 1.2 * alone.uncertainty
    sure = over_laws(few.fits.isel(recording=0), {few.label: 1.0}, few.row["amplitude_rad"])["decay_time"]
    assert sure == pytest.approx(alone)  # of a law that is sure its own


def test_many_points_tell_one_law():
    many = swingdown.fit(T, A)
    # the same share of every swing: no amplitude tells bent material from viscous drag
    assert many.label == "viscous" and many.row["or_model"] == "structural_damping"


def test_a_count_has_its_decay_in_swings_and_no_period(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    pd.DataFrame({"swing": np.arange(40), "amplitude (cm)": 100 * np.abs(A[::2])}).round(1).to_csv(
        "n.csv", index=False
    )
    assert main(["n.csv", "--quick"]) == 0
    told = capsys.readouterr().out
    assert "decay in swings" in told and "cm" in told
    assert "period  " not in told and "frequency" not in told and " s " not in told.partition("\n\n")[2]
    row = pd.read_csv("n-swingdown/first_answer.csv").iloc[0]
    # e-folds of exp(-zeta omega t), in swings
    assert row["decay_swings"] == pytest.approx(1 / (2 * np.pi * 0.004), rel=0.05)


def test_arrays_are_taken_alike():
    answer = swingdown.fit(T, A)
    value, error, unit = answer.quantities["natural_frequency"]
    assert unit == "rad/s" and abs(value - 4.4) < 3 * error
    assert "taken as turning points, each half-swing" in answer.remarks[0]
    with pytest.raises(InputError, match="argument kind"):
        swingdown.fit(T, A, kind="peaks")


def test_no_verdict_is_given_on_torques():
    with pytest.raises(InputError, match="what a torque does between them is not in the data"):
        swingdown.explain(T, A)


def test_a_study_of_turning_points_ends_with_its_report_and_no_verdict(tmp_path, monkeypatch, snakemake):
    monkeypatch.chdir(tmp_path)
    pd.DataFrame({"t (s)": T, "angle (rad)": A}).round(4).to_csv("both.csv", index=False)
    assert main(["both.csv", "--quick"]) == 0
    study = tmp_path / "both-swingdown"
    snakemake("--configfile", study / "study.yaml", directory=study)
    row = pd.read_csv(study / "results" / "tables" / "pendulums.csv").iloc[0]
    assert abs(row["natural_frequency_rad_per_s"] - 4.4) < 3 * row["natural_frequency_rad_per_s_u"]
    assert "what a torque does between them is not in the data" in row["remark"]
    assert (
        "what a torque does between them is not in the data"
        in (study / "results" / "report.html").read_text()
    )
    found = json.loads((study / "results/discovery/both/verdict.json").read_text())
    assert found["status"] == "no_verdict" and "rad_per_s" not in json.dumps(found)
