"""One bad recording among good ones: the study goes on without it, says so, and takes it in once it is mended."""

import json
import shutil

import numpy as np
import pandas as pd
import pytest

import swingdown
from swingdown import dataset, sealed
from swingdown.__main__ import main
from swingdown.engine.trajectory import simulate
from swingdown.errors import InputError
from swingdown.pendulum.model import Model, everyday
from swingdown.studies.left_out import OF_ALL, OF_SEARCH, last_words, left_out

TIMES = np.arange(501) / 50
TRUTH = Model("viscous", {"natural_frequency": 7.25, "viscous_ratio": 0.008})
REASONS = {
    "text": "line 3, column angle_rad: 1 of 3 cells hold no finite number",
    "grown": "its swings grow",
    "short": "too few swings to fit",
    "hand": "it does not move as a pendulum that swings by itself",
}
# Two campaigns of the same two good swings, `some` with bad ones of all kinds, a record at rest and such as hold no angle among them.
# Campaigns of one recording: `lost` a bad one, `brief` too short for a search, `moved` by a hand, `soft` under a spring that damping does not explain, `kicked` on its way.
ALONE = {"counts": "no scale", "volts": "no scale", "peaks": "points of the motion only"}
ROWS = [
    "recording,campaign,file,role",
    "some-1,some,one.csv,",
    "some-2,some,two.csv,",
    *(f"{kind}-3,some,{kind}.csv," for kind in (*REASONS, *ALONE)),
    "rest-3,some,words.csv,static",
    "whole-1,whole,one.csv,",
    "whole-2,whole,two.csv,",
    "lost,lost,text.csv,",
    "brief,brief,brief.csv,",
    "moved,moved,hand.csv,",
    "soft,soft,soft.csv,",
    "kicked,kicked,kicked.csv,",
]
CONFIG = "recordings: sheet.csv\nsimulation: {simulated: []}\ndiscovery: {rounds: 1}\n"


def series():
    """(times, angles) of each file by name."""
    noise = 0.002 * np.random.default_rng(7).standard_normal((4, TIMES.size))
    one, two, three = (
        simulate(TRUTH, TIMES, angle) + more for angle, more in zip((0.3, 0.2, 0.4), noise, strict=False)
    )
    held = 1 + 0.4 * np.sin(2.3 * TIMES)  # a hand changes how far it swings, and when
    hand = 0.3 * held * np.exp(-0.02 * TIMES) * np.sin(7 * TIMES + 2 * np.sin(1.3 * TIMES)) + noise[3]
    return {
        "one": (TIMES, one), "two": (TIMES, two), "three": (TIMES, three), "grown": (TIMES, three[::-1]), "hand": (TIMES, hand),
        "short": (TIMES[:35], three[:35]), "brief": (TIMES[:95], three[:95]), "soft": softening(), "kicked": kicked(),
    }  # fmt: skip


def kicked():
    """(times, angles) of a swing that is kicked at 6.5 s, and free from there on."""
    times = np.arange(0, 30, 0.02)
    late = times >= 6.5
    size = np.where(late, 0.3, 0.08) * np.exp(-np.where(late, times - 6.5, times) / 10)
    return times, size * np.sin(2 * np.pi * times / 1.3)


def softening():
    """(times, angles) under a spring that softens so much that a pendulum's period is wrong by whole swings."""
    values = {"natural_frequency": 6.2, "viscous_ratio": 0.004, "quadratic_stiffness": -10.0}
    times = np.arange(0, 60, 0.05)
    exact = simulate(Model("viscous+quadratic_stiffness", values), times, 1.2)
    return times, exact + 0.002 * np.random.default_rng(1).standard_normal(times.size)


@pytest.fixture
def files(tmp_path):
    """A folder with the recordings."""
    return recorded(tmp_path)


def recorded(folder):
    for name, columns in series().items():
        rows = [f"{time:.2f},{angle:.5f}" for time, angle in zip(*columns, strict=True)]
        (folder / f"{name}.csv").write_text("\n".join(["time_s,angle_rad", *rows, ""]))
    times, angles = series()["two"]
    for name, column in (("counts", "adc"), ("volts", "U (V)")):
        pd.DataFrame({"t_ms": 1e3 * times, column: np.round(512 + 900 * angles)}).to_csv(
            folder / f"{name}.csv", index=False
        )
    each = np.arange(12) * np.pi / 7.25
    peaks = 11.5 * (-1) ** np.arange(12) * np.exp(-0.008 * 7.25 * each)
    pd.DataFrame({"time_s": each, "angle_deg": peaks}).round(3).to_csv(folder / "peaks.csv", index=False)
    for name in ("text", "words"):
        (folder / f"{name}.csv").write_text("time_s,angle_rad\n0,0.1\n0.01,lots\n0.02,0.3\n")
    return folder


def sheet(folder, rows):
    (folder / "sheet.csv").write_text("\n".join([*rows, ""]))
    (folder / "mine.yaml").write_text(CONFIG + f"experiment: {{fitted: [{', '.join(everyday())}]}}\n")
    return "--configfile", folder / "mine.yaml"


