"""A sweep's table: any key that matters can be an axis, and what cannot be one is refused with the mend."""

import copy

import numpy as np
import pytest
import yaml

from swingdown.errors import InputError
from swingdown.pendulum.model import Model
from swingdown.pendulum.model_file import write_model
from swingdown.planning.settings import complete
from swingdown.sweep.draws import cell_key, noise_key, stream, value_of
from swingdown.sweep.table import READS, sweeps

SMALL = {
    "computes": "identification",
    "axes": {"simulation.simulated": ["viscous"], "simulation.snr": [10, 50]},
}


def made(**changed):
    """The one sweep of a config, ``SMALL`` with changed keys."""
    return sweeps(complete({"sweeps": {"mine": copy.deepcopy(SMALL) | changed}}))["mine"]


def refused(**changed):
    with pytest.raises(InputError) as told:
        made(**changed)
    return told.value


def test_the_shipped_sweeps_are_over_what_the_paper_leaves_open(root):
    shipped = sweeps(complete(yaml.safe_load((root / "config/sweeps.yaml").read_text())))
    dims = {axis.dim for axis in shipped["identification"].axes}
    assert {"simulated", "snr", "duration_s", "release_angle_deg"} <= dims
    assert {axis.dim for axis in shipped["detection"].axes} == {"effect", "size"}
    full = sweeps(complete(yaml.safe_load((root / "config/sweeps-full.yaml").read_text())))
    assert {name: sweep.computes for name, sweep in full.items()} == {
        name: sweep.computes for name, sweep in shipped.items()
    }
    assert full["identification"].cells * full["identification"].realizations * 7 > 1e7


@pytest.mark.parametrize(
    ("key", "words", "unit"),
    [
        ("duration_s", "duration", "s"),
        ("sampling_rate_hz", "sampling rate", "Hz"),
        ("snr", "signal to noise ratio", "1"),
    ],
)
def test_an_axis_has_its_words_and_its_unit(key, words, unit):
    axes = {"simulation.simulated": ["viscous"], f"simulation.{key}": [20, 50]}
    axis = made(computes="identification", axes=axes).axes[1]
    assert (axis.long_name, axis.units) == (words, unit)


VALUES = {
    "seed": [1, 2], "simulation.noise": ["additive", "quantisation"], "simulation.start": ["rest", "free"], "model.restoring": ["sine", "linear"],
    "model.form": ["consistent", "printed"], "simulation.simulated": ["viscous", "load_coulomb"], "simulation.fitted": ["viscous", "load_coulomb"],
    "discovery.base": [["viscous"], ["viscous", "load_coulomb"]], "discovery.rounds": [1, 2], "detection.effect": ["presliding", "detent"],
    "detection.release_angles_deg": [[10, 20], [20, 40]], "detection.noise": ["additive", "proportional"],
}  # fmt: skip


@pytest.mark.parametrize(
    ("computes", "key"), [(computes, key) for computes, keys in READS.items() for key in keys]
)
def test_any_key_that_a_computation_depends_on_can_be_an_axis(computes, key):
    axes = {"simulation.simulated": ["viscous"]} if computes == "identification" else {}
    values = VALUES.get(key, [0.5, 1.5])
    sweep = made(computes=computes, axes=axes | {key: values})
    axis = next(axis for axis in sweep.axes if axis.key == key)
    assert len(axis.values) == 2 and sweep.cells == 2
    assert axis.coordinate.size == 2 and axis.units
    told = [cell_key(computes, sweep.cell(one)) for one in sweep]
    assert len(set(told)) == 2


