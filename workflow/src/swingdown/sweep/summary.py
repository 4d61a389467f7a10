"""What a sweep says: for every cell, how often each answer was given, and the table of it."""

import math
from functools import cache

import numpy as np
import pandas as pd
from scipy.stats import binomtest

from .parts import texts
from .parts import values as plain

REACHED = 0.05  # share of the size asked for within which what a hidden effect leaves counts as that size
LEVEL = 0.95  # of every interval that is told
TEN = 10  # runs whose mean norm the paper compares
_SINGLE = ("viscous", "quadratic_drag", "load_coulomb")
_BLOCK = 32760  # draws read at a time, whole sets of ten
PACKED = {"zlib": True, "complevel": 4, "fletcher32": True}  # how netCDF4 keeps a variable


def _ends(*names):
    """Entries for the ends of probabilities' intervals."""
    return {
        f"{name}_{end}_95": ((), "1", f"{end} end of the 95 % interval (Wilson) of {name}")
        for name in names
        for end in ("low", "high")
    }


# name: dimensions beside the axes, unit, meaning
BOTH = {
    "made": ((), "1", "number of draws that could be made"),
    "independent": (
        (),
        "1",
        "number of draws made that are not all alike: 1 where nothing is drawn, as by quantisation",
    ),
}
IDENTIFICATION = BOTH | {
    "lowest_norm": (("fitted",), "1", "share of draws in which the model is closest to the noise-free swing"),
    "lowest_bic": (("fitted",), "1", "share of draws in which the model has the lowest BIC"),
    "mean_norm": (("fitted",), "degrees", "mean norm: RMS of fit minus noise-free truth"),
    "unconverged": (("fitted",), "1", "share of draws whose fit did not end at a stationary point"),
    "true_by_norm": ((), "1", "share of draws in which the true model has the lowest norm"),
    "true_by_bic": ((), "1", "share of draws in which the true model has the lowest BIC"),
    "true_by_ten": (
        (),
        "1",
        "share of sets of ten draws in which the true model has the lowest mean norm of the paper's four",
    ),
    "sets_of_ten": ((), "1", "number of sets of ten draws, 1 where all draws are alike"),
    **_ends("true_by_norm", "true_by_bic", "true_by_ten"),
}
DETECTION = BOTH | {
    "share": (("said",), "1", "share of the campaigns that could be made in which discovery said so"),
    "found": ((), "1", "share of campaigns in which something is reported missing"),
    "named": ((), "1", "share of campaigns in which the hidden effect was named, and it alone"),
    "size_of_effect": ((), "see the hidden effect's first parameter", "size of the hidden effect"),
    "left_by_base": ((), "1", "RMS that the base model leaves of the noise-free swings, over the noise"),
    "mean_gap": ((), "1", "mean RMS that the base model leaves, over the noise that discovery measured"),
    "reached": (
        (),
        "1",
        "1 where the hidden effect leaves what was asked for (to 5 %), 0 where no size of it does",
    ),
    **_ends("found", "named"),
}


def add(file, sweep, reasons):
    """The open netCDF4 ``file`` of a combined sweep with variables for the cells' probabilities, and why cells were not made: the
    ``reasons`` by the cell's index."""
    kinds, axes = _kinds(sweep), tuple(axis.dim for axis in sweep.axes)
    if sweep.computes == "detection":
        from .detection import OUTCOMES

        file.createDimension("said", len(OUTCOMES))
        said = file.createVariable("said", str, ("said",))
        said.long_name = "what discovery said"
        said[:] = np.array(OUTCOMES, dtype=object)
    for name, (more, units, meaning) in kinds.items():
        made = file.createVariable(name, "f8", (*axes, *more), fill_value=np.nan, **PACKED)
        made.setncatts({"units": units, "long_name": meaning})
    told = np.full(sweep.shape, "", dtype=object)
    for index, why in reasons.items():
        told[index] = why
    why = file.createVariable("reason", str, axes)
    why.long_name = "why not, where a cell or a draw of it could not be made"
    why[...] = told


