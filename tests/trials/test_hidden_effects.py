"""Hidden effects are named, foreign ones are called unknown, and nothing is found where nothing is: from files alone."""

import json
from dataclasses import replace

import pandas as pd
import pytest

from swingdown.errors import InputError
from swingdown.measurement.apparatus import read_apparatus
from swingdown.pendulum.catalogue import SHIPPED
from swingdown.pendulum.model import Model
from swingdown.pendulum.slack import Slack
from swingdown.plots.trials import detection
from swingdown_trials.find import find
from swingdown_trials.schedule import Planned, chunks, drawn, planned
from swingdown_trials.score import confusion, guard, read_scores, row, summarise
from swingdown_trials.second_pendulum import Runaway
from swingdown_trials.trial import BASE, USUAL, hideable, left_by_base, write_trial

SEED = 99  # not the seed of the scores in the README


def verdicts(folder, *trials, rounds=4, seed=SEED, apparatus=None):
    """The scorer's rows for trials written to files, found from the sheet, and held against the truth kept here."""
    rows, truths, lacks = [], {}, {}
    for number, one in enumerate(trials):
        trial, name = drawn(seed, one), f"c{number}"
        more, truths[name] = write_trial(trial, seed, name, folder, apparatus=apparatus)
        rows += more
        lacks |= {name: trial.hidden} if trial.kind == "removed" else {}
    pd.DataFrame(rows).to_csv(folder / "sheet.csv", index=False)
    found = find(folder / "sheet.csv", Model(BASE), rounds, lacks)
    return [row(name, truths[name], found[name]) for name in truths], found


@pytest.mark.slow("searches")
@pytest.mark.parametrize(
    ("hidden", "noise"),
    [
        ("quadratic_drag", "white"),
        ("cubic_stiffness", "coloured"),
        ("constant_torque", "steps"),
        ("base_vibration", "white"),
    ],
)
def test_one_hidden_effect_is_named(tmp_path, hidden, noise):
    ((one,), found) = verdicts(tmp_path, Planned("single", (hidden,), 2.0, noise, 0))
    assert one["inside"], (one, found["c0"]["verdict"]["sentence"])
    assert not one["wrong"]
    assert one["holdout_sigma"] < 1.06
    assert one["gap_after"] < 0.7 * one["gap_before"]
    assert one["separation"] > one["excess"]


@pytest.mark.slow("a search")
def test_a_fit_that_stopped_beside_the_best_minimum_asks_for_no_second_effect(tmp_path):
    """Friction makes minima side by side, and constant friction was told beside Stribeck's, which left 2 % too much."""
    one = Planned("single", ("stribeck",), 5.0, "coloured", 0)
    ((row,), _) = verdicts(tmp_path, one, seed=52631)
    assert row["exact"], row["named"]


@pytest.mark.slow("searches")
@pytest.mark.parametrize("noise", ["white", "coloured", "steps"])
def test_nothing_is_found_where_nothing_is_hidden(tmp_path, noise):
    rows, _ = verdicts(tmp_path, *(Planned("null", (), 1.0, noise, number) for number in range(3)))
    assert [one["status"] for one in rows] == ["consistent"] * 3


@pytest.mark.slow("searches")
def test_swings_of_a_pendulum_that_was_taken_down_are_given_their_own_frequencies(tmp_path):
    one = Planned("own", (), 1.0, "white", 0)
    ((row,), found) = verdicts(tmp_path, one)
    verdict = found["c0"]["verdict"]
    assert row["status"] == "consistent"
    true = {f"c0-{k}": own["natural_frequency"] for k, own in enumerate(drawn(SEED, one).own, 1)}
    assert verdict["own_frequency"] == pytest.approx(true, rel=2e-4)
    assert "differ in natural frequency" in verdict["sentence"]


@pytest.mark.slow("searches")
def test_a_calibration_that_is_as_wrong_as_it_says_is_no_missing_effect(tmp_path, root, monkeypatch):
    sheet = read_apparatus(root / "config/apparatus.yaml", check_files=False)
    one = Planned("calibrated", (), 1.0, "white", 12)
    ((row,), found) = verdicts(tmp_path, one, apparatus=sheet)
    assert row["status"] == "consistent"
    gain = found["c0"]["verdict"]["nuisance"]["sensor_gain"]
    assert abs(gain["value"]) < 2 * gain["before"]
    assert row["holdout_sigma"] < 1.06
    assert pd.read_csv(tmp_path / "c0-1.csv").columns.tolist() == ["t_s", "encoder_V"]
    # the same readings, taken for what they say
    monkeypatch.setattr("swingdown_trials.find.of_angles", lambda angles: Slack())
    ((row,), _) = verdicts(tmp_path, one, rounds=1, apparatus=sheet)
    assert row["alarm"]


