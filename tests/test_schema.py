"""YAML as every file of settings is read: plain, and refused with its line where it would be taken for something else."""

import time

import pytest

from swingdown.errors import InputError
from swingdown.pendulum.model_file import read_model
from swingdown.schema import as_said, check, parse_yaml, rules

BOMB = "a0: &a0 [x]\n" + "".join(f"a{k}: &a{k} [{', '.join([f'*a{k - 1}'] * 10)}]\n" for k in range(1, 10))
CHAIN = "a0: &a0 [x]\n" + "".join(f"a{k}: &a{k} [*a{k - 1}]\n" for k in range(1, 2000))


@pytest.mark.parametrize(
    ("text", "line", "told"),
    [
        ("seed: 1\nrounds: 2\nseed: 3\n", 3, "'seed' is there twice"),
        ("discovery: {rounds: 1, rounds: 2}\n", 1, "'rounds' is there twice"),
        ("a: &a [1, *a]\n", 1, "holds itself"),
        ("a: " + "[" * 100_000, 1, "nested more than 50 deep"),
        ("\n".join(f"{' ' * k}a{k}:" for k in range(3000)), 50, "nested more than 50 deep"),
        (BOMB, 6, "more than 100000 entries"),
        (CHAIN, None, "50 levels"),
        ("a: [1\nb: 2\n", 2, "expected"),
        ("a: 2024-13-45\n", None, "month"),
        ("a: !!python/object/apply:os.system [ls]\n", 1, "could not determine a constructor"),
    ],
)
def test_what_yaml_would_swallow_is_refused_with_its_line(text, line, told):
    begun = time.monotonic()
    with pytest.raises(InputError, match=told) as caught:
        parse_yaml(text, "a.yaml")
    assert caught.value.mend and caught.value.where.startswith(
        "a.yaml" if line is None else f"a.yaml, line {line},"
    )
    assert time.monotonic() - begun < 20


def test_what_is_plain_is_read():
    assert parse_yaml("a: &a {b: 1}\nc: [*a, *a, {<<: *a, d: 2}]\n1: x\n'1': y\n", "a") == {
        "a": {"b": 1}, "c": [{"b": 1}, {"b": 1}, {"b": 1, "d": 2}], 1: "x", "1": "y",
    }  # fmt: skip


def test_a_list_of_many_values_is_no_alias(tmp_path):
    assert len(parse_yaml("a: [" + "1, " * 120_000 + "1]", "a")["a"]) == 120_001


def test_a_model_file_is_read_that_way(tmp_path):
    (tmp_path / "model.yaml").write_text("effects: [viscous]\neffects: [quadratic_drag]\n")
    with pytest.raises(InputError, match="line 2.*'effects' is there twice"):
        read_model(tmp_path / "model.yaml")


NEEDED = {"config.schema.yaml": {}, "recordings.schema.yaml": {"recording": "a", "file": "a.csv"}}


def leaves(rule, way=()):
    """The way to each key that is no group, and its rule."""
    for key, one in rule.get("properties", {}).items():
        yield from leaves(one, (*way, key)) if "properties" in one else [((*way, key), one)]


def beside(rule):
    """Values that a rule does not allow, and what their refusal tells."""
    for word, sign, step in (("minimum", "≥", -1), ("maximum", "≤", 1), ("exclusiveMinimum", ">", 0), ("exclusiveMaximum", "<", 0)):  # fmt: skip
        if word in rule:
            yield rule[word] + step, f"{sign} {rule[word]}"
    if "enum" in rule:
        yield f"{rule['enum'][-1]}x", f"write {rule['enum'][-1]!r}"
    if "pattern" in rule:
        yield "ä ö", "'ä ö' "
    if "maxLength" in rule:
        yield "x" * (rule["maxLength"] + 1), f"at most {rule['maxLength']}"
    if rule.get("uniqueItems"):
        yield ["one", "one"], "an entry is there twice"
    if "minItems" in rule:
        yield [], f"at least {rule['minItems']}"
    if rule.get("type") in ("number", "integer"):
        yield "soon", "'soon' is not a number"
        yield "1e400", "not a finite number"
        yield True, "True is not a number"
        yield "7", "'7' is text"
    if rule.get("type") == "integer":
        yield 1.5, "a whole number"


