"""Groups that measured the same: do they agree, and which does not?"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike
from scipy.special import ndtr

from ..arrays import Floats
from ..errors import InputError
from ..studies.power_laws import BEYOND, Scatter

_LEAST = 1e-9  # no uncertainty is known so well that a probability below means anything


@dataclass(frozen=True)
class Comparison:
    """Groups compared with each other.

    Attributes
    ----------
    chi2, dof, p
        Chi² of equality, its degrees of freedom, and the probability of so much difference by the uncertainties alone.
    apart
        The groups that stand apart.
    table
        A row for each group: name, number of recordings, weighted mean, standard uncertainty, and ``pull``, its distance from the
        mean of the others in standard uncertainties.
    """

    chi2: float
    dof: int
    p: float
    apart: tuple[str, ...]
    table: pd.DataFrame = field(repr=False)

    @property
    def sentence(self) -> str:
        """A sentence: which groups agree, with chi² and p."""
        if self.p < BEYOND and (self.table["recordings"] == 1).all():
            return f"{self._said()}; each has one recording, and how far a repetition scatters is not in their uncertainties"
        return self._said()

    @property
    def chance(self) -> str:
        """The probability of so much difference, in words."""
        return f"p = {self.p:.2g}" if self.p > _LEAST else "p below 1e-9"

    def _said(self) -> str:
        shown = f"{self.chi2:.0f}" if self.chi2 >= 1000 else f"{self.chi2:.3g}"
        chance = f"chi² {shown} for {self.dof}, {self.chance}"
        names = [str(one) for one in self.table["group"]]
        all_of_them = " and ".join(names) if len(names) == 2 else f"the {len(names)} groups"
        if self.p >= BEYOND:
            return f"{all_of_them} agree ({chance})"
        if len(names) == 2:
            return f"{all_of_them} do not agree ({chance})"
        if not self.apart or len(self.apart) > len(names) / 2:
            return f"the {len(names)} groups do not agree, and none stands out ({chance})"
        some = ", ".join(self.apart)
        if len(self.apart) == 1:
            return f"{some} does not agree with the others, which agree with each other ({chance} for all)"
        return f"{some} do not agree with the others, which agree with each other ({chance} for all)"

    def to_dict(self) -> dict[str, Any]:
        """A dict of plain numbers and texts."""
        return {"chi2": self.chi2, "dof": self.dof, "p": self.p, "apart": list(self.apart), "groups": self.table.to_dict("records")}  # fmt: skip


def compare(groups: Sequence[str], values: ArrayLike, uncertainties: ArrayLike, taken: int = 0) -> Comparison:
    """The ``Comparison`` of values by group.

    Recordings of a group give a weighted mean. If they scatter beyond their errors, all uncertainties are widened alike.

    Parameters
    ----------
    groups
        The group of each value, of shape (value,).
    values, uncertainties
        Values and their standard uncertainties (above 0), of shape (value,), in one unit.
    taken
        Degrees of freedom of their scatter that what was taken off the values before has used.

    Raises
    ------
    InputError
        For fewer than two groups, and for a value without an uncertainty.
    """
    values, uncertainties = np.asarray(values, dtype=float), np.asarray(uncertainties, dtype=float)
    names = list(dict.fromkeys(map(str, groups)))
    if len(names) < 2:
        raise InputError("groups", f"{len(names)} group", "at least two", "name the groups")
    if not np.all(uncertainties > 0) or not np.isfinite(values).all():
        raise InputError("groups", "a value has no uncertainty", "values with standard uncertainties above 0", "leave it out")  # fmt: skip
    member = np.array(list(map(str, groups)))
    rows, within = [], []
    for name in names:
        own = member == name
        mean, error, scatter = _mean(values[own], uncertainties[own])
        rows.append((name, int(own.sum()), mean, error))
        within.append(scatter)
    pooled = Scatter(sum(one.chi2 for one in within), sum(one.dof for one in within) - taken)
    table = pd.DataFrame(rows, columns=["group", "recordings", "value", "standard_uncertainty"])
    table["standard_uncertainty"] *= pooled.widening
    means, errors = table["value"].to_numpy(), table["standard_uncertainty"].to_numpy()
    whole = _mean(means, errors)[2]
    table["pull"] = _pulls(means, errors)
    left = np.arange(len(names))
    while len(left) > 2 and _mean(means[left], errors[left])[2].refuted:
        pulls = np.abs(_pulls(means[left], errors[left]))
        worst = int(np.argmax(pulls))
        if 2 * ndtr(-pulls[worst]) * len(left) >= BEYOND:  # the worst of so many
            break
        left = np.delete(left, worst)
    agree = not _mean(means[left], errors[left])[2].refuted
    told = tuple(name for k, name in enumerate(names) if agree and k not in left)
    return Comparison(whole.chi2, whole.dof, whole.p, told, table)


def _mean(values: Floats, errors: Floats) -> tuple[float, float, Scatter]:
    """The weighted mean, its standard uncertainty, and how the values scatter about it."""
    weight = errors**-2
    mean = float(np.average(values, weights=weight))
    return mean, float(weight.sum() ** -0.5), Scatter(float(weight @ (values - mean) ** 2), values.size - 1)


def _pulls(means: Floats, errors: Floats) -> list[float]:
    """How far each is from the mean of the others, in standard uncertainties."""
    others = [_mean(np.delete(means, k), np.delete(errors, k)) for k in range(means.size)]
    return [
        float((mean - other) / np.hypot(error, u))
        for mean, error, (other, u, _) in zip(means, errors, others, strict=True)
    ]
