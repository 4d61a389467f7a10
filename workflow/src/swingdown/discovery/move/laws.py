"""Each everyday law of damping in the place of a structure's own: what a pendulum's values are told from."""

from collections.abc import Collection, Iterator, Mapping
from contextlib import suppress
from itertools import product

import numpy as np

from ...arrays import Floats
from ...engine.trajectory import TrajectoryError
from ...fitting.result import Begin, Fit
from ...pendulum.effect import NATURAL_FREQUENCY, Effect
from ...pendulum.model import Model, everyday
from ..budget import Budget
from ..data.campaign import Campaign
from ..data.noise import Noise
from ..see.linear import Frame, best_step, columns_of, frame
from .admissible import hopeless, within
from .candidates import shifted
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
    model, swings = fit.model, campaign.fit
    enough, here = hopeless(fit, swings, noise), frame(fit, swings)
    others = [name for name in model.names if name not in damping(model)]
    for law in everyday(model.restoring):
        names = law.split("+")
        one = model.with_effects((*names, *others))
        known = allowed is None or set(names) <= {*allowed, *model.names}
        if budget.spent or one.names == model.names or not known:
            continue
        with suppress(TrajectoryError):
            found = refit_by_the_widest(_begin(here, one), swings, enough, grown=False)
            if found is not None and all(within(found, name) for name in names):
                yield found


def _begin(here: Frame, to: Model) -> Begin:
    """Where the fit of a model begins that has other laws than that of a frame: what a linear step gives, of the shapes that it starts from the
    one that explains most."""
    model = here.fit.model
    there = here.without([name for name in model.names if name not in to.names])
    new = [to.catalogue[name] for name in to.names if name not in model.names]
    sizes = [one for effect in new for one in effect.with_role("size")]
    shapes = [one for effect in new for one in effect.with_role("shape")]
    found = []
    for shape in product(*(one.starting_values(model.values[NATURAL_FREQUENCY.name]) for one in shapes)):
        values = {one.name: float(value) for one, value in zip(shapes, shape, strict=True)}
        try:
            columns = np.hstack([np.zeros((here.samples, 0)), *(_columns(there, one, values) for one in new)])
        except TrajectoryError:
            continue
        low, high = np.array([(one.lower, one.upper) for one in sizes]).reshape(-1, 2).T
        step = best_step(there, columns, low, high)
        found.append(
            (
                step,
                values | dict(zip((one.name for one in sizes), map(float, step.coefficients), strict=True)),
            )
        )
    if not found:
        raise TrajectoryError(f"{to.label}: no step leads there")
    step, values = max(found, key=lambda one: one[0].squares)
    swings = shifted(there, step.own).swings
    return Begin(
        to,
        tuple(
            one._replace(values={name: {**one.values, **values}[name] for name in to.parameters})
            for one in swings
        ),
    )


def _columns(there: Frame, effect: Effect, shapes: Mapping[str, float]) -> Floats:
    sizes = [one.name for one in effect.with_role("size")]
    values = {one.name: shapes.get(one.name, 0.0) for one in effect.parameters}
    return columns_of(there, effect, values, sizes, rough=True)
