"""The sentence that answers what stops a pendulum, and the command's ways to say it: one number for one thing, each refusal once."""

import json
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from scipy.integrate import solve_ivp

import swingdown
from swingdown.__main__ import main
from swingdown.engine.trajectory import simulate
from swingdown.pendulum.model import Model
from swingdown.rounding import plus_minus
from swingdown.studies.doubt import NotFree
from swingdown.studies.words import headline

TIMES = np.arange(1501) / 100
FREQUENCY = {"natural_frequency": 7.25}
NOISE = 0.002 * np.random.default_rng(8).standard_normal(TIMES.size)
PENDULUMS = {
    "viscous": {"viscous_ratio": 0.008},
    "quadratic_drag": {"quadratic_coefficient": 0.04},
    "viscous+load_coulomb": {"viscous_ratio": 0.004, "load_friction": 0.004},
}


def swing(label, values, release=0.5):
    return simulate(Model(label, FREQUENCY | values), TIMES, release) + NOISE


def write(path, angle):
    pd.DataFrame({"Time (s)": TIMES, "Angle (rad)": angle}).to_csv(path, index=False)


@pytest.mark.parametrize(
    ("label", "words"),
    [
        ("viscous", "Air drag (viscous) stops it: T = "),
        ("quadratic_drag", "Air drag (quadratic) stops it: T = "),
        ("viscous+load_coulomb", "Air drag (viscous) and bearing friction stop it: T = "),
    ],
)
def test_the_sentence_names_what_stops_it_with_period_and_quality(label, words):
    found = swingdown.fit(TIMES, swing(label, PENDULUMS[label]))
    assert found.sentence.startswith(words)
    assert re.search(r"T = 0\.\d+\(\d+\) s, Q = \d+(\.\d+)?\(\d+(\.\d+)?\)\.$", found.sentence)
    assert str(found).splitlines()[0] == found.sentence


def test_where_nothing_is_missing_the_sentence_says_so():
    found = swingdown.explain(TIMES, swing("viscous", PENDULUMS["viscous"]), fitted=["viscous"])
    assert found.sentence.endswith(" Nothing else is needed.")


def test_of_a_wheel_on_a_spring_air_is_not_said_to_brake_it():
    truth = Model("viscous", FREQUENCY | PENDULUMS["viscous"], restoring="linear")
    found = swingdown.fit(TIMES, simulate(truth, TIMES, 0.5) + NOISE, unit="rad", restoring="linear")
    assert found.sentence.startswith("Viscous drag stops it: ")


def test_what_a_motor_keeps_going_is_not_said_to_be_stopped():
    found = swingdown.fit(TIMES, 0.3 * np.sin(7.0 * TIMES) + NOISE)
    assert found.sentence.startswith("What stops it cannot be told: it does not die away. T = 0.89")
    assert set(found.quantities) == {"period", "natural_frequency"}
    assert "drag" not in str(found) and "Q" not in found.sentence and "unit is in doubt" not in str(found)


@pytest.mark.parametrize("label", PENDULUMS)
def test_one_thing_has_one_number_in_sentence_table_picture_and_json(here, capsys, label):
    write(here / "a.csv", swing(label, PENDULUMS[label]))
    assert main(["a.csv", "--quick", "--json"]) == 0
    told = capsys.readouterr()
    (found,) = json.loads(told.out)["pendulums"]
    table = pd.read_csv(here / "a-swingdown" / "first_answer.csv").iloc[0]
    lines = {line.split("  ")[1].strip(): line for line in told.err.splitlines() if line.startswith("  ")}
    for column, symbol, words in (("period_s", "T", "period"), ("quality", "Q", "quality Q")):
        entry = found["quantities"][column.removesuffix("_s")]
        assert table[column] == pytest.approx(entry["value"], rel=1e-12)
        assert table[f"{column}_text"] == entry["text"]
        assert f"{symbol} = {entry['text']}" in found["sentence"]
        assert entry["text"] in next(line for key, line in lines.items() if key.startswith(words))
    assert found["sentence"] in told.err


