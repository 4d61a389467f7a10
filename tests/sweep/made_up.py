"""Chunks of a sweep with made-up results, for tests of what becomes of them: nothing is fitted or searched."""

import numpy as np
import xarray as xr

from swingdown.dataset import write as write_whole
from swingdown.sweep import compute, detection, identification
from swingdown.sweep.chunks import add_to_book, deal

COMPUTES = {"identification": identification, "detection": detection}


def results(chunk, results_of):
    """The Dataset of a chunk, as ``compute`` makes it; ``results_of(settings, first, count)`` stands for the computation."""

    class Module:
        DIMENSION = COMPUTES[chunk.computes].DIMENSION
        VARIABLES = COMPUTES[chunk.computes].VARIABLES
        FLAGS = getattr(COMPUTES[chunk.computes], "FLAGS", {})
        entries = staticmethod(COMPUTES[chunk.computes].entries)
        fits = staticmethod(COMPUTES[chunk.computes].fits)
        results = staticmethod(results_of)

    return compute.compute(chunk, Module)[0]


def write(sweep, folder, results_of):
    """The paths of all chunks of a sweep, written with made-up results into a folder."""
    dealt = deal(sweep, folder / "plan.jsonl", "0" * 8)
    add_to_book(folder / "plan.jsonl", dealt.new)
    paths = []
    for name, chunk in dealt.chunks.items():
        paths.append(folder / "chunks" / f"{dealt.files[name]}.nc")
        write_whole(results(chunk, results_of), paths[-1], replace=False)
    return paths


def verdicts(shares, left=None, none=()):
    """A function for ``write`` that gives every outcome as often as ``shares(settings)`` says, in order; cells of the effects
    ``none`` are not made.
    """
    words = detection.OUTCOMES

    def made(settings, first, count):
        size = settings["detection.size"]
        found = {
            "outcome": np.empty(count, np.int8), "answer": np.zeros(count, np.int8), "coefficient": np.full(count, 0.1),
            "left": np.full(count, left(settings) if left else size), "gap": np.full(count, 1.0 + size) + 1e-3 * np.arange(first, first + count),
        }  # fmt: skip
        if settings["detection.effect"] in none and size:
            found["outcome"][:] = words.index("not_made")
            return found | {
                name: np.full(count, np.nan) for name in ("coefficient", "left", "gap")
            }, "the angle crosses its middle fewer than twice"
        edges = np.cumsum([shares(settings).get(word, 0) for word in words])
        found["outcome"][:] = [
            int(np.searchsorted(edges, ((first + k) % 100 + 0.5) / 100)) for k in range(count)
        ]
        return found, ""

    return made


def dataset(path):
    """A Dataset loaded whole."""
    return xr.load_dataset(path)
