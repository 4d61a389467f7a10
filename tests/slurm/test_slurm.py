"""The identification sweep on a real Slurm, one of whose nodes dies on the way: the same numbers, none missing."""

import subprocess
import sys
import time
import warnings

import pytest
import xarray as xr
from cluster import cluster, lacking

pytestmark = pytest.mark.slow
LIMIT = 600  # seconds for the whole sweep; it took 400 on two cores with four other programs running
SWEEP = """\
recordings: null
simulation: {simulated: []}
sweeps:
  identification:
    computes: identification
    axes:
      simulation.simulated: [viscous, quadratic_drag, load_coulomb]
      simulation.snr: [20, 50]
    realizations: 120
    chunk: 120
"""


@pytest.fixture(scope="module")
def slurm(tmp_path_factory):
    """A cluster of three nodes with one core each."""
    if reason := lacking():
        reason = f"NOT TESTED: no Slurm: {reason}"
        warnings.warn(reason, stacklevel=1)
        pytest.skip(reason)
    folder = tmp_path_factory.mktemp("slurm")
    for one in (folder, *folder.parents[:2]):
        one.chmod(0o755)  # munged runs as a user of its own
    with cluster(folder) as started:
        yield started


@pytest.fixture(scope="module")
def local(snakemake, tmp_path_factory):
    """The folder of the same sweep, computed on this machine alone."""
    folder = tmp_path_factory.mktemp("local")
    (folder / "sweep.yaml").write_text(SWEEP)
    snakemake("sweep", "--configfile", folder / "sweep.yaml", directory=folder)
    return folder


@pytest.fixture(scope="module")
def with_a_death(root, slurm, tmp_path_factory):
    """The folder of the sweep on the cluster, what was printed, and the jobs that ran on the node that died."""
    folder = tmp_path_factory.mktemp("cluster")
    (folder / "sweep.yaml").write_text(SWEEP)
    command = [
        sys.executable, "-m", "snakemake", "sweep", "--profile", "workflow/profiles/slurm", "--slurm-init-seconds-before-status-checks", "2",
        "--seconds-between-status-checks", "2", "--configfile", folder / "sweep.yaml", "--directory", folder,
    ]  # fmt: skip
    log = folder / "printed.txt"
    with log.open("w") as printed:
        run = subprocess.Popen(
            list(map(str, command)), cwd=root, env=slurm.environment, stdout=printed, stderr=subprocess.STDOUT
        )
        try:
            until, node, victims = time.monotonic() + LIMIT, slurm.nodes[0], []
            while not victims and run.poll() is None and time.monotonic() < until:
                time.sleep(0.5)
                victims = slurm.running(node)
            if victims:
                time.sleep(1.5)  # it is at work
                victims = slurm.running(node) or victims
                slurm.kill(node)
            run.wait(max(1, until - time.monotonic()))
        except subprocess.TimeoutExpired:
            queue = slurm.run("squeue") + slurm.run("scontrol", "show", "nodes")
            pytest.fail(f"the sweep did not end within {LIMIT} s\n{queue}\n{log.read_text()[-5000:]}")
        finally:
            if run.poll() is None:
                run.kill()
                run.wait()
    return folder, log.read_text(), victims, run.returncode


def test_the_sweep_ends_well_though_a_node_dies_under_its_jobs(slurm, with_a_death):
    folder, printed, victims, code = with_a_death
    assert code == 0, printed[-5000:]
    assert victims, "no job ran on the node that was to die"
    assert any(state.startswith("DOWN") for state in slurm.states())
    assert "FAILED" not in printed  # no manual step: Slurm itself queued them again
    assert "Restarts=1" in "".join(slurm.run("scontrol", "show", "job", job) for job in victims)


def test_every_draw_is_there_once_and_equal_to_the_local_run(with_a_death, local):
    folder, *_ = with_a_death
    ours = xr.load_dataset(folder / "results/sweeps/identification/sweep.nc")
    theirs = xr.load_dataset(local / "results/sweeps/identification/sweep.nc")
    xr.testing.assert_identical(ours, theirs)
    assert ours["norm"].notnull().all()
    dealt = (folder / "results/sweeps/identification/plan.jsonl").read_text().splitlines()
    made = list((folder / "results/sweeps/identification/chunks").iterdir())
    assert sorted(path.stem for path in made) == sorted(line.partition(" ")[0] for line in dealt)
    assert len(made) == 6


def test_the_profile_needs_no_accounting(slurm):
    assert "accounting_storage/none" in slurm.run("scontrol", "show", "config")
