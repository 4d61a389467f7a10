"""Whatever stands in the config: an InputError with a mend, or settings that hold what was written and are whole."""

import copy
import math

import pytest
import yaml
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st
from ways import paths

from swingdown.errors import InputError
from swingdown.planning.plan import plan
from swingdown.planning.settings import complete

FUZZ = settings(deadline=None, max_examples=150, suppress_health_check=[HealthCheck.function_scoped_fixture])

scalar = st.one_of(
    st.none(), st.booleans(), st.integers(-3, 12), st.floats(), st.text(max_size=8),
    st.sampled_from([10**400, -(10**30), 1e308, 5e-324, "nan", "viscous", "viscous+viscous", "sine", "rest", "R", "../x", "1e3", "\0"]),
)  # fmt: skip
value = st.recursive(
    scalar,
    lambda one: st.lists(one, max_size=3) | st.dictionaries(st.text(max_size=6) | scalar, one, max_size=3),
    max_leaves=5,
)


@pytest.fixture(scope="module")
def whole(root):
    return complete(yaml.safe_load((root / "config/config.yaml").read_text()))


def changed(content, way, new):
    content = copy.deepcopy(content)
    inside = content
    for key in way[:-1]:
        inside = inside[key]
    inside[way[-1]] = new
    return content


def numbers(content):
    if isinstance(content, dict | list):
        for one in content.values() if isinstance(content, dict) else content:
            yield from numbers(one)
    elif isinstance(content, int | float) and not isinstance(content, bool):
        yield content


@FUZZ
@given(data=st.data())
def test_any_value_anywhere(whole, data):
    for _ in range(data.draw(st.integers(1, 2))):
        way = data.draw(st.sampled_from(sorted(paths(whole), key=repr)))
        if data.draw(st.booleans()):  # a key nobody knows, or one in the wrong group
            way = (*way[:-1], data.draw(st.text(max_size=8) | st.sampled_from(["seed", "snr", "effects"])))
        if way and isinstance(way[-1], str) and len(way) > 1 and isinstance(way[-2], int):
            continue
        new = data.draw(value)
        try:
            content = changed(whole, way, new)
        except (TypeError, IndexError):
            continue  # a name for an entry of a list
        try:
            found = complete(content)
        except InputError as error:
            assert error.where and error.problem
            continue
        assert complete(found) == found
        assert all(math.isfinite(one) for one in numbers(found))
        told = found
        for key in way:
            told = told[key] if not (isinstance(told, dict) and key not in told) else None
        if not isinstance(new, dict):
            assert new is None or told == new


@FUZZ
@given(content=st.dictionaries(st.sampled_from(["recordings", "apparatus", "seed", "experiment", "discovery", "effects", "sweeps", "capture"]) | st.text(max_size=5), value, max_size=4))  # fmt: skip
@example(content={"seed": 10**400})
@example(content={"recordings": "/"})
@example(content={"recordings": "a\0b"})
def test_any_config_of_ones_own(tmp_path, monkeypatch, content):
    monkeypatch.chdir(tmp_path)
    try:
        plan(complete(content))
    except InputError as error:
        assert error.where and error.problem


FORMULA = st.text("theta dot+-*/()0123456789.^abskgnt_", max_size=20)


@FUZZ
@given(
    name=st.text(max_size=10) | st.sampled_from(["gravity", "viscous", "my_drag"]),
    entry=value | st.fixed_dictionaries({"torque": FORMULA}, optional={"parameters": value, "sentence": scalar}),
)  # fmt: skip
def test_any_effect_of_ones_own(name, entry):
    try:
        found = complete({"effects": {name: entry}})
    except InputError as error:
        assert error.where and error.problem
        return
    assert name not in ("gravity", "viscous") and set(found["effects"]) == {name}
