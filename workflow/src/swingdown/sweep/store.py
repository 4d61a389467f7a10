"""The draws of a combined sweep as one Zarr store: what of it is asked for is read, and nothing else.

It has a dimension ``draw``, on which all draws of a cell lie one behind the other; ``row`` in ``sweep.nc`` (and in the store's group
``cells``) says where each is. Chunks stay the netCDF files that jobs wrote, so the store can be made anew at any time.
"""

import shutil
from pathlib import Path

import numpy as np
import xarray as xr

from .. import dataset, sealed
from ..errors import InputError
from ..extras import needed
from ..paths import checksum

STORE, SUMS = "draws.zarr", "draws.sha256"
_BLOCK = 1 << 15  # draws that lie together in a file, and in the memory
_ROW = {"long_name": "where along the dimension draw of the Zarr store this draw is"}


def move(path, folder):
    """The path of the store written into ``folder``; the combined sweep in the netCDF file ``path`` has ``row`` in place of its draws.

    The store appears whole or not at all, with the checksums of its files beside it (``draws.sha256``, as ``sha256sum`` has them).
    """
    folder = Path(folder)
    partial = folder / f".{STORE}.part"
    shutil.rmtree(partial, ignore_errors=True)
    try:
        with xr.open_dataset(path, engine="netcdf4", decode_times=False, decode_timedelta=False) as whole:
            names = [name for name, one in whole.items() if "realization" in one.dims]
            axes = whole[names[0]].dims[: len(whole.attrs["axes"].split())]
            shape = tuple(whole.sizes[name] for name in (*axes, "realization"))
            draws = whole[names]
            along = {*axes, "realization"}  # of the coordinates alone what the draws are listed by is kept
            draws = draws.drop_vars([name for name, one in draws.coords.items() if along & {*one.dims}])
            for first in range(0, int(np.prod(shape)), _BLOCK):
                part = _block(draws, axes, shape, first)
                chunks = {name: {"chunks": (_BLOCK, *one.shape[1:])} for name, one in part.items()}
                how = {"append_dim": "draw"} if first else {"mode": "w", "encoding": chunks}
                part.to_zarr(partial, zarr_format=2, consolidated=False, **how)
            rows = np.arange(np.prod(shape)).reshape(shape)
            cells = whole.drop_vars(names).assign(row=((*axes, "realization"), rows, _ROW)).load()
        cells.to_zarr(partial, group="cells", mode="w", zarr_format=2, consolidated=False)
        needed("zarr").consolidate_metadata(partial)
        dataset.write(cells, path)
        shutil.rmtree(folder / STORE, ignore_errors=True)
        partial.rename(folder / STORE)
    finally:
        shutil.rmtree(partial, ignore_errors=True)
    files = sorted(one for one in (folder / STORE).rglob("*") if one.is_file())
    lines = [f"{checksum(one)}  {one.relative_to(folder).as_posix()}\n" for one in files]
    sealed.write_text(folder / SUMS, "".join(lines))
    return folder / STORE


def check(folder):
    """None where every file of the store is what was written; InputError for the one that is not."""
    folder = Path(folder)
    for line in sealed.read_text(folder / SUMS).splitlines():
        digest, _, name = line.partition("  ")
        path = folder / name
        if not path.is_file() or checksum(path) != digest:
            mend = f"delete {folder / 'sweep.nc'} and give the same command again, which makes both anew"
            raise InputError(path, "it was damaged or edited", f"the bytes whose checksum is in {SUMS}", mend)


def _block(draws, axes, shape, first):
    """The Dataset (draw, …) of the draws from ``first`` on, at most ``_BLOCK`` of them."""
    each, last = shape[-1], min(first + _BLOCK, int(np.prod(shape)))
    parts = []
    for cell in range(first // each, -(-last // each)):
        at = dict(zip(axes, np.unravel_index(cell, shape[:-1]), strict=True))
        within = np.arange(max(first - cell * each, 0), min(last - cell * each, each))
        one = draws.isel(at | {"realization": within}).load()
        parts.append(one.assign(index=("realization", within.astype(np.int32))))
    found = xr.concat(parts, "realization").rename(realization="draw").rename(index="realization")
    found["realization"].attrs = {"long_name": "index of the draw"}
    return found.drop_encoding()
