"""Packages that only some uses need: they come with an extra of the package, and each is imported where it is first used."""

from importlib import import_module
from importlib.util import find_spec
from typing import Any

from .errors import PackageError

_WORKFLOW = "workflow"
# A module, the extra of pyproject.toml that brings it, and what it is needed for.
EXTRAS = {
    "cv2": ("video", "a film"),
    "docutils": (_WORKFLOW, "a caption with formulas"),
    "jsonschema": (_WORKFLOW, "settings and sheets of one's own"),
    "labjack": ("labjack", "a LabJack"),
    "matplotlib": (_WORKFLOW, "a picture"),
    "netCDF4": (_WORKFLOW, "a netCDF file"),
    "openpyxl": ("spreadsheet", "a table as a spreadsheet"),
    "python_calamine": (_WORKFLOW, "a workbook"),
    "serial": ("capture", "a recording at the bench"),
    "snakemake": (_WORKFLOW, "a study by its config"),
    "sympy": (_WORKFLOW, "an effect of one's own, or an engine compiled on this machine,"),
    "zarr": (_WORKFLOW, "a sweep into a Zarr store"),
}


def has(package: str) -> bool:
    """Whether the package of an extra is installed."""
    return find_spec(package) is not None


def needed(module: str) -> Any:
    """The module of this name, imported; PackageError with the mend where the package that has it is not installed."""
    try:
        return import_module(module)
    except ModuleNotFoundError as problem:
        package = module.partition(".")[0]
        if (problem.name or "").partition(".")[0] != package:
            raise
        raise lacking(package) from None


def lacking(package: str) -> PackageError:
    """The refusal of what needs a package of an extra that is not installed."""
    extra, use = EXTRAS[package]
    problem = f"{use} needs the package {package}, which is not installed"
    expected, mend = f"swingdown with its extra `{extra}`", f"pip install 'swingdown[{extra}]'"
    return PackageError(f"package {package}", problem, expected, mend)
