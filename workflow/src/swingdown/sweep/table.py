"""A sweep as a table: axes are keys of the config, a cell is one value of each."""

import copy
import json
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from ..errors import InputError
from ..pendulum.catalogue import catalogue
from ..pendulum.model import Model
from ..planning.settings import complete
from ..schema import near
from . import axes as written
from .measured import of_pendulum

# What each computation depends on. Any other key would be an axis along which nothing changes.
_SWING = (
    "seed", "simulation.natural_frequency", "simulation.viscous_ratio", "simulation.quadratic_coefficient",
    "simulation.load_friction", "simulation.sampling_rate_hz", "simulation.duration_s", "model.restoring", "model.form",
)  # fmt: skip
READS = {
    "identification": (
        *_SWING, "simulation.simulated", "simulation.release_angle_deg", "simulation.snr", "simulation.noise",
        "simulation.fitted", "simulation.start",
    ),
    "detection": (
        *_SWING, "detection.effect", "detection.size", "detection.release_angles_deg", "detection.noise_rad",
        "detection.noise", "detection.snr", "discovery.base", "discovery.rounds",
    ),
}  # fmt: skip
_PARAMETER = "parameters."  # what a parameter's name follows that has no key of its own in the config
_UNITS = {"deg": "degrees", "rad": "rad", "hz": "Hz", "s": "s"}
_TAKEN = ("fitted", "realization", "cell")  # names of dimensions that every result has


@dataclass(frozen=True)
class Axis:
    """One axis of a sweep: its ``key`` in the config, the name of its dimension (``dim``), its ``values``, their ``units``, and its name in words
    (``long_name``); ``coupled`` are axes of other keys, as long, that change together with it."""

    key: str
    dim: str
    values: tuple
    units: str
    long_name: str
    coupled: tuple = ()

    @property
    def coordinate(self):
        """The values as an array of numbers or of texts, for labels; of a coupled axis whose values recur, all of them as text."""
        if len({json.dumps(value) for value in self.values}) < len(self.values):
            every = zip(self.values, *(other.values for other in self.coupled), strict=True)
            return np.array([" / ".join(map(text, one)) for one in every])
        return self.labels

    @property
    def labels(self):
        """The values as an array of numbers or of texts; they may recur."""
        if all(isinstance(value, (int, float)) for value in self.values):
            return np.array(self.values)
        return np.array([text(value) for value in self.values])

    @property
    def keys(self):
        """Its key, and those of the axes coupled to it."""
        return (self.key, *(other.key for other in self.coupled))

    @property
    def steps(self):
        """The values of ``keys`` at each of its places."""
        return list(zip(self.values, *(other.values for other in self.coupled), strict=True))


@dataclass(frozen=True)
class Sweep:
    """A named table of cells: what it ``computes``, its ``axes``, and the other ``settings`` of every cell, by key.

    ``realizations`` are the draws of every cell, ``chunk`` the most draws in one job; ``format`` is ``netcdf`` or ``zarr``.
    """

    name: str
    computes: str
    axes: tuple
    settings: dict
    realizations: int
    chunk: int
    format: str = "netcdf"

    @property
    def shape(self):
        """The number of values of each axis."""
        return tuple(len(axis.values) for axis in self.axes)

    @property
    def cells(self):
        """The number of cells."""
        return int(np.prod(self.shape))

    @property
    def keys(self):
        """The axes' keys in the config, in order."""
        return tuple(key for axis in self.axes for key in axis.keys)

    def __iter__(self):
        """The values of each cell's keys, the last axis fastest."""
        for steps in product(*(axis.steps for axis in self.axes)):
            yield tuple(value for step in steps for value in step)

    def cell(self, values):
        """The complete settings of a cell, by key."""
        return self.settings | dict(zip(self.keys, values, strict=True))


def sweeps(config, where="config"):
    """The ``Sweep``s of a complete config, by name; ``where`` is what errors call it.

    InputError for an axis that is no key or that the computation does not depend on, a value that the key does not admit, and a sweep that
    leaves open which model is simulated.
    """
    base = {key: value for key, value in config.items() if key != "sweeps"}
    entries = config["sweeps"].items()
    return {name: _sweep(name, entry, base, f"{where}, key sweeps.{name}") for name, entry in entries}


