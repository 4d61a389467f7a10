"""A driven pendulum as a caller and a file's owner have it: the input acts in the model, and nobody asks whether the swing is free."""

import json

import numpy as np
import pandas as pd
import pytest

import swingdown
from swingdown.__main__ import main
from swingdown.errors import InputError

TIMES = 0.02 * np.arange(2000)
MOTOR = 0.04 * np.sin(2 * np.pi * 0.9 * TIMES) + 0.03 * np.sin(2 * np.pi * 1.31 * TIMES + 1.0)  # rad
WHEEL = {"natural_frequency": 6.5, "viscous_ratio": 0.02, "constant_friction": 0.08}


def wheel(**more):
    """The wheel's swing; with ``cubic_stiffness`` its spring stiffens."""
    said = {"input": MOTOR, "input_kind": "pivot_angle"} | more
    label = "viscous+constant_coulomb" + ("+cubic_stiffness" if "cubic_stiffness" in said else "")
    return swingdown.simulate(label, TIMES, 0.1, restoring="linear", noise=1e-3, **said, **WHEEL)


def test_a_driven_wheel_gives_its_own_period_and_friction():
    answer = swingdown.fit(
        TIMES, wheel(), restoring="linear", input=MOTOR, input_kind="pivot_angle", input_free="gain,delay"
    )
    for name, value in (WHEEL | {"pivot_angle_gain": 1.0, "input_delay": 0.0}).items():
        assert abs(answer[name].value - value) < 4 * answer[name].u, name
    assert answer["period"].value == pytest.approx(2 * np.pi / 6.5, rel=1e-3), "as it swings by itself"
    assert "input" not in answer.sentence and "input" not in answer.remarks
    assert np.abs(answer.simulate().values - answer.shown[0].fit).max() < 1e-9
    with pytest.raises(InputError, match="curves against the amplitude are of free swings"):
        answer.curves()


def test_units_are_those_of_the_input():
    """The same shaking in m/s^2 and in g; the same lever in degrees and in radians."""
    shaken = swingdown.simulate(
        "viscous",
        TIMES,
        0.1,
        input=MOTOR,
        input_kind="pivot_acceleration",
        input_unit="g",
        natural_frequency=6.5,
        viscous_ratio=0.02,
    )
    again = swingdown.simulate(
        "viscous",
        TIMES,
        0.1,
        input=9.80665 * MOTOR,
        input_kind="pivot_acceleration",
        natural_frequency=6.5,
        viscous_ratio=0.02,
    )
    assert np.abs(shaken - again).max() < 1e-12
    assert np.abs(wheel() - wheel(input=np.degrees(MOTOR), input_unit="deg")).max() < 1e-12


def test_an_input_may_have_a_clock_of_its_own():
    fine = 0.005 * np.arange(8000)
    lever = 0.04 * np.sin(2 * np.pi * 0.9 * fine) + 0.03 * np.sin(2 * np.pi * 1.31 * fine + 1.0)
    assert np.abs(wheel() - wheel(input=(fine, lever))).max() < 1e-5


def test_a_file_with_an_input_is_fitted_by_the_command(tmp_path, capsys):
    frame = {"time_s": TIMES, "wheel_rad": wheel().values, "motor_deg": np.degrees(MOTOR)}
    pd.DataFrame(frame).to_csv(tmp_path / "pohl.csv", index=False)
    said = [
        "--column",
        "wheel_rad",
        "--input",
        "motor_deg",
        "--input-kind",
        "pivot_angle",
        "--restoring",
        "linear",
        "--quick",
        "--json",
    ]
    assert main([str(tmp_path / "pohl.csv"), *said]) == 0
    printed = capsys.readouterr()
    found = json.loads(printed.out)["pendulums"][0]["quantities"]
    friction = found["constant_friction"]
    assert abs(friction["value"] - 0.08) < 4 * friction["standard_uncertainty"]
    assert "driven by `motor_deg`, a pivot angle in deg" in printed.err
    recording = swingdown.read(
        tmp_path / "pohl.csv",
        column="wheel_rad",
        input="motor_deg",
        input_kind="pivot_angle",
        restoring="linear",
    )
    assert recording.fit()["period"].value == pytest.approx(found["period"]["value"])
    with pytest.raises(InputError, match="the file has no column 'motor'"):
        swingdown.read(tmp_path / "pohl.csv", input="motor", input_kind="pivot_angle")


