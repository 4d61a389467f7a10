"""What the command tells of eighteen inputs is what it was, line by line: a number or a word that changes anywhere between a file and its answer
is seen here.

The second pendulum makes the swings. ``frozen_answers.json`` holds the lines and the tables; after a change that is meant, ``FROZEN_WRITE=1 make quick
TESTS="tests/answer/test_frozen_answers.py"`` writes them anew, and the diff shows what it did.
"""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from frozen import by_a_digit, held

from swingdown.__main__ import main
from swingdown.pendulum.half_swings import lengthening
from swingdown_trials.second_pendulum import trajectory

FROZEN = Path(__file__).with_name("frozen_answers.json")
VALUES = {"natural_frequency": 6.4, "viscous_ratio": 0.007, "quadratic_coefficient": 0.004, "load_friction": 0.0015, "constant_friction": 0.06}  # fmt: skip
AIR, RUBS, TURNS = ("viscous", "quadratic_drag"), ("viscous", "load_coulomb"), ("viscous", "constant_coulomb")
TABLES = ("curves.csv", "laws.csv", "series.csv", "resonance.csv", "periods.csv")


def swing(effects=AIR, angle=0.6, seconds=15.0, rate=100.0, noise=1.5e-3, seed=8, restoring="sine", **values):
    """(times in s, angles in rad) of the second pendulum, with white noise."""
    times = np.arange(round(seconds * rate) + 1) / rate
    motion = trajectory(effects, VALUES | values, times, angle, restoring=restoring)
    return times, motion.reading + noise * np.random.default_rng(seed).standard_normal(times.size)


def table(path, digits=5, **columns):
    """Writes columns by their heads; spaces stand for underscores there."""
    path.parent.mkdir(exist_ok=True)
    named = {name.replace("__", "/").replace("_", " "): values for name, values in columns.items()}
    pd.DataFrame(named).round(digits).to_csv(path, index=False)


def in_degrees(path, **options):
    times, angle = swing(**options)
    table(path, **{"Time_(s)": times, "Angle_(deg)": np.degrees(angle)})


def a_swing(folder):
    in_degrees(folder / "a.csv")
    return ["a.csv"]


def two_swings(folder):
    for k, angle in enumerate((0.7, -0.4)):
        in_degrees(folder / f"{k}.csv", effects=RUBS, angle=angle, seed=k)
    return ["0.csv", "1.csv", "--together"]


def a_class(folder):
    for k, name in enumerate(("Ann", "Ben", "Cem", "Dora")):
        in_degrees(
            folder / "class" / f"{name}.csv",
            natural_frequency=6.4 + 0.02 * k,
            seed=k,
            noise=0.02 if k == 3 else 2e-3,
        )
    return ["class"]


def a_wheel(folder):
    times, angle = swing(TURNS, 2.2, restoring="linear", noise=0.0)
    counts = np.round(angle / (2 * np.pi) * 1200 + 300)
    table(folder / "wheel.csv", **{"time_(ms)": 1e3 * times, "counts": counts})
    return ["wheel.csv", "--restoring", "linear", "--counts-per-revolution", "1200"]


def a_spring(folder):
    times, angle = swing(("viscous",), 1.0, rate=40.0, restoring="linear", seed=3)
    table(folder / "spring.csv", **{"t_(s)": times, "Position_(mm)": 30 * angle + 412})
    return ["spring.csv", "--restoring", "linear"]


def a_gyroscope(folder):
    times, angle = swing(angle=0.5, noise=0.0)
    rate = np.gradient(angle, times) + 0.01 * np.random.default_rng(1).standard_normal(times.size)
    table(folder / "gyro.csv", **{"Time_(s)": times, "Gyroscope_x_(rad__s)": rate})
    return ["gyro.csv"]


def a_film(folder):
    times, angle = swing(rate=30.0, noise=0.0)
    draws = 0.5 * np.random.default_rng(2).standard_normal((2, times.size))
    x, y = 320 + 250 * np.sin(angle) + draws[0], 60 + 250 * np.cos(angle) + draws[1]
    table(folder / "film.csv", t=times, x=x, y=y)
    return ["film.csv", "--length", "0.245(1)"]


def a_ball(folder):
    in_degrees(folder / "ball.csv", natural_frequency=4.43)
    return ["ball.csv", "--length", "0.500±0.001", "--bob-diameter", "30.0(1)mm", "--bob-density", "7800"]


def a_reversible_body(folder):
    for k, frequency in enumerate((5.7, 5.72)):
        in_degrees(folder / f"{k}.csv", natural_frequency=frequency, angle=0.15, seed=k)
    return ["0.csv", "1.csv", "--kater", "0.2000(2)", "0.1000(2)"]


