"""One chunk as a dataset: every draw of its cells, in the order of the book."""

import resource
import time

import numpy as np
import xarray as xr

from ..errors import InputError
from . import code


def compute(chunk, computation):
    """The Dataset of a chunk by a computation (the module ``identification`` or ``detection``), and in words what it took.

    Dimensions are ``draw`` (each with ``cell``, a position in ``key``, and ``realization``, its index), ``cell_key`` (with ``reason``:
    why it could not be made, or one of its draws not) and, where the computation lists its variables by something, that.
    Attributes tell the version of the code.
    """
    began = time.process_time()
    cells = list(chunk.cells())
    keys = list(dict.fromkeys(key for _, key, *_ in cells))
    entries = [name for settings, *_ in cells for name in computation.entries(settings) or ()]
    listed = list(dict.fromkeys(entries))
    dims = ("draw", computation.DIMENSION) if computation.DIMENSION else ("draw",)
    shape = (chunk.draws, len(listed)) if computation.DIMENSION else (chunk.draws,)
    columns, at, fits = {}, 0, 0
    cell, realization = np.empty(chunk.draws, np.int32), np.empty(chunk.draws, np.int32)
    reasons = dict.fromkeys(keys, "")
    for settings, key, first, count in cells:
        here = slice(at, at + count)
        cell[here], realization[here] = keys.index(key), np.arange(first, first + count)
        own = [listed.index(name) for name in computation.entries(settings) or ()]
        found, why = _results(computation, settings, first, count, chunk.keys)
        reasons[key] = reasons[key] or why
        for name, values in found.items():
            if name not in columns:
                columns[name] = np.full(shape, np.nan if values.dtype.kind == "f" else 0, values.dtype)
            columns[name][(here, own) if own else here] = values
        at, fits = at + count, fits + count * computation.fits(settings)
    coords = {"key": ("cell_key", keys)}
    if computation.DIMENSION:
        coords[computation.DIMENSION] = (computation.DIMENSION, listed)
    took = time.process_time() - began
    data = xr.Dataset(
        {name: (dims, values, attributes(computation, name)) for name, values in columns.items()}
        | {"cell": ("draw", cell), "realization": ("draw", realization)}
        | {"reason": ("cell_key", [reasons[key] for key in keys], {"long_name": "why not, where a cell or a draw of it could not be made"})},
        coords,
        {"computes": chunk.computes, "source": "simulated", "emulated": "no", "code": code.version(chunk.computes),
         "swingdown": code.project(), "cpu_s": took},
    )  # fmt: skip
    return data, "\n".join([_took(chunk, len(keys), fits, took, computation), *_told(reasons, chunk)])


def _results(computation, settings, first, count, axes):
    """What the computation says of a cell; what is no outcome but a fault of the program tells the cell as well."""
    try:
        return computation.results(settings, first, count)
    except Exception as error:
        where = ", ".join(f"{key} {settings[key]}" for key in axes)
        error.add_note(f"in the cell with {where}, draws {first} to {first + count - 1}")
        if isinstance(error, InputError):
            told = error.problem, error.expected, error.mend
            raise InputError(f"sweep, cell with {where}", *told) from error
        raise


def _took(chunk, cells, fits, took, computation):
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    what = "fits" if computation.DIMENSION else "verdicts"
    return f"{cells} cells, {chunk.draws} draws, {fits} {what}: {took:.2f} s of CPU, {1e3 * took / fits:.3g} ms each, {peak:.0f} MB"


def _told(reasons, chunk, most=5):
    """Lines that tell the cells in which something could not be made."""
    values = {key: [settings[name] for name in chunk.keys] for settings, key, *_ in chunk.cells()}
    lines = [
        f"not made, or not every draw: {', '.join(f'{name} {value}' for name, value in zip(chunk.keys, values[key], strict=True))}: {why}"
        for key, why in reasons.items()
        if why
    ]
    return lines[:most] + ([f"… and in {len(lines) - most} more cells"] if len(lines) > most else [])


def attributes(computation, name):
    """The attributes of a variable: unit, meaning, and what its numbers stand for."""
    units, meaning = computation.VARIABLES[name]
    found = {"long_name": meaning} | ({"units": units} if units else {})
    if name in getattr(computation, "FLAGS", {}):
        words = computation.FLAGS[name]
        found |= {"flag_values": np.arange(len(words), dtype=np.int8), "flag_meanings": " ".join(words)}
    return found