def _sweep(name, entry, base, where):
    reads = READS[entry["computes"]]
    given = {**of_pendulum(entry, f"{where}.pendulum", base["effects"]), **entry["settings"]}
    asked = [key for keys in entry["axes"] for key in written.keys(keys)]
    for key in (*entry["settings"], *asked):
        _check_key(key, base, reads, entry["computes"], f"{where}.{'axes' if key in asked else 'settings'}")
    for key in entry["settings"]:
        if key in asked:
            told = f"{key!r} is an axis too", "each key once", "remove one of the two"
            raise InputError(f"{where}.settings", *told)
    axes, fixed = {}, {}
    for keys, entries in entry["axes"].items():
        place = f"{where}.axes, {keys}"
        given_steps = written.steps(keys, entries, place)
        # what holds at both ends of a range holds between them: the settings' bounds are intervals
        numbers = all(isinstance(one, float) for step in given_steps for one in step)
        within = isinstance(entries, dict) and numbers
        steps = [
            tuple(
                _plain(value, key) if within and 1 < k < len(given_steps) else _checked(base, key, value, f"{place}, value {k}")
                for key, value in zip(written.keys(keys), step, strict=True)
            )
            for k, step in enumerate(given_steps, 1)
        ]  # fmt: skip
        if len({json.dumps(step) for step in steps}) < len(steps):
            raise InputError(place, "a value is there twice", "each value once", "remove one")
        axes[written.keys(keys)] = steps
    flat = _flat(base)
    for key in (*reads, *(key for key in given if key.startswith(_PARAMETER))):
        if key not in asked:
            fixed[key] = _checked(base, key, given.get(key, flat.get(key)), f"{where}.settings, {key}")
    if base["effects"]:
        fixed["effects"] = base["effects"]  # formulas of the study's own are part of what is computed
    if entry["computes"] == "identification":
        axes = _one_simulated(axes, fixed, asked, where)
    else:
        _one_hidden(_values(axes) | {key: [value] for key, value in fixed.items()}, where)
    names = _dims([key for keys in axes for key in keys])
    made = tuple(_axis(keys, steps, names, base["effects"]) for keys, steps in axes.items())
    return Sweep(name, entry["computes"], made, fixed, entry["realizations"], entry["chunk"], entry["format"])


def _axis(keys, steps, names, own):
    each = zip(keys, zip(*steps, strict=True), strict=True)
    first, *others = [Axis(key, names[key], values, unit(key, own), _words(key)) for key, values in each]
    return replace(first, coupled=tuple(others))


def _values(axes):
    """The values of each key of the axes."""
    return {key: [step[k] for step in steps] for keys, steps in axes.items() for k, key in enumerate(keys)}


def _check_key(key, base, reads, computes, place):
    names = [f"{_PARAMETER}{name}" for name in catalogue(base["effects"]).parameters]
    if key in reads or key in names:
        return
    if key.startswith(_PARAMETER):
        raise InputError(f"{place}, {key}", "no effect has such a parameter", "a parameter of the catalogue's effects",
                         near(key, names))  # fmt: skip
    if key == "simulation.realizations":
        raise InputError(f"{place}, {key}", "the number of draws is not an axis", "the key realizations",
                         "write `realizations: 100` beside `axes`")  # fmt: skip
    if key in _flat(base):
        raise InputError(f"{place}, {key}", f"{computes} does not depend on it: nothing would change along this axis",
                         f"one of {', '.join(reads)}", "remove it")  # fmt: skip
    full = [name for name in reads if name.rpartition(".")[2] == key]
    mend = f"write {full[0]!r}" if full else near(key, reads)
    raise InputError(f"{place}, {key}", "no such key in the config", f"one of {', '.join(reads)}", mend)


