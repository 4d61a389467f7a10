"""A pendulum model: the effects it has, their values and standard errors; writing model files."""

from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import combinations
from pathlib import Path

import yaml

from ..errors import InputError
from ..paths import written_whole
from . import catalogue as effects

FORMS = ("consistent", "printed")
RESTORING = tuple(effects.GRAVITY)
_TABLE_1 = ("viscous", "quadratic_drag", "load_coulomb")
PAPER_MODELS = tuple("+".join(terms) for size in (1, 2, 3) for terms in combinations(_TABLE_1, size))


@dataclass(frozen=True)
class Model:
    """A pendulum with chosen effects: ``theta'' = gravity + the sum of its torques``, and what its sensor does.

    ``effects`` is a label such as ``viscous+load_coulomb`` or a sequence of names, kept in catalogue order.
    ``values`` and ``standard_errors`` go by parameter name, in each parameter's unit. ``restoring`` is ``sine`` or
    ``linear``; ``form`` is ``consistent`` or ``printed`` (the paper's Table 1 to the letter). An unknown effect,
    form or parameter raises InputError.
    """

    effects: tuple[str, ...]
    values: dict = field(default_factory=dict)
    standard_errors: dict = field(default_factory=dict)
    restoring: str = "sine"
    form: str = "consistent"

    def __post_init__(self):
        names = self.effects.split("+") if isinstance(self.effects, str) else list(self.effects)
        for name in names:
            effects.effect(name)
        if len(set(names)) < len(names):
            raise InputError(f"model {'+'.join(names)}", "an effect is named twice", "each effect once")
        object.__setattr__(self, "effects", tuple(sorted(names, key=list(effects.known()).index)))
        for key, value, known in (("restoring", self.restoring, RESTORING), ("form", self.form, FORMS)):
            if value not in known:
                raise InputError(f"model {self.label}, {key}", f"unknown {key} {value!r}", " or ".join(known))
        for name in (*self.values, *self.standard_errors):
            if name not in self.parameters:
                raise InputError(f"model {self.label}", f"no parameter {name!r}", ", ".join(self.parameters))

    @property
    def label(self):
        """The effects' names joined by ``+``, in catalogue order."""
        return "+".join(self.effects)

    @cached_property
    def definitions(self):
        """The definitions (``effects.Parameter``) of all parameters, the natural frequency first."""
        own = (parameter for name in self.effects for parameter in effects.known()[name].parameters)
        return (effects.NATURAL_FREQUENCY, *own)

    @cached_property
    def parameters(self):
        """The parameters' names, the natural frequency first."""
        return tuple(parameter.name for parameter in self.definitions)

    @property
    def units(self):
        """The unit of each parameter, by name."""
        return {parameter.name: parameter.unit for parameter in self.definitions}

    def with_values(self, values, standard_errors=None):
        """The same model with other values and standard errors."""
        return replace(self, values=dict(values), standard_errors=dict(standard_errors or {}))

    def vector(self):
        """The values in the order of ``parameters``; InputError names those that are missing."""
        if lost := [name for name in self.parameters if name not in self.values]:
            raise InputError(
                f"model {self.label}", f"no value for {', '.join(lost)}", "a value for each parameter"
            )
        return [float(self.values[name]) for name in self.parameters]


def symbol(label, mathtext=False):
    """The model's symbol as in the paper: ``κv,q`` for ``viscous+quadratic_drag``, in mathtext on request."""
    letters = ",".join(effects.effect(name).symbol or name.replace("_", " ") for name in label.split("+"))
    return rf"$\kappa_{{{letters}}}$".replace(" ", r"\ ") if mathtext else f"κ{letters}"


def write_model(model, path):
    """The path written: a model file (YAML) with effects, options, and value ± standard error and unit of each parameter."""
    values = {
        name: {"value": float(model.values[name]), "unit": model.units[name]}
        | ({"standard_error": float(model.standard_errors[name])} if name in model.standard_errors else {})
        for name in model.parameters
        if name in model.values
    }
    content = {
        "effects": list(model.effects),
        "restoring": model.restoring,
        "form": model.form,
        "parameters": values,
    }
    with written_whole(path) as partial:
        partial.write_text(yaml.safe_dump(content, sort_keys=False, allow_unicode=True))
    return Path(path)
