"""No two test files, and no two modules that tests import by name, are called alike: pytest and sys.path know them by that name."""

from collections import Counter


def test_each_name_is_given_once(root):
    tests = root / "tests"
    imported = [p for p in (tests / "benchmarks").rglob("*.py") if p.name != "__init__.py"]
    names = Counter(path.stem for path in {*tests.rglob("test_*.py"), *imported})
    assert {name for name, count in names.items() if count > 1} == set()
