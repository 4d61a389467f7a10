"""The sampler's real firmware, emulated, recorded by the capture rule in real time and taken through the whole study."""

import subprocess
import time
from concurrent.futures import ThreadPoolExecutor
from contextlib import chdir
from math import radians

import board as boards
import numpy as np
import pandas as pd
import pytest
import xarray as xr
import yaml
from truth import check_truth, made

from swingdown import dataset
from swingdown.capture import job as jobs
from swingdown.capture import session, takes
from swingdown.measurement.recording import ingest
from swingdown.measurement.sheet import read_sheet
from swingdown.planning.settings import complete

STUDY = """\
recordings: recordings.csv
apparatus: apparatus.yaml
simulation: {simulated: []}
calibration: {draws: 2000}
experiment: {fitted: [viscous, load_coulomb, quadratic_drag+load_coulomb]}
capture:
  scale: 0.0048828125
  duration_s: 8
  settle_s: 1
  campaign: emulated
  trigger: {threshold: 0.05}
  emulated: true
"""
APPARATUS = """\
name: emulated board
emulated: true
campaigns: [emulated]
lengths:
  arm: {value: 0.20800, limit: 0.00004}
  shaft_diameter: {value: 0.012700, limit: 0.000002}
  over_shaft: {value: 0.24635, limit: 0.00004}
  bob_diameter: {value: 0.025400, limit: 0.000002}
encoder:
  limits: [{up_to: 5.0, limit: 0.008}]
  step: 0.0048828125
rest: {limit: 0.0002}
"""


@pytest.fixture
def bench(tmp_path, snakemake):
    """A folder with a study, and a function that captures from a board with ``--config`` words."""
    (tmp_path / "study.yaml").write_text(STUDY)
    (tmp_path / "apparatus.yaml").write_text(APPARATUS)

    def capture(board, *words, **more):
        settings = ", ".join(f"{key}: {value}" for key, value in {"port": board.port, **more}.items())
        words = [*words, f"capture={{{settings}}}"]
        return snakemake(
            "capture",
            "--configfile",
            tmp_path / "study.yaml",
            "--config",
            *words,
            directory=tmp_path,
            cores=1,
            check=False,
        )

    return tmp_path, capture


def test_the_capture_rule_records_the_real_firmware(bench):
    """100 S/s in real time, through the board's reset on opening: no frame lost, and the angle that was there."""
    folder, capture = bench
    with made(folder, "swing", boards.swing(24, 3.5, 20)) as board:
        done = capture(board, "recording=swing-07", duration_s=5)
        assert done.returncode == 0, done.stdout
        data = dataset.read(folder / "resources/recordings/swing-07.nc")
        check_truth(data, board)
    assert "swing-07: complete: 550 of 550 samples" in done.stdout and "0 lost, 0 damaged" in done.stdout
    assert data.attrs["partial"] == "no" and data.attrs["emulated"] == "yes"
    assert data.attrs["rate_by_host_hz"] == pytest.approx(100, rel=0.1)
    times = data["time"].values
    assert times == pytest.approx(np.arange(-50, 500) / 100)

    angle = (data["voltage"].values - boards.ZERO_VOLTAGE) / boards.VOLTS_PER_RADIAN
    fine = np.arange(0, 5.2, 0.0005)
    truth = boards.emulate.motion(fine, radians(24))  # since the release
    step = boards.STEP / boards.VOLTS_PER_RADIAN

    def worst(shift):
        known = np.interp(times + shift, fine, truth, left=radians(24))
        return np.abs(angle - known).max()

    near = min(np.arange(-0.1, 0.1, 0.002), key=worst)
    assert -0.005 < near < 0.015  # 0 is the first sample after the release
    assert min(worst(near + shift) for shift in np.arange(-0.002, 0.002, 2e-5)) <= 1.05 * step

    row = read_sheet(folder / "recordings.csv", check_files=False).loc["swing-07"]
    assert row.signal_unit == "V" and row.start_s == 0 and row.campaign == "emulated"


@pytest.mark.slow("an emulated board")
def test_unplugging_the_board_keeps_what_arrived(bench, snakemake):
    folder, capture = bench
    with made(folder, "swing", boards.swing(24, 0.5, 20)) as board, ThreadPoolExecutor(1) as pool:
        running = pool.submit(capture, board, "recording=swing-07", trigger="null")
        raw = folder / "resources/recordings/swing-07.raw"
        while not raw.exists() and not running.done():
            time.sleep(0.1)
        time.sleep(3)
        board.unplug()
        done = running.result()
        data = dataset.read(raw.with_suffix(".nc"))
        check_truth(data, board)
    assert done.returncode != 0 and "kept and marked partial: disconnected" in done.stdout
    assert (
        data.attrs["status"] == "disconnected" and 30 < data.attrs["received"] < 800 == data.attrs["expected"]
    )

    # no fit and no discovery takes it, unless the sheet allows it
    sheet = folder / "recordings.csv"
    sheet.write_text(sheet.read_text().replace(",voltage,V,", ",voltage,rad,"))
    (folder / "own.yaml").write_text(
        "recordings: recordings.csv\nsimulation: {simulated: []}\ndiscovery: {rounds: 1}\n"
    )
    for target in ("results/experiment/fits/swing-07.nc", "discover"):
        refused = snakemake(target, "--configfile", folder / "own.yaml", directory=folder, check=False)
        assert (refused.returncode != 0) is (
            target == "discover"
        )  # a fit that is asked for by name says why it is none
        assert "the recording is partial" in refused.stdout and "write `allow`" in refused.stdout
    sheet.write_text(sheet.read_text().replace(",voltage,rad,", ",voltage,V,").rstrip("\n") + "allow\n")
    with chdir(folder):  # where the sheet's files are looked for
        taken = ingest(read_sheet(str(sheet)).loc["swing-07"], str(sheet))
    assert taken.sizes["time"] > 30