def from_file(file, sweep):
    """The probabilities of a combined sweep, with their intervals, written to the open ``file``: a block of a cell's draws at a time."""
    identifies = sweep.computes == "identification"
    make = _Identified if identifies else _Detected
    entries = texts(file["fitted" if identifies else "said"])
    names = [name for name in make.reads if name in file.variables]
    found = {name: np.full(file[name].shape, np.nan) for name in _kinds(sweep)}
    for index, values in zip(np.ndindex(sweep.shape), sweep, strict=True):
        cell = make(sweep.cell(values), entries)
        for first in range(0, sweep.realizations, _BLOCK):
            here = slice(first, min(first + _BLOCK, sweep.realizations))
            cell.feed({name: plain(file[name][(*index, here)]) for name in names})
        for name, value in cell.told().items():
            found[name][index] = value
    for name in [name.removesuffix("_low_95") for name in found if name.endswith("_low_95")]:
        counted = found["sets_of_ten" if name == "true_by_ten" else "independent"]
        found[f"{name}_low_95"], found[f"{name}_high_95"] = intervals(found[name], counted)
    for name, values in found.items():
        file[name][...] = values


class _Cell:
    """Draws counted, and whether they are all alike: then they say no more than one."""

    def __init__(self):
        self.made, self._alike, self._first = 0, True, None

    def _count(self, rows, made):
        self.made += int(np.count_nonzero(made))
        rows = rows[made]
        if len(rows):
            self._first = rows[:1] if self._first is None else self._first
            first = np.repeat(self._first, len(rows), axis=0)
            self._alike = self._alike and np.array_equal(rows, first, equal_nan=True)

    def _counted(self):
        return {"made": self.made, "independent": min(self.made, 1) if self._alike else self.made}


