"""NIST's univariate reference sets, made to cancel digits: mean, standard deviation and lag-1 correlation of samples."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from swingdown.measurement.uncertainty import mean_of_samples

from .case import Quantity, values

SOURCE = "NIST StRD, univariate summary statistics"


def samples(rule: dict[str, Any]) -> list[float]:
    """The samples of a set, by its rule: the first ones, and a pattern that is repeated."""
    return [*map(float, rule["first"]), *[float(one) for one in rule["pattern"]] * int(rule["times"])]


def quantities(folder: Path) -> Iterator[Quantity]:
    """The Quantities of all sets."""
    for name, case in values(folder / "nist_strd_univariate/expected.json").items():
        found = mean_of_samples(samples(case))
        told = {"mean": found.value, "standard_deviation": found.standard_deviation, "lag_1": found.lag_1}
        for key, ours in told.items():
            yield Quantity(f"NIST {name}", key, case[key], ours, SOURCE, exact=True)
