"""Arrays that bring a unit, a mask or gaps along, as plain numbers: those of numpy, pandas, xarray, pint and astropy."""

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from ..arrays import Floats
from ..errors import InputError
from ..measurement.files.columns import UNITS, meaning
from ..measurement.files.known_units import FACTORS
from ..measurement.gyroscope import TO_RAD_PER_S

ANGLES = ("rad", "deg", *TO_RAD_PER_S, "V")  # of volts without a scale period and decay are told
_SECONDS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}


def angles(given: Any) -> tuple[Floats, str]:
    """The values of a series as floats, those that are masked or missing as NaN, and the unit that it states ("" for none).

    A unit is stated by a quantity of pint or astropy, the attribute ``units`` of xarray or pandas, or the end of the series' name.
    What is a known number of one of ``ANGLES``, as mrad or turns, is told in that. InputError for what holds no numbers, and for any other unit.
    """
    if (quantity := _quantity(given)) is not None:
        return _in_units(quantity, ANGLES, "the angles")
    written = _written(given, "angle")
    unit, worth = unit_named(written)
    if written and unit not in ANGLES:
        raise InputError("the angles", f"their unit is {written!r}", " or ".join(ANGLES), "convert them first")  # fmt: skip
    values = numbers(given, "the angles")
    return (values if worth == 1 else worth * values), unit


def times(given: Any) -> Floats:
    """The times of a series in s, those that are masked or missing as NaN; of dates and durations those since the first.

    Units as of ``angles``; s where none is stated. InputError for what holds no times, and for a unit of something else.
    """
    if (quantity := _quantity(given)) is not None:
        return _in_units(quantity, ("s",), "the times")[0]
    values = np.asarray(getattr(given, "values", given))
    if values.dtype.kind in "mM":
        known = values[~np.isnat(values)]
        return (values - (known[0] if known.size else values[:1])) / np.timedelta64(1, "ns") * 1e-9
    written = _written(given, "time")
    if not written:
        return numbers(given, "the times")
    unit, worth = unit_named(written)
    if unit not in _SECONDS:
        raise InputError("the times", f"their unit is {written!r}", "s, ms, us, ns, min or h", "convert them first")  # fmt: skip
    return worth * _SECONDS[unit] * numbers(given, "the times")


def numbers(given: Any, what: str) -> Floats:
    """The values as floats, those that are masked or missing as NaN; InputError for what holds no numbers."""
    if isinstance(given, str | bytes | Path):
        raise InputError(what, f"{str(given)!r} is text", "numbers", "read a file by swingdown.read(path)")
    try:
        if isinstance(given, pd.Series | pd.Index | pd.api.extensions.ExtensionArray):
            return np.array(pd.Series(given).to_numpy(dtype=float, na_value=np.nan))
        if np.iscomplexobj(given):
            raise TypeError("complex numbers")
        if np.ma.isMaskedArray(given):
            return np.ma.filled(given.astype(float), np.nan)
        return np.array(given, dtype=float)
    except (TypeError, ValueError) as problem:
        raise InputError(what, f"they are no numbers ({problem})", "numbers, all in one row") from problem


def value(given: Any, unit: str, what: str) -> float:
    """One number in this unit, of a number, or of a quantity with a unit of its own; InputError for what is none."""
    if (quantity := _quantity(given)) is not None:
        given, _ = _in_units(quantity, ("" if unit == "1" else unit,), what)
    try:
        return float(getattr(given, "nominal_value", given))  # of the package uncertainties
    except (TypeError, ValueError) as problem:
        raise InputError(what, f"{given!r} is no number", f"a number in {unit}") from problem


def unit_named(written: str) -> tuple[str, float]:
    """What a unit is called here, as somebody writes it, or of what it is a known number, and which; ("", 1) for any other."""
    unit = UNITS.get(written if written in UNITS else written.lower(), ("", ""))[1]
    return (unit, 1.0) if unit else FACTORS.get(written.lower(), ("", 1.0))


def known_in(names: Iterable[str]) -> dict[str, str]:
    """Of the names of columns those that state a unit which is a known number of another one, with that one."""
    written = {name: meaning(name).written.lower() for name in names}
    return {name: FACTORS[one][0] for name, one in written.items() if one in FACTORS}


def _written(given: Any, called: str) -> str:
    """A series' unit as it states it: in its attribute ``units`` or at the end of its name; "" for none."""
    if beside := str(getattr(given, "attrs", {}).get("units", "")).strip():
        written = meaning(called, beside).written
        return beside if written in ("", beside.lower()) else written
    return meaning(str(getattr(given, "name", "") or "")).written


def _quantity(given: Any) -> Any:
    """The series as a quantity of pint or astropy, where it is one or holds one; else None."""
    # of an array that is a buffer, which dates have not
    inside = () if isinstance(given, np.ndarray) else ("data", "array")
    for one in (given, *(getattr(given, name, None) for name in inside)):
        if hasattr(one, "magnitude") and hasattr(one, "to") or hasattr(one, "to_value"):
            return getattr(one, "quantity", one)
    if isinstance(given, list | tuple) and given and hasattr(given[0], "magnitude"):
        return type(given[0]).from_list(list(given))
    return None


def _in_units(quantity: Any, units: tuple[str, ...], what: str) -> tuple[Floats, str]:
    """The values of a quantity in the first of these units that it can be told in, and that unit; "" where it has none."""
    stated = str(getattr(quantity, "units", getattr(quantity, "unit", "")))
    if stated in ("", "dimensionless"):
        return numbers(getattr(quantity, "magnitude", getattr(quantity, "value", quantity)), what), ""
    for unit in units:
        try:
            of_astropy = hasattr(quantity, "to_value")
            converted = quantity.to_value(unit) if of_astropy else quantity.to(unit).magnitude
        except Exception:  # each library has its own error for a quantity of another kind
            continue
        return numbers(converted, what), unit
    raise InputError(what, f"their unit is {stated!r}", " or ".join(units), "convert them first")
