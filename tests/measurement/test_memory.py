"""A recording is read in pieces: what is held follows the window that is asked for, not the file."""

import tracemalloc

import numpy as np
import pytest

from swingdown.measurement.recording import ingest
from swingdown.measurement.sheet import read_sheet

ROWS = 1_000_000
PIECE = 25e6  # bytes: a piece of the file while it is read
SAMPLE = 16  # bytes: a time and an angle


@pytest.mark.slow("a large file")
@pytest.mark.parametrize(("start", "stop", "held"), [("", "", ROWS), (40, 44, ROWS / 25)])
def test_at_most_three_times_the_window_is_held(tmp_path, monkeypatch, start, stop, held):
    monkeypatch.chdir(tmp_path)
    with open("a.csv", "w") as file:
        file.write("t_s,theta_rad\n")
        for first in range(0, ROWS, 100_000):
            times = np.arange(first, first + 100_000) / 10_000
            swing = 0.5 * np.exp(-0.01 * times) * np.cos(7.25 * times)
            swing += 0.001 * np.random.default_rng(first).standard_normal(times.size)
            file.writelines(f"{t:.4f},{x:.6f}\n" for t, x in zip(times, swing, strict=True))
    (tmp_path / "sheet.csv").write_text(f"recording,file,start_s,stop_s\na,a.csv,{start},{stop}\n")
    row = read_sheet("sheet.csv").loc["a"]
    ingest(row, "sheet.csv")  # what is imported at the first use is no part of it
    tracemalloc.start()
    found = ingest(row, "sheet.csv")
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert found.sizes["time"] == pytest.approx(held, abs=2)
    assert peak < 3 * SAMPLE * held + PIECE
