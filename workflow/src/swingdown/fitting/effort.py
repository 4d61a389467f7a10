"""How much work fits have been: samples times free values, summed over all evaluations. It is the same on every machine.

Each thread counts its own: searches side by side do not spend one another's time.
"""

from contextvars import ContextVar

_done: ContextVar[int] = ContextVar("work of fits", default=0)


def done() -> int:
    """The work of this thread's fits so far; it only grows."""
    return _done.get()


def add(work: int) -> None:
    """Count more work."""
    _done.set(_done.get() + work)
