"""Names: of test files each is given once; what a room exports says in its docstring what it takes."""

import inspect
import pkgutil
from collections import Counter
from importlib import import_module

import swingdown


def test_each_name_is_given_once(root):
    tests = root / "tests"
    imported = [p for p in (tests / "benchmarks").rglob("*.py") if p.name != "__init__.py"]
    names = Counter(path.stem for path in {*tests.rglob("test_*.py"), *imported})
    assert {name for name, count in names.items() if count > 1} == set()


def exported():
    """(name, object) of what each room exports, with the public methods of its classes."""
    rooms = [one.name for one in pkgutil.iter_modules(swingdown.__path__, "swingdown.") if one.ispkg]
    for room in map(import_module, (swingdown.__name__, *rooms)):
        for name in getattr(room, "__all__", ()):
            yield f"{room.__name__}.{name}", (found := getattr(room, name))
            if inspect.isclass(found):
                public = [key for key in vars(found) if key[0] != "_"]
                yield from ((f"{room.__name__}.{name}.{key}", getattr(found, key)) for key in public)


def test_what_a_room_exports_says_what_it_takes():
    """In sections, as numpy's docstrings have them; of a class that only holds values these may be its attributes."""
    silent = {
        name
        for name, one in exported()
        if callable(one)
        and {*inspect.signature(one).parameters} - {"self"}
        and not {"Parameters", "Attributes"} & {*(inspect.getdoc(one) or "").splitlines()}
    }
    assert silent == set()


def test_no_room_hides_a_module_behind_a_name():
    """Else ``import room.module`` gives a function, and the site describes it twice."""
    modules = [
        one.name.rpartition(".")
        for one in pkgutil.walk_packages(swingdown.__path__, "swingdown.")
        if not one.ispkg
    ]
    hidden = [
        f"{room}.{name}"
        for room, _, name in modules
        if not inspect.ismodule(vars(import_module(room)).get(name, inspect))
    ]
    assert hidden == []
