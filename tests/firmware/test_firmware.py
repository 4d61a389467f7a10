"""What the sampler's firmware can be set to, emulated and recorded in real time, and what its compiler refuses."""

import re
import subprocess

import board as boards
import numpy as np
import pytest
from truth import check_truth, made

from swingdown import dataset
from swingdown.capture import job as jobs
from swingdown.capture import recording
from swingdown.errors import InputError
from swingdown.planning.settings import complete


def recorded(tmp_path, monkeypatch, scene, settings=None, **more):
    """The dataset and the board of a recording without a trigger, made in this process."""
    monkeypatch.chdir(tmp_path)
    with made(tmp_path, "a", scene, **more) as board:
        capture = {
            **complete({"recordings": "sheet.csv", "capture": {}})["capture"], "port": str(board.port), "settle_s": 1,
            "duration_s": 4, "rate_hz": more.get("rate", 100), "emulated": True, "trigger": None, "timeout_s": 3, **(settings or {}),
        }  # fmt: skip
        try:
            recording.capture(jobs.job({"recording": "a", "recordings": "sheet.csv", "capture": capture}))
        except InputError as error:
            assert "kept and marked partial" in error.problem, error
        return dataset.read(jobs.FOLDER / "a.nc"), board, board.truth()


@pytest.mark.slow("a recording in real time")
def test_times_of_a_board_that_falls_seconds_behind_are_the_hosts(tmp_path, monkeypatch):
    """It gets through a third of the time, in jerks, from the middle of the recording on: it is seconds late at the end."""
    scene, settings = boards.swing(24, 0, 60), {"duration_s": 8, "scale": boards.STEP}
    data, board, (_, cycles, host) = recorded(tmp_path, monkeypatch, scene, settings, held_up=4)
    at = data["sequence"].values[[0, -1]]
    assert np.diff(host[at])[0] - np.diff(cycles[at])[0] / 16e6 > 2
    assert data.attrs["partial"] == "yes"
    check_truth(data, board)


COUNTS = {"signal_unit": "counts", "counts_per_revolution": 4096}


def test_five_thousand_samples_a_second_without_loss(tmp_path, monkeypatch):
    """At 500 000 baud; the sequence numbers wrap."""
    data, board, _ = recorded(
        tmp_path,
        monkeypatch,
        boards.swing(24, 0, 60),
        {"duration_s": 14, "scale": boards.STEP},
        rate=5000,
        BAUD_RATE=500000,
    )
    assert (data.attrs["received"], data.attrs["lost"], data.attrs["damaged"]) == (70_000, 0, 0)
    assert data.attrs["status"] == "complete"
    assert set(np.diff(data["sequence"].values)) == {1}
    check_truth(data, board, 5000)


