"""A run that is killed at any moment loses nothing: run again, it ends with the same bytes."""

import os
import random
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from swingdown.paths import checksum
from swingdown.sealed import remove_orphans

KILLS = int(os.environ.get("SWINGDOWN_KILLS", 2))  # more at one's wish


def command(root, folder):
    return [
        sys.executable, "-m", "snakemake", "-c1", "--nolock", "--rerun-incomplete", "--configfile", folder / "mine.yaml",
        "--directory", folder, "results/manifest.json",
    ]  # fmt: skip


def study(root, folder):
    folder.mkdir()
    header, *rows = (root / "config/recordings.csv").read_text().splitlines()
    kept = [row for row in rows if row.startswith("swing_01") or "static" in row]
    (folder / "sheet.csv").write_text("\n".join([header, *kept, ""]))
    (folder / "mine.yaml").write_text(
        "recordings: sheet.csv\napparatus: config/apparatus.yaml\nsimulation: {simulated: []}\n"
        "calibration: {draws: 2000}\nexperiment: {fitted: [viscous]}\ndiscovery: {rounds: 0}\n"
    )
    return command(root, folder)


def results(folder):
    """The checksums of all that a run left but logs."""
    return {
        path.relative_to(folder): checksum(path)
        for path in sorted((folder / "results").rglob("*"))
        if path.is_file() and "logs" not in path.parts and not path.name.startswith(".")
    }


@pytest.mark.slow("a whole study")
def test_a_killed_run_ends_with_the_same_bytes(root, tmp_path):
    whole = study(root, tmp_path / "whole")
    begun = time.monotonic()
    subprocess.run(whole, cwd=root, check=True, capture_output=True)
    took = time.monotonic() - begun
    killed, wanted = study(root, tmp_path / "killed"), results(tmp_path / "whole")
    assert {Path("results/report.html"), Path("results/manifest.json")} <= set(wanted)
    moments, kills = random.Random(5), 0
    while kills < KILLS:
        begun = time.monotonic()
        run = subprocess.Popen(
            killed, cwd=root, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, start_new_session=True
        )
        try:
            told, _ = run.communicate(timeout=moments.uniform(0.2, 1.0) * took)
        except subprocess.TimeoutExpired:
            os.killpg(run.pid, signal.SIGKILL)
            run.communicate()
            kills += 1
        else:  # it was whole before its moment came; the next begins anew
            assert run.returncode == 0, told
            took = min(took, time.monotonic() - begun)  # of a machine that was busy before
            assert results(tmp_path / "killed") == wanted
            shutil.rmtree(tmp_path / "killed" / "results")
    subprocess.run(killed, cwd=root, check=True, capture_output=True)
    assert results(tmp_path / "killed") == wanted
    left = tmp_path / "killed" / "results"
    assert not [*left.rglob(".*.part"), *remove_orphans(left)]
