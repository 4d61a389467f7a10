"""A sweep in one Zarr store: every job writes its own part, and what is read lazily is what a netCDF file would hold."""

import json
import shutil
from multiprocessing import get_context
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from swingdown.errors import InputError
from swingdown.study.settings import complete
from swingdown.sweep import store
from swingdown.sweep.chunks import add_to_book, deal
from swingdown.sweep.combine import combine
from swingdown.sweep.job import work as job
from swingdown.sweep.table import sweeps


def sweep(kind="zarr", snr=(20, 50), realizations=12, fitted=("viscous", "load_coulomb")):
    entry = {"computes": "identification", "axes": {"simulation.simulated": ["viscous", "load_coulomb"], "simulation.snr": list(snr)},
             "settings": {"simulation.duration_s": 2.5, "simulation.start": "free", "simulation.fitted": list(fitted)},
             "realizations": realizations, "chunk": 10, "format": kind}  # fmt: skip
    return sweeps(complete({"sweeps": {"small": entry}}))["small"]


def jobs(chosen, folder):
    """The plan of a sweep in a folder, its book written and room made, as when a run starts."""
    dealt = deal(chosen, folder / "plan.jsonl")
    add_to_book(folder / "plan.jsonl", dealt.new)
    if chosen.format == "zarr":
        store.prepare(chosen, dealt, folder)
    ending = "json" if chosen.format == "zarr" else "nc"
    return dealt, [
        (folder / "plan.jsonl", stem, folder / "chunks" / f"{stem}.{ending}") for stem in dealt.files.values()
    ]


def run(chosen, folder):
    folder.mkdir(parents=True, exist_ok=True)
    _, order = jobs(chosen, folder)
    for one in order:
        job(*one)
    return combine(chosen, [path for *_, path in order], folder / "sweep.nc")


@pytest.fixture(scope="module")
def both(tmp_path_factory):
    """The folders of one sweep kept as netCDF, and in a store that two processes wrote at the same time."""
    netcdf, zarr = tmp_path_factory.mktemp("netcdf"), tmp_path_factory.mktemp("zarr")
    run(sweep("netcdf"), netcdf)
    _, order = jobs(sweep(), zarr)
    with get_context("spawn").Pool(2) as pool:
        pool.starmap(job, order[::-1], chunksize=1)
    combine(sweep(), [path for *_, path in order], zarr / "sweep.nc")
    return netcdf, zarr


def test_the_draws_in_the_store_are_those_of_the_netcdf_file_to_the_bit(both):
    one, cells = xr.load_dataset(both[0] / "sweep.nc"), xr.load_dataset(both[1] / "sweep.nc")
    draws = xr.open_zarr(both[1] / store.STORE, chunks=None)
    assert draws["norm"].dims == ("draw", "fitted") and draws["fitted"].values.tolist() == [
        "viscous",
        "load_coulomb",
    ]
    for name in ("norm", "residual_norm", "bic", "converged"):
        found = draws[name].isel(draw=cells["row"]).transpose(*one[name].dims)
        assert np.array_equal(found.values, one[name].values), name
    assert (draws["realization"].isel(draw=cells["row"]).values == np.arange(12)).all()
    for name in (
        "true_by_norm",
        "true_by_bic",
        "lowest_bic",
        "mean_norm",
        "unconverged",
        "true_by_norm_low_95",
        "made",
    ):
        assert np.allclose(cells[name], one[name], rtol=1e-12, equal_nan=True), name
    assert draws["norm"].attrs["units"] == "degrees"
    inside = xr.open_zarr(both[1] / store.STORE, group="cells", chunks=None)
    assert (
        np.array_equal(inside["row"].values, cells["row"].values)
        and inside["snr"].attrs["config_key"] == "simulation.snr"
    )


def files(folder):
    return {path: (path.stat().st_ino, path.stat().st_mtime_ns) for path in (folder / store.STORE).rglob("*")
            if path.is_file() and not path.name.startswith(".z") and "cells" not in path.parts}  # fmt: skip


def test_a_wider_table_adds_to_the_store_and_writes_nothing_again(tmp_path):
    run(sweep(), tmp_path)
    before, marks = files(tmp_path), set((tmp_path / "chunks").iterdir())
    wider = sweep(snr=(20, 35, 50), realizations=15)
    dealt, _ = jobs(wider, tmp_path)
    assert sum(dealt.chunks[name].draws for name in dealt.missing) == 2 * 15 + 4 * 3
    run(wider, tmp_path)
    after = files(tmp_path)
    assert {path: after[path] for path in before} == before
    assert marks < set((tmp_path / "chunks").iterdir())
    fresh = xr.load_dataset(run(sweep("netcdf", snr=(20, 35, 50), realizations=15), tmp_path / "fresh"))
    cells = xr.load_dataset(tmp_path / "sweep.nc")
    draws = xr.open_zarr(tmp_path / store.STORE, chunks=None)
    assert np.array_equal(draws["norm"].isel(draw=cells["row"]).values, fresh["norm"].values)


def test_a_chunk_that_is_whole_in_the_store_is_left_alone(tmp_path):
    run(sweep(), tmp_path)
    before = files(tmp_path)
    _, order = jobs(sweep(), tmp_path)
    assert "whole already" in job(*order[0])
    order[0][
        2
    ].unlink()  # as if the job had died before its mark: the same numbers are written in the same place
    old = xr.open_zarr(tmp_path / store.STORE, chunks=None)["norm"].values.copy()
    jobs(sweep(), tmp_path)
    job(*order[0])
    assert np.array_equal(
        xr.open_zarr(tmp_path / store.STORE, chunks=None)["norm"].values, old, equal_nan=True
    )
    assert set(files(tmp_path)) == set(before)