def test_a_trial_in_volts_needs_an_apparatus(tmp_path):
    with pytest.raises(InputError, match="an apparatus sheet"):
        verdicts(tmp_path, Planned("calibrated", (), 1.0, "white", 0))


@pytest.mark.slow("a search")
def test_an_effect_that_the_catalogue_lacks_is_unknown_and_named_after_nothing_else(tmp_path):
    ((one,), found) = verdicts(tmp_path, Planned("removed", ("base_vibration",), 2.0, "white", 0), rounds=1)
    verdict = found["c0"]["verdict"]
    assert one["status"] == "unknown"
    assert one["excess"] > 100
    assert verdict["where"]["groups"]["line"]["share"] > 0.5
    assert "base_vibration" not in verdict["sentence"]


@pytest.mark.slow("a search")
def test_a_recording_that_the_import_refuses_is_left_out_and_told(tmp_path):
    rows, _ = write_trial(drawn(SEED, Planned("null", (), 1.0, "white", 0)), SEED, "c0", tmp_path)
    sheet = pd.DataFrame(rows).drop(columns="sha256")
    cut = pd.read_csv(sheet["file"][1])
    cut["theta_rad"] = cut["theta_rad"].clip(-0.2, 0.2)  # at a rail
    cut.to_csv(sheet["file"][1], index=False)
    sheet.to_csv(tmp_path / "sheet.csv", index=False)
    found = find(tmp_path / "sheet.csv", Model(BASE), 4)["c0"]
    assert found["verdict"]["status"] == "consistent"
    assert "saturated" in found["refused"]["c0-2"]
    assert len(found["refused"]) == 1


def test_the_truth_is_not_in_what_the_search_sees(tmp_path):
    trial = drawn(SEED, Planned("single", ("quadratic_drag",), 2.0, "white", 0))
    rows, truth = write_trial(trial, SEED, "c1", tmp_path)
    seen = json.dumps(rows) + "".join(path.name + path.read_text()[:200] for path in tmp_path.iterdir())
    assert "quadratic" not in seen
    assert truth["values"]["quadratic_coefficient"] > 0


def test_a_trial_is_the_same_however_often_it_is_drawn():
    one = Planned("single", ("cubic_stiffness",), 2.0, "white", 0)
    assert drawn(SEED, one) == drawn(SEED, one)
    assert drawn(SEED, one) != drawn(SEED + 1, one)


def test_a_pendulum_that_stops_before_it_has_swung_is_no_trial():
    trial = drawn(SEED, Planned("null", (), 1.0, "white", 0))
    for friction, swings in ((0.05, True), (6.0, False)):
        one = replace(trial, values=trial.values | {"constant_friction": friction})
        if swings:
            assert left_by_base(one, ("constant_coulomb",), SHIPPED) > 0
        else:
            with pytest.raises(Runaway):
                left_by_base(one, ("constant_coulomb",), SHIPPED)


def test_a_drag_told_in_the_power_two_is_quadratic_drag():
    truth = {"kind": "removed", "hidden": ["quadratic_drag"], "noise": "white", "ratio": 2.0, "reached": 2.0, "sigma": 1e-3,
             "values": {}, "noise_rms_rad": [1e-3] * 6, "samples": 2001}  # fmt: skip

    def wrong(exponent, error):
        values = {"power_law_coefficient": 0.02, "power_law_exponent": exponent}
        told = {"name": "power_law_drag", "tied_with": [],
                "parameters": {k: {"value": v, "standard_error": error, "unit": ""} for k, v in values.items()}}  # fmt: skip
        verdict = {"status": "named", "effects": [told], "stand_ins": [], "gap": {"holdout": [2.0, 1.0]}, "noise_rms_rad": 1e-3,
                   "moves": [], "model": {}}  # fmt: skip
        return row("c", truth, {"verdict": verdict, "fitted": ["c-1"], "rms_rad": {"power_law_drag": 1e-3}, "seconds": 1.0})["wrong"]  # fmt: skip

    assert not wrong(2.04, 0.02)
    assert wrong(2.9, 0.02)
    assert wrong(1.0, 0.02)  # viscous, which is not hidden


