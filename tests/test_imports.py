"""Imports run one way (DESIGN): a newcomer may read a module without those that come after it."""

import ast
from pathlib import Path

import pytest

from swingdown import sources

PACKAGE = sources.PACKAGE
FILES = sorted(PACKAGE.rglob("*.py"))
# Each chain runs from what knows nothing of the rest to what rests on it; missing modules are to come.
CHAINS = (
    ("errors", "formula", "effects", "model", "trajectory", "fit", "discovery"),
    ("errors", "paths", "sheet", "recording", "calibration", "angle"),
    ("fit", "norms", "tables", "report"),
    ("calibration", "norms"),
    ("effects", "model", "settings", "sweep"),
    ("fit", "discovery", "sweep"),
)
ONLY_IN = {"matplotlib": "plots", "serial": "capture", "docutils": "report", "jinja2": "report"}


def room(file):
    """The module or sub-package that a file belongs to, by name."""
    return Path(file).relative_to(PACKAGE).parts[0].removesuffix(".py")


def reached(name):
    """The rooms that a room rests on, directly or through others."""
    files = [file for file in FILES if room(file) == name]
    return {room(path) for file in files for path in sources.sources(file)} - {name}


def outside(file):
    """The top names of the packages that a file imports absolutely."""
    for node in ast.walk(ast.parse(file.read_text())):
        if isinstance(node, ast.Import):
            yield from (alias.name.split(".")[0] for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and not node.level:
            yield node.module.split(".")[0]


@pytest.mark.parametrize("chain", CHAINS, ids=" -> ".join)
def test_nothing_imports_what_comes_after_it(chain):
    for position, name in enumerate(chain):
        later = set(chain[position + 1 :])
        assert not reached(name) & later, f"{name} rests on {reached(name) & later}"


@pytest.mark.parametrize("package", ONLY_IN)
def test_a_package_is_imported_in_its_room_alone(package):
    found = {room(file) for file in FILES if package in outside(file)}
    assert found <= {ONLY_IN[package]}


def test_the_science_does_not_know_the_workflow():
    assert not [file for file in FILES if "snakemake" in outside(file)]
    assert not [name for name in map(room, FILES) if "plots" in reached(name)]


def test_plots_compute_nothing():
    assert not reached("plots") & {
        "trajectory",
        "fit",
        "calibration",
        "simulation",
        "experiment",
        "discovery",
        "sweep",
    }


def test_imports_are_found_wherever_they_stand(tmp_path):
    script = tmp_path / "script.py"
    script.write_text(
        "import numpy\nfrom swingdown import effects\ndef f():\n    from swingdown.sheet import COLUMNS\n"
    )
    found = {Path(path).stem for path in sources.sources(script)}
    assert {"effects", "formula", "errors", "sheet", "paths"} <= found
    assert "fit" not in found


def test_the_engines_c_files_count_as_sources():
    assert any(path.endswith(".c") for path in sources.sources(PACKAGE / "fit.py"))