@pytest.mark.parametrize("older", [False, True])
def test_what_the_store_has_no_room_for_is_refused(tmp_path, older):
    run(sweep(), tmp_path)
    with pytest.raises(InputError, match="made without viscous\\+load_coulomb"):
        jobs(sweep(fitted=("viscous", "load_coulomb", "viscous+load_coulomb")), tmp_path)
    mark = sorted((tmp_path / "chunks").iterdir())[0]
    told = json.loads(mark.read_text())
    if older:  # marks once had no digests of themselves and the draws
        del told["sha256"], told["draws_sha256"]
    mark.write_text(json.dumps(told | {"first": told["first"] + 3}))
    words = "in another chunk too|does not hold what it says" if older else "damaged, or was edited"
    with pytest.raises(InputError, match=words):
        combine(sweep(), sorted((tmp_path / "chunks").iterdir()), tmp_path / "sweep.nc")


DAMAGES = {
    "emptied": lambda content, at: b"",
    "cut": lambda content, at: content[:at],
    "flipped": lambda content, at: content[:at] + bytes([content[at] ^ 16]) + content[at + 1 :],
}


def test_a_store_that_is_damaged_is_refused_by_a_run_that_opens_it_and_by_the_manifest(tmp_path):
    """Whatever file of it: draws, coordinates, units and all else that describes them, the group of cells."""
    run(sweep(), tmp_path)
    chunks = sorted((tmp_path / "chunks").iterdir())
    draws = np.random.default_rng(2)
    files = [path for path in sorted((tmp_path / store.STORE).rglob("*")) if path.is_file()]
    names = {path.relative_to(tmp_path / store.STORE).as_posix() for path in files}
    assert {"fitted/0", "fitted/.zarray", ".zmetadata", "norm/.zattrs", "norm/0.0", "cells/snr/0"} <= names
    for k, path in enumerate([*files, tmp_path / store.SUMS]):
        whole = path.read_bytes()
        damage = list(DAMAGES.values())[k % 3]
        path.write_bytes(damage(whole, int(draws.integers(len(whole)))))
        with pytest.raises(InputError, match="Mend: .*delete"):
            jobs(sweep(), tmp_path)  # before the first job
            combine(sweep(), chunks, tmp_path / "again.nc")
        with pytest.raises(InputError, match="Mend: .*delete"):
            store.check(tmp_path)
            store.check_draws(tmp_path)
        path.write_bytes(whole)
    jobs(sweep(), tmp_path)
    store.check(tmp_path)
    store.check_draws(tmp_path)


@pytest.mark.parametrize("damage", DAMAGES.values(), ids=DAMAGES)
def test_damaged_draws_are_mended_as_told(tmp_path, damage):
    """The mark of their chunk is deleted, and it is computed anew, into the same place: the last one, too, that fills no slot."""
    whole = xr.load_dataset(run(sweep(), tmp_path))
    for path in sorted((tmp_path / store.STORE / "norm").glob("[0-9]*")):
        before = path.read_bytes()
        path.write_bytes(damage(before, len(before) // 2))
        with pytest.raises(InputError, match="Mend: delete it and give the same command again") as caught:
            store.check_draws(tmp_path)
        Path(caught.value.where).unlink()
        xr.testing.assert_identical(xr.load_dataset(run(sweep(), tmp_path)), whole)
        assert path.read_bytes() == before


def test_a_damaged_group_of_cells_is_mended_as_told(tmp_path):
    run(sweep(), tmp_path)
    group = tmp_path / store.STORE / "cells"
    before = (group / "snr/0").read_bytes()
    (group / "snr/0").write_bytes(b"")
    with pytest.raises(InputError, match=r"cells/snr/0.*Mend: delete \S+/draws.zarr/cells and \S+/sweep.nc"):
        jobs(sweep(), tmp_path)
    shutil.rmtree(group)
    (tmp_path / "sweep.nc").unlink()
    run(sweep(), tmp_path)
    assert (group / "snr/0").read_bytes() == before


def test_a_run_killed_while_it_changes_the_store_is_not_taken_for_damage(tmp_path, monkeypatch):
    run(sweep(), tmp_path)
    with monkeypatch.context() as dies, pytest.raises(KeyboardInterrupt):
        dies.setattr("swingdown.sweep.store._add_sums", lambda *_: (_ for _ in ()).throw(KeyboardInterrupt()))
        jobs(sweep(realizations=30), tmp_path)
    run(sweep(realizations=30), tmp_path)
    fresh = xr.load_dataset(run(sweep("netcdf", realizations=30), tmp_path / "fresh"))
    rows = xr.load_dataset(tmp_path / "sweep.nc")["row"]
    found = xr.open_zarr(tmp_path / store.STORE, chunks=None)["norm"].isel(draw=rows)
    assert np.array_equal(found.values, fresh["norm"].values)


def test_chunks_that_are_damaged_are_refused(tmp_path):
    """Those in netCDF, at any byte; the library is not asked, which a damaged file can crash."""
    run(sweep("netcdf"), tmp_path)
    chunks = sorted((tmp_path / "chunks").iterdir())
    draws = np.random.default_rng(6)
    whole = chunks[0].read_bytes()
    for _ in range(10):
        at = int(draws.integers(len(whole) - 100))
        chunks[0].write_bytes(whole[:at] + bytes([whole[at] ^ 4]) + whole[at + 1 :])
        with pytest.raises(InputError, match="cannot be read.*Mend: delete it"):
            combine(sweep("netcdf"), chunks, tmp_path / "sweep.nc")


def test_a_store_is_opened_without_reading_it(both):
    data = xr.open_zarr(both[1] / store.STORE, chunks=None)
    assert not data["norm"].variable._in_memory and not data["key"].variable._in_memory