def test_after_a_search_one_thing_has_one_number_too():
    """Where presliding was missing: sentence, lines, table, picture, and JSON tell the numbers of the model that the search ended with."""
    values = {"viscous_ratio": 0.004, "presliding_friction": 0.12, "presliding_angle": 0.006}
    times = np.arange(2000) / 100
    truth = Model("viscous+presliding", FREQUENCY | values)
    angles = simulate(truth, times, 0.5) + np.random.default_rng(3).normal(0, 1e-3, times.size)
    found = swingdown.explain(times, angles)
    content = found.to_dict()
    assert found.sentence.startswith(
        "Air drag (viscous) and friction that winds up before it slips (presliding) stop it: T = "
    )
    for name, symbol in (("period", "T"), ("quality", "Q")):
        text = str(found[name])
        assert f"{symbol} = {text}" in found.sentence and text in str(found)
        assert f"{symbol} = {text}" in found.plot().legends[0].get_title().get_text()
        assert (
            content["quantities"][name]["text"]
            == found.to_dataframe().loc[name, "text"]
            == text.removesuffix(" s")
        )
        assert content["verdict"]["conclusion"]["quantities"][name]["value"] == found[name].value
    told, (effect,) = found["presliding_angle"], content["verdict"]["effects"]
    assert found.model.values["presliding_angle"] == told.value
    entry = effect["parameters"]["presliding_angle"]
    assert (entry["value"], entry["standard_error"]) == (told.value, told.u)
    size = plus_minus(1e3 * told.value, 1e3 * told.u, "one")
    assert f"Presliding (angle {size} mrad)" in content["verdict"]["sentence"]


def test_a_model_that_holds_part_by_part_alone_has_the_values_of_its_parts():
    """A clock that loses 20 ms at the tenth swing: each part is a pendulum's, and the whole is none's."""
    times = np.arange(2000) / 100
    truth = Model("viscous", FREQUENCY | {"viscous_ratio": 0.004})
    angles = simulate(truth, np.where(times < 6, times, times + 0.02), 0.4)
    found = swingdown.explain(times, angles + np.random.default_rng(3).normal(0, 1e-3, times.size))
    assert abs(found["natural_frequency"].value - 7.25) < 2.5 * found["natural_frequency"].u < 0.003
    said = re.search(r"Fitted to the whole recordings the model leaves (\S+) times the noise: its values are those of the fitted swings\.", found.verdict["sentence"])  # fmt: skip
    assert said and 5 < float(said[1]) < 15
    assert said[0] in str(found)


def test_a_verdict_that_is_unknown_or_partial_does_not_claim_all(here):
    row = swingdown.fit(TIMES, swing("viscous", PENDULUMS["viscous"])).row
    assert headline(row, {"status": "unknown"}).startswith("What stops it is not established; air drag")
    assert headline(row | {"model_of": "search"}, {"status": "partial"}).endswith(
        "Something remains that has no name here."
    )


def test_json_is_all_of_stdout_and_a_refused_file_is_in_it(here, capsys):
    (here / "class").mkdir()
    write(here / "class" / "a.csv", swing("viscous", PENDULUMS["viscous"]))
    (here / "class" / "broken.csv").write_text("time,angle\n0,0.1\n0.1,lots\n0.2,0.3\n")
    assert main(["class", "--quick", "--json"]) == 0
    told = capsys.readouterr()
    found = json.loads(told.out)
    assert [one["pendulum"] for one in found["pendulums"]] == ["a"] and found["report"] is None
    assert "lots" in found["left_out"][0]["problem"] and found["left_out"][0]["mend"]
    assert found["read"][0]["taken"].startswith("took `Angle (rad)`") and "NOT USED" in told.err


@pytest.mark.parametrize("count", [1, 2])
def test_each_refusal_is_told_once(here, capsys, count):
    for k in range(count):
        (here / f"{k}.csv").write_text(f"time,angle\n0,0.1\n0.1,lots{k}\n0.2,0.3\n")
    with pytest.raises(SystemExit):
        main([f"{k}.csv" for k in range(count)] + ["--quick"])
    told = capsys.readouterr()
    assert [(told.out + told.err).count(f"lots{k}") for k in range(count)] == [1] * count


