"""The table of pendulums: the model that describes each, its quantities, the verdict, and why one has none."""

import numpy as np
import pandas as pd
import pytest
import xarray as xr

import swingdown
from swingdown.engine.trajectory import simulate
from swingdown.measurement.angle import UNSCALED
from swingdown.pendulum.model import Model
from swingdown.studies.described import described_by, rivals, weights
from swingdown.studies.experiment import fit_campaign, fit_recording
from swingdown.studies.norms import combine_recordings
from swingdown.studies.pendulums import (
    NOT_DYING,
    _foretold,
    _with_period,
    by_verdict,
    cells_of,
    pendulums,
    quantities_of,
    residual_of,
)
from swingdown.studies.quantities import Quantity, quantities
from swingdown.studies.words import short

FITTED = ["viscous", "load_coulomb", "viscous+load_coulomb"]
TIMES = np.arange(1001) / 100


def swing(name, campaign, angle, seed, **values):
    model = Model("+".join(label for label, key in (("viscous", "viscous_ratio"), ("load_coulomb", "load_friction")) if key in values),
                  {"natural_frequency": 7.0, **values})  # fmt: skip
    series = simulate(model, TIMES, angle) + 0.002 * np.random.default_rng(seed).standard_normal(TIMES.size)
    about = {"recording": name, "campaign": campaign, "emulated": "no"}
    return xr.Dataset({"angle": ("time", series, {"units": "rad"})}, {"time": TIMES}, about)


@pytest.fixture(scope="module")
def study():
    """Norms of a pendulum z of two swings and a pendulum a of one, in that order, and the joint fit of the first."""
    swings = [
        swing("z1", "z", 0.3, 1, viscous_ratio=0.006, load_friction=0.003),
        swing("z2", "z", 0.2, 2, viscous_ratio=0.006, load_friction=0.003),
        swing("a1", "a", 0.3, 3, viscous_ratio=0.01),
    ]
    return combine_recordings([fit_recording(one, FITTED) for one in swings]), fit_campaign(
        swings[:2], FITTED
    )


def test_a_row_for_each_recording_and_for_all_of_one_pendulum_in_the_sheets_order(study):
    norms, joint = study
    table = pendulums(norms, [joint])
    assert list(table["recording"]) == ["z1", "z2", "(joint)", "a1"]
    assert list(table["model"]) == [FITTED[2]] * 3 + ["viscous"]
    together = table.iloc[2]
    assert together["viscous_ratio_u"] < table.iloc[0]["viscous_ratio_u"]
    assert together["amplitude_rad"] == pytest.approx(0.3, abs=0.002)


@pytest.mark.parametrize(
    ("narrowing", "model"), [(1.0, NOT_DYING), (0.97, NOT_DYING), (0.85, "viscous"), (np.nan, "viscous")]
)
def test_a_quality_that_the_turning_points_deny_is_none(study, narrowing, model):
    """A swing that a motor keeps up, fitted by laws of which one gives what another takes: its Q would be theirs alone."""
    norms = study[0].assign(narrowing=narrowing + 0 * study[0]["narrowing"])
    row = pendulums(norms).set_index("recording").loc["a1"]
    assert row["model"] == model
    assert bool(np.isfinite(row.get("quality", np.nan))) == (model == "viscous")
    assert row["period"] == pytest.approx(0.9, abs=0.01) if "period" in row else row["period_s"] > 0


def test_what_was_read_once_more_says_so_of_its_own_row_alone(study):
    norms, joint = study
    norms = norms.assign_coords(again=("recording", ["", "its longest free stretch is used", ""]))
    remarks = dict(zip(*(pendulums(norms, [joint])[key] for key in ("recording", "remark")), strict=True))
    assert "its longest free stretch is used" in remarks["z2"]
    assert not any("stretch" in remarks[name] for name in ("z1", "(joint)", "a1"))


def test_of_a_searchs_model_no_quantity_of_damping_is_left():
    row = {
        "model": "viscous", "share_left": 0.3, "or_model": "", "remark": "", "amplitude_rad": 0.4, "campaign": "a", "recording": "a1", "residual_rad": 0.01,
        "period_s": 0.87, "period_s_u": 0.1, "period_s_text": "0.87(10)", "decay_time_s": 9.0, "decay_time_s_u": 1.0, "decay_time_s_text": "9.0(10)",
    }  # fmt: skip
    quantities = {"period": {"value": 0.88, "standard_uncertainty": 0.01, "unit": "s"}}
    concluded = {
        "quantities": quantities,
        "amplitude_rad": 0.41,
        "model": "viscous+presliding",
        "residual": 0.002,
    }
    found = by_verdict(row, {"status": "named", "conclusion": concluded})
    assert (
        found["period_s_text"] == "0.880(10)" and found["campaign"] == "a" and found["residual_rad"] == 0.002
    )
    assert not [key for key in found if key.startswith("decay") or key in ("share_left", "or_model")]


