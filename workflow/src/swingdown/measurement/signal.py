"""What the signal's columns hold: an angle about a fitted pivot, one by a coordinate and a length, or as recorded."""

import re
from collections.abc import Mapping
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from ..arrays import Floats
from ..errors import InputError
from ..own_unit import UNNAMED
from .apparent_scale import apparent_scale
from .choice import Chosen, widest
from .files.columns import LENGTH, OF_ACCELERATIONS, OTHER, RATE, SPEED, UNTOLD, accelerates, place_of
from .gyroscope import TO_RAD_PER_S, rate_unit, turning_most
from .judge import Reading
from .plausibility import EVEN_SIDES, check_once, evenness
from .positions import (
    Circle,
    along_a_line,
    along_most,
    by_length,
    fit_circle,
    in_their_plane,
    lost,
    metres,
    on_a_string,
    to_angles,
    without_length,
)
from .sheet import Row
from .units import NO_SCALE, in_rad

UNIT_WORDS = {
    "V": "volts", "rad": "rad", "deg": "degrees", "counts": "counts", "rad/s": "rad/s, an angular rate",
    "deg/s": "degrees a second, an angular rate", NO_SCALE: "readings of unknown scale",
}  # fmt: skip
WIDE = 0.4  # rad; beyond it the sine of an angle dies away a twentieth more slowly than the angle does
MOST_LOST = 0.2  # of the positions: a tracker that loses more follows no bob
_NAMES = {"V": "V", "counts": "counts"}
OF_A_MASS = "an acceleration, taken as the place of a mass on a spring: a loss itself shows in it, so that a structure as small as that may be none"
RELATIVE = "relative"  # in the cell scale: nobody knows it
_SCALE = re.compile(
    r"(?i)(?P<number>[-+.\de]+)\s*(?P<unit>|deg(rees?)?|°|rad)(\s*(/|per )\s*(V|volt|counts?|steps?|readings?|units?))?"
)
_RAW = re.compile(
    r"(?i)\b(adc|raw|analog\w*|a0|sensor ?value|poti?|potentiometer|au|a\.u|arb|ch(annel)? ?\d+ ?v?)\b"
)


class Interpreted(NamedTuple):
    """Times (s) in order, the signal, what it is read as, remarks, attributes to keep, the signal's column, and how it was read."""

    times: Floats
    signal: Floats
    reading: Reading
    remarks: list[str]
    about: dict[str, Any]
    column: str
    rate: float = 0.0  # standard uncertainty of the clock's rate, as a share, that scattered stamps leave
    read: tuple[str, ...] = ()  # in words: the columns, what they are if no angle, the clock, the layout
    input: Floats | None = None  # what was measured of its drive
    input_unit: str = ""  # that the file states of it
    guessed: bool = False  # neither the names nor the number of its columns say which one holds the swing

    def taken(self, reading: Reading) -> str:
        """One line on how the file was read, for what the signal turned out to be."""
        what, instead, *others = self.read
        unit = instead or UNIT_WORDS[reading.unit]
        if reading.unit == NO_SCALE and reading.stated and np.isfinite(self.reading.scale):
            unit = instead or f"readings of {np.degrees(reading.scale):.4g}° each"
        if not (reading.stated or instead):
            unit = f"{unit if reading.unit == 'rad' else unit.upper()} (no unit is stated)"
        return ", ".join([f"took {what} as {unit}", *others])


