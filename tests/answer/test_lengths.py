"""g at the command line: from the length that is typed beside the file."""

import json

import numpy as np
import pandas as pd
import pytest
from exporting import export

from swingdown.__main__ import main
from swingdown.errors import InputError

THIRTY = np.radians(30)  # the period is 2 % longer than that of small swings


def test_a_length_gives_g_with_its_budget(here, capsys):
    export(here / "anna.csv", np.sqrt(9.81 / 0.583), THIRTY)
    assert main(["anna.csv", "--quick", "--length", "58.3±0.1cm"]) == 0
    told = capsys.readouterr().out
    assert "g                  9.81" in told and "of a point on a string without mass" in told
    row = pd.read_csv(here / "anna-swingdown/first_answer.csv").iloc[0]
    assert abs(row["g_m_per_s2"] - 9.81) < 0.003  # 2 % of the period would be 0.4
    assert row["g_m_per_s2_u"] == pytest.approx(9.81 / 583, rel=0.02)
    budget = pd.read_csv(here / "anna-swingdown/g_budget.csv").set_index("quantity")
    assert budget.loc["length", "contribution_m_per_s2"] == pytest.approx(9.81 / 583, rel=0.001)
    assert budget.loc["factor for the amplitude of 30°", "value"] == pytest.approx(1.0352, abs=2e-4)
    assert json.loads((here / "anna-swingdown/g.json").read_text())["anna"]["unit"] == "m/s^2"


def test_a_length_without_an_uncertainty_gives_g_to_the_digits_that_all_else_leaves(here, capsys):
    """In the line, the table, the JSON of both and the row of many alike, with the words that the length's own is not known."""
    export(here / "anna.csv", np.sqrt(9.81 / 0.583), THIRTY)
    assert main(["anna.csv", "--quick", "--length", "0.583", "--json"]) == 0
    found, told = json.loads(capsys.readouterr().out), {}
    one = found["g"]["anna"]
    part = one["standard_uncertainty_without_length"]
    told["g"], told["quantity"] = one["text"], found["pendulums"][0]["quantities"]["g"]["text"]
    assert one["standard_uncertainty"] is None and 1e-4 < part < 1e-2
    told["table"] = pd.read_csv(here / "anna-swingdown/first_answer.csv").iloc[0]["g_m_per_s2_text"]
    assert main(["anna.csv", "--quick", "--length", "0.583", "--lang", "fr", "--latex"]) == 0
    line = next(one for one in capsys.readouterr().out.split("\n") if one.startswith("  g "))
    told["line"] = line.split()[1].replace(",", ".")
    (text,) = set(told.values())
    digits = text.removesuffix("(?)").partition(".")[2]
    assert len(digits) == -int(np.floor(np.log10(part))) and abs(float(text[:-3]) - 9.81) < 0.003
    assert "l'incertitude de la longueur n'a pas été donnée" in line
    assert text.replace(".", ",") in (here / "anna-swingdown/answer.tex").read_text()


def test_a_rod_about_two_pivots(here, capsys):
    for name, distance in (("near.csv", 0.2), ("far.csv", 0.5)):
        export(here / name, np.sqrt(9.81 * distance / (1 / 12 + distance**2)), THIRTY)
    assert main(["near.csv", "far.csv", "--quick", "--kater", "0.2000(2)", "0.5000(2)"]) == 0
    found = json.loads((here / "near-swingdown/g.json").read_text())["two pivots"]
    assert abs(found["value"] - 9.81) < 2 * found["standard_uncertainty"] < 0.1
    assert "of a rigid body about two pivots" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("typed", "where"),
    [
        (("--length", "58kg"), "--length"),
        (("--bob-density", "heavy"), "--bob-density"),
        (("--kater", "0.2", "0.5"), "--kater"),
        (("--bob-diameter", "-3cm"), "'-3cm' is no bob diameter"),
    ],
)
def test_what_is_typed_wrongly_is_refused_before_anything_is_read(here, typed, where, capsys):
    export(here / "anna.csv", 4.0)
    with pytest.raises((InputError, SystemExit)):
        main(["anna.csv", "--quick", *typed])
    printed = capsys.readouterr()
    assert where in printed.err and "took" not in printed.out and not (here / "anna-swingdown").exists()
