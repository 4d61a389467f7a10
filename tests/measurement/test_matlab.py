"""Arrays that MATLAB saved are columns of a recording."""

import numpy as np
import pytest
from scipy.io import savemat

from swingdown.errors import InputError
from swingdown.measurement.files.matlab import arrays
from swingdown.measurement.recording import ingest
from swingdown.measurement.sheet import COLUMNS

TIME = np.arange(0, 20, 0.05)
SWING = 0.2 * np.exp(-TIME / 30) * np.cos(4 * TIME)


def read(path, **saved):
    savemat(path, saved)
    with open(path, "rb") as source:
        return arrays(source, path.name)[""]


def test_arrays_of_one_length_are_columns(tmp_path):
    found = read(
        tmp_path / "a.mat", t=TIME[:, None], theta=SWING[None], gain=3.0, settings=np.arange(12.0), name="run"
    )
    assert list(found.frame) == ["t", "theta"]
    assert found.frame["theta"].to_numpy() == pytest.approx(SWING)


def test_a_matrix_is_as_many_columns_as_it_has(tmp_path):
    found = read(tmp_path / "a.mat", data=np.column_stack([TIME, SWING]))
    assert list(found.frame) == ["data 1", "data 2"]


@pytest.mark.parametrize(("name", "value"), [("ActualRate", 20), ("fs", 20.0), ("dt", 0.05)])
def test_times_are_made_of_a_rate_that_stands_beside(tmp_path, name, value):
    found = read(tmp_path / "a.mat", theta=SWING, **{name: value}, duration=20, gain=3.0)
    assert found.frame["time (s)"].to_numpy() == pytest.approx(TIME)
    assert f"`{name}`, 20 Hz" in found.layout


def test_a_swing_alone_takes_the_rate_that_the_user_states(tmp_path):
    savemat(tmp_path / "a.mat", {"theta": SWING, "gain": 3.0})
    row = {**COLUMNS, "recording": "a", "file": str(tmp_path / "a.mat")}
    with pytest.raises(InputError, match="rate_hz"):
        ingest(row)
    assert ingest({**row, "rate_hz": 20.0})["time"].values == pytest.approx(TIME)


def test_settings_alone_are_no_recording(tmp_path):
    with pytest.raises(InputError, match="no array of 10 numbers or more.*writematrix"):
        read(tmp_path / "a.mat", gain=3.0)


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"MATLAB 7.3 MAT-file".ljust(124) + b"\x00\x02IM", "version 7.3"),
        (b"no MATLAB at all", "cannot be read"),
        (b"", "cannot be read"),
    ],
)
def test_what_the_reader_does_not_know_is_told(tmp_path, content, words):
    path = tmp_path / "a.mat"
    path.write_bytes(content)
    with open(path, "rb") as source, pytest.raises(InputError, match=f"{words}.*writematrix"):
        arrays(source, "a.mat")


def test_of_several_arrays_that_swing_the_user_names_one(tmp_path):
    other, still = 0.1 * np.exp(-TIME / 20) * np.cos(4.4 * TIME), 0.01 * TIME
    row = {**COLUMNS, "recording": "a", "file": str(tmp_path / "a.mat")}
    savemat(tmp_path / "a.mat", {"mytime": TIME, "one": other, "two": SWING, "gains": still})
    with pytest.raises(InputError, match="2 of its columns swing.*: one, two") as caught:
        ingest(row)
    assert "signal_column" in caught.value.mend
    named = ingest({**row, "time_column": "mytime", "signal_column": "two"})
    assert named["signal"].values == pytest.approx(SWING)
    savemat(tmp_path / "a.mat", {"mytime": TIME, "two": SWING, "zero": 0.9 + 0.01 * np.cos(TIME)})
    assert ingest({**row, "time_column": "mytime"})["signal"].values == pytest.approx(SWING)
    savemat(tmp_path / "a.mat", {"time": TIME, "one": other, "theta": SWING})
    assert ingest(row)["signal"].values == pytest.approx(SWING)
    savemat(tmp_path / "a.mat", {"data": np.column_stack([TIME, SWING, other])})
    assert ingest(row)["signal"].values == pytest.approx(SWING)
