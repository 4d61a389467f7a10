"""A switch of the config adds or removes exactly the rules and files that it should, and nothing else."""

import os
import signal

import pytest
from snakemake.api import SnakemakeApi
from snakemake.settings.enums import Quietness
from snakemake.settings.types import (
    ConfigSettings,
    DAGSettings,
    ExecutionSettings,
    OutputSettings,
    ResourceSettings,
)

PAPER = {
    "all", "page", "manifest", "simulate", "fit_simulated", "table2", "record", "calibrate", "angle", "fit_swing", "fit_campaign",
    "table3", "left_out", "pendulums", "discover_search", "discover_verdict", "discover_figures", *(f"fig{number:02d}" for number in range(1, 16)),
}  # fmt: skip
SIMULATION = {"simulate", "fit_simulated", "table2", "fig02", "fig03", "fig04", "fig05"}
CALIBRATION = {"calibrate", "fig06", "fig07", "fig08"}
EXPERIMENT = PAPER - SIMULATION - {"all", "page", "manifest", "fig01"}
OWN = {rule for rule in PAPER if not rule.startswith("fig")} - SIMULATION - CALIBRATION | {
    "pendulums_figure",
    "curves",
}


@pytest.fixture
def rules(root, tmp_path):
    """A function that plans a config, in this process to save starts, and returns how often each rule would run."""

    def counts(config=None, *targets):
        (tmp_path / "mine.yaml").write_text(config or "")
        files = [] if config is None else [tmp_path / "mine.yaml"]
        with SnakemakeApi(OutputSettings(quiet={Quietness.ALL})) as api:
            study = api.workflow(
                resource_settings=ResourceSettings(cores=1),
                config_settings=ConfigSettings(configfiles=files),
                snakefile=root / "Snakefile",
                workdir=tmp_path,
            )
            jobs = study.dag(dag_settings=DAGSettings(targets=set(targets)))
            jobs.execute_workflow(executor="dryrun", execution_settings=ExecutionSettings(lock=False))
            _, found = study._workflow.dag.stats()
        return {name: count for name, count in found.items() if name != "total"}

    return counts


@pytest.fixture
def sheet(tmp_path):
    """A sample sheet of one pendulum whose swings are in radians, in the folder of the run."""
    (tmp_path / "a.csv").write_text("time_s,angle_rad\n")
    (tmp_path / "b.csv").write_text("time_s,angle_rad\n")
    (tmp_path / "sheet.csv").write_text("recording,campaign,file\na,mine,a.csv\nb,mine,b.csv\n")
    return "recordings: sheet.csv\n"


def test_lengths_in_the_sheet_ask_for_g_and_three_of_them_for_a_series(rules, tmp_path):
    for name in "abc":
        (tmp_path / f"{name}.csv").write_text("time_s,angle_rad\n")
    head, own = "recording,campaign,file,length", "recordings: sheet.csv\nsimulation: {simulated: []}\n"
    for lengths, made in (
        (("0.2", "0.3", "0.4"), {"series", "series_figure"}),
        (("0.2", "0.2", "0.2"), {"series"}),
    ):
        rows = [f"{name},{name},{name}.csv,{length}" for name, length in zip("abc", lengths, strict=True)]
        (tmp_path / "sheet.csv").write_text("\n".join([head, *rows]) + "\n")
        assert set(rules(own)) & {"series", "series_figure"} == made


def test_the_papers_study(rules):
    counts = rules()
    assert set(counts) == PAPER
    assert (
        counts["record"] == counts["angle"] == 19
    )  # both campaigns and the record at rest, which tells the noise
    # the tables are of one campaign, and whether a swing is free is asked of both
    assert (counts["fit_swing"], counts["fit_campaign"]) == (18, 1)
    assert (counts["discover_verdict"], counts["discover_search"]) == (2, 2)
    assert counts["fit_simulated"] == 3


def test_settings_that_name_no_recordings_change_the_papers_study(rules):
    assert rules("simulation: {simulated: [viscous]}\n")["fit_simulated"] == 1
    assert set(rules("seed: 1\n")) == PAPER


def test_without_recordings_only_the_simulation_study_runs(rules):
    assert set(rules("recordings: null\n")) == SIMULATION | {"all", "page", "manifest", "fig01"}


def test_recordings_in_radians_need_no_calibration(rules, sheet):
    assert set(rules(sheet)) == PAPER - CALIBRATION


def test_no_simulated_term_leaves_the_simulation_study_and_the_papers_figures_out(rules, sheet):
    own = sheet + "simulation: {simulated: []}\n"
    assert set(rules(own)) == OWN
    assert "fig13" in rules(own, "results/figures/fig13.svg")  # by name it is still there


def test_a_pendulum_of_one_swing_is_not_fitted_together(rules, sheet, tmp_path):
    with (tmp_path / "sheet.csv").open("a") as rows:
        rows.write("c,alone,a.csv\n")
    assert rules(sheet)["fit_campaign"] == 1