def lengths(folder):
    for k, length in enumerate((20, 40, 60, 90)):
        in_degrees(folder / "lengths" / f"{length}cm.csv", natural_frequency=np.sqrt(981 / length), seed=k)
    return ["lengths", "--by", "length±1mm"]


def masses(folder):
    for k, mass in enumerate((50, 100, 200, 400)):
        in_degrees(folder / "masses" / f"{mass}g.csv", viscous_ratio=0.5 / mass, effects=("viscous",), seed=k)
    return ["masses", "--by", "mass"]


def by_hand(folder):
    length, draws = np.repeat([0.3, 0.5, 0.8, 1.1], 3), np.random.default_rng(4)
    ten = 10 * 2 * np.pi * np.sqrt(length / 9.81) + 0.05 * draws.standard_normal(length.size)
    table(folder / "timed.csv", 3, **{"length_(m)": length, "10_periods_(s)": ten})
    return ["timed.csv", "--by", "length"]


def turning_points(folder):
    amplitude = 0.6 * 0.96 ** np.arange(40)
    half = np.pi / 6.4 * lengthening(amplitude) + 2e-3 * np.random.default_rng(5).standard_normal(40)
    table(folder / "turns.csv", **{"time_(s)": np.cumsum(half), "amplitude_(deg)": np.degrees(amplitude)})
    return ["turns.csv", "--kind", "half_swings"]


def a_gate(folder):
    half = np.pi / 6.4 + 1e-4 * np.random.default_rng(6).standard_normal(60)
    table(folder / "gate.csv", **{"time_(s)": np.cumsum(half)})
    return ["gate.csv", "--kind", "passages"]


def a_wheel_that_will_be_driven(folder):
    times, angle = swing(("viscous",), 1.5, restoring="linear", viscous_ratio=0.02)
    table(folder / "wheel.csv", **{"time_(s)": times, "angle_(rad)": angle})
    return ["wheel.csv", "--restoring", "linear", "--drive", "0.5", "1"]


def a_spoilt_recording(folder):
    """Held and let go, a hole, two echoes, and at rest at the end."""
    times, angle = swing(RUBS, seconds=25.0, rate=50.0, load_friction=0.006)
    held = 0.6 + 1.5e-3 * np.random.default_rng(7).standard_normal(100)
    times, angle = np.r_[np.arange(100) / 50, times + 2], np.r_[held, angle]
    angle[[300, 700]] += 0.4
    kept = (times < 9) | (times > 9.3)
    table(folder / "spoilt.csv", **{"Time_(s)": times[kept], "Angle_(deg)": np.degrees(angle[kept])})
    return ["spoilt.csv"]


def slow_noise(folder):
    times, angle = swing(noise=0.0)
    noise = np.random.default_rng(9).standard_normal(times.size)
    for k in range(1, noise.size):
        noise[k] += 0.8 * noise[k - 1]
    table(folder / "slow.csv", **{"Time_(s)": times, "Angle_(rad)": angle + 1e-3 * noise})
    return ["slow.csv"]


def nothing_that_swings(folder):
    times = np.arange(500) / 50
    table(folder / "noise.csv", **{"Time_(s)": times, "Angle_(deg)": np.random.default_rng(1).normal(size=500)})  # fmt: skip
    return ["noise.csv"]


INPUTS = {made.__name__: made for made in (
    a_swing, two_swings, a_class, a_wheel, a_spring, a_gyroscope, a_film, a_ball, a_reversible_body, lengths, masses, by_hand,
    turning_points, a_gate, a_wheel_that_will_be_driven, a_spoilt_recording, slow_noise, nothing_that_swings,
)}  # fmt: skip


def rows(path):
    """The first, middle and last row of a table, numbers to four digits; a chance far below one in a billion is 0."""
    found = pd.read_csv(path)
    chosen = found.iloc[sorted({0, len(found) // 2, len(found) - 1} & set(range(len(found))))]
    return [[f"{0 if abs(one) < 1e-12 else one:.4g}" if isinstance(one, float) else str(one) for one in row] for row in chosen.values.tolist()]  # fmt: skip


def told(capsys, arguments):
    """Every line that the command writes, and of each table some rows."""
    try:
        code = main([*arguments, "--quick", "--into", "study"])
    except SystemExit as end:
        code = end.code
    said = capsys.readouterr()
    lines = [line for line in (said.out + said.err).splitlines() if line.strip()]
    tables = {name: rows(Path("study", name)) for name in TABLES if Path("study", name).exists()}
    return {"code": code, "lines": lines, **tables}


@pytest.mark.parametrize("name", INPUTS)
def test_the_answer_is_what_it_was(name, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    held(FROZEN, INPUTS, name, told(capsys, INPUTS[name](tmp_path)), by_a_digit, indent=1)
