"""The moves that could mend a model: add an effect, exchange one for another, drop one; and where to start each fit."""

from dataclasses import dataclass, field
from itertools import product

import numpy as np

from ..engine.trajectory import TrajectoryError
from ..pendulum import catalogue as effects
from .linear import best_step, columns_of, each_model
from .locate import line

# what a richer or rival description takes the place of
EXCHANGES = {
    "load_coulomb": ("constant_coulomb", "presliding"),
    "constant_coulomb": ("load_coulomb", "presliding"),
    "quadratic_drag": ("power_law_drag", "steady_wind"),
    "viscous": ("power_law_drag",),
}


@dataclass(frozen=True)
class Start:
    """Where a refit begins: the effects it has, values for each swing by name, and the squares it promises to explain.

    The releases (rad, rad/s) are those of the fit it begins from where they are empty.
    """

    added: str | None
    dropped: str | None
    effects: tuple
    values: tuple
    promise: float
    releases: tuple = field(default=())

    @property
    def move(self):
        """What is done to the model, in words."""
        return describe(self.added, self.dropped)


def describe(added, dropped):
    """A move in words: add, exchange or drop."""
    if dropped is None:
        return f"add {added}"
    return f"drop {dropped}" if added is None else f"exchange {dropped} for {added}"


def additions(model, allowed=None):
    """The names of the effects that can be added to a model, in catalogue order; ``allowed`` limits them."""
    return [
        name
        for name in effects.catalogue()
        if name not in model.effects
        and not (name == "finite_amplitude" and model.restoring == "sine")
        and (allowed is None or name in allowed)
    ]


def starts_to_add(frame, name, best=2, dropped=None):
    """The ``Start``s of adding one effect, best first: for the most promising shapes, what a linear step gives.

    The step keeps every value within the catalogue's bounds: an effect that would have to act backwards promises nothing.
    ``dropped`` names the effect whose place it takes in a frame of the model without that one. Empty where the effect, even
    with nothing of it, makes motions that the engine cannot follow.
    """
    effect = effects.effect(name)
    wider = (*frame.fit.model.effects, name)
    before = [model.values for model in each_model(frame.fit)]
    if not effect.parameters:
        return [Start(name, dropped, wider, tuple(before), 0.0)]
    amplitudes = [p for p in effect.parameters if not p.grid and not p.phase]
    phases = [p for p in effect.parameters if p.phase]
    shapes = [p for p in effect.parameters if p.grid]
    grids = [_grid(frame, parameter) for parameter in shapes]
    if any(p.own for p in phases):  # vibration: the frequency is where the residual's periodogram peaks
        shapes, grids = [p for p in effect.parameters if p.unit == "Hz"], [[line(frame)[0]]]
        amplitudes = [p for p in amplitudes if p.unit != "Hz"]
    sides = [{phases[0].name: phase} for phase in (0.0, np.pi / 2)] if phases else [{}]
    found = []
    for shape in product(*grids):
        values = {p.name: float(value) for p, value in zip(shapes, shape, strict=True)}
        values |= {
            p.name: 0.0 if p.lower <= 0 else 0.3 * p.typical for p in amplitudes
        }  # a lag of nothing has no slope
        free = [p.name for p in amplitudes]
        try:
            columns = np.hstack([columns_of(frame, effect, values | one, free) for one in sides])
        except TrajectoryError:
            continue
        low, high = np.full(columns.shape[1], -np.inf), np.full(columns.shape[1], np.inf)
        if not phases:
            low = np.array([max(p.lower, -30 * p.typical) - values[p.name] for p in amplitudes])
            high = np.array([min(p.upper, 30 * p.typical) - values[p.name] for p in amplitudes])
        step = best_step(frame, columns, low, high)
        found.append((step, _stepped(step.coefficients, values, free, phases, len(frame.swings))))
    if not found:
        return []
    found.sort(key=lambda entry: -entry[0].squares)
    starts = []
    for step, each in found[:best]:
        values, releases = _shifted(frame, step.own)
        starts.append(Start(name, dropped, wider, _joined(values, each), step.squares, releases))
    step, each = found[0]
    return [*starts, Start(name, dropped, wider, _joined(before, each), step.squares)]


