"""A value and its uncertainty as a reader wants them: both cut at the uncertainty's last meaningful digit.

Whatever shows a value with its uncertainty asks here; full precision belongs in files.
"""

from decimal import ROUND_HALF_EVEN, Decimal
from math import isfinite, nan

RULES = ("two", "one", "limit")
SURE = 0.999  # probability above which one says no more
_SMALLEST = -4  # power of ten of the larger of the two below which, and ...
_LONG = 4  # power of ten of an uncertainty from which on digits before the point are rounded away
_COARSEST = 2  # ... of the last digit shown above which a power of ten reads better


def again(times: int) -> str:
    """How often something happened besides, to follow what says when it did; empty where it did not."""
    return "" if times == 0 else " and once more" if times == 1 else f" and {times} times more"


def moment(time: float, digits: int = 6) -> str:
    """A time (s) as a message has it and an option takes it: to so many digits, of a clock that counts since 1970 to a millisecond."""
    if abs(time) < 10.0 ** (digits - 1):
        return f"{time:.{digits}g}"
    return f"{time:.3f}".rstrip("0").rstrip(".")


def value_with_uncertainty(value: float, uncertainty: float, known: float = nan) -> str:
    """A text such as ``1.418(45)``: the standard uncertainty, with two digits (GUM 7.2.6), in units of the last digits.

    Parameters
    ----------
    value, uncertainty
        In one unit. An uncertainty that is not above 0 gives ``value(?)``.
    known
        The part that is known of an uncertainty that is not: the value is cut at its first digit.
    """
    parts = _cut(value, uncertainty, "two")
    number, error, last, power = parts or _cut(value, known, "one") or (None, None, 0, 0)
    if number is None or error is None:
        return _unknown(value, "(?)")
    if parts is None:
        return f"{number:.{max(-last, 0)}f}(?)" + _power(power)
    if last >= 0:
        return f"{int(number)}({int(error)})" + _power(power)
    inside = f"{error:.{-last}f}" if error >= 1 else str(int(error.scaleb(-last)))
    return f"{number:.{-last}f}({inside})" + _power(power)


def plus_minus(value: float, uncertainty: float, rule: str = "two") -> str:
    """A text such as ``1.418 ± 0.045``, or ``(1.20 ± 0.34)e-7``: both numbers with the same decimals.

    Parameters
    ----------
    value, uncertainty
        As of ``value_with_uncertainty``. Digits before the point are rounded away of uncertainties of five digits or more.
    rule
        Digits of the uncertainty: ``two``, ``one`` or ``limit`` (two, or one where the second is a zero).

    Raises
    ------
    ValueError
        For another rule.
    """
    if (parts := _cut(value, uncertainty, rule, coarsest=0)) is None:
        return _unknown(value, " ± ?")
    number, error, last, power = parts
    text = f"{number:.{max(-last, 0)}f} ± {error:.{max(-last, 0)}f}"
    return f"({text}){_power(power)}" if power else text


def probability(chance: float) -> str:
    """A probability as one says it: ``0.953``, and ``> 0.999`` above that."""
    return "> 0.999" if chance > SURE else f"{chance:.3f}"


def _cut(
    value: float, uncertainty: float, rule: str, coarsest: int | None = None
) -> tuple[Decimal, Decimal, int, int] | None:
    """Value and uncertainty at the last digit shown, in units of a power of ten; that digit's power and this one.

    None where there is nothing to cut at. ``coarsest`` is the power that the last digit shown does not exceed; then
    only small numbers are told with a power of ten, and those as uncertain as 10 000.
    """
    if rule not in RULES:
        raise ValueError(f"unknown rule {rule!r}: {', '.join(RULES)}")
    if not (isfinite(value) and isfinite(uncertainty) and uncertainty > 0):
        return None
    # Decimal of a float is exact, so that a half is a half in what is stored and not in how it prints
    number, error = Decimal(float(value)), Decimal(float(uncertainty))
    last = _last_digit(error, rule)
    size = max(number, error, key=abs).adjusted()
    power, long = 0, error.adjusted() >= _LONG
    if size < _SMALLEST or long or (coarsest is None and last > _COARSEST):
        power = size
    if coarsest is not None and not long:
        last = min(last, coarsest + power)
    number, error = (_rounded(part, last).scaleb(-power) for part in (number, error))
    return abs(number) if number == 0 else number, error, last - power, power


def _last_digit(error: Decimal, rule: str) -> int:
    """The power of ten of the last digit shown of an uncertainty."""
    exponent, digits = error.adjusted(), 1 if rule == "one" else 2
    last = exponent - digits + 1
    rounded = _rounded(error, last)
    if rounded.adjusted() > exponent:  # 0.0996 becomes 0.100, which is again two digits too few
        last += 1
    if rule == "limit" and last < 0 and _rounded(rounded, last + 1) == rounded:
        last += 1
    return last


def _rounded(number: Decimal, last: int) -> Decimal:
    step = Decimal(1).scaleb(last)
    return (number / step).to_integral_value(ROUND_HALF_EVEN) * step


def _power(power: int) -> str:
    return f"e{power}" if power else ""


def _unknown(value: float, mark: str) -> str:
    return f"{value:.7g}{mark}" if isfinite(value) else str(float(value))
