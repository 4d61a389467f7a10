"""Somebody's netCDF file that is damaged is refused or harmless: never a crash, never another number."""

import netCDF4
import numpy as np
import pytest

from swingdown.errors import InputError
from swingdown.measurement.files import source
from swingdown.measurement.recording import ingest
from swingdown.measurement.sheet import read_sheet


def write(path):
    time = np.arange(400) / 50
    with netCDF4.Dataset(path, "w") as file:
        file.createDimension("time", time.size)
        for name, values, unit in (("time", time, "s"), ("angle", 0.4 * np.cos(5 * time), "rad")):
            variable = file.createVariable(name, "f8", ("time",), zlib=True, fletcher32=True)
            variable.units = unit
            variable[:] = values


@pytest.fixture
def read(tmp_path, monkeypatch):
    """A function that reads a netCDF file of these bytes as a study does."""
    monkeypatch.chdir(tmp_path)

    def one(content):
        (tmp_path / "a.nc").write_bytes(content)
        (tmp_path / "sheet.csv").write_text("recording,file\na,a.nc\n")
        return ingest(read_sheet("sheet.csv").loc["a"], "sheet.csv")

    return one


def test_a_library_that_crashes_or_hangs_is_told(read, tmp_path, monkeypatch):
    write(tmp_path / "b.nc")
    whole = (tmp_path / "b.nc").read_bytes()
    assert read(whole).sizes["time"] == 400
    monkeypatch.setattr(source, "_OPENING", "import os, signal; os.kill(os.getpid(), signal.SIGSEGV)")
    with pytest.raises(InputError, match="library crashes at it, signal 11"):
        read(whole)
    monkeypatch.setattr(source, "_OPENING", "import time; time.sleep(60)")
    monkeypatch.setattr(source, "_SECONDS", 0.5)
    with pytest.raises(InputError, match="has not read it"):
        read(whole)


@pytest.mark.slow("many damages")
def test_bytes_that_are_flipped_or_cut(read, tmp_path):
    write(tmp_path / "b.nc")
    whole = (tmp_path / "b.nc").read_bytes()
    good = read(whole)
    draws = np.random.default_rng(8)
    refused = 0
    for k in range(60):
        damaged = bytearray(whole)
        if k % 5 == 0:
            del damaged[int(draws.integers(len(whole))) :]
        else:
            damaged[int(draws.integers(len(whole)))] ^= 1 << int(draws.integers(8))
        try:
            found = read(bytes(damaged))
        except InputError as error:
            refused += 1
            assert error.mend
            continue
        if found["signal"].attrs["units"] == "rad":  # a unit is text, which the format does not check
            np.testing.assert_array_equal(found["signal"].values, good["signal"].values)
            np.testing.assert_array_equal(found["time"].values, good["time"].values)
    assert refused > 12
