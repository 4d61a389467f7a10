"""A package that only some uses need is asked for where it is used, and an error names what installs it."""

import json

import pytest

from swingdown.errors import PackageError
from swingdown.extras import EXTRAS, has, lacking, needed


def test_what_is_there_is_imported():
    assert has("json") and needed("json.decoder") is json.decoder and not has("no_such_package")


@pytest.mark.parametrize("module", ["serial", "serial.tools.list_ports"])
def test_what_is_not_there_is_told_with_what_installs_it(monkeypatch, module):
    monkeypatch.setattr("swingdown.extras.import_module", missing("serial"))
    with pytest.raises(PackageError) as told:
        needed(module)
    assert str(told.value).startswith(
        "package serial: a recording at the bench needs the package serial, which is not installed."
    )
    assert told.value.mend == "pip install 'swingdown[capture]'" and isinstance(told.value, ImportError)


def test_a_package_that_lacks_one_of_its_own_says_so_itself(monkeypatch):
    monkeypatch.setattr("swingdown.extras.import_module", missing("another"))
    with pytest.raises(ModuleNotFoundError, match="another") as told:
        needed("serial")
    assert not isinstance(told.value, PackageError)


def missing(name):
    def fail(_):
        raise ModuleNotFoundError(f"No module named {name!r}", name=name)

    return fail


@pytest.mark.parametrize("package", EXTRAS)
def test_each_package_has_an_extra_that_brings_it(package):
    extra, use = EXTRAS[package]
    assert (
        lacking(package).expected == f"swingdown with its extra `{extra}`" and use in lacking(package).problem
    )
