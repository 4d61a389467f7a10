"""All draws of a sweep as one Zarr store that every job writes its own part of, at the same time as the others.

The store has a dimension ``draw``; a job writes whole chunks of it, which no other job touches, and then the mark
``chunks/NAME-CODE.json``, which has their checksums. Those of all else in the store are ``draws.sha256``. Where a job's draws begin
stands in ``slots.jsonl``, which is only added to. ``sweep.nc`` (and in the store the group ``cells``) has ``row``: where along
``draw`` each draw of each cell is.
"""

import hashlib
import json
import os
from contextlib import contextmanager
from importlib import import_module
from pathlib import Path

import numpy as np

from .. import sealed
from ..errors import MAKE_ANEW, InputError
from ..manifest import checksum

STORE, SLOTS, SUMS = "draws.zarr", "slots.jsonl", "draws.sha256"
_TYPES = {"converged": "i1"}


def prepare(sweep, plan, folder):
    """The path of the store, with room for the chunks of the plan that are not computed; what is there stays where it is.

    InputError where the store is damaged, or the sweep lists its variables by something that it, once made, has no room for.
    """
    import zarr

    check(folder)

    folder = Path(folder)
    computation, path = import_module(f".{sweep.computes}", __package__), folder / STORE
    listed = list(
        dict.fromkeys(name for values in sweep for name in computation.entries(sweep.cell(values)) or ())
    )
    with _reading(path):
        group = zarr.open_group(path, mode="a", zarr_format=2)
    if "slot" not in group.attrs:
        _remove_sums(folder)
        group.attrs.update(
            {"slot": sweep.chunk, "listed": listed, "computes": sweep.computes, "sweep": sweep.name}
        )
        _create(group, computation, listed, sweep.chunk)
    if lost := [name for name in listed if name not in group.attrs["listed"]]:
        raise InputError(path, f"it was made without {lost[0]}", f"only {', '.join(group.attrs['listed'])}",
                         "give the sweep another name, or keep it as netcdf")  # fmt: skip
    slots = read_slots(folder)
    taken = max((first + count for first, count in slots.values()), default=0)
    lines = []
    for name in plan.missing:
        stem = plan.files[name]
        if stem not in slots:
            count = -(-plan.chunks[name].draws // group.attrs["slot"])
            lines.append(json.dumps([stem, taken, count]))
            taken += count
    if lines:
        _remove_sums(folder)
        for name in [*computation.VARIABLES, "key", "realization"]:
            one = group[name]
            if one.shape[0] < taken * group.attrs["slot"]:
                one.resize((taken * group.attrs["slot"], *one.shape[1:]))
        before = sealed.read_text(folder / SLOTS) if (folder / SLOTS).exists() else ""
        sealed.write_text(folder / SLOTS, before + "\n".join(lines) + "\n")
        zarr.consolidate_metadata(path)
    if not (folder / SUMS).exists():
        _add_sums(folder)
    return path


def check(folder):
    """None where all of the store but its draws is what was written, or has no sums; InputError for the file that is not.

    What changes the store takes the sums away before, and adds them after: who is killed between leaves none.
    """
    folder = Path(folder)
    for line in sealed.read_text(folder / SUMS).splitlines() if (folder / SUMS).exists() else ():
        digest, _, name = line.partition("  ")
        path, cells = folder / name, folder / STORE / "cells"
        inside = cells in path.parents
        if (inside and not cells.exists()) or (path.is_file() and checksum(path) == digest):
            continue
        mend = (
            f"delete {cells} and {folder / 'sweep.nc'}, and give the same command again, which makes both anew"
            if inside
            else f"put back a copy of it; or delete {folder} and give the same command again, which computes the sweep anew"
        )
        raise InputError(path, "it is damaged, or was edited", f"what {SUMS} was taken of", mend)


def check_draws(folder):
    """None where the draws of every chunk in the store are those that its mark tells; InputError where they are not."""
    for mark in sorted((Path(folder) / "chunks").glob("[!.]*.json")):
        for _ in parts(mark):
            pass


def _remove_sums(folder):
    (folder / SUMS).unlink(missing_ok=True)
    sealed.seal_of(folder / SUMS).unlink(missing_ok=True)


def _add_sums(folder):
    """The checksums of the files that describe the draws: all but the draws themselves; in the form of ``sha256sum``."""
    import zarr

    path = folder / STORE
    group = zarr.open_group(path, mode="r", use_consolidated=False)
    draws = {"key", "realization", *_variables(group)}
    files = [
        one
        for one in sorted(path.rglob("*"))
        if one.is_file()
        and (one.name.startswith(".z") or one.parent.name not in draws or one.parent.parent != path)
    ]
    lines = [f"{checksum(one)}  {one.relative_to(folder).as_posix()}\n" for one in files]
    sealed.write_text(folder / SUMS, "".join(lines))


def _create(group, computation, listed, slot):
    several = (len(listed),) if computation.DIMENSION else ()
    dims = ["draw", computation.DIMENSION] if several else ["draw"]
    for name, (units, meaning) in computation.VARIABLES.items():
        words = getattr(computation, "FLAGS", {}).get(name)
        kind = "i1" if words or name in _TYPES else "f8"
        told = {"long_name": meaning} | ({"units": units} if units else {})
        told |= {"flag_values": list(range(len(words))), "flag_meanings": " ".join(words)} if words else {}
        fill = float("nan") if kind == "f8" else -1
        group.create_array(name, shape=(0, *several), chunks=(slot, *several), dtype=kind, fill_value=fill,
                           attributes=told | {"_ARRAY_DIMENSIONS": dims})  # fmt: skip
    for name, kind, fill, meaning in (
        (
            "key",
            "u8",
            0,
            "the cell: the first 16 hexadecimal digits of its key as a number; 0 where no draw is",
        ),
        ("realization", "i4", -1, "index of the draw"),
    ):
        group.create_array(name, shape=(0,), chunks=(slot,), dtype=kind, fill_value=fill,
                           attributes={"long_name": meaning, "_ARRAY_DIMENSIONS": ["draw"]})  # fmt: skip
    if several:
        made = group.create_array(computation.DIMENSION, shape=several, dtype=f"<U{max(map(len, listed))}",
                                  attributes={"long_name": "fitted model", "_ARRAY_DIMENSIONS": [computation.DIMENSION]})  # fmt: skip
        made[:] = np.array(listed)


def read_slots(folder):
    """(first slot, number of slots) of each chunk in the store, by the name of its results."""
    path = Path(folder) / SLOTS
    lines = sealed.read_text(path).splitlines() if path.exists() else []
    return {stem: (first, count) for stem, first, count in map(json.loads, lines)}


def write(data, stem, mark):
    """Whether a chunk's Dataset (``compute``) was written into the store beside the folder of ``mark``, and the mark after it."""
    import zarr

    from .compute import appear

    mark = Path(mark)
    folder = mark.parent.parent
    group = zarr.open_group(folder / STORE, mode="r+", use_consolidated=False)
    if stem not in (slots := read_slots(folder)):
        raise InputError(folder / SLOTS, f"no place for chunk {stem}", "a line that lists it",
                         "run the sweep again: it makes room before its jobs")  # fmt: skip
    if mark.exists():
        return False
    slot = group.attrs["slot"]
    first, room, size = slots[stem][0] * slot, slots[stem][1] * slot, data.sizes["draw"]
    keys = [str(key) for key in data["key"].values]
    numbers = np.array([int(key[:16], 16) for key in keys], np.uint64)
    columns = {"key": numbers[data["cell"].values], "realization": data["realization"].values}
    for name, one in data.data_vars.items():
        if name in group and one.dims[:1] == ("draw",) and name != "realization":
            columns[str(name)] = one.values
            if one.ndim > 1:
                own = [group.attrs["listed"].index(str(entry)) for entry in data[one.dims[1]].values]
                columns[str(name)] = np.full((size, len(group.attrs["listed"])), group[name].fill_value)
                columns[str(name)][:, own] = one.values
    for name, values in columns.items():
        # the slots whole: of what may lie there, damaged, nothing is read
        whole = np.full((room, *values.shape[1:]), group[name].fill_value, group[name].dtype)
        whole[:size] = values
        group[name][first : first + room] = whole
    reasons = {key: str(why) for key, why in zip(keys, data["reason"].values, strict=True) if str(why)}
    told = {key: data.attrs[key] for key in ("computes", "code", "swingdown", "cpu_s")}
    told |= {"first": first, "draws": size, "keys": keys, "reasons": reasons}
    told["draws_sha256"] = _digests(group, slice(first, first + size))
    told["sha256"] = _digest_of(told)
    mark.parent.mkdir(parents=True, exist_ok=True)
    partial = mark.with_name(f".{mark.name}.{os.uname().nodename}.{os.getpid()}")
    try:
        partial.write_text(json.dumps(told) + "\n", encoding="utf-8")
        return appear(partial, mark)
    finally:
        partial.unlink(missing_ok=True)


def parts(mark):
    """What ``parts.parts`` gives, of a chunk in the store, with ``row``, where along ``draw`` the block is, among the variables."""
    import zarr

    told = read_mark(mark)
    with _reading(mark):
        group = zarr.open_group(Path(mark).parent.parent / STORE, mode="r", use_consolidated=False)
    here = slice(told["first"], told["first"] + told["draws"])
    with _reading(mark, MAKE_ANEW):
        found = _digests(group, here)
    if any(found.get(name) != digest for name, digest in told.get("draws_sha256", {}).items()):
        raise InputError(mark, "the draws in the store are not those that were written", "undamaged draws",
                         MAKE_ANEW)  # fmt: skip
    numbers, draws = group["key"][here], group["realization"][here]
    names = {int(key[:16], 16): key for key in told["keys"]}
    if not set(map(int, np.unique(numbers))) <= set(names):
        raise InputError(mark, "the store does not hold what it says", "draws of the cells that it lists",
                         MAKE_ANEW)  # fmt: skip
    found = {name: group[name][here] for name in _variables(group)}
    found["row"] = np.arange(here.start, here.stop)
    edges = np.flatnonzero((np.diff(numbers) != 0) | (np.diff(draws) != 1)) + 1
    for first, last in zip([0, *edges], [*edges, draws.size], strict=True):
        yield (
            names[int(numbers[first])],
            int(draws[first]),
            {name: one[first:last] for name, one in found.items()},
        )


def about(mark):
    """What ``parts.about`` gives, of a chunk in the store."""
    import zarr

    told = read_mark(mark)
    with _reading(mark):
        group = zarr.open_group(Path(mark).parent.parent / STORE, mode="r", use_consolidated=False)
        dims = {name: tuple(group[name].attrs["_ARRAY_DIMENSIONS"]) for name in _variables(group)}
    dimension = next((one[1] for one in dims.values() if len(one) > 1), None)
    variables = {
        name: (
            group[name].dtype,
            dims[name],
            {key: value for key, value in group[name].attrs.items() if key != "_ARRAY_DIMENSIONS"},
        )
        for name in dims
    }
    return {
        "listed": (dimension, list(group.attrs["listed"])),
        "variables": variables,
        "reasons": told["reasons"],
        "attributes": told,
    }


@contextmanager
def _reading(where, mend="delete the sweep's folder and give the same command again, which computes it anew"):
    """A block that reads the store: whatever goes wrong with its files is told as an InputError."""
    try:
        yield
    except (InputError, MemoryError):
        raise
    except Exception as error:  # damage makes zarr fail in ways that nobody listed
        raise InputError(where, f"the store cannot be read ({' '.join(str(error).split())})", f"an undamaged {STORE}",
                         mend) from error  # fmt: skip


def read_mark(mark):
    """What the mark of a chunk in the store tells; InputError where it is damaged. An older one carries no digest of itself."""
    content = sealed.read_json(mark)
    if not isinstance(content, dict) or ("sha256" in content and content["sha256"] != _digest_of(content)):
        raise InputError(mark, "it is damaged, or was edited", "what its own sha256 was taken of",
                         MAKE_ANEW)  # fmt: skip
    return content


def _digest_of(told):
    text = json.dumps({key: value for key, value in told.items() if key != "sha256"}, sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()


def _digests(group, here):
    """The SHA-256 of a chunk's draws as they are read back, by variable."""
    names = ["key", "realization", *_variables(group)]
    return {
        name: hashlib.sha256(np.ascontiguousarray(group[name][here]).tobytes()).hexdigest() for name in names
    }


def _variables(group):
    return [
        name
        for name, one in group.arrays()
        if one.ndim and name not in ("key", "realization") and one.attrs["_ARRAY_DIMENSIONS"][0] == "draw"
    ]


def add_cells(folder, cells):
    """The store with the Dataset ``cells`` as its group ``cells``, in place of what was there."""
    import zarr

    folder = Path(folder)
    path = folder / STORE
    _remove_sums(folder)
    cells.to_zarr(path, group="cells", mode="w", zarr_format=2, consolidated=False)
    zarr.consolidate_metadata(path)
    _add_sums(folder)
    return path
