"""The study's settings: held against their schema, completed with its defaults, refused with a mend."""

from ..errors import InputError
from ..pendulum import own as own_effects
from ..pendulum.catalogue import catalogue
from ..pendulum.model import Model
from ..schema import as_said, check, near


def complete(config, where="config"):
    """A copy of ``config`` with every default filled in.

    Raises InputError, with the full name of the key and a near match where there is one, for an unknown key, a value
    of another kind or out of bounds, and a model that is not built from the catalogue's effects.
    """
    config = as_said(
        config, "config.schema.yaml", ("capture", "live", "recover", "height", "count", "session", "monitor")
    )
    settings = check(config, "config.schema.yaml", where)
    own_effects.use(settings["effects"], f"{where}, key effects")
    for number, name in enumerate(settings["discovery"]["base"], 1):
        _check_effects([name], f"{where}, key discovery.base[{number}]")
    _check_effects([settings["detection"]["effect"]], f"{where}, key detection.effect")
    for part in ("simulation", "experiment"):
        for number, label in enumerate(settings[part]["fitted"], 1):
            _check_model(label, f"{where}, key {part}.fitted[{number}]")
    return settings


def _check_model(label, place):
    names = label.split("+")
    _check_effects(names, place)
    if len(set(names)) < len(names):
        raise InputError(place, f"an effect is named twice in {label!r}", "each effect once", "remove one")
    if (ordered := Model(label).label) != label:  # the label names results, so each model must have one
        problem = f"{label!r} is not in the catalogue's order"
        raise InputError(place, problem, ordered, f"write {ordered!r}")


def _check_effects(names, place):
    for name in names:
        if name not in catalogue():
            problem = f"no effect {name!r} in the catalogue"
            raise InputError(place, problem, ", ".join(catalogue()), near(name, catalogue()))
