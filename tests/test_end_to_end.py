"""The whole study, small: everything appears, again nothing is done, and the numbers do not depend on the cores."""

import json
import subprocess
import sys
from pathlib import Path

import pandas as pd
import pint
import pytest
import xarray as xr

NUMBERS = (
    "results/simulation/norms.nc",
    "results/experiment/norms.nc",
    "results/calibration/calibration.nc",
    "results/angles/swing_01.nc",
)
TABLES = ("table2", "table3", "comparison", "parameters", "uncertainty_budget")


def test_every_table_figure_and_the_report_are_there(small_study):
    for table in TABLES:
        assert len(pd.read_csv(small_study / f"results/tables/{table}.csv")) > 1
    for number in range(1, 16):
        for ending in ("svg", "png"):
            assert (small_study / f"results/figures/fig{number:02d}.{ending}").stat().st_size > 2000
    assert (small_study / "results/report.html").stat().st_size > 100_000
    assert not list((small_study / "results").rglob("*.part"))


def test_every_number_has_a_unit(small_study):
    for path in (small_study / "results").rglob("*.nc"):
        with xr.open_dataset(path, decode_timedelta=False) as data:
            for name, variable in data.variables.items():
                assert variable.dtype.kind != "f" or variable.attrs.get("units"), f"{path.name}: {name}"


def test_every_file_keeps_the_cf_conventions(small_study):
    """But for the elapsed time in plain seconds, which the Conventions' time axis, a date, cannot be."""
    known = pint.UnitRegistry()
    for path in (small_study / "results").rglob("*.nc"):
        with xr.open_dataset(path, decode_timedelta=False) as data:
            assert all(data.attrs.get(key) for key in ("title", "history", "source", "Conventions")), (
                path.name
            )
            for name, variable in data.variables.items():
                where = f"{path.name}: {name}"
                assert variable.attrs.get("long_name"), where
                assert variable.dtype != "int64", where
                if "units" in variable.attrs:
                    known.parse_units(variable.attrs["units"].replace("-1", "**-1"))
                linked = variable.attrs.get("ancillary_variables", "").split()
                assert set(linked) <= set(data.variables), where


KINDS = ("recordings/swing_01", "angles/swing_01", "calibration/calibration", "simulation/norms", "experiment/fits/swing_01",
         "experiment/joint/bench", "experiment/norms")  # fmt: skip


@pytest.mark.slow("a checker that starts slowly")
def test_the_compliance_checker_finds_nothing_but_the_name_of_elapsed_time(small_study, tmp_path):
    """It takes whatever is called ``time`` for a date; ours are seconds, and say so."""
    told = [tmp_path / f"{k}.json" for k in range(len(KINDS))]
    command = [Path(sys.executable).with_name("compliance-checker"), "--test=cf:1.11", "--format=json"]
    asked = [f"--output={path}" for path in told] + [small_study / f"results/{kind}.nc" for kind in KINDS]
    subprocess.run([*command, *asked], capture_output=True, timeout=300)
    allowed = {"Coordinate variable 'time' should have standard_name='time', found: 'None'"}
    for kind, path in zip(KINDS, told, strict=True):
        found = json.loads(path.read_text())["cf:1.11"]
        said = {text for one in found["all_priorities"] for text in one["msgs"]}
        assert {text for text in said if "shares the same name" not in text} <= allowed, kind


def test_what_comes_from_the_bench_says_that_it_is_emulated(small_study):
    for path in ("recordings/swing_01", "angles/swing_01", "calibration/calibration", "experiment/norms"):
        assert xr.open_dataset(small_study / f"results/{path}.nc").attrs["emulated"] == "yes", path
    assert xr.open_dataset(small_study / "results/simulation/norms.nc").attrs["emulated"] == "no"


def test_a_second_run_has_nothing_to_do(small_study, snakemake):
    done = snakemake("--configfile", small_study / "small.yaml", directory=small_study)
    assert "Nothing to do" in done.stdout


def test_another_setting_runs_only_what_rests_on_it(small_study, snakemake):
    done = snakemake(
        "--configfile",
        small_study / "small.yaml",
        "--dry-run",
        "--quiet",
        "rules",
        "--config",
        "experiment={start: rest}",
        directory=small_study,
    )
    rules = set(done.stdout.split("Job stats:")[1].split("total")[0].split())
    assert {"fit_swing", "fit_campaign", "table3", "page", "manifest", "fig15"} <= rules
    assert not {"record", "angle", "calibrate", "simulate", "fit_simulated", "fig02", "fig09"} & rules


