"""Content read from YAML, held against a schema: completed with its defaults, or refused with a mend."""

import copy
import difflib
import math
import sys
from collections.abc import Iterable
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import yaml

from .errors import InputError
from .extras import needed
from .own_yaml import read_own

if TYPE_CHECKING:
    import jsonschema

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


_DEEPEST = 50  # levels; the deepest of our own files has six
_MOST = 100_000  # entries that aliases may make of a file, which is all that a report could print


class _Loader(yaml.SafeLoader):
    """YAML's own safe loader, which also refuses a key that is there twice, and what holds itself, is deep or grows without end."""

    _depth = 0

    def compose_node(self, parent: Any, index: Any) -> Any:
        self._depth += 1
        if self._depth > _DEEPEST:
            raise _fault(f"it is nested more than {_DEEPEST} deep", self.peek_event().start_mark)
        node = super().compose_node(parent, index)
        self._depth -= 1
        return node

    def construct_document(self, node: Any) -> Any:
        _weighed(node, {})
        return super().construct_document(node)


def _weighed(node: yaml.Node, known: dict[yaml.Node, tuple[int, int] | None]) -> tuple[int, int]:
    """(entries, levels) below a node when every alias is written out; each node is looked at once."""
    if node in known:
        if (found := known[node]) is None:
            raise _fault("it holds itself, by an alias", node.start_mark)
        return found
    known[node] = None
    below = list(node.value) if isinstance(node, yaml.SequenceNode) else []
    if isinstance(node, yaml.MappingNode):
        seen = set()
        for key, value in node.value:
            if (key.tag, str(key.value)) in seen:
                raise _fault(f"the key {key.value!r} is there twice", key.start_mark)
            seen.add((key.tag, str(key.value)))
            below += [key, value]
    weights = [_weighed(one, known) for one in below]
    size, depth = 1 + sum(size for size, _ in weights), 1 + max((depth for _, depth in weights), default=0)
    if size > max(_MOST, len(known)) or depth > _DEEPEST:
        problem = f"its aliases make more than {_MOST} entries of it, or more than {_DEEPEST} levels"
        raise _fault(problem, node.start_mark)
    known[node] = size, depth
    return size, depth


def _fault(problem: str, mark: Any) -> yaml.MarkedYAMLError:
    return yaml.composer.ComposerError(None, None, problem, mark)


def parse_yaml(text: str, where: object) -> Any:
    """What a text in YAML holds. InputError with the line where it is none, or cannot be taken as it stands."""
    try:
        return yaml.load(text, Loader=_Loader)
    except (yaml.YAMLError, ValueError) as problem:
        mark, context = getattr(problem, "problem_mark", None), getattr(problem, "context_mark", None)
        at = f"{where}, line {mark.line + 1}, column {mark.column + 1}" if mark else str(where)
        said = str(getattr(problem, "problem", None) or problem)
        said, since = said.replace("\t", "a tab").replace("'\\t'", "a tab"), ""
        if mark and context and context.line != mark.line:
            since = f", in what begins in line {context.line + 1}"
        raise InputError(
            at, f"it cannot be read as YAML: {said}{since}", "keys with a colon, each once, indented by spaces, brackets and quotes closed",
            "mend that line, or the one before it",
        ) from problem  # fmt: skip


def read_yaml(path: Path, where: object) -> Any:
    """What a file in YAML holds; InputError as ``parse_yaml``, or where it is no text in UTF-8."""
    try:
        text = path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError as problem:
        told = "it is not text in UTF-8", "a YAML file in UTF-8", "save it in UTF-8"
        raise InputError(where, *told) from problem
    return parse_yaml(text, where)


def check(content: Any, schema: str, where: object, part: str = "key") -> dict[str, Any]:
    """A copy of a mapping read from YAML, with the defaults of a schema filled in.

    Unknown keys are refused before all other faults. A number is a finite number. A group that stands there empty counts as left out.
    Beside JSON Schema's own words a schema may say of a value that it refuses what is the matter with it (``refused``) and the ``mend``.
    ``schema`` is a file name in ``schemas``. InputError for the first fault, with the key: ``where`` is the place that it names, and ``part``
    what a key is called there, as the row of a table has columns.
    """
    if not isinstance(content, dict):
        problem = "it is not a mapping of keys to values"
        raise InputError(where, problem, "keys and values in YAML", "write `key: value` lines")
    content = {key: value for key, value in content.items() if value is not None}

    def order(fault: "jsonschema.ValidationError") -> tuple[bool, list[tuple[str, Any]]]:
        path = [(type(step).__name__, step) for step in fault.path]  # YAML's keys are of several kinds
        return fault.validator != "additionalProperties", path

    if fault := min(_validator(schema).iter_errors(content), key=order, default=None):
        raise _refusal(fault, rules(schema), where, part)
    return filled(content, schema)


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
        return yaml.load(value, Loader=_Loader)
    except (yaml.YAMLError, ValueError):
        return value


@cache
def rules(schema: str) -> dict[str, Any]:
    """The content of ``schemas/<schema>``."""
    return read_own(SCHEMAS / schema)


def _is_number(checker: object, value: object) -> bool:
    """A number that a float can hold: neither infinite nor an integer of hundreds of digits."""
    numeric = isinstance(value, int | float) and not isinstance(value, bool)
    return numeric and abs(value) <= sys.float_info.max  # type: ignore[arg-type]


