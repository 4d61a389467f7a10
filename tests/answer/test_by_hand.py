"""Periods that were timed by hand, given to the command: g of one pendulum whose length is stated, and what is said of the rest."""

import numpy as np
import pytest

from swingdown.answer.by_hand import PERIODS, by_hand


def table(folder, head="time for 10 swings (s)", rows=("20.02", "20.10", "19.95", "20.05")):
    path = folder / "watch.csv"
    path.write_text("\n".join([head, *rows]) + "\n")
    return path


def test_trials_of_one_pendulum_give_g_once_its_length_is_stated(tmp_path):
    path = table(tmp_path)
    asked = by_hand(path, tmp_path / "out", "", {})
    assert asked.g == {} and "--length gives g" in asked.told and (tmp_path / "out" / PERIODS).is_file()
    assert any(line.startswith("T = 2.00") for line in asked.told)
    found = by_hand(path, tmp_path / "out", "", {"length": "0.994(1) m"})
    (g,) = found.g.values()
    # 2.003 s, whose mean is known to 3.2 ms: g to 0.32 %, and a tenth of a percent of the length
    assert g.value == pytest.approx(4 * np.pi**2 * 0.994 / 2.003**2, rel=1e-4)
    scatter = np.std([2.002, 2.010, 1.995, 2.005], ddof=1) / 2
    assert g.uncertainty / g.value == pytest.approx(np.hypot(2 * scatter / 2.003, 0.001 / 0.994), rel=0.05)
    assert found.told[1].startswith("T = 2.00") and g.sentence in found.told


def test_two_rows_of_different_lengths_are_neither_one_pendulum_nor_a_series(tmp_path):
    path = table(tmp_path, "length (m),time for 10 swings (s)", ("0.5,14.2", "1.0,20.1"))
    found = by_hand(path, tmp_path / "out", "", {})
    assert found.series == [] and found.g == {}
    assert any("three values or two groups make a series" in line and PERIODS in line for line in found.told)
