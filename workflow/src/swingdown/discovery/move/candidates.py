"""The moves that could mend a model: add an effect, exchange one for another, drop one; and where to start each fit.

What an effect can stand in for, and with which values, stands with its entry in the catalogue.
"""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from ...arrays import Floats
from ...engine.trajectory import TrajectoryError
from ...fitting.nested import in_place_of
from ...fitting.result import Begin, Fit, SwingStart
from ...pendulum.effect import NATURAL_FREQUENCY, Parameter
from ...pendulum.model import Model
from ..see.linear import Frame, best_step, columns_of
from ..see.locate import line
from .refit import widened, with_effect

WIDEST = 30.0  # typical sizes: as far as a linear step goes
_FIRST = 0.3  # of the typical size: where an effect that cannot be nothing starts, for a lag of nothing has no slope


@dataclass(frozen=True)
class Start:
    """Where a refit begins, what was added and dropped for it, and the squares (rad^2) that a linear step predicts to gain."""

    added: str | None
    dropped: str | None
    begin: Begin
    predicted: float
    also: tuple[str, ...] = ()

    @property
    def move(self) -> str:
        """What is done to the model, in words."""
        return describe(self.added, self.dropped, self.also)


def describe(added: str | None, dropped: str | None, also: Sequence[str] = ()) -> str:
    """A move in words: add, exchange or drop; ``also`` names what is added with the first."""
    if added is None:
        return f"drop {dropped}"
    joined = " and ".join((added, *also))
    return f"add {joined}" if dropped is None else f"exchange {dropped} for {joined}"


def additions(model: Model, allowed: Collection[str] | None = None) -> list[str]:
    """The names of the effects that can be added to a model, in catalogue order; ``allowed`` limits them."""
    return [
        effect.name
        for effect in model.catalogue
        if effect.name not in model.names
        and effect.beside in ("", model.restoring)
        and (allowed is None or effect.name in allowed)
    ]


def starts_to_add(frame: Frame, name: str, best: int = 2, dropped: str | None = None) -> list[Start]:
    """The ``Start``s of adding one effect, best first: for the most promising shapes, what a linear step gives.

    The step keeps every value within the catalogue's bounds: an effect that would have to act backwards promises nothing.
    ``dropped`` names the effect whose place it takes in a frame of the model without that one. Empty where the effect, even
    with nothing of it, makes motions that the engine cannot follow.
    """
    effect, begin = frame.fit.model.catalogue[name], frame.fit.begin
    if not effect.parameters:
        return [Start(name, dropped, with_effect(begin, name, {}), 0.0)]
    sizes, shapes, phases = effect.with_role("size"), effect.with_role("shape"), effect.with_role("phase")
    sides = [{phases[0].name: phase} for phase in (0.0, np.pi / 2)] if phases else [{}]
    free = [p.name for p in sizes]
    found = []
    for shape in product(*(_starting_values(frame, parameter) for parameter in shapes)):
        values = {p.name: float(value) for p, value in zip(shapes, shape, strict=True)}
        values |= {p.name: 0.0 if p.lower <= 0 else _FIRST * p.typical for p in sizes}
        values |= {p.name: p.usual for p in effect.with_role("start")}
        try:
            columns = np.hstack([columns_of(frame, effect, values | one, free, rough=True) for one in sides])
        except TrajectoryError:
            continue
        low, high = np.full(columns.shape[1], -np.inf), np.full(columns.shape[1], np.inf)
        if not phases:
            low = np.array([max(p.lower, -WIDEST * p.typical) - values[p.name] for p in sizes])
            high = np.array([min(p.upper, WIDEST * p.typical) - values[p.name] for p in sizes])
        step = best_step(frame, columns, low, high)
        found.append((step, _stepped(step.coefficients, values, free, phases, len(frame.swings))))
    if not found:
        return []
    found.sort(key=lambda entry: -entry[0].squares)
    starts = [
        Start(name, dropped, widened(shifted(frame, step.own), name, each), step.squares)
        for step, each in found[:best]
    ]
    step, each = found[0]
    return [*starts, Start(name, dropped, widened(begin, name, each), step.squares)]


def _starting_values(frame: Frame, parameter: Parameter) -> list[float]:
    """Where a shape is looked for: at the residual's spectral line, or where the catalogue says."""
    if parameter.at_line:
        return [line(frame)[0]]
    return parameter.starting_values(frame.fit.model.values[NATURAL_FREQUENCY.name])


def _stepped(
    coefficients: Floats,
    values: Mapping[str, float],
    free: Sequence[str],
    phases: Sequence[Parameter],
    swings: int,
) -> tuple[dict[str, float], ...]:
    """The effect's values of each swing after the linear step."""
    if not phases:
        moved = {name: values[name] + float(c) for name, c in zip(free, coefficients, strict=True)}
        return ({**values, **moved},) * swings
    sine, cosine = np.split(coefficients, 2)
    size, angle = np.hypot(sine, cosine), np.arctan2(cosine, sine)
    if not phases[0].each:
        return ({**values, free[0]: float(size[0]), phases[0].name: float(angle[0])},) * swings
    mean = float(np.mean(size))
    return tuple({**values, free[0]: mean, phases[0].name: float(one)} for one in angle)


def shifted(frame: Frame, own: Floats) -> Begin:
    """What a linear step does to the values the model already has, and to the releases."""
    definitions = {definition.name: definition for definition in frame.fit.model.definitions}
    values = [dict(model.values) for model in frame.fit.models]
    angles = [swing.release_angle for swing in frame.fit.swings]
    velocities = [swing.release_velocity for swing in frame.fit.swings]
    for name, swing, change in zip(frame.names, frame.of, own, strict=True):
        if name == "release_angle":
            angles[swing] += float(change)
        elif name == "release_velocity":
            velocities[swing] += float(change)
        else:
            for one in values if swing < 0 else [values[swing]]:
                low, high = definitions[name].lower, definitions[name].upper
                one[name] = float(np.clip(one[name] + change, low, high))
    return Begin(frame.fit.model, tuple(map(SwingStart, values, angles, velocities)))


def without(fit: Fit, name: str) -> Begin:
    """Where the fit of a model without one of its effects begins: all else as in the fit."""
    own = {parameter.name for parameter in fit.model.catalogue[name].parameters}
    model = fit.model.with_effects([other for other in fit.model.names if other != name])
    swings = tuple(
        one._replace(values={k: v for k, v in one.values.items() if k not in own}) for one in fit.begin.swings
    )
    return Begin(model, swings)


def starts_to_drop(frame: Frame) -> list[Start]:
    """The ``Start``s of the model without one of its effects, for each of several."""
    model = frame.fit.model
    own = [one.name for one in model.effects if not one.takes_input]  # a drive that was measured is there
    return [Start(None, old, without(frame.fit, old), 0.0) for old in own if len(own) > 1]


def starts_to_exchange(frame: Frame, allowed: Collection[str] | None = None) -> list[Start]:
    """The ``Start``s of exchanging one effect for another that can do its work, as the catalogue says."""
    found = []
    for old in frame.fit.model.effects:
        begin = without(frame.fit, old.name)
        for new in additions(frame.fit.model, allowed):
            for values in in_place_of(frame.fit.model, old, new):
                found.append(Start(new, old.name, with_effect(begin, new, values), 0.0))
    return found
