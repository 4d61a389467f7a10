"""Datasets on disk are whole, labelled, and notice damage."""

import errno
import subprocess
import sys
import warnings

import netCDF4
import numpy as np
import pytest
import xarray as xr

from swingdown import dataset
from swingdown.errors import InputError


@pytest.fixture
def labelled():
    angle = ("time", np.sin(np.arange(5000) / 9), {"units": "rad", "long_name": "angle"})
    name = ("model", np.array(["κv", "load_coulomb"]), {"long_name": "name"})
    time = ("time", np.arange(5000) / 100, {"units": "s", "long_name": "time"})
    return xr.Dataset({"angle": angle, "name": name}, {"time": time}, {"campaign": "bench"})


def test_what_is_read_is_what_was_written(labelled, tmp_path):
    back = dataset.read(dataset.write(labelled, tmp_path / "new" / "a.nc"))
    xr.testing.assert_equal(back, labelled)
    assert back.attrs["campaign"] == "bench" and back["angle"].attrs["units"] == "rad"
    assert back["time"].dtype == float  # seconds stay numbers, they are no dates


def test_every_variable_is_compressed_and_has_a_checksum(labelled, tmp_path):
    with netCDF4.Dataset(dataset.write(labelled, tmp_path / "a.nc")) as file:
        filters = [variable.filters() for variable in file.variables.values()]
    assert all(one["zlib"] and one["fletcher32"] for one in filters)


def test_every_file_says_what_it_is_and_by_what_it_was_made(labelled, tmp_path):
    labelled["n"] = ("model", np.array([3, 4]))
    path = dataset.write(labelled.assign_attrs(title="mine"), tmp_path / "angles" / "a.nc")
    with netCDF4.Dataset(path) as file:
        assert (file.title, file.source, file.Conventions) == ("mine", "swingdown", "CF-1.11")
        assert file.history.startswith("written by swingdown ")
        assert file["n"].dtype == np.int32 and file["n"].long_name == "n"
    assert dataset.read(dataset.write(labelled, tmp_path / "angles" / "a.nc")).title == "angles: a"
    large = labelled.assign(n=("model", np.array([2**40, 4])))
    assert dataset.read(dataset.write(large, path))["n"].values[0] == 2**40


def test_a_missing_number_is_told_to_every_reader_and_no_time_is_missing(labelled, tmp_path):
    """CF 2.5.1: NaN stands for no number, and a coordinate has one everywhere, so that it names none."""
    with netCDF4.Dataset(dataset.write(labelled, tmp_path / "a.nc")) as file:
        assert np.isnan(file["angle"]._FillValue) and "_FillValue" not in file["time"].ncattrs()


def test_the_same_dataset_gives_the_same_bytes(labelled, tmp_path):
    first = dataset.write(labelled, tmp_path / "a.nc").read_bytes()
    assert dataset.write(labelled, tmp_path / "a.nc").read_bytes() == first


@pytest.mark.parametrize("key", ["units", "long_name"])
def test_a_number_without_unit_or_name_is_not_written(labelled, tmp_path, key):
    del labelled["angle"].attrs[key]
    with pytest.raises(ValueError, match=f"angle: no {key}"):
        dataset.write(labelled, tmp_path / "a.nc")
    assert not list(tmp_path.iterdir())


def test_a_unit_that_is_lost_is_noticed_without_a_seal_too(labelled, tmp_path):
    """Releases without seals wrote such files."""
    del labelled["angle"].attrs["units"]
    labelled.assign_attrs(complete=1).to_netcdf(tmp_path / "a.nc", engine="netcdf4")
    with pytest.raises(InputError, match="angle has no units"):
        dataset.read(tmp_path / "a.nc")


def test_a_flipped_bit_is_noticed(labelled, tmp_path):
    path = dataset.write(labelled, tmp_path / "a.nc")
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 1
    path.write_bytes(content)
    with pytest.raises(InputError, match=r"a\.nc.*cannot be read.*undamaged"):
        dataset.read(path)


def test_a_changed_text_is_noticed(labelled, tmp_path):
    """Text of variable length lies outside every checksum of the format."""
    path = dataset.write(labelled.assign_attrs(campaign="bänch"), tmp_path / "a.nc")
    content = path.read_bytes()
    assert content.count("bänch".encode()) == 1
    path.write_bytes(content.replace("bänch".encode(), "bönch".encode()))
    with pytest.raises(InputError, match=r"a\.nc.*not those that were written.*Mend"):
        dataset.read(path)


def test_a_number_changed_by_another_program_is_noticed(labelled, tmp_path):
    path = dataset.write(labelled, tmp_path / "a.nc")
    with netCDF4.Dataset(path, "a") as file:
        file["angle"][7] = 0.0
    with pytest.raises(InputError, match="another program has changed it|not those that were written"):
        dataset.read(path)


def test_a_file_of_a_release_without_seals_is_read(labelled, tmp_path):
    labelled.assign_attrs(complete=1).to_netcdf(tmp_path / "a.nc", engine="netcdf4")
    xr.testing.assert_equal(dataset.read(tmp_path / "a.nc"), labelled)


