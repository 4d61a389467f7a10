"""Content read from YAML, held against a schema: completed with its defaults, or refused with a mend."""

import copy
import difflib
import math
import sys
from collections.abc import Iterable
from functools import cache
from pathlib import Path
from typing import Any

import jsonschema
import yaml

from .errors import InputError

SCHEMAS = Path(__file__).with_name("schemas")
_KINDS = {
    "string": "text",
    "integer": "a whole number",
    "number": "a number",
    "array": "a list",
    "object": "a group of keys",
    "boolean": "true or false",
}
_BOUNDS = {"minimum": "≥", "exclusiveMinimum": ">", "maximum": "≤", "exclusiveMaximum": "<"}


def check(content: Any, schema: str, where: object, part: str = "key") -> dict[str, Any]:
    """A copy of ``content`` (a mapping read from YAML) with the defaults of ``schemas/<schema>`` filled in.

    What the schema refuses raises InputError: the first fault, unknown keys before all others, told as ``where`` and key
    (``part`` is what a key is called there: the row of a table has columns). A number is a finite one. A group that
    stands there empty counts as left out. Beside JSON Schema's own words a schema may say of a value that it refuses
    what is the matter with it (``refused``) and the ``mend``.
    """
    if not isinstance(content, dict):
        raise InputError(
            where,
            "it is not a mapping of keys to values",
            "keys and values in YAML",
            "write `key: value` lines",
        )
    content = {key: value for key, value in content.items() if value is not None}
    validator = _validator(schema)
    faults = sorted(
        validator.iter_errors(content),
        key=lambda fault: (
            fault.validator != "additionalProperties",
            [(type(step).__name__, step) for step in fault.path],  # YAML's keys are of several kinds
        ),
    )
    if faults:
        raise _refusal(faults[0], rules(schema), where, part)
    return _filled(copy.deepcopy(content), rules(schema))


def as_said(content: Any, schema: str, keys: Iterable[str]) -> Any:
    """``content`` with text under ``keys`` read as YAML wherever the schema wants something else than text.

    For keys that are given on the command line: of a group in ``--config key={...}`` Snakemake makes every value text.
    """
    known = rules(schema)["properties"]
    if not isinstance(content, dict):
        return content
    return content | {key: _said(content[key], known[key]) for key in keys if key in content}


def _said(value: Any, rule: dict[str, Any]) -> Any:
    if isinstance(value, dict):
        known = rule.get("properties", {})
        return {key: _said(part, known.get(key, {"type": "string"})) for key, part in value.items()}
    if not isinstance(value, str) or rule.get("type") == "string":
        return value
    try:
        return yaml.safe_load(value)
    except yaml.YAMLError:
        return value


@cache
def rules(schema: str) -> dict[str, Any]:
    """The content of ``schemas/<schema>``."""
    return yaml.safe_load((SCHEMAS / schema).read_text(encoding="utf-8"))


_TYPES = jsonschema.Draft202012Validator.TYPE_CHECKER


def _is_number(checker: object, value: object) -> bool:
    """A number that a float can hold: neither infinite nor an integer of hundreds of digits."""
    numeric = isinstance(value, int | float) and not isinstance(value, bool)
    return numeric and abs(value) <= sys.float_info.max  # type: ignore[arg-type]


def _is_integer(checker: object, value: object) -> bool:
    return _TYPES.is_type(value, "integer") and _is_number(checker, value)


_Validator = jsonschema.validators.extend(
    jsonschema.Draft202012Validator,
    type_checker=_TYPES.redefine_many({"number": _is_number, "integer": _is_integer}),
)


@cache
def _validator(schema: str) -> jsonschema.Draft202012Validator:
    return _Validator(rules(schema))


def _filled(content: dict[str, Any], schema: dict[str, Any]) -> dict[str, Any]:
    for key, rule in schema.get("properties", {}).items():
        if key not in content and "default" in rule:
            content[key] = copy.deepcopy(rule["default"])
        if isinstance(content.get(key), dict):
            _filled(content[key], rule)
    if isinstance(
        rest := schema.get("additionalProperties"), dict
    ):  # keys of any name, each by the same rules
        for key, one in content.items():
            if key not in schema.get("properties", {}) and isinstance(one, dict):
                _filled(one, rest)
    return content


