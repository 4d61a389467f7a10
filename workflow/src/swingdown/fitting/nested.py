"""Fits of a family of models, each started from the optima of the models it contains."""

from collections.abc import Callable, Sequence
from typing import TypeVar

from ..pendulum.model import Model

Found = TypeVar("Found")


def fit_nested(models: Sequence[Model], fit: Callable[[Model, list[Found]], Found]) -> list[Found]:
    """The fits of these models, in their order.

    ``fit(model, guesses)`` fits one model, also of no guesses from the decay seen in the data. Smaller models go first, and a larger one is started from every
    optimum of its sub-models besides its own starts: its sum of squares cannot then end above theirs, which the paper's
    Table 3 violates (κv,q,c .13249 against κq,c .13102).
    """
    fits: dict[str, Found] = {}
    for model in sorted(models, key=lambda model: len(model.names)):
        inside = [found for label, found in fits.items() if contains(model.label, label)]
        fits[model.label] = fit(model, inside)
    return [fits[model.label] for model in models]


def contains(label: str, other: str) -> bool:
    """True if the model ``label`` has every effect of the model ``other`` and at least one more."""
    return set(other.split("+")) < set(label.split("+"))
