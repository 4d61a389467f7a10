"""What stands for the code of a computation changes with what is computed, and with no word beside it."""

import re

import pytest

from swingdown.sweep import code
from swingdown.sweep.code import project, version


@pytest.mark.parametrize("computes", ["identification", "detection"])
def test_eight_digits_stand_for_it(computes):
    assert re.fullmatch("[0-9a-f]{8}", version(computes)) and re.fullmatch(r"[\d.]+.*", project())


def test_computations_that_rest_on_other_files_have_other_digits():
    assert version("identification") != version("detection")


@pytest.mark.parametrize(
    ("name", "before", "after", "same"),
    [
        ("a.py", 'x = 1\n', 'x = 1  # one\n\n', True),
        ("a.py", '"""Told."""\nx = 1\n', '"""Otherwise."""\nx = (1)\n', True),
        ("a.py", 'def f():\n    "a"\n    return 1\n', 'def f():\n    "b"\n    return 1\n', True),
        ("a.py", 'class A:\n    """a"""\n    x = 1\n', 'class A:\n    """b"""\n    x = 1\n', True),
        ("a.py", 'def f():\n    return "a"\n', 'def f():\n    return "b"\n', False),
        ("a.py", 'if x:\n    "a"\n', 'if x:\n    "b"\n', False),
        ("a.py", 'x = 1\n', 'x = 2\n', False),
        ("a.yaml", "a: 1\nb: 2\n", "# one\nb: 2\na: 1\n", True),
        ("a.yaml", "a: 1\n", "a: 2\n", False),
        ("a.c", "int x = 1; // one\n", "int x  = 1; /* two\n lines */\n", True),
        ("a.c", 'char *x = "//a";', 'char *x = "//b";', False),
        ("a.c", "int x = 1;", "int x = 2;", False),
    ],
)  # fmt: skip
def test_comments_and_layout_are_no_code(tmp_path, monkeypatch, name, before, after, same):
    """As of a file of a room whose code makes the numbers."""
    room = tmp_path / "pendulum"
    for folder in (room, tmp_path / "sweep"):
        folder.mkdir()
    (tmp_path / "sweep" / "made_up.py").touch()
    monkeypatch.setattr(code, "PACKAGE", tmp_path)
    monkeypatch.setattr(code, "__file__", str(tmp_path / "sweep" / "code.py"))
    monkeypatch.setattr(code, "sources", lambda module: [str(room / name)])
    told = []
    for text in (before, after):
        (room / name).write_text(text)
        version.cache_clear()
        told.append(version("made_up"))
    version.cache_clear()
    assert (told[0] == told[1]) is same
