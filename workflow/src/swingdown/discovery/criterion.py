"""What decides a verdict: its numbers, each once (criterion.yaml), the ``Criterion`` that they make, and the doubts that it leaves.

``CLEAR`` is of estimates: standard errors that a size must be from nothing to be tried, or a shape from what would make its effect a simpler one.
"""

from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import Any

import numpy as np

from ..own_yaml import read_own

GUARD: dict[str, Any] = read_own(Path(__file__).with_name("criterion.yaml"))
CLEAR: float = GUARD["clear"]


class Doubt(StrEnum):
    """Why an effect is not told, in words."""

    NO_MODEL = "no model without it can be fitted"
    IMPROBABLE = "its probability is only {probability:.2f}"
    AS_WELL = "its probability is only {probability:.2f}: something that has no name may do as well"
    IDLE = "without it nothing is missing"
    REMAINS = "{share:.0%} of what is missing remains with it"
    NOT_ASKED = "swings that were held out leave too little without it to confirm it"
    NOT_CONFIRMED = "swings that were held out do not confirm it"
    OF_UNIT = "another unit would explain it as well"
    OF_MOTOR = "it does not die away"
    TOO_SLOW = "{parameter} is less than one in the longest recording"


@dataclass(frozen=True)
class Criterion:
    """What an effect must be to be told: ``discover`` takes another one as well.

    Parameters
    ----------
    probable
        The probability of an effect, or of a tie, at which it is asserted: of 0.95 one of twenty may be wrong.
    share
        Of what the model lacks without an effect, so much may be left with it. What leaves more is not the thing that is missing.
    held_out
        The same of swings that no fit has seen, which know nothing of how the effect was chosen.
    ties
        The names of a tie at most; what has more is not told apart.
    """

    probable: float = GUARD["probable"]
    share: float = GUARD["share"]
    held_out: float = GUARD["held_out"]
    ties: int = GUARD["ties"]

    @property
    def possible(self) -> float:
        """The probability below which anything is improbable, and left out."""
        return 1 - self.probable

    def doubt(self, probability: float, share: float, held_out: float) -> Doubt | None:
        """The ``Doubt`` of an effect of that probability, with which such shares are left; None where it is told."""
        doubts = {
            Doubt.IMPROBABLE: probability < self.probable,
            Doubt.IDLE: np.isinf(share),
            Doubt.REMAINS: share > self.share,
            Doubt.NOT_ASKED: np.isinf(held_out),
            Doubt.NOT_CONFIRMED: held_out > self.held_out,
        }
        return next((one for one, there in doubts.items() if there), None)

    def over_bounds(self, shares: tuple[float, float]) -> float:
        """What the larger of (share, the same of held-out swings) is, each of the most that may be left: above one an effect leaves too much to
        be the thing that is missing."""
        return max(shares[0] / self.share, shares[1] / self.held_out)


USUAL = Criterion()
"""The ``Criterion`` of criterion.yaml, with which the trials were made."""
