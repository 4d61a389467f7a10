"""YAML as every file of settings is read: plain, and refused with its line where it would be taken for something else."""

import time

import pytest

from swingdown.errors import InputError
from swingdown.pendulum.model_file import read_model
from swingdown.schema import parse_yaml

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
