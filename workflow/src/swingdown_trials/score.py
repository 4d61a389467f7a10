"""Verdicts held against the truth: a row for each trial, the figures that tell how far verdicts can be trusted, and whether the
probabilities that they tell are right: of the effects told with 90 %, about 90 % are there."""

from collections.abc import Iterable, Mapping
from itertools import pairwise
from math import isfinite
from typing import Any

import numpy as np
import pandas as pd
from scipy.stats import binomtest

from swingdown.discovery.criterion import GUARD
from swingdown.discovery.data.noise import Noise
from swingdown.pendulum.catalogue import SHIPPED, Catalogue
from swingdown.sealed import read_csv
from swingdown.status import NAMING, REMAINING, Status

from .trial import CORRELATION, Design

# chi-square that one effect of the catalogue leaves, above which a foreign one is not imitated
_EXCESS = 100.0
_SEPARABLE = 25.0  # chi-square by which every other effect fails
_TIE_SET = 4
_EDGES = (0.01, 0.1, 0.3, 0.7, 0.9, 0.99, 1.0)  # probabilities; less is not told
_KINDS = {
    "one in the catalogue": ("single", "pair", "null", "own", "calibrated"),
    "one that it lacks": ("removed", "foreign"),
}
_NEAR, _ERRORS = 0.05, 3.0  # of a value, and standard errors: where an effect is told to be a simpler one


def row(
    name: str, truth: Mapping[str, Any], found: Mapping[str, Any], catalogue: Catalogue = SHIPPED
) -> dict[str, Any]:
    """One trial's row of scores.csv, as a dict, from its truth and what was found.

    ``named`` and ``tied`` list the verdict's effects and their rivals; ``exact`` every hidden effect and no other is named;
    ``inside`` every hidden one is named or tied in sets of at most four, and no other is named; ``wrong`` an effect is asserted, and
    neither it nor a rival nor the simpler effect that it is at the values told is hidden; ``stand_ins`` what merely helps; ``alarm`` anything but "consistent". ``right`` is what the kind of trial asks for.
    ``holdout_sigma`` is the last held-out residual in units of the true noise, ``excess`` the chi-square that the best
    single effect leaves beyond the noise that was added, ``separation`` the same of the best effect that is not hidden,
    ``covered`` of ``intervals`` 95 % intervals hold the true value.
    """
    verdict, hidden = found["verdict"], tuple(truth["hidden"])
    told = verdict["effects"]
    sets = {one["name"]: {one["name"], *one["tied_with"]} for one in told}
    exact = sorted(sets) == sorted(hidden) and verdict["status"] in NAMING - REMAINING
    among = all(any(one in members for members in sets.values()) for one in hidden)
    small = all(len(members) <= _TIE_SET for members in sets.values())
    inside = len(sets) == len(hidden) and among and small and verdict["status"] in NAMING - REMAINING
    covered, intervals = _coverage(_as_told(truth, found, catalogue), verdict) if exact else (0, 0)
    excess = _excess(truth, found, found["rms_rad"])
    # to first order (1 - rho^2) times the chi-square of the hidden effect; what contains it can always do its work
    others = (one for one in found["rms_rad"] if one not in hidden)
    rivals = [one for one in others if not set(catalogue.contained_in(one)) & set(hidden)]
    separation = _excess(truth, found, rivals)
    right = {
        "single": inside, "pair": inside, "null": verdict["status"] == Status.CONSISTENT, "own": verdict["status"] == Status.CONSISTENT,
        "calibrated": verdict["status"] == Status.CONSISTENT,
        "removed": not told and verdict["status"] == Status.UNKNOWN, "foreign": not told and verdict["status"] == Status.UNKNOWN,
    }  # fmt: skip
    return {
        "campaign": name,
        "kind": truth["kind"],
        "hidden": "+".join(hidden),
        "noise": truth["noise"],
        "ratio": truth["ratio"],
        "reached": truth["reached"],
        "status": verdict["status"],
        "named": "+".join(sets),
        "tied": "; ".join("/".join(sorted(members - {name})) for name, members in sets.items()),
        "stand_ins": "+".join(one["name"] for one in verdict["stand_ins"]),
        "exact": exact,
        "inside": inside,
        "wrong": any(not _there(one, hidden, catalogue) for one in told),
        "alarm": verdict["status"] != Status.CONSISTENT,
        "right": right[truth["kind"]],
        "holdout_sigma": verdict["gap"]["holdout"][-1] * verdict["noise_rms_rad"] / truth["sigma"],
        "gap_before": verdict["gap"]["holdout"][0],
        "gap_after": verdict["gap"]["holdout"][-1],
        "excess": excess,
        "separation": separation,
        "covered": covered,
        "intervals": intervals,
        "seconds": found["seconds"],
        "moves": "; ".join(verdict["moves"]),
    }


