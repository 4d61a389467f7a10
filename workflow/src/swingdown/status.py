"""The state that the search of a campaign ended in."""

from enum import StrEnum


class Status(StrEnum):
    """The status of a verdict."""

    CONSISTENT = "consistent"  # nothing was missing
    NAMED = "named"  # what is asserted stands alone, and nothing above the noise remains
    AMBIGUOUS = "ambiguous"  # the same, with a tie
    PARTIAL = "partial"  # something is asserted, and something remains or is not asserted
    UNKNOWN = "unknown"  # something is missing, and nothing is asserted
    NO_VERDICT = "no_verdict"  # nothing could be looked for


REMAINING = frozenset({Status.PARTIAL, Status.UNKNOWN})
"""Those beside which something is missing still."""
NAMING = frozenset({Status.NAMED, Status.AMBIGUOUS, Status.PARTIAL})
"""Those that assert an effect."""