@pytest.mark.parametrize(
    ("axes", "problem", "mend"),
    [
        ({"simulation.srn": [1]}, "no such key", "'simulation.snr'"),
        ({"snr": [1]}, "no such key", "'simulation.snr'"),
        ({"calibration.draws": [1000]}, "nothing would change along this axis", "remove"),
        ({"detection.size": [1]}, "nothing would change along this axis", "remove"),
        ({"simulation.realizations": [10]}, "not an axis", "realizations: 100"),
        ({"simulation.snr": [10, -1]}, "-1 does not fit", "correct"),
        ({"simulation.snr": [10, "50"]}, "text", "without quotes"),
        ({"simulation.snr": [10, 10.0]}, "twice", "remove one"),
        ({"simulation.snr": []}, "too short", "add"),
        (
            {"simulation.simulated": [["viscous", "load_coulomb"]]},
            "['viscous', 'load_coulomb']",
            "[viscous, load_coulomb]",
        ),
        ({"simulation.simulated": ["viscuos"]}, "viscuos", "'viscous'"),
    ],
)
def test_an_axis_that_cannot_be_is_refused_with_its_place_and_the_mend(axes, problem, mend):
    error = refused(axes=SMALL["axes"] | axes)
    assert "sweeps.mine" in error.where and next(iter(axes)) in error.where
    assert problem in error.problem
    assert mend in error.mend


def test_a_setting_that_is_an_axis_too_and_an_effect_that_is_not_hidden_are_refused():
    assert "axis too" in refused(settings={"simulation.snr": 10}).problem
    assert (
        "'viscous' is not among"
        in refused(settings={"simulation.fitted": ["quadratic_drag", "load_coulomb"]}).problem
    )
    told = refused(computes="detection", axes={"detection.effect": ["viscous"]})
    assert "not hidden" in told.problem


def test_several_models_in_the_settings_are_an_axis():
    sweep = made(axes={"simulation.snr": [10, 50]})
    assert [axis.dim for axis in sweep.axes] == ["simulated", "snr"]
    assert sweep.shape == (3, 2)


def test_a_cell_is_known_by_its_settings_however_they_are_written_and_wherever_it_stands():
    first, second = (
        made(),
        made(axes={"simulation.snr": [50.0, 99, 10.0], "simulation.simulated": ["load_coulomb", "viscous"]}),
    )
    keys = [{cell_key(one.computes, one.cell(values)) for values in one} for one in (first, second)]
    assert keys[0] < keys[1]


def test_noise_belongs_to_the_swing_not_to_what_is_fitted_to_it():
    one = made()
    cell = one.cell(next(iter(one)))
    same = cell | {"simulation.fitted": ["viscous"], "simulation.start": "free"}
    assert noise_key(cell) == noise_key(same)
    assert noise_key(cell) != noise_key(cell | {"simulation.snr": 11.0})
    draws = [stream(cell, noise_key(cell), k).standard_normal(5) for k in (0, 1)]
    assert not np.any(draws[0] == draws[1])
    assert np.array_equal(draws[1], stream(same, noise_key(same), 1).standard_normal(5))
    assert not np.any(draws[0] == stream(cell | {"seed": 151}, noise_key(cell), 0).standard_normal(5))


def test_a_range_is_an_axis():
    sweep = made(
        axes={
            "simulation.simulated": ["viscous"],
            "simulation.snr": {"from": 5, "to": 500, "steps": 3, "spacing": "log"},
        }
    )
    assert sweep.axes[1].values == (5.0, 50.0, 500.0)
    even = made(
        axes={"simulation.simulated": ["viscous"], "simulation.snr": {"from": 10, "to": 20, "steps": 3}}
    )
    assert even.axes[1].values == (10.0, 15.0, 20.0)
    told = refused(axes={"simulation.simulated": ["viscous"], "simulation.snr": {"from": 5, "to": 500}})
    assert "steps" in str(told)
    assert (
        "both ends above 0"
        in refused(axes={"simulation.snr": {"from": 0, "to": 5, "steps": 3, "spacing": "log"}}).expected
    )


