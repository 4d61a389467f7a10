"""What a study left can be held against its manifest, and nothing unfinished stays lying about."""

import json
import os
import shutil
import subprocess
import sys
import time
from hashlib import sha256

import netCDF4
import numpy as np
import pandas as pd
import pytest
import xarray as xr
from snakemake.api import SnakemakeApi
from snakemake.settings.enums import Quietness
from snakemake.settings.types import (
    ConfigSettings,
    DAGSettings,
    ExecutionSettings,
    OutputSettings,
    ResourceSettings,
)

from swingdown import dataset, sealed
from swingdown.__main__ import main
from swingdown.errors import InputError
from swingdown.manifest import NAME, write_manifest
from swingdown.paths import remove_leftovers, write_csv, write_text, written_whole


@pytest.fixture
def results(tmp_path):
    """A folder of results with its manifest."""
    folder = tmp_path / "results"
    for name in ("b.txt", "logs/run.log", "sweeps/benchmarks/x.tsv", "sweeps/s.txt"):
        write_text(folder / name, name)
    sealed.write_text(folder / "tables/a.csv", "a,b\n1,2\n")
    write_manifest(folder, folder / NAME, without=["sweeps"])
    write_manifest(folder, folder / "sweeps" / NAME, parts=["sweeps"])
    return folder


def test_a_manifest_lists_what_was_made_and_nothing_of_the_run(results):
    files = json.loads((results / NAME).read_text())["files"]
    assert [one["path"] for one in files] == ["b.txt", "tables/a.csv"]
    assert files[0] == {"path": "b.txt", "size": 5, "sha256": sha256(b"b.txt").hexdigest()}


def test_a_manifest_is_the_same_again(results):
    before = (results / NAME).read_bytes()
    write_manifest(results, results / NAME, without=["sweeps"])
    assert (results / NAME).read_bytes() == before


def test_what_is_as_written_passes(results, capsys):
    assert main(["verify", str(results)]) == 0
    assert "3 files, all as they were written" in capsys.readouterr().out


def test_a_flipped_bit_a_lost_file_and_a_stranger_are_told(results, capsys):
    (results / "b.txt").write_text("b.txu")
    (results / "tables/a.csv").unlink()
    (results / "tables/new.csv").write_text("")
    assert main(["verify", str(results)]) == 1
    told = capsys.readouterr().out.splitlines()
    assert told[:3] == ["missing: tables/a.csv", "changed: b.txt", "unknown: tables/new.csv"]


@pytest.mark.parametrize(
    "damage", [lambda seal: seal[:5] + b"x" + seal[6:], lambda seal: seal[:40], lambda seal: b""]
)
def test_a_seal_that_is_flipped_cut_or_emptied_is_told(results, capsys, damage):
    seal = sealed.seal_of(results / "tables/a.csv")
    seal.write_bytes(damage(seal.read_bytes()))
    assert main(["verify", str(results)]) == 1
    assert capsys.readouterr().out.splitlines()[0] == "changed: tables/.a.csv.sha256"
    seal.unlink()  # as the mend says
    assert main(["verify", str(results)]) == 0


def edited(path):
    path.write_text(path.read_text().replace("1", "3"))


def seal_edited(path):
    edited(sealed.seal_of(path))


def number_changed(path):
    with netCDF4.Dataset(path, "a") as file:
        file["x"][0] = 7


def flipped(path):
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 1
    path.write_bytes(content)


def cut(path):
    path.write_bytes(path.read_bytes()[:-200])


@pytest.mark.parametrize(
    "name, damage",
    [
        ("tables/a.csv", edited),
        ("tables/a.csv", seal_edited),
        ("c.nc", number_changed),
        ("c.nc", flipped),
        ("c.nc", cut),
    ],
)
def test_what_is_not_as_it_was_written_becomes_no_truth(results, name, damage):
    """A manifest that is written anew lists nothing that a seal belies, and says how that is made anew."""
    dataset.write(xr.Dataset({"x": ("n", np.arange(3))}), results / "c.nc")
    before = (results / NAME).read_bytes()
    damage(results / name)
    with pytest.raises(InputError, match=f"{name}.*Mend: delete it and give the same command again"):
        write_manifest(results, results / NAME)
    assert (results / NAME).read_bytes() == before


