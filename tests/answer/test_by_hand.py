"""Periods that were timed by hand, given to the command: g of one pendulum whose length is stated, and what is said of the rest."""

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
    assert g.value == pytest.approx(9.79, abs=0.1) and 0 < g.uncertainty < 0.1


def test_two_rows_of_different_lengths_are_neither_one_pendulum_nor_a_series(tmp_path):
    path = table(tmp_path, "length (m),time for 10 swings (s)", ("0.5,14.2", "1.0,20.1"))
    found = by_hand(path, tmp_path / "out", "", {})
    assert found.series == [] and found.g == {}
    assert any("three values or two groups make a series" in line and PERIODS in line for line in found.told)