@pytest.mark.parametrize(
    ("given", "meant"),
    [
        (["a.csv", "--quikc"], "did you mean --quick?"),
        (["a.csv", "--tim-unit=ms"], "did you mean --time-unit?"),
        (["verfy", "results"], "did you mean swingdown verify?"),
        (["b.csv", "--quick"], "did you mean a.csv?"),
    ],
)
def test_what_is_mistyped_is_met_with_what_was_meant(here, capsys, given, meant):
    write(here / "a.csv", NOISE)
    with pytest.raises(SystemExit):
        main(given)
    assert meant in capsys.readouterr().err


def test_it_tells_its_version(capsys):
    with pytest.raises(SystemExit) as ended:
        main(["--version"])
    assert ended.value.code == 0
    assert re.fullmatch(r"swingdown \d+\.\d+\.\d+\n", capsys.readouterr().out)


def test_after_ctrl_c_there_is_one_line(here):
    """In the search, where a workflow and its jobs end too."""
    write(here / "a.csv", swing("viscous", PENDULUMS["viscous"]))
    command = [Path(sys.executable).with_name("swingdown"), "a.csv", "--cores", "1"]

    def hears_ctrl_c():
        """As in a terminal: what a shell starts in the background ignores it, and so would all that is started here."""
        signal.signal(signal.SIGINT, signal.default_int_handler)

    with subprocess.Popen(
        command, cwd=here, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, start_new_session=True, preexec_fn=hears_ctrl_c
    ) as running:  # fmt: skip
        assert running.stdout is not None
        for line in running.stdout:
            if "jobs to run" in line:
                break
        time.sleep(0.2)
        os.killpg(running.pid, signal.SIGINT)
        told = running.stdout.read()
    assert running.returncode == 130
    after = [line for line in told.splitlines() if line and not line.startswith("[")]
    assert after == ["stopped; the same command goes on with what is finished"]


def test_what_does_not_die_away_is_told_no_law_of_damping(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    times = np.arange(3000) / 100
    angle = 0.3 * np.cos(6 * times) + 1e-3 * np.random.default_rng(1).standard_normal(times.size)
    np.savetxt(
        "motor.csv", np.column_stack([times, angle]), delimiter=",", header="t_s,angle_rad", comments=""
    )
    assert main(["motor.csv", "--quick", "--into", "study"]) == 0
    told = capsys.readouterr()
    assert "it does not die away" in told.out and "Exponential" not in told.out + told.err
    assert not list((tmp_path / "study").glob("*.png"))


@pytest.mark.slow("a search")
@pytest.mark.parametrize(("gain", "start"), [(0.43, (0.3, 0.3)), (0.2, (0.3, 0.3)), (0.2, (2.0, 0.0))])
def test_what_keeps_itself_going_is_not_said_to_be_stopped_by_half_an_explanation(gain, start):
    """Van der Pol's oscillator: a shaken support does part of it, whose damping would give a quality of 0.6 or 3 to what swings on."""
    times = np.arange(0, 60, 0.02)
    exact = solve_ivp(
        lambda _, y: [y[1], -y[0] - gain * (y[0] ** 2 - 1) * y[1]], (0, 60), start, t_eval=times, rtol=1e-9
    ).y[0]
    readings = exact + np.random.default_rng(5).normal(0, 2e-3, times.size)
    try:
        answer = swingdown.explain(times, readings, unit="rad")
    except NotFree as refused:  # before it has grown a fit may find that it gains energy: no number is told
        assert start != (2.0, 0.0) and "gains energy" in refused.problem
        return
    assert answer.verdict["status"] in ("partial", "unknown")
    assert answer.sentence.startswith("What stops it cannot be told: it does not die away. T = 6.")
    period = answer.quantities["period"]
    assert abs(period.value - 2 * np.pi * (1 + gain**2 / 16)) < 3 * period.uncertainty
    assert not {"quality", "decay time", "viscous ratio"} & set(answer.quantities)


@pytest.mark.parametrize("seed", [1, 2])
def test_a_motor_whose_swing_no_law_of_damping_makes_gains_no_energy(seed):
    """A pure sine of 20°: a viscous drag that gives and a friction that takes would follow it a little better."""
    times = np.arange(0, 30, 0.02)
    angle = 20 * np.cos(6 * times) + 0.05 * np.random.default_rng(seed).standard_normal(times.size)
    found = swingdown.fit(times, np.radians(angle), unit="rad")
    assert "it does not die away" in found.sentence
    assert found["period"].value == pytest.approx(np.pi / 3, rel=1e-5)