def test_whatever_is_flipped_or_cut_is_refused_or_harmless(labelled, tmp_path):
    """Three bytes in four fall where the format keeps its book, for there the least is checked."""
    small = labelled.isel(time=slice(200)).assign_attrs(campaign="bänch", seed=7)
    path = dataset.write(small, tmp_path / "a.nc")
    whole, good = path.read_bytes(), dataset.read(path)
    rng = np.random.default_rng(12)
    refused = 0
    for k in range(300):
        damaged = bytearray(whole)
        if k % 6 == 0:
            damaged = damaged[: rng.integers(len(whole))]
        else:
            damaged[rng.integers(len(whole) if k % 4 == 0 else 3000)] ^= rng.integers(1, 256)
        copy = (
            tmp_path / f"{k}.nc"
        )  # a file that could not be opened stays in the library's memory under its name
        copy.write_bytes(damaged)
        try:
            xr.testing.assert_identical(dataset.read(copy), good)
        except InputError as error:
            refused += 1
            assert error.where == str(copy) and error.problem and error.mend
        else:
            assert k % 6 or len(damaged) > len(whole) - 100, "a file that was cut"
    assert refused > 290  # the others hit the seal itself


def test_an_unfinished_file_is_noticed(labelled, tmp_path):
    labelled.to_netcdf(tmp_path / "a.nc")
    with pytest.raises(InputError, match="completeness mark"):
        dataset.read(tmp_path / "a.nc")


def test_a_missing_file_is_told(tmp_path):
    with pytest.raises(InputError, match="no such file"):
        dataset.read(tmp_path / "a.nc")


def test_a_write_that_fails_leaves_the_old_file_and_nothing_else(labelled, tmp_path, monkeypatch):
    path = dataset.write(labelled, tmp_path / "a.nc")
    before = path.read_bytes()
    monkeypatch.setattr("os.replace", lambda *_: (_ for _ in ()).throw(RuntimeError("NetCDF: HDF error")))
    with pytest.raises(RuntimeError, match="HDF error"):
        dataset.write(labelled, path)
    assert path.read_bytes() == before and list(tmp_path.iterdir()) == [path]


def test_a_full_disk_is_told(labelled, tmp_path):
    """A limit on the size of files stands for the full disk: netCDF says only "HDF error" of either."""
    code = f"""
import resource, shutil, signal, types
import numpy as np, xarray as xr
from swingdown import dataset
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
noise = np.random.default_rng(1).standard_normal(200_000)
data = xr.Dataset({{"x": ("k", noise, {{"units": "1", "long_name": "noise"}})}})
resource.setrlimit(resource.RLIMIT_FSIZE, (100_000, 100_000))
dataset.shutil.disk_usage = lambda path: types.SimpleNamespace(free=90_000)
try:
    dataset.write(data, {str(tmp_path / "a.nc")!r})
except OSError as error:
    print(error.errno, error)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=120)
    assert done.stdout.startswith(f"{errno.ENOSPC} "), done.stdout + done.stderr
    assert "the disk is full" in done.stdout and "1.6 MB" in done.stdout and "0.09 MB are free" in done.stdout
    assert not list(tmp_path.iterdir())


def test_an_empty_dimension_is_no_reason_to_warn_when_the_rest_is_written_again(tmp_path):
    series = {"nothing": ("none", np.zeros(0)), "values": ("time", np.arange(3.0))}
    data = xr.Dataset(
        {name: (dim, one, {"units": "1", "long_name": name}) for name, (dim, one) in series.items()}
    )
    read = dataset.read(dataset.write(data.assign_attrs(title="a test"), tmp_path / "one.nc"))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        dataset.write(read[["values"]], tmp_path / "two.nc")


@pytest.mark.parametrize("name", ["angle", "rate"])
def test_a_series_and_its_parts_are_those_of_the_sensor(name):
    data = xr.Dataset({name: ("time", [1.0, 2.0]), f"{name}_bound": ("time", [0.1, 0.2])})
    assert list(dataset.series_of(data)) == [1.0, 2.0] and list(dataset.series_of(data, "bound")) == [
        0.1,
        0.2,
    ]
    with pytest.raises(KeyError):
        dataset.series_of(data, "random_uncertainty")


@pytest.mark.parametrize("links", [True, False], ids=["with links", "without"])
def test_what_must_not_replace_leaves_what_is_there(labelled, tmp_path, monkeypatch, links):
    def refused(*_):
        raise PermissionError(errno.EPERM, "no links on this file system")

    if not links:
        monkeypatch.setattr("swingdown.paths.os.link", refused)
    path = dataset.write(labelled, tmp_path / "runs" / "a.nc", replace=False)
    before = path.read_bytes()
    assert dataset.read(path).title == "runs: a"
    with pytest.raises(FileExistsError):
        dataset.write(labelled.assign_attrs(title="another"), path, replace=False)
    assert path.read_bytes() == before and list(path.parent.iterdir()) == [path]
