"""A value and its uncertainty as a reader wants them: both cut at the uncertainty's last meaningful digit."""

from decimal import ROUND_HALF_EVEN, Decimal
from math import isfinite

_SMALLEST = -4  # power of ten of the larger of the two below which, and ...
_COARSEST = 2  # ... of the last digit shown above which a power of ten reads better


def value_with_uncertainty(value, uncertainty, rule="two"):
    """A text such as ``1.418(45)``: the standard uncertainty in units of the last digits.

    ``rule`` is ``two`` (two digits of the uncertainty, GUM 7.2.6) or ``pdg`` (Particle Data Group: leading digits 100-354
    two, 355-949 one, 950-999 rounded up to 1000 and two). ``value(?)`` where the uncertainty is 0 or not finite. Full
    precision belongs in files; this is for reading. ValueError for another rule.
    """
    if rule not in ("two", "pdg"):
        raise ValueError(f"unknown rule {rule!r}: two or pdg")
    if not isfinite(value):
        return str(float(value))
    if not (isfinite(uncertainty) and uncertainty > 0):
        return f"{value:.7g}(?)"
    # Decimal of a float is exact, so that a half is a half in what is stored and not in how it prints
    value, uncertainty = Decimal(float(value)), Decimal(float(uncertainty))
    exponent = uncertainty.adjusted()
    digits = 2
    if rule == "pdg":
        leading = int(uncertainty.scaleb(2 - exponent))
        if leading > 949:
            uncertainty, exponent = Decimal(1).scaleb(exponent + 1), exponent + 1
        elif leading > 354:
            digits = 1
    last = exponent - digits + 1
    rounded = _rounded(uncertainty, last)
    if rounded.adjusted() > exponent:  # 0.0996 becomes 0.100, which is again two digits too few
        last += 1
        rounded = _rounded(uncertainty, last)
    power = max(value.adjusted(), exponent) if value else exponent
    if power < _SMALLEST or last > _COARSEST:
        return f"{_told(value.scaleb(-power), rounded.scaleb(-power), last - power)}e{power}"
    return _told(value, rounded, last)


def _told(value, uncertainty, last):
    if last >= 0:
        return f"{int(_rounded(value, last))}({int(_rounded(uncertainty, last))})"
    decimals = -last
    inside = f"{uncertainty:.{decimals}f}" if uncertainty >= 1 else str(int(uncertainty.scaleb(decimals)))
    return f"{_rounded(value, last):.{decimals}f}({inside})"


def _rounded(number, last):
    step = Decimal(1).scaleb(last)
    return (number / step).to_integral_value(ROUND_HALF_EVEN) * step
