"""Sweeps as a user runs them: what a dry run tells, what is computed again, and what is left after kill -9."""

import os
import re
import signal
import subprocess
import sys
import time

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

from swingdown.report import contents, sweeps
from swingdown.report.page import Figure

CONFIG = """\
recordings: null
simulation: {{simulated: []}}
sweeps:
  small:
    computes: identification
    axes:
      simulation.simulated: [viscous, load_coulomb]
      simulation.snr: {snr}
    settings: {{simulation.duration_s: 2.5, simulation.start: free}}
    realizations: {realizations}
    chunk: {chunk}
"""
DATA = "results/sweeps/small/sweep.nc"


def write(folder, snr="[20, 50]", realizations=20, chunk=30):
    (folder / "sweep.yaml").write_text(CONFIG.format(snr=snr, realizations=realizations, chunk=chunk))
    return "sweep", "--configfile", folder / "sweep.yaml"


def chunks(folder):
    return {
        path.name: (path.stat().st_ino, path.stat().st_mtime_ns)
        for path in (folder / "results/sweeps/small/chunks").glob("[!.]*.nc")
    }


@pytest.fixture(scope="module")
def swept(snakemake, tmp_path_factory):
    """The folder of a small sweep that has run, but for its maps, and what the run printed."""
    folder = tmp_path_factory.mktemp("swept")
    return folder, snakemake(DATA, *write(folder)[1:], directory=folder).stdout


@pytest.fixture(scope="module")
def mapped(snakemake, swept):
    """The same folder with the maps and their page, and what that run printed."""
    return swept[0], snakemake(*write(swept[0]), directory=swept[0]).stdout


@pytest.fixture
def planned(root):
    """A function that plans a run in a folder, in this process to save starts, and returns how often each rule would run."""

    def counts(folder, arguments):
        target, _, config = arguments
        with SnakemakeApi(OutputSettings(quiet={Quietness.ALL})) as api:
            study = api.workflow(
                resource_settings=ResourceSettings(cores=1), config_settings=ConfigSettings(configfiles=[config]),
                snakefile=root / "Snakefile", workdir=folder,
            )  # fmt: skip
            jobs = study.dag(dag_settings=DAGSettings(targets={target}))
            jobs.execute_workflow(executor="dryrun", execution_settings=ExecutionSettings(lock=False))
            _, found = study._workflow.dag.stats()
        return {name: count for name, count in found.items() if name != "total"}

    return counts


@pytest.mark.slow("a sweep")
def test_a_dry_run_tells_fits_chunks_and_hours_and_writes_nothing(snakemake, root, tmp_path):
    told = snakemake(
        "-n", "sweep", "--configfile", root / "config/sweeps-full.yaml", directory=tmp_path
    ).stdout
    count = re.search(
        r"sweep identification: ([\d,]+) cells × ([\d,]+) draws = ([\d,]+) fits in ([\d,]+) chunks", told
    )
    cells, draws, fits, jobs = (int(number.replace(",", "")) for number in count.groups())
    assert fits == cells * draws * 7 > 1e7
    assert jobs <= 2000
    took = re.search(r"([\d.,]+) (h|min) of CPU at [\d.e+]+ ms a fit \(timed just now\)", told)
    hours = float(took[1].replace(",", "")) / (1 if took[2] == "h" else 60)
    assert 0.2 < hours < 40
    assert "a verdict (timed just now)" in told
    assert not (tmp_path / "results").exists()


@pytest.mark.slow("a sweep")
def test_every_draw_is_told_to_be_there(swept):
    assert "80 draws, all there, from 3 chunks" in swept[1]


