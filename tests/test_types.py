"""Annotations hold: mypy finds nothing, and in the rooms that are done no function is without them."""

import subprocess
import sys
import tomllib
from pathlib import Path


def test_mypy_finds_nothing(root):
    done = subprocess.run([sys.executable, "-m", "mypy"], cwd=root, text=True, capture_output=True)
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_rooms_that_are_done_exist(root):
    overrides = tomllib.loads((root / "pyproject.toml").read_text())["tool"]["mypy"]["overrides"]
    (done,) = [one["module"] for one in overrides if one.get("disallow_untyped_defs")]
    for name in done:
        parts = name.removesuffix(".*").split(".")
        place = Path(root, "workflow/src", *parts)
        assert place.is_dir() if name.endswith(".*") else place.with_suffix(".py").is_file(), name
