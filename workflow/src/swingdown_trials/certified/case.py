"""A published value beside ours, and in how many digits the two agree."""

import json
import math
from collections.abc import Iterator
from dataclasses import dataclass
from decimal import Decimal
from pathlib import Path
from typing import Any

from swingdown.errors import InputError

EXACT = 15  # digits that a double holds; a value that is certified exactly has no more


@dataclass(frozen=True)
class Quantity:
    """One quantity of a case: the ``certified`` value as printed, ``ours``, and where the first is from.

    ``exact``: it is certified to more digits than are printed. ``draws``: of a Monte-Carlo result, 0 of any other.
    """

    case: str
    name: str
    certified: Decimal
    ours: float
    source: str
    unit: str = "1"
    exact: bool = False
    draws: int = 0

    @property
    def stated(self) -> int:
        """The number of significant digits that the certified value has."""
        return EXACT if self.exact else len(self.certified.as_tuple().digits)

    @property
    def digits(self) -> float:
        """The digits in which ours agrees, at most those stated: NIST's log relative error (of 0 the log absolute error).

        Within half a unit of the last printed digit it is all of them.
        """
        true, off = float(self.certified), abs(self.ours - float(self.certified))
        exponent = self.certified.as_tuple().exponent
        if not math.isfinite(off):
            return 0.0
        if off == 0 or (not self.exact and isinstance(exponent, int) and off <= 0.5000001 * 10.0**exponent):
            return float(self.stated)
        return min(max(-math.log10(off / (abs(true) or 1.0)), 0.0), float(self.stated))


def values(path: Path) -> dict[str, Any]:
    """What a JSON file of certified values says, its numbers as Decimal: as many digits as are printed."""
    loaded = json.loads(text(path), parse_float=Decimal, parse_int=Decimal)
    assert isinstance(loaded, dict)
    return loaded


def text(path: Path) -> str:
    """The text of a file of certified values; InputError where it is not there."""
    try:
        return path.read_text(encoding="utf-8")
    except FileNotFoundError:
        mend = "restore resources/certified"
        raise InputError(path, "it is not there", "the project's certified values", mend) from None


def pairs(certified: list[Decimal], ours: Any) -> Iterator[tuple[Decimal, float]]:
    """Certified values and ours, one by one."""
    return zip(certified, map(float, ours), strict=True)
