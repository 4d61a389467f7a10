"""A sweep as a table: axes are keys of the config, a cell is one value of each."""

import copy
import hashlib
import json
from dataclasses import dataclass
from itertools import product

import numpy as np

from ..errors import InputError
from ..pendulum.catalogue import SHIPPED
from ..schema import near
from ..study.settings import complete

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
        "discovery.base", "discovery.rounds",
    ),
}  # fmt: skip
# Settings that a swing's noise does not depend on: with other models fitted it stays the same swing.
_OF_THE_FIT = {"simulation.fitted", "simulation.start", "discovery.base", "discovery.rounds", "seed"}
_UNITS = {"deg": "degrees", "rad": "rad", "hz": "Hz", "s": "s"}
_TAKEN = ("fitted", "realization", "cell")  # names of dimensions that every result has


@dataclass(frozen=True)
class Axis:
    """One axis: its key in the config, the name of its dimension, its values, unit and name in words."""

    key: str
    dim: str
    values: tuple
    units: str
    long_name: str

    @property
    def coordinate(self):
        """The values as an array of numbers or of texts, for labels."""
        if all(isinstance(value, (int, float)) for value in self.values):
            return np.array(self.values)
        return np.array([text(value) for value in self.values])


@dataclass(frozen=True)
class Sweep:
    """A named table: what is computed, its axes, the other settings of every cell (by key), and how often each is drawn.

    ``chunk`` is the largest number of draws in one job.
    """

    name: str
    computes: str
    axes: tuple
    settings: dict
    realizations: int
    chunk: int

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
        return tuple(axis.key for axis in self.axes)

    def __iter__(self):
        """The values of each cell's axes, the last axis fastest."""
        return product(*(axis.values for axis in self.axes))

    def cell(self, values):
        """The complete settings of a cell, by key."""
        return self.settings | dict(zip(self.keys, values, strict=True))


def sweeps(config, where="config"):
    """The ``Sweep``s of a complete config, by name.

    InputError for an axis that is no key of the config or that the computation does not depend on, for a value that the
    key does not admit, and for a sweep that leaves open which model is simulated.
    """
    base = {key: value for key, value in config.items() if key != "sweeps"}
    return {
        name: _sweep(name, entry, base, f"{where}, key sweeps.{name}")
        for name, entry in config["sweeps"].items()
    }


def _sweep(name, entry, base, where):
    known, reads = list(_flat(base)), READS[entry["computes"]]
    for key in (*entry["settings"], *entry["axes"]):
        _check_key(
            key, known, reads, entry["computes"], f"{where}.{'axes' if key in entry['axes'] else 'settings'}"
        )
    for key in entry["settings"]:
        if key in entry["axes"]:
            raise InputError(
                f"{where}.settings", f"{key!r} is an axis too", "each key once", "remove one of the two"
            )
    axes, fixed = {}, {}
    for key in entry["axes"]:
        place = f"{where}.axes, {key}"
        axes[key] = [
            _checked(base, key, value, f"{place}, value {k}") for k, value in enumerate(entry["axes"][key], 1)
        ]
        if len({json.dumps(value) for value in axes[key]}) < len(axes[key]):
            raise InputError(place, "a value is there twice", "each value once", "remove one")
    for key in reads:
        if key not in axes:
            value = entry["settings"].get(key, _flat(base)[key])
            fixed[key] = _checked(base, key, value, f"{where}.settings, {key}")
    if base["effects"]:
        fixed["effects"] = base["effects"]  # formulas of the study's own are part of what is computed
    if entry["computes"] == "identification":
        _one_simulated(axes, fixed, where)
    else:
        _one_hidden(axes | {key: [value] for key, value in fixed.items()}, where)
    names = _dims(list(axes))
    made = tuple(Axis(key, names[key], tuple(values), unit(key), _words(key)) for key, values in axes.items())
    return Sweep(name, entry["computes"], made, fixed, entry["realizations"], entry["chunk"])


def _check_key(key, known, reads, computes, place):
    if key in reads:
        return
    if key == "simulation.realizations":
        raise InputError(f"{place}, {key}", "how often a cell is drawn is no axis", "the key realizations",
                         "write `realizations: 100` beside `axes`")  # fmt: skip
    if key in known:
        raise InputError(f"{place}, {key}", f"{computes} does not depend on it: nothing would change along this axis",
                         f"one of {', '.join(reads)}", "remove it")  # fmt: skip
    full = [name for name in reads if name.rpartition(".")[2] == key]
    mend = f"write {full[0]!r}" if full else near(key, reads)
    raise InputError(f"{place}, {key}", "no such key in the config", f"one of {', '.join(reads)}", mend)