@pytest.fixture(scope="module")
def study(snakemake, tmp_path_factory):
    """The folder of a study with bad recordings, and what the run printed."""
    folder = recorded(tmp_path_factory.mktemp("study"))
    done = snakemake(*sheet(folder, ROWS), directory=folder)
    return folder, done.stdout


def verdict(folder, campaign):
    return json.loads((folder / "results/discovery" / campaign / "verdict.json").read_text())


@pytest.mark.slow("a whole study")
def test_a_campaign_goes_on_with_the_recordings_that_can_be_used(study):
    folder, _ = study
    found, whole = verdict(folder, "some"), verdict(folder, "whole")
    for key in ("status", "effects", "gap", "model", "noise_rms_rad", "conclusion", "probabilities"):
        assert found[key] == whole[key], key
    assert found["recordings"] == ["some-1", "some-2"]
    lost = {one["recording"]: one["problem"] for one in found["left_out"]}
    reasons = {f"{kind}-3": reason for kind, reason in (REASONS | ALONE | {"rest": REASONS["text"]}).items()}
    assert lost.keys() == reasons.keys() and all(reasons[one] in lost[one] for one in lost)
    table = pd.read_csv(folder / "results/tables/pendulums.csv").set_index(["campaign", "recording"])
    same = ["period_s", "period_s_u", "quality", "natural_frequency_rad_per_s", "model", "verdict"]
    assert table.loc[("some", "(joint)"), same].equals(table.loc[("whole", "(joint)"), same])


@pytest.mark.slow("a whole study")
@pytest.mark.parametrize("kind", ALONE)
def test_what_holds_no_angle_has_a_period_and_a_decay_beside_angles(study, kind):
    row = pd.read_csv(study[0] / "results/tables/pendulums.csv").set_index("recording").loc[f"{kind}-3"]
    assert row["period_s"] == pytest.approx(2 * np.pi / 7.25, rel=0.01)
    assert row["quality"] == pytest.approx(1 / 0.016, rel=0.1)
    assert ALONE[kind] in row["remark"] and np.isnan(row["verdict"])


@pytest.mark.slow("a whole study")
def test_the_free_stretch_of_what_no_model_follows_is_used_as_by_the_command(study):
    folder, _ = study
    table = pd.read_csv(folder / "results/tables/pendulums.csv").set_index("recording")
    assert "USED FROM 6.5" in table.loc["kicked", "remark"]
    assert table.loc["kicked", "period_s"] == pytest.approx(1.3, rel=5e-3)
    assert dataset.read(folder / "results/angles/kicked.nc")["time"].values[0] > 6.4
    (used,) = swingdown.read(folder / "kicked.csv").fit().swings
    assert used["time"].size == dataset.read(folder / "results/angles/kicked.nc")["time"].size


@pytest.mark.slow("a whole study")
def test_the_run_its_table_and_the_report_tell_each_with_its_reason(study):
    folder, told = study
    last = told[told.index("Left out of these results") :]
    report = (folder / "results/report.html").read_text()
    table = pd.read_csv(folder / "results/tables/left_out.csv").set_index("recording")
    assert set(table.index) == {
        *(f"{kind}-3" for kind in (*REASONS, *ALONE, "rest")), "lost", "brief", "moved",
    }  # fmt: skip
    for kind, reason in REASONS.items():
        assert reason in table.loc[f"{kind}-3", "problem"] and table.loc[f"{kind}-3", "mend"]
        assert f"{kind}-3: " in last and reason in last and reason in report
    assert "7 recordings were left out: " in report


@pytest.mark.slow("a whole study")
def test_a_campaign_without_a_search_is_told_and_stops_no_other(study):
    folder, _ = study
    table = pd.read_csv(folder / "results/tables/pendulums.csv").set_index("recording")
    for name, reason in (("lost", REASONS["text"]), ("brief", "3 half-swings")):
        found = verdict(folder, name)
        assert found["status"] == "no_verdict" and found["effects"] == []
        assert reason in found["sentence"] and reason in table.loc[name, "remark"]
    assert table.loc["brief", "period_s"] == pytest.approx(0.875, abs=0.002)  # it is fitted all the same
    assert np.isnan(table.loc["lost", "period_s"]) and table.loc["lost", "verdict"] == "refused"


@pytest.mark.slow("a whole study")
def test_where_no_swing_is_free_the_search_goes_first(study):
    """What damping does not follow has a name in one campaign, and none in the other."""
    folder, _ = study
    soft, moved = verdict(folder, "soft"), verdict(folder, "moved")
    assert [one["name"] for one in soft["effects"]] == ["quadratic_stiffness"]
    assert soft["recordings"] == ["soft"] and soft["left_out"] == []
    assert moved["status"] == "no_verdict" and moved["recordings"] == []
    assert REASONS["hand"] in moved["sentence"] and moved["left_out"][0]["recording"] == "moved"
    table = pd.read_csv(folder / "results/tables/pendulums.csv").set_index("recording")
    assert table.loc["soft", "natural_frequency_rad_per_s"] == pytest.approx(6.2, abs=0.002)
    assert np.isnan(table.loc["moved", "period_s"]) and table.loc["moved", "verdict"] == "refused"
    assert "moved" not in set(pd.read_csv(folder / "results/tables/parameters.csv")["recording"])


