"""Numbers as a reader wants them: as many digits as the uncertainty bears, a true minus, nothing for not-a-number."""

import re
from math import floor, isfinite, log10, nan

from ..rounding import plus_minus, value_with_uncertainty


def spread(value: float, deviation: float) -> str:
    """``0.131 ± 0.010``: the deviation with two significant digits, the value to the same decimal."""
    if not _ok(value):
        return "–"
    if not _ok(deviation) or deviation <= 0:
        return plain(value)
    return _typeset(plus_minus(value, deviation))


def brief(value: float, uncertainty: float, known: float = nan) -> str:
    """``0.0512(13)``: the uncertainty in units of the last digits of the value; powers of ten where they help.

    ``known`` is the part that is known of an uncertainty that is not: ``0.051(?)``.
    """
    if not _ok(value):
        return "–"
    if not (_ok(uncertainty) and uncertainty > 0 or _ok(known) and known > 0):
        return plain(value)
    return _typeset(value_with_uncertainty(value, uncertainty, known))


def plain(value: float, digits: int = 3) -> str:
    """A number with so many significant digits, without trailing noise; a power of ten if very large or small."""
    if not _ok(value):
        return "–"
    if value == 0:
        return "0"
    power = floor(log10(abs(value)))
    if -4 <= power < 6:
        return _fixed(value, max(digits - 1 - power, 0))
    return f"{_fixed(value / 10.0**power, digits - 1)} × 10{_superscript(power)}"


def whole(value: float) -> str:
    """A number without decimals."""
    return _fixed(value, 0) if _ok(value) else "–"


def in_sentence(text: str) -> str:
    """A sentence whose values with uncertainties are told as in the tables: ``1.23(4)e5`` as ``1.23(4) × 10⁵``."""
    return re.sub(r"(?<=\))e(-?\d+)", lambda power: f" × 10{_superscript(power[1])}", text)


def _typeset(text: str) -> str:
    number, _, power = text.replace("-", "−").partition("e")
    return f"{number} × 10{_superscript(power)}" if power else number


def _fixed(value: float, places: int) -> str:
    text = f"{value:.{places}f}"
    if float(text) == 0:
        text = text.lstrip("-")
    return text.replace("-", "−")


def _superscript(power: object) -> str:
    return str(power).translate(str.maketrans("−-0123456789", "⁻⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))


def _ok(value: float) -> bool:
    try:
        return isfinite(value)
    except TypeError:
        return False
