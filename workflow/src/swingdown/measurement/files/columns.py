"""What a column's header says: a quantity and its unit, and so which columns hold the time and the swing."""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from types import MappingProxyType

from ...errors import InputError
from ..sheet import SIGNAL_UNITS, TIME_UNITS, unit_of

TIME, ANGLE, VOLTAGE, COUNTS, LENGTH, SPEED, RATE, OTHER, UNTOLD = (
    "a time", "an angle", "a voltage", "counts", "a length", "a speed", "an angular rate", "something else", "",
)  # fmt: skip

_METRES = ("meter", "metre", "meters", "metres", "metro", "metros", "metri", "mètre", "mètres")
_PIXELS = ("px", "pixel", "pixels")
# Units as programs write them: what is measured, and the unit by the sample sheet's name where it has one.
_WRITTEN = {
    (TIME, "s"): ("s", "sec", "secs", "second", "seconds", "sekunde", "sekunden", "seconde", "secondes", "segundo", "segundos", "secondo", "secondi", "с", "сек", "秒"),
    (TIME, "ms"): ("ms", "msec", "millis", "millisecond", "milliseconds", "millisekunden", "millisecondes", "milisegundos", "milissegundos", "millisecondi", "мс", "毫秒"),
    (TIME, "us"): ("us", "µs", "μs", "usec", "micros", "microsecond", "microseconds"),
    (TIME, "ns"): ("ns", "nsec", "nanos", "nanosecond", "nanoseconds"),
    (TIME, ""): ("min", "minutes", "h", "hours", "1/10 s", "0.1 s", "0,1 s", "1/100 s", "0.01 s", "0,01 s"),
    (ANGLE, "rad"): ("rad", "rads", "radian", "radians", "radiant", "radianti", "radianes", "radianos", "рад"),
    (ANGLE, "deg"): ("deg", "degs", "degree", "degrees", "°", "º", "˚", "degrés", "degré", "grados", "gradi", "graus", "град", "度", "도"),
    (ANGLE, ""): ("grad", "gon", "rev", "revs", "revolutions", "turn", "turns", "mrad", "arcmin", "arcsec"),
    (VOLTAGE, "V"): ("v", "volt", "volts"),
    (VOLTAGE, ""): ("mv", "µv", "μv"),
    (COUNTS, "counts"): ("count", "counts", "ticks"),
    (LENGTH, ""): ("m", "dm", "cm", "mm", "km", "in", "inch", "ft", *_PIXELS, *_METRES),
    (SPEED, ""): ("m/s", "dm/s", "cm/s", "mm/s", "px/s"),
    (RATE, "rad/s"): ("rad/s", "rad/sec", "rad·s⁻¹", "rad s^-1", "rad*s^-1", "rad s⁻¹", "rad s-1", "radians/s", "rads/s", "рад/с", "рад/сек"),
    (RATE, "deg/s"): ("deg/s", "deg/sec", "degrees/s", "degrés/s", "grados/s", "gradi/s", "graus/s", "°/s", "º/s", "˚/s", "dps", "°/sec", "deg s⁻¹", "град/с", "град/сек"),
    (RATE, ""): ("1/s", "rpm", "mdps"),
    (OTHER, ""): (
        "m/s^2", "m/s²", "m/s2", "g", "mg", "n", "nm", "n·m", "°c", "c", "°f", "k", "hz", "kg", "t", "µt", "μt",
        "mt", "lx", "lux", "pa", "hpa", "kpa", "a", "ma", "w", "j", "db", "%", "rad/s^2", "rad/s²", "deg/s^2", "°/s²", "°/s^2",
    ),
}  # fmt: skip
# units that are a column's whole name: those of one letter are as well a symbol
_ALONE = {"counts", "volt", "volts", *_PIXELS} | {
    written
    for (kind, unit), all_ in _WRITTEN.items()
    if unit and kind in (TIME, ANGLE, RATE)
    for written in all_
    if len(written) > 1
}
_IN = "(?:in|en|em)"  # between a quantity and its unit
_TEMPERATURE = re.compile(r"(?i)\b(temp|temperatur\w*|température|thermo\w*)\b")
_A_SECOND = re.compile(r"(?i)(.+)_(rad|deg|mm|cm|m)_(?:per_)?s(?:ec)?")
UNNAMED = "Unnamed: "  # before the number of a column without a name, where others have one
SIGNAL_RATES = ("rad/s", "deg/s")
_ACCELERATIONS = ("m/s^2", "m/s²", "m/s2", "g", "mg")
UNITS = {written: meaning for meaning, all_ in _WRITTEN.items() for written in all_}
# a rate, a speed or an acceleration in words: `Grad pro Sekunde`, `metros por segundo al cuadrado`
_PER = re.compile(
    r"(?i)(?<!\w)([^\W\d_]+)(?: (?:per|pro|por|par|al) | ?/ ?)(\w{3,})( (?:squared|quadrat|hoch 2|al cuadrado|au carré|al quadrato|ao quadrado))?"
)

