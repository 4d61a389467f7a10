"""A full disk, a folder that cannot be written, two runs in one: told once and in words, nothing lost, and resumed as if nothing had been."""

import os
import re
import shutil
import signal
import subprocess
import sys
import time
from contextlib import contextmanager

import pytest

from swingdown.sealed import remove_orphans, seal_of

WORDS = "The results cannot be written."


@pytest.fixture
def disk(tmp_path):
    """A function that mounts a small disk on a folder, for root alone may; the disk goes at the end."""
    mounted = []

    def mount(folder, size):
        folder.mkdir(parents=True, exist_ok=True)
        command = ["mount", "-t", "tmpfs", "-o", f"size={size}", "tmpfs", folder]
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode:
            pytest.skip(f"NOT TESTED: no disk can be mounted here ({done.stderr.strip() or 'not root'})")
        mounted.append(folder)

    yield mount
    for folder in reversed(mounted):
        subprocess.run(["umount", "-l", folder], check=True)


@contextmanager
def filled(folder, spare=0):
    """The disk of a folder full but for ``spare`` bytes, as long as the block lasts."""
    filler = folder / "filler"
    with filler.open("wb", buffering=0) as file:
        try:
            while file.write(bytes(1 << 20)):
                pass
        except OSError:
            pass
        file.truncate(max(0, file.tell() - spare))
    yield
    filler.unlink()


def told_once(done, words):
    """The output of a run that failed: it says what is wrong once, frames it once, and shows no traceback."""
    assert done.returncode
    assert done.stdout.count(words) == 1, done.stdout
    assert "Traceback" not in done.stdout and "Errno" not in done.stdout, done.stdout
    assert "Mend:" in done.stdout


@pytest.mark.parametrize("spare", [0, 12_000, 40_000])
def test_a_disk_that_is_full(snakemake, disk, tmp_path, spare):
    """So full that Snakemake cannot lock the folder, cannot prepare a job, or that a result finds no room."""
    disk(tmp_path / "study", "400k")
    with filled(tmp_path / "study", spare):
        done = snakemake("results/figures/fig01.svg", directory=tmp_path / "study", check=False)
    told_once(done, "the disk is full")
    assert done.stdout.count(WORDS) == 1
    assert not list((tmp_path / "study").rglob("*.part"))


@pytest.mark.parametrize("inside", [".", "results"])
def test_a_folder_that_cannot_be_written(snakemake, disk, tmp_path, inside):
    folder = tmp_path / "study" / inside
    disk(folder, "400k")
    subprocess.run(["mount", "-o", "remount,ro", folder], check=True)
    done = snakemake("results/figures/fig01.svg", directory=tmp_path / "study", check=False)
    told_once(done, "the folder cannot be written")
    assert "--directory" in done.stdout


def contents(folder):
    """What lies below a folder, but logs, the filler, and seals of what is gone, which the next run removes."""
    remove_orphans(folder)
    return {
        path.relative_to(folder): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file() and "logs" not in path.parts and path.name != "filler"
    }


# At each stage, what is asked for, and what else its job makes: without what the others need, so that together they can all fail in
# one run.
STAGES = {
    "ingest, angle, simulation, a figure": {
        "recordings/swing_02.nc": [],
        "angles/swing_01.nc": [],
        "simulation/realizations.nc": [],
        "figures/fig01.svg": ["figures/fig01.png"],
    },
    "calibration, fits of simulations": {
        "calibration/calibration.nc": ["tables/uncertainty_budget.csv"],
        "simulation/norms_viscous.nc": [],
    },
    "fits of swings": {"experiment/fits/swing_01.nc": []},
    "table, verdict": {
        "tables/table2.csv": ["simulation/norms.nc"],
        "discovery/bench/verdict.json": [],
    },
    "tables, figures of data and of a verdict": {
        "tables/table3.csv": [
            "tables/comparison.csv", "tables/parameters.csv", "tables/parameter_budget.csv", "experiment/norms.nc",
        ],
        "figures/fig08.svg": ["figures/fig08.png"],
        "discovery/bench/figures/gap.svg": ["discovery/bench/figures/*.*"],
    },
    "report": {"report.html": []},
}  # fmt: skip


