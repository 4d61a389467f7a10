"""What the pages of docs/ tell to type works as it stands there, and prints what they show.

A comment before a block says what it is: ``<!-- run -->``, or ``<!-- run slow -->`` for what takes longer, runs its commands (Python
where the block says so) one after the other in a folder that looks like a fresh clone; ``<!-- file: NAME -->`` writes it there;
``<!-- prints -->`` holds each of its lines to be printed by the block before.
"""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
BLOCK = re.compile(
    r"^<!-- (run|run slow|prints|file: \S+) -->\n```(\w*)\n(.*?)^```$", re.DOTALL | re.MULTILINE
)
PAGES = {
    path.name: BLOCK.findall(path.read_text(encoding="utf-8"))
    for path in sorted((ROOT / "docs").glob("*.md"))
}
PAGES = {name: blocks for name, blocks in PAGES.items() if blocks}
FIRST = ("notebook.md", "own-file.md")
# what a clone has, but for what is made in it
THERE = (
    ".venv",
    "Makefile",
    "Snakefile",
    "config",
    "docs",
    "profiles",
    "pyproject.toml",
    "resources",
    "workflow",
)


@pytest.fixture
def clone(tmp_path):
    """A folder with the project in it, where results are made and none is there yet."""
    for name in THERE:
        (tmp_path / name).symlink_to(ROOT / name)
    return tmp_path


def run(page, folder, slow):
    """Follows a page: its files are written, its commands run, what they print is held against what it shows."""
    printed = ""
    for kind, language, text in PAGES[page]:
        if kind.startswith("file: "):
            path = folder / kind.removeprefix("file: ")
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
        elif kind == "prints":
            missing = [line for line in text.splitlines() if printed and line.strip() not in printed]
            assert not missing, f"{page} shows lines that are not printed: {missing}\n{printed[-4000:]}"
        elif kind == "run" or slow:
            command = (
                [".venv/bin/python", "-c", text]
                if language == "python"
                else ["bash", "-euo", "pipefail", "-c", text]
            )
            done = subprocess.run(
                command,
                cwd=folder,
                env=os.environ | {"PYTHONUNBUFFERED": "1"},
                text=True,
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
            )
            assert done.returncode == 0, f"{page}: {text}\n{done.stdout[-4000:]}"
            printed = done.stdout
        else:
            printed = ""


def _marked(page):
    """The page as a test of its own: the two that one begins with are of the usual ones."""
    return pytest.param(page, marks=() if page in FIRST else pytest.mark.slow("a page's commands"))


@pytest.mark.parametrize(
    "page", [_marked(page) for page, blocks in PAGES.items() if any(b[0].startswith("run") for b in blocks)]
)
def test_what_a_page_tells_to_type_works(page, clone, pytestconfig):
    wanted = os.environ.get("SWINGDOWN_SLOW") or "slow" in (pytestconfig.option.markexpr or "")
    run(page, clone, slow=bool(wanted))


def test_each_kind_of_user_has_a_tutorial_that_is_run():
    assert {
        "own-file.md",
        "class.md",
        "bench.md",
        "paper.md",
        "sweeps.md",
        "own-effect.md",
        "notebook.md",
    } <= set(PAGES)


def test_the_first_command_of_the_readme_names_a_file_that_the_project_ships(root, tmp_path):
    command = re.search(r"^make start FILE=(\S+)", (root / "README.md").read_text(), re.M)
    shipped = root / command[1]
    subprocess.run([sys.executable, root / "docs/examples.py", tmp_path / "anna.csv"], check=True)
    assert shipped.read_bytes() == (tmp_path / "anna.csv").read_bytes()


def test_a_missing_file_is_told_before_anything_is_set_up(root, tmp_path):
    shutil.copy(root / "Makefile", tmp_path)
    for given, told in (("FILE=none.csv", "There is no file or folder none.csv"), ("FILE=", "Which file?")):
        done = subprocess.run(
            ["make", "-s", "start", given], cwd=tmp_path, capture_output=True, text=True, check=False
        )
        assert done.returncode == 2 and told in done.stderr
        assert not (tmp_path / ".venv").exists()