def signal_of(
    row: Row,
    place: str,
    columns: Chosen,
    times: Floats,
    read: Mapping[str, Floats],
    restoring: str,
    third: str,
) -> Interpreted:
    """The signal that the columns hold: an angle about a fitted pivot, one by a coordinate and a length, or as recorded.

    ``third`` is the column z beside x and y, "" for none.
    """
    first, file, names, values = columns.found[0], row["file"], list(read), list(read.values())
    where = f"{file}, {place_of(first.name)} ({place})"
    if len(columns.found) == 2:
        both = f"{file}, columns {first.name} and {columns.found[1].name} ({place})"
        if third and not first.written:
            raise InputError(
                f"{file}, columns {first.name}, {columns.found[1].name} and {third} ({place})",
                "no unit is stated: are they positions of a bob, its acceleration, or rates about three axes?",
                "positions, or an angle or an angular rate",
                "write the unit of positions in the header, as `x (m)`; of a gyroscope name the axis that it swings about ⟨in signal_column⟩, "
                f"and rad/s ⟨in signal_unit⟩; of an acceleration {OF_ACCELERATIONS}",
            )
        line, plane = along_a_line(values[0], values[1]), list[str]()
        if line is not None and len(values) > 2 and along_a_line(*(made := in_their_plane(values))) is None:
            line, values = None, list(made)
            plane = [f"they lie on a line, and with `{names[2]}` on an arc: taken in the plane of all three"]
        if line is not None:
            on_a_line = "the positions lie on a line, which tells no pivot: how far along it is taken for one coordinate"
            return _computed(_coordinate(row, both, columns, times, line, restoring), on_a_line)
        try:
            circle = fit_circle(values[0], values[1], both)
        except InputError:
            if (line := along_most(times, values[0], values[1])) is None:
                raise
            no_circle = "THE POSITIONS LIE ON NO CIRCLE: how far along the axis on which they move most is taken for one coordinate"
            return _computed(_coordinate(row, both, columns, times, line, restoring), no_circle)
        away = lost(values[0], values[1], circle)
        signal = to_angles(values[0], values[1], circle)
        about = {f"pivot_{key}": value for key, value in circle._asdict().items()}
        left_out = _told_lost(away, circle, signal, first.written, both)
        remarks = [*plane, _pivot(circle, first.written), *left_out]
        reading = Reading("rad", True, 1.0, restoring, True)
        return Interpreted(times[~away], signal[~away], reading, remarks, about, first.name)
    if not columns.unit and (first.kind in (LENGTH, SPEED) or (first.axis and not columns.clock.axis)):
        return _coordinate(row, where, columns, times, values[0], restoring)
    if first.kind == RATE or len(read) == 1:
        taken, told = turning_most(names, values)
    else:
        taken, told = widest(times, read, f"{file} ({place})")
    about = {"counts_per_revolution": row["counts_per_revolution"]} if columns.unit == "counts" else {}
    if first.kind == UNTOLD and not columns.unit and not row.get("scale"):
        check_once(values[taken], where)
    reading = _reading(row, columns, times, values[taken], restoring, where)
    # a force may be another one than the spring's, and a rate is no deflection
    if restoring == "linear" and accelerates(first):
        told = [*told, OF_A_MASS]
    if restoring == "linear" and (first.kind not in (OTHER, SPEED, RATE) or accelerates(first)):
        reading = replace(reading, own=_NAMES.get(columns.unit) or first.written or UNNAMED)
    return Interpreted(times, values[taken], reading, told, about, names[taken])


def _reading(row: Row, columns: Chosen, times: Floats, signal: Floats, restoring: str, where: str) -> Reading:
    """What a column is read as: by its unit, the sheet's scale, or its name where that is one of raw readings."""
    unit, scale = columns.unit, _stated_scale(row, where)
    if unit == "counts" and scale is None:
        turn = row["counts_per_revolution"]
        return Reading(unit, True, 2 * np.pi / turn if turn > 0 else np.nan, restoring)
    if unit in ("V", "counts"):
        return Reading(unit, True, 0.0 if scale is None else scale, restoring)
    if unit and scale is not None and np.isfinite(scale):
        raise InputError(
            f"{where}, column scale",
            f"{row['scale']!r} is what one unit of the signal is worth, and that is in {unit} already",
            "a scale of volts, counts or readings without a unit",
            f"leave ⟨scale⟩ out, or write counts or V ⟨in signal_unit⟩ for what is not in {unit}",
        )
    if unit in TO_RAD_PER_S:
        return Reading(unit, True, 0.0, restoring)
    # asked for by ``relative``: period and decay alone; so are a force and an acceleration, in step with what a spring pulls back
    if (scale is not None and np.isnan(scale)) or columns.found[0].kind == OTHER:
        return Reading(NO_SCALE, True, np.nan, restoring)
    if unit:
        return Reading(unit, True, in_rad(unit), restoring)
    if columns.found[0].kind == RATE:
        return Reading(rate_unit(times, signal), False, 0.0, restoring)
    if scale is not None:
        return Reading(NO_SCALE, True, scale, restoring)
    if _RAW.search(columns.found[0].name.replace("_", " ")):
        return Reading(NO_SCALE, True, np.nan, restoring)
    return Reading("rad", False, 1.0, restoring)


def _stated_scale(row: Row, where: str) -> float | None:
    """Rad per unit of the signal by the sheet's cell ``scale``; NaN for ``relative``, None for an empty cell."""
    cell = str(row.get("scale", "") or "").strip()
    if not cell:
        return None
    if cell == RELATIVE:
        return np.nan
    try:
        scale = float(np.radians(_degrees_a_unit(cell)))
    except (ValueError, ZeroDivisionError):
        scale = 0.0
    if not (np.isfinite(scale) and scale):
        raise InputError(f"{where}, column scale", f"{cell!r} is no scale", "degrees that one unit of the signal is worth, two readings at known angles as 512=0,700=30, or relative", "correct ⟨scale⟩")  # fmt: skip
    return scale


def _degrees_a_unit(cell: str) -> float:
    """The degrees that one unit is worth: ``0.35``, ``0.35 deg/V``, ``0.006 rad/V``, or by two readings and their angles, ``512=0,700=30``."""
    if "=" not in cell:
        said = _SCALE.fullmatch(cell)
        if said is None:
            raise ValueError(cell)
        number = float(said["number"])
        return float(np.degrees(number)) if said["unit"].lower() == "rad" else number
    pairs = [pair.split("=") for pair in cell.replace(";", ",").split(",")]
    (first, low), (second, high) = [(float(reading), float(angle)) for reading, angle in pairs]
    return (high - low) / (second - first)


