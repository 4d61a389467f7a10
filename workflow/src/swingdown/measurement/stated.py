"""Quantities as people write them: ``0.583±0.001``, ``58.3(1) cm``, ``500 g``."""

import re
from typing import NamedTuple

import numpy as np

from ..errors import InputError

# Each unit's dimension and its factor to the first unit of that dimension, which is the SI's.
UNITS: dict[str, tuple[str, float]] = {
    **{name: ("m", factor) for names, factor in (("m meter meters metre metres", 1.0), ("dm", 0.1), ("cm", 1e-2), ("mm", 1e-3), ("in inch", 0.0254), ("ft", 0.3048)) for name in names.split()},
    **{name: ("kg", factor) for name, factor in (("kg", 1.0), ("g", 1e-3), ("mg", 1e-6))},
    **{f"{name}{square}": ("m^2", factor) for square in ("^2", "²", "2") for name, factor in (("m", 1.0), ("cm", 1e-4), ("mm", 1e-6))},
    **{name: ("A", factor) for name, factor in (("A", 1.0), ("mA", 1e-3))},
    **{name: ("V", factor) for name, factor in (("V", 1.0), ("mV", 1e-3))},
    **{name: ("rad", factor) for name, factor in (("rad", 1.0), ("deg", np.pi / 180), ("°", np.pi / 180))},
    **{name: ("kg/m^3", factor) for name, factor in (("kg/m^3", 1.0), ("kg/m3", 1.0), ("kg/m³", 1.0), ("g/cm^3", 1e3), ("g/cm3", 1e3), ("g/cm³", 1e3))},
}  # fmt: skip
_NUMBER = r"[-+]?(?:\d+(?:[.,]\d+)?|\.\d+)(?:[eE][-+]?\d+)?"
_UNIT = r"[^\W\d_][\w/^²³]*|°|"
_WRITTEN = re.compile(
    rf"\s*(?P<open>\(?)\s*(?P<value>{_NUMBER})\s*(?:\((?P<digits>\d+(?:[.,]\d+)?)\)(?P<power>[eE][-+]?\d+)?)?\s*(?P<inner>{_UNIT})\s*"
    rf"(?:(?:±|\+/?-|\\pm)\s*(?P<error>{_NUMBER})\s*)?(?P<close>\)?)\s*(?P<unit>{_UNIT})\s*"
)


class Stated(NamedTuple):
    """A value with its standard uncertainty (NaN: none is stated) and its unit ("": none is stated)."""

    value: float
    uncertainty: float = np.nan
    unit: str = ""

    def of(self, dimension: str) -> "Stated | None":
        """The same in the SI's unit of a dimension such as ``m``; without a unit it is in that already. None in one of another."""
        known, factor = UNITS.get(self.unit, (dimension if not self.unit else "", 1.0))
        if known != dimension:
            return None
        return Stated(self.value * factor, self.uncertainty * factor, dimension)


def read(text: str) -> Stated | None:
    """The ``Stated`` that a text holds, or None where it is no quantity.

    The uncertainty is a standard one: after ``±`` or ``+-``, or in brackets in units of the last digits. Each part may have a
    unit of its own (``0.583 m ± 1 mm``).
    """
    found = _WRITTEN.fullmatch(text.replace("−", "-"))
    if not found or bool(found["open"]) != bool(found["close"]) or (found["digits"] and found["error"]):
        return None
    value, inner, unit = _number(found["value"]), found["inner"], found["unit"]
    if found["open"] and inner:
        return None
    if found["error"] is None and inner and unit:
        return None
    error = np.nan
    if found["error"] is not None:
        error = _number(found["error"])
        if inner and unit and inner != unit:
            (one, factor), (other, own) = (UNITS.get(name, (name, 1.0)) for name in (inner, unit))
            if one != other:
                return None
            error *= own / factor
    elif digits := found["digits"]:
        places = len(re.split("[eE]", found["value"])[0].replace(",", ".").partition(".")[2])
        power = float("1" + (found["power"] or ""))
        scale = power * abs(float("1" + "".join(re.findall(r"[eE][-+]?\d+", found["value"]))))
        error = scale * (_number(digits) if re.search("[.,]", digits) else int(digits) * 10.0**-places)
        value *= power
    return Stated(value, error, inner or unit)


def _number(text: str) -> float:
    return float(text.replace(",", "."))


def quantity(text: str, dimension: str, place: str, what: str, mend: str) -> Stated:
    """The ``Stated`` of a cell or an option in the SI's unit of its dimension; InputError for anything else than one above 0."""
    found = read(text)
    known = found.of(dimension) if found else None
    if known is None or not (known.value > 0 and np.isfinite(known.value)) or known.uncertainty < 0:
        units = {"m": "m, cm or mm", "kg/m^3": "kg/m^3 or g/cm3"}.get(dimension, dimension)
        raise InputError(
            place, f"{text!r} is no {what}", f"a value above 0 in {units}, as 0.583, 0.583±0.001 or 0.583(1)", mend
        )  # fmt: skip
    return known


def name_and_unit(column: str) -> tuple[str, str]:
    """(name in words, unit) of a column that is called by both: ``current_A`` is current in A; the unit is empty where none is known."""
    name, _, unit = column.rpartition("_")
    if name and unit in {one.replace("^", "") for one in UNITS}:
        return name.replace("_", " "), unit.replace("m2", "m²")
    return column.replace("_", " "), ""
