"""One command from files to an answer: what a newcomer types in a folder with nothing but their exports."""

import csv
import os
import subprocess
import sys
import zipfile
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import yaml
from exporting import TIMES, export

import swingdown
from swingdown.__main__ import main
from swingdown.engine.trajectory import simulate
from swingdown.measurement.sheet import read_sheet
from swingdown.pendulum.model import Model
from swingdown.planning import own


def test_a_file_gives_its_first_answer_and_a_study_beside_it(here, capsys):
    export(here / "anna.csv")
    assert main(["anna.csv", "--quick"]) == 0
    told = capsys.readouterr().out
    assert "anna.csv: took `Angle (°)` as degrees" in told and "1001 samples" in told
    for words in ("period", "natural frequency", "quality Q", "decay time (1/e)", "viscous"):
        assert words in told
    folder = here / "anna-swingdown"
    assert sorted(path.name for path in folder.iterdir() if not path.name.startswith(".")) == [
        "curves.csv",
        "curves.png",
        "first_answer.csv",
        "laws.csv",
        "laws.png",
        "recordings.csv",
        "study.yaml",
    ]
    row = pd.read_csv(folder / "first_answer.csv").iloc[0]
    assert abs(row["natural_frequency_rad_per_s"] - 7.25) < 4 * row["natural_frequency_rad_per_s_u"]
    assert abs(row["viscous_ratio"] - 0.008) < 4 * row["viscous_ratio_u"]


def test_what_it_writes_is_a_study_that_the_workflow_takes(here, snakemake, capsys):
    export(here / "in here" / "swing 1.csv")
    assert main(["in here/swing 1.csv", "--quick"]) == 0
    folder = here / "in here" / "swing 1-swingdown"
    done = snakemake("--configfile", folder / "study.yaml", "--dry-run", "--quiet", "rules", directory=folder)
    jobs = set(done.stdout.split("Job stats:")[1].split("total")[0].split())
    assert {"record", "fit_swing", "discover_verdict", "pendulums", "page"} <= jobs
    assert not [job for job in jobs if job.startswith("fig")], "figures of the paper"


def test_a_folder_is_a_class_in_which_one_bad_file_spoils_only_its_own_row(here, capsys):
    for k in range(3):
        export(here / "class" / f"swing {k + 9}.csv", frequency=5 + k, seed=k)
    export(here / "class" / "Jürgen.csv", frequency=4.5)
    export(here / "class" / "brief.csv", times=np.arange(190) / 100)
    (here / "class" / "broken.csv").write_text("time,angle\n0,0.1\n0.1,lots\n0.2,0.3\n")
    assert main(["class", "--quick"]) == 0
    told = capsys.readouterr().out
    assert "broken.csv: NOT USED" in told and "brief: " in told
    folder = here / "class-swingdown"
    table = pd.read_csv(folder / "first_answer.csv")
    assert list(table["recording"]) == ["brief", "Jurgen", "swing-9", "swing-10", "swing-11"]
    assert np.all(np.abs(table["natural_frequency_rad_per_s"] - [7.25, 4.5, 5, 6, 7]) < 5e-3)
    out = pd.read_csv(folder / "left_out.csv").set_index("recording")
    assert "lots" in out.loc["broken", "problem"] and "half-swings" in out.loc["brief", "problem"]
    settings = yaml.safe_load((folder / "study.yaml").read_text())
    assert settings["discovery"]["campaigns"] == ["Jurgen", "swing-9", "swing-10", "swing-11"]
    os.chdir(folder)
    assert set(read_sheet("recordings.csv")["campaign"]) == {
        "Jurgen",
        "brief",
        "swing-9",
        "swing-10",
        "swing-11",
    }


def test_runs_side_by_side_are_rows_of_their_own(here, capsys):
    parts = [
        pd.read_csv(export(here / f"{k}.txt", frequency=5 + k, seed=k, times=TIMES[: 1001 - 200 * k]))
        for k in range(3)
    ]
    table = pd.concat([part.add_suffix(f" Run #{k}") for k, part in enumerate(parts, 1)], axis=1)
    (here / "class").mkdir()
    table.to_csv(here / "class" / "capstone.csv", index=False)
    assert main(["class", "--quick"]) == 0
    told = capsys.readouterr().out
    assert (
        "capstone.csv: 3 runs; all taken" in told and "capstone.csv, Run #3: took `Angle (°) Run #3`" in told
    )
    answers = pd.read_csv(here / "class-swingdown" / "first_answer.csv")
    assert list(answers["recording"]) == ["capstone-Run-1", "capstone-Run-2", "capstone-Run-3"]
    assert np.all(np.abs(answers["natural_frequency_rad_per_s"] - [5, 6, 7]) < 5e-3)
    os.chdir(here / "class-swingdown")
    rows = read_sheet("recordings.csv")
    assert list(rows["run"]) == ["Run #1", "Run #2", "Run #3"] and rows["campaign"].is_unique


