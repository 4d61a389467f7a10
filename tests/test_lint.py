"""Style is checked by machine: ruff on every Python file, Snakemake's own lint on the rules."""

import re
import subprocess
import sys

import pytest


def test_ruff_finds_nothing(root):
    done = subprocess.run(
        [sys.executable, "-m", "ruff", "check", "workflow", "tests", "resources", "--output-format", "concise"],
        cwd=root, text=True, capture_output=True,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.parametrize("words", [(), ("--config", "recording=swing-07")], ids=["study", "capture"])
def test_snakemakes_lint_asks_for_environments_alone(snakemake, tmp_path, words):
    """A conda or container directive that nobody has run would be a false promise; all else must be in order."""
    done = snakemake("--lint", *words, directory=tmp_path, check=False)
    findings = set(re.findall(r"^ +\* (.+?):?$", done.stdout, re.MULTILINE))
    assert findings == {"Specify a conda environment or container for each rule."}, done.stdout


def test_no_script_imports_another_or_touches_the_path(root):
    for script in (root / "workflow/scripts").glob("*.py"):
        text = script.read_text()
        assert "sys.path" not in text, script
        assert "from __future__" not in text, script
        assert text.count('if __name__ == "__main__":') == 1, script