def test_keys_that_change_together_are_one_axis():
    axes = {
        "simulation.simulated": ["viscous"],
        "simulation.release_angle_deg, simulation.duration_s": [[5, 20], [40, 5]],
    }
    sweep = made(axes=axes)
    assert sweep.shape == (1, 2) and sweep.keys[1:] == (
        "simulation.release_angle_deg",
        "simulation.duration_s",
    )
    cells = [sweep.cell(values) for values in sweep]
    assert [(cell["simulation.release_angle_deg"], cell["simulation.duration_s"]) for cell in cells] == [
        (5, 20),
        (40, 5),
    ]
    alone = made(
        axes={
            "simulation.simulated": ["viscous"],
            "simulation.release_angle_deg": [5],
            "simulation.duration_s": [20],
        }
    )
    assert cell_key("identification", cells[0]) == cell_key("identification", alone.cell(next(iter(alone))))
    assert "2 values" in refused(axes=axes | {"simulation.snr, simulation.noise": [[5]]}).expected
    assert "179" not in str(
        refused(axes={"simulation.release_angle_deg, simulation.duration_s": [[500, 1]]}).mend
    )


def test_a_parameter_without_a_key_of_its_own_can_be_an_axis_and_a_wrong_one_is_told():
    sweep = made(axes={"simulation.simulated": ["constant_coulomb"], "parameters.constant_friction": [0.1, 0.2]},
                 settings={"simulation.fitted": ["viscous", "constant_coulomb"]})  # fmt: skip
    assert sweep.axes[1].dim == "constant_friction" and sweep.axes[1].units == "rad/s^2"
    assert "parameters.constant_friction" in refused(axes={"parameters.constant_fricton": [1]}).mend


def test_a_key_that_came_later_changes_no_cell_that_was_computed_before_it():
    cell = made(computes="detection", axes={"detection.effect": ["detent"]}).cell((["detent"],))
    before = {key: value for key, value in cell.items() if key not in ("detection.noise", "detection.snr")}
    assert cell_key("detection", cell) == cell_key("detection", before)
    assert cell_key("detection", cell | {"detection.snr": 40.0}) != cell_key("detection", before)


def test_a_measured_pendulum_is_the_one_that_is_simulated(tmp_path):
    folder = tmp_path / "mine"
    for name, friction in (("first", 0.001), ("last", 0.002)):
        (folder / name).mkdir(parents=True)
        values = {"natural_frequency": 6.5, "viscous_ratio": 0.01, "load_friction": friction}
        write_model(Model("viscous+load_coulomb", values), folder / f"{name}/model.yaml")
    (folder / "verdict.json").write_text('{"noise_rms_rad": 0.0007}')
    sweep = made(
        computes="detection",
        axes={"detection.size": [1]},
        pendulum=str(folder),
        settings={"simulation.viscous_ratio": 0.03},
    )
    cell = sweep.cell(next(iter(sweep)))
    assert cell["simulation.natural_frequency"] == 6.5 and cell["simulation.load_friction"] == 0.002
    assert cell["simulation.viscous_ratio"] == 0.03  # what the settings say goes before
    assert cell["discovery.base"] == ["viscous", "load_coulomb"] and cell["detection.noise_rad"] == 0.0007
    known = made(axes={"simulation.snr": [10]}, pendulum=str(folder / "first/model.yaml"))
    assert (
        known.settings["simulation.simulated"] == ["viscous+load_coulomb"]
        and known.settings["simulation.load_friction"] == 0.001
    )
    assert "snakemake discover" in refused(pendulum=str(tmp_path / "none")).mend


def test_a_model_of_a_rate_is_no_pendulum_of_a_sweep(tmp_path):
    """Its sensor's zero is in rad/s, and sweeps simulate angles."""
    from swingdown.pendulum.model import Model
    from swingdown.pendulum.model_file import write_model
    from swingdown.sweep.measured import of_pendulum

    file = write_model(Model("viscous", {"natural_frequency": 7.0, "viscous_ratio": 0.01}).of("rate"), tmp_path / "model.yaml")  # fmt: skip
    with pytest.raises(InputError, match="angular rate"):
        of_pendulum({"pendulum": str(file), "computes": "detection"}, "config, key sweeps")


def test_a_parameter_has_its_own_key_or_that_of_the_simulation():
    settings = {"simulation.viscous_ratio": 0.01, "parameters.detent_order": 3.0}
    assert value_of(settings, "viscous_ratio") == 0.01 and value_of(settings, "detent_order") == 3.0
