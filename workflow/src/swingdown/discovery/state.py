"""The state of a search after so many moves: the fit, where it fails, what could mend it, and what was chosen."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from ..fitting.result import Fit
from ..pendulum.model import Model
from .budget import Budget
from .campaign import Campaign, Noise
from .evidence import Candidate, evidence
from .locate import Group
from .next_swing import NextSwing
from .verdict import GUARD

if TYPE_CHECKING:
    from .established import Finding


@dataclass(frozen=True)
class Round:
    """The state after so many moves: the fit and where it fails, what could mend it, and what was chosen.

    ``found`` names the effects added so far; ``ties`` are those of ``ranked`` that the data do not tell apart, ``alike`` their
    correlations with the first of them by move; ``rivals`` holds for each the effects that would do as well in its place
    (looked for in the last round); ``curves`` is the table of missing torques, ``kept`` that of the torques without a name
    that the model has, ``half_swings`` that of what the fitted swings show without a model, beside what the model shows.
    ``out_of_sample`` holds, by move, the logarithm by which those that were judged so shrink what held-out swings leave;
    ``others`` are those of them that were not chosen, best first.
    """

    number: int
    fit: Fit
    holdout: Fit
    noise: Noise
    groups: tuple[Group, ...]
    curves: pd.DataFrame
    kept: pd.DataFrame
    half_swings: pd.DataFrame
    found: tuple[str, ...] = ()
    ranked: tuple[Candidate, ...] = ()
    ties: tuple[Candidate, ...] = ()
    alike: dict[str, float] = field(default_factory=dict)
    rivals: dict[str, list[str]] = field(default_factory=dict)
    chosen: Candidate | None = None  # the next model
    reason: str = ""  # why there is none
    out_of_sample: dict[str, float] = field(default_factory=dict)
    others: tuple[Candidate, ...] = ()
    established: "Mapping[str, Finding] | None" = None
    """By effect found, whether it is established; None where nothing more is missing and few effects were found."""
    established_in: int | None = None  # the number of the round that tells it
    probabilities: Mapping[str, float] = field(
        default_factory=dict
    )  # by effect, of being there; told in the last round
    next_swing: NextSwing | None = None  # that tells the leading structures apart
    spent: bool = False  # the search's budget
    concluded: dict[str, Any] | None = None  # of the last round: what ``conclusion.conclusion`` gives

    @property
    def bic(self) -> float:
        """The evidence of the fit, to hold the candidates' against."""
        return evidence(self.fit, self.noise)

    @property
    def model(self) -> Model:
        """The model with standard errors that know the noise's colour."""
        model, systematic = self.fit.model, np.sum(self.fit.systematic**2, axis=1)
        random = np.diag(self.fit.covariance) - systematic
        errors = dict(zip(self.fit.free, np.sqrt(random * self.noise.inflation + systematic), strict=True))
        return model.with_values(model.values, {name: float(errors[name]) for name in model.standard_errors})

    @property
    def nameless(self) -> list[str]:
        """Those of the effects found that are torques without a name."""
        return [name for name in self.found if not self.fit.model.catalogue.has_name(name)]

    @property
    def missing(self) -> bool:
        """True where some group finds more than the noise allows."""
        return any(group.p < GUARD["p_missing"] for group in self.groups)


@dataclass(frozen=True)
class Search:
    """What stays the same throughout a search."""

    campaign: Campaign
    rounds: int
    allowed: Collection[str] | None
    budget: Budget
    base: tuple[str, ...] = ()  # the effects that the model had at first: none of them is found
    looked: list[Round] = field(default_factory=list)  # all rounds of all ways, in order

    def after(self, found: Sequence[str], chosen: Candidate) -> tuple[str, ...]:
        """The names of the effects found, after a move."""
        names = dict.fromkeys((*found, *chosen.names))  # what was dropped may be put back
        return tuple(name for name in names if name != chosen.dropped and name not in self.base)