@pytest.mark.slow("a whole study")
def test_what_stands_for_a_bad_recording_yields_no_number(study):
    folder, _ = study
    for name in ("recordings/text-3", "angles/text-3", "experiment/fits/short-3", "discovery/lost/first/fit"):
        with pytest.raises(InputError, match=REASONS["short" if "short" in name else "text"].split(": ")[-1]):
            dataset.read(folder / "results" / f"{name}.nc")
    assert main(["verify", str(folder / "results")]) == 0


@pytest.mark.slow("a whole study")
def test_once_mended_it_takes_part(study, snakemake, tmp_path):
    folder = shutil.copytree(study[0], tmp_path / "study")
    shutil.copy(folder / "three.csv", folder / "text.csv")
    snakemake("discover", "--configfile", folder / "mine.yaml", directory=folder)
    found = verdict(folder, "some")
    assert found["recordings"] == ["some-1", "some-2", "text-3"]
    still = {f"{kind}-3" for kind in ({*REASONS} - {"text"}) | {*ALONE, "rest"}}
    assert {one["recording"] for one in found["left_out"]} == still
    assert verdict(folder, "lost")["status"] == "consistent"
    lost = set(pd.read_csv(folder / "results/tables/left_out.csv")["recording"])
    assert lost == {*still, "brief", "moved"}


@pytest.mark.slow("a whole study")
def test_the_command_leaves_out_the_same_for_the_same_reasons(study, files, monkeypatch, capsys):
    monkeypatch.chdir(files)
    bad = [f"{kind}.csv" for kind in REASONS]
    assert (
        main(["one.csv", "two.csv", *bad, "--together", "--quick", "--zero-tolerance", "0", "--into", "mine"])
        == 0
    )
    by_command = pd.read_csv(files / "mine/left_out.csv").set_index("recording")["problem"]
    by_sheet = pd.read_csv(study[0] / "results/tables/left_out.csv").set_index("recording")["problem"]
    assert set(by_command.index) == set(REASONS)
    for kind in REASONS:
        assert by_command[kind] == by_sheet[f"{kind}-3"]
    table = pd.read_csv(files / "mine/first_answer.csv").set_index("recording")
    whole = pd.read_csv(study[0] / "results/tables/pendulums.csv").set_index("recording")
    assert table.loc["one", "period_s"] == pytest.approx(whole.loc["whole-1", "period_s"], rel=1e-12)


@pytest.mark.slow("runs of the workflow")
@pytest.mark.parametrize(
    ("rows", "words"),
    [
        (["a,x,text.csv", "b,y,grown.csv"], "none of 2 recordings can be used; the first, a (text.csv)"),
        (["a,x,one.csv", "b,x,file:///nowhere/b.csv"], "file:///nowhere/b.csv cannot be read"),
        (["a,x,one.csv", "b,x,nowhere.csv"], "nowhere.csv"),
    ],
)
def test_a_study_of_nothing_and_a_file_that_is_not_there_are_errors(files, snakemake, rows, words):
    """A file out of reach may be there the next time, so nothing is written in its place."""
    done = snakemake(
        "discover", *sheet(files, ["recording,campaign,file", *rows]), directory=files, check=False
    )
    assert done.returncode and words in done.stdout and "Traceback" not in done.stdout
    assert (files / "results/recordings/b.nc").exists() is ("grown" in rows[1])
    assert not (files / "results/tables/left_out.csv").exists()


def test_what_the_command_left_out_before_is_told_beside(tmp_path):
    """Of two that it tells of, one is in the study and was only not searched."""
    columns = {
        "recording": ["bad", 7],
        "file": ["bad.csv", "7.csv"],
        "problem": ["no numbers", "5 half-swings"],
    }
    table = left_out([], before=pd.DataFrame(columns), members={"7", "good"}).set_index("recording")
    assert table["left_out_of"].to_dict() == {"bad": "everything", 7: "the search"}
    assert table.loc["bad", "problem"] == "no numbers"


def test_a_run_ends_with_what_it_left_out_also_where_no_mend_is_known(tmp_path):
    path = tmp_path / "left_out.csv"
    rows = {
        "recording": ["a", "b"],
        "left_out_of": [OF_ALL, OF_SEARCH],
        "problem": "it is too short",
        "mend": "",
    }
    sealed.write_csv(pd.DataFrame(rows), path)
    said = last_words(path)
    assert (
        "a: it is too short\n" in said and "b: not searched: it is too short\n" in said and "Mend" not in said
    )
    sealed.write_csv(pd.DataFrame(rows | {"mend": "record longer"}), path)
    assert "a: it is too short. Mend: record longer" in last_words(path)
    sealed.write_csv(pd.DataFrame(rows).head(0), path)
    assert last_words(path) == last_words(tmp_path / "none.csv") == ""
