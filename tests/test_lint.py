"""Style is checked by machine: ruff on every Python file, snakefmt and Snakemake's own lint on the rules."""

import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
import yaml

CHECKS = {
    "formatter": ["ruff", "format", "--check", "."],
    "linter": ["ruff", "check", "--output-format", "concise", "."],
    "rules": ["snakefmt", "--check", "Snakefile", "workflow/rules"],
}


@pytest.mark.parametrize("check", CHECKS)
def test_nothing_is_left_to_do(root, check):
    """What is checked here is what .pre-commit-config.yaml does before a commit."""
    command = [Path(sys.executable).with_name(CHECKS[check][0]), *CHECKS[check][1:]]
    done = subprocess.run(command, cwd=root, text=True, capture_output=True)
    assert done.returncode == 0, done.stdout + done.stderr


def test_python_and_rules_have_lines_of_one_length(root):
    tools = tomllib.loads((root / "pyproject.toml").read_text())["tool"]
    assert tools["snakefmt"]["line_length"] == tools["ruff"]["line-length"]


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


def test_the_hooks_before_a_commit_call_tools_that_are_there(root):
    """A hook's program, with what it is called with, runs in the environment that make lays."""
    (local,) = yaml.safe_load((root / ".pre-commit-config.yaml").read_text())["repos"]
    for hook in local["hooks"]:
        program, *words = hook["entry"].split()
        tool = Path(sys.executable).with_name(Path(program).name)
        done = subprocess.run([tool, *words, "--help"], cwd=root, text=True, capture_output=True)
        assert program.startswith(".venv/bin/") and done.returncode == 0, hook["id"]
    told = {hook["entry"].split()[0].removeprefix(".venv/bin/") for hook in local["hooks"]}
    assert told == {"ruff", "snakefmt", "mypy", "lint-imports"}


def test_hosted_ci_and_ci_run_the_same_parts(root):
    hosted = yaml.safe_load((root / ".github/workflows/ci.yml").read_text())
    steps = [step["run"] for job in hosted["jobs"].values() for step in job["steps"] if "run" in step]
    assert {".ci/run", "make test", "sudo tools/install-test-tools"} <= set(steps)
    named = [path for run in steps for path in re.findall(r"[\w./]+\.py|\.ci/run|tools/[\w-]+", run)]
    assert all((root / path).is_file() for path in named), named


def test_the_changelog_tells_the_version_that_the_project_has(root):
    version = tomllib.loads((root / "pyproject.toml").read_text())["project"]["version"]
    headings = re.findall(r"^## \[(.+?)\]", (root / "CHANGELOG.md").read_text(), re.MULTILINE)
    assert headings[:2] == ["Unreleased", version]
