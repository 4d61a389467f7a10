"""Labelled datasets on disk: whole or not there, compressed so that damage shows, every number with a unit."""

import errno
import shutil
from collections.abc import Hashable, Iterator
from pathlib import Path
from typing import Any

import netCDF4
import numpy as np
import xarray as xr

from .errors import InputError
from .paths import written_whole

CONVENTIONS = "CF-1.8"


def write(dataset: xr.Dataset, path: str | Path) -> Path:
    """The path written. The file appears under its name only when it is complete and on the disk.

    Every numeric and text variable is compressed with zlib, because a flipped bit in an uncompressed file
    goes unnoticed. A float variable without ``units`` and ``long_name`` raises ValueError; a full disk raises
    OSError (ENOSPC) with the space wanted and free. Nothing is left behind by a write that fails.
    """
    path = Path(path)
    if lost := [f"{name}: no {key}" for name, key in _unlabelled(dataset)]:
        raise ValueError(f"{path} is not written. {'; '.join(lost)}")
    dataset = _with_plain_text(dataset).assign_attrs(Conventions=CONVENTIONS)
    encoding: dict[Hashable, dict[str, Any]] = {
        name: {"zlib": True, "complevel": 4} for name in dataset.variables
    }
    for name, variable in dataset.variables.items():
        if variable.dtype.kind == "U":  # variable-length strings cannot be compressed, characters can
            encoding[name]["dtype"] = "S1"
        elif variable.dtype.kind == "f":
            encoding[name]["_FillValue"] = None if name in dataset.coords else np.nan

    try:
        with written_whole(path) as partial:
            dataset.to_netcdf(partial, engine="netcdf4", format="NETCDF4", encoding=encoding)
            with netCDF4.Dataset(
                partial, "a"
            ) as file:  # last of all: a killed writer leaves a file that opens cleanly
                file.setncattr("complete", np.int32(1))
    except (OSError, RuntimeError) as error:
        free = shutil.disk_usage(path.parent).free
        if (
            getattr(error, "errno", None) == errno.ENOSPC or free < dataset.nbytes
        ):  # netCDF says only "HDF error"
            raise OSError(
                errno.ENOSPC,
                f"the disk is full: {path} needs up to {dataset.nbytes / 1e6:.3g} MB and "
                f"{free / 1e6:.3g} MB are free. Mend: make room and run again",
            ) from error
        raise
    return path


def read(path: str | Path) -> xr.Dataset:
    """The dataset of a file written by ``write``, loaded whole.

    A file that is missing, damaged, incomplete, or that lost the unit of a float variable raises InputError.
    """
    path = Path(path)
    if not path.exists():
        raise InputError(
            path, "there is no such file", "a dataset written by an earlier step", "run that step again"
        )
    mend = "delete it and run the step that makes it again"
    try:
        dataset = xr.load_dataset(path, engine="netcdf4", decode_times=False, decode_timedelta=False)
    except (OSError, RuntimeError, ValueError) as error:
        raise InputError(path, f"it cannot be read ({error})", "an undamaged netCDF file", mend) from error
    if dataset.attrs.get("complete") != 1:
        raise InputError(
            path, "it has no completeness mark", "the attribute complete = 1, written last", mend
        )
    if lost := [f"{name} has no {key}" for name, key in _unlabelled(dataset) if key == "units"]:
        raise InputError(path, "; ".join(lost), "units on every float variable", mend)
    return dataset


def attributes(path: str | Path) -> dict[str, Any]:
    """The attributes of a file written by ``write``, as a dict; its data are not read."""
    with netCDF4.Dataset(path) as file:
        return {name: file.getncattr(name) for name in file.ncattrs()}


def _unlabelled(dataset: xr.Dataset) -> Iterator[tuple[Hashable, str]]:
    for name, variable in dataset.variables.items():
        if variable.dtype.kind == "f":
            yield from ((name, key) for key in ("units", "long_name") if key not in variable.attrs)


def _with_plain_text(dataset: xr.Dataset) -> xr.Dataset:
    texts = {n: v.astype(str) for n, v in dataset.variables.items() if v.dtype.kind not in "fiubSUMm"}
    return dataset.assign({n: (v.dims, np.asarray(v.values, dtype="U"), v.attrs) for n, v in texts.items()})