@pytest.mark.slow("an emulated board")
def test_from_an_emulated_capture_through_the_whole_study(bench, snakemake):
    """Tower heights, rest and swings are captured, then calibration, fits and figures follow from them."""
    folder, capture = bench
    heights = {"tower-1": 0.02385, "tower-2": 0.03445, "tower-3": 0.05090, "tower-4": 0.0420}
    scenes = {name: ([0.0], [boards.emulate.tower_angle(height)]) for name, height in heights.items()}
    scenes |= {"rest": ([0.0], [boards.emulate.REST_ANGLE])}
    scenes |= {f"swing-{k}": boards.swing(release, 5, 20) for k, release in ((1, 22), (2, 26))}
    words = {name: [f"height={height}"] for name, height in heights.items()} | {"rest": ["role=static"]}

    def run(name):
        with made(folder, name, scenes[name]) as board:
            return capture(board, f"recording={name}", *words.get(name, []), settle_s=1)

    for names in (list(heights)[:2], list(heights)[2:], ["rest", "swing-1"], ["swing-2"]):
        with ThreadPoolExecutor(2) as pool:
            for done in pool.map(run, names):
                assert done.returncode == 0, done.stdout
    points = yaml.safe_load((folder / "apparatus.yaml").read_text())["points"]
    assert sorted(point["height"] for point in points) == sorted(heights.values())

    snakemake("--configfile", folder / "study.yaml", directory=folder)
    results = folder / "results"
    line = xr.open_dataset(results / "calibration/calibration.nc")
    slope = float(line["line"].sel(mode="gum", coefficient="slope"))
    assert slope == pytest.approx(1 / boards.VOLTS_PER_RADIAN, rel=0.005)
    table = pd.read_csv(results / "tables/table3.csv").set_index("fitted")
    best = "quadratic_drag+load_coulomb"
    assert table.loc[best, "mean"] < 1.0 * np.degrees(
        boards.STEP / boards.VOLTS_PER_RADIAN
    )  # within the step
    assert "emulated" in str(table.loc[best, "note"])
    fits = xr.open_dataset(results / "experiment/fits/swing-1.nc")
    frequency = float(fits["value"].sel(fitted=best, parameter="natural_frequency"))
    assert frequency == pytest.approx(boards.emulate.NATURAL_FREQUENCY, rel=0.003)
    assert (results / "figures/fig08.svg").stat().st_size > 2000  # the calibration line
    assert (results / "report.html").stat().st_size > 100_000


class Led:
    """Someone at the emulated bench who does what the session asks for, and lets go when it says ARMED."""

    def __init__(self, board):
        self.hands, self.said = boards.Hands(board), []

    def prompt(self, text, wait, look):
        self.said.append(text)
        if "tower of" in text:
            self.hands.do(f"tower {text.split()[-2]}")
        else:
            self.hands.do("rest" if "at rest" in text else "hold 20")
        end = time.monotonic() + 2  # until what the sensor saw before has gone by
        while time.monotonic() < end:
            look()
        return True

    def show(self, recorder):
        if recorder.state == "armed" and self.hands.held:
            self.hands.do("go")

    def close(self):
        pass


def test_a_session_is_followed_at_the_emulated_board(tmp_path, monkeypatch):
    """Tower, rest and swing through one open port: each recording has the voltage that the hands put before the sensor."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "apparatus.yaml").write_text(APPARATUS)
    plan = [
        {"recording": "tower-1", "height": 0.0345},
        {"recording": "rest", "role": "static"},
        {"recording": "swing-01"},
    ]
    config = complete(yaml.safe_load(STUDY)) | {"session": True}
    with made(tmp_path, "a", ([0.0], [0.0])) as board:
        config["capture"] |= {
            "port": str(board.port),
            "duration_s": 3,
            "still_s": 1,
            "takes": plan,
            "timeout_s": 3,
        }
        guide = Led(board)
        found = [jobs.job(config | take, again=True) for take in takes.takes(config)]
        assert "3 of 3 recorded" in session.run(found, guide, views=[guide])
    read = {name: dataset.read(jobs.FOLDER / f"{name}.nc") for name in ("tower-1", "rest", "swing-01")}
    for name, angle in {
        "tower-1": boards.emulate.tower_angle(0.0345),
        "rest": boards.emulate.REST_ANGLE,
    }.items():
        assert np.abs(read[name]["voltage"].values - boards.volts(angle)).max() <= boards.STEP
    swing = read["swing-01"]["voltage"].values
    assert swing[:40] == pytest.approx(boards.volts(radians(20)), abs=boards.STEP) and swing.min() < 1.3
    assert len(guide.said) == 3


@pytest.mark.slow("an emulated board")
def test_a_thousand_samples_a_second_on_a_busy_machine(bench):
    """Two cores are kept busy by others; nothing is lost. The emulated board is held up too, so its silence is given more time."""
    folder, capture = bench
    busy = [subprocess.Popen(["python3", "-c", "while True: pass"]) for _ in range(2)]
    try:
        with made(folder, "swing", boards.swing(24, 0, 40), rate=1000) as board:
            done = capture(board, "recording=fast", rate_hz=1000, duration_s=15, trigger="null", timeout_s=8)
            assert done.returncode == 0, done.stdout
            data = dataset.read(folder / "resources/recordings/fast.nc")
            check_truth(data, board, 1000)
    finally:
        for process in busy:
            process.kill()
            process.wait()
    assert "fast: complete: 15000 of 15000 samples" in done.stdout and "0 lost, 0 damaged" in done.stdout
