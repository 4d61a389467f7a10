"""Fits of a family of models, each started from the optima of the models it contains, and of those whose work it can do."""

from collections.abc import Callable, Sequence
from typing import Any, TypeVar

from ..pendulum.effect import NATURAL_FREQUENCY, Effect
from ..pendulum.formula import evaluate
from ..pendulum.model import Model

Found = TypeVar("Found")


def fit_nested(
    models: Sequence[Model],
    fit: Callable[[Model, list[Any]], Found],
    in_place: Callable[[Model, Found], Sequence[Any]] | None = None,
) -> list[Found]:
    """The fits of these models, in their order, none with a higher sum of squares than a model inside it.

    Smaller models go first, and a larger one also starts from every optimum of its sub-models.

    Parameters
    ----------
    models
        The models to fit.
    fit
        ``fit(model, guesses)`` returns the fit of one model; without guesses it starts from the decay in the data.
    in_place
        ``in_place(model, other fit)`` gives more guesses from the fits before that are not inside; None is no fit.
    """
    fits: dict[str, Found] = {}
    for model in sorted(models, key=lambda model: len(model.names)):
        known = {label: found for label, found in fits.items() if found is not None}
        inside = [found for label, found in known.items() if contains(model.label, label)]
        others = [found for label, found in known.items() if not contains(model.label, label)]
        more = [one for found in others for one in in_place(model, found)] if in_place else []
        fits[model.label] = fit(model, [*inside, *more])
    return [fits[model.label] for model in models]


def contains(label: str, other: str) -> bool:
    """True if the model ``label`` has every effect of the model ``other`` and at least one more."""
    return set(other.split("+")) < set(label.split("+"))


def unseen(model: Model) -> bool:
    """True of a model with an effect that the decay alone does not size: its entry in the catalogue says what it stands in for, and not how it damps."""
    return any(effect.replaces and not effect.damping for effect in model.effects)


def stand_ins(model: Model, other: Model) -> list[dict[str, float]]:
    """The values with which a model that is ``unseen`` does about the work of another one, which has one other effect, by parameter; none
    where the catalogue does not say how."""
    old, new = (
        [one for one in a.effects if one.name not in b.names] for a, b in ((other, model), (model, other))
    )
    if not unseen(model) or len(old) != 1 or len(new) != 1:
        return []
    kept = {name: value for name, value in other.values.items() if name in model.parameters}
    return [kept | values for values in in_place_of(other, old[0], new[0].name)]


def in_place_of(model: Model, old: Effect, new: str) -> list[dict[str, float]]:
    """Values with which the effect ``new`` does about the work of one that the model has; none where the catalogue does not say how."""
    known = {parameter.symbol: model.values[parameter.name] for parameter in old.parameters}
    known[NATURAL_FREQUENCY.symbol] = model.values[NATURAL_FREQUENCY.name]
    return [
        {name: float(evaluate(formula, **known)) for name, formula in values.items()}
        for stand_in in model.catalogue[new].replaces
        if stand_in.name == old.name
        for values in stand_in.values
    ]
