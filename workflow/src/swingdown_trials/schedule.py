"""Which trials are drawn: every effect at every size, pairs, foreign effects, effects taken out of the catalogue, and nulls, also of
pendulums that were taken down between the swings (``own``) or whose sensor was calibrated (``calibrated``)."""

from collections.abc import Mapping
from typing import Any

from swingdown.pendulum.catalogue import SHIPPED, Catalogue

from .torques import FOREIGN
from .trial import NOISES, PAIRS, USUAL, Design, Planned, Trial, check_known, draw, hideable

_TRIES = 4  # draws of one kind, before it is left out because no size within reason leaves such a residual
_AT_ONCE = 2.0  # ratio of residual to noise of each of a pair, and of effects taken out of the catalogue


def planned(settings: Mapping[str, Any], catalogue: Catalogue = SHIPPED) -> list[Planned]:
    """The list of ``Planned`` trials of the settings' group ``hidden_effects``, in a fixed order.

    InputError for an effect that the second pendulum does not know: none is left out in silence.
    """
    found: list[Planned] = []
    sizes, repeats = settings["sizes"], settings["repeats"]
    names = settings["effects"] or hideable(catalogue)
    check_known(names, catalogue)

    def add(kind, hidden, ratio, number):
        found.append(Planned(kind, hidden, float(ratio), NOISES[len(found) % len(NOISES)], _TRIES * number))

    for number in range(repeats):
        for ratio in sizes:
            for name in names:
                add("single", (name,), ratio, number)
        for name in names if settings["removed"] else ():
            add("removed", (name,), _AT_ONCE, number)
        for pair in PAIRS if settings["pairs"] else ():
            add("pair", pair, _AT_ONCE, number)
        for name in FOREIGN if settings["foreign"] else ():
            for ratio in sizes:
                add("foreign", (name,), ratio, number)
    for number in range(settings["nulls"]):
        add("null", (), 1.0, number)
    for number in range(settings["own_frequencies"]):
        add("own", (), 1.0, number)
    for number in range(settings["calibrated"]):
        add("calibrated", (), 1.0, number)
    return found


def chunks(settings: Mapping[str, Any], catalogue: Catalogue = SHIPPED) -> dict[str, list[Planned]]:
    """The planned trials by the name of the chunk that holds them: chunks are computed together, and not shared out anew when more are planned."""
    trials, length = planned(settings, catalogue), settings["chunk"]
    return {f"{k:04d}": trials[k * length : (k + 1) * length] for k in range(-(-len(trials) // length))}


def drawn(seed: int, one: Planned, catalogue: Catalogue = SHIPPED, design: Design = USUAL) -> Trial | None:
    """The ``Trial`` of a ``Planned`` one, or None where no size within reason leaves the residual that is asked for."""
    for k in range(_TRIES):
        try:
            return draw(seed, one._replace(number=one.number + k), catalogue, design)
        except ArithmeticError:
            continue
    return None