def within(rule):
    """The ends of what a rule allows."""
    yield from (rule[word] for word in ("minimum", "maximum") if word in rule)
    yield from rule.get("enum", ())
    if "maxLength" in rule:
        yield "x" * rule["maxLength"]


def of_every_key(values):
    """(schema, way, value, …) of every key of the schemas."""
    return [
        (schema, way, *one) if isinstance(one, tuple) else (schema, way, one)
        for schema in NEEDED
        for way, rule in leaves(rules(schema))
        for one in values(rule)
    ]


def given(schema, way, value):
    """A content whose key at the end of the way has this value."""
    for key in reversed(way):
        value = {key: value} | ({"threshold": 0.1} if key in ("pre_s", "wait_s") else {})
    return NEEDED[schema] | value


@pytest.mark.parametrize(("schema", "way", "value", "told"), of_every_key(beside))
def test_every_key_refuses_what_lies_beside_its_rule(schema, way, value, told):
    with pytest.raises(InputError) as refused:
        check(given(schema, way, value), schema, "mine.yaml")
    assert refused.value.where == f"mine.yaml, key {'.'.join(way)}"
    assert told in str(refused.value) and refused.value.mend


@pytest.mark.parametrize(("schema", "way", "value"), of_every_key(within))
def test_every_key_takes_the_ends_of_its_rule(schema, way, value):
    found = check(given(schema, way, value), schema, "mine.yaml")
    for key in way:
        found = found[key]
    assert found == value and type(found) is type(value)


@pytest.mark.parametrize("schema", NEEDED)
def test_what_is_left_out_has_its_default_and_an_empty_group_counts_as_left_out(schema):
    groups = [key for key, rule in rules(schema)["properties"].items() if "properties" in rule]
    found = check(NEEDED[schema] | dict.fromkeys(groups), schema, "mine.yaml")
    told = 0
    for (first, *more), rule in leaves(rules(schema)):
        if first in found and len(more) < 2 and first not in NEEDED[schema] and "default" in rule:
            value = found[first][more[0]] if more else found[first]
            assert repr(value) == repr(rule["default"])  # nan, too
            told += 1
    assert told > 30


def test_a_row_of_a_table_has_columns_and_names_the_cell_that_is_empty():
    with pytest.raises(InputError, match="row 3, column file: the cell is empty"):
        check({"recording": "a"}, "recordings.schema.yaml", "row 3", part="column")
    with pytest.raises(InputError, match="row 3: the key 'file' is missing.*add 'file'"):
        check({"recording": "a"}, "recordings.schema.yaml", "row 3")


def test_a_key_in_the_wrong_group_is_told_where_it_belongs():
    for content, mend in (
        ({"snr": 3}, "it belongs at simulation.snr"),
        ({"simulation": {"seed": 3}}, "it belongs at seed"),
        ({"sead": 3}, "write 'seed'"),
        ({"zzzz": 3}, "use one of these, or remove it"),
    ):
        with pytest.raises(InputError) as refused:
            check(content, "config.schema.yaml", "mine.yaml")
        assert refused.value.problem == "unknown key" and refused.value.mend.startswith(mend)


def test_text_of_the_command_line_is_read_as_yaml_where_the_schema_wants_no_text():
    schema = "config.schema.yaml"
    said = {"capture": {"duration_s": "null", "trigger": {"threshold": "0.05"}, "notes": "7", "unknown": "7"}, "live": "true", "seed": "1"}  # fmt: skip
    read = as_said(said, schema, ("capture", "live"))
    assert read["capture"] == {"duration_s": None, "trigger": {"threshold": 0.05}, "notes": "7", "unknown": "7"}  # fmt: skip
    assert read["live"] is True and read["seed"] == "1"
    assert as_said({"live": "[", "capture": 3}, schema, ("capture", "live")) == {"live": "[", "capture": 3}
    assert as_said(["live"], schema, ("live",)) == ["live"]
