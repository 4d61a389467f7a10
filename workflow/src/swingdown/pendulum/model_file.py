"""Model files: a pendulum model as YAML, written and read again."""

from collections.abc import Sequence
from dataclasses import replace
from math import inf
from pathlib import Path
from typing import Any

import yaml

from ..errors import InputError
from ..schema import parse_yaml
from ..sealed import read_text, write_text
from .catalogue import ANGLE, SHIPPED, Catalogue
from .model import Model


def write_model(model: Model, path: Path | str) -> Path:
    """The path written: a model file (YAML) with effects, options, and value ± standard error and unit of each parameter.

    Parameters
    ----------
    model
        Its nuisance parameters (``slack``) are left out.
    path
        Where to write. ``read_model`` reads it again.

    Raises
    ------
    Unwritten
        If there is no room, or no leave to write.
    """
    values = {
        name: {"value": float(model.values[name]), "unit": model.units[name]}
        | ({"standard_error": float(model.standard_errors[name])} if name in model.standard_errors else {})
        for name in model.parameters
        if name in model.values and name not in model.slack.parameters
    }
    own = [name for name in model.own if name in model.parameters]
    content = {
        "effects": list(model.names),
        "restoring": model.restoring,
        "form": model.form,
        **({} if model.reading == ANGLE else {"reading": model.reading}),
        **({"record_s": model.record} if model.record and model.drifts else {}),
        **({"own_frequency": True} if model.own_frequency else {}),
        **({"own": own} if own else {}),
        "parameters": values,
    }
    return write_text(path, yaml.safe_dump(content, sort_keys=False, allow_unicode=True))


def read_model(path: Path | str, catalogue: Catalogue = SHIPPED) -> Model:
    """The ``Model`` that a model file states.

    Raises
    ------
    InputError
        With the file and the key that is wrong.
    """
    content = parse_yaml(read_text(path), path)
    if not isinstance(content, dict) or "effects" not in content:
        raise InputError(path, "not a model file", "a mapping with the key 'effects'")
    known = ("effects", "restoring", "form", "reading", "record_s", "own_frequency", "own", "parameters")
    if unknown := set(content) - set(known):
        raise InputError(path, f"unknown key {sorted(unknown)[0]!r}", ", ".join(known))
    names, parameters = content["effects"], content.get("parameters") or {}
    names = names.split("+") if isinstance(names, str) else names
    if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
        raise InputError(
            f"{path}, key effects", f"{names!r} is no list of names", "a list such as [viscous, load_coulomb]"
        )
    if not isinstance(parameters, dict):
        raise InputError(
            f"{path}, key parameters", "it is not a mapping", "parameter names, each with value and unit"
        )
    try:
        model = Model(
            tuple(names),
            restoring=content.get("restoring", "sine"),
            form=content.get("form", "consistent"),
            catalogue=catalogue.of(content.get("reading", ANGLE)),
            record=_record(content.get("record_s")),
            own_frequency=_yes_or_no("own_frequency", content.get("own_frequency", False)),
        )
        model = replace(model, own=_own(content.get("own", []), model.parameters))
        values, errors = {}, {}
        for name, entry in parameters.items():
            if not isinstance(entry, dict) or not isinstance(entry.get("value"), (int, float)):
                raise InputError(
                    f"parameter {name}", f"{entry!r} has no number as value", "a mapping with value and unit"
                )
            if name in model.units and entry.get("unit", model.units[name]) != model.units[name]:
                raise InputError(f"parameter {name}", f"unit {entry['unit']!r}", model.units[name])
            values[name] = float(entry["value"])
            if "standard_error" in entry:
                errors[name] = float(entry["standard_error"])
        return model.with_values(values, errors)
    except InputError as problem:
        raise InputError(path, str(problem)) from None


def _record(given: Any) -> float | None:
    if given is None:
        return None
    if not isinstance(given, (int, float)) or not 0 < given < inf:
        raise InputError("key record_s", f"{given!r}", "a length in seconds, more than 0")
    return float(given)


def _own(given: Any, known: Sequence[str]) -> tuple[str, ...]:
    if not isinstance(given, list) or not set(map(str, given)) <= set(known):
        raise InputError("key own", f"{given!r}", f"a list of parameters: {', '.join(known)}")
    return tuple(given)


def _yes_or_no(key: str, given: Any) -> bool:
    if not isinstance(given, bool):
        raise InputError(f"key {key}", f"{given!r}", "true or false")
    return given