def test_a_file_that_nobody_looked_at_is_no_pendulum_and_a_refused_one_is(study):
    norms, joint = study
    row = {
        "campaign": "b",
        "recording": "b",
        "label": "b",
        "file": "b.csv",
        "problem": "not looked at: it is odd",
    }
    for code, there in (("", True), ("not looked at", False)):
        table = pendulums(norms, [joint], left_out=pd.DataFrame([row | {"code": code}]))
        assert ("b" in set(table["recording"])) is there


def test_the_quantities_are_the_truths_within_their_uncertainties_and_come_back_from_the_row(study, tmp_path):
    norms, joint = study
    pendulums(norms, [joint]).to_csv(tmp_path / "table.csv", index=False)
    row = pd.read_csv(tmp_path / "table.csv").iloc[2].to_dict()
    truth = Model(FITTED[2], {"natural_frequency": 7.0, "viscous_ratio": 0.006, "load_friction": 0.003})
    expected, found = quantities(truth, row["amplitude_rad"]), quantities_of(row)
    assert set(found) == set(expected)
    for name, (value, error, unit) in found.items():
        assert unit == expected[name].unit
        assert abs(value - expected[name].value) < 4 * error, name
    assert row["period_s_text"].startswith(f"{row['period_s']:.3f}")


def test_a_model_with_a_damper_that_gives_energy_describes_nothing_where_another_does(study):
    norms, _ = study
    one = norms.sel(recording=["a1"]).copy(deep=True)
    assert described_by(one) == "viscous"
    one["value"].loc[{"fitted": "viscous", "parameter": "viscous_ratio"}] = -0.01
    assert described_by(one) != "viscous"


def test_a_model_that_ran_away_describes_nothing_where_another_does(study):
    norms, _ = study
    one = norms.sel(recording=["a1"]).copy(deep=True)
    one["standard_error"].loc[{"fitted": "viscous"}] = np.nan
    assert described_by(one) != "viscous"
    one["standard_error"].loc[{}] = np.nan
    assert described_by(one) == "viscous"


def test_a_model_whose_frequency_is_not_told_describes_nothing(study):
    """A friction that winds up over many turns is a spring, and takes the weight's place."""
    one = study[0].sel(recording=["z1"]).copy(deep=True)
    best = described_by(one)
    at = {"fitted": best, "parameter": "natural_frequency"}
    one["standard_error"].loc[at] = 1.1 * one["value"].loc[at]
    assert described_by(one) != best and best not in weights(one)


def test_a_law_of_a_shape_that_it_cannot_have_describes_nothing():
    """A drag by the 25th power of the speed fits a few large swings, and stops those that are a little larger at once."""
    times = np.arange(1500) / 50
    swing = np.radians(20) * np.exp(-0.02 * times) * np.cos(4 * times)
    noise = np.random.default_rng(4).normal(0, 2e-3, times.size)
    found = swingdown.fit(times, swing + noise, unit="rad", restoring="linear")
    one = found.fits.copy(deep=True)
    one["norm"].loc[{"fitted": "power_law_drag"}] = 0.9 * float(one["norm"].min())
    assert described_by(one) == "power_law_drag"
    one["value"].loc[{"fitted": "power_law_drag", "parameter": "power_law_exponent"}] = 25.0
    assert described_by(one) != "power_law_drag" and "power_law_drag" not in weights(one)


def test_a_model_ran_away_if_it_needs_an_effect_whose_size_is_not_told(study):
    norms, _ = study
    one = norms.sel(recording=["z1"]).copy(deep=True)
    at = {"fitted": FITTED[2], "parameter": "load_friction"}
    assert described_by(one) == FITTED[2]
    one["standard_error"].loc[at] = 2 * one["value"].loc[at]
    assert described_by(one) != FITTED[2] and FITTED[2] not in weights(one)
    for label in FITTED:  # now it does not need it
        one["norm"].loc[{"fitted": label}] = one["norm"].sel(fitted=FITTED[2])
    assert FITTED[2] in weights(one)


def test_a_model_that_fits_as_well_is_a_rival_and_a_worse_one_is_none(study):
    norms, _ = study
    one = norms.sel(recording=["a1"]).copy(deep=True)
    assert rivals(one, "viscous") == []
    one["norm"].loc[{"fitted": "load_coulomb"}] = one["norm"].sel(fitted="viscous")
    assert rivals(one, "viscous") == ["load_coulomb"]


