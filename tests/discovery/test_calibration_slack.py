"""A sensor effect is named only beyond what the calibration leaves open, and what it leaves open is no missing effect."""

from types import SimpleNamespace

import numpy as np
import pytest

from swingdown.discovery.criterion import USUAL
from swingdown.discovery.data.campaign import Swing, campaign
from swingdown.discovery.data.noise import Noise
from swingdown.discovery.judge import findings
from swingdown.discovery.search import discover
from swingdown.discovery.tell import files
from swingdown.discovery.tell.verdict import verdict
from swingdown.engine.trajectory import simulate
from swingdown.pendulum.model import Model
from swingdown.pendulum.slack import reading_slack
from swingdown.sealed import read_json

TIMES = np.arange(0, 15, 0.02)
BASE = Model(
    "viscous+constant_coulomb", {"natural_frequency": 7.0, "viscous_ratio": 0.006, "constant_friction": 0.05}
)
DEVIATION = 0.004  # standard uncertainty of the sensitivity
ALLOWED = ["quadratic_drag", "sensor_gain", "presliding", "cubic_stiffness"]


def seen(gain, slack, folder, amplitudes=(0.25, 0.4, 0.55, 0.7)):
    """The verdict on swings that a sensor of this gain error read."""
    rng = np.random.default_rng(12)
    swings = [
        Swing(
            f"s{k}",
            TIMES,
            (1 + gain) * simulate(BASE, TIMES, amplitude) + 5e-4 * rng.standard_normal(TIMES.size),
        )
        for k, amplitude in enumerate(amplitudes)
    ]
    made = campaign("bench", swings)
    known = type(made)(made.name, made.fit, made.holdout, made.how, systematic=DEVIATION * 0.7, slack=slack)
    files.write_rounds(discover(known, BASE, allowed=ALLOWED), known, folder, False)
    return verdict(read_json(folder / "rounds.json"))


@pytest.fixture
def slack():
    return reading_slack({"sensor_gain": {"length": DEVIATION}})


def test_what_the_calibration_leaves_open_is_not_missing(slack, tmp_path):
    found = seen(1.5 * DEVIATION, slack, tmp_path)
    assert found["status"] == "consistent" and found["effects"] == []
    assert "within the calibration's uncertainty" in found["sentence"]
    gain = found["nuisance"]["sensor_gain"]
    assert gain["value"] == pytest.approx(1.5 * DEVIATION, abs=3 * gain["standard_error"])
    assert gain["before"] == DEVIATION
    assert "sensor_gain" not in found["model"]


def test_the_same_error_is_missing_where_nothing_is_open(slack, tmp_path):
    found = seen(1.5 * DEVIATION, type(slack)(), tmp_path)
    assert [one["name"] for one in found["effects"]] == ["sensor_gain"]


def test_a_gain_far_beyond_the_slack_is_named(slack, tmp_path):
    found = seen(12 * DEVIATION, slack, tmp_path)
    assert found["status"] == "named"
    assert [one["name"] for one in found["effects"]] == ["sensor_gain"]
    gain = found["effects"][0]["parameters"]["sensor_gain"]
    assert gain["value"] == pytest.approx(12 * DEVIATION, abs=3 * gain["standard_error"])


@pytest.mark.parametrize(("with_it", "left"), [(0.9, 0.0), (3.8, np.inf)])
def test_what_held_out_swings_need_not_confirm_they_may_refute(with_it, left):
    """Without the effect they leave less than the noise."""

    def structure(rms, share):
        model = SimpleNamespace(slack=SimpleNamespace(names=("sensor_zero",)))
        return SimpleNamespace(fit=SimpleNamespace(rms=rms, n=300, model=model), left=lambda noise: share)

    pool = SimpleNamespace(criterion=USUAL, noise=Noise(1.0), held_out=lambda fit: fit)
    assert findings._whole(pool, structure(with_it, 0.1), structure(0.95, 1.0))[1] == left
