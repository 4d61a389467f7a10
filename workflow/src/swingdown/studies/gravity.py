"""The acceleration of gravity from a pendulum and its lengths, with the budget of its uncertainty (JCGM 100, 5.1 and H)."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pandas as pd

from ..arrays import finite_or_none
from ..errors import InputError
from ..measurement.stated import Stated, quantity
from ..pendulum.half_swings import lengthening
from ..rounding import plus_minus, value_with_uncertainty
from .pendulums import TOGETHER, cells_of, in_order
from .quantities import Quantity

UNIT = "m/s^2"
PIVOT = "pivot_distance"  # the cell of a rigid body's pivot
TWO = "two pivots"
# cells of the sheet, and in what they are
STATED = {"length": "m", "bob_diameter": "m", "bob_density": "kg/m^3"}
PIXELS = ("px", "pixel", "pixels")
ON_EARTH = 9.81  # m/s^2
# kg/m^3: 10 to 30 °C and 950 to 1040 hPa, taken as a rectangle (JCGM 100, 4.3.7)
AIR = Stated(1.20, 0.08 / np.sqrt(3), "kg/m^3")
# What a ball in an ideal fluid carries along, in masses of the air it displaces; the layer that clings to it adds up to as much again
# (Stokes 1851; Nelson and Olsson, Am. J. Phys. 54, 112 (1986)).
CARRIED = Stated(0.5, 0.5 / np.sqrt(3), "1")
_U, _PART = "standard_uncertainty", "contribution_m_per_s2"
_COLUMNS = ["quantity", "value", _U, "unit", "sensitivity", _PART, "note"]


@dataclass(frozen=True)
class Gravity:
    """g with its uncertainty, in m/s²; the uncertainty is NaN where a length has none, and ``u_without_length`` that by all inputs but the lengths.

    ``of``: what the pendulum was taken for. ``budget``: a row for each input, quantity, value, standard_uncertainty, unit, sensitivity,
    contribution_m_per_s2, note.
    """

    value: float
    uncertainty: float
    u_without_length: float
    of: str
    budget: pd.DataFrame = field(repr=False)

    @property
    def sentence(self) -> str:
        """What is said of it."""
        known = np.isfinite(self.uncertainty)
        number = plus_minus(self.value, self.uncertainty) if known else self.text
        return f"g = {number} m/s², {of_words(self)}"

    @property
    def text(self) -> str:
        """The number with its uncertainty; where a length has none, to the digits that all else leaves."""
        return value_with_uncertainty(self.value, self.uncertainty, self.u_without_length)

    def to_dict(self) -> dict[str, Any]:
        """Plain numbers and texts; None for what was not given."""
        budget = self.budget.astype(object).where(self.budget.notna(), None)
        return {
            "value": self.value,
            "standard_uncertainty": finite_or_none(self.uncertainty),
            "standard_uncertainty_without_length": self.u_without_length,
            "unit": UNIT,
            "text": self.text,
            "of": self.of,
            "budget": budget.to_dict("records"),
        }


_STRUNG = {
    (False, False): "a point on a string without mass, air left out",
    (True, False): "a ball on a string without mass, air left out",
    (False, True): "a point on a string without mass, with the air's buoyancy and inertia",
    (True, True): "a ball on a string without mass, with the air's buoyancy and inertia",
}  # by whether the bob's diameter and its density are known


def gravity(
    natural_frequency: Stated,
    length: Stated,
    bob_diameter: Stated | None = None,
    bob_density: Stated | None = None,
    amplitude: float = np.nan,
    period: float = np.nan,
) -> Gravity:
    """The ``Gravity`` of a bob on a string without mass. Errors of the inputs count as independent.

    Parameters
    ----------
    natural_frequency
        Of small undamped swings, in rad/s.
    length
        From the pivot to the bob's middle, in m.
    bob_diameter
        Of a ball, in m: adds its inertia.
    bob_density
        In kg/m³: adds the air's buoyancy and inertia.
    amplitude, period
        In rad and s: the budget then has the correction for the amplitude.
    """
    inputs = {"length": length, "natural frequency": natural_frequency}
    if bob_diameter:
        inputs["bob's diameter"] = bob_diameter
    if bob_density:
        inputs |= {"bob's density": bob_density, "air's density": AIR, "air carried along": CARRIED}

    def value(x: Mapping[str, complex]) -> complex:
        found = x["natural frequency"] ** 2 * x["length"]
        if bob_diameter:
            found *= 1 + x["bob's diameter"] ** 2 / (10 * x["length"] ** 2)
        if bob_density:
            share = x["air's density"] / x["bob's density"]
            found *= (1 + x["air carried along"] * share) / (1 - share)
        return found

    what = _STRUNG[bool(bob_diameter), bool(bob_density)]
    made = _corrections(natural_frequency.value, amplitude, period)
    return _propagated(value, inputs, ("length",), what, made)


def gravity_of_two_pivots(frequencies: Sequence[Stated], distances: Sequence[Stated]) -> Gravity:
    """The ``Gravity`` of one rigid body about two pivots in line with its centre of mass (Kater, Bessel 1828).

    By the natural frequency (rad/s) about each pivot and its distance (m) from the centre of mass; InputError where the distances are equal, or
    contradict the frequencies.
    """
    (one, other), (near, far) = frequencies, distances
    inputs = {
        "distance 1": near, "distance 2": far, "natural frequency 1": one, "natural frequency 2": other,
    }  # fmt: skip

    def value(x: Mapping[str, complex]) -> complex:
        first = x["distance 1"] / x["natural frequency 1"] ** 2
        second = x["distance 2"] / x["natural frequency 2"] ** 2
        return (x["distance 1"] ** 2 - x["distance 2"] ** 2) / (first - second)

    g = value({name: at.value for name, at in inputs.items()}).real if near.value != far.value else 0.0
    inertia = g * near.value / one.value**2 - near.value**2  # about the centre of mass, over the mass
    if not (g > 0 and inertia > 0):
        raise InputError(
            "pivot_distance",
            f"the distances {near.value:g} m and {far.value:g} m give no g with periods of "
            f"{2 * np.pi / one.value:.6g} s and {2 * np.pi / other.value:.6g} s",
            "one rigid body, and pivots at two different distances from its centre of mass",
            "correct the distances, or the order of the recordings",
        )
    return _propagated(
        value, inputs, ("distance 1", "distance 2"), "a rigid body about two pivots, air left out", []
    )


def _propagated(
    value: Callable[[Mapping[str, complex]], complex],
    inputs: Mapping[str, Stated],
    lengths: Sequence[str],
    of: str,
    corrections: list[dict[str, Any]],
) -> Gravity:
    at = {name: complex(one.value) for name, one in inputs.items()}
    step = 1e-30  # of a complex argument: the slope is exact
    rows = []
    for name, one in inputs.items():
        slope = value(at | {name: one.value + 1j * step}).imag / step
        unknown = not np.isfinite(one.uncertainty)
        note = "its uncertainty was not given" + ("" if name in lengths else ", and counts as none")
        rows.append([name, one.value, one.uncertainty, one.unit, slope, abs(slope) * one.uncertainty, note if unknown else ""])  # fmt: skip
    budget = pd.DataFrame(rows, columns=_COLUMNS)
    parts = budget.set_index("quantity")[_PART]
    known = float(np.sqrt(np.nansum(parts.drop(list(lengths)) ** 2)))
    total = float(np.hypot(known, np.sqrt(np.sum(parts[list(lengths)].to_numpy() ** 2))))
    more = pd.DataFrame(corrections, columns=_COLUMNS)
    budget = pd.concat([budget, more], ignore_index=True) if corrections else budget
    return Gravity(float(value(at).real), total, known, of, budget)


def _corrections(frequency: float, amplitude: float, period: float) -> list[dict[str, Any]]:
    """Rows of the budget for what the fit has taken off: their errors are in that of the natural frequency."""
    if not (np.isfinite(amplitude) and np.isfinite(period)):
        return []
    longer = float(lengthening(amplitude)) ** 2
    whole = (frequency * period / (2 * np.pi)) ** 2
    note = "made by the fit; its uncertainty is in that of the natural frequency"
    return [
        {"quantity": f"factor for the amplitude of {np.degrees(amplitude):.3g}°", "value": longer, "unit": "1", "note": note},
        {"quantity": "factor for damping, and the fall within a swing", "value": whole / longer, "unit": "1", "note": note},
    ]  # fmt: skip


def with_gravity(
    table: pd.DataFrame, stated: Mapping[str, Mapping[str, Any]], restoring: str = "sine"
) -> tuple[pd.DataFrame, dict[str, Gravity]]:
    """A table of ``studies.pendulums`` with g where a length is stated, and the ``Gravity`` of each by recording.

    Nothing is added for a spring (``restoring`` linear), for a length in pixels, and where the period at no amplitude is known. ``stated`` are
    the cells of the sample sheet, by recording. InputError for a cell that is no length.
    """
    rows, found = [], {}
    for row in table.to_dict("records"):
        one = _of_row(row, _cells(row, table, stated)) if restoring == "sine" else None
        if one:
            name = str(row["campaign"] if row["recording"] == TOGETHER else row["recording"])
            found[name] = one
            row = row | cells_of("g", Quantity(one.value, one.uncertainty, UNIT)) | {"g_of": of_words(one)}
            if not np.isfinite(one.uncertainty):
                row |= {"g_m_per_s2_text": one.text, "g_u_without_length_m_per_s2": one.u_without_length}
        rows.append(row)
    return (in_order(pd.DataFrame(rows)), found) if found else (table, found)


def of_two_pivots(table: pd.DataFrame, stated: Mapping[str, Mapping[str, Any]]) -> dict[str, Gravity]:
    """The ``Gravity`` of the two recordings of a table of ``pendulums`` whose pivot's distance is stated; nothing where none is.

    InputError where these are not two.
    """
    rows = {row["recording"]: row for row in table.to_dict("records")}
    given = {name: text for name in stated if name in rows and (text := _cell(stated[name], PIVOT))}
    if not given:
        return {}
    pairs: list[tuple[Stated, Stated]] = []
    for name, text in given.items():
        distance = quantity(text, "m", f"recording {name}, {PIVOT}", "distance of a pivot", f"correct ⟨{PIVOT}⟩")  # fmt: skip
        if frequency := frequency_of(rows[name]):
            pairs.append((frequency, distance))
    if len(pairs) != 2:
        raise InputError(
            PIVOT, f"{len(pairs)} recordings with a period and the distance of a pivot",
            "two: one body about two pivots", "give each of two files one release",
        )  # fmt: skip
    frequencies, distances = zip(*pairs, strict=True)
    return {TWO: gravity_of_two_pivots(frequencies, distances)}


def of_words(one: Gravity) -> str:
    """What g is that of, what its uncertainty lacks, and whether no place on Earth has it."""
    told = f"of {one.of}"
    if not np.isfinite(one.uncertainty):
        told += f"; the length's uncertainty was not given, and all else makes {one.u_without_length:.2g}"
    if not 0.5 < one.value / ON_EARTH < 2:
        told += "; no place on Earth has it: are the units of length and time right, and the pendulum a bob on a string?"
    return told


def _cells(
    row: Mapping[str, Any], table: pd.DataFrame, stated: Mapping[str, Mapping[str, Any]]
) -> Mapping[str, Any]:
    if row["recording"] != TOGETHER:
        return stated.get(row["recording"], {})
    own = table.loc[table["campaign"] == row["campaign"], "recording"]
    each = [{key: _cell(stated.get(one, {}), key) for key in STATED} for one in own if one != TOGETHER]
    return each[0] if each and all(one == each[0] for one in each) else {}


def _cell(cells: Mapping[str, Any], name: str) -> str:
    text = cells.get(name)
    return text.strip() if isinstance(text, str) else ""


def _of_row(row: Mapping[str, Any], cells: Mapping[str, Any]) -> Gravity | None:
    frequency = frequency_of(row)
    if not _cell(cells, "length") or frequency is None or _cell(cells, "length").endswith(PIXELS):
        return None
    given = {
        name: quantity(text, dimension, f"recording {row['recording']}, {name}", name.replace("_", " "), f"correct ⟨{name}⟩")
        for name, dimension in STATED.items() if (text := _cell(cells, name))
    }  # fmt: skip
    return gravity(frequency, **given, amplitude=row["amplitude_rad"], period=row["period_s"])


def frequency_of(row: Mapping[str, Any]) -> Stated | None:
    """The frequency (rad/s) of small undamped swings in a row of ``pendulums``; None where it has none."""
    value, error = (row.get(f"natural_frequency_rad_per_s{end}", np.nan) for end in ("", "_u"))
    return Stated(float(value), float(error), "rad/s") if np.isfinite(value) else None


def budgets(found: Mapping[str, Gravity]) -> pd.DataFrame:
    """The budgets below each other, each with the name of its recording and a last row for g itself."""
    if not found:
        return pd.DataFrame(columns=["recording", *_COLUMNS])
    parts = []
    for name, one in found.items():
        total = {
            "quantity": "g", "value": one.value, _U: one.uncertainty, "unit": UNIT, "sensitivity": 1.0, _PART: one.uncertainty,
            "note": of_words(one),
        }  # fmt: skip
        part = pd.concat([one.budget, pd.DataFrame([total])], ignore_index=True)
        part.insert(0, "recording", name)
        parts.append(part)
    return pd.concat(parts, ignore_index=True)