def _coordinate(
    row: Row, where: str, columns: Chosen, times: Floats, x: Floats, restoring: str
) -> Interpreted:
    """The angle of one coordinate of the bob: by the length that the sheet states, as a small swing, or without a scale."""
    first = columns.found[0]
    unit, alone = first.written, len(columns.found) == 1
    cell, scale = str(row.get("length", "") or "").strip(), _stated_scale(row, where)
    height, even = first.axis == "y" and alone, evenness(x)
    if (alone and even < EVEN_SIDES) or (height and (cell or not even >= EVEN_SIDES)):  # nan is neither
        raise InputError(
            where,
            "it is the height of a bob without its partner x: it goes up and down twice a period"
            if height
            else "its turning points of one side stay where they are: the height of a bob goes up and down twice a period",
            "the horizontal coordinate, or both",
            "export x too, or name its column ⟨in signal_column⟩",
        )
    if not unit and alone:
        check_once(x, where)
    reading = Reading("rad", True, 1.0, restoring)
    if cell and first.kind != SPEED:
        length = metres(cell, unit, where)
        told = [f"one coordinate: the angle is its arcsine over the length, {cell}"]
        return Interpreted(times, by_length(x, length, where), reading, told, {}, first.name)
    each = metres(f"1 {unit}", "m", where, quiet=True) if unit and first.kind != SPEED else 0.0
    if scale is None and each and not height and (small := without_length(times, x, each, where)):
        return Interpreted(times, small[0], reading, small[1], {}, first.name)
    if scale is None and restoring == "sine" and first.kind != SPEED and not height:
        _ask_length(times, x, each, where)
    told = [
        "the speed of a bob: taken as it swings"
        if first.kind == SPEED
        else "the height of a bob whose tops fall as its bottoms rise, as on a spring: taken as it swings"
        if height
        else "one coordinate without a length (⟨length⟩, in its unit): taken as it swings, whatever pulls it back"
    ]
    known = np.nan if scale is None else scale
    own = (unit or UNNAMED) if restoring == "linear" and first.kind != SPEED else ""
    reading = Reading(NO_SCALE, True, known, restoring, own=own)
    return Interpreted(times, x, reading, told if scale is None else [], {}, first.name)


def _ask_length(times: Floats, x: Floats, each: float, where: str) -> None:
    """InputError where the period of one coordinate, ``each`` m a unit (0.0: not known), falls with its swings as that of a pendulum whose sine
    is not its angle, and as a bob's on a string does that swings so far: no spring's does."""
    wide = float(np.ptp(x)) / 2
    if apparent_scale(times, x) * wide > WIDE and not 0 < wide * each < WIDE * on_a_string(times, x):
        problem = "its period falls as its swings shrink, as a pendulum's does: they are wide, and the angle of one coordinate is an arcsine over its length"
        mend = "state ⟨length⟩, in its unit; for the period alone write ⟨scale=relative⟩"
        raise InputError(where, problem, "the length, from the pivot to the point that was followed", mend)


def _told_lost(away: np.ndarray, circle: Circle, angle: Floats, unit: str, place: str) -> list[str]:
    """Remarks on positions off the circle, which a tracker lost; InputError where they are too many."""
    share, unit = float(np.mean(away)), f" {unit}" if unit else ""
    if share > MOST_LOST:
        problem = f"{100 * share:.0f} % of the positions lie off the circle of the others, {circle.residual:.2g}{unit} (RMS)"
        mend = "track it anew, or leave the part out with ⟨start_s⟩ and ⟨stop_s⟩"
        raise InputError(place, problem, "a bob that the tracker follows", mend)
    told = [f"{int(away.sum())} of {away.size} positions lie off the circle, as where a tracker lost the bob: left out as missing"] if away.any() else []  # fmt: skip
    swing = circle.radius * float(np.ptp(angle)) / 2
    if circle.residual > 0.1 * swing:
        told.append(
            f"THE TRACKER SCATTERS by {100 * circle.residual / swing:.0f} % of the swing: values are as unsure as that makes them"
        )
    return told


def _computed(made: Interpreted, remark: str) -> Interpreted:
    """What was computed of two coordinates, with a remark before its own."""
    return made._replace(reading=replace(made.reading, computed=True), remarks=[remark, *made.remarks])


def _pivot(circle: Circle, unit: str) -> str:
    unit = f" {unit}" if unit else ""
    return (
        f"the pivot was fitted to the positions: x {circle.x:.6g} ± {circle.u_x:.2g}{unit}, "
        f"y {circle.y:.6g} ± {circle.u_y:.2g}{unit}, radius {circle.radius:.6g} ± {circle.u_radius:.2g}{unit}, "
        f"points {circle.residual:.2g}{unit} (RMS) from the circle"
    )