@pytest.mark.slow("a search")
def test_a_folder_is_told_whole(here, snakemake, capsys):
    """Each file is used, refused, or not looked at and why; names that Snakemake or a sheet cannot hold take nobody else down."""
    for name in ("group {7}.csv", "<script>.csv", "zip me.txt"):
        export(here / "class" / name)
    with zipfile.ZipFile(here / "class" / "phone.zip", "w") as packed:
        packed.write(here / "class" / "zip me.txt", "Raw Data.csv")
        packed.writestr("meta/device.csv", "property,value\n")
    folder = os.fsencode(here / "class")
    for name in (b"K\xf6nig.csv", b"photo.jpg", b"sketch.ino", b"film.mp4"):
        with open(os.path.join(folder, name), "wb") as file:
            file.write(b"\0\0\0\x18ftypisom" if name == b"film.mp4" else b"x,y\n")
    (here / "class" / "old").mkdir()
    assert main(["class", "--quick"]) == 0
    told = capsys.readouterr().out
    for words in (
        "photo.jpg: not looked at: a picture",
        "sketch.ino: not looked at: files that end in .ino",
        "old: not looked at: a folder",
    ):
        assert words in told
    assert "film.mp4: NOT USED" in told
    study = here / "class-swingdown"
    assert set(pd.read_csv(study / "first_answer.csv")["recording"]) == {
        "group-7",
        "script",
        "zip-me",
        "phone",
    }
    out = pd.read_csv(study / "left_out.csv").set_index("recording")["problem"]
    assert set(out.index) == {"photo.jpg", "sketch.ino", "old", "film", "Konig.csv"}
    assert "perhaps Latin-1" in out["Konig.csv"]
    wanted = ["results/recordings/group-7.nc", "results/recordings/script.nc"]
    snakemake(*wanted, "--configfile", study / "study.yaml", directory=study)
    assert all((study / one).exists() for one in wanted)


def test_names_are_no_formulas_in_its_tables_and_hold_no_control_characters(here, capsys):
    """A spreadsheet would compute the first, a terminal obey the second; each is read again as what it was."""
    for name in ("=1+2.csv", "@sum.csv", "an\x1b[31mna\x07.csv"):
        export(here / name)
    (here / "=3.txt").write_text("no numbers\n")
    (here / "-x\x1b.pdf").write_text("")
    assert main([".", "--quick", "--into", "."]) == 0
    for name, column in (("recordings.csv", "file"), ("first_answer.csv", "label"), ("left_out.csv", "file")):
        with open(name, newline="") as file:
            rows = list(csv.DictReader(file))
        assert not [cell for row in rows for cell in row.values() if cell[:1] in "=@" and cell], name
        assert not [row["label"] for row in rows if "\x1b" in row["label"]], name
        assert {"'=1+2", "'@sum", "an\\x1b[31mna\\x07"} <= {
            row["label"] for row in rows
        } or name == "left_out.csv"
        assert [row[column] for row in rows if row[column].startswith("'=")], name
    sheet = read_sheet("recordings.csv")
    assert set(sheet["label"]) == {"=1+2", "@sum", "an\\x1b[31mna\\x07"}
    assert set(sheet["file"]) == {"=1+2.csv", "@sum.csv", "an\x1b[31mna\x07.csv"}
    assert "'-x\\x1b.pdf" in set(pd.read_csv("left_out.csv")["label"])


def test_together_they_are_one_pendulum(here, capsys):
    for k in range(2):
        export(here / f"{k}.csv", angle=0.2 + 0.1 * k, seed=k)
    assert main(["0.csv", "1.csv", "--together", "--quick", "--into", "mine"]) == 0
    table = pd.read_csv(here / "mine" / "first_answer.csv")
    assert list(table["recording"]) == ["0", "1", "(joint)"]
    assert set(table["campaign"]) == {"pendulum"}


def test_units_that_the_file_leaves_out_can_be_told(here, capsys):
    export(here / "a.csv", header=("t", "value"))
    assert main(["a.csv", "--quick"]) == 0
    assert "TAKEN AS DEGREES (--unit says otherwise)" in capsys.readouterr().out
    assert main(["a.csv", "--quick", "--unit", "deg"]) == 0
    assert "TAKEN AS" not in capsys.readouterr().out
    assert pd.read_csv(here / "a-swingdown" / "recordings.csv")["signal_unit"].item() == "deg"