def _joined(values, each):
    return tuple(one | further for one, further in zip(values, each, strict=True))


def _stepped(coefficients, values, free, phases, swings):
    """The effect's values of each swing after the linear step."""
    if not phases:
        return (
            {name: values[name] + float(c) for name, c in zip(free, coefficients, strict=True)}
            | {k: v for k, v in values.items() if k not in free},
        ) * swings
    sine, cosine = np.split(coefficients, 2)
    size, angle = np.hypot(sine, cosine), np.arctan2(cosine, sine)
    if not phases[0].own:
        return (values | {free[0]: float(size[0]), phases[0].name: float(angle[0])},) * swings
    mean = float(np.mean(size))
    return tuple(values | {free[0]: mean, phases[0].name: float(one)} for one in angle)


def _shifted(frame, own):
    """What the same linear step does to the values the model already has, and to the releases."""
    definitions = {definition.name: definition for definition in frame.fit.model.definitions}
    values = [dict(model.values) for model in each_model(frame.fit)]
    angles, velocities = list(frame.fit.release_angle), list(frame.fit.release_velocity)
    for name, swing, change in zip(frame.names, frame.of, own, strict=True):
        if name == "release_angle":
            angles[swing] += float(change)
        elif name == "release_velocity":
            velocities[swing] += float(change)
        else:
            for one in values if swing < 0 else [values[swing]]:
                low, high = definitions[name].lower, definitions[name].upper
                one[name] = float(np.clip(one[name] + change, low, high))
    return values, tuple(zip(angles, velocities, strict=True))


def _grid(frame, parameter):
    if parameter.name == "pivot_frequency":  # in proportion to the pendulum's own
        return [ratio * frame.fit.model.values["natural_frequency"] for ratio in (1.7, 2.7, 4.0, 6.5)]
    return list(parameter.grid)


def without(fit, name):
    """Effects and each swing's values of a fit's model without one effect."""
    own = {p.name for p in effects.effect(name).parameters}
    kept = tuple(other for other in fit.model.effects if other != name)
    return kept, tuple({k: v for k, v in one.values.items() if k not in own} for one in each_model(fit))


def starts_to_drop(frame):
    """The ``Start``s of the model without one of its effects, for each of several."""
    model = frame.fit.model
    if len(model.effects) < 2:
        return []
    return [Start(None, old, *without(frame.fit, old), 0.0) for old in model.effects]


def starts_to_exchange(frame, allowed=None):
    """The ``Start``s of exchanging one effect for a known rival that can do its work."""
    model, found = frame.fit.model, []
    for old in model.effects:
        kept, values = without(frame.fit, old)
        for new in EXCHANGES.get(old, ()):
            if new not in model.effects and (allowed is None or new in allowed):
                found += [
                    Start(new, old, (*kept, new), tuple(one | like for one in values), 0.0)
                    for like in _in_place_of(model, old, new)
                ]
    return found


def _in_place_of(model, old, new):
    """Values of the new effect that do about the work of the old one."""
    value = model.values[effects.effect(old).parameters[0].name]
    w = model.values["natural_frequency"]
    friction = {"load_coulomb": value * w**2, "constant_coulomb": value}.get(old)
    if new == "load_coulomb":
        return [{"load_friction": value / w**2}]
    if new == "constant_coulomb":
        return [{"constant_friction": friction}]
    if new == "presliding":
        return [
            {"presliding_friction": abs(friction) + 1e-4, "presliding_angle": angle}
            for angle in (0.001, 0.003, 0.01, 0.03)
        ]
    if new == "power_law_drag":
        exponent, scale = (1.2, 2 * value * w) if old == "viscous" else (1.8, value * w)
        return [{"power_law_coefficient": abs(scale) + 1e-4, "power_law_exponent": exponent}]
    return [{"wind_coefficient": abs(value) + 1e-4, "wind_speed": speed} for speed in (-0.3, 0.3)]