def test_a_drift_is_held_against_the_part_of_the_record_that_is_used():
    truth = {"kind": "single", "hidden": ["damping_drift"], "noise": "white", "ratio": 2.0, "reached": 2.0, "sigma": 1e-3,
             "values": {"damping_drift": 0.04, "viscous_ratio": 0.01}, "noise_rms_rad": [1e-3] * 6, "samples": 2001,
             "design": list(USUAL)}  # fmt: skip
    told = {"name": "damping_drift", "tied_with": []}
    model = {"damping_drift": 0.03, "viscous_ratio": 0.01}
    verdict = {"status": "named", "effects": [told], "stand_ins": [], "gap": {"holdout": [2.0, 1.0]}, "noise_rms_rad": 1e-3,
               "moves": [], "model": {name: {"value": value, "standard_error": 1e-4} for name, value in model.items()}}  # fmt: skip
    found = {"verdict": verdict, "fitted": ["c-1"], "rms_rad": {"damping_drift": 1e-3}, "seconds": 1.0}
    assert (
        row("c", truth, found | {"duration_s": 15.0})["covered"] == 2
    )  # of 20 s, the last five of them at rest
    assert row("c", truth, found | {"duration_s": 20.0})["covered"] == 1


def test_every_effect_is_hidden_at_every_size_and_chunks_hold_each_trial_once():
    settings = {
        "effects": [],
        "sizes": [1.3, 2, 5],
        "repeats": 1,
        "removed": True,
        "pairs": True,
        "foreign": True,
        "nulls": 30,
        "own_frequencies": 3,
        "calibrated": 2,
        "chunk": 7,
    }
    trials = planned(settings)
    assert sum(one.kind == "single" for one in trials) == 3 * len(hideable(SHIPPED))
    assert {one.noise for one in trials if one.kind == "null"} == {"white", "coloured", "steps"}
    assert [one for part in chunks(settings).values() for one in part] == trials


def scored(**changes):
    return {"kind": "single", "hidden": "viscous", "noise": "white", "ratio": 2.0, "status": "named", "named": "viscous", "exact": True, "inside": True,
            "wrong": False, "alarm": True, "right": True, "holdout_sigma": 1.0, "excess": 500.0, "separation": 400.0, "covered": 3, "intervals": 3, "seconds": 1.0} | changes  # fmt: skip


def test_the_summary_counts_misses():
    rows = [
        scored(),
        scored(inside=False, exact=False, wrong=True, named="quadratic_drag"),
        scored(kind="null", alarm=True),
        scored(kind="null", alarm=False),
    ]
    table = summarise(pd.DataFrame(rows)).set_index("figure")
    assert table.loc["named exactly", "value"] == 0.5
    assert table.loc["a wrong name", "value"] == 0.5
    assert table.loc["false alarms where nothing is hidden", "value"] == 0.5
    limit = 1 - 0.975**0.5  # of one in two, by Clopper and Pearson
    assert table.loc["a wrong name", ["low", "high"]].tolist() == pytest.approx([limit, 1 - limit])


def test_naming_exactly_is_asked_only_where_no_other_effect_does_as_well():
    rows = [
        scored(),
        scored(exact=False),
        scored(exact=False, separation=20.0),
        scored(exact=False, separation=float("nan")),
    ]
    one = (
        summarise(pd.DataFrame(rows))
        .set_index("figure")
        .loc["named exactly, where every other effect fails by more than 25"]
    )
    assert one["n"] == 3
    assert one["value"] == pytest.approx(1 / 3)


def test_the_guard_tells_the_false_alarms_that_were_counted():
    told = guard(pd.DataFrame([scored(), scored(kind="null", alarm=True), scored(kind="null", alarm=False)]))
    assert (told["nulls"], told["false_alarms"]) == (2, 1)
    assert set(told) == {"probable", "share", "held_out", "clear", "ties", "nulls", "false_alarms"}


def test_campaigns_with_nothing_hidden_are_there_when_scores_are_read_again_and_drawn(tmp_path):
    pd.DataFrame([scored(), scored(kind="null", named="", alarm=False)]).to_csv(
        tmp_path / "scores.csv", index=False
    )
    again = read_scores(tmp_path / "scores.csv")
    assert again["kind"].tolist() == ["single", "null"]
    figure = detection(again)
    assert any("0 of 1" in text.get_text() for axes in figure.axes for text in axes.texts)


def test_the_confusion_matrix_tells_what_was_said_instead():
    rows = [
        scored(),
        scored(inside=False, named="quadratic_drag"),
        scored(inside=False, status="unknown", named=""),
    ]
    matrix = confusion(pd.DataFrame(rows))
    assert matrix.loc["viscous", ["viscous", "quadratic_drag", "unknown"]].tolist() == pytest.approx(
        [1 / 3] * 3
    )