def test_oversampling_sends_the_sum_of_readings_that_are_evenly_spread(tmp_path, monkeypatch):
    settings = {"scale": boards.STEP / 16, "range": [0, 4.99]}
    data, _, (volts, cycles, *_) = recorded(
        tmp_path, monkeypatch, boards.swing(24, 0, 20), settings, OVERSAMPLE=16
    )
    assert data.attrs["partial"] == "no", data.attrs["problems"]
    assert set(np.diff(cycles[:6400])) == {10_000}
    means = volts[: len(volts) // 16 * 16].reshape(-1, 16).mean(axis=1)[data["sequence"].values]
    error = data["voltage"].values - means
    assert np.abs(error).max() <= boards.STEP
    alone = (
        np.floor(means / boards.STEP) * boards.STEP - means
    )  # what one reading in its place would be off by
    moving = np.abs(np.gradient(means)) > 8 * boards.STEP
    assert np.std(error[moving]) < 0.5 * np.std(alone[moving])


@pytest.mark.parametrize("oversample", [1, 16])
def test_what_lies_beyond_the_converters_range_is_told(tmp_path, monkeypatch, oversample):
    """Above 5 V: also where only one of the readings of a sample is."""
    settings = {"scale": boards.STEP / oversample, "range": [0, 1023 * boards.STEP], "duration_s": 2}
    data, _, (volts, *_) = recorded(
        tmp_path, monkeypatch, boards.swing(60, 0, 20), settings, OVERSAMPLE=oversample
    )
    samples = volts[: len(volts) // oversample * oversample].reshape(-1, oversample)[data["sequence"].values]
    beyond = ((samples >= 1023 * boards.STEP) | (samples < boards.STEP)).any(axis=1)
    assert data.attrs["partial"] == "yes"
    # a busy machine may have a problem of its own to tell before it
    (told,) = re.findall(r"(\d+) samples[^;]*the true signal lies beyond", data.attrs["problems"])
    assert int(told) == pytest.approx(beyond.sum(), abs=3)


def test_another_reference_is_taken_from_its_pin(tmp_path, monkeypatch):
    step = 3.3 / 1024
    data, _, (volts, *_) = recorded(
        tmp_path,
        monkeypatch,
        ([0.0], [-0.1]),
        {"scale": step, "duration_s": 0.5},
        EXTERNAL_REFERENCE=1,
        aref=3.3,
    )
    assert np.abs(data["voltage"].values - volts[0]).max() <= step


def test_an_encoder_is_counted_with_its_sign_over_more_than_sixteen_bits(tmp_path, monkeypatch):
    """A swing, then twenty turns backwards: -81 920 counts."""
    times, angles = boards.swing(24, 0, 3)
    scene = np.append(times, [3.5, 8.5]), np.append(angles, [0, -20 * 2 * np.pi])
    data, _, (counts, cycles, *_) = recorded(
        tmp_path, monkeypatch, scene, {**COUNTS, "duration_s": 9}, counts=4096
    )
    assert data.attrs["partial"] == "no", data.attrs["problems"]
    counted, true = data["counts"].values, counts[data["sequence"].values]
    assert np.abs((counted - counted[-1]) - (true - true[-1])).max() <= 1
    assert counted[0] - counted[-1] > 81_000 and counted.min() < -65_536
    assert np.abs(np.diff(cycles) - 160_000).max() <= 2


def test_forty_thousand_counts_a_second_are_all_counted(tmp_path, monkeypatch):
    scene = np.array([0, 2.5, 2.9, 4]), np.array([0, 0.01, 1, 1]) * 2 * np.pi * 4
    data, _, (true, *_) = recorded(tmp_path, monkeypatch, scene, {**COUNTS, "duration_s": 2}, counts=4096)
    counted = data["counts"].values
    assert np.diff(counted).max() > 380
    true = true[data["sequence"].values]
    assert np.abs((counted - counted[0]) - (true - true[0])).max() <= 1 and data.attrs["partial"] == "no"


@pytest.mark.parametrize(
    ("chosen", "told"),
    [
        ({"rate": 333}, "does not divide the clock exactly"),
        ({"BAUD_RATE": 115200}, "within 0.5 %"),
        ({"rate": 5000}, "the frames fill the line"),
        ({"rate": 1000, "OVERSAMPLE": 16, "BAUD_RATE": 500000}, "8000 readings a second"),
        ({"OVERSAMPLE": 65}, "1 to 64"),
        ({"mcu": "atmega2560"}, "serves the ATmega328P alone"),
        ({"mcu": "atmega32u4"}, "serves the ATmega328P alone"),
        ({"mcu": "atmega168"}, "serves the ATmega328P alone"),
    ],
)
def test_the_compiler_refuses_what_the_sampler_cannot_do(tmp_path, chosen, told):
    with pytest.raises(subprocess.CalledProcessError) as caught:
        boards.build(tmp_path, **chosen)
    assert told in caught.value.stderr


@pytest.mark.parametrize("language", ["c", "c++"])
@pytest.mark.parametrize("mcu", ["atmega328p", "atmega328"])
@pytest.mark.parametrize(
    "chosen",
    [{}, {"OVERSAMPLE": 16}, {"ENCODER": 1}, {"EXTERNAL_REFERENCE": 1}, {"BAUD_RATE": 38400}],
    ids=lambda chosen: "-".join(chosen) or "plain",
)
def test_it_is_c_and_what_the_arduino_ide_takes_for_each_board_it_claims(tmp_path, mcu, language, chosen):
    boards.build(tmp_path, mcu=mcu, language=language, **chosen)
