"""An effect of a study's own is read from its settings, and what cannot be one is told with its key."""

import numpy as np
import pytest

from swingdown.errors import InputError
from swingdown.pendulum.own import own_effects

BRAKE = {"torque": "-k*thetadot*abs(theta)**n", "parameters": {"k": {"unit": "1/s"}, "n": {"start": [2, 1]}}}


def test_parameters_have_what_is_stated_and_the_usual_where_nothing_is():
    (found,) = own_effects({"brake": BRAKE})
    size, shape = found.parameters
    assert (found.name, found.term, found.explanation) == (
        "brake",
        BRAKE["torque"],
        "An effect of this study's own.",
    )
    assert (size.name, size.symbol, size.unit, size.lower, size.upper, size.typical, size.role) == (
        "brake_k",
        "k",
        "1/s",
        -np.inf,
        np.inf,
        1.0,
        "size",
    )
    assert (shape.name, shape.unit, shape.starts, shape.typical, shape.role) == (
        "brake_n",
        "1",
        (2.0, 1.0),
        2.0,
        "shape",
    )
    assert found.size is size


@pytest.mark.parametrize(
    ("stated", "typical"),
    [
        ({"start": [-3, 1]}, 3.0),
        ({"start": [0, 4]}, 1.0),
        ({"typical": 0.2, "start": [3]}, 0.2),
        ({"start": []}, 1.0),
    ],
)
def test_the_typical_size_is_stated_or_that_of_the_first_start(stated, typical):
    (found,) = own_effects(
        {"brake": BRAKE | {"parameters": {"k": None, "n": {"start": [2]} | stated}, "torque": "-k*n*theta"}}
    )
    assert found.parameters[1].typical == typical


@pytest.mark.parametrize(
    ("name", "changes", "where", "problem"),
    [
        ("Brake", {}, "effects.Brake", "is no name of an effect"),
        ("2brake", {}, "effects.2brake", "is no name of an effect"),
        ("brake", {"parameters": {"theta": {}}}, "brake.parameters.theta", "is a variable of every formula"),
        ("brake", {"parameters": {"k-1": {}}}, "brake.parameters.k-1", "is no symbol"),
        ("brake", {"parameters": {"lambda": {}}}, "brake.parameters.lambda", "has a meaning of its own"),
        ("brake", {"parameters": {"exp": {}}}, "brake.parameters.exp", "has a meaning of its own"),
        ("brake", {"parameters": {"k": {"lower": 1, "upper": 1}}}, "brake.parameters.k", "the bounds 1 and 1 leave nothing"),
        ("brake", {"parameters": {"k": {}, "n": {"lower": 1, "upper": 2, "start": [1, 2, 2.5]}}}, "brake.parameters.n.start", "2.5 is outside the bounds"),
        ("brake", {"parameters": {"k": {}, "n": {"start": [1]}, "m": {}}}, "brake.parameters.m", "the torque does not use it"),
        ("brake", {"parameters": {"k": {}, "n": {}}}, "brake.parameters.n", "the torque is not linear in it"),
        ("brake", {"parameters": {"k": {"start": [1]}, "n": {"start": [1]}}}, "brake.parameters", "all parameters have values to start from"),
        ("brake", {"torque": "-theta", "parameters": {}}, "brake.parameters", "it has no parameter"),
    ],
)  # fmt: skip
def test_what_cannot_be_an_effect_is_told_with_its_key(name, changes, where, problem):
    with pytest.raises(InputError, match=problem) as told:
        own_effects({name: BRAKE | changes})
    assert told.value.where == f"config, key effects.{where.removeprefix('effects.')}" and told.value.expected


def test_starts_may_lie_on_the_bounds():
    (found,) = own_effects(
        {"brake": BRAKE | {"parameters": {"k": {"lower": 0}, "n": {"lower": 1, "upper": 2, "start": [1, 2]}}}}
    )
    assert found.parameters[1].starts == (1.0, 2.0) and found.one_sided
