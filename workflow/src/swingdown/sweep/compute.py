"""One chunk as a dataset: every draw of its cells, in the order of the book."""

import resource
import time

import numpy as np
import xarray as xr


def compute(chunk, computation):
    """The Dataset of a chunk (``chunks.Chunk``), and in words what it took.

    Dimensions ``draw`` (each with ``cell``, a position in ``key``, and ``realization``, its index), ``cell_key`` and, where the
    computation lists its variables by something, that. ``computation`` is ``identification`` or ``detection``, a module.
    """
    began = time.process_time()
    cells = list(chunk.cells())
    keys = list(dict.fromkeys(key for _, key, *_ in cells))
    listed = list(
        dict.fromkeys(name for settings, *_ in cells for name in computation.entries(settings) or ())
    )
    dims = ("draw", computation.DIMENSION) if computation.DIMENSION else ("draw",)
    shape = (chunk.draws, len(listed)) if computation.DIMENSION else (chunk.draws,)
    columns, at, fits = {}, 0, 0
    cell, realization = np.empty(chunk.draws, np.int32), np.empty(chunk.draws, np.int32)
    for settings, key, first, count in cells:
        here = slice(at, at + count)
        cell[here], realization[here] = keys.index(key), np.arange(first, first + count)
        own = [listed.index(name) for name in computation.entries(settings) or ()]
        for name, values in computation.results(settings, first, count).items():
            if name not in columns:
                columns[name] = np.full(shape, np.nan if values.dtype.kind == "f" else 0, values.dtype)
            columns[name][(here, own) if own else here] = values
        at, fits = at + count, fits + count * computation.fits(settings)
    coords = {"key": ("cell_key", keys)}
    if computation.DIMENSION:
        coords[computation.DIMENSION] = (computation.DIMENSION, listed)
    data = xr.Dataset(
        {name: (dims, values, attributes(computation, name)) for name, values in columns.items()}
        | {"cell": ("draw", cell), "realization": ("draw", realization)},
        coords,
        {"computes": chunk.computes, "source": "simulated", "emulated": "no"},
    )
    took = time.process_time() - began
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    what = "fits" if computation.DIMENSION else "verdicts"
    words = f"{len(keys)} cells, {chunk.draws} draws, {fits} {what}: {took:.2f} s of CPU, {1e3 * took / fits:.3g} ms each, {peak:.0f} MB"
    return data, words


def attributes(computation, name):
    """The attributes of a variable: unit, meaning, and what its numbers stand for."""
    units, meaning = computation.VARIABLES[name]
    found = {"long_name": meaning} | ({"units": units} if units else {})
    if name in getattr(computation, "FLAGS", {}):
        words = computation.FLAGS[name]
        found |= {"flag_values": np.arange(len(words), dtype=np.int8), "flag_meanings": " ".join(words)}
    return found