def _refusal(
    fault: jsonschema.ValidationError, schema: dict[str, Any], where: object, part: str
) -> InputError:
    """The InputError that tells a jsonschema error: which key, what was expected, the mend."""
    key = "".join(
        f"[{step + 1}]" if isinstance(step, int) else f".{step}" for step in fault.absolute_path
    ).lstrip(".")
    place = f"{where}, {part} {key}" if key else str(where)
    rule, value = fault.schema, fault.instance
    if fault.validator == "additionalProperties":
        return _unknown_key(fault, schema, where, key)
    if fault.validator == "required":
        return _missing(fault, schema, where, part, place)
    if fault.validator == "enum":
        known = fault.validator_value
        return InputError(
            place, f"{value!r} is not known here", ", ".join(map(str, known)), near(value, known)
        )
    if fault.validator == "uniqueItems":
        return InputError(place, "an entry is there twice", "each entry once", "remove one")
    if fault.validator == "pattern":
        problem = f"{value!r} {rule.get('refused', 'is no name')}"
        return InputError(place, problem, rule.get("description", ""), rule.get("mend", "rename it"))
    if fault.validator == "minItems":
        return InputError(place, "the list is too short", f"at least {fault.validator_value}", "add an entry")
    if fault.validator == "type" and rule.get("type") in ("number", "integer"):
        return _no_number(value, rule, place)
    return InputError(place, f"{value!r} does not fit", _expected(rule), "correct the value")


def _missing(
    fault: jsonschema.ValidationError, schema: dict[str, Any], where: object, part: str, place: str
) -> InputError:
    lost = next(name for name in fault.validator_value if name not in fault.instance)
    rule = fault.schema.get("properties", schema["properties"]).get(lost, {})
    if part == "column":
        return InputError(f"{where}, column {lost}", "the cell is empty", _expected(rule), "fill it in")
    return InputError(place, f"the key {lost!r} is missing", _expected(rule), f"add {lost!r}")


def _no_number(value: object, rule: dict[str, Any], place: str) -> InputError:
    """The fault of something else where a number belongs: text, or a number that is infinite or none."""
    whole = rule["type"] == "integer"
    try:
        number = float(str(value))
    except ValueError:
        return InputError(place, f"{value!r} is not a number", _expected(rule), "correct the value")
    if not math.isfinite(number):
        return InputError(place, f"{value!r} is not a finite number", _expected(rule), "correct the value")
    if not isinstance(value, str):
        return InputError(place, f"{value!r} does not fit", _expected(rule), "correct the value")
    mend = f"write {int(number) if whole else number!r} without quotes"
    return InputError(place, f"{value!r} is text", _expected(rule), mend)


def _unknown_key(
    fault: jsonschema.ValidationError, schema: dict[str, Any], where: object, key: str
) -> InputError:
    known = fault.schema["properties"]
    name = next(name for name in fault.instance if name not in known)
    full = f"{key}.{name}" if key else str(name)
    elsewhere = [str(name)] if key and name in schema["properties"] else []
    elsewhere += [
        f"{group}.{name}"
        for group, rule in schema["properties"].items()
        if name in rule.get("properties", {})
    ]
    mend = f"it belongs at {elsewhere[0]}" if elsewhere else near(name, known)
    return InputError(f"{where}, key {full}", "unknown key", f"one of {', '.join(known)}", mend)


def near(name: object, known: Iterable[object]) -> str:
    """The mend for a name that is not known: the one that looks like it, if there is one."""
    by_small = {str(one).lower(): str(one) for one in known}
    found = difflib.get_close_matches(str(name).lower(), by_small, 1, 0.5)
    return (
        f"write {by_small[found[0]]!r}, if that is what was meant"
        if found
        else "use one of these, or remove it"
    )


def _expected(rule: dict[str, Any]) -> str:
    bounds = " and ".join(f"{sign} {rule[bound]}" for bound, sign in _BOUNDS.items() if bound in rule)
    named = rule.get("type", [])
    kinds = [named] if isinstance(named, str) else named
    kind = " or ".join(_KINDS.get(name, name) for name in kinds)
    if "enum" in rule:
        kind = " or ".join(map(str, rule["enum"]))
    return ", ".join(part for part in (f"{kind} {bounds}".strip(), rule.get("description", "")) if part)