_TIMES = re.compile(
    r"(?i)\b(t|time|zeit|temps|tiempo|tempo|tijd|czas|čas|tid|zaman|время|час|时间|時間|시간|timestamp|stamp|elapsed|millis|micros)\b"
)
_FROM_ROW_TO_ROW = re.compile(
    r"(?i)Δ|\b(previous|prev|last|delta|diff|difference|interval|step|between|d) ?t?\b|\bdt\b"
)
_ATTITUDE = re.compile(r"(?i)\b(roll|pitch|yaw)\b")
_ANGLES = re.compile(
    r"(?i)θ|φ|\b(theta|phi|angle|angular position|winkel|ángulo|angulo|ângulo|angolo|hoek|kąt|úhel|uhol|vinkel|açı|угол|кут|角度|각도|ausschlag|roll|pitch|yaw|euler|orient)\b"
)
_DRIVES = re.compile(
    r"(?i)\b(drive|driver|driving|motor|forcing|excitation|exciter|input(?! ?[a-d\d]\b)|forzante|forzatura|erreger|antrieb|excitateur|torques?|tau|effort|"
    r"forces?|pwm|control|command|cmd|set ?point|desired|reference|output (voltage|current|power))\b"
)
_ACCELERATES = re.compile(
    r"(?i)α|\b(acceleration|accelerations|accelerometer|accel|acc|beschleunigung|accélération|aceleración|aceleracion|aceleração|accelerazione)[ .]?[xyz]?\b"
    r"|\b(a|g ?f)[ .]?[xyzt]\b"
)
_TURNS = re.compile(r"(?i)\b(velocity|rate|gyro\w*|omega|w[xyz]|gy?r?[ .]?[xyz])\b|ω")
_FIELD = re.compile(r"(?i)\b(compass|magnetometer|mag)\b")  # its x and y are no positions
# a column of uncertainties
OF_AN_ERROR = re.compile(
    r"(?i)\b(d[xytaθ]|[xyta]?_?err(or)?s?|unc(ert(ainty|ainties)?)?|sigma|sd|std)\b|[xyta]err\b|±|σ|δ"
)
_HUMP = re.compile("(?<=[a-z])(?=[A-Z][a-z])")  # of `SampleTime`
_POINT = re.compile(r"(?i)([xy])[ _]?(\d)")
_SIZE_ALONE = re.compile(r"(?i)\b(abs|absolute|magnitude|norm|total|betrag)\b")
_NUMBERS = re.compile(
    r"(?i)(frame|frames|frame ?(no|nr|number|index|id)|bild|bildnummer|fotograma|image|sample|samples|sample ?(no|nr|number|id|index)|index|idx|n|no|nr)\.?"
)
_TICKS = re.compile(r"(?i)((cpu|clock|timer|sys|system)[ _]?)?(ticks?|cycles?)")
_QUATERNION = re.compile(r"(?i)(q|quat|quaternion|orientation)[ _.]?[wxyz0-3]")
_COORDINATE, _THIRD = (
    re.compile(
        rf"(?i)^(?:.*[ _/-])?(?:position[ _-]?|pos|c|center|centre|centroid)?([{axes}])(?:[ _-]?(?:position|pos|c|center|centre))?$"
    )
    for axes in ("xy", "z")
)
OF_ACCELERATIONS = (
    "record the gyroscope in the same way: an accelerometer that rides on the bob tells no angle; for a weight on a spring, whose "
    "acceleration swings as it does, write ⟨restoring=linear⟩ and name the column ⟨in signal_column⟩"
)


