"""From the export of a telephone's gyroscope to an answer: the rate is fitted as a rate, through the whole of the project."""

import json

import numpy as np
import pytest

import swingdown
from swingdown import dataset
from swingdown.answer import command
from swingdown.errors import InputError
from swingdown.measurement.angle import to_angle
from swingdown.measurement.recording import ingest
from swingdown.measurement.sheet import COLUMNS
from swingdown_trials.second_pendulum import trajectory

TRUTH = {"natural_frequency": 4.2, "viscous_ratio": 0.004, "load_friction": 0.003}
HIDDEN = TRUTH | {"quadratic_coefficient": 0.12}
TIMES = np.arange(2500) * 0.0100244
ZEROS, GAIN, NOISE = np.array([0.002, -0.011, 0.013]), 1.01, 0.004  # rad/s, 1, rad/s


def rates(values=TRUTH, effects=("viscous", "load_coulomb"), release=0.45, held=0.0):
    """What a gyroscope reads (rad/s) about three axes, of a pendulum held for a while (s) and let go."""
    exact = trajectory(effects, values, TIMES, release, reading="rate").reading
    exact = np.concatenate([np.zeros(int(held / TIMES[1])), exact])[: TIMES.size]
    noise = np.random.default_rng(5).normal(0, NOISE, (TIMES.size, 3))
    return np.column_stack([0.004 * exact, 0.012 * exact, GAIN * exact]) + noise + ZEROS


def phyphox(path, xyz, unit="rad/s"):
    """A file as phyphox exports its raw gyroscope data: semicolons, decimal commas, digits in scientific notation."""
    head = ";".join(f'"{name}"' for name in ("Time (s)", *(f"Gyroscope {axis} ({unit})" for axis in "xyz"), f"Absolute ({unit})"))  # fmt: skip
    rows = (
        ";".join(f"{cell:.9E}".replace(".", ",") for cell in (t, *row, np.linalg.norm(row)))
        for t, row in zip(TIMES, xyz, strict=True)
    )
    path.write_text("\n".join([head, *rows, ""]), encoding="utf-8")
    return path


def read(path, **cells):
    return ingest({**COLUMNS, "recording": "phone", "file": str(path), **cells})


def within(found, truth, times=4):
    value, uncertainty, _ = found
    assert abs(value - truth) < times * uncertainty


@pytest.mark.parametrize("unit, scale", [("rad/s", 1.0), ("°/s", 180 / np.pi)])
def test_the_command_answers_on_a_telephones_export(tmp_path, capsys, unit, scale):
    path = phyphox(tmp_path / "Raw Data.csv", scale * rates(), unit)
    assert command.answer([str(path)], {}, command.Wishes(str(tmp_path / "study"), quick=True)) == 0
    said = capsys.readouterr().out
    assert f"took `Gyroscope z ({unit})`" in said and "angular rate" in said
    assert "of 3 axes" in said and "mrad/s RMS" in said
    table = (tmp_path / "study" / "first_answer.csv").read_text().splitlines()
    row = dict(zip(*(line.split(",") for line in table), strict=True))
    for column in ("natural_frequency_rad_per_s", "viscous_ratio", "load_friction"):
        within((float(row[column]), float(row[f"{column}_u"]), ""), TRUTH[column.removesuffix("_rad_per_s")])
    assert row["residual_rad"] == "" and abs(float(row["residual_rad_per_s"]) / NOISE - 1) < 0.1


def test_an_angle_file_of_a_rate_says_what_it_is(tmp_path):
    angle = to_angle(read(phyphox(tmp_path / "a.csv", rates())))
    again = dataset.read(dataset.write(angle, tmp_path / "a.nc"))
    assert "angle" not in again and again["rate"].attrs["units"] == "rad/s"
    assert [str(name) for name in again["nuisance"].values] == ["sensor_gain", "sensor_zero"]


@pytest.mark.parametrize("held", [3.0, 7.0])
def test_the_release_is_found_in_a_rate(tmp_path, held):
    found = read(phyphox(tmp_path / "a.csv", rates(held=held)))
    assert abs(found.attrs["released_s"] - held) < 0.3
    assert "begins_s" not in read(phyphox(tmp_path / "b.csv", rates())).attrs


