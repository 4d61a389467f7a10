"""How much work the fits of this process have been: samples times free values, summed over all evaluations. It is the same on every machine."""

_done = 0


def done() -> int:
    """The work so far; it only grows."""
    return _done


def add(work: int) -> None:
    """Count more work."""
    global _done
    _done += work