@dataclass(frozen=True)
class Meaning:
    """What one column holds, as far as its header says."""

    name: str
    kind: str  # TIME, ANGLE, ...; UNTOLD where the header says nothing
    unit: str = ""  # by the sample sheet's name; "" where none is stated, or none the sheet knows
    written: str = ""  # the unit as it stands in the header
    axis: str = ""  # x or y of a position
    attribute: bool = False  # True where the file states the unit beside the header, as netCDF does


@lru_cache(maxsize=10_000)  # each row of a table is asked whether it is a header
def meaning(name: str, beside: str = "") -> Meaning:
    """What one column holds, as far as its header says.

    Parameters
    ----------
    name
        ``Angle (°)``, ``t [ms]``, ``t/s``, ``theta_rad``, ``Latest: Time (s)``.
    beside
        A unit that the file states apart from the header; it goes first where it is known.
    """
    mended = re.sub("Â(?=[°µ])", "", name)  # UTF-8 that a program took for Latin-1
    bare = re.sub(r"(?i)^latest:|\brun #?\d+\b|\bset \d+\b", " ", mended).strip(" :,")
    label, written = _unit_in(_PER.sub(_in_symbols, bare))
    attribute = beside.lower().partition(" since ")[0].strip()
    if known := beside in UNITS or attribute in UNITS:
        written = beside if beside in UNITS else attribute
    kind, unit = UNITS.get(
        written.lower() if written not in UNITS else written, (OTHER if written else UNTOLD, "")
    )
    if kind == ANGLE and _TEMPERATURE.search(label.replace("_", " ")):
        kind, unit = OTHER, ""
    words = (label if "=" in label else _HUMP.sub(" ", label)).replace("_", " ")  # a setting is no name
    if kind == TIME and _named(words) == ANGLE:  # what an angle makes in a second is no time: `angle/s`
        kind, unit, written = RATE if "/" in bare else ANGLE, "", ""
    if kind == UNTOLD:
        kind = _named(words)
    if kind == UNTOLD and _QUATERNION.fullmatch(label):
        kind, written = OTHER, "part of a quaternion"
    written = "m" if written.lower() in _METRES else written
    coordinate = _COORDINATE.match(label) if kind in (LENGTH, UNTOLD) else None
    return Meaning(name, kind, unit, written, coordinate[1].lower() if coordinate else "", known)


def _named(words: str) -> str:
    """What the words of a header say that a column holds, without its unit; UNTOLD where they do not."""
    if _ACCELERATES.search(words) or _FIELD.search(words):
        return OTHER
    if _TURNS.search(words):
        return RATE
    return TIME if _TIMES.search(words) else ANGLE if _ANGLES.search(words) else UNTOLD


def _in_symbols(words: re.Match[str]) -> str:
    """A unit in words by its symbols, ``deg/s``; the words as they stand where these are no angle or length, or no second."""
    kind, unit = (ANGLE, "deg") if words[1].lower() == "grad" else UNITS.get(words[1].lower(), (UNTOLD, ""))
    unit = "m" if words[1].lower() in _METRES else unit or words[1]
    a_second = UNITS.get(words[2].lower()) == (TIME, "s")
    if a_second and not words[3] and _named(words[1]) == ANGLE:  # a rate in no unit
        return f"{words[1]} rate"
    if kind not in (ANGLE, LENGTH) or not a_second:
        return words[0]
    return f"{unit}/s{'^2' if words[3] else ''}"


