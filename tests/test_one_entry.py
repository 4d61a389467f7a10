"""Ten lines add an effect: an entry in a copy of the catalogue goes the whole way, and no other file is touched.

Simulation, fit, hidden trial, discovery, verdict and score, tables, figures and report each take the toy effect from its entry alone.
"""

import json

import numpy as np
import pandas as pd
import pytest
import xarray as xr

from swingdown.discovery.data.campaign import Swing, campaign
from swingdown.discovery.search import discover
from swingdown.discovery.tell import files
from swingdown.discovery.tell.verdict import verdict
from swingdown.engine.trajectory import simulate
from swingdown.errors import InputError
from swingdown.fitting.least_squares import fit_trajectory
from swingdown.pendulum.catalogue import SHIPPED
from swingdown.pendulum.effect import Contained, Effect, Parameter, StandIn
from swingdown.pendulum.model import Model
from swingdown.plots import discovery as drawn
from swingdown.plots import trials as trials_drawn
from swingdown.report import contents, page
from swingdown.sealed import read_json
from swingdown.studies.comparison import comparison
from swingdown.studies.experiment import fit_campaign, fit_recording
from swingdown.studies.norms import combine_recordings
from swingdown.studies.paper_tables import table3
from swingdown.studies.parameters import parameters
from swingdown_trials.find import find
from swingdown_trials.schedule import Planned, chunks, planned
from swingdown_trials.schedule import drawn as drawn_trial
from swingdown_trials.score import confusion, row, summarise
from swingdown_trials.trial import BASE, hideable, write_trial

TOY = Effect(
    "rolling_resistance",
    "-r*theta**2*sign(thetadot)",
    (Parameter("rolling_friction", "r", "rad/s^2", 0.0, np.inf, "friction at 1 rad, over inertia", 1.0),),
    "A ball that rolls in a groove takes more the further it leans.",
    "a toy",
    damping="3*loss*omega_n**2/(2*amplitude**2)",
    contains=(Contained("structural_damping", {}),),
    replaces=(StandIn("structural_damping", ({"rolling_friction": "2*h"},)),),
    told_apart={"structural_damping": "Release from twice the angle."},
    twin=lambda t, angle, velocity, way, values, duration: -values["rolling_friction"] * angle * angle * way,
)  # fmt: skip
CATALOGUE = SHIPPED.with_effects(TOY)
TRUTH = Model(
    "viscous+rolling_resistance",
    {"natural_frequency": 7.0, "viscous_ratio": 0.01, "rolling_friction": 1.2},
    catalogue=CATALOGUE,
)
TIMES = np.arange(1501) / 100


def noisy(number, release):
    """One swing of the toy pendulum (rad) with noise of 2 mrad."""
    rng = np.random.default_rng([4, number])
    return simulate(TRUTH, TIMES, release) + 2e-3 * rng.standard_normal(TIMES.size)


SWINGS = [noisy(number, release) for number, release in enumerate((0.9, -0.6, 0.3))]


def test_it_is_simulated_and_fitted():
    fit = fit_trajectory(TRUTH, TIMES, SWINGS[0])
    assert fit.converged and fit.rms == pytest.approx(2e-3, rel=0.1)
    error = fit.model.standard_errors["rolling_friction"]
    assert abs(fit.model.values["rolling_friction"] - 1.2) < 4 * error


@pytest.fixture(scope="module")
def states():
    swings = [Swing(f"swing {k}", TIMES, angle) for k, angle in enumerate(SWINGS)]
    one = campaign("toy", swings)
    return one, discover(one, Model("viscous", catalogue=CATALOGUE), rounds=2)


