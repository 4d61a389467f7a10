"""Labelled datasets on disk: whole or not there, with checksums so that damage shows, every number with a unit."""

import errno
import importlib.metadata
import shutil
from collections.abc import Hashable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from .arrays import Floats
from .calmed import calmed
from .errors import MAKE_ANEW, InputError, Unwritten
from .extras import needed
from .paths import written_whole
from .sealed import check_behind, seal_behind

CONVENTIONS = "CF-1.11"
SEALED = "sealed"  # the attribute that tells of a seal behind the end, which a program that changes the file cuts off
Labelled = tuple[str | tuple[str, ...], Any, dict[str, str]]
REFUSED = "refused"  # the role of a dataset without samples that says why a recording cannot be used


def variable(
    dims: str | tuple[str, ...], values: Any, long_name: str, units: str = "", **more: str
) -> Labelled:
    """What xarray makes a variable of that says what it is: dimensions, values, and attributes, of which ``units`` may be none."""
    return dims, values, ({"units": units} if units else {}) | more | {"long_name": long_name}


def write(dataset: xr.Dataset, path: str | Path, replace: bool = True) -> Path:
    """The path written. The file appears under its name only when it is complete and on the disk.

    Every variable is compressed with zlib and carries the format's own checksum (Fletcher-32), which any reader of
    netCDF verifies. What lies between the variables (the index of their pieces, text of variable length) has none, so the
    file has a seal as well (``sealed.seal_behind``). What the CF Conventions ask of every file (title, history without a date,
    source, a name for each variable) is added where the dataset does not say it itself.

    A write that fails leaves nothing behind: ValueError if a float variable lacks ``units`` or ``long_name``, Unwritten if the disk is
    full (ENOSPC), with the space wanted and free, FileExistsError unless it may ``replace`` a file of that name.
    """
    path, netcdf = Path(path), needed("netCDF4")
    if lost := [f"{name}: no {key}" for name, key in _unlabelled(dataset)]:
        raise ValueError(f"{path} is not written. {'; '.join(lost)}")
    dataset = _described(_with_plain_text(dataset), path)
    encoding: dict[Hashable, dict[str, Any]] = {
        name: {"zlib": True, "complevel": 4, "fletcher32": True} for name in dataset.variables
    }
    for name, variable in dataset.variables.items():
        if variable.dtype.kind == "U":  # variable-length strings cannot be compressed, characters can
            encoding[name]["dtype"] = "S1"
        elif variable.dtype.kind == "f":
            encoding[name]["_FillValue"] = None if name in dataset.coords else np.nan
        elif variable.dtype == np.int64 and np.all(np.abs(variable.values) < 2**31):
            encoding[name]["dtype"] = "int32"  # the Conventions know no longer integers

    try:
        with written_whole(path, replace) as partial:
            # a dimension of nothing comes back from a file as one without a limit
            form: dict[str, Any] = {"engine": "netcdf4", "format": "NETCDF4", "unlimited_dims": ()}
            dataset.to_netcdf(partial, encoding=encoding, **form)
            # last of all: a killed writer leaves a file that opens cleanly
            with netcdf.Dataset(partial, "a") as file:
                file.setncattr(SEALED, "SHA-256 behind the end")
                file.setncattr("complete", np.int32(1))
            seal_behind(partial)
    except (OSError, RuntimeError) as error:
        free = shutil.disk_usage(path.parent).free
        # netCDF says only "HDF error"
        if getattr(error, "errno", None) == errno.ENOSPC or free < dataset.nbytes:
            needs = f"{path} needs up to {dataset.nbytes / 1e6:.3g} MB and {free / 1e6:.3g} MB are free"
            told = f"the disk is full: {needs}. Mend: make room and run again"
            raise Unwritten(errno.ENOSPC, told) from error
        raise
    return path


def series_of(data: xr.Dataset, part: str = "") -> xr.DataArray:
    """What a sensor read, of a dataset of ``results/angles``: ``angle`` (rad) or ``rate`` (rad/s), over ``time`` (s); or a ``part`` that goes
    with it, such as ``bound`` or ``random_uncertainty``, KeyError where there is none."""
    name = "rate" if "rate" in data else "angle"
    return data[f"{name}_{part}" if part else name]