@pytest.mark.slow("a sweep")
def test_a_damaged_chunk_is_told_and_mended_as_told(snakemake, swept):
    """It is deleted, as the message says, and the same command makes it anew; the rest of the chunks stay."""
    folder, _ = swept
    before, old = chunks(folder), (folder / DATA).read_bytes()
    damaged = folder / "results/sweeps/small/chunks" / sorted(before)[0]
    whole = damaged.read_bytes()
    damaged.write_bytes(whole[:5000] + bytes([whole[5000] ^ 4]) + whole[5001:])
    (folder / DATA).unlink()
    done = snakemake(DATA, *write(folder)[1:], directory=folder, check=False)
    assert done.returncode
    told = " ".join(done.stdout.split())
    assert (
        str(damaged.relative_to(folder)) in told and "mend: delete it and give the same command again" in told
    )
    damaged.unlink()
    done = snakemake(DATA, *write(folder)[1:], directory=folder)
    after = chunks(folder)
    assert done.stdout.count("computing chunk") == 1
    assert {name for name, stamp in after.items() if stamp != before[name]} == {damaged.name}
    assert (folder / DATA).read_bytes() == old


@pytest.mark.slow("a sweep")
def test_the_maps_are_on_a_page_with_the_papers_claim(mapped):
    folder, printed = mapped
    page = (folder / "results/sweeps.html").read_text()
    assert page.count("data:image/svg+xml") == 3
    assert "68 %" in page and "Sweep small, by BIC" in page
    assert "small: averaged over all cells the true model has the lowest norm in" in printed


@pytest.mark.slow("a sweep")
def test_the_report_shows_the_maps_of_sweeps_that_were_made(mapped, root):
    captions = sorted((root / "workflow/report").glob("sweep_*.rst"))
    found = sweeps.made(["small", "not_made"], captions, mapped[0] / "results/sweeps")
    assert list(found) == ["small"]
    material = contents.Material(
        {}, {}, [], {"seed": 1, "simulation": {"snr": 1, "realizations": 2}}, sweeps=found
    )
    section = next(one for one in contents.sections(material) if one.title == "Sweeps")
    assert [item.label for item in section.items if isinstance(item, Figure)] == [
        "Sweep small, by norm", "Sweep small, by BIC", "Sweep small, by ten runs",
    ]  # fmt: skip


@pytest.mark.slow("a sweep")
def test_nothing_is_left_to_do_and_what_is_new_is_all_that_would_run(planned, swept):
    folder, _ = swept
    assert planned(folder, (DATA, *write(folder)[1:])) == {}
    assert "sweep_identification" not in planned(folder, ("all", *write(folder)[1:]))
    _, *wider = write(folder, snr="[20, 35, 50]", realizations=25)
    assert planned(folder, (DATA, *wider)) == {"sweep_identification": 3, "sweep_combine": 1}
    assert "sweep_identification" not in planned(folder, write(folder, chunk=7))
    write(folder)


@pytest.mark.slow("a sweep")
def test_more_draws_and_another_value_run_only_what_is_new(snakemake, mapped):
    folder, _ = mapped
    before, old = chunks(folder), xr.load_dataset(folder / DATA)
    wider = write(folder, snr="[20, 35, 50]", realizations=25)
    done = snakemake(*wider, directory=folder).stdout
    after, new = chunks(folder), xr.load_dataset(folder / DATA)
    assert {name: after[name] for name in before} == before  # not one was written again
    assert len(after) - len(before) == done.count("computing chunk") == 3  # 70 new draws in chunks of 30
    same = new.sel(snr=[20, 50]).isel(realization=slice(0, 20))
    assert (same["norm"].values == old["norm"].values).all()
    write(folder)