def _unit_in(name: str) -> tuple[str, str]:
    """A header's label and the unit that it states, or ""."""
    if name.lower() in _ALONE:
        return name, name.lower()
    if found := _A_SECOND.fullmatch(name):
        return found[1], f"{found[2]}/s"
    if found := re.fullmatch(r"(.*?)\s*[(\[]\s*([^()\[\]]*?)\s*[)\]]\s*", name):
        label, inside = found.groups()
        # a word of comment, such as in ``angle (filtered)``, is none
        return label, inside if inside.lower() in UNITS or re.search(r"[/^°²·%]", inside) else ""
    # the German noun; what is no noun may be a 400th of a turn
    if found := re.fullmatch(rf"(.+) {_IN} Grad(/s)?", name):
        return found[1], "degrees" + (found[2] or "")
    for pattern in (
        rf"(.+) {_IN} (\S+)",  # before a stroke, which may be the unit's own
        r"(.+)[ _](\S+/\S+)",
        r"(.+?)[,;:]\s*(\S+)",
        r"(.+?)\s*/\s*(.+)",
        r"(.+)_([^_]+)",
        r"(.+) (\S+)",
    ):
        if (found := re.fullmatch(pattern, name)) and found[2].lower() in UNITS and _states(*found.groups()):
            return found[1], found[2]
    return name, ""


def _states(label: str, unit: str) -> bool:
    """True where a last word of one letter is a unit and not a name: ``theta_t`` is no tesla, and what is counted per second no time."""
    kind, _ = UNITS[unit.lower()]
    if "/" in unit or re.search(r"(?i) (per|pro|por|par|al)$", label):
        return "/" in unit
    return kind not in (OTHER, SPEED) and not (kind == LENGTH and unit == "in")


def choose(
    names: Sequence[str],
    time: str,
    signal: str,
    place: str,
    units: tuple[str, str] = ("", ""),
    beside: Mapping[str, str] = MappingProxyType({}),
) -> tuple[Meaning, list[Meaning]]:
    """The column of the time, and that of the swing, or the two of its position x, y.

    ``time`` and ``signal`` are what the sample sheet names, "" where it leaves the choice, and ``units`` those
    that it states; ``beside`` holds units that the file tells apart from its header. Without a word from it the time is the first column beside the swing that it names, unless that
    is something else and another says that it is one; the swing is the second, unless that is no angle and another one is. InputError
    names what a column holds that cannot be an angle.
    """
    columns = _numbered_once([meaning(name, beside.get(name, "")) for name in names])
    by_name = {column.name: column for column in columns}
    if time:
        clock = by_name[time]
    else:
        free = [one for one in columns if one.name != signal or (one.kind == TIME and not units[1])]
        clock = next((one for one in free if one.kind == TIME), (free or columns)[0])
    if not units[0] and clock.kind not in (TIME, UNTOLD):
        raise InputError(
            f"{place}, {place_of(clock.name)}",
            f"{_saying(clock)} cannot be the time",
            "a column of time in s, ms, us or ns",
            "name it ⟨in time_column⟩, or write its unit ⟨in time_unit⟩; for a file without times write the samples a second ⟨in rate_hz⟩",
        )
    if not units[0] and clock.written and not clock.unit:
        problem = f"the unit of the time, {clock.written!r}, is not known here"
        mend = "convert the column, or write its unit ⟨in time_unit⟩"
        raise InputError(f"{place}, {place_of(clock.name)}", problem, "s, ms, us or ns", mend)
    others = [one for one in columns if one is not clock]
    return clock, _swing(clock, others, by_name, signal, place, units[1])


def _numbered_once(columns: list[Meaning]) -> list[Meaning]:
    """The columns, ``X1`` and ``Y1`` of a single point with their axes: of several points nobody says which is the bob."""
    found = [_POINT.fullmatch(one.name) if one.kind in (LENGTH, UNTOLD) else None for one in columns]
    axes, points = [one[1].lower() for one in found if one], {one[2] for one in found if one}
    if sorted(axes) != ["x", "y"] or len(points) > 1:
        return columns
    return [replace(one, axis=at[1].lower()) if at else one for one, at in zip(columns, found, strict=True)]


