"""Arrays that MATLAB saved are columns of a recording."""

import numpy as np
import pytest
from scipy.io import savemat

from swingdown.errors import InputError
from swingdown.measurement.matlab import arrays

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


@pytest.mark.parametrize("saved", [{"theta": SWING}, {"gain": 3.0}])
def test_an_array_alone_is_no_recording(tmp_path, saved):
    with pytest.raises(InputError, match="no two arrays of one length.*writematrix"):
        read(tmp_path / "a.mat", **saved)


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
