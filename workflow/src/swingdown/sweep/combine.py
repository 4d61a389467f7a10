"""One labelled dataset out of the chunks of a sweep, a block of draws at a time, so that its size does not matter to the memory."""

from collections import Counter
from pathlib import Path

import netCDF4
import numpy as np
import xarray as xr
import yaml

from .. import dataset
from ..errors import InputError
from ..paths import written_whole
from ..sealed import seal_behind
from . import code, parts, store, summary
from .chunks import uncovered
from .draws import cell_key, noise_key

SEEDING = (
    "draw k of a cell is numpy.random.SeedSequence(seed, spawn_key=(the cell's noise_key as four 32-bit words, most significant "
    "first, then k)), k from 0"
)
_KEPT = {"f": "f8", "i": "i4", "b": "i1"}
_CACHE = 1 << 21  # bytes
_BLOCK = 1 << 15  # draws of a cell that lie together in the file


def combine(sweep, paths, output):
    """The path of the netCDF written: every draw of every cell, and the cells' probabilities (``summary``).

    Dimensions are the axes' names, ``realization``, and what the variables are listed by (``fitted``). ``noise_key`` has the
    seeds, ``reason`` why a cell could not be made. Of a sweep in a Zarr store, ``row`` is where each draw is in it (``store``).

    ``sweep`` is a ``table.Sweep``, ``paths`` are its chunks. InputError with the cell whose draw is missing or there twice.
    """
    output = Path(output)
    keys = (cell_key(sweep.computes, sweep.cell(values)) for values in sweep)
    where = dict(zip(keys, np.ndindex(sweep.shape), strict=True))
    netCDF4.set_chunk_cache(_CACHE)  # of each variable; by default it is 64 MB
    found = [parts.about(path) for path in paths]
    listed = _listed(found)
    with written_whole(output) as partial:
        dataset.write(_skeleton(sweep, listed), partial)
        with netCDF4.Dataset(partial, "a") as file:
            _realizations(file, sweep)
            taken, versions = _fill(file, sweep, where, listed, paths, found)
            _check(sweep, taken)
            file.code = "; ".join(f"{version}: {draws} draws" for version, draws in sorted(versions.items()))
            told = {key: why for one in reversed(found) for key, why in one["reasons"].items()}
            summary.add(file, sweep, {where[key]: why for key, why in told.items() if key in where})
            summary.from_file(file, sweep)
        if sweep.format == "zarr":
            store.move(partial, output.parent)
        seal_behind(partial)
    return output


def read_maps(path):
    """The Dataset of a combined sweep without the single draws: coordinates, settings and the cells' probabilities."""
    with (
        dataset.reading(path),
        xr.open_dataset(path, engine="netcdf4", decode_times=False, decode_timedelta=False) as data,
    ):
        return data.drop_dims("realization").load()


def _listed(found):
    """The dimension beside cell and draw that the chunks have, and its entries; (None, []) where there is none."""
    names, dimension = [], None
    for one in found:
        dimension = one["listed"][0] or dimension
        names += one["listed"][1]
    return dimension, list(dict.fromkeys(names))


def _skeleton(sweep, listed):
    dimension, names = listed
    coords = {}
    for axis in sweep.axes:
        for one in (axis, *axis.coupled):
            units = {"units": one.units} if one.coordinate.dtype.kind in "fi" else {}
            told = {"long_name": one.long_name, "config_key": one.key}
            coords[one.dim] = (axis.dim, one.coordinate if one is axis else one.labels, told | units)
    dims = tuple(axis.dim for axis in sweep.axes)
    keys = np.array([noise_key(sweep.cell(values)) for values in sweep]).reshape(sweep.shape)
    coords["noise_key"] = (dims, keys, {"long_name": "what seeds the draws of a cell, beside the seed"})
    if dimension:
        coords[dimension] = (dimension, names, {"long_name": "fitted model"})
    settings = yaml.safe_dump(dict(sorted(sweep.settings.items())), allow_unicode=True, sort_keys=False)
    attributes = {
        "title": f"sweep {sweep.name}", "sweep": sweep.name, "computes": sweep.computes, "axes": " ".join(dims), "settings": settings, "seeding": SEEDING,
        "realizations": sweep.realizations, "source": "simulated", "emulated": "no", "swingdown": code.project(),
    }  # fmt: skip
    for key in ("seed", "simulation.start", "detection.size"):
        if key in sweep.settings:
            attributes[key.rpartition(".")[2]] = sweep.settings[key]
    return xr.Dataset({}, coords, attributes)


def _realizations(file, sweep):
    file.createDimension("realization", sweep.realizations)
    made = file.createVariable("realization", "i4", ("realization",), zlib=True, complevel=4)
    made.long_name = "index of the draw"
    for begin in range(0, sweep.realizations, _BLOCK):
        last = min(begin + _BLOCK, sweep.realizations)
        made[begin:last] = np.arange(begin, last, dtype=np.int32)


def _fill(file, sweep, where, listed, paths, found):
    """The ranges of draws that the chunks hold, by the cell's index, after their variables are written; and how many
    draws each version of the code computed.
    """
    versions = Counter()
    dims, taken = (*(axis.dim for axis in sweep.axes), "realization"), {index: [] for index in where.values()}
    for one in found:
        for name, (kind, own, told) in one["variables"].items():
            if name not in file.variables:
                _create(file, name, kind, own, told, dims, listed)
    for path, one in zip(paths, found, strict=True):
        own = [listed[1].index(name) for name in one["listed"][1]]
        told = one["attributes"]
        version = f"{told.get('code', 'unknown')} (swingdown {told.get('swingdown', 'unknown')})"
        for key, start, block in parts.parts(path):
            index = where.get(key)
            size = next(iter(block.values())).shape[0]
            stop = min(sweep.realizations, start + size)
            if index is None or start >= stop:
                continue  # of a wider table than today's
            if any(first < stop and last > start for first, last in taken[index]):
                raise InputError(path, f"draws {start} to {stop - 1} of {_named(sweep, index)} are in another chunk too",
                                 "each draw once", f"delete the folder {Path(path).parent.parent} and run the sweep again")  # fmt: skip
            taken[index].append((start, stop))
            versions[version] += stop - start
            for name in block:
                values, here = block[name][: stop - start], (*index, slice(start, stop))
                file[name][here if values.ndim == 1 else (*here, own)] = values
    return taken, versions


def _create(file, name, kind, own, told, dims, listed):
    several = len(own) > 1
    size = file.dimensions["realization"].size
    shape = (1,) * (len(dims) - 1) + (min(size, _BLOCK),) + ((len(listed[1]),) if several else ())
    kept, dims = "i1" if kind.itemsize == 1 else _KEPT[kind.kind], (*dims, listed[0]) if several else dims
    unknown = np.nan if kept == "f8" else None
    made = file.createVariable(name, kept, dims, chunksizes=shape, fill_value=unknown, **summary.PACKED)
    made.setncatts(told)


def _check(sweep, taken):
    lost = {index: list(uncovered(ranges, sweep.realizations)) for index, ranges in taken.items()}
    if count := sum(last - first for one in lost.values() for first, last in one):
        index, ((draw, _), *_) = next((index, one) for index, one in lost.items() if one)
        raise InputError(f"sweep {sweep.name}", f"{count} of {sweep.cells * sweep.realizations} draws are in no chunk, first draw {draw} of {_named(sweep, index)}",
                         "every draw of every cell", "run the sweep again")  # fmt: skip


def _named(sweep, index):
    return ", ".join(f"{axis.dim} {axis.coordinate[k]}" for axis, k in zip(sweep.axes, index, strict=True))