@pytest.mark.slow("a whole study")
def test_a_disk_that_fills_up_at_any_stage(small_study, snakemake, disk, tmp_path):
    """Each stage says so in one message; what was there stays; with room again, all that failed ends as it would have."""
    folder, results = tmp_path / "study", tmp_path / "study" / "results"
    shutil.copytree(small_study, folder, ignore=shutil.ignore_patterns("results"))
    disk(results, "60m")
    shutil.copytree(small_study / "results", results, dirs_exist_ok=True)
    whole = contents(small_study / "results")
    arguments = ("--configfile", folder / "small.yaml", "--rerun-triggers", "mtime", "--keep-going")
    every = []
    for stage, names in STAGES.items():
        made = [results / name for name in names]
        made += [path for more in names.values() for pattern in more for path in results.glob(pattern)]
        made = sorted({*made, *(seal for path in made if (seal := seal_of(path)).exists())})
        every += made
        for path in made:  # what goes at the start of a job leaves room for a small table
            path.unlink()
        shutil.rmtree(results / "logs")
        with filled(results):
            before = contents(results)
            asked = [f"results/{name}" for name in names]
            done = snakemake(*asked, *arguments, directory=folder, check=False)
            assert done.returncode and "Traceback" not in done.stdout, stage
            assert done.stdout.count(WORDS) == done.stdout.count("the disk is full") == len(names), (
                f"{stage}\n{done.stdout}"
            )
            after = contents(results)
            assert after.items() <= before.items(), stage
            assert not [path for path in after if path.suffix == ".part"]
        for path in made:  # for the next stage
            path.parent.mkdir(exist_ok=True)
            shutil.copy2(small_study / path.relative_to(folder), path)
    for path in every:
        path.unlink()
    snakemake(*arguments, directory=folder)
    again = contents(results)
    told_of_runs = [path for path in whole if path.name in ("report.html", "manifest.json")]
    assert {path for path in whole if whole[path] != again.get(path)} <= set(told_of_runs)


@pytest.fixture
def running(tmp_path, root):
    """A run that holds the lock of a folder and is halted; the process, and the folder."""
    folder = tmp_path / "study"
    folder.mkdir()
    command = [sys.executable, "-m", "snakemake", "-c1", "--directory", folder, "results/simulation/realizations.nc"]  # fmt: skip
    process = subprocess.Popen(
        command, cwd=root, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, start_new_session=True
    )
    end = time.monotonic() + 120
    # Until the output's lock is written whole: a lock of the inputs alone holds nobody back.
    locks = folder / ".snakemake" / "locks"
    while not any("realizations.nc" in lock.read_text() for lock in locks.glob("*.output.lock")):
        assert process.poll() is None and time.monotonic() < end
        time.sleep(0.01)
    os.killpg(process.pid, signal.SIGSTOP)
    yield process, folder, command
    if process.poll() is None:
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()


@pytest.mark.slow("runs of the workflow")
def test_two_runs_in_one_folder(running, root):
    first, folder, command = running
    second = subprocess.run(command, cwd=root, capture_output=True, text=True)
    assert second.returncode
    assert "Another run is at work in this folder" in second.stderr and "--unlock" in second.stderr
    assert str(folder) in second.stderr and "LockException" not in second.stderr
    assert not (folder / "results/simulation/realizations.nc").exists()
    os.killpg(first.pid, signal.SIGCONT)
    told, _ = first.communicate(timeout=300)
    assert first.returncode == 0, told
    assert (folder / "results/simulation/realizations.nc").exists()


@pytest.mark.slow("runs of the workflow")
def test_the_lock_of_a_run_that_was_killed_goes_as_is_told(running, root):
    first, _, command = running
    os.killpg(first.pid, signal.SIGKILL)
    first.wait()
    told = subprocess.run(command, cwd=root, capture_output=True, text=True).stderr
    (option,) = set(re.findall(r"--unlock\b", told))
    subprocess.run([*command, option], cwd=root, check=True, capture_output=True)
    subprocess.run(command, cwd=root, check=True, capture_output=True)
