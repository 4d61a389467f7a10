"""The identification sweep on a real Slurm under which everything goes wrong once: the same numbers, and no whole chunk touched.

A node dies, another is drained, a job is cancelled, one suspended, one held back until all is over, and the workflow itself is
killed; its jobs live on beside those of the run that resumes.
"""

import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
import xarray as xr
from cluster import cluster, lacking

pytestmark = pytest.mark.slow("a cluster")
LIMIT = (
    420  # seconds for both runs of the sweep; they took 150 to 200 on two cores with other programs running
)
CHUNKS = 7
SWEEP = """\
recordings: null
simulation: {simulated: []}
sweeps:
  identification:
    computes: identification
    axes:
      simulation.simulated: [viscous, quadratic_drag, load_coulomb]
      simulation.snr: [20, 50]
    realizations: 100
    chunk: 86
"""
FOLDER = "results/sweeps/identification"
DATA_TARGET = f"{FOLDER}/sweep.nc"


@pytest.fixture(scope="module")
def slurm(tmp_path_factory):
    """A cluster of three nodes with one core each."""
    if reason := lacking():
        pytest.skip(f"NOT TESTED: no Slurm: {reason}")
    folder = tmp_path_factory.mktemp("slurm")
    for one in (folder, *folder.parents[:3]):
        one.chmod(0o755)  # munged runs as a user of its own
    with cluster(folder) as started:
        yield started


@pytest.fixture(scope="module")
def local(snakemake, tmp_path_factory):
    """The combined dataset of the same sweep, computed on this machine alone."""
    folder = tmp_path_factory.mktemp("local")
    (folder / "sweep.yaml").write_text(SWEEP.replace("chunk: 86", "chunk: 600"))
    snakemake(f"{FOLDER}/sweep.nc", "--configfile", folder / "sweep.yaml", directory=folder)
    return xr.load_dataset(folder / FOLDER / "sweep.nc")


class Study:
    """A folder in which the sweep runs, and what was ever seen of its chunks: inode and time stamp at first sight."""

    def __init__(self, root, slurm, folder):
        self.root, self.slurm, self.folder, self.seen, self.touched = root, slurm, folder, {}, []
        (folder / "sweep.yaml").write_text(SWEEP)

    def start(self, log, *more):
        command = [
            sys.executable, "-m", "snakemake", *more, "--profile", "profiles/slurm", "--slurm-init-seconds-before-status-checks", "2",
            "--seconds-between-status-checks", "2", "--slurm-keep-successful-logs", "--configfile", self.folder / "sweep.yaml", "--directory", self.folder,
        ]  # fmt: skip
        with (self.folder / log).open("w") as printed:
            return subprocess.Popen(
                list(map(str, command)), cwd=self.root, env=self.slurm.environment, stdout=printed, stderr=subprocess.STDOUT
            )  # fmt: skip

    def look(self):
        """The names of the chunks that are whole; one that is gone, or another file than before, is kept in ``touched``."""
        now = {}
        for path in (self.folder / FOLDER / "chunks").glob("[!.]*.nc"):
            there = path.stat()
            now[path.name] = (there.st_ino, there.st_mtime_ns)
        self.touched += [name for name, known in self.seen.items() if now.get(name) != known]
        self.seen |= {name: stamp for name, stamp in now.items() if name not in self.seen}
        return set(now)

    def wait(self, ready, what):
        until = time.monotonic() + LIMIT
        while not ready():
            self.look()
            if time.monotonic() > until:
                logs = "".join(path.read_text()[-3000:] for path in self.folder.glob("*.txt"))
                pytest.fail(
                    f"{what} not within {LIMIT} s\n{self.slurm.run('squeue')}{self.slurm.run('scontrol', 'show', 'nodes')}\n{logs}"
                )
            time.sleep(0.3)


