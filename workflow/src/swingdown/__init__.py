"""Pendulum swings: calibration, trajectories, fits of damping models, and what the fits leave unexplained.

Plain functions on arrays and datasets; nothing here knows of the workflow that calls it. ``swingdown.read`` takes a file;
``swingdown.fit`` and ``swingdown.explain`` go from it, or from arrays, to an answer in one call, and ``swingdown.simulate`` from a
model to its swing.
"""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .answer import Answer, Quantity, Recording, explain, fit, read, simulate
    from .errors import InputError
    from .pendulum.model import Model

__all__ = ["Answer", "InputError", "Model", "Quantity", "Recording", "explain", "fit", "read", "simulate"]
_ELSEWHERE = {"InputError": "errors", "Model": "pendulum.model"}


def __getattr__(name: str) -> Any:
    """What a call needs is loaded at the first one: it takes some seconds, and most jobs need a part of it."""
    if name in __all__:
        from importlib import import_module

        return getattr(import_module(f".{_ELSEWHERE.get(name, 'answer')}", __name__), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted([*globals(), *__all__])
