"""The study's settings: held against their schema, completed with its defaults, refused with a mend."""

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from ..errors import InputError
from ..pendulum.catalogue import Catalogue, catalogue
from ..pendulum.model import BASES
from ..schema import as_said, check, filled, near, read_yaml

CONFIGS = (".yaml", ".yml")
_SCHEMA = "config.schema.yaml"


def check_config(path: Path) -> None:
    """None for a config file that holds settings; InputError with the line for one that cannot be read as YAML."""
    if not path.is_file():
        there = [one.name for one in path.parent.glob("*") if one.suffix in CONFIGS]
        raise InputError(
            path, "there is no such config file", f"a YAML file, in {Path.cwd()} or given by its whole path",
            near(path.name, there) if there else "correct the path",
        )  # fmt: skip
    if path.suffix == ".json":
        return  # which Snakemake reads, with tabs, that YAML does not know
    content = read_yaml(path, path)
    if not isinstance(content, dict):
        raise InputError(path, "it holds no settings", "keys such as `recordings: sheet.csv`", "name the config, not another file")  # fmt: skip


def complete(config: Mapping[str, Any], where: str = "config") -> dict[str, Any]:
    """A copy of ``config`` with every default filled in.

    Raises InputError, with the full name of the key and a near match where there is one, for an unknown key, a value
    of another kind or out of bounds, and a model that is not built from the catalogue's effects and the study's own.
    """
    keys = ("capture", "live", "recover", "recompute", "height", "count", "session", "monitor")
    config = as_said(config, _SCHEMA, keys)
    settings = with_defaults(check(config, _SCHEMA, where))
    _check_size(settings["simulation"], f"{where}, key simulation")
    known = catalogue(settings["effects"], f"{where}, key effects")
    for part, key in (("discovery", "base"), ("hidden_effects", "effects")):
        for number, name in enumerate(settings[part][key], 1):
            _check_effects([name], known, f"{where}, key {part}.{key}[{number}]")
    _check_effects([settings["detection"]["effect"]], known, f"{where}, key detection.effect")
    for part in ("simulation", "experiment"):
        for number, label in enumerate(settings[part]["fitted"], 1):
            _check_model(label, known, f"{where}, key {part}.fitted[{number}]")
    return settings


def with_defaults(config: Mapping[str, Any]) -> dict[str, Any]:
    """A copy of ``config`` with every default filled in, of which nothing is checked."""
    settings = filled(dict(config), _SCHEMA)
    settings["discovery"].setdefault("base", list(BASES[settings["model"]["restoring"]]))
    return settings


_MOST_SAMPLES = 50_000_000  # of all noisy copies of one simulated swing; they are held at once, at 8 bytes


def _check_size(simulation: Mapping[str, Any], place: str) -> None:
    """InputError for simulations that no machine holds, with what they would take."""
    samples = simulation["sampling_rate_hz"] * simulation["duration_s"]
    whole = samples * simulation["realizations"]
    if whole > _MOST_SAMPLES:
        problem = f"{samples:.3g} samples in each of {simulation['realizations']} realisations take {8e-9 * whole:.3g} GB"
        mend = "lower sampling_rate_hz, duration_s or realizations"
        raise InputError(place, problem, f"at most {_MOST_SAMPLES:.0e} samples in all", mend)


def _check_model(label: str, known: Catalogue, place: str) -> None:
    names = label.split("+")
    _check_effects(names, known, place)
    if len(set(names)) < len(names):
        raise InputError(place, f"an effect is named twice in {label!r}", "each effect once", "remove one")
    ordered = "+".join(known.ordered(names))  # the label names results, so each model must have one
    if ordered != label:
        problem = f"{label!r} is not in the catalogue's order"
        raise InputError(place, problem, ordered, f"write {ordered!r}")


def _check_effects(names: Iterable[str], known: Catalogue, place: str) -> None:
    for name in names:
        if name not in known.names:
            problem = f"no effect {name!r} in the catalogue"
            raise InputError(place, problem, ", ".join(known.names), near(name, known.names))
