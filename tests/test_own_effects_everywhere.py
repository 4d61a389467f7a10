"""An effect of a study's own, said once in the config, goes through every rule: fits, tables, figures, search, report."""

import json

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from scipy.integrate import solve_ivp

CONFIG = """\
recordings: sheet.csv
effects:
  five_teeth:
    torque: -k*sin(5*theta + phi)
    parameters:
      k: {unit: rad/s^2, typical: 0.2}
      phi: {unit: rad, start: [0.0, 0.8, 1.6, 2.4]}
simulation:
  simulated: [viscous]
  fitted: [viscous, viscous+five_teeth]
  realizations: 2
  duration_s: 3
experiment: {fitted: [viscous, viscous+five_teeth]}
discovery: {base: [viscous], rounds: 1}
"""
MODEL = "viscous+five_teeth"


@pytest.fixture(scope="module")
def study(snakemake, tmp_path_factory):
    """The folder of a run of such a study, whose pendulum has the own effect and no other."""
    folder, times = tmp_path_factory.mktemp("own"), np.arange(801) / 80
    rng = np.random.default_rng(8)

    def motion(_, state):
        angle, velocity = state
        return velocity, -(7.0**2) * np.sin(angle) - 0.14 * velocity - 0.3 * np.sin(5 * angle + 0.6)

    rows = ["recording,file"]
    for number, release in enumerate((0.35, -0.55, 0.8)):
        angle = solve_ivp(motion, (0, times[-1]), (release, 0.0), "DOP853", times, rtol=1e-10, atol=1e-12).y[
            0
        ]
        noisy = angle + 1e-3 * rng.standard_normal(times.size)
        table = pd.DataFrame({"time_s": times, "angle_rad": noisy})
        table.to_csv(folder / f"s{number}.csv", index=False)
        rows.append(f"s{number},s{number}.csv")
    (folder / "sheet.csv").write_text("\n".join([*rows, ""]))
    (folder / "mine.yaml").write_text(CONFIG)
    snakemake("--configfile", folder / "mine.yaml", directory=folder)
    return folder


@pytest.mark.slow("a whole study")
def test_it_is_fitted_tabled_found_and_told(study):
    results = study / "results"
    with xr.open_dataset(results / "experiment/norms.nc") as norms:
        assert (norms["norm"].sel(fitted=MODEL) < 0.5 * norms["norm"].sel(fitted="viscous")).all()
        unit = norms["parameter_unit"].sel(parameter="five_teeth_k")
        assert unit == "rad/s^2"
    with xr.open_dataset(results / "simulation/norms.nc") as norms:
        assert MODEL in norms["fitted"].values
    assert MODEL in set(pd.read_csv(results / "tables/table3.csv")["fitted"])
    values = pd.read_csv(results / "tables/parameters.csv").query("parameter == 'five_teeth_k'")["value"]
    assert values.to_numpy() == pytest.approx(0.3, abs=0.02)
    verdict = json.loads((results / "discovery/pendulum/verdict.json").read_text())
    assert [one["name"] for one in verdict["effects"]] == ["five_teeth"]
    assert "five teeth" in (results / "report.html").read_text()


@pytest.mark.slow("a whole study")
def test_another_formula_runs_every_rule_that_rests_on_it_and_no_other(study, snakemake):
    (study / "other.yaml").write_text(CONFIG.replace("sin(5*theta", "sin(6*theta"))
    done = snakemake(
        "--configfile", study / "other.yaml", "--dry-run", "--quiet", "rules", directory=study
    )  # fmt: skip
    rules = set(done.stdout.split("Job stats:")[1].split("total")[0].split())
    search = {"discover_search", "discover_verdict", "discover_figures"}
    assert {"fit_swing", "fit_campaign", "fit_simulated", "table2", "table3", "page", *search} <= rules
    assert not {"record", "angle", "simulate", "fig02", "fig09"} & rules


@pytest.mark.slow("a whole study")
def test_trials_do_not_hide_what_they_cannot_make(study, snakemake):
    (study / "trial.yaml").write_text(CONFIG + "hidden_effects: {effects: [five_teeth]}\n")
    done = snakemake(
        "hidden_effects", "--configfile", study / "trial.yaml", "--dry-run", directory=study, check=False
    )  # fmt: skip
    assert done.returncode != 0 and "does not know it" in done.stdout and "Traceback" not in done.stdout
