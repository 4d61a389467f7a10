"""Pendulum swings: calibration, trajectories, fits of damping models, and what the fits leave unexplained.

Plain functions on arrays and datasets; nothing here knows of the workflow that calls it. ``swingdown.fit`` and
``swingdown.explain`` go from arrays to an answer in one call.
"""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .answer import Answer, explain, fit

__all__ = ["Answer", "explain", "fit"]


def __getattr__(name: str) -> Any:
    """What a call needs is loaded at the first one: it takes some seconds, and most jobs need a part of it."""
    if name in __all__:
        from . import answer

        return getattr(answer, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted([*globals(), *__all__])
