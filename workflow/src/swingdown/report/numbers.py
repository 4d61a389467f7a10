"""Numbers as a reader wants them: as many digits as the uncertainty bears, a true minus, nothing for not-a-number."""

from math import floor, isfinite, log10

from ..studies.rounding import value_with_uncertainty

DIGITS = 2  # of an uncertainty


def spread(value, deviation):
    """``0.131 ± 0.010``: the deviation with two significant digits, the value to the same decimal."""
    if not _ok(value):
        return "–"
    if not _ok(deviation) or deviation <= 0:
        return plain(value)
    places = _places(deviation)
    return f"{_fixed(value, places)} ± {_fixed(deviation, places)}"


def brief(value, uncertainty):
    """``0.0512(13)``: the uncertainty in units of the last digits of the value; powers of ten where they help."""
    if not _ok(value):
        return "–"
    if not _ok(uncertainty) or uncertainty <= 0:
        return plain(value)
    number, _, power = value_with_uncertainty(value, uncertainty).replace("-", "−").partition("e")
    return f"{number} × 10{_superscript(power)}" if power else number


def plain(value, digits=3):
    """A number with so many significant digits, without trailing noise; a power of ten if very large or small."""
    if not _ok(value):
        return "–"
    if value == 0:
        return "0"
    power = floor(log10(abs(value)))
    if -4 <= power < 6:
        return _fixed(value, max(digits - 1 - power, 0))
    return f"{_fixed(value / 10.0**power, digits - 1)} × 10{_superscript(power)}"


def whole(value):
    """A number without decimals."""
    return _fixed(value, 0) if _ok(value) else "–"


def _places(uncertainty):
    """Decimals that show two significant digits; 0.0995 rounds up to 0.10, which has them one decimal earlier."""
    places = DIGITS - 1 - floor(log10(uncertainty))
    if round(uncertainty, places) >= 10.0 ** (DIGITS - places):
        places -= 1
    return max(places, 0)


def _fixed(value, places):
    text = f"{value:.{places}f}"
    if float(text) == 0:
        text = text.lstrip("-")
    return text.replace("-", "−")


def _superscript(power):
    return str(power).translate(str.maketrans("−-0123456789", "⁻⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))


def _ok(value):
    try:
        return isfinite(value)
    except TypeError:
        return False