@cache
def _kind() -> Any:
    """JSON Schema's validator, for which a number is a finite one."""
    library = needed("jsonschema")
    known = library.Draft202012Validator

    def is_integer(checker: object, value: object) -> bool:
        return known.TYPE_CHECKER.is_type(value, "integer") and _is_number(checker, value)

    checker = known.TYPE_CHECKER.redefine_many({"number": _is_number, "integer": is_integer})
    return library.validators.extend(known, type_checker=checker)


@cache
def _validator(schema: str) -> Any:
    return _kind()(rules(schema))


def filled(content: dict[str, Any], schema: str) -> dict[str, Any]:
    """A copy of ``content`` with the defaults of ``schemas/<schema>`` filled in; nothing of it is checked."""
    return _filled(copy.deepcopy(content), rules(schema))


def _filled(content: dict[str, Any], schema: dict[str, Any]) -> dict[str, Any]:
    for key, rule in schema.get("properties", {}).items():
        if key not in content and "default" in rule:
            content[key] = copy.deepcopy(rule["default"])
        if isinstance(content.get(key), dict):
            _filled(content[key], rule)
    # keys of any name, each by the same rules
    if isinstance(rest := schema.get("additionalProperties"), dict):
        for key, one in content.items():
            if key not in schema.get("properties", {}) and isinstance(one, dict):
                _filled(one, rest)
    return content


def _refusal(
    fault: "jsonschema.ValidationError", schema: dict[str, Any], where: object, part: str
) -> InputError:
    """The InputError that tells a jsonschema error: which key, what was expected, the mend."""
    steps = [f"[{one + 1}]" if isinstance(one, int) else f".{one}" for one in fault.absolute_path]
    key = "".join(steps).lstrip(".")
    place = f"{where}, {part} {key}" if key else str(where)
    rule, value = fault.schema, fault.instance
    if fault.validator == "additionalProperties":
        return _unknown_key(fault, schema, where, key)
    if fault.validator == "required":
        return _missing(fault, schema, where, part, place)
    if fault.validator == "enum":
        known = fault.validator_value
        problem = f"{value!r} is not known here"
        return InputError(place, problem, ", ".join(map(str, known)), near(value, known))
    if fault.validator == "uniqueItems":
        return InputError(place, "an entry is there twice", "each entry once", "remove one")
    if fault.validator == "pattern":
        problem = f"{value!r} {rule.get('refused', 'is no name')}"
        return InputError(place, problem, rule.get("description", ""), rule.get("mend", "rename it"))
    if fault.validator == "maxLength":
        problem = f"it has {len(value)} characters ({value[:40]}…)"
        return InputError(place, problem, f"at most {fault.validator_value}", "shorten it")
    if fault.validator == "minItems":
        return InputError(place, "the list is too short", f"at least {fault.validator_value}", "add an entry")
    if fault.validator == "type" and rule.get("type") in ("number", "integer"):
        return _no_number(value, rule, place)
    return InputError(place, f"{value!r} does not fit", _expected(rule), "correct the value")


def _missing(
    fault: "jsonschema.ValidationError", schema: dict[str, Any], where: object, part: str, place: str
) -> InputError:
    lost = next(name for name in fault.validator_value if name not in fault.instance)
    rule = fault.schema.get("properties", schema["properties"]).get(lost, {})
    if part == "column":
        return InputError(f"{where}, column {lost}", "the cell is empty", _expected(rule), "fill it in")
    return InputError(place, f"the key {lost!r} is missing", _expected(rule), f"add {lost!r}")


def _no_number(value: object, rule: dict[str, Any], place: str) -> InputError:
    """The fault of something else where a number belongs: text, or a number that is infinite or none."""
    problem, mend = "does not fit", "correct the value"
    try:
        number = float(str(value))
    except ValueError:
        problem = "is not a number"
    else:
        if not math.isfinite(number):
            problem = "is not a finite number"
        elif isinstance(value, str):
            problem = "is text"
            mend = f"write {int(number) if rule['type'] == 'integer' else number!r} without quotes"
    return InputError(place, f"{value!r} {problem}", _expected(rule), mend)


def _unknown_key(
    fault: "jsonschema.ValidationError", schema: dict[str, Any], where: object, key: str
) -> InputError:
    known = fault.schema["properties"]
    name = next(name for name in fault.instance if name not in known)
    full = f"{key}.{name}" if key else str(name)
    groups = schema["properties"]
    elsewhere = [str(name)] if key and name in groups else []
    elsewhere += [f"{group}.{name}" for group in groups if name in groups[group].get("properties", {})]
    mend = f"it belongs at {elsewhere[0]}" if elsewhere else near(name, known)
    return InputError(f"{where}, key {full}", "unknown key", f"one of {', '.join(known)}", mend)


def near(name: object, known: Iterable[object]) -> str:
    """The mend for a name that is not known: the one that looks like it, if there is one."""
    by_small = {str(one).lower(): str(one) for one in known}
    if found := difflib.get_close_matches(str(name).lower(), by_small, 1, 0.5):
        return f"write {by_small[found[0]]!r}, if that is what was meant"
    return "use one of these, or remove it"


def _expected(rule: dict[str, Any]) -> str:
    bounds = " and ".join(f"{sign} {rule[bound]}" for bound, sign in _BOUNDS.items() if bound in rule)
    named = rule.get("type", [])
    kinds = [named] if isinstance(named, str) else named
    kind = " or ".join(_KINDS.get(name, name) for name in kinds)
    if "enum" in rule:
        kind = " or ".join(map(str, rule["enum"]))
    return ", ".join(part for part in (f"{kind} {bounds}".strip(), rule.get("description", "")) if part)
