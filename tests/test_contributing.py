"""The changes that CONTRIBUTING.md works through (docs/changes) can be made as they stand there, and do what it says."""

import os
import re
import shutil
import subprocess
import sys

import pytest


@pytest.fixture(scope="module")
def changes(root):
    """All patches that CONTRIBUTING.md links to, as one."""
    text = (root / "CONTRIBUTING.md").read_text(encoding="utf-8")
    linked = re.findall(r"\]\((\S+\.patch)\)", text)
    return "".join((root / patch).read_text(encoding="utf-8") for patch in linked)


def git_apply(changes, folder, *options):
    done = subprocess.run(
        ["git", "apply", *options, "-"], input=changes, cwd=folder, text=True, capture_output=True
    )
    assert done.returncode == 0, done.stderr


def test_the_changes_fit_the_files_as_they_are(root, changes):
    assert changes.count("+++ b/") == 11
    git_apply(changes, root, "--check")


@pytest.mark.slow("a whole copy is tested")
def test_with_the_changes_made_the_tests_pass(root, changes, tmp_path):
    """On a copy: formatter and linter find nothing, the figure is drawn, the format is read."""
    copy, ignored = tmp_path / "copy", shutil.ignore_patterns("__pycache__", "*.egg-info")
    for name in ("workflow", "tests", "config", "resources"):
        shutil.copytree(root / name, copy / name, ignore=ignored)
    for name in ("pyproject.toml", "Snakefile"):
        shutil.copy(root / name, copy / name)
    git_apply(changes, copy)
    asked = [
        "tests/pendulum/test_effects.py",
        "tests/plots/test_captions.py",
        "tests/plots/test_figures.py",
        "tests/capture/test_capture_formats.py",
    ]
    commands = [
        ["ruff", "format", "--check", "."],
        ["ruff", "check", "."],
        ["snakefmt", "--check", "workflow/rules"],
        [
            "pytest",
            "-q",
            *asked,
            "-k",
            "fig16 or one_more or decimal_commas or neither_hang or rolling_resistance or second_pendulum",
        ],
    ]
    for command in commands:
        done = subprocess.run(
            [sys.executable, "-m", *command],
            cwd=copy,
            env=os.environ | {"PYTHONPATH": str(copy / "workflow/src")},
            text=True,
            capture_output=True,
        )
        assert done.returncode == 0, done.stdout + done.stderr
    assert " passed" in done.stdout


def test_each_place_that_is_named_for_a_change_is_there(root):
    text = (root / "CONTRIBUTING.md").read_text(encoding="utf-8")
    table = text[text.index("| what | where |") : text.index("House rules:")]
    places = re.findall(r"`([\w/]+\.py)`", table)
    assert len(places) > 6
    assert [place for place in places if not (root / "workflow/src/swingdown" / place).is_file()] == []