def test_each_simulated_term_is_one_job(rules):
    assert rules("simulation: {simulated: [viscous, load_coulomb]}\n")["fit_simulated"] == 2


def test_campaigns_choose_what_is_fitted(rules, sheet, tmp_path):
    with (tmp_path / "sheet.csv").open("a") as rows:
        rows.write("c,other,a.csv\nd,other,b.csv\ne,other,b.csv\n")
    assert rules(sheet)["fit_swing"] == 5
    assert rules(sheet)["fit_campaign"] == 2
    chosen = rules(sheet + "experiment: {campaigns: [other]}\n")
    assert (chosen["fit_swing"], chosen["fit_campaign"], chosen["record"]) == (3, 1, 3)


def test_the_report_is_a_target_of_its_own(rules):
    assert set(rules(None, "report")) == PAPER - {"all"} | {"report"}


def test_discovery_alone_asks_whether_swings_are_free_and_fits_nothing_else(rules, sheet):
    found = rules(sheet + "discovery: {rounds: 1}\n", "discover")
    assert found == {
        "discover": 1,
        "part_manifest": 1,
        "discover_search": 1,
        "discover_verdict": 1,
        "discover_figures": 1,
        "record": 2,
        "angle": 2,
        "fit_swing": 2,
        "left_out": 1,
    }


def test_certified_cases_are_asked_for_by_name_and_need_no_recordings(rules):
    found = rules("recordings: null\nsimulation: {simulated: []}\n", "certified")
    assert found == {"certified": 1, "certified_cases": 1, "part_manifest": 1}


def test_hidden_effects_are_asked_for_by_name_and_need_no_recordings(rules):
    found = rules(
        "recordings: null\nhidden_effects: {nulls: 12, own_frequencies: 0, calibrated: 0, effects: [quadratic_drag], sizes: [2], removed: false, pairs: false, foreign: false}\n",
        "hidden_effects",
    )
    assert found == {
        "hidden_effects": 1,
        "part_manifest": 1,
        "hidden_make": 2,
        "hidden_find": 2,
        "hidden_score": 1,
        "hidden_figures": 1,
    }


CAPTURE = "capture: {port: nowhere}\n"


@pytest.fixture
def interruptible():
    """Planning a capture leaves Ctrl-C to the recording; the tests want it back."""
    before = signal.getsignal(signal.SIGINT)
    yield
    signal.signal(signal.SIGINT, before)


def test_a_capture_is_one_job_and_looks_at_nothing_else(rules, interruptible):
    assert rules("recordings: not_there_yet.csv\nrecording: swing-07\n" + CAPTURE, "capture") == {
        "capture": 1
    }


@pytest.mark.parametrize("target", ["all", "discover", "report", "results/angles/a.nc"])
def test_no_other_target_captures(rules, sheet, target):
    """Also where the settings of a capture stand in the config, and its script is newer than every recording."""
    assert "capture" not in rules(sheet + CAPTURE, target)


def test_a_recording_that_is_there_is_an_input_like_any_other(rules, root, tmp_path):
    (tmp_path / "resources/recordings").mkdir(parents=True)
    recording = tmp_path / "resources/recordings/a.nc"
    recording.write_text("")
    os.utime(recording, (0, 0))  # older than script, rule and package
    (tmp_path / "sheet.csv").write_text("recording,file\na,resources/recordings/a.nc\n")
    counts = rules("recordings: sheet.csv\n" + CAPTURE)
    assert counts["record"] == 1 and "capture" not in counts
    assert recording.exists()


@pytest.mark.parametrize("targets", [(), ("all",)])
def test_a_name_to_record_without_the_target_is_told(rules, interruptible, capfd, targets):
    with pytest.raises(SystemExit):
        rules("recording: swing-07\n" + CAPTURE, *targets)
    assert "name the target `capture`" in capfd.readouterr().err


def test_the_settings_of_a_capture_run_nothing_again(rules, sheet):
    assert rules(sheet) == rules(sheet + CAPTURE)


@pytest.mark.parametrize(
    ("config", "told"),
    [
        ("capture: {prot: x}\n", "write 'port'"),
        ("recording: 7\n", "letters, digits"),
        ("recording: a/b\n", "letters, digits"),
        ("sead: 1\n", "key sead"),
        ("recordings: nowhere.csv\n", "nowhere.csv"),
        ("recordings: sheet.csv\nexperiment: {campaigns: [mime]}\n", "'mine'"),
        ("recordings: config/recordings.csv\napparatus: none.yaml\n", "none.yaml"),
    ],
)
def test_a_study_that_cannot_be_is_told_in_one_block(rules, sheet, tmp_path, capfd, config, told):
    with pytest.raises(SystemExit) as stopped:
        rules(config)
    assert stopped.value.code == 1
    shown = capfd.readouterr().err
    assert shown.count("This input cannot be used.") == 1
    assert told in shown
    assert "mend:" in shown
    assert "Traceback" not in shown
    assert not (tmp_path / "results").exists()
