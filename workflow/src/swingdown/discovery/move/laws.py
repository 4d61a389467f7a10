"""Each everyday law of damping in the place of a structure's own: what a pendulum's values are told from."""

from collections.abc import Collection, Iterator
from contextlib import suppress

from ...engine.trajectory import TrajectoryError
from ...fitting.result import Begin, Fit
from ...pendulum.model import Model, everyday
from ..budget import Budget
from ..data.campaign import Campaign
from ..data.noise import Noise
from .admissible import hopeless, within
from .refit import refit_by_the_widest


def damping(model: Model) -> frozenset[str]:
    """The names of the effects that the everyday laws are made of."""
    return frozenset(name for law in everyday(model.restoring) for name in law.split("+"))


def with_each_law(
    fit: Fit, campaign: Campaign, noise: Noise, budget: Budget, allowed: Collection[str] | None = None
) -> Iterator[Fit]:
    """The ``Fit`` of each law beside what else a fit has, the fit's own law and hopeless ones left out, and those of effects that are not
    ``allowed`` (all of the catalogue by default).

    A law at a bound is another law, whose values are better known: it is left out.
    """
    model = fit.model
    enough = hopeless(fit, campaign.fit, noise)
    others = [name for name in model.names if name not in damping(model)]
    for law in everyday(model.restoring):
        names = law.split("+")
        one = model.with_effects((*names, *others))
        known = allowed is None or set(names) <= {*allowed, *model.names}
        if budget.spent or one.names == model.names or not known:
            continue
        starts = tuple(
            swing._replace(values={name: swing.values.get(name, 0.0) for name in one.parameters})
            for swing in fit.begin.swings
        )
        with suppress(TrajectoryError):
            found = refit_by_the_widest(Begin(one, starts), campaign.fit, enough)
            if found is not None and all(within(found, name) for name in names):
                yield found
