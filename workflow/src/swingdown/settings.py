"""The study's settings: held against the schema, completed with its defaults, refused with a mend."""

import copy
import difflib
from functools import cache

import jsonschema
import yaml

from .effects import CATALOGUE
from .errors import InputError
from .model import Model
from .paths import PROJECT

SCHEMAS = PROJECT / "workflow" / "schemas"
_KINDS = {
    "string": "text", "integer": "a whole number", "number": "a number", "array": "a list", "object": "a group of keys",
    "boolean": "true or false",
}  # fmt: skip
_BOUNDS = {"minimum": "≥", "exclusiveMinimum": ">", "maximum": "≤", "exclusiveMaximum": "<"}


def complete(config, where="config"):
    """A copy of ``config`` with every default filled in.

    Raises InputError, with the full name of the key and a near match where there is one, for an unknown key, a value
    of another kind or out of bounds, and a model that is not built from the catalogue's effects.
    """
    settings = check(config, "config.schema.yaml", where)
    for part in ("simulation", "experiment"):
        for label in settings[part]["fitted"]:
            if (ordered := Model(label).label) != label:
                mend = f"write {ordered!r}"
                raise InputError(
                    f"{where}, key {part}.fitted", f"{label!r} is not in the catalogue's order", ordered, mend
                )
    return settings


def check(content, schema, where):
    """A copy of ``content`` (a mapping read from YAML) with the defaults of ``workflow/schemas/<schema>`` filled in.

    What the schema refuses raises InputError: the first fault, unknown keys before all others, told as ``where`` and key.
    A group that stands there empty counts as left out.
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
        key=lambda fault: (fault.validator != "additionalProperties", fault.path),
    )
    if faults:
        raise _told(faults[0], validator.schema, where)
    return _filled(copy.deepcopy(content), validator.schema)


@cache
def _validator(schema):
    formats = jsonschema.FormatChecker(formats=())
    formats.checks("effect")(lambda name: not isinstance(name, str) or name in CATALOGUE)
    formats.checks("model")(lambda label: not isinstance(label, str) or not _model_fault(label))
    rules = yaml.safe_load((SCHEMAS / schema).read_text(encoding="utf-8"))
    return jsonschema.Draft202012Validator(rules, format_checker=formats)


def _model_fault(label):
    """What keeps ``label`` from naming a model: the first unknown effect, or 'twice'; None if nothing does."""
    names = label.split("+")
    unknown = [name for name in names if name not in CATALOGUE]
    return unknown[0] if unknown else ("twice" if len(set(names)) < len(names) else None)


def _filled(content, schema):
    for key, rule in schema.get("properties", {}).items():
        if key not in content and "default" in rule:
            content[key] = copy.deepcopy(rule["default"])
        if isinstance(content.get(key), dict):
            _filled(content[key], rule)
    return content


def _told(fault, schema, where):
    """The InputError that tells a jsonschema error: which key, what was expected, the mend."""
    key = "".join(
        f"[{part + 1}]" if isinstance(part, int) else f".{part}" for part in fault.absolute_path
    ).lstrip(".")
    place = f"{where}, key {key}" if key else str(where)
    rule, value = fault.schema, fault.instance
    if fault.validator == "additionalProperties":
        return _unknown_key(fault, schema, where, key)
    if fault.validator == "required":
        lost = next(name for name in fault.validator_value if name not in value)
        return InputError(
            place,
            f"the key {lost!r} is missing",
            _expected(rule["properties"].get(lost, {})),
            f"add {lost!r}",
        )
    if fault.validator == "enum":
        return InputError(
            place,
            f"{value!r} is not known here",
            ", ".join(map(str, fault.validator_value)),
            _near(value, fault.validator_value),
        )
    if fault.validator == "format":
        wrong = _model_fault(str(value)) or value
        if wrong == "twice":
            return InputError(
                place, f"an effect is named twice in {value!r}", "each effect once", "remove one"
            )
        return InputError(
            place, f"no effect {wrong!r} in the catalogue", ", ".join(CATALOGUE), _near(wrong, CATALOGUE)
        )
    if fault.validator == "uniqueItems":
        return InputError(place, "an entry is there twice", "each entry once", "remove one")
    if fault.validator == "minItems":
        return InputError(place, "the list is too short", f"at least {fault.validator_value}", "add an entry")
    if fault.validator == "type" and isinstance(value, str) and rule.get("type") in ("number", "integer"):
        try:
            number = int(float(value)) if rule["type"] == "integer" else float(value)
            return InputError(
                place, f"{value!r} is text", _expected(rule), f"write {number!r} without quotes"
            )
        except ValueError:
            pass
    return InputError(place, f"{value!r} does not fit", _expected(rule), "correct the value")


def _unknown_key(fault, schema, where, key):
    known = fault.schema["properties"]
    name = next(name for name in fault.instance if name not in known)
    full = f"{key}.{name}" if key else str(name)
    elsewhere = [
        f"{group}.{name}"
        for group, rule in schema["properties"].items()
        if name in rule.get("properties", {})
    ]
    elsewhere += [str(name)] if key and name in schema["properties"] else []
    mend = f"it belongs at {elsewhere[0]}" if elsewhere else _near(name, known)
    return InputError(f"{where}, key {full}", "unknown key", f"one of {', '.join(known)}", mend)


def _near(name, known):
    near = difflib.get_close_matches(str(name), list(map(str, known)), 1, 0.5)
    return f"write {near[0]!r}, if that is what was meant" if near else "use one of these, or remove it"


def _expected(rule):
    bounds = " and ".join(f"{sign} {rule[bound]}" for bound, sign in _BOUNDS.items() if bound in rule)
    kind = _KINDS.get(rule.get("type"), "")
    if "enum" in rule:
        kind = " or ".join(map(str, rule["enum"]))
    return ", ".join(part for part in (f"{kind} {bounds}".strip(), rule.get("description", "")) if part)