def test_it_is_discovered_and_told(states, tmp_path):
    one, found = states
    files.write_rounds(found, one, tmp_path, True)
    told = verdict(read_json(tmp_path / "rounds.json"), CATALOGUE)
    assert [entry["name"] for entry in told["effects"]] == ["rolling_resistance"]
    assert "Rolling resistance (friction 1." in told["sentence"]
    assert told["next_measurement"] in (None, "Release from twice the angle.")
    for name in ("residuals", "half_swings", "ranking"):
        assert ((tmp_path / "first") / {"residuals": "fit.nc"}.get(name, f"{name}.csv")).stat().st_size
    drawn.ranking(pd.read_csv((tmp_path / "first") / "ranking.csv"), told["moves"][0])
    drawn.gap(told)
    material = contents.Material({}, {}, [], {"sweeps": {}}, verdicts=[told])
    page.write(tmp_path / "report.html", [contents.findings(material)], contents.head(material))
    assert "Rolling resistance" in (tmp_path / "report.html").read_text()


def test_it_is_hidden_found_and_scored(tmp_path):
    assert "rolling_resistance" in hideable(CATALOGUE)
    settings = {"effects": [], "sizes": [2], "repeats": 1, "removed": False, "pairs": False, "foreign": False, "nulls": 0, "own_frequencies": 0, "calibrated": 0, "chunk": 5}  # fmt: skip
    one = next(p for p in planned(settings, CATALOGUE) if p.hidden == ("rolling_resistance",))
    trial = drawn_trial(99, one, CATALOGUE)
    rows, truth = write_trial(trial, 99, "c1", tmp_path, CATALOGUE)
    pd.DataFrame(rows).to_csv(tmp_path / "sheet.csv", index=False)
    found = find(tmp_path / "sheet.csv", Model(BASE, catalogue=CATALOGUE), 2)
    score = row("c1", json.loads(json.dumps(truth)), found["c1"], CATALOGUE)
    assert score["inside"], (score, found["c1"]["verdict"]["sentence"])
    table = pd.DataFrame([score])
    assert summarise(table).set_index("figure").loc["named exactly", "n"] == 1
    assert "rolling_resistance" in confusion(table, CATALOGUE).index
    trials_drawn.confusion(confusion(table, CATALOGUE).reset_index())


def test_trials_refuse_what_the_second_pendulum_does_not_know():
    """Left out in silence it would be looked for in vain, and count against the search."""
    mute = SHIPPED.with_effects(Effect("mute", TOY.term, TOY.parameters, "A.", "a toy"))
    settings = {"effects": ["mute"], "sizes": [2], "repeats": 1, "removed": False, "pairs": False, "foreign": False, "nulls": 0, "own_frequencies": 0, "calibrated": 0, "chunk": 5}  # fmt: skip
    with pytest.raises(InputError, match="second pendulum.*does not know"):
        chunks(settings, mute)
    with pytest.raises(InputError, match="second pendulum.*does not know"):
        drawn_trial(1, Planned("single", ("mute",), 2.0, "white", 0), mute)
    assert "mute" not in hideable(mute)


def test_it_stands_in_the_tables():
    labels = ("viscous", "viscous+rolling_resistance")
    family = [Model(label, catalogue=CATALOGUE) for label in labels]
    angles = [
        xr.Dataset({"angle": ("time", series, {"units": "rad"})}, {"time": TIMES}, {"recording": f"s{k}", "campaign": "toy"})
        for k, series in enumerate(SWINGS)
    ]  # fmt: skip
    norms = combine_recordings([fit_recording(angle, family) for angle in angles])
    assert norms["parameter_unit"].sel(parameter="rolling_friction") == "rad/s^2"
    published = pd.DataFrame({"fitted": ["viscous"], "mean_degrees": [1.0], "std_degrees": [0.1]})
    table = table3(norms, published)
    assert set(labels) <= set(table["fitted"])
    assert "viscous+rolling_resistance" in set(comparison(norms)[["model_a", "model_b"]].to_numpy().ravel())
    told = parameters(norms, [fit_campaign(angles, family)])
    assert "rolling_friction" in set(told["parameter"])