def _checked(base, key, value, place):
    """The value as the config's schema takes it; a single entry where the key holds a list of names."""
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
    return (
        float(value)
        if isinstance(value, (int, float)) and not isinstance(value, bool) and not whole
        else value
    )


def _one_simulated(axes, fixed, where):
    """Each cell simulates one model: several in the settings are an axis of their own, the first."""
    for key in ("simulation.simulated",):
        models = axes.get(key) or [[name] for name in fixed.pop(key)]
        if not models or any(len(one) != 1 for one in models):
            raise InputError(
                f"{where}.axes, {key}", f"{models!r}", "one model a value", "write `[viscous, load_coulomb]`"
            )
        if len(models) == 1 and key not in axes:
            fixed[key] = models[0]
        else:
            rest = {name: axes.pop(name) for name in list(axes) if name != key}
            axes[key] = models
            axes.update(rest)
    for (truth,) in models:
        for fitted in axes.get("simulation.fitted", [fixed.get("simulation.fitted", [])]):
            if len(fitted) > 1 and truth not in fitted:
                raise InputError(f"{where}, simulation.fitted", f"the simulated {truth!r} is not among the models fitted",
                                 "a list with it", f"add {truth!r}")  # fmt: skip


def _one_hidden(values, where):
    for effect in values["detection.effect"]:
        for base in values["discovery.base"]:
            if effect in base:
                raise InputError(f"{where}, detection.effect", f"{effect!r} is in discovery.base: it is not hidden",
                                 "an effect that the base lacks", f"remove {effect!r}")  # fmt: skip


def _flat(config):
    """Every key of a config with its group: ``simulation.snr``; keys that have no group stand as they are."""
    found = {}
    for key, value in config.items():
        found |= (
            {f"{key}.{name}": one for name, one in value.items()} if isinstance(value, dict) else {key: value}
        )
    return found


def _dims(keys):
    """A dimension's name for each key: its last part, or the whole where that is taken."""
    last = [key.rpartition(".")[2] for key in keys]
    return {
        key: key.replace(".", "_") if short in _TAKEN or last.count(short) > 1 else short
        for key, short in zip(keys, last, strict=True)
    }


def unit(key):
    """The unit of a key's value: of a coefficient from the catalogue, else as its name ends; empty for words."""
    name = key.rpartition(".")[2]
    known = {one.name: one.unit for one in SHIPPED.parameters.values()}
    return known.get(name) or _UNITS.get(name.rpartition("_")[2], "1")


def _words(key):
    name = key.rpartition(".")[2]
    parts = name.split("_")
    if len(parts) > 1 and parts[-1] in _UNITS:
        parts = parts[:-1]
    return {"snr": "signal to noise ratio", "size": "what the hidden effect leaves, over the noise"}.get(
        name, " ".join(parts)
    )


def text(value):
    """A value as a label: list entries joined by a comma, numbers without trailing noise."""
    if isinstance(value, (list, tuple)):
        return ", ".join(map(text, value))
    return f"{value:g}" if isinstance(value, float) else str(value)


def cell_key(computes, settings):
    """32 hexadecimal digits that stand for all settings of a cell: what was computed under them stays valid."""
    return _digest([computes, dict(sorted(settings.items()))])


def noise_key(settings):
    """32 hexadecimal digits that stand for a swing: the settings less the seed and what is fitted to it."""
    return _digest({key: value for key, value in sorted(settings.items()) if key not in _OF_THE_FIT})


def stream(settings, key, realization):
    """The numpy Generator of one draw: of the seed, the swing (``noise_key``) and the draw's index alone.

    So a draw is the same in whatever chunk, order, process or machine it is made, and whatever else the sweep holds.
    """
    words = [int(key[k : k + 8], 16) for k in range(0, 32, 8)]
    return np.random.default_rng(np.random.SeedSequence(settings["seed"], spawn_key=(*words, realization)))


def _digest(content):
    return hashlib.sha256(json.dumps(content, separators=(",", ":")).encode()).hexdigest()[:32]