def test_one_number_a_line_asks_for_the_rate_in_the_words_of_the_command(here, capsys):
    table = pd.read_csv(export(here / "a.csv"))
    (here / "a.csv").write_text("\n".join(f"{x:.5f}" for x in np.radians(table["Angle (°)"])) + "\n")
    with pytest.raises(SystemExit):
        main(["a.csv", "--quick"])
    told = capsys.readouterr().err
    assert "--rate" in told and "rate_hz" not in told and "sheet" not in told
    assert main(["a.csv", "--quick", "--unit", "rad", "--rate", "100"]) == 0
    row = pd.read_csv(here / "a-swingdown" / "first_answer.csv").iloc[0]
    assert abs(row["natural_frequency_rad_per_s"] - 7.25) < 0.01
    with pytest.raises(SystemExit):
        main([str(export(here / "b.csv")), "--quick", "--rate", "100"])
    assert "leave --rate empty" not in capsys.readouterr().err


def test_a_window_can_be_told(here, capsys):
    export(here / "a.csv")
    assert main(["a.csv", "--quick", "--start", "2", "--stop", "8"]) == 0
    assert "601 samples" in capsys.readouterr().out
    assert pd.read_csv(here / "a-swingdown" / "recordings.csv")[["start_s", "stop_s"]].values.tolist() == [
        [2, 8]
    ]


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["nowhere.csv"], "there is no such file"),
        (["empty"], "no recording in this folder"),
        (["text.csv"], "mend:"),
        (["verfy", "results"], "there is no such file"),
    ],
)
def test_what_cannot_be_used_is_told_in_one_block(here, capsys, arguments, told):
    (here / "empty").mkdir()
    (here / "text.csv").write_text("dear diary\n")
    with pytest.raises(SystemExit) as stopped:
        main(arguments)
    shown = capsys.readouterr().err
    assert stopped.value.code == 1
    assert told in shown and shown.count("This input cannot be used.") == 1
    assert sorted(path.name for path in here.iterdir()) == ["empty", "text.csv"]


def test_a_study_that_somebody_changed_is_left_as_it_is(here, capsys):
    export(here / "anna.csv")
    assert main(["anna.csv", "--quick"]) == 0
    assert main(["anna.csv", "--quick"]) == 0  # its own work it may do again
    sheet = here / "anna-swingdown" / "recordings.csv"
    sheet.write_text(sheet.read_text().replace("anna,anna", "anna,bench"))
    before = {path.name: path.read_bytes() for path in sheet.parent.iterdir()}
    with pytest.raises(SystemExit):
        main(["anna.csv", "--quick"])
    assert "--into" in capsys.readouterr().err
    assert {path.name: path.read_bytes() for path in sheet.parent.iterdir()} == before


def test_a_folder_that_cannot_be_written_is_told(here, capsys):
    export(here / "anna.csv")
    (here / "taken").write_text("a file where the folder should be")
    with pytest.raises(SystemExit):
        main(["anna.csv", "--quick", "--into", "taken"])
    assert "cannot be written" in capsys.readouterr().err


def test_of_one_pendulum_a_swing_that_is_too_short_is_left_out_alone(here, capsys):
    for k in range(2):
        export(here / f"{k}.csv", angle=0.2 + 0.1 * k, seed=k)
    export(here / "2.csv", times=np.arange(70) / 100)
    assert main(["0.csv", "1.csv", "2.csv", "--together", "--quick", "--into", "mine"]) == 0
    assert list(pd.read_csv(here / "mine" / "first_answer.csv")["recording"]) == ["0", "1", "(joint)"]
    assert list(pd.read_csv(here / "mine" / "recordings.csv")["recording"]) == [0, 1]
    assert "too few swings" in pd.read_csv(here / "mine" / "left_out.csv")["problem"].item()


def test_a_search_that_fails_of_one_pendulum_leaves_the_others_their_report(here, capsys, monkeypatch):
    for k in range(2):
        export(here / "class" / f"{k}.csv", seed=k)
    asked = []

    def run(command, cwd, **streams):
        """Stands for the workflow: the first time the search of the second pendulum ends in an error."""
        folder = Path(command[command.index("--directory") + 1])
        settings = yaml.safe_load((folder / "study.yaml").read_text())
        asked.append(settings.get("discovery", {}).get("campaigns"))
        path = folder / "results/discovery/0/verdict.json"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text('{"status": "consistent", "sentence": "Nothing is missing: as it should be."}')
        return running([sys.executable, "-c", f"raise SystemExit({1 if len(asked) == 1 else 0})"], **streams)

    running = subprocess.Popen
    monkeypatch.setattr("swingdown.answer.command.subprocess.Popen", run)
    assert main(["class"]) == 0
    assert asked == [None, ["0"]]
    told = capsys.readouterr().out
    assert "0: Nothing is missing. As it should be." in told and "1: no verdict" in told
    assert pd.read_csv(here / "class-swingdown" / "left_out.csv")["recording"].item() == 1


