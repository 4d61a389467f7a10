"""A model: labels as in the paper, values by name, and files that can be read again."""

import numpy as np
import pytest
import yaml

from swingdown.errors import InputError
from swingdown.pendulum.catalogue import RATE
from swingdown.pendulum.drive import drive
from swingdown.pendulum.model import PAPER_MODELS, Model, as_model, symbol
from swingdown.pendulum.model_file import read_model, write_model
from swingdown.pendulum.slack import reading_slack

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


def test_a_model_file_says_what_the_model_is(tmp_path):
    values, errors = VALUES | {"viscous_ratio": 1 / 3}, {"viscous_ratio": 1e-7 / 3}
    path = write_model(
        Model("viscous+load_coulomb", values, errors, "linear", "printed"), tmp_path / "a" / "model.yaml"
    )
    content = yaml.safe_load(path.read_text())
    assert content["effects"] == ["viscous", "load_coulomb"]
    assert (content["restoring"], content["form"]) == ("linear", "printed")
    told = {name: one["value"] for name, one in content["parameters"].items()}
    assert told == {name: values[name] for name in Model("viscous+load_coulomb").parameters}, (
        "to the last digit"
    )
    left = sorted(found.name for found in path.parent.iterdir())
    assert left == [".model.yaml.sha256", "model.yaml"], "no half-written file stays"
    assert read_model(path) == Model("viscous+load_coulomb", values, errors, "linear", "printed")


def test_a_model_file_tells_units_and_errors(tmp_path):
    model = Model(
        "viscous",
        {"natural_frequency": np.float64(7.25), "viscous_ratio": 0.03},
        {"viscous_ratio": np.float64(0.001)},
    )
    content = yaml.safe_load(write_model(model, tmp_path / "model.yaml").read_text())
    assert content["parameters"]["viscous_ratio"] == {"value": 0.03, "unit": "1", "standard_error": 0.001}
    assert content["parameters"]["natural_frequency"] == {"value": 7.25, "unit": "rad/s"}


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("", "effects"),
        ("- viscous", "effects"),
        ("effects: [viscous]\nparameter: {}", "'parameter'"),
        ("effects: [viscose]", "viscose"),
        ("effects: [viscous]\nparameters: {viscous_ratio: {value: 0.1, unit: s}}", "unit 's'"),
        ("effects: [viscous]\nparameters: {gamma: {value: 0.1}}", "gamma"),
        ("effects: [viscous]\nrestoring: square", "square"),
        ("effects: viscous+load_coulomb\nparameters: {viscous_ratio: {value: much}}", "viscous_ratio"),
        ("effects: [viscous]\nparameters: {viscous_ratio: 0.1}", "viscous_ratio"),
        ("effects: [viscous]\nparameters: {viscous_ratio: {unit: '1'}}", "viscous_ratio"),
        ("effects: [viscous]\nparameters: [viscous_ratio]", "parameters"),
        ("effects: 3", "effects"),
        ("effects: [viscous]\nown: viscous_ratio", "key own"),
        ("effects: [viscous]\nown: [drag]", "key own.*viscous_ratio"),
        ("effects: [viscous]\nown: [[viscous_ratio]]", "key own"),
        ("effects: [viscous", "model.yaml"),
    ],
)
def test_a_bad_model_file_is_told_with_its_name(tmp_path, text, told):
    path = tmp_path / "model.yaml"
    path.write_text(text)
    with pytest.raises(InputError, match=told) as refusal:
        read_model(path)
    assert "model.yaml" in str(refusal.value)


def test_a_model_that_drifts_keeps_the_record_it_drifts_over(tmp_path):
    model = Model(
        ("viscous", "clock_drift"),
        {"natural_frequency": 7.0, "viscous_ratio": 0.01, "clock_drift": 0.02},
        record=20.0,
    )
    assert read_model(write_model(model, tmp_path / "model.yaml")).record == 20.0
    plain = write_model(model.with_effects(("viscous",), {}), tmp_path / "plain.yaml")
    assert "record" not in plain.read_text()
    broken = tmp_path / "broken.yaml"
    broken.write_text("effects: [viscous]\nrecord_s: -1\n")
    with pytest.raises(InputError, match="record_s"):
        read_model(broken)


def test_what_each_recording_has_for_itself_is_kept(tmp_path):
    model = Model("viscous", {"natural_frequency": 7.0, "viscous_ratio": 0.01}, own=("viscous_ratio",))
    again = read_model(write_model(model, tmp_path / "model.yaml"))
    assert again.each == ("viscous_ratio",)
    other = Model("load_coulomb", {"natural_frequency": 7.0, "load_friction": 0.01}, own=("viscous_ratio",))
    assert read_model(write_model(other, tmp_path / "other.yaml")).each == ()


def test_the_motion_is_the_pendulum_s_without_what_reads_it():
    """Its values stay, those of sensor, clock and slack go, and it reads an angle."""
    values = VALUES | {"sensor_gain": 0.1, "clock_drift": 0.01}
    read = Model("viscous+load_coulomb+sensor_gain+clock_drift", values, record=20.0)
    motion = read.motion
    assert motion.label == "viscous+load_coulomb" and dict(motion.values) == VALUES
    assert motion.record == 20.0 and read.of(RATE).motion == motion and motion.reading == "angle"
    assert read.drifts and not motion.drifts


def test_a_measured_drive_acts_by_an_effect_of_its_own_and_a_free_swing_by_none():
    pushed = drive(np.arange(5.0), np.arange(5.0), "torque")
    model = Model("viscous")
    assert model.under(None) is model and not model.takes_input
    under = model.under(pushed)
    assert under.names == ("viscous", "torque_input_gain") and under.drive is pushed and under.takes_input
    assert under.driven_by(pushed) is under and under.driven_by(None).drive is None


def test_other_effects_come_with_the_values_that_are_given_and_no_others():
    model = Model(
        "viscous", {"natural_frequency": 7.0, "viscous_ratio": 0.1}, {"viscous_ratio": 0.01}, "linear"
    )
    other = model.with_effects(("load_coulomb",), {"natural_frequency": 6.0, "load_friction": 0.02})
    assert dict(other.values) == {"natural_frequency": 6.0, "load_friction": 0.02}
    assert other.restoring == "linear" and not other.standard_errors
    assert not model.with_effects(("load_coulomb",)).values


def test_a_label_is_a_model_and_a_model_is_itself():
    model = Model("viscous", {"natural_frequency": 7.0, "viscous_ratio": 0.1})
    assert as_model(model) is model
    assert as_model("viscous+load_coulomb") == as_model(["load_coulomb", "viscous"]) == Model("viscous+load_coulomb")  # fmt: skip


def test_what_a_measurement_leaves_open_are_values_that_begin_at_nothing():
    model = Model("viscous", {"natural_frequency": 7.0, "viscous_ratio": 0.1}, {"viscous_ratio": 0.01})
    open_ = model.with_slack(reading_slack({"sensor_gain": {"length": 0.01}}))
    assert open_.values["sensor_gain"] == 0.0 and open_.values["viscous_ratio"] == 0.1
    assert open_.standard_errors == {"viscous_ratio": 0.01}
    known = open_.with_values({**open_.values, "sensor_gain": 0.02})
    back = known.with_slack(reading_slack({"sensor_zero": {"rest": 0.1}}))
    assert "sensor_gain" not in back.values and back.values["sensor_zero"] == 0.0
    assert not Model("viscous").with_slack(reading_slack({"sensor_gain": {"length": 0.01}})).values
