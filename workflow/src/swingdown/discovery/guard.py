"""The numbers that decide a verdict, each once (guard.yaml).

- ``PROBABLE``: the probability of an effect, or of a tie, at which it is asserted: one of twenty may be wrong. What is improbable to the
  same degree (``POSSIBLE``) is left out.
- ``SHARE``: of what the model lacks without an effect, so much may be left with it. What leaves more is not the thing that is missing.
- ``HELD_OUT``: the same of swings that no fit has seen, which know nothing of how the effect was chosen.
- ``CLEAR``: standard errors that a size must be from nothing to be tried, or a shape from what would make its effect a simpler one.
- ``TIES``: the names of a tie at most; what has more is not told apart.
"""

from importlib import resources

import yaml

from ..sealed import read_text

GUARD = yaml.safe_load(read_text(str(resources.files(__package__) / "guard.yaml")))
PROBABLE, SHARE, HELD_OUT, CLEAR, TIES = (
    GUARD[name] for name in ("probable", "share", "held_out", "clear", "ties")
)
POSSIBLE = 1 - PROBABLE
