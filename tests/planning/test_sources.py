"""A script rests on what it imports, wherever in it that stands, and on what that imports."""

import pytest

from swingdown.planning.sources import PACKAGE, fingerprint, imported, sources

SCRIPT = """\
import numpy
import swingdown.errors
from swingdown import rounding as r
from swingdown.pendulum import model, Nothing


def f():
    from swingdown.paths import find
    if numpy:
        import swingdown_trials.find
    else:
        from swingdown.engine import trajectory


try:
    from . import x
except ImportError:
    from swingdown import schema
finally:
    from swingdown import sealed
"""


@pytest.fixture
def script(tmp_path):
    def written(text, name="one.py"):
        (tmp_path / name).write_text(text)
        return tmp_path / name

    return written


def names(paths):
    return [path.relative_to(PACKAGE.parent).as_posix() for path in paths]


def test_imports_are_found_wherever_they_stand(script):
    assert names(imported(script(SCRIPT))) == [
        "swingdown/errors.py", "swingdown/rounding.py", "swingdown/pendulum/__init__.py", "swingdown/pendulum/model.py",
        "swingdown/paths.py", "swingdown_trials/find.py", "swingdown/engine/__init__.py", "swingdown/engine/trajectory.py",
        "swingdown/schema.py", "swingdown/sealed.py",
    ]  # fmt: skip


def test_imports_inside_the_package_are_from_where_a_file_lies():
    found = names(imported(PACKAGE / "measurement" / "points" / "swing_counts.py"))
    assert found == [
        "swingdown/arrays.py",
        "swingdown/pendulum/__init__.py",
        "swingdown/pendulum/half_swings.py",
    ]


def test_a_script_rests_on_all_that_its_imports_import_and_on_the_data_beside_a_package(script):
    found = sources(script("from swingdown.engine import trajectory\n"))
    assert found == sorted(set(found))
    inside = [one.removeprefix(f"{PACKAGE}/") for one in found]
    assert {
        "engine/trajectory.py",
        "engine/generate.py",
        "pendulum/effect.py",
        "errors.py",
        "arrays.py",
    } <= set(inside)
    assert any(one.endswith(".c") for one in inside) and any(one.endswith(".h") for one in inside)
    assert not any(one.startswith(("plots", "report", "capture")) for one in inside)
    assert sources(script("import numpy\n", "two.py")) == []


def test_a_fingerprint_is_of_the_files_alone(script):
    one, two, other = (
        script(text, f"{k}.py")
        for k, text in enumerate(
            (
                "import swingdown.arrays\n",
                "x = 1\nfrom swingdown import arrays\n",
                "import swingdown.errors\n",
            )
        )
    )
    assert fingerprint(one) == fingerprint(two) != fingerprint(other)
    assert len(fingerprint(one)) == 16 and int(fingerprint(one), 16) >= 0
