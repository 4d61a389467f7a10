"""One labelled dataset out of the chunks of a sweep, cell by cell, so that its size does not matter to the memory."""

from pathlib import Path

import netCDF4
import numpy as np
import xarray as xr
import yaml

from .. import dataset
from ..errors import InputError
from ..paths import written_whole
from . import summary
from .table import cell_key, noise_key

SEEDING = (
    "draw k of a cell is numpy.random.SeedSequence(seed, spawn_key=(the cell's noise_key as four 32-bit words, most significant "
    "first, then k)), k from 0"
)
_KEPT = {"f": "f8", "i": "i4", "b": "i1"}


def combine(sweep, paths, output):
    """The path of the netCDF written: every draw of every cell, and the cells' probabilities (``summary``).

    Dimensions are the axes' names in the order of the config, ``realization``, and what the variables are listed by
    (``fitted``); coordinates have units, the settings and seeds are attributes and ``noise_key``. InputError where a draw is
    missing or there twice, naming the cell.
    """
    output = Path(output)
    where = {
        cell_key(sweep.computes, sweep.cell(values)): index
        for index, values in zip(np.ndindex(sweep.shape), sweep, strict=True)
    }
    listed = _listed(paths)
    with written_whole(output) as partial:
        dataset.write(_skeleton(sweep, listed), partial)
        with netCDF4.Dataset(partial, "a") as file:
            file.delncattr(dataset.DIGEST)  # it was taken of the skeleton alone
            filled = _fill(file, sweep, where, listed, paths)
            if not filled.all():
                _tell_missing(sweep, filled)
            summary.add(file, sweep)
        dataset.seal(partial)
    return output


def read_maps(path):
    """The Dataset of a combined sweep without the single draws: coordinates, settings and the cells' probabilities."""
    with (
        dataset.reading(path),
        xr.open_dataset(path, engine="netcdf4", decode_times=False, decode_timedelta=False) as data,
    ):
        return data.drop_dims("realization").load()


def _listed(paths):
    """The dimension beside cell and draw that the chunks have, and its entries; (None, []) where there is none."""
    found, dimension = [], None
    for path in paths:
        with dataset.reading(path), xr.open_dataset(path, engine="netcdf4", decode_times=False) as data:
            other = [name for name in data.sizes if name in data.coords and name != "cell_key"]
            dimension = other[0] if other else dimension
            found += [str(name) for name in (data[other[0]].values if other else ())]
    return dimension, list(dict.fromkeys(found))


def _skeleton(sweep, listed):
    dimension, names = listed
    coords = {
        axis.dim: (axis.dim, axis.coordinate, {"long_name": axis.long_name, "config_key": axis.key}
                   | ({"units": axis.units} if axis.coordinate.dtype.kind in "fi" else {}))
        for axis in sweep.axes
    }  # fmt: skip
    dims = tuple(axis.dim for axis in sweep.axes)
    keys = np.array([noise_key(sweep.cell(values)) for values in sweep]).reshape(sweep.shape)
    coords |= {
        "realization": ("realization", np.arange(sweep.realizations), {"long_name": "index of the draw"}),
        "noise_key": (dims, keys, {"long_name": "what seeds the draws of a cell, beside the seed"}),
    }
    if dimension:
        coords[dimension] = (dimension, names, {"long_name": "fitted model"})
    settings = yaml.safe_dump(dict(sorted(sweep.settings.items())), allow_unicode=True, sort_keys=False)
    attributes = {
        "title": f"sweep {sweep.name}", "sweep": sweep.name, "computes": sweep.computes, "axes": " ".join(dims), "settings": settings, "seeding": SEEDING,
        "realizations": sweep.realizations, "source": "simulated", "emulated": "no",
    }  # fmt: skip
    if "seed" in sweep.settings:
        attributes["seed"] = sweep.settings["seed"]
    return xr.Dataset({}, coords, attributes)


def _fill(file, sweep, where, listed, paths):
    dims = tuple(axis.dim for axis in sweep.axes) + ("realization",)
    filled = np.zeros((*sweep.shape, sweep.realizations), dtype=bool)
    for path in paths:
        data = dataset.read(path)
        keys = [str(key) for key in data["key"].values]
        cells, draws = data["cell"].values, data["realization"].values
        names = [name for name, one in data.data_vars.items() if name not in ("cell", "realization", "key")]
        own = (
            [listed[1].index(str(name)) for name in data[listed[0]].values]
            if listed[0] in data.coords
            else None
        )
        for name in names:
            if name not in file.variables:
                _create(file, name, data[name], dims, listed, sweep)
        # a part is one cell's draws without a gap
        edges = np.flatnonzero((np.diff(cells) != 0) | (np.diff(draws) != 1)) + 1
        for first, last in zip([0, *edges], [*edges, cells.size], strict=True):
            index = where.get(keys[cells[first]])
            stop = min(sweep.realizations, int(draws[last - 1]) + 1)
            start = int(draws[first])
            if index is None or start >= stop:
                continue  # of a wider table than today's
            if filled[index][start:stop].any():
                raise InputError(path, f"draws {start} to {stop - 1} of {_named(sweep, index)} are in another chunk too",
                                 "each draw once", f"delete the folder {Path(path).parent.parent} and run the sweep again")  # fmt: skip
            filled[index][start:stop] = True
            for name in names:
                values = data[name].values[first : first + stop - start]
                if own is None or data[name].ndim == 1:
                    file[name][(*index, slice(start, stop))] = values
                else:
                    file[name][(*index, slice(start, stop), own)] = values
    return filled


def _create(file, name, like, dims, listed, sweep):
    several = like.ndim > 1
    shape = (1,) * len(sweep.shape) + (sweep.realizations,) + ((len(listed[1]),) if several else ())
    kind = "i1" if like.dtype.itemsize == 1 else _KEPT[like.dtype.kind]
    dims = (*dims, listed[0]) if several else dims
    made = file.createVariable(
        name,
        kind,
        dims,
        zlib=True,
        complevel=4,
        fletcher32=True,
        chunksizes=shape,
        fill_value=np.nan if kind == "f8" else None,
    )
    made.setncatts(dict(like.attrs) | ({"dtype": "bool"} if like.dtype.kind == "b" else {}))


def _tell_missing(sweep, filled):
    lost = np.argwhere(~filled)
    index, draw = tuple(lost[0][:-1]), int(lost[0][-1])
    raise InputError(f"sweep {sweep.name}", f"{len(lost)} of {filled.size} draws are in no chunk, first draw {draw} of {_named(sweep, index)}",
                     "every draw of every cell", "run the sweep again")  # fmt: skip


def _named(sweep, index):
    return ", ".join(f"{axis.dim} {axis.coordinate[k]}" for axis, k in zip(sweep.axes, index, strict=True))