def test_names_are_safe_and_each_is_there_once():
    given = ["Jürgen", "swing 1", "a", "A", "..", "Gruppe 3 / a", "ß", "名前", "名"]
    found = own.names([Path(f"{name.replace('/', '_')}.csv") for name in given])
    assert found[:4] == ["Jurgen", "swing-1", "a", "A-2"]
    assert len({name.lower() for name in found}) == len(given)
    assert all(name[0].isalnum() and name.isascii() and " " not in name for name in found)


@pytest.mark.slow("a whole study")
def test_from_an_empty_folder_to_a_report(here, root):
    """Two files and a broken one, by the command alone: verdicts, the table, and a report without a trace of the paper."""
    for k in range(2):
        export(here / "class" / f"swing {k}.csv", frequency=6 + k, seed=k)
    (here / "class" / "broken.csv").write_text("time,angle\n0,0.1\n0.1,lots\n0.2,0.3\n")
    command = [Path(sys.executable).with_name("swingdown"), "class"]
    done = subprocess.run(command, cwd=here, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    assert done.returncode == 0, done.stdout
    assert "swing-0: Nothing is missing" in done.stdout
    results = here / "class-swingdown" / "results"
    table = pd.read_csv(results / "tables/pendulums.csv").set_index("recording")
    assert table["verdict"].to_dict() == {
        "swing-0": "consistent",
        "swing-1": "consistent",
        "broken": "refused",
    }
    text = (results / "report.html").read_text(encoding="utf-8")
    assert "Nothing is missing" in text and "broken" in text
    for trace in ("paper", "Table 3", "Figure 1", "published"):
        assert trace not in text
    assert len(text) < 2_000_000
    assert main(["verify", str(results)]) == 0


def three_releases():
    """(times in s, angles in rad): let go at 2, 14 and 26 s from 0.6 rad, caught and lifted in between."""
    times = np.arange(0, 37, 0.01)
    model = Model("viscous", {"natural_frequency": 7.25, "viscous_ratio": 0.008})
    own = simulate(model, np.arange(1000) / 100, 0.6)
    lift = np.interp(np.arange(200), [0, 120, 200], [own[-1], 0.6, 0.6])
    first = np.interp(np.arange(200), [0, 100, 200], [0, 0.6, 0.6])
    angle = np.concatenate([first, own, lift, own, lift, own, lift])[: times.size]
    return times[: angle.size], angle + 0.002 * np.random.default_rng(5).standard_normal(angle.size)


def test_several_releases_in_a_file_are_recordings_of_one_pendulum(here, capsys):
    times, angle = three_releases()
    pd.DataFrame({"Time (s)": times, "Angle (°)": np.degrees(angle)}).round(5).to_csv("anna.csv", index=False)
    assert main(["anna.csv", "--quick"]) == 0
    told = capsys.readouterr().out
    assert "the pendulum is released 3 times in it; each is a recording" in told
    sheet = read_sheet("anna-swingdown/recordings.csv", check_files=False)
    assert list(sheet.index) == ["anna-1", "anna-2", "anna-3"]
    assert list(sheet["campaign"].unique()) == ["anna"]
    assert sheet["label"].tolist() == [f"anna, release {k}" for k in (1, 2, 3)]
    row = pd.read_csv("anna-swingdown/first_answer.csv").iloc[0]
    assert abs(row["natural_frequency_rad_per_s"] - 7.25) < 4 * row["natural_frequency_rad_per_s_u"]


def test_several_releases_in_a_series_are_swings_of_one_pendulum():
    found = swingdown.fit(*three_releases())
    assert len(found.swings) == 3
    value = found.row["natural_frequency_rad_per_s"]
    assert abs(value - 7.25) < 4 * found.row["natural_frequency_rad_per_s_u"]


def test_linear_algebra_takes_one_thread_as_its_last_bits_go_by_their_number(here):
    export(here / "anna.csv")
    program = (
        "import threadpoolctl; from swingdown.__main__ import main; main(['anna.csv', '--quick']); "
        "print('threads', {one['num_threads'] for one in threadpoolctl.threadpool_info()})"
    )
    bare = {name: value for name, value in os.environ.items() if not name.endswith("_NUM_THREADS")}
    done = subprocess.run([sys.executable, "-c", program], env=bare, text=True, capture_output=True)
    assert "threads {1}" in done.stdout, done.stdout + done.stderr
