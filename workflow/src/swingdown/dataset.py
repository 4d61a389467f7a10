"""Labelled datasets on disk: whole or not there, with checksums so that damage shows, every number with a unit."""

import errno
import hashlib
import importlib.metadata
import json
import os
import shutil
from collections.abc import Hashable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import netCDF4
import numpy as np
import xarray as xr

from .errors import InputError
from .paths import written_whole

CONVENTIONS = "CF-1.11"
DIGEST = "content_sha256"  # the attribute that holds the digest of all the rest
_SEAL = b"\nswingdown sha256 "
_MAKE_AGAIN = "delete it and run the step that makes it again"


def write(dataset: xr.Dataset, path: str | Path) -> Path:
    """The path written. The file appears under its name only when it is complete and on the disk.

    Every variable is compressed with zlib and carries the format's own checksum (Fletcher-32), which any reader of
    netCDF verifies. What lies between the variables (the index of their pieces, text of variable length) has none, so a
    SHA-256 of the content as it is read back goes beside it, and one of the bytes behind the end of the file. What the CF Conventions ask of every file (title, history
    without a date, source, a name for each variable) is added where the dataset does not say it itself. A float variable without ``units`` and ``long_name`` raises ValueError; a full disk raises
    OSError (ENOSPC) with the space wanted and free. Nothing is left behind by a write that fails.
    """
    path = Path(path)
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
        with written_whole(path) as partial:
            # a dimension of nothing comes back from a file as one without a limit
            dataset.to_netcdf(
                partial, engine="netcdf4", format="NETCDF4", encoding=encoding, unlimited_dims=()
            )
            digest = _digest(_load(partial))
            with netCDF4.Dataset(
                partial, "a"
            ) as file:  # last of all: a killed writer leaves a file that opens cleanly
                file.setncattr(DIGEST, digest)
                file.setncattr("complete", np.int32(1))
            seal(partial)
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


def series_of(data: xr.Dataset, part: str = "") -> xr.DataArray:
    """What a sensor read, of a dataset of ``results/angles``: the variable ``angle`` (rad), or ``rate`` (rad/s) where it has that.

    ``part`` names one that goes with it, such as ``bound`` or ``random_uncertainty``; KeyError where there is none.
    """
    name = "rate" if "rate" in data else "angle"
    return data[f"{name}_{part}" if part else name]


def read(path: str | Path) -> xr.Dataset:
    """The dataset of a file written by ``write``, loaded whole.

    A file that is missing, damaged, incomplete, changed since, or that lost the unit of a float variable raises InputError.
    """
    path = Path(path)
    if not path.exists():
        raise InputError(
            path, "there is no such file", "a dataset written by an earlier step", "run that step again"
        )
    mend = _MAKE_AGAIN
    with reading(path):
        dataset = _load(path)
    if dataset.attrs.get("complete") != 1:
        raise InputError(
            path, "it has no completeness mark", "the attribute complete = 1, written last", mend
        )
    if lost := [f"{name} has no {key}" for name, key in _unlabelled(dataset) if key == "units"]:
        raise InputError(path, "; ".join(lost), "units on every float variable", mend)
    written = dataset.attrs.pop(DIGEST, None)  # files made before there were digests have none
    if written is not None and written != _digest(dataset):
        raise InputError(
            path, "its content is not what was written", f"the content that {DIGEST} was taken of", mend
        )
    return dataset


def attributes(path: str | Path) -> dict[str, Any]:
    """The attributes of a file written by ``write``, as a dict; its data are not read. InputError for a damaged one."""
    with reading(path), netCDF4.Dataset(path) as file:
        return {name: file.getncattr(name) for name in file.ncattrs()}


@contextmanager
def reading(path: str | Path) -> Iterator[None]:
    """A block that reads the netCDF file ``path``: whatever goes wrong in it is told as an InputError."""
    check_seal(Path(path))
    try:
        yield
    except (InputError, MemoryError):
        raise
    except Exception as error:  # a damaged file makes the reader fail in ways that nobody listed
        raise InputError(
            path, f"it cannot be read ({error})", "an undamaged netCDF file", _MAKE_AGAIN
        ) from error


def seal(path: Path) -> None:
    """The file with the SHA-256 of its bytes behind its end, where readers of netCDF do not look.

    A damaged book of the format can make its library crash rather than complain, so damage must show before that is asked.
    A program that changes the file cuts the seal off; ``DIGEST`` then tells.
    """
    with path.open("r+b") as file:
        digest = hashlib.file_digest(file, "sha256").hexdigest()
        file.seek(0, os.SEEK_END)
        file.write(_SEAL + digest.encode())


def check_seal(path: Path) -> None:
    """None where a file's bytes are those that were written, or it has no seal; InputError where they are not."""
    with path.open("rb") as file:
        size = file.seek(0, os.SEEK_END) - len(_SEAL) - 64
        file.seek(max(size, 0))
        tail = file.read()
        if size <= 0 or not tail.startswith(_SEAL):
            return
        found, left = hashlib.sha256(), size
        file.seek(0)
        while left:
            piece = file.read(min(left, 1 << 20))
            found.update(piece)
            left -= len(piece)
    if tail[len(_SEAL) :] != found.hexdigest().encode():
        raise InputError(
            path,
            "it cannot be read (its bytes are not those that were written)",
            "an undamaged netCDF file",
            _MAKE_AGAIN,
        )


def _load(path: Path) -> xr.Dataset:
    return xr.load_dataset(path, engine="netcdf4", decode_times=False, decode_timedelta=False)


def _digest(dataset: xr.Dataset) -> str:
    """The SHA-256 of names, dimensions, types, values and attributes, as xarray reads them; in hexadecimal."""
    found = hashlib.sha256()
    attributes = {key: value for key, value in dataset.attrs.items() if key not in ("complete", DIGEST)}
    found.update(_text([dict(dataset.sizes), attributes]))
    for name, variable in sorted(dataset.variables.items(), key=lambda item: str(item[0])):
        values = variable.values
        plain = values.dtype.kind in "fiub"
        found.update(
            _text([str(name), variable.dims, str(values.dtype) if plain else "text", variable.attrs])
        )
        found.update(np.ascontiguousarray(values).tobytes() if plain else _text(values.astype(str)))
    return found.hexdigest()


def _text(value: Any) -> bytes:
    def plain(one: Any) -> Any:
        return one.tolist() if isinstance(one, np.ndarray | np.generic) else str(one)

    return json.dumps(value, default=plain, sort_keys=True).encode()


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