@pytest.mark.parametrize(
    "cells, words",
    [
        ({"signal_column": "Absolute (rad/s)"}, "a speed without a direction"),
        ({"zero_tolerance_rad": 0.1}, "zero_tolerance_rad_per_s"),
    ],
)
def test_what_no_rate_can_have_is_refused(tmp_path, cells, words):
    path = phyphox(tmp_path / "a.csv", rates())
    with pytest.raises(InputError, match=words):
        read(path, **cells)


def test_degrees_a_second_called_rad_are_refused(tmp_path):
    with pytest.raises(InputError, match="deg/s in the cell signal_unit"):
        read(phyphox(tmp_path / "a.csv", 180 / np.pi * rates()))


def test_what_turns_one_way_is_no_pendulum(tmp_path):
    """A wheel that rolls, and stops at the end."""
    xyz = rates() + np.outer(np.where(TIMES < 20, 4.0, 0.0), [0, 0, 1])
    with pytest.raises(InputError, match="it turns one way all the time, at about 4 rad/s"):
        read(phyphox(tmp_path / "a.csv", xyz))


def test_an_axis_askew_is_told(tmp_path):
    xyz = rates()
    xyz[:, 0] += 0.5 * xyz[:, 2]
    assert "lies askew and reads too little, by about 1" in read(phyphox(tmp_path / "a.csv", xyz)).attrs["remarks"]  # fmt: skip


def test_what_is_missing_is_found_in_a_rate():
    effects = ("viscous", "load_coulomb", "quadratic_drag")
    xyz = rates(HIDDEN, effects, release=1.2)
    found = swingdown.explain(TIMES, xyz[:, 2], unit="rad/s")
    assert (found.verdict["reading"], found.verdict["unit"]) == ("rate", "rad/s")
    assert [one["name"] for one in found.verdict["effects"]] == ["quadratic_drag"]
    entry = found.verdict["effects"][0]["parameters"]["quadratic_coefficient"]
    within((entry["value"], entry["standard_error"], ""), HIDDEN["quadratic_coefficient"])
    assert (
        abs(found.verdict["noise_rms_rad_per_s"] / NOISE - 1) < 0.1 and found.verdict["noise_rms_rad"] is None
    )
    assert json.dumps(found.to_dict()["residual"]["unit"]) == '"rad/s"'
    assert "mrad/s RMS" in str(found) and "angular rate" in found.plot().axes[0].get_ylabel()


def test_angles_and_rates_are_no_one_pendulum(tmp_path):
    rate = to_angle(read(phyphox(tmp_path / "a.csv", rates())))
    angle = trajectory(("viscous", "load_coulomb"), TRUTH, TIMES, 0.4).reading
    (given,) = swingdown.fit(TIMES, angle + 1e-4 * rates()[:, 0]).swings
    with pytest.raises(InputError, match="make two campaigns"):
        swingdown.answer.of_swings([rate, given])


@pytest.mark.parametrize("noise", [1e-3, 5e-3])
def test_rates_that_somebody_derived_from_noisy_angles_tell_the_swing(noise):
    """Their noise goes through zero many times a swing, and is at most as wide as it: period, decay and course are the swing's."""
    swung = trajectory(
        ["viscous"], {k: v for k, v in TRUTH.items() if k != "load_friction"}, TIMES, 0.45
    ).reading
    truth = 2 * np.pi / TRUTH["natural_frequency"]
    angle = swung + np.random.default_rng(3).normal(0, noise, TIMES.size)
    found = swingdown.fit(TIMES, np.gradient(angle, TIMES), unit="rad/s")
    row = found.to_dict()
    for name, true in (("natural_frequency", TRUTH["natural_frequency"]), ("quality", 125.0)):
        one = row["quantities"][name]
        assert abs(one["value"] - true) < 2 * one["standard_uncertainty"] < 0.3 * true
    assert "goes from" not in str(found)
    (timed,) = row["timed"]
    for one in (timed["first"], timed["last"], timed["first_swing"]):
        assert one["period_s"] == pytest.approx(truth, rel=0.015)