def test_a_part_made_again_by_itself_is_as_it_should_be(results):
    """Its own manifest knows it; that of the whole study is older."""
    write_text(results / "angles/a.txt", "before")
    write_manifest(results, results / NAME, without=["sweeps"])
    write_text(results / "angles/a.txt", "after")
    assert main(["verify", str(results)]) == 1
    write_manifest(results, results / "discovery" / NAME, parts=["angles", "discovery"])
    assert main(["verify", str(results)]) == 0


@pytest.mark.parametrize(
    "content", [None, "{", "[]", '{"files": [{}]}', '{"files": [{"path": 1, "size": "x"}]}']
)
def test_without_a_manifest_that_can_be_read_it_says_so(tmp_path, capsys, content):
    if content is not None:
        (tmp_path / NAME).write_text(content)
    with pytest.raises(SystemExit) as stopped:
        main(["verify", str(tmp_path)])
    assert stopped.value.code == 1
    assert "mend:" in capsys.readouterr().err


@pytest.mark.parametrize("arguments", [[], ["verify"], ["verify", "a", "b"]])
def test_a_verb_that_is_none_is_told_the_verbs(arguments, capsys):
    assert main(arguments) == 2
    assert "verify RESULTS" in capsys.readouterr().err


def test_the_module_runs(results):
    done = subprocess.run(
        [sys.executable, "-m", "swingdown", "verify", results], capture_output=True, text=True
    )
    assert (done.returncode, done.stdout) == (0, "3 files, all as they were written\n")


def test_a_studys_results_are_all_listed_and_verified(small_study, capsys):
    assert main(["verify", str(small_study / "results")]) == 0
    listed = {one["path"] for one in json.loads((small_study / "results" / NAME).read_text())["files"]}
    assert {"report.html", "tables/table2.csv", "figures/fig01.png", "angles/swing_01.nc"} <= listed
    assert not [path for path in listed if path.startswith("logs/") or path.endswith(NAME)]


@pytest.mark.slow("a whole study")
def test_a_value_that_was_changed_is_refused_and_mended_as_told(small_study, snakemake, tmp_path):
    """No later step reads the file: only the manifest sees it, and it asks for what is deleted."""
    folder = tmp_path / "study"
    shutil.copytree(small_study, folder)
    arguments = ("results/manifest.json", "--configfile", folder / "small.yaml", "--rerun-triggers", "mtime")
    changed = folder / "results/discovery/bench/first/model.yaml"
    whole = changed.read_text()
    changed.write_text(whole.replace("viscous", "Viscous", 1))
    (folder / "results/manifest.json").unlink()
    done = snakemake(*arguments, directory=folder, check=False)
    assert done.returncode and not (folder / "results/manifest.json").exists()
    told = " ".join(done.stdout.split())
    assert (
        "results/discovery/bench/first/model.yaml" in told
        and "mend: delete it and give the same command" in told
    )
    changed.unlink()
    snakemake(*arguments, directory=folder)
    assert changed.read_text() == whole and main(["verify", str(folder / "results")]) == 0


