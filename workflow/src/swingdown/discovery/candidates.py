"""The moves that could mend a model: add an effect, exchange one for another, drop one; and where to start each fit."""

from dataclasses import dataclass
from itertools import product

import numpy as np

from .. import effects
from ..model import Model
from .linear import columns_of, each_model, explained
from .locate import line

# what a richer or rival description takes the place of
EXCHANGES = {
    "load_coulomb": ("constant_coulomb", "presliding"),
    "constant_coulomb": ("load_coulomb", "presliding"),
    "quadratic_drag": ("power_law_drag", "steady_wind"),
    "viscous": ("power_law_drag",),
}
# to no order do these differ from the named effects' own terms
EXCLUDED = {
    "finite_amplitude": "sine",  # only where the restoring torque is linear
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
    release_angle: tuple = ()
    release_velocity: tuple = ()

    @property
    def move(self):
        """What is done to the model, in words."""
        if self.dropped is None:
            return f"add {self.added}"
        return f"drop {self.dropped}" if self.added is None else f"exchange {self.dropped} for {self.added}"


def additions(model):
    """The names of the catalogue's effects that can be added to a model, in catalogue order."""
    return [
        name
        for name in effects.CATALOGUE
        if name not in model.effects and not (name == "finite_amplitude" and model.restoring == "sine")
    ]


def starts_to_add(frame, name, best=2):
    """The ``Start``s of adding one effect: for the most promising shapes, the amplitudes that a linear step gives."""
    effect = effects.effect(name)
    amplitudes = [p for p in effect.parameters if not p.grid and not p.phase]
    phases = [p for p in effect.parameters if p.phase]
    shapes = [p for p in effect.parameters if p.grid]
    grids = [_grid(frame, parameter) for parameter in shapes]
    if any(p.own for p in phases):  # vibration: the frequency is where the residual's periodogram peaks
        shapes, grids = [p for p in effect.parameters if p.unit == "Hz"], [[line(frame)[0]]]
        amplitudes = [p for p in amplitudes if p.unit != "Hz"]
    found = []
    for shape in product(*grids):
        values = {p.name: float(value) for p, value in zip(shapes, shape, strict=True)}
        values |= {p.name: 0.0 if np.isinf(p.lower) or p.lower <= 0 else p.lower for p in amplitudes}
        free = [p.name for p in amplitudes]
        if phases:
            pieces = [columns_of(frame, effect, values | {phases[0].name: phase}, free) for phase in (0.0, np.pi / 2)]
            columns = np.hstack(pieces)
            squares, _, coefficients = explained(frame, columns)
            sine, cosine = np.split(coefficients, 2)
            size, angle = np.hypot(sine, cosine), np.arctan2(cosine, sine)
            each = _spread(frame, size, angle, free[0], phases[0], values)
        elif not free:
            columns, coefficients = np.zeros((frame.residual.size, 0)), np.zeros(0)
            squares, each = 0.0, ({},) * len(frame.swings)
        else:
            columns = columns_of(frame, effect, values, free)
            squares, _, coefficients = explained(frame, columns)
            moved = {p.name: _within(p, values[p.name] + c) for p, c in zip(amplitudes, coefficients, strict=True)}
            each = (values | moved,) * len(frame.swings)
        found.append((squares, each, columns, coefficients))
    found.sort(key=lambda entry: -entry[0])
    wider = (*frame.fit.model.effects, name)
    starts = []
    for squares, each, columns, coefficients in found[:best]:
        values, angles, velocities = _shifted(frame, columns, coefficients)
        starts.append(Start(name, None, wider, _joined(values, each), squares, angles, velocities))
    squares, each, *_ = found[0]
    return [*starts, Start(name, None, wider, _joined([model.values for model in each_model(frame.fit)], each), squares)]


def _joined(values, each):
    return tuple(one | further for one, further in zip(values, each, strict=True))


def _shifted(frame, columns, coefficients):
    """What the same linear step does to the values the model already has, and to the releases."""
    rest = frame.residual - columns @ coefficients
    step = np.linalg.lstsq(frame.slopes / frame.scale, rest, rcond=1e-9)[0] / frame.scale
    definitions = {definition.name: definition for definition in frame.fit.model.definitions}
    values = [dict(model.values) for model in each_model(frame.fit)]
    angles, velocities = list(frame.fit.release_angle), list(frame.fit.release_velocity)
    for name, swing, change in zip(frame.names, frame.of, step, strict=True):
        if name == "release_angle":
            angles[swing] += float(change)
        elif name == "release_velocity":
            velocities[swing] += float(change)
        else:
            for one in values if swing < 0 else [values[swing]]:
                low, high = definitions[name].lower, definitions[name].upper
                one[name] = float(np.clip(one[name] + change, low, high))
    return values, tuple(angles), tuple(velocities)


def _within(parameter, value):
    """The linear step's value, kept where a fit can begin: inside the bounds and not far beyond the usual size."""
    most = 30 * parameter.typical
    return float(np.clip(value, max(parameter.lower, -most), min(parameter.upper, most)))


def _grid(frame, parameter):
    if parameter.name == "pivot_frequency":  # in proportion to the pendulum's own
        return [ratio * frame.fit.model.values["natural_frequency"] for ratio in (1.7, 2.7, 4.0, 6.5)]
    return list(parameter.grid)


def _spread(frame, size, angle, amplitude, phase, values):
    if not phase.own:
        return (values | {amplitude: float(size[0]), phase.name: float(angle[0])},) * len(frame.swings)
    mean = float(np.mean(size))
    return tuple(values | {amplitude: mean, phase.name: float(one)} for one in angle)


def starts_to_exchange(frame):
    """The ``Start``s of exchanging one effect for another that does its work, and of dropping one."""
    model, found = frame.fit.model, []
    for old in model.effects:
        kept = tuple(name for name in model.effects if name != old)
        own = {p.name for p in effects.effect(old).parameters}
        without = tuple({k: v for k, v in one.values.items() if k not in own} for one in each_model(frame.fit))
        if kept:
            found.append(Start(None, old, kept, without, 0.0))
        for new in EXCHANGES.get(old, ()):
            if new in model.effects:
                continue
            for values in _in_place_of(model, old, new):
                found.append(Start(new, old, (*kept, new), tuple(one | values for one in without), 0.0))
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
        return [{"presliding_friction": abs(friction) + 1e-4, "presliding_angle": angle} for angle in (0.001, 0.003, 0.01, 0.03)]
    if new == "power_law_drag":
        exponent, scale = (1.2, 2 * value * w) if old == "viscous" else (1.8, value * w)
        return [{"power_law_coefficient": abs(scale) + 1e-4, "power_law_exponent": exponent}]
    return [{"wind_coefficient": abs(value) + 1e-4, "wind_speed": speed} for speed in (-0.3, 0.3)]


def model_of(start, like):
    """The model a start describes, with the options of the model it is like, and its first swing's values."""
    model = Model(start.effects, restoring=like.restoring, form=like.form)
    return model.with_values({name: start.values[0][name] for name in model.parameters})