@pytest.fixture(scope="module")
def misfortune(root, slurm, tmp_path_factory):
    """The ``Study`` after all that can go wrong, with what happened to whom."""
    study = Study(root, slurm, tmp_path_factory.mktemp("cluster"))
    first = study.start("first.txt", DATA_TARGET)
    try:
        study.wait(lambda: len(study.look()) >= 2 or first.poll() is not None, "the first chunks")
        # the last in the queue is held back, as on a busy cluster
        waiting = slurm.run("squeue", "-h", "-t", "PD", "-o", "%A").split()
        study.held = waiting[-1]
        slurm.run("scontrol", "hold", study.held)
        dying, draining, other = slurm.nodes
        # a job that is about to end would be no victim
        study.wait(lambda: slurm.hold_at_work(slurm.nodes) or first.poll() is not None, "a job on every node")
        study.victims, study.cancelled, study.suspended = (
            slurm.running(dying),
            slurm.running(draining),
            slurm.running(other),
        )
        slurm.run("scontrol", "suspend", *study.suspended)
        slurm.run("scontrol", "update", f"nodename={draining}", "state=drain", "reason=test")
        slurm.run("scancel", *study.cancelled)
        slurm.kill(dying)
        slurm.go_on([draining])  # the suspended ones Slurm itself wakes
        time.sleep(3)
        os.kill(first.pid, signal.SIGKILL)
        first.wait()
        slurm.run("scontrol", "resume", *study.suspended)
        slurm.run("scontrol", "update", f"nodename={draining}", "state=resume")
        study.at_kill = study.look()
        study.living = slurm.run("squeue", "-h", "-o", "%A").split()
        unlock = [
            sys.executable,
            "-m",
            "snakemake",
            "--unlock",
            "--configfile",
            study.folder / "sweep.yaml",
            "--directory",
            study.folder,
        ]
        subprocess.run(
            list(map(str, unlock)), cwd=root, check=True, capture_output=True, env=slurm.environment
        )
        second = study.start("second.txt", "sweep")
        study.wait(lambda: second.poll() is not None, "the end of the run that resumes")
        study.code = second.returncode
    finally:
        for run in (first, *([second] if "second" in locals() else ())):
            if run.poll() is None:
                run.kill()
                run.wait()
    return study


def test_the_run_that_resumes_ends_well_and_every_draw_equals_the_local_one(slurm, misfortune, local):
    printed = (misfortune.folder / "second.txt").read_text()
    assert misfortune.code == 0, printed[-5000:]
    assert misfortune.victims and misfortune.cancelled and misfortune.suspended and misfortune.living
    assert any(state.startswith("DOWN") for state in slurm.states())
    told = [slurm.run("scontrol", "show", "job", job) for job in misfortune.victims]
    assert any(int(re.search(r"Restarts=(\d+)", one)[1]) > 0 for one in told), told[0]
    assert len(misfortune.look()) == CHUNKS
    xr.testing.assert_identical(xr.load_dataset(misfortune.folder / DATA_TARGET), local)


def test_a_run_on_slurm_says_how_far_it_is_and_asks_for_no_account(misfortune):
    printed = (misfortune.folder / "second.txt").read_text()
    told = [int(done) for done in re.findall(r"^(\d+) of \d+ jobs done", printed, re.MULTILINE)]
    assert len(told) >= 3 and told == sorted(told)
    assert "account" not in printed


def test_a_job_of_the_dead_run_that_slurm_starts_when_all_is_over_touches_no_chunk(slurm, misfortune):
    assert misfortune.held in slurm.run("squeue", "-h", "-o", "%A").split()
    slurm.run("scontrol", "release", misfortune.held)
    misfortune.wait(
        lambda: misfortune.held not in slurm.run("squeue", "-h", "-o", "%A").split(), "the late job's end"
    )
    misfortune.look()
    told = slurm.run("scontrol", "show", "job", misfortune.held)
    log = Path(re.search(r"StdOut=(\S+)", told)[1])
    assert "JobState=COMPLETED" in told, told + (log.read_text() if log.exists() else "no log")
    assert "is whole already" in log.read_text()
    assert misfortune.touched == []  # of what was seen all along, through both runs
    assert misfortune.at_kill and len(misfortune.seen) == CHUNKS


def test_the_command_of_the_docs_cancels_the_jobs_of_a_dead_run(root, slurm, misfortune):
    text = (root / "docs/cluster.md").read_text()
    command = next(line for line in text.splitlines() if line.startswith("squeue") and "scancel" in line)
    script = "#!/bin/sh\nsleep 60\n"
    for name in ("swingdown_0", "another"):
        subprocess.run(
            ["sbatch", "-J", name, "-o", "/dev/null"],
            input=script,
            text=True,
            env=slurm.environment,
            check=True,
            capture_output=True,
        )
    subprocess.run(command, shell=True, env=slurm.environment, check=True, timeout=30)
    time.sleep(2)
    names = slurm.run("squeue", "-h", "-o", "%j").split()
    slurm.run("scancel", "--name=another")
    assert names == ["another"]


def test_the_profile_needs_no_accounting(slurm):
    assert "accounting_storage/none" in slurm.run("scontrol", "show", "config")
