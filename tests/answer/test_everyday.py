"""First answers on pendulums whose law of damping is none of the paper's, or cannot be told."""

import numpy as np
import pytest

import swingdown
from swingdown.engine.trajectory import TrajectoryError, simulate
from swingdown.errors import InputError
from swingdown.fitting.uncertainty import uncertainty
from swingdown.pendulum.model import PAPER_MODELS, Model
from swingdown.studies import experiment, fit_rows
from swingdown.studies.quantities import quantities

TIMES = np.arange(1500) / 50  # s
OTHERS = {
    "power_law_drag": {"power_law_coefficient": 0.04, "power_law_exponent": 1.5},
    "structural_damping": {"structural_coefficient": 0.2},
    "viscous+presliding": {"viscous_ratio": 0.003, "presliding_friction": 0.02, "presliding_angle": 0.02},
}


def swing(label, values, noise=1e-3, seed=11, times=TIMES):
    """The model and a swing of it, with white noise (rad)."""
    model = Model(label, {"natural_frequency": 6.0} | values)
    draws = np.random.default_rng(seed).standard_normal(times.size)
    return model, simulate(model, times, 0.5) + noise * draws


def off(answer, model):
    """How far period, quality and decay time are from the truth, in standard uncertainties."""
    right = quantities(model, answer.row["amplitude_rad"])
    told = answer.quantities
    return {
        name: abs(told[name].value - right[name].value) / told[name].u
        for name in ("period", "quality", "decay_time")
    }


@pytest.mark.parametrize("label", OTHERS)
def test_a_law_that_the_paper_has_not_is_named_and_its_values_hold_the_truth(label):
    model, angle = swing(label, OTHERS[label])
    answer = swingdown.fit(TIMES, angle, unit="rad")
    assert answer.label == label
    assert max(off(answer, model).values()) < 3
    paper_s = swingdown.fit(TIMES, angle, unit="rad", fitted=PAPER_MODELS)
    assert paper_s.row["residual_rad"] > answer.row["residual_rad"]
    if label == "power_law_drag":
        assert max(off(paper_s, model).values()) > 3


LIGHT = {"viscous_ratio": 0.004}
BESIDE_LIST = {
    "viscous+cubic_stiffness": LIGHT | {"cubic_stiffness": 0.8},
    "viscous+quadratic_stiffness": LIGHT | {"quadratic_stiffness": 0.2},
}


@pytest.mark.parametrize("label", BESIDE_LIST)
def test_a_law_that_no_list_has_costs_width_and_not_the_truth(label, monkeypatch):
    model, angle = swing(label, BESIDE_LIST[label])
    assert max(off(swingdown.fit(TIMES, angle, unit="rad"), model).values()) < 2.5
    monkeypatch.setattr(fit_rows, "uncertainty", lambda fit, swings, free: uncertainty(fit, swings))
    assert max(off(swingdown.fit(TIMES, angle, unit="rad"), model).values()) > 5


@pytest.mark.parametrize(
    "values", [{"viscous_ratio": 0.003}, {"viscous_ratio": 0.002, "load_friction": 3e-4}]
)
def test_where_a_law_of_the_list_holds_nothing_is_wider(values, monkeypatch):
    label = "+".join({"viscous_ratio": "viscous", "load_friction": "load_coulomb"}[name] for name in values)
    angles = [swing(label, values, seed=seed)[1] for seed in range(6)]

    def told():
        found = [swingdown.fit(TIMES, angle, unit="rad").quantities for angle in angles]
        return np.array([[one[name].u for name in ("period", "quality", "decay_time")] for one in found])

    wide = told()
    monkeypatch.setattr(fit_rows, "uncertainty", lambda fit, swings, free: uncertainty(fit, swings))
    assert np.exp(np.mean(np.log(wide / told()), axis=0)) == pytest.approx(1, abs=0.1)


def test_laws_that_cannot_be_told_apart_are_all_named():
    _, angle = swing("structural_damping", OTHERS["structural_damping"], 0.02)
    answer = swingdown.fit(TIMES, angle, unit="rad")
    stop = answer.sentence.partition(" stops it")[0]
    assert "viscous" in stop and " or " in stop and "structural" in stop
    assert set(answer.to_dict()["or_models"]) | {answer.label} >= {"viscous", "structural_damping"}


def test_a_decay_beyond_the_record_is_called_extrapolated():
    _, angle = swing("viscous", {"viscous_ratio": 0.003})
    held = swingdown.fit(TIMES, angle, unit="rad").to_dataframe()["holds"]["decay_time"]
    assert held.endswith("extrapolated: the record has 30 s")  # of a decay of 56 s
    _, angle = swing("viscous", {"viscous_ratio": 0.02})
    assert "extrapolated" not in swingdown.fit(TIMES, angle, unit="rad").to_dataframe()["holds"]["decay_time"]


def test_a_law_that_cannot_be_fitted_is_left_out(monkeypatch):
    real = experiment.fit_jointly

    def fit(model, *given, **options):
        if "presliding" in model.names:
            raise TrajectoryError("it stops")
        return real(model, *given, **options)

    model, angle = swing("viscous", {"viscous_ratio": 0.008})
    monkeypatch.setattr(experiment, "fit_jointly", fit)
    answer = swingdown.fit([TIMES, TIMES], [angle, -0.6 * angle], unit="rad")
    assert answer.label == "viscous" and max(off(answer, model).values()) < 3
    assert np.isnan(answer.fits["norm"].sel(fitted="viscous+presliding")).all()
    assert not answer.fits["converged"].sel(fitted="viscous+presliding").any()
    assert answer.laws()  # which begin where the first answers ended
    monkeypatch.setattr(experiment, "fit_jointly", lambda *_, **__: fit(Model("presliding")))
    with pytest.raises(InputError, match="no model of a pendulum follows"):
        swingdown.fit(TIMES, angle, unit="rad")
