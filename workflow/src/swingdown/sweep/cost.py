"""What a sweep will take: counted from its plan, timed on this machine, and which of its cells cannot be made."""

import time
from importlib import import_module

import numpy as np

from .impossible import IMPOSSIBLE, reason

_TRIAL = 0.7  # seconds of CPU after which the trial ends
_FORESEE = 0.5  # the same of the search for cells that cannot be made
_DRAWS = 32  # side by side they cost much less than one by one
_CELLS = 64
_BYTES = 26  # a fit or verdict on disk, compressed, measured


def estimate(sweep, plan, missing):
    """Lines that say what is still to compute: fits, chunks, hours from a trial on this machine, files and bytes.

    ``missing`` are the plan's chunks that have no results yet. The trial computes a few draws of cells spread over the table;
    cells that cannot be made, of as many as half a second allows to try, are told with their reason. So are chunks of other code.
    """
    computation = import_module(f".{sweep.computes}", __package__)
    draws = sum(plan.chunks[name].draws for name in missing)
    per_draw = computation.fits(sweep.cell(next(iter(sweep))))
    unit = "fits" if computation.DIMENSION else "verdicts"
    all_of_it = f"sweep {sweep.name}: {sweep.cells:,} cells × {sweep.realizations:,} draws = {sweep.cells * sweep.realizations * per_draw:,} {unit}"
    size = f"{_BYTES * sweep.cells * sweep.realizations * per_draw / 1e6:,.1f} MB"
    lines = [f"{all_of_it} in {len(plan.chunks):,} chunks ({size})", *outdated(plan)]
    if not draws:
        return [*lines, "  every chunk is there"]
    parts = sum(len(plan.chunks[name].parts) for name in missing)
    per_part, rate = seconds(sweep, computation)
    took = parts * per_part + draws * rate
    lines.append(
        f"  to compute: {draws * per_draw:,} {unit} in {len(missing):,} chunks, {_time(took)} of CPU at {1e3 * took / draws / per_draw:.3g} ms "
        f"a {unit[:-1]} (timed just now), {_time(took / len(missing))} a chunk"
    )
    return [*lines, *foreseen(sweep, computation)]


def outdated(plan):
    """A line that tells chunks which other code computed, and how to have them computed again; none where there are none."""
    if plan.outdated:
        versions = ", ".join(sorted({one or "unknown" for one in plan.outdated.values()}))
        yield (
            f"  {len(plan.outdated):,} of {len(plan.chunks):,} chunks were computed by other code ({versions}) and are kept; "
            "`--config recompute=true` computes them again, beside the old ones"
        )


def foreseen(sweep, computation):
    """Lines that tell cells which cannot be made, those with the largest hidden effects tried first."""
    cells = list(sweep)
    order = [cells[k] for k in np.random.default_rng(2).permutation(len(cells))]
    if "detection.size" in sweep.keys:
        at = sweep.keys.index("detection.size")
        order.sort(key=lambda values: -values[at])
    lost, tried, began = {}, 0, time.process_time()
    for values in order:
        if time.process_time() - began > _FORESEE:
            break
        tried += 1
        try:
            computation.foresee(sweep.cell(values))
        except IMPOSSIBLE as error:
            lost.setdefault(reason(error), []).append(values)
    for why, those in lost.items():
        first = ", ".join(f"{key} {value}" for key, value in zip(sweep.keys, those[0], strict=True))
        yield f"  cannot be made: {len(those):,} of {tried:,} cells tried ({sweep.cells:,} in all): {why} (the first: {first}); they are reported as such, and stop nothing"


def seconds(sweep, computation):
    """(seconds of CPU a cell takes before its first draw, seconds a draw takes) here, averaged over cells of the table."""
    chosen = set(np.random.default_rng(0).permutation(sweep.cells)[:_CELLS])
    settings = [sweep.cell(values) for number, values in enumerate(sweep) if number in chosen]
    if computation.DIMENSION:
        computation.results(settings[0], 0, 1)  # the engine is loaded, or compiled
    found, began = [], time.process_time()
    for one in np.random.default_rng(1).permutation(len(settings)):
        start = time.process_time()
        computation.results(settings[one], 0, 1)
        first = time.process_time() - start
        if first > _TRIAL:  # what a cell takes before its first draw does not count beside that
            found.append((0.0, first))
            break
        again = time.process_time()
        computation.results(settings[one], 0, _DRAWS if computation.DIMENSION else 2)
        both = time.process_time() - again
        if computation.DIMENSION:  # what the cell's draws share is known by now
            found.append((first, both / _DRAWS))
        else:
            each = max(both - first, 0.0)
            found.append((max(first - each, 0.0), each))
        if time.process_time() - began > _TRIAL:
            break
    return tuple(map(float, np.mean(found, axis=0)))


def _time(seconds):
    if seconds < 120:
        return f"{seconds:.3g} s"
    return f"{seconds / 60:.3g} min" if seconds < 7200 else f"{seconds / 3600:,.3g} h"
