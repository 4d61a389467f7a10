"""A chunk that is whole is never removed and never written again, whatever happens to the run, the code or the table."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import xarray as xr

from swingdown.sweep import code

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
    realizations: 20
    chunk: 30
"""
FOLDER = "results/sweeps/small"
DATA = f"{FOLDER}/sweep.nc"


class Project:
    """A copy of the project whose files may be edited, and a folder in which its sweep runs."""

    def __init__(self, root, folder):
        self.root, self.folder = folder / "project", folder / "study"
        for name in ("workflow", "config", "profiles", "resources"):
            shutil.copytree(root / name, self.root / name, ignore=shutil.ignore_patterns("__pycache__"))
        shutil.copy(root / "Snakefile", self.root)
        self.folder.mkdir()
        self.write()

    def write(self, snr="[20, 50]"):
        (self.folder / "sweep.yaml").write_text(CONFIG.format(snr=snr))

    def snakemake(self, *arguments):
        """What a run of the copy printed."""
        command = [
            sys.executable,
            "-m",
            "snakemake",
            "-c2",
            "--configfile",
            self.folder / "sweep.yaml",
            "--directory",
            self.folder,
            *arguments,
        ]
        done = subprocess.run(
            list(map(str, command)), cwd=self.root, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=300,
            env=os.environ | {"PYTHONPATH": str(self.root / "workflow/src")},
        )  # fmt: skip
        assert done.returncode == 0, done.stdout
        return done.stdout

    def chunks(self):
        """Inode and time stamp of each chunk that is whole."""
        files = (self.folder / FOLDER / "chunks").glob("[!.]*.nc")
        return {path.name: (path.stat().st_ino, path.stat().st_mtime_ns) for path in files}

    def edit(self, file, before, after):
        path = self.root / "workflow" / file
        assert before in (text := path.read_text())
        path.write_text(text.replace(before, after, 1))


@pytest.fixture(scope="module")
def project(root, tmp_path_factory):
    """A ``Project`` whose sweep has run."""
    made = Project(root, tmp_path_factory.mktemp("copy"))
    made.snakemake(DATA)
    return made


def computes(printed):
    """How many chunks a dry run would compute."""
    rows = [line.split() for line in printed.splitlines() if line.startswith("sweep_identification ")]
    return int(rows[0][1]) if rows else 0


@pytest.mark.slow("a sweep")
def test_a_job_of_a_dead_run_that_is_started_late_leaves_a_whole_chunk_as_it_is(project):
    """As the Slurm plugin starts a job: forced, in a process of its own, with no knowledge of what was done since."""
    before = project.chunks()
    chunk = sorted(before)[0].removesuffix(".nc")
    said = project.snakemake(
        "--target-jobs", f"sweep_identification:chunk={chunk},sweep=small", "--allowed-rules", "sweep_identification",
        "--force", "--nolock", "--ignore-incomplete", "--mode", "remote",
    )  # fmt: skip
    assert "is whole already" in said
    assert project.chunks() == before
    assert json.loads((project.folder / FOLDER / "jobs" / f"{chunk}.json").read_text())["code"]
    assert computes(project.snakemake("-n", DATA)) == 0


@pytest.mark.slow("a sweep")
def test_what_the_books_of_snakemake_lost_or_doubt_is_not_computed_again(project):
    """After kill -9 a finished chunk may have no record, or Snakemake may hold it for unfinished."""
    before = project.chunks()
    records = sorted((project.folder / FOLDER / "jobs").glob("[!.]*"))
    records[0].unlink()
    shutil.rmtree(project.folder / ".snakemake")
    assert "computing chunk" not in project.snakemake(DATA, "--rerun-incomplete")
    assert project.chunks() == before and records[0].exists()


@pytest.mark.slow("a sweep")
def test_a_comment_computes_nothing_and_a_formula_is_told_and_waits_for_the_user(project):
    before = project.chunks()
    project.edit("src/swingdown/fitting/least_squares.py", "\nimport", "\n# a remark\nimport")
    project.edit("scripts/sweep_chunk.py", "from swingdown", "# a remark\nfrom swingdown")
    printed = project.snakemake("-n", DATA)
    assert computes(printed) == 0 and "every chunk is there" in printed and "other code" not in printed

    project.edit(
        "src/swingdown/sweep/identification.py", '"norm": np.degrees(off)', '"norm": 2 * np.degrees(off)'
    )
    printed = project.snakemake("-n", DATA)
    assert computes(printed) == 0 and "3 of 3 chunks were computed by other code" in printed
    old = xr.load_dataset(project.folder / DATA)
    project.snakemake(DATA)
    assert project.chunks() == before
    assert xr.load_dataset(project.folder / DATA).equals(old)

    assert computes(project.snakemake("-n", DATA, "--config", "recompute=true")) == 3
    project.snakemake(DATA, "--config", "recompute=true")
    after = project.chunks()
    assert len(after) == 6 and {name: after[name] for name in before} == before
    new = xr.load_dataset(project.folder / DATA)
    assert new["norm"].values == pytest.approx(2 * old["norm"].values)
    assert old.attrs["code"].endswith(": 80 draws") and new.attrs["code"] != old.attrs["code"]
    assert computes(project.snakemake("-n", DATA)) == 0


@pytest.mark.slow("a sweep")
def test_a_wider_table_leaves_every_whole_chunk(project):
    before = project.chunks()
    project.write(snr="[20, 35, 50]")
    assert computes(project.snakemake("-n", DATA)) == 2
    project.snakemake(DATA)
    after = project.chunks()
    assert {name: after[name] for name in before} == before and len(after) == len(before) + 2


def test_the_version_of_the_code_is_of_its_syntax_and_of_the_compiled_parts(root, tmp_path):
    """Comments, docstrings and layout are left out, of Python and of C; a number is not."""
    said = code._meaning
    python, c = tmp_path / "a.py", tmp_path / "a.c"

    def of(path, text):
        path.write_text(text)
        return said(path)

    assert of(python, '"""One."""\nx = 1  # so\n\n\ndef f():\n    """Two."""\n    return x\n') == of(
        python, '"""Other."""\nx = (1)\ndef f():\n    """More."""\n    return x'
    )
    assert of(python, "x = 1\n") != of(python, "x = 2\n")
    assert of(c, "double f(void) { return 1.0; } // one\n/* two */") == of(
        c, "double f(void)\n{ return 1.0; }"
    )
    assert of(c, 'const char *s = "// 1";') != of(c, 'const char *s = "// 2";')
    assert code.version("identification") != code.version("detection")
    assert len(code.version("identification")) == 8 and Path(code.PACKAGE).name == "swingdown"


@pytest.mark.parametrize(
    ("file", "counts"), [("fitting/least_squares.py", True), ("sweep/draws.py", True), ("errors.py", False)]
)
def test_code_that_computes_no_draw_may_change(monkeypatch, file, counts):
    meaning = code._meaning
    before = code.version.__wrapped__("identification")
    monkeypatch.setattr(
        code, "_meaning", lambda path: meaning(path) + " " * (path.as_posix().endswith(f"swingdown/{file}"))
    )
    assert (code.version.__wrapped__("identification") != before) == counts