def _checked(base, key, value, place):
    """The value as the config's schema takes it; a single entry where the key holds a list of names."""
    if key.startswith(_PARAMETER):
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            raise InputError(place, f"{value!r} is no number", "a number", "correct it")
        return float(value)
    # a sweep's truth is any model that could be fitted, not the paper's terms alone
    if key == "simulation.simulated":
        return _checked(base, "simulation.fitted", value, place) if value else []
    group, _, name = key.rpartition(".")
    candidate = copy.deepcopy(base)
    holder = candidate[group] if group else candidate
    if isinstance(holder.get(name), list) and not isinstance(value, list):
        value = [value]
    holder[name] = value
    try:
        complete(candidate, place)
    except InputError as error:
        raise InputError(place, error.problem, error.expected, error.mend) from None
    return _plain(value, key)


def _plain(value, key):
    """Numbers in one form, so that 20 and 20.0 are one setting."""
    if isinstance(value, list):
        return [_plain(one, key) for one in value]
    whole = key in ("seed", "discovery.rounds")
    if isinstance(value, (int, float)) and not isinstance(value, bool) and not whole:
        return float(value)
    return value


def _one_simulated(axes, fixed, asked, where):
    """The axes, the simulated model among them: several in the settings are an axis of their own, the first.

    ``fixed`` has the models' parameters added: as the settings say, else of the size that is usual.
    """
    key = "simulation.simulated"
    models = _values(axes)[key] if key in asked else [[name] for name in fixed.pop(key)]
    if not models or any(len(one) != 1 for one in models):
        mend = "write `[viscous, load_coulomb]`"
        raise InputError(f"{where}.axes, {key}", f"{models!r}", "one model a value", mend)
    if len(models) == 1 and key not in asked:
        fixed[key] = models[0]
    elif key not in asked:
        axes = {(key,): [(one,) for one in models], **axes}
    elif (key,) in axes:
        axes = {(key,): axes[key,], **axes}
    for (truth,) in models:
        for parameter in Model(truth, catalogue=catalogue(fixed.get("effects"))).definitions:
            named = f"{_PARAMETER}{parameter.name}"
            if f"simulation.{parameter.name}" not in READS["identification"] and named not in asked:
                fixed.setdefault(named, float(parameter.usual))
        for fitted in _values(axes).get("simulation.fitted", [fixed.get("simulation.fitted", [])]):
            if len(fitted) > 1 and truth not in fitted:
                raise InputError(f"{where}, simulation.fitted", f"the simulated {truth!r} is not among the models fitted",
                                 "a list with it", f"add {truth!r}")  # fmt: skip
    return axes


def _one_hidden(values, where):
    for name in values["detection.effect"]:
        for base in values["discovery.base"]:
            if name in base:
                raise InputError(f"{where}, detection.effect", f"{name!r} is in discovery.base: it is not hidden",
                                 "an effect that the base lacks", f"remove {name!r}")  # fmt: skip


def _flat(config):
    """Every key of a config with its group: ``simulation.snr``; keys that have no group stand as they are."""
    found = {}
    for key, value in config.items():
        group = isinstance(value, dict)
        found |= {f"{key}.{name}": one for name, one in value.items()} if group else {key: value}
    return found


def _dims(keys):
    """A dimension's name for each key: its last part, or the whole where that is taken."""
    last = [key.rpartition(".")[2] for key in keys]
    return {
        key: key.replace(".", "_") if short in _TAKEN or last.count(short) > 1 else short
        for key, short in zip(keys, last, strict=True)
    }


def unit(key, own=None):
    """The unit of a key's value: of a coefficient from the catalogue (``own``: the study's own effects), else as its name
    ends; empty for words."""
    name = key.rpartition(".")[2]
    known = catalogue(own).parameters
    return known[name].unit if name in known else _UNITS.get(name.rpartition("_")[2], "1")


def _words(key):
    name = key.rpartition(".")[2]
    parts = name.split("_")
    if len(parts) > 1 and parts[-1] in _UNITS:
        parts = parts[:-1]
    known = {"snr": "signal to noise ratio", "size": "what the hidden effect leaves, over the noise"}
    return known.get(name, " ".join(parts))


def text(value):
    """A value as a label: list entries joined by a comma, numbers without trailing noise."""
    if isinstance(value, (list, tuple)):
        return ", ".join(map(text, value))
    return f"{value:g}" if isinstance(value, float) else str(value)
