"""What decides a verdict: its numbers, each once (guard.yaml), and the doubts that they leave.

- ``PROBABLE``: the probability of an effect, or of a tie, at which it is asserted: one of twenty may be wrong. What is improbable to the
  same degree (``POSSIBLE``) is left out.
- ``SHARE``: of what the model lacks without an effect, so much may be left with it. What leaves more is not the thing that is missing.
- ``HELD_OUT``: the same of swings that no fit has seen, which know nothing of how the effect was chosen.
- ``CLEAR``: standard errors that a size must be from nothing to be tried, or a shape from what would make its effect a simpler one.
- ``TIES``: the names of a tie at most; what has more is not told apart.
"""

from enum import StrEnum
from importlib import resources

import numpy as np
import yaml

from ..sealed import read_text

GUARD = yaml.safe_load(read_text(str(resources.files(__package__) / "guard.yaml")))
PROBABLE, SHARE, HELD_OUT, CLEAR, TIES = (
    GUARD[name] for name in ("probable", "share", "held_out", "clear", "ties")
)
POSSIBLE = 1 - PROBABLE


class Doubt(StrEnum):
    """Why an effect is not told, in words."""

    NO_MODEL = "no model without it can be fitted"
    IMPROBABLE = "its probability is only {probability:.2f}"
    IDLE = "without it nothing is missing"
    REMAINS = "{share:.0%} of what is missing remains with it"
    NOT_ASKED = "swings that were held out leave too little without it to confirm it"
    NOT_CONFIRMED = "swings that were held out do not confirm it"
    OF_UNIT = "another unit would explain it as well"
    OF_MOTOR = "it does not die away"
    TOO_SLOW = "{parameter} is less than one in the longest recording"


def doubt(probability: float, share: float, held_out: float) -> Doubt | None:
    """The ``Doubt`` of an effect of that probability, with which such shares are left; None where it is told."""
    doubts = {
        Doubt.IMPROBABLE: probability < PROBABLE,
        Doubt.IDLE: np.isinf(share),
        Doubt.REMAINS: share > SHARE,
        Doubt.NOT_ASKED: np.isinf(held_out),
        Doubt.NOT_CONFIRMED: held_out > HELD_OUT,
    }
    return next((one for one, there in doubts.items() if there), None)


def over_bounds(shares: tuple[float, float]) -> float:
    """What the larger of (share, the same of held-out swings) is, each of the most that may be left: above one an effect leaves too much to
    be the thing that is missing."""
    return max(shares[0] / SHARE, shares[1] / HELD_OUT)
