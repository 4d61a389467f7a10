"""How much work fits have been: half-swings times free values, summed over all evaluations. It is the same on every machine.

A trajectory goes from turn to turn, and so many samples in between cost as much as one does.

Each thread counts its own: searches side by side do not spend one another's time.
"""

from contextvars import ContextVar

SAMPLES = 64  # that cost as much as a half-swing
_done: ContextVar[int] = ContextVar("work of fits", default=0)


def done() -> int:
    """The work of this thread's fits so far; it only grows."""
    return _done.get()


def add(evaluations: int, values: int, half_swings: float, samples: int) -> None:
    """Count evaluations of so many half-swings with so many samples, and so many free values."""
    _done.set(_done.get() + round(evaluations * values * (half_swings + samples / SAMPLES)))
