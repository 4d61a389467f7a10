"""What a sweep says: for every cell, how often each answer was given, and the table of it."""

import math

import numpy as np
import pandas as pd

TEN = 10  # runs whose mean norm the paper compares
CLAIM = 0.68  # "the correct model may be determined with a high level of confidence despite the confidence level actually being 68%"
_SINGLE = ("viscous", "quadratic_drag", "load_coulomb")
# name: dimensions beside the axes, unit, meaning
IDENTIFICATION = {
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
}
DETECTION = {
    "share": (("said",), "1", "share of campaigns in which discovery said so"),
    "found": ((), "1", "share of campaigns in which something was found missing"),
    "named": ((), "1", "share of campaigns in which the hidden effect was named, and it alone"),
    "size_of_effect": ((), "see the hidden effect's first parameter", "size of the hidden effect"),
    "left_by_base": ((), "1", "RMS that the base model leaves of the noise-free swings, over the noise"),
    "mean_gap": ((), "1", "mean RMS that the base model leaves, over the noise that discovery measured"),
}


def add(file, sweep):
    """The open netCDF4 ``file`` of a combined sweep with the cells' probabilities added; one cell is read at a time."""
    kinds, tell = (
        (IDENTIFICATION, _identified) if sweep.computes == "identification" else (DETECTION, _detected)
    )
    axes = tuple(axis.dim for axis in sweep.axes)
    if sweep.computes == "detection":
        words = file["outcome"].flag_meanings.split()
        file.createDimension("said", len(words))
        said = file.createVariable("said", str, ("said",))
        said.long_name = "what discovery said"
        said[:] = np.array(words, dtype=object)
    for name, (more, units, meaning) in kinds.items():
        made = file.createVariable(
            name, "f8", (*axes, *more), zlib=True, complevel=4, fletcher32=True, fill_value=np.nan
        )
        made.setncatts({"units": units, "long_name": meaning})
    collected = {name: np.full(file[name].shape, np.nan) for name in kinds}
    for index, values in zip(np.ndindex(sweep.shape), sweep, strict=True):
        for name, value in tell(file, index, sweep.cell(values)).items():
            collected[name][index] = value
    for name, values in collected.items():
        file[name][...] = values


def _identified(file, index, settings):
    norm, bic = (_numbers(file[name][index]) for name in ("norm", "bic"))
    fitted = [str(name) for name in _texts(file["fitted"])]
    (truth,) = settings["simulation.simulated"]
    by_norm, by_bic = _lowest(norm), _lowest(bic)
    at = fitted.index(truth) if truth in fitted else None
    return {
        "lowest_norm": by_norm,
        "lowest_bic": by_bic,
        "mean_norm": norm.mean(axis=0),
        "unconverged": 1 - np.asarray(file["converged"][index], float).mean(axis=0),
        "true_by_norm": math.nan if at is None else by_norm[at],
        "true_by_bic": math.nan if at is None else by_bic[at],
        "true_by_ten": _by_ten(norm, fitted, truth),
    }


def _lowest(values):
    """How often each column is the lowest of its row; a row without a number counts for none."""
    known = np.where(np.isfinite(values), values, np.inf)
    rows = np.isfinite(known.min(axis=1))
    return np.bincount(known.argmin(axis=1)[rows], minlength=values.shape[1]) / len(values)


def _by_ten(norm, fitted, truth):
    """The paper's comparison: three single terms and the pair without the true one, by the mean norm of ten runs."""
    pair = "+".join(name for name in _SINGLE if name != truth)
    four = [*_SINGLE, pair]
    sets = len(norm) // TEN
    if not sets or truth not in _SINGLE or not set(four) <= set(fitted):
        return math.nan
    chosen = norm[: sets * TEN, [fitted.index(name) for name in four]].reshape(sets, TEN, 4).mean(axis=1)
    return float(_lowest(chosen)[four.index(truth)])


def _detected(file, index, settings):
    outcome = np.asarray(file["outcome"][index])
    words = file["outcome"].flag_meanings.split()
    share = np.bincount(outcome, minlength=len(words)) / outcome.size
    gap = _numbers(file["gap"][index])
    return {
        "share": share,
        "found": 1 - share[words.index("nothing")] - share[words.index("failed")],
        "named": share[words.index("named")],
        "size_of_effect": _numbers(file["coefficient"][index])[0],
        "left_by_base": _numbers(file["left"][index])[0],
        "mean_gap": gap[np.isfinite(gap)].mean() if np.isfinite(gap).any() else math.nan,
    }


def _numbers(values):
    return np.ma.filled(np.ma.asarray(values, float), np.nan)


def _texts(variable):
    """The entries of a text coordinate, kept as characters or as strings."""
    import netCDF4

    values = np.asarray(variable[:])
    return netCDF4.chartostring(values) if values.dtype.kind == "S" and values.ndim == 2 else values


def wilson(share, n, z=1.0):
    """(low, high): the interval of z standard deviations of a probability seen as ``share`` in n draws.

    Wilson, J. Am. Stat. Assoc. 22, 209 (1927); unlike the square root of p (1 - p) / n it does not vanish at 0 and 1.
    """
    middle = (share + z * z / (2 * n)) / (1 + z * z / n)
    half = z * np.sqrt(share * (1 - share) / n + z * z / (4 * n * n)) / (1 + z * z / n)
    return middle - half, middle + half


def table(maps):
    """A row for each cell: its axes, the number of draws, and each probability with the interval of one standard deviation.

    ``maps`` is what ``combine.read_maps`` returns.
    """
    axes, draws = maps.attrs["axes"].split(), int(maps.attrs["realizations"])
    shares = ["true_by_norm", "true_by_bic", "true_by_ten"] if "fitted" in maps.dims else ["found", "named"]
    frame = maps[shares].to_dataframe().reset_index()[[*axes, *shares]]
    rows = frame[axes].assign(draws=draws)
    for name in shares:
        n = draws // TEN if name == "true_by_ten" else draws
        rows[name] = frame[name]
        rows[f"{name}_low"], rows[f"{name}_high"] = wilson(frame[name], n) if n else (np.nan, np.nan)
    if "fitted" in maps.dims:
        for criterion in ("norm", "bic"):
            most = maps[f"lowest_{criterion}"].fillna(-1)
            rows[f"most_often_by_{criterion}"] = pd.Series(
                most["fitted"].values[most.argmax("fitted").values.ravel()]
            ).astype(str)
        rows["unconverged"] = maps["unconverged"].mean("fitted").values.ravel()
    else:
        for word in maps["said"].values:
            rows[f"said_{word}"] = maps["share"].sel(said=word).values.ravel()
        for name in ("size_of_effect", "left_by_base", "mean_gap"):
            rows[name] = maps[name].values.ravel()
    return rows