@pytest.mark.parametrize(
    ("said", "problem"),
    [
        ({"input": MOTOR}, "an input is named, and its kind is not stated"),
        ({"input": MOTOR, "input_kind": "push"}, "unknown input_kind 'push'"),
        ({"input": MOTOR, "input_kind": "pivot_angle", "input_unit": "V"}, "'V' is no unit of a pivot_angle"),
        ({"input": MOTOR[:-1], "input_kind": "torque"}, "1999 values for 2000 times"),
        ({"input": np.where(TIMES[5] == TIMES, np.nan, MOTOR), "input_kind": "torque"}, "no number at 0.1 s"),
        ({"input_kind": "torque"}, "but its values are missing"),
        ({"input": MOTOR, "input_knd": "torque"}, "there is no such argument"),
        ({"input": MOTOR, "input_kind": "torque", "input_free": "phase"}, "unknown 'phase'"),
    ],
)
def test_what_is_said_wrongly_is_refused_with_the_mend(said, problem):
    with pytest.raises(InputError, match=problem):
        swingdown.fit(TIMES, wheel(), restoring="linear", **said)


@pytest.mark.slow("many starts")
def test_a_swing_that_does_not_answer_to_its_input_is_refused():
    few = slice(0, 300)
    other = 0.05 * np.sin(2 * np.pi * 0.31 * TIMES[few] ** 1.1)
    with pytest.raises(InputError, match="does not answer to its input as a pendulum does"):
        swingdown.fit(
            TIMES[few],
            wheel()[few],
            restoring="linear",
            input=other,
            input_kind="pivot_angle",
            fitted=["viscous"],
        )


@pytest.mark.slow("a search by the workflow")
def test_the_command_finds_what_is_missing_in_driven_swings(tmp_path, capsys):
    """Two files of one wheel: the spring that stiffens is named, and nothing is said of them that only a free swing has."""
    for seed, size in ((1, 1.6), (2, 1.1)):  # wide enough to tell a stiffness
        lever = size * MOTOR
        angle = wheel(input=lever, seed=seed, cubic_stiffness=3.0)
        frame = pd.DataFrame({"time_s": TIMES, "wheel_rad": angle, "motor_deg": np.degrees(lever)})
        frame[:1000].to_csv(tmp_path / f"pohl{seed}.csv", index=False)
    said = [
        "--column",
        "wheel_rad",
        "--input",
        "motor_deg",
        "--input-kind",
        "pivot_angle",
        "--restoring",
        "linear",
    ]
    study = tmp_path / "study"
    files = [str(tmp_path / f"pohl{seed}.csv") for seed in (1, 2)]
    assert main([*files, "--together", *said, "--into", str(study)]) == 0
    told = capsys.readouterr().out
    assert "Named. Cubic stiffness" in told
    found = json.loads((study / "results/discovery/pendulum/verdict.json").read_text())
    (cubic,) = found["effects"]
    value = cubic["parameters"]["cubic_stiffness"]
    assert abs(value["value"] - 3.0) < 4 * value["standard_error"]
    for name in ("curves", "laws"):
        assert len(pd.read_csv(study / f"results/curves/pendulum/{name}.csv")) == 0
    report = (study / "results/report.html").read_text()
    assert "Recording and fit, pendulum" in report
    assert "Half swings" not in report and "Curves, pendulum" not in report


@pytest.mark.slow("a search")
def test_what_is_missing_is_found_in_a_driven_swing():
    """A spring that stiffens, hidden in a wheel under its motor, is named with its size; of a wheel that lacks nothing nothing is."""
    times = 0.02 * np.arange(3000)
    lever = 0.05 * np.sin(2 * np.pi * 0.9 * times) + 0.04 * np.sin(2 * np.pi * 1.31 * times + 1.0)
    said = {"input": lever, "input_kind": "pivot_angle"}
    for effects, hidden in (("", {}), ("+cubic_stiffness", {"cubic_stiffness": 3.0})):
        swing = swingdown.simulate(
            f"viscous+constant_coulomb{effects}",
            times,
            0.1,
            restoring="linear",
            noise=1e-3,
            seed=1,
            **said,
            **WHEEL,
            **hidden,
        )
        answer = swingdown.explain(times, swing, restoring="linear", input_free="gain,delay", **said)
        assert [one["name"] for one in answer.verdict["effects"]] == list(hidden)
        assert not answer.verdict["removed"]
        for name, value in (hidden | {"pivot_angle_gain": 1.0, "input_delay": 0.0}).items():
            assert abs(answer[name].value - value) < 4 * answer[name].u
