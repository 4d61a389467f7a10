"""Fits of a family of models, each started from the optima of the models it contains."""

from collections.abc import Callable, Sequence
from typing import TypeVar

from ..pendulum.model import Model

Found = TypeVar("Found")


def fit_nested(models: Sequence[Model], fit: Callable[[Model, list[Found]], Found]) -> list[Found]:
    """The fits of these models, in their order, none with a higher sum of squares than a model inside it.

    Smaller models go first, and a larger one also starts from every optimum of its sub-models.

    Parameters
    ----------
    models
        The models to fit.
    fit
        ``fit(model, guesses)`` returns the fit of one model; without guesses it starts from the decay in the data.
    """
    fits: dict[str, Found] = {}
    for model in sorted(models, key=lambda model: len(model.names)):
        inside = [found for label, found in fits.items() if contains(model.label, label)]
        fits[model.label] = fit(model, inside)
    return [fits[model.label] for model in models]


def contains(label: str, other: str) -> bool:
    """True if the model ``label`` has every effect of the model ``other`` and at least one more."""
    return set(other.split("+")) < set(label.split("+"))
