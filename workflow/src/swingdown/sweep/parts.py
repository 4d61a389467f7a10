"""The draws of a sweep as its jobs left them, part by part: no more is in memory than a block of one cell's draws."""

import netCDF4
import numpy as np

from .. import dataset

_BLOCK = 1 << 15  # draws
_ABOUT = ("cell", "realization", "key", "reason")


def parts(path):
    """(key of the cell, index of the first draw, variables of a block of its draws by name) of one chunk, one block at a time.

    ``path`` is a chunk's netCDF file. InputError for one that is not whole.
    """
    with dataset.opened(path) as file:
        keys, size = texts(file["key"]), file.dimensions["draw"].size
        names = list(_drawn(file))
        for begin in range(0, size, _BLOCK):
            here = slice(begin, min(begin + _BLOCK, size))
            cells, draws = np.asarray(file["cell"][here]), np.asarray(file["realization"][here])
            found = {name: values(file[name][here]) for name in names}
            edges = np.flatnonzero((np.diff(cells) != 0) | (np.diff(draws) != 1)) + 1
            for first, last in zip([0, *edges], [*edges, cells.size], strict=True):
                block = {name: one[first:last] for name, one in found.items()}
                yield keys[cells[first]], int(draws[first]), block


def about(path):
    """What one chunk tells beside its draws: ``listed`` (dimension and entries beside the draw), attributes of each variable
    with its type and dimensions, ``reasons`` by the cell's key, and the chunk's own ``attributes``.
    """
    with dataset.opened(path) as file:
        variables = {}
        for name, one in _drawn(file).items():
            told = {key: one.getncattr(key) for key in one.ncattrs() if key != "_FillValue"}
            variables[name] = one.dtype, one.dimensions, told
        other = {name for _, dims, _ in variables.values() for name in dims[1:]}
        dimension = next(iter(other), None)
        reasons = texts(file["reason"]) if "reason" in file.variables else []
        return {
            "listed": (dimension, texts(file[dimension]) if dimension else []),
            "variables": variables,
            "reasons": {key: why for key, why in zip(texts(file["key"]), reasons, strict=False) if why},
            "attributes": {name: file.getncattr(name) for name in file.ncattrs()},
        }


def _drawn(file):
    """The variables of a chunk that each draw has, by name."""
    each = {name: one for name, one in file.variables.items() if one.dimensions[:1] == ("draw",)}
    return {name: one for name, one in each.items() if name not in _ABOUT}


def texts(variable):
    """The entries of a text variable as a list, kept as characters or as strings."""
    found = np.asarray(variable[:])
    if found.dtype.kind == "S" and found.ndim == 2:
        found = netCDF4.chartostring(found)
    return [str(one) for one in found]


def values(found):
    """An array of what netCDF4 read, NaN where it is masked."""
    if np.ma.isMaskedArray(found):
        return found.filled(np.nan) if found.dtype.kind == "f" else found.data
    return np.asarray(found)