def test_of_two_recordings_that_two_models_fit_alike_one_is_told(study):
    norms, _ = study
    two = norms.sel(recording=["z1", "z2"]).copy(deep=True)
    for label in ("viscous", "load_coulomb"):
        two["norm"].loc[{"fitted": label}] = two["norm"].sel(fitted="viscous+load_coulomb")
    assert described_by(two) in ("viscous", "load_coulomb")


def test_a_spring_that_softens_is_a_model_like_another():
    truth = Model(
        "viscous+cubic_stiffness", {"natural_frequency": 7.0, "viscous_ratio": 0.01, "cubic_stiffness": -8.0}
    )
    series = simulate(truth, TIMES, 0.5) + 0.002 * np.random.default_rng(4).standard_normal(TIMES.size)
    about = {"recording": "s", "campaign": "s", "emulated": "no"}
    angle = xr.Dataset({"angle": ("time", series, {"units": "rad"})}, {"time": TIMES}, about)
    norms = combine_recordings([fit_recording(angle, ["viscous", "viscous+cubic_stiffness"])])
    assert described_by(norms) == "viscous+cubic_stiffness"


def test_the_verdict_and_what_is_left_out_stand_in_the_table(study):
    norms, joint = study
    effects = [
        {"name": "presliding", "tied_with": []},
        {"name": "sensor_zero", "tied_with": ["constant_torque"]},
    ]
    verdicts = [{"campaign": "z", "status": "ambiguous", "effects": effects}]
    out = pd.DataFrame(
        {
            "campaign": ["a1", "b"],
            "recording": ["a1", "b"],
            "file": ["a.csv", "b.csv"],
            "problem": ["5 half-swings", "no number"],
        }
    )
    table = pendulums(norms, [joint], verdicts, out).set_index("recording")
    assert list(table["verdict"]) == ["ambiguous"] * 3 + ["", "refused"]
    assert table.loc["z1", "missing"] == "presliding; sensor_zero or constant_torque"
    assert table.loc["a1", "remark"] == "5 half-swings"
    assert table.loc["b", "remark"] == "b.csv: no number" and np.isnan(table.loc["b", "period_s"])


def test_the_quality_of_a_swing_whose_law_nobody_knows_is_as_sure_as_it_is_said_to_be():
    """Three laws at once, each too small to be told beside the others: 24 swings, of which 95 % should hold the truth."""
    draws, held, times = np.random.default_rng(17), [], np.arange(0, 20, 0.02)
    for _ in range(24):
        values = {
            "natural_frequency": draws.uniform(4, 7),
            "viscous_ratio": draws.uniform(1e-3, 6e-3),
            "quadratic_coefficient": draws.uniform(1e-3, 6e-3),
            "load_friction": draws.uniform(5e-5, 4e-4),
        }
        model = Model("viscous+quadratic_drag+load_coulomb", values)
        angle = simulate(model, times, draws.uniform(0.2, 0.6)) + 2e-3 * draws.standard_normal(times.size)
        answer = swingdown.fit(times, angle, unit="rad")
        right = quantities(model, float(answer.table["amplitude_rad"].iloc[0]))["quality"].value
        value, u, _ = answer.quantities["quality"]
        held.append(abs(value - right) < 1.96 * u)
    assert sum(held) >= 21


def test_readings_without_a_scale_have_the_period_of_their_first_swings(study):
    (own,) = (one for name, one in study[0].groupby("recording") if name == "a1")
    unscaled = own.assign(uncertainty=("recording", [UNSCALED]), period_change=("recording", [np.nan]))
    row = pendulums(unscaled).iloc[0]
    assert row["amplitude_text"] == "the first swings" and np.isnan(row["amplitude_rad"])
    assert row["period_s"] == pytest.approx(2 * np.pi / 7.0 * 1.0056, abs=0.003)
    assert not np.isfinite(row.get("last_period_s", np.nan))


@pytest.mark.parametrize("status", ["named", "partial"])
def test_a_verdict_alone_has_its_period_and_quality(status):
    """As a figure of one verdict writes them above its trace, beside no row of a first answer."""
    quantities = {
        "period": {"value": 0.8725, "standard_uncertainty": 0.0003, "unit": "s"},
        "quality": {"value": 59.8, "standard_uncertainty": 0.7, "unit": "1"},
    }
    conclusion = {"quantities": quantities, "amplitude_rad": 0.3, "model": "viscous", "residual": 1e-3}
    assert short({}, {"status": status, "conclusion": conclusion}) == "T = 0.87250(30) s, Q = 59.80(70)"


