"""A sweep in one Zarr store: what is read of it is what a netCDF file would hold."""

import made_up
import numpy as np
import pytest
import xarray as xr

from swingdown.errors import InputError
from swingdown.planning.settings import complete
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


def run(chosen, folder):
    """The combined sweep in a folder, every job done as a run does them."""
    folder.mkdir(parents=True, exist_ok=True)
    dealt = deal(chosen, folder / "plan.jsonl")
    add_to_book(folder / "plan.jsonl", dealt.new)
    paths = [folder / "chunks" / f"{stem}.nc" for stem in dealt.files.values()]
    for path in paths:
        job(folder / "plan.jsonl", path.stem, path)
    return combine(chosen, paths, folder / "sweep.nc")


@pytest.fixture(scope="module", params=[1 << 15, 7], ids=["whole", "across cells"])
def both(request, tmp_path_factory):
    """The folders of one sweep kept as netCDF, and in a store that is written so many draws at a time."""
    netcdf, zarr = tmp_path_factory.mktemp("netcdf"), tmp_path_factory.mktemp("zarr")
    run(sweep("netcdf"), netcdf)
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(store, "_BLOCK", request.param)
        run(sweep(), zarr)
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


def test_verdicts_of_a_search_are_in_a_store_too(tmp_path):
    """They are listed by nothing beside the draw, and their outcomes are numbers with a meaning."""
    entry = {"computes": "detection", "axes": {"detection.size": [0, 2]}, "realizations": 9, "chunk": 4,
             "settings": {"detection.effect": "constant_torque"}}  # fmt: skip
    kept = {}
    for kind in ("netcdf", "zarr"):
        (chosen,) = sweeps(complete({"sweeps": {"small": entry | {"format": kind}}})).values()
        paths = made_up.write(
            chosen, tmp_path / kind, made_up.verdicts(lambda one: {"named": 0.5, "nothing": 0.5})
        )
        kept[kind] = xr.load_dataset(combine(chosen, paths, tmp_path / kind / "sweep.nc"))
    draws = xr.open_zarr(tmp_path / "zarr" / store.STORE, chunks=None)
    for name in ("outcome", "gap"):
        assert np.array_equal(draws[name].isel(draw=kept["zarr"]["row"]).values, kept["netcdf"][name].values)
    assert "named" in draws["outcome"].attrs["flag_meanings"] and draws["outcome"].dtype == np.int8
    assert "outcome" not in kept["zarr"]


def test_a_wider_table_makes_the_store_anew_and_computes_no_chunk_again(tmp_path):
    run(sweep(), tmp_path)
    before = {path: path.stat().st_mtime_ns for path in (tmp_path / "chunks").iterdir()}
    wider = sweep(snr=(20, 35, 50), realizations=15, fitted=("viscous", "load_coulomb"))
    run(wider, tmp_path)
    assert {path: path.stat().st_mtime_ns for path in before} == before
    fresh = xr.load_dataset(run(sweep("netcdf", snr=(20, 35, 50), realizations=15), tmp_path / "fresh"))
    cells = xr.load_dataset(tmp_path / "sweep.nc")
    draws = xr.open_zarr(tmp_path / store.STORE, chunks=None)
    assert draws.sizes["draw"] == 2 * 3 * 15
    assert np.array_equal(draws["norm"].isel(draw=cells["row"]).values, fresh["norm"].values)
    store.check(tmp_path)


DAMAGES = {
    "emptied": lambda content, at: b"",
    "cut": lambda content, at: content[:at],
    "flipped": lambda content, at: content[:at] + bytes([content[at] ^ 16]) + content[at + 1 :],
}


def test_a_store_that_is_damaged_is_refused_and_mended_as_told(tmp_path):
    """Whatever file of it: draws, coordinates, units and all else that describes them, the group of cells."""
    run(sweep(), tmp_path)
    draws = np.random.default_rng(2)
    files = [path for path in sorted((tmp_path / store.STORE).rglob("*")) if path.is_file()]
    names = {path.relative_to(tmp_path / store.STORE).as_posix() for path in files}
    assert {"fitted/0", "fitted/.zarray", ".zmetadata", "norm/.zattrs", "norm/0.0", "cells/snr/0"} <= names
    for k, path in enumerate([*files, tmp_path / store.SUMS]):
        whole = path.read_bytes()
        damage = list(DAMAGES.values())[k % 3]
        path.write_bytes(damage(whole, int(draws.integers(len(whole)))))
        with pytest.raises(InputError, match="Mend: .*delete"):
            store.check(tmp_path)
        path.write_bytes(whole)
    store.check(tmp_path)
    (tmp_path / store.STORE / "norm/0.0").write_bytes(b"")
    with pytest.raises(InputError, match=r"norm/0.0.*Mend: delete \S+/sweep.nc"):
        store.check(tmp_path)
    (tmp_path / "sweep.nc").unlink()
    run(sweep(), tmp_path)
    store.check(tmp_path)


def test_a_run_killed_while_it_writes_leaves_the_store_that_was_there(tmp_path, monkeypatch):
    run(sweep(), tmp_path)
    with monkeypatch.context() as dies, pytest.raises(KeyboardInterrupt):
        dies.setattr(store, "needed", lambda *_: (_ for _ in ()).throw(KeyboardInterrupt()))
        run(sweep(realizations=30), tmp_path)
    store.check(tmp_path)
    assert xr.open_zarr(tmp_path / store.STORE, chunks=None).sizes["draw"] == 2 * 2 * 12
    assert not list(tmp_path.glob("*.part")) and not list(tmp_path.glob(".*.part"))
    rows = xr.load_dataset(tmp_path / "sweep.nc")["row"]
    assert rows.size == 2 * 2 * 12


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
    assert not data["norm"].variable._in_memory and not data["bic"].variable._in_memory
