"""Arrays that numpy saved, ``.npy`` and ``.npz``, and columns in a ``.json`` file."""

import io
import json
from collections.abc import Mapping
from pathlib import PurePath
from typing import Any, BinaryIO

import numpy as np
import pandas as pd

from ...arrays import Floats
from ...errors import InputError
from .elements import FEWEST, Columns, columns_in, no_arrays

LARGEST = 200_000_000  # bytes: it is held whole
_MEND = "save its columns as a CSV file"


def saved_arrays(source: BinaryIO, name: str) -> dict[str, Columns]:
    """The Columns that the arrays of an open file make, by "": those of the length that most of them have.

    An array of two dimensions is as many columns as it has. A JSON file holds lists by their names, or a list of rows. InputError for a
    file that cannot be read, and for one without such arrays; nothing that is not numbers is loaded. Empty for a file with a JSON document a line.
    """
    ending = PurePath(name).suffix.lower()
    if source.seek(0, io.SEEK_END) > LARGEST:
        problem = f"it has more than {LARGEST / 1e6:.0f} MB"
        raise InputError(name, problem, "a file that can be held whole", _MEND)
    source.seek(0)
    try:
        found = _of_json(json.load(source)) if ending == ".json" else _of_numpy(np.load(source))
    except MemoryError:
        raise
    except Exception as error:  # a damaged file makes the readers fail in ways that nobody listed
        if isinstance(error, json.JSONDecodeError) and error.msg == "Extra data":
            source.seek(0)  # a document a line: the readers of text take it
            return {}
        raise InputError(name, f"it cannot be read ({error})", "arrays of numbers", _MEND) from error
    sizes = [one.size for one in found.values()]
    length = max(sizes, key=sizes.count, default=0)
    kept = {key: one for key, one in found.items() if one.size == length}
    if length < FEWEST:
        raise no_arrays(name, _MEND)
    return {"": Columns.of_arrays(kept, "JSON" if ending == ".json" else "numpy")}


def _of_numpy(saved: Any) -> dict[str, Floats]:
    if isinstance(saved, np.ndarray):
        return _columns("column", saved)
    return {name: one for key in saved.files for name, one in _columns(str(key), saved[key]).items()}


def _of_json(saved: Any) -> dict[str, Floats]:
    if isinstance(saved, list) and saved and isinstance(saved[0], Mapping):
        frame = pd.json_normalize(saved)
        return {str(key): _numbers(frame[key]) for key in frame if np.isfinite(_numbers(frame[key])).any()}
    if isinstance(saved, list):
        return _columns("column", np.array(saved, float))
    found: dict[str, Floats] = {}
    for key, value in saved.items() if isinstance(saved, Mapping) else ():
        if isinstance(value, list) and value and isinstance(value[0], Mapping):
            found |= _of_json(value)
        elif isinstance(value, list) and value and not isinstance(value[0], str):
            if isinstance(value[0], list):
                across = enumerate(zip(*value, strict=True), 1)
                found |= _of_json({f"{key} {k}": list(one) for k, one in across})
            else:
                found |= _columns(str(key), _numbers(value))
        elif isinstance(value, Mapping):
            found |= _of_json(value)
    return found


def _numbers(values: Any) -> Floats:
    return np.asarray(pd.to_numeric(pd.Series(values), errors="coerce"), float)


def _columns(key: str, value: np.ndarray) -> dict[str, Floats]:
    if value.dtype.names:
        return {str(name): value[name].astype(float).ravel() for name in value.dtype.names}
    return columns_in(key, value)