class _Identified(_Cell):
    """How often each model was the closest one to the truth, and had the lowest BIC."""

    reads = ("norm", "residual_norm", "bic", "converged")

    def __init__(self, settings, fitted):
        super().__init__()
        (truth,) = settings["simulation.simulated"]
        self._at = fitted.index(truth) if truth in fitted else None
        zeros = np.zeros(len(fitted))
        self._norm, self._bic, self._sum, self._finite, self._converged = (zeros.copy() for _ in range(5))
        four = [*_SINGLE, "+".join(name for name in _SINGLE if name != truth)]
        known = truth in _SINGLE and set(four) <= set(fitted)
        self._four = [fitted.index(name) for name in four] if known else []
        self._true, self._sets, self._best = four.index(truth) if truth in four else 0, 0, 0

    def feed(self, block):
        norm = block["norm"]
        made = np.isfinite(norm).any(axis=1)
        self._count(np.hstack([norm, block["residual_norm"]]), made)
        self._norm += _lowest(norm)
        self._bic += _lowest(block["bic"])
        self._sum += np.nansum(norm, axis=0)
        self._finite += np.isfinite(norm).sum(axis=0)
        self._converged += (block["converged"] > 0).sum(axis=0)
        if self._four:  # the paper's comparison: three single terms and the pair without the true one, by the mean norm of ten runs
            sets = norm[: len(norm) // TEN * TEN, self._four]
            means = sets.reshape(-1, TEN, 4).mean(axis=1)
            self._sets += int(np.isfinite(means).any(axis=1).sum())
            self._best += int(_lowest(means)[self._true])

    def told(self):
        n = self.made or math.nan
        return self._counted() | {
            "lowest_norm": self._norm / n,
            "lowest_bic": self._bic / n,
            "mean_norm": np.where(self._finite > 0, self._sum / np.maximum(self._finite, 1), np.nan),
            "unconverged": 1 - self._converged / n,
            "true_by_norm": math.nan if self._at is None else self._norm[self._at] / n,
            "true_by_bic": math.nan if self._at is None else self._bic[self._at] / n,
            "true_by_ten": self._best / self._sets if self._sets else math.nan,
            "sets_of_ten": (min(self._sets, 1) if self._alike else self._sets) if self._four else math.nan,
        }


def _lowest(values):
    """How many times each column is the lowest of its row; a row without a number counts for none."""
    known = np.where(np.isfinite(values), values, np.inf)
    rows = np.isfinite(known.min(axis=1))
    return np.bincount(known.argmin(axis=1)[rows], minlength=values.shape[1])


class _Detected(_Cell):
    """How often discovery gave each answer."""

    reads = ("outcome", "coefficient", "left", "gap")

    def __init__(self, settings, words):
        super().__init__()
        self._words, self._said = words, np.zeros(len(words))
        self._not, self._asked = words.index("not_made"), settings["detection.size"]
        self._gap, self._gaps, self._size, self._left = 0.0, 0, math.nan, math.nan

    def feed(self, block):
        outcome, gap = block["outcome"].astype(int), block["gap"]
        made = outcome != self._not
        self._count(np.column_stack([outcome, gap]), made)
        self._said += np.bincount(outcome[made], minlength=len(self._words))
        self._gap += float(np.nansum(gap))
        self._gaps += int(np.isfinite(gap).sum())
        self._size, self._left = float(block["coefficient"][0]), float(block["left"][0])

    def told(self):
        share = self._said / (self.made or math.nan)
        reached = not self._asked or abs(self._left / self._asked - 1) < REACHED
        return self._counted() | {
            "share": share,
            "found": 1 - share[self._words.index("nothing")] - share[self._words.index("failed")],
            "named": share[self._words.index("named")],
            "size_of_effect": self._size,
            "left_by_base": self._left,
            "mean_gap": self._gap / self._gaps if self._gaps else math.nan,
            "reached": float(reached) if self.made else math.nan,
        }


def _kinds(sweep):
    return IDENTIFICATION if sweep.computes == "identification" else DETECTION


@cache
def interval(count: int, n: int) -> tuple[float, float]:
    """The 95 % interval (low, high) of the probability of what was seen ``count`` times in ``n`` draws; NaN for n = 0.

    Wilson, J. Am. Stat. Assoc. 22, 209 (1927).
    """
    if not n:
        return math.nan, math.nan
    found = binomtest(count, n).proportion_ci(LEVEL, method="wilson")
    return float(found.low), float(found.high)


def intervals(share, n):
    """The 95 % intervals (arrays low, high, of the shape of ``share``) of probabilities seen as ``share`` in ``n`` independent draws."""
    share, n = np.broadcast_arrays(np.asarray(share, float), np.asarray(n, float))
    known = np.isfinite(share) & np.isfinite(n)
    pairs = [
        interval(round(one * count), int(count)) if ok else (math.nan, math.nan)
        for one, count, ok in zip(share.flat, n.flat, known.flat, strict=True)
    ]
    low, high = np.array(pairs).reshape(-1, 2).T
    return low.reshape(share.shape), high.reshape(share.shape)


def table(maps):
    """A row for each cell: its axes, the numbers of draws asked for, made and independent, and each probability.

    ``…_low_95`` and ``…_high_95`` are the ends of a probability's 95 % interval (``interval``), ``reason`` says why a cell could
    not be made. ``maps`` is what ``combine.read_maps`` returns.
    """
    axes, draws = maps.attrs["axes"].split(), int(maps.attrs["realizations"])
    shares = ["true_by_norm", "true_by_bic", "true_by_ten"] if "fitted" in maps.dims else ["found", "named"]
    frame = maps[[*shares, "made", "independent"]].to_dataframe().reset_index()
    others = [name for name in maps.coords if name not in axes]
    beside = [name for name in others if maps[name].dims in {(axis,) for axis in axes}]
    rows = frame[[*axes, *beside]].assign(draws=draws)
    rows["made"], rows["independent"] = frame["made"].astype(int), frame["independent"].astype(int)
    for name in shares:
        rows[name] = frame[name]
        for end in (f"{name}_low_95", f"{name}_high_95"):
            rows[end] = maps[end].values.ravel()
    if "fitted" in maps.dims:
        rows["sets_of_ten"] = maps["sets_of_ten"].values.ravel()
        for criterion in ("norm", "bic"):
            most = maps[f"lowest_{criterion}"].fillna(-1)
            labels = pd.Series(most["fitted"].values[most.argmax("fitted").values.ravel()]).astype(str)
            rows[f"most_often_by_{criterion}"] = labels.where(frame["made"] > 0, "")
        rows["unconverged"] = maps["unconverged"].mean("fitted").values.ravel()
    else:
        for word in maps["said"].values:
            if word != "not_made":
                rows[f"said_{word}"] = maps["share"].sel(said=word).values.ravel()
        for name in ("size_of_effect", "left_by_base", "mean_gap", "reached"):
            rows[name] = maps[name].values.ravel()
    rows["reason"] = [str(why) for why in maps["reason"].values.ravel()]
    return rows


def combined(sweep, rows, chunks):
    """Lines that tell what was combined: how many draws, and how many cells could not be made, for which reasons."""
    draws = sweep.cells * sweep.realizations
    yield f"{sweep.name}: {sweep.cells} cells × {sweep.realizations} draws = {draws} draws, all there, from {chunks} chunks"
    names = rows.columns[: list(rows.columns).index("draws")]
    for why, part in rows[rows["made"] == 0].groupby("reason"):
        first = ", ".join(f"{name} {part.iloc[0][name]}" for name in names)
        yield f"{len(part)} of {sweep.cells} cells could not be made: {why} (the first: {first})"
    if "reached" in rows and (short := int((rows["reached"] == 0).sum())):
        yield f"in {short} of {sweep.cells} cells no size of the hidden effect leaves what was asked for: left_by_base has what it leaves"
