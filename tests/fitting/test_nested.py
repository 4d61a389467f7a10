"""From where a model's fit starts: the models inside it, and another one whose work it can do."""

import pytest

from swingdown.fitting.nested import contains, stand_ins
from swingdown.pendulum.model import Model

LOAD = {"natural_frequency": 6.0, "load_friction": 0.01}


def test_a_model_holds_those_with_fewer_of_its_effects_and_not_itself():
    assert contains("viscous+load_coulomb", "viscous")
    assert not contains("viscous", "viscous")
    assert not contains("viscous", "load_coulomb")


def test_friction_that_winds_up_starts_where_plain_friction_of_that_size_ended():
    found = stand_ins(Model("presliding"), Model("load_coulomb", LOAD))
    assert [one["presliding_angle"] for one in found] == [0.001, 0.003, 0.01, 0.03]
    for one in found:
        assert one["natural_frequency"] == 6.0
        assert one["presliding_friction"] == pytest.approx(0.01 * 36, abs=1e-3)


@pytest.mark.parametrize(
    "model, other",
    [
        ("presliding", "quadratic_drag"),  # friction does not do what air does
        ("presliding", "load_coulomb+stribeck"),  # nor alone what two effects do
        ("presliding+quadratic_drag", "load_coulomb"),
        ("constant_coulomb", "load_coulomb"),  # what the decay itself sizes needs no other
    ],
)
def test_nothing_stands_in_for_what_is_not_in_the_catalogue_s_words(model, other):
    values = dict.fromkeys(Model(other).parameters, 0.01) | LOAD
    own = Model(other)
    assert stand_ins(Model(model), Model(other, {name: values[name] for name in own.parameters})) == []