def quiet_of(data: xr.Dataset) -> Floats:
    """What a sensor read, for whoever counts its swings: as it is, or of a rate ``calmed``, whose noise may hide them."""
    series = series_of(data)
    return calmed(data["time"].values, series.values, False) if series.name == "rate" else series.values


def read(path: str | Path) -> xr.Dataset:
    """The dataset of a netCDF file written by ``write``, loaded whole.

    InputError where the file is missing, damaged, incomplete, changed since, or lost the unit of a float variable. Of a file that stands for a
    recording that cannot be used it is that recording's.
    """
    needed("netCDF4")
    with reading(path):
        dataset = xr.load_dataset(path, engine="netcdf4", decode_times=False, decode_timedelta=False)
    if dataset.attrs.get("complete") != 1:
        expected = "the attribute complete = 1, written last"
        raise InputError(path, "it has no completeness mark", expected, MAKE_ANEW)
    if lost := [f"{name} has no {key}" for name, key in _unlabelled(dataset) if key == "units"]:
        raise InputError(path, "; ".join(lost), "units on every float variable", MAKE_ANEW)
    dataset.attrs.pop(SEALED, None)
    if dataset.attrs.get("role") == REFUSED:
        raise InputError(*(dataset.attrs[key] for key in ("where", "problem", "expected", "mend")))
    return dataset


def _check_sealed(path: str | Path) -> None:
    """None where a file's bytes are those that were written, or it was written without a seal; InputError where another program changed it."""
    if check_behind(Path(path)):
        return
    with needed("netCDF4").Dataset(path) as file:
        if SEALED in file.ncattrs():
            problem = "another program has changed it: the seal behind its end is gone"
            raise InputError(path, problem, "the file as it was written", MAKE_ANEW)


def attributes(path: str | Path) -> dict[str, Any]:
    """The attributes of a file written by ``write``, as a dict; its data are not read. InputError for a damaged one."""
    with opened(path) as file:
        return {name: file.getncattr(name) for name in file.ncattrs()}


@contextmanager
def opened(path: str | Path) -> Iterator[Any]:
    """The netCDF4.Dataset of a file written by ``write``, open for a block; errors as of ``reading``."""
    with reading(path), needed("netCDF4").Dataset(path) as file:
        yield file


@contextmanager
def reading(path: str | Path) -> Iterator[None]:
    """A block that reads the netCDF file ``path``: whatever goes wrong in it is told as an InputError."""
    if not Path(path).exists():
        raise InputError(path, "there is no such file", "a dataset written by an earlier step", "give the same command again")  # fmt: skip
    try:
        _check_sealed(path)
        yield
    except (InputError, MemoryError):
        raise
    except Exception as error:  # a damaged file makes the reader fail in ways that nobody listed
        problem = f"it cannot be read ({error})"
        raise InputError(path, problem, "an undamaged netCDF file", MAKE_ANEW) from error


def _unlabelled(dataset: xr.Dataset) -> Iterator[tuple[Hashable, str]]:
    for name, variable in dataset.variables.items():
        if variable.dtype.kind == "f":
            yield from ((name, key) for key in ("units", "long_name") if key not in variable.attrs)


def _described(dataset: xr.Dataset, path: Path) -> xr.Dataset:
    told = {
        "title": f"{path.resolve().parent.name}: {path.stem}",
        "source": "swingdown",
        "history": f"written by swingdown {importlib.metadata.version('swingdown')}",  # undated: the same run, the same bytes
    }
    dataset = dataset.assign_attrs(told | dataset.attrs | {"Conventions": CONVENTIONS})
    unnamed = [name for name, variable in dataset.variables.items() if "long_name" not in variable.attrs]
    for name in unnamed:
        dataset[name].attrs["long_name"] = str(name).replace("_", " ")
    return dataset


def _with_plain_text(dataset: xr.Dataset) -> xr.Dataset:
    texts = {n: v.astype(str) for n, v in dataset.variables.items() if v.dtype.kind not in "fiubSUMm"}
    return dataset.assign({n: (v.dims, np.asarray(v.values, dtype="U"), v.attrs) for n, v in texts.items()})