def _swing(
    clock: Meaning, others: list[Meaning], by_name: dict[str, Meaning], signal: str, place: str, stated: str
) -> list[Meaning]:
    if not others:
        raise InputError(
            place, "the file has 1 column(s)", "a column of time and one of the signal", "export both, or write the samples a second ⟨in rate_hz⟩",
        )  # fmt: skip
    if signal:
        chosen = by_name[signal]
        pair = _pair(others) if chosen.kind == LENGTH or (chosen.axis and not stated) else []
        if not stated and chosen in pair:
            return pair
        return [_checked(chosen, others, place, stated)]
    # what drives a pendulum, the number of the sample, and what stands beside a table without a name are none, while there is another
    for is_none in (drives, numbers_rows, lambda name: name.startswith(UNNAMED)):
        others = [one for one in others if not is_none(one.name)] or others
    others = [one for one in others if one.kind != TIME] or others  # another clock
    first = others[0]
    if stated in SIGNAL_RATES and (turning := next((one for one in others if one.kind == RATE), None)):
        return [turning]
    if stated or (first.unit and first.kind in (ANGLE, VOLTAGE, COUNTS)):
        return [first]
    if found := next((one for one in others if one.kind == ANGLE and one.unit), None):
        return [found]
    if pair := _pair(others):
        return pair
    if clock.axis == "x" and (drawn := next((one for one in others if one.axis == "y"), None)):
        return [_checked(drawn, others, place, "")]  # a graph's: y over x, its errors may follow
    for wanted in _LIKELIEST:
        if found := next((one for one in others if wanted(one)), None):
            return [found]
    first = next((one for one in others if not accelerates(one)), first)  # a gyroscope beside tells more
    return [_checked(first, others, place, "")]


def drives(name: str) -> bool:
    """True for the name of a column of what drives a pendulum, which is no swing; `Input A` is a channel of an instrument."""
    return bool(_DRIVES.search(name.replace("_", " ")))


def axes_beside(names: Sequence[str], chosen: Meaning, beside: Mapping[str, str]) -> list[str]:
    """The columns that hold the same about other axes as the ``chosen`` one, in its unit, that among them: of an angular rate the rates,
    of roll, pitch or yaw those. How fast it turns without saying which way is none of them."""
    if chosen.kind != RATE and not _of_attitude(chosen):
        return [chosen.name]
    columns = [meaning(name, beside.get(name, "")) for name in names]
    beside_it = [
        one
        for one in columns
        if (one.kind, one.unit, one.written) == (chosen.kind, chosen.unit, chosen.written)
        and (one.kind == RATE or _of_attitude(one))
    ]
    return [one.name for one in beside_it if not _SIZE_ALONE.search(one.name) and not drives(one.name)]


def _of_attitude(one: Meaning) -> bool:
    """True for one of the three angles of a body."""
    return one.kind == ANGLE and bool(_ATTITUDE.search(one.name.replace("_", " ")))


def _is_speed(one: Meaning) -> bool:
    return one.kind == SPEED and not _SIZE_ALONE.search(one.name)


# What the swing may be where no column is an angle in a unit, the likeliest first.
_LIKELIEST: tuple[Callable[[Meaning], bool], ...] = (
    lambda one: one.kind == ANGLE and not one.written,
    lambda one: one.kind == UNTOLD and not one.axis,
    lambda one: bool(one.unit) and one.kind in (VOLTAGE, COUNTS),
    lambda one: bool(one.unit) and one.kind == RATE and not _SIZE_ALONE.search(one.name),
    lambda one: one.kind == LENGTH,
    _is_speed,
)


def _pair(columns: list[Meaning]) -> list[Meaning]:
    """The first x and the first y of one unit, or nothing; a z in a unit of length stands for either where it is missing."""
    x = next((one for one in columns if one.axis == "x"), None)
    y = next((one for one in columns if one.axis == "y" and (not x or one.written == x.written)), None)
    both = [one for one in (x, y) if one]
    z = third(columns, both[0]) if len(both) == 1 else None
    return [*both, z] if z else both if len(both) == 2 else []


