"""A model: labels as in the paper, values by name, and files that can be read again."""

import numpy as np
import pytest
import yaml

from swingdown.errors import InputError
from swingdown.pendulum.model import PAPER_MODELS, Model, symbol, write_model

VALUES = {"natural_frequency": 7.25, "viscous_ratio": 0.03, "load_friction": 0.012}


def test_the_papers_seven():
    assert PAPER_MODELS == (
        "viscous", "quadratic_drag", "load_coulomb", "viscous+quadratic_drag", "viscous+load_coulomb",
        "quadratic_drag+load_coulomb", "viscous+quadratic_drag+load_coulomb",
    )  # fmt: skip
    assert [symbol(label) for label in PAPER_MODELS] == ["κv", "κq", "κc", "κv,q", "κv,c", "κq,c", "κv,q,c"]
    assert symbol("viscous+quadratic_drag", mathtext=True) == r"$\kappa_{v,q}$"
    assert symbol("viscous+eddy_brake", mathtext=True) == r"$\kappa_{v,eddy\ brake}$"


def test_the_order_of_effects_does_not_matter():
    model = Model("load_coulomb+viscous", VALUES)
    assert model == Model(["viscous", "load_coulomb"], VALUES)
    assert model.label == "viscous+load_coulomb"
    assert model.parameters == ("natural_frequency", "viscous_ratio", "load_friction")
    assert model.units == {"natural_frequency": "rad/s", "viscous_ratio": "1", "load_friction": "1"}
    assert model.vector() == [7.25, 0.03, 0.012]


@pytest.mark.parametrize(
    ("make", "told"),
    [
        (lambda: Model("viscosity"), "viscosity"),
        (lambda: Model("viscous+viscous"), "named twice"),
        (lambda: Model(""), "''"),
        (lambda: Model("viscous", {"gamma": 1.0}), "gamma"),
        (lambda: Model("viscous", {}, {"load_friction": 1.0}), "load_friction"),
        (lambda: Model("viscous", restoring="cosine"), "sine or linear"),
        (lambda: Model("viscous", form="literal"), "consistent or printed"),
        (lambda: Model("viscous", {"viscous_ratio": 0.1}).vector(), "natural_frequency"),
    ],
    ids=["effect", "twice", "none", "value", "error", "restoring", "form", "lost"],
)
def test_what_is_wrong_is_named(make, told):
    with pytest.raises(InputError, match=told):
        make()


def test_a_model_cannot_be_changed_by_its_copy():
    model = Model("viscous+load_coulomb", VALUES)
    other = model.with_values(VALUES | {"viscous_ratio": 0.5})
    assert model.values["viscous_ratio"] == 0.03 and other.values["viscous_ratio"] == 0.5
    given = dict(VALUES)
    kept = model.with_values(given)
    given["viscous_ratio"] = 9.0
    assert kept.values["viscous_ratio"] == 0.03


@pytest.mark.parametrize("restoring", ["sine", "linear"])
@pytest.mark.parametrize("form", ["consistent", "printed"])
def test_a_model_file_reads_as_it_was_written(tmp_path, restoring, form):
    model = Model(
        "viscous+load_coulomb",
        VALUES | {"viscous_ratio": 1 / 3},
        {"viscous_ratio": 1e-7 / 3},
        restoring,
        form,
    )
    path = write_model(model, tmp_path / "round-1" / "model.yaml")
    content = yaml.safe_load(path.read_text())
    entries = content.pop("parameters")
    read = {
        key: {name: entry[key] for name, entry in entries.items() if key in entry}
        for key in ("value", "standard_error")
    }
    assert Model(tuple(content.pop("effects")), *read.values(), **content) == model
    assert [found.name for found in path.parent.iterdir()] == ["model.yaml"], "no half-written file stays"


def test_a_model_file_tells_units_and_errors(tmp_path):
    model = Model(
        "viscous",
        {"natural_frequency": np.float64(7.25), "viscous_ratio": 0.03},
        {"viscous_ratio": np.float64(0.001)},
    )
    content = yaml.safe_load(write_model(model, tmp_path / "model.yaml").read_text())
    assert content["parameters"]["viscous_ratio"] == {"value": 0.03, "unit": "1", "standard_error": 0.001}
    assert content["parameters"]["natural_frequency"] == {"value": 7.25, "unit": "rad/s"}