@pytest.mark.slow("a sweep")
def test_kill_9_and_the_resume_command_of_the_docs_computes_only_what_is_missing(snakemake, root, tmp_path):
    docs = (root / "docs/cluster.md").read_text()
    resume = [
        line.split()
        for line in re.search(r"snakemake --unlock.*?\n```", docs, re.DOTALL)[0].splitlines()
        if "snakemake" in line
    ]
    unlock, again = (
        line[line.index("snakemake") + 1 :] if "snakemake" in line else line[1:] for line in resume[:2]
    )
    whole, killed = tmp_path / "whole", tmp_path / "killed"
    for folder in (whole, killed):
        folder.mkdir()
        write(folder, realizations=120, chunk=40)
    snakemake(DATA, "--configfile", whole / "sweep.yaml", directory=whole)
    base = ["--configfile", killed / "sweep.yaml", "--directory", killed]
    command = [sys.executable, "-m", "snakemake", "-c2", "sweep", *base]
    running = subprocess.Popen(
        list(map(str, command)), cwd=root, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )
    until = time.monotonic() + 240
    while len(chunks(killed)) < 3 and time.monotonic() < until:
        time.sleep(0.1)
    os.kill(running.pid, signal.SIGKILL)
    running.wait()
    before = chunks(killed)  # scripts in hand run on, and end beside the run that follows
    assert 3 <= len(before) < 12
    for arguments in (unlock, again):
        command = [sys.executable, "-m", "snakemake", *arguments, *base]
        done = subprocess.run(list(map(str, command)), cwd=root, text=True, capture_output=True, timeout=300)
        assert done.returncode == 0, done.stdout + done.stderr
    after = chunks(killed)
    assert {name: after[name] for name in before} == before  # not one was written again
    assert len(after) == 12
    xr.testing.assert_identical(xr.load_dataset(killed / DATA), xr.load_dataset(whole / DATA))


@pytest.mark.slow("a sweep")
def test_a_store_with_an_emptied_coordinate_is_in_no_manifest(snakemake, tmp_path):
    write(tmp_path, realizations=8)
    config = tmp_path / "sweep.yaml"
    config.write_text(config.read_text().replace("chunk:", "format: zarr\n    chunk:"))
    snakemake("sweep", "--configfile", config, directory=tmp_path)
    manifest = tmp_path / "results/sweeps/manifest.json"
    assert "draws.zarr/fitted/0" in manifest.read_text()
    (tmp_path / "results/sweeps/small/draws.zarr/fitted/0").write_bytes(b"")
    manifest.unlink()
    done = snakemake("sweep", "--configfile", config, directory=tmp_path, check=False)
    assert done.returncode and "draws.zarr/fitted/0" in done.stdout and "mend:" in done.stdout
    assert "File " not in done.stdout and not manifest.exists()


IMPOSSIBLE = """\
recordings: null
simulation: {simulated: []}
sweeps:
  hard:
    computes: detection
    axes:
      simulation.load_friction: [0.004, 0.6]
      detection.effect: [constant_torque]
    settings: {detection.release_angles_deg: [10, 20], simulation.duration_s: 4, detection.size: 2}
    realizations: 1
    chunk: 1
"""


@pytest.mark.slow("a sweep")
def test_a_cell_that_cannot_be_made_is_foreseen_and_told_and_the_run_ends(snakemake, tmp_path):
    (tmp_path / "hard.yaml").write_text(IMPOSSIBLE)
    foreseen = snakemake("-n", "sweep", "--configfile", tmp_path / "hard.yaml", directory=tmp_path).stdout
    assert (
        "cannot be made: 1 of 2 cells tried (2 in all): the angle crosses its middle fewer than twice"
        in foreseen
    )
    printed = snakemake("sweep", "--configfile", tmp_path / "hard.yaml", directory=tmp_path).stdout
    assert "1 of 2 cells could not be made: the angle crosses its middle fewer than twice" in printed
    rows = pd.read_csv(tmp_path / "results/sweeps/hard/summary.csv")
    assert rows["made"].tolist() == [1, 0] and rows["found"].isna().tolist() == [False, True]
    assert rows["reason"].fillna("").tolist() == ["", "the angle crosses its middle fewer than twice"]
    page = (tmp_path / "results/sweeps.html").read_text()
    assert "1 of 2 cells could not be made" in page