def test_what_the_search_sees_going_on_has_no_loss_in_the_first_answer():
    """One law gives what another takes, and their quality of 800 000 is above three standard errors."""
    row = {
        "campaign": "a",
        "recording": "a",
        "model": "viscous+load_coulomb",
        "or_model": "",
        "model_probability": 0.5,
    }
    row |= cells_of("period", Quantity(6.3, 0.08, "s")) | cells_of("quality", Quantity(8e5, 2.5e5, "1"))
    verdict = {"status": "unknown", "conclusion": None}
    assert by_verdict(row, verdict) == row
    told = by_verdict(row, verdict | {"dies_away": False})
    assert told["model"] == NOT_DYING and told["period_s_text"] == row["period_s_text"]
    assert not [column for column in told if column.startswith(("quality", "or_model"))]


def test_where_the_passages_tell_the_period_the_frequency_of_small_swings_follows():
    """Its share of doubt is that of the period, and twice that of the amplitude in what a wide swing takes longer."""
    derived = {"period": Quantity(1.0, 0.1, "s"), "natural_frequency": Quantity(6.0, 0.1, "rad/s"), "quality": Quantity(50.0, 1.0, "1")}  # fmt: skip
    told = _with_period(derived, Quantity(1.05, 0.002, "s"), 1.05, 0.2)
    assert told["period"] == Quantity(1.05, 0.002, "s") and told["quality"] == derived["quality"]
    frequency = told["natural_frequency"]
    assert frequency.value == pytest.approx(2 * np.pi)
    # by differences: the period longer, the amplitude a fifth wider
    off = 1 - 1.05 / 1.052, (1.05 - 1) * (1.2**2 - 0.8**2) / 2 / 1.05
    assert frequency.uncertainty == pytest.approx(2 * np.pi * np.hypot(*off), rel=0.01)
    assert list(_with_period({}, Quantity(1.05, 0.002, "s"), 1.05, 0.2)) == ["period"]


def test_a_quality_foretells_how_much_narrower_the_last_third_swings():
    known = cells_of("quality", Quantity(50.0, 1.0, "1")) | cells_of("period", Quantity(1.2, 0.1, "s"))
    fallen = np.exp(
        -np.pi * np.array([0.0, 20.0]) / 1.2 / 50.0
    )  # from the first third's middle to the last's
    assert _foretold(known | {"record_s": 30.0}) == pytest.approx(fallen[1] / fallen[0])
    assert _foretold({"record_s": 30.0}) == 1.0
    assert _foretold(known | {"record_s": 30.0} | cells_of("quality", Quantity(-5.0, 1.0, "1"))) == 1.0


def test_what_a_model_leaves_is_told_in_the_unit_of_its_reading():
    assert residual_of({"residual_rad": 0.01}) == (0.01, "rad")
    assert residual_of({"residual_rad": 0.01, "own_unit": "mm"}) == (0.01, "mm")
    assert residual_of({"residual_rad": 0.01, "own_unit": np.nan}) == (0.01, "rad")
    assert residual_of({"residual_rad": np.nan, "residual_rad_per_s": 0.2}) == (0.2, "rad/s")


@pytest.mark.parametrize(("zero", "told"), [(0.04, True), (-0.04, True), (0.02, False)])
def test_where_a_pendulum_hangs_is_told_where_that_is_surely_not_nothing(study, zero, told):
    norms = study[0].assign(zero=zero + 0 * study[0]["norm"], zero_u=0.01 + 0 * study[0]["norm"])
    row = pendulums(norms).set_index("recording").loc["a1"]
    known = quantities_of(row.to_dict())
    assert ("sensor_zero" in known) == told
    if told:
        assert known["sensor_zero"] == Quantity(zero, 0.01, "rad")
    assert "sensor_zero" not in quantities_of(pendulums(study[0]).set_index("recording").loc["a1"].to_dict())


def test_of_several_recordings_the_joint_row_has_the_model_that_the_search_ended_with(study):
    """Of a pendulum of one recording its own has it; a recording that was left out counts for none."""
    norms, joint = study
    quantities_found = {"period": {"value": 0.88, "standard_uncertainty": 0.01, "unit": "s"}}
    concluded = {"model": "viscous+eddy_brake", "amplitude_rad": 0.25, "residual": 0.002, "quantities": quantities_found}  # fmt: skip
    verdicts = [{"campaign": name, "status": "identified", "conclusion": concluded, "effects": [{"name": "eddy_brake", "tied_with": ["magnet"]}]} for name in "za"]  # fmt: skip
    table = pendulums(norms, [joint], verdicts).set_index("recording")
    assert list(table["model_of"]) == ["damping", "damping", "search", "search"]
    assert table.loc["(joint)", "period_s"] == table.loc["a1", "period_s"] == 0.88
    assert table.loc["(joint)", "amplitude_rad"] == 0.25 and table.loc["z1", "amplitude_rad"] != 0.25
    assert set(table["missing"]) == {"eddy_brake or magnet"} and set(table["verdict"]) == {"identified"}
