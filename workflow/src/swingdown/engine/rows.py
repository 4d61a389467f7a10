"""The order of the compiled table of effects, which both the generator and its callers go by."""

from collections.abc import Iterable

from ..pendulum.effect import Effect


def entries(catalogue: Iterable[Effect], gravity: Iterable[Effect]) -> list[tuple[Effect, str]]:
    """The (effect, form) of each row: the gravities, then each effect in each form it has."""
    rows = [(effect, "consistent") for effect in gravity]
    for effect in catalogue:
        rows.append((effect, "consistent"))
        if effect.printed:
            rows.append((effect, "printed"))
    return rows