def third(columns: Sequence[Meaning], beside: Meaning) -> Meaning | None:
    """The z of a position in a unit of length that is that of the coordinate ``beside`` it; None without one."""
    for one in columns if beside.kind == LENGTH else ():
        if one.kind == LENGTH and one.written == beside.written and _THIRD.match(_unit_in(one.name)[0]):
            return one
    return None


def accelerates(one: Meaning) -> bool:
    """True of an acceleration, by its unit or, without one, by its name."""
    return one.written.lower() in _ACCELERATIONS or (
        not one.written and one.kind == OTHER and bool(_ACCELERATES.search(one.name.replace("_", " ")))
    )


def _saying(one: Meaning) -> str:
    kind = "an acceleration" if accelerates(one) else one.kind
    return f"{kind or 'a column'}" + (f" in {one.written!r}" if one.written else "")


def _checked(one: Meaning, others: list[Meaning], place: str, stated: str) -> Meaning:
    """``one``; InputError by name where it can be neither an angle nor one coordinate of a bob."""
    if one.kind == RATE and _SIZE_ALONE.search(one.name):
        raise InputError(
            f"{place}, {place_of(one.name)}",
            "it is a speed without a direction",
            "the rate about one axis, in rad/s or deg/s",
            "name the column of that axis ⟨in signal_column⟩",
        )
    if stated or (one.unit and one.kind in (ANGLE, VOLTAGE, COUNTS, RATE)):
        return one
    if one.kind == LENGTH or _is_speed(one) or (one.kind in (ANGLE, RATE, UNTOLD) and not one.written):
        return one
    mends = {
        RATE: "write rad/s or deg/s ⟨in signal_unit⟩, or convert the column to one of them",
        ANGLE: "convert it to rad or deg",
        VOLTAGE: "convert it to V, rad or deg",
    }
    if accelerates(one):
        mends[OTHER] = OF_ACCELERATIONS
    unknown = dict.fromkeys((ANGLE, VOLTAGE), " in a unit known here") | {
        RATE: " and no rate in a unit known here"
    }
    raise InputError(
        f"{place}, {place_of(one.name)}",
        f"{_saying(one)} is no angle{unknown.get(one.kind, '')}",
        "an angle in rad or deg, an angular rate in rad/s or deg/s, encoder counts, volts, or positions x and y"
        + (f"; the file has {', '.join(column.name for column in others)}" if len(others) > 1 else ""),
        mends.get(one.kind, "name the column of the angle ⟨in signal_column⟩"),
    )


def from_row_to_row(one: Meaning) -> bool:
    """True for a column that by its name holds how much time passed since the row before: ``dt``, ``time from previous sample (ms)``."""
    words = one.name.replace("_", " ")
    named = one.kind == TIME or re.fullmatch(r"(?i)(d|Δ|delta) ?t", words)
    return bool(named and _FROM_ROW_TO_ROW.search(words))


def numbers_rows(name: str) -> bool:
    """True for the name of a column that counts frames or samples and is no time."""
    return bool(_NUMBERS.fullmatch(name.replace("_", " ").strip()))


def ticks_alone(name: str) -> bool:
    """True for the name of a column that counts what a clock does, which is in no unit of time."""
    return bool(_TICKS.fullmatch(name.strip()))


def place_of(name: str) -> str:
    """How a column is called where something is wrong with it: by its name, or by its number where it has none."""
    return name if re.fullmatch(r"column \d+", name) else f"column {name}"


def known_unit(column: Meaning, stated: str, kinds: Sequence[str]) -> str:
    """The unit of a column: the sheet's word, else the ending of its name, else its header's, else ""."""
    own = column.unit if column.kind in kinds else ""
    ending = unit_of(column.name, TIME_UNITS if TIME in kinds else SIGNAL_UNITS)
    return stated or (own if column.attribute else "") or ending or own