@pytest.mark.slow("a whole study")
def test_every_file_of_a_study_that_is_deleted_is_made_anew(small_study, root, tmp_path):
    """By the same command: what no later step needs, too. Here it is planned only, of figures, on which none rests, all at once."""
    folder = tmp_path / "study"
    shutil.copytree(small_study, folder)

    def planned():
        with SnakemakeApi(OutputSettings(quiet={Quietness.ALL})) as api:
            study = api.workflow(
                resource_settings=ResourceSettings(cores=1), config_settings=ConfigSettings(configfiles=[folder / "small.yaml"]),
                snakefile=root / "Snakefile", workdir=folder,
            )  # fmt: skip
            jobs = study.dag(dag_settings=DAGSettings(targets={"all"}, rerun_triggers={"mtime"}))
            jobs.execute_workflow(executor="dryrun", execution_settings=ExecutionSettings(lock=False))
            return {
                str(path)
                for job in study._workflow.dag.needrun_jobs(exclude_finished=False)
                for path in job.output
            }

    assert not planned()
    files = [one["path"] for one in json.loads((folder / "results" / NAME).read_text())["files"]]
    figures = [path for path in files if "figures" in path]
    assert len(figures) > 20
    for lost in (figures, *([path] for path in files if path not in figures)):
        for path in lost:
            (folder / "results" / path).rename(tmp_path / path.replace("/", " "))
        assert {f"results/{path}" for path in lost} <= planned()
        for path in lost:
            (tmp_path / path.replace("/", " ")).rename(folder / "results" / path)


KILLED = """
import os, signal, sys
from swingdown.paths import written_whole
with written_whole(sys.argv[1]) as partial:
    partial.write_text("half")
    os.kill(os.getpid(), signal.SIGKILL)
"""


def test_what_a_killed_writer_left_is_removed_and_nothing_else(tmp_path):
    subprocess.run([sys.executable, "-c", KILLED, tmp_path / "deep" / "a.nc"])
    (left,) = (tmp_path / "deep").iterdir()
    mine, strangers = tmp_path / ".notes.part", tmp_path / "video.mp4.123.part"
    mine.write_text("")
    strangers.write_text("")
    elsewhere = tmp_path / ".a.nc.another-machine-1.part"
    elsewhere.write_text("")
    with written_whole(tmp_path / "b.txt") as running:
        running.write_text("half")
        assert remove_leftovers(tmp_path) == [left]
        assert running.exists() and mine.exists() and strangers.exists() and elsewhere.exists()
    long_ago = time.time() - 2 * 86400
    os.utime(elsewhere, (long_ago, long_ago))
    assert remove_leftovers(tmp_path) == [elsewhere]


def test_a_process_number_given_again_protects_no_leftover(tmp_path):
    with written_whole(tmp_path / "b.txt") as partial:
        partial.write_text("half")
        os.utime(partial, (0, 0))  # long before this process began
        found = remove_leftovers(tmp_path)
        partial.write_text("whole")
    assert found == [partial]


@pytest.mark.slow("runs of the workflow")
def test_the_next_run_removes_leftovers_and_a_dry_run_does_not(small_study, snakemake, tmp_path):
    left = tmp_path / "results" / "tables" / ".table2.csv.999999999.part"
    write_text(left, "half")
    arguments = ("results/figures/fig01.svg", "--configfile", small_study / "small.yaml")
    (tmp_path / "small.csv").write_text((small_study / "small.csv").read_text())
    snakemake(*arguments, "--dry-run", directory=tmp_path)
    assert left.exists()
    snakemake(*arguments, directory=tmp_path)
    assert not left.exists()


@pytest.mark.parametrize(
    "write", [lambda path: write_text(path, "new"), lambda path: write_csv(Broken(), path)]
)
def test_text_and_tables_are_written_whole_or_not_at_all(tmp_path, write, monkeypatch):
    path = tmp_path / "a.csv"
    path.write_text("old")
    monkeypatch.setattr("os.replace", lambda *_: (_ for _ in ()).throw(OSError("no room")))
    with pytest.raises(OSError, match="no room"):
        write(path)
    assert path.read_text() == "old" and list(tmp_path.iterdir()) == [path]


class Broken(pd.DataFrame):
    @property
    def _constructor(self):
        return Broken

    def to_csv(self, path, **told):
        path.write_text("ha")
        raise OSError("no room")