def _there(one: Mapping[str, Any], hidden: Iterable[str], catalogue: Catalogue) -> bool:
    """True for an effect that is hidden, is tied with one that is, or is told with values at which it is one that is: a drag in the
    power 2.00 of the speed is quadratic drag."""
    if {one["name"], *one["tied_with"]} & set(hidden):
        return True

    def at(name: str, wanted: float) -> bool:
        value, error = (one["parameters"][name][part] for part in ("value", "standard_error"))
        return isfinite(wanted) and abs(value - wanted) < max(_NEAR * abs(wanted), _ERRORS * (error or 0.0))

    return any(
        simpler.name in hidden and all(at(name, wanted) for name, wanted in simpler.at.items())
        for simpler in catalogue[one["name"]].contains
    )


def _as_told(truth: Mapping[str, Any], found: Mapping[str, Any], catalogue: Catalogue) -> dict[str, float]:
    """The true values as a verdict tells them: what drifts over a record drifts over the longest that is used, and the end of a recording
    in which the pendulum rests is not."""
    used = found["duration_s"] / Design(*truth["design"]).duration
    drifts = {p.name for one in catalogue if "duration" in one.term for p in one.parameters}
    return {name: value * (used if name in drifts else 1.0) for name, value in truth["values"].items()}


def _coverage(values: Mapping[str, float], verdict: Mapping[str, Any]) -> tuple[int, int]:
    """How many of the model's 95 % intervals hold the true values, and how many there are; phases are left out."""
    held = count = 0
    for name, entry in verdict["model"].items():
        error = entry["standard_error"]
        if name not in values or name.endswith("_phase") or error is None or entry["value"] == 0:
            continue
        count += 1
        held += abs(entry["value"] - values[name]) < 1.96 * error
    return held, count


def _excess(truth, found, among):
    """The chi-square (noise at the pendulum's frequencies) that the best of these effects leaves beyond the noise."""
    left = [found["rms_rad"][name] for name in among]
    if not left:
        return np.nan
    fitted = [int(name.rsplit("-", 1)[1]) - 1 for name in found["fitted"]]
    noise = np.mean([truth["noise_rms_rad"][k] ** 2 for k in fitted])
    white = Noise(truth["sigma"], CORRELATION if truth["noise"] == "coloured" else 0.0)
    return truth["samples"] * len(fitted) * (min(left) ** 2 - noise) / white.slow_variance


def read_scores(path):
    """The table of a scores.csv, in which "null" is a kind of trial and no missing value."""
    return read_csv(path, keep_default_na=False, na_values=[""])


