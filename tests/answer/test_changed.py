"""One thing changed between the recordings of one pendulum: from a folder whose names say it to the effect that follows."""

import json

import numpy as np
import pandas as pd
import pytest

from swingdown.__main__ import main
from swingdown.engine.trajectory import simulate
from swingdown.errors import InputError
from swingdown.pendulum.model import Model
from swingdown.planning.plan import plan
from swingdown.planning.settings import complete

TIMES = np.arange(0, 20, 0.02)  # s
CURRENTS = (0.1, 0.2, 0.3, 0.4)  # A


@pytest.fixture
def wheel(tmp_path, monkeypatch):
    """A folder with four recordings of a wheel whose brake had another current in each."""
    monkeypatch.chdir(tmp_path)
    draws = np.random.default_rng(8)
    for current in CURRENTS:
        values = {
            "natural_frequency": 3.2,
            "viscous_ratio": 0.002 + 0.3 * current**2,
            "constant_friction": 0.05,
        }
        model = Model("viscous+constant_coulomb", values, restoring="linear")
        angle = simulate(model, TIMES, 2.0) + 1e-3 * draws.standard_normal(TIMES.size)
        path = tmp_path / "wheel" / f"{1000 * current:.0f}mA.csv"
        path.parent.mkdir(exist_ok=True)
        pd.DataFrame({"t (s)": TIMES, "angle (rad)": angle}).round(5).to_csv(path, index=False)
    return tmp_path / "wheel"


def sheet(folder):
    return pd.read_csv(folder / "recordings.csv", dtype=str).set_index("recording")


def test_what_the_names_say_was_changed_stands_in_the_sheet(wheel, capsys):
    assert main(["wheel", "--together", "--by", "current", "--restoring", "linear", "--quick"]) == 0
    told = capsys.readouterr().out
    assert "current was changed between the recordings" in told
    assert "What stops it" not in told
    rows = sheet(wheel.parent / "wheel-swingdown")
    assert set(rows["changed"]) == {"current_A"}
    assert rows["changed_value"].to_dict() == {f"{1000 * one:.0f}mA": f"{one:g}" for one in CURRENTS}


def test_recordings_of_several_pendulums_are_no_change_of_one(wheel):
    assert main(["wheel", "--by", "current", "--restoring", "linear", "--quick"]) == 0
    assert "changed" not in sheet(wheel.parent / "wheel-swingdown")


@pytest.mark.slow("a search")
def test_the_verdict_tells_what_follows_the_current_and_draws_it(wheel):
    assert main(["wheel", "--together", "--by", "current", "--restoring", "linear"]) == 0
    results = wheel.parent / "wheel-swingdown" / "results"
    found = json.loads((results / "discovery/pendulum/verdict.json").read_text())
    told = found["difference"]
    assert (told["quantity"], told["effect"], told["tied_with"]) == ("current_A", "viscous", [])
    assert told["exponent"] == pytest.approx(2, abs=3 * told["exponent_standard_error"])
    assert [one["value"] for one in told["sizes"]] == list(CURRENTS)
    assert found["status"] == "consistent"
    assert found["sentence"].startswith("Viscous follows the current (P > 0.999): it goes as its power 2.0")
    assert (results / "discovery/pendulum/figures/difference.svg").exists()
    assert "What follows the change" in (results / "report.html").read_text()


def test_a_campaign_in_which_some_recordings_do_not_say_it_is_refused(wheel, monkeypatch):
    main(["wheel", "--together", "--by", "current", "--restoring", "linear", "--quick"])
    folder = wheel.parent / "wheel-swingdown"
    rows = sheet(folder)
    rows.loc["200mA", "changed_value"] = ""
    rows.to_csv(folder / "recordings.csv")
    monkeypatch.chdir(folder)
    with pytest.raises(InputError, match="200mA.*changed_value"):
        plan(complete({"recordings": str(folder / "recordings.csv")}))