@pytest.mark.slow("a whole study")
def test_cores_order_folder_and_locale_change_no_byte(small_study, snakemake, tmp_path):
    """One core for two, what comes last made first, in another folder, for a Turk in Calcutta."""
    folder = tmp_path / "Bank für Pendel"
    folder.mkdir()
    for name in ("small.csv", "small.yaml"):
        (folder / name).write_text((small_study / name).read_text())
    other = {"LC_ALL": "tr_TR.UTF-8", "LANG": "tr_TR.UTF-8", "TZ": "Asia/Kolkata", "PYTHONHASHSEED": "7"}
    tables = [f"results/tables/{name}.csv" for name in TABLES]
    figures = [
        f"results/figures/fig{number:02d}.{ending}" for number in (2, 3, 9, 13) for ending in ("svg", "png")
    ]
    first = ["--prioritize", "results/simulation/norms.nc", "--"]
    snakemake(
        "--configfile", folder / "small.yaml", *first, *NUMBERS, *tables, *figures, "results/report.html",
        directory=folder, cores=1, environment=other,
    )  # fmt: skip
    for path in NUMBERS:
        one, two = xr.open_dataset(folder / path), xr.open_dataset(small_study / path)
        xr.testing.assert_identical(one, two)
    for path in (*tables, *figures, "results/report.html"):
        assert (folder / path).read_bytes() == (small_study / path).read_bytes(), path


def test_the_run_tells_what_it_does_and_finds(small_study, snakemake, tmp_path):
    (tmp_path / "sim.yaml").write_text("simulation: {realizations: 2, fitted: [viscous, load_coulomb]}\n")
    done = snakemake(
        "results/simulation/norms_viscous.nc", "--configfile", tmp_path / "sim.yaml", directory=tmp_path
    )
    assert "[0/2] Simulating swings and drawing their noise" in done.stdout
    assert "κv is closest to the truth" in done.stdout
    assert "2 of 2 jobs done" in done.stdout
    assert "κv is closest" in (tmp_path / "results/logs/fit_simulated/viscous.log").read_text()


OWN = """\
recordings: sheet.csv
simulation: {simulated: []}
experiment: {fitted: [viscous, load_coulomb]}
discovery: {rounds: 1}
"""


@pytest.fixture
def own(tmp_path):
    """A study of one recording that a test writes."""

    def write(text, columns="recording,file", cells="mine,mine.csv"):
        (tmp_path / "mine.csv").write_text(text)
        (tmp_path / "sheet.csv").write_text(f"{columns}\n{cells}\n")
        (tmp_path / "mine.yaml").write_text(OWN)
        return tmp_path

    return write


def swing():
    """A decaying swing as CSV text."""
    times = [k / 100 for k in range(800)]
    rows = [
        f"{t},{0.3 * 0.9**t * (1 if int(t * 2) % 2 else -1) * (1 - (4 * (t % 0.5) - 1) ** 2):.6f}"
        for t in times
    ]
    return "\n".join(["time_s,angle_rad", *rows, ""])


SPOILT = {
    "hold no finite number": lambda k, time, angle: (time, "nan" if k % 3 else angle),
    "all samples have one time": lambda k, time, angle: ("4.0", angle),
    "the first 'lots' in line 2": lambda k, time, angle: (time, angle if k % 5 else "lots"),
}


@pytest.mark.parametrize("told", SPOILT)
def test_a_study_of_a_bad_recording_alone_stops_and_tells_why(own, snakemake, told):
    header, *rows = swing().splitlines()
    rows = [",".join(SPOILT[told](k, *row.split(","))) for k, row in enumerate(rows)]
    folder = own("\n".join([header, *rows, ""]))
    done = snakemake("--configfile", folder / "mine.yaml", directory=folder, check=False)
    assert done.returncode != 0
    assert "This input cannot be used." in done.stdout
    assert told in done.stdout and "mine.csv" in done.stdout
    assert "Traceback" not in done.stdout
    for kept in (folder / "results").rglob("*.nc"):
        with xr.open_dataset(kept) as recording:  # it says why it was refused, and holds no number
            assert recording.attrs["role"] == "refused" and not recording.sizes.get("time", 0)
    assert not list((folder / "results").rglob("*.part"))


@pytest.mark.slow("a whole study")
def test_ones_own_recording_needs_no_apparatus(own, snakemake):
    folder = own(swing())
    snakemake("--configfile", folder / "mine.yaml", directory=folder)
    assert pd.read_csv(folder / "results/tables/table3.csv")["campaign"].unique() == ["pendulum"]
    report = (folder / "results/report.html").read_text()
    assert "emulated" not in report.split("<main>")[1].lower()
    assert "Figure 8" not in report