def summarise(scores):
    """The table of figures: columns ``figure``, ``value``, ``low`` and ``high`` (95 %, Clopper and Pearson), ``n``, ``asked``.

    ``value`` is a share of n, or a median where no limits are given.
    """
    kind = {
        name: scores[scores["kind"] == name]
        for name in ("single", "pair", "null", "own", "calibrated", "removed", "foreign")
    }
    plain = pd.concat([kind["removed"], kind["foreign"]])
    plain = plain[plain["excess"] > _EXCESS]
    # where no other effect could be added at all, too
    apart = kind["single"][~(kind["single"]["separation"] <= _SEPARABLE)]
    known = pd.concat([kind["single"], kind["pair"]])
    repaired = known[known["inside"].astype(bool)]
    covered, intervals = int(scores["covered"].sum()), int(scores["intervals"].sum())
    rows = [
        ("named exactly or inside a tie of at most four", *_share(kind["single"]["inside"]), "≥ 90 %"),
        *((f"the same, effects that leave {ratio:g} times the noise", *_share(part["inside"]), "≥ 90 %")
          for ratio, part in kind["single"].groupby("ratio")),
        ("named exactly", *_share(kind["single"]["exact"]), ""),
        ("named exactly, where every other effect fails by more than 25", *_share(apart["exact"]), "≥ 90 %"),
        ("a wrong name", *_share(kind["single"]["wrong"]), "≤ 2 %"),
        ("false alarms where nothing is hidden", *_share(kind["null"]["alarm"]), "≤ 2 %"),
        *((f"the same, {noise} noise", *_share(part["alarm"]), "≤ 2 %") for noise, part in kind["null"].groupby("noise")),
        ("the same, each swing its own natural frequency", *_share(kind["own"]["alarm"]), "≤ 2 %"),
        ("the same, volts with a calibration", *_share(kind["calibrated"]["alarm"]), "≤ 2 %"),
        ("unknown, effects not in the catalogue that leave more than 100", *_share(plain["right"]), "≥ 85 %"),
        ("unknown, all effects not in the catalogue", *_share(pd.concat([kind["removed"], kind["foreign"]])["right"]), ""),
        ("both of two hidden effects", *_share(kind["pair"]["inside"]), "≥ 70 %"),
        ("95 % intervals that hold the true value", *_proportion(covered, intervals), "92–98 %"),
        ("held-out residual after repair, true noise (median)", repaired["holdout_sigma"].median(), np.nan, np.nan, len(repaired), "≤ 1.05"),
        ("CPU seconds a campaign, one effect hidden (median)", kind["single"]["seconds"].median(), np.nan, np.nan, len(kind["single"]), "≤ 10"),
        ("CPU seconds a campaign, one effect hidden (95 %)", kind["single"]["seconds"].quantile(0.95), np.nan, np.nan, len(kind["single"]), ""),
    ]  # fmt: skip
    told = ["figure", "value", "low", "high", "n", "asked"]
    return pd.DataFrame([one for one in rows if one[4]], columns=told)


def _share(flags):
    return _proportion(int(flags.astype(bool).sum()), len(flags))


def _proportion(count, n):
    if not n:
        return np.nan, np.nan, np.nan, 0
    interval = binomtest(count, n).proportion_ci(method="exact")
    return count / n, float(interval.low), float(interval.high), n


def reliability(trials: Iterable[tuple[Mapping[str, Any], Mapping[str, Any]]]) -> pd.DataFrame:
    """The reliability table of trials, each a (truth, what was found): a row for each band of probability that effects were told
    with, by whether the hidden effects are in the catalogue.

    Columns ``hidden``, ``from`` and ``to`` (of the band), ``told`` (mean probability), ``n`` (effects told so), ``there`` (the
    share of them that is hidden) with ``low`` and ``high`` (95 %, Clopper and Pearson). Every effect that a search gave a
    probability counts, asserted or not.
    """
    told = [
        (truth["kind"], probability, name in truth["hidden"])
        for truth, found in trials
        for name, probability in found["verdict"]["probabilities"].items()
    ]
    rows = []
    for label, kinds in _KINDS.items():
        of_kind = [(probability, there) for kind, probability, there in told if kind in kinds]
        for low, high in pairwise(_EDGES):
            inside = [one for one in of_kind if low <= one[0] and (one[0] < high or high == _EDGES[-1])]
            if not inside:
                continue
            share, *limits, n = _proportion(sum(there for _, there in inside), len(inside))
            mean = sum(probability for probability, _ in inside) / n
            rows.append((label, low, high, mean, n, share, *limits))
    return pd.DataFrame(rows, columns=["hidden", "from", "to", "told", "n", "there", "low", "high"])


def guard(scores):
    """The contents of guard.yaml with the false alarms of these scores: what verdicts then tell of themselves."""
    nulls = scores[scores["kind"].isin(["null", "own", "calibrated"])]
    return GUARD | {"nulls": len(nulls), "false_alarms": int(nulls["alarm"].sum())}


def confusion(scores: pd.DataFrame, catalogue: Catalogue = SHIPPED) -> pd.DataFrame:
    """The confusion matrix of single hidden effects: rows the hidden one, columns what was named, shares of each row.

    A verdict of "unknown" or "consistent" counts as that; of a tie the hidden effect if it is inside, else the first.
    """
    single = scores[scores["kind"] == "single"]

    def told(one):
        if one["status"] in (Status.UNKNOWN, Status.CONSISTENT):
            return one["status"]
        return one["hidden"] if one["inside"] else one["named"].split("+")[0]

    table = pd.crosstab(single["hidden"], single.apply(told, axis=1), normalize="index")
    order = [name for name in catalogue.names if name in table.index]
    columns = [*order, *(name for name in catalogue.names if name in table.columns and name not in order)]
    return table.reindex(index=order, columns=[*columns, "unknown", "consistent"], fill_value=0.0)
