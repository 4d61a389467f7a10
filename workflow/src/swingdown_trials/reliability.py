"""Whether the probabilities that verdicts tell are right: of the effects told with 90 %, about 90 % are there."""

from collections.abc import Iterable, Mapping
from itertools import pairwise
from typing import Any

import pandas as pd
from scipy.stats import binomtest

_EDGES = (0.01, 0.1, 0.3, 0.7, 0.9, 0.99, 1.0)  # probabilities; less is not told
_KINDS = {
    "one in the catalogue": ("single", "pair", "null", "own", "calibrated"),
    "one that it lacks": ("removed", "foreign"),
}
COLUMNS = ["hidden", "from", "to", "told", "n", "there", "low", "high"]


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
        for low, high in pairwise(_EDGES):
            inside = [
                (probability, there)
                for kind, probability, there in told
                if kind in kinds and low <= probability and (probability < high or high == _EDGES[-1])
            ]
            if not inside:
                continue
            n, count = len(inside), sum(there for _, there in inside)
            interval = binomtest(count, n).proportion_ci(method="exact")
            mean = sum(probability for probability, _ in inside) / n
            rows.append((label, low, high, mean, n, count / n, float(interval.low), float(interval.high)))
    return pd.DataFrame(rows, columns=COLUMNS)
