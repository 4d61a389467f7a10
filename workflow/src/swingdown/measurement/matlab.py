"""Arrays that MATLAB or Octave saved, ``.mat``: those of one length are columns."""

import re
from collections.abc import Mapping
from typing import BinaryIO

import numpy as np
import pandas as pd
from scipy.io import loadmat

from ..arrays import Floats
from ..errors import InputError
from .columns import TIME, meaning
from .elements import Columns
from .layout import CLOCKED

PROGRAM = "MATLAB"
FEWEST = 10  # numbers in an array; a shorter one is a setting
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
    columns: dict[str, Floats] = {}
    for key, value in saved.items():
        columns |= {} if key.startswith("__") else _columns(key, value)
    length = _length(columns)
    kept = {key: one for key, one in columns.items() if one.size == length}
    if not kept:
        raise InputError(
            name, f"it holds no array of {FEWEST} numbers or more", "arrays of a time and a swing", mend
        )
    layout = f"arrays of {PROGRAM}"
    if not any(meaning(key).kind == TIME for key in kept) and (stated := _rate(saved)):
        key, rate = stated
        kept = {CLOCKED: np.arange(length) / rate, **kept}
        layout += f", times by its `{key}`, {rate:g} Hz"
    return {"": Columns(pd.DataFrame(kept), layout, {}, {"source": PROGRAM})}


def _rate(saved: Mapping[str, object]) -> tuple[str, float] | None:
    """The name of the one number among the saved that tells how fast was sampled, and the rate (Hz); None without one, or of several."""
    found = []
    for key, value in saved.items():
        if (
            isinstance(value, np.ndarray)
            and value.size == 1
            and value.dtype.kind in "fiu"
            and value.item() > 0
        ):
            if _RATE.fullmatch(key):
                found.append((key, float(value.item())))
            elif _INTERVAL.fullmatch(key):
                found.append((key, 1 / float(value.item())))
    return found[0] if len(found) == 1 else None


def _columns(key: str, value: object) -> dict[str, Floats]:
    if not isinstance(value, np.ndarray) or value.ndim != 2 or value.dtype.kind not in "fiu":
        return {}
    across = value if value.shape[0] >= value.shape[1] else value.T
    if len(across) < FEWEST:
        return {}
    if across.shape[1] == 1:
        return {key: across[:, 0].astype(float)}
    return {f"{key} {k}": one.astype(float) for k, one in enumerate(across.T, 1)}


def _length(columns: dict[str, Floats]) -> int:
    """How many numbers the time has, or else most of the arrays."""
    times = [one.size for key, one in columns.items() if meaning(key).kind == TIME]
    sizes = [one.size for one in columns.values()]
    return times[0] if times else max(sizes, key=sizes.count, default=0)
