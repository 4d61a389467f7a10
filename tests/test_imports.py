"""Imports run one way (DESIGN): a newcomer may read a module without those that come after it."""

import ast
import subprocess
import sys
from functools import cache
from pathlib import Path

import pytest

from swingdown.planning import sources

PACKAGE = sources.PACKAGE
FILES = sorted(PACKAGE.rglob("*.py"))
ONLY_IN = {"matplotlib": "plots", "serial": "capture", "docutils": "report", "markupsafe": "report"}


def room(file):
    """The module or sub-package that a file belongs to, by name."""
    return Path(file).relative_to(PACKAGE).parts[0].removesuffix(".py")


@cache
def reached(name):
    """The rooms that a room rests on, directly or through others."""
    files = [file for file in FILES if room(file) == name]
    return {room(path) for file in files for path in sources.sources(file)} - {name}


@cache
def outside(file):
    """The top names of the packages that a file imports absolutely."""
    found = []
    for node in ast.walk(ast.parse(file.read_text())):
        if isinstance(node, ast.Import):
            found += [alias.name.split(".")[0] for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and not node.level:
            found.append(node.module.split(".")[0])
    return found


def test_a_room_imports_those_below_it_and_no_other(root):
    """The order of the rooms stands in pyproject.toml; a room that is not in it fails too."""
    done = subprocess.run(
        [Path(sys.executable).with_name("lint-imports"), "--no-cache"],
        cwd=root,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.parametrize("package", ONLY_IN)
def test_a_package_is_imported_in_its_room_alone(package):
    found = {room(file) for file in FILES if package in outside(file)}
    assert found <= {ONLY_IN[package]}


def test_the_science_does_not_know_the_workflow():
    assert not [file for file in FILES if "snakemake" in outside(file)]
    above = {"answer", "__main__", "__init__"}  # what is drawn there is drawn where it is asked for
    assert not [name for name in map(room, FILES) if name not in above and "plots" in reached(name)]


def test_plots_compute_nothing():
    assert not reached("plots") & {"engine", "fitting", "calibration", "studies", "discovery", "sweep"}


def test_imports_are_found_wherever_they_stand(tmp_path):
    script = tmp_path / "script.py"
    script.write_text(
        "import numpy\nfrom swingdown.pendulum import model\ndef f():\n    from swingdown.measurement.sheet import COLUMNS\n"
        "match 1:\n    case 1:\n        try:\n            pass\n        except OSError:\n            from swingdown import prefork\n"
    )
    found = {Path(path).stem for path in sources.sources(script)}
    assert {"model", "dissipation", "errors", "sheet", "paths", "prefork"} <= found
    assert "trajectory" not in found


def test_the_quick_look_finds_what_a_parser_does(root):
    """Of the package's own files; what others import changes no code of ours."""
    for path in [*(root / "workflow/src").rglob("*.py"), *(root / "workflow/scripts").glob("*.py")]:
        text = path.read_text(encoding="utf-8")
        parsed = [one for one in ast.walk(ast.parse(text)) if isinstance(one, ast.Import | ast.ImportFrom)]
        known = {ast.unparse(one) for one in parsed}
        found = {ast.unparse(one) for one in sources._imports(text)}
        ours = {one for one in known ^ found if "swingdown" in one or one.startswith("from .")}
        assert not ours, path


def test_the_trials_beside_the_package_count_as_sources(root):
    """An edited trial runs its rules again, and so does the science that it tries."""
    found = sources.sources(root / "workflow/scripts/hidden_find.py")
    for name in ("swingdown_trials/find.py", "swingdown_trials/torques.py", "swingdown/discovery/search.py"):
        assert any(path.endswith(name) for path in found), name


def test_the_engines_c_files_count_as_sources():
    assert any(path.endswith(".c") for path in sources.sources(PACKAGE / "fitting/batch.py"))


def test_what_verdicts_are_judged_by_counts_as_a_source(root):
    """A changed threshold runs again every rule that reads it."""
    for script in ("discover_search", "discover_verdict"):
        assert any(
            path.endswith("criterion.yaml")
            for path in sources.sources(root / f"workflow/scripts/{script}.py")
        )


def test_what_a_rule_knows_of_its_code_changes_with_any_file_that_its_script_rests_on(tmp_path, monkeypatch):
    package = tmp_path / "swingdown"
    package.mkdir()
    for name, text in {"__init__": "", "near": "from . import far", "far": "a = 1", "other": "b = 1"}.items():
        (package / f"{name}.py").write_text(text)
    (tmp_path / "script.py").write_text("from swingdown import near\n")
    monkeypatch.setattr(sources, "PACKAGE", package)

    def known():
        for kept in (sources.imported, sources.fingerprint, sources._content):
            kept.cache_clear()
        return sources.fingerprint(tmp_path / "script.py")

    before = known()
    (package / "other.py").write_text("b = 2")
    assert known() == before
    (package / "far.py").write_text("a = 2")
    assert known() != before
    (package / "far.py").write_text("a = 1")
    assert known() == before
