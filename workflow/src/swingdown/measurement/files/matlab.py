"""Arrays that MATLAB or Octave saved, ``.mat``: those of one length are columns."""

import re
from collections.abc import Iterable, Mapping
from typing import BinaryIO

import numpy as np
from scipy.io import loadmat

from ...arrays import Floats
from ...errors import InputError
from .columns import TIME, meaning
from .elements import Columns, columns_in, no_arrays
from .layout import CLOCKED

PROGRAM = "MATLAB"
_LABELS = ("label", "name", "Name")  # of the signals that Simulink logs
_VALUES = ("values", "data")
_DEEPEST = 6  # structures in structures: a timeseries of a logged signal has four
_RATE = re.compile(r"(?i)(actual|sampl(e|ing))?_?(rate|freq(uency)?)(_?hz)?|f_?s|fps|frame_?rate")
_INTERVAL = re.compile(r"(?i)(sampl(e|ing))?_?(interval|period|time)(_?s)?|d_?t|t_?s|delta_?t")


def arrays(source: BinaryIO, name: str) -> dict[str, Columns]:
    """The Columns that the arrays of an open file make, by "": those as long as the time, or else as most.

    An array of two dimensions is as many columns as it has, ``name 1``, ``name 2``. InputError for a file that the reader does not
    know, such as one of version 7.3, and for one without such arrays. Where none of them is a time, one is made of a number that is
    called a rate (Hz) or an interval (s).
    """
    mend = f"export its arrays as columns of a CSV file, in {PROGRAM} by writematrix"
    try:
        saved = loadmat(source, appendmat=False)
    except MemoryError:
        raise
    except Exception as error:  # a damaged file makes the reader fail in ways that nobody listed
        version = isinstance(error, NotImplementedError)
        what = "it is of version 7.3, which is not read here" if version else f"it cannot be read ({error})"
        raise InputError(name, what, f"a file as {PROGRAM} saves it up to version 7", mend) from error
    columns = _together(
        (key, _columns(key, value)) for key, value in saved.items() if not key.startswith("__")
    )
    times = [one.size for key, one in columns.items() if meaning(key).kind == TIME]
    sizes = [one.size for one in columns.values()]
    length = times[0] if times else max(sizes, key=sizes.count, default=0)
    kept = {key: one for key, one in columns.items() if one.size == length}
    if not kept:
        raise no_arrays(name, mend)
    more = ""
    if not any(meaning(key).kind == TIME for key in kept) and (stated := _rate(saved)):
        key, rate = stated
        kept = {CLOCKED: np.arange(length) / rate, **kept}
        more = f", times by its `{key}`, {rate:g} Hz"
    return {"": Columns.of_arrays(kept, PROGRAM, more)}


def _rate(saved: Mapping[str, object]) -> tuple[str, float] | None:
    """The name of the one number among the saved that tells how fast was sampled, and the rate (Hz); None without one, or of several."""
    single = {
        key: float(value.item())
        for key, value in saved.items()
        if isinstance(value, np.ndarray) and value.size == 1 and value.dtype.kind in "fiu"
    }
    found = [(key, one) for key, one in single.items() if one > 0 and _RATE.fullmatch(key)]
    found += [(key, 1 / one) for key, one in single.items() if one > 0 and _INTERVAL.fullmatch(key)]
    return found[0] if len(found) == 1 else None


def _together(parts: Iterable[tuple[str, Mapping[str, Floats]]]) -> dict[str, Floats]:
    """The columns of parts by their names; of two with one name the second is told by its part's name before it."""
    found: dict[str, Floats] = {}
    for part, columns in parts:
        found |= {name if name not in found else f"{part} {name}": one for name, one in columns.items()}
    return found


def _called(key: str, value: object, size: int, number: int) -> str:
    """What an element of a structure is called: by its label, as logged signals have one, else by its number where there are several."""
    if isinstance(value, np.void) and value.dtype.names:
        for field in set(_LABELS) & set(value.dtype.names):
            if isinstance(value[field], np.ndarray) and value[field].dtype.kind == "U" and value[field].size:
                return str(value[field].flat[0])
    return key if size == 1 else f"{key} {number}"


def _fields(key: str, value: object, depth: int) -> dict[str, Floats]:
    """The columns in the fields of a structure, each by its own name, and its ``values`` by the structure's; of structures in it too."""
    if depth >= _DEEPEST:
        return {}
    if not isinstance(value, np.void) or not value.dtype.names:
        return _columns(key, value, depth + 1)
    names = {field: key if field.lower() in _VALUES else field for field in value.dtype.names}
    return _together((key, _columns(name, value[field], depth + 1)) for field, name in names.items())


def _columns(key: str, value: object, depth: int = 0) -> dict[str, Floats]:
    if isinstance(value, np.ndarray) and (value.dtype.names or value.dtype == object):
        parts = [_fields(_called(key, one, value.size, k), one, depth) for k, one in enumerate(value.flat, 1)]
        return _together(zip((f"{key} {k}" for k in range(1, len(parts) + 1)), parts, strict=True))
    if not isinstance(value, np.ndarray) or value.ndim != 2:
        return {}
    return columns_in(key, value.ravel() if 1 in value.shape else value)
