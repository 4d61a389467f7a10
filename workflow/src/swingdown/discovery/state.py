"""The state of a search after so many moves: the fit, where it fails, what could mend it, and what was chosen."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pandas as pd

from ..fitting.result import Fit
from ..pendulum.model import Model
from .criterion import USUAL, Criterion
from .data.noise import Noise
from .judge.findings import Finding
from .move.evidence import Candidate, evidence
from .next.proposal import NextSwing
from .see.locate import Group


@dataclass(frozen=True)
class Round:
    """The state after so many moves: the fit and where it fails, what could mend it, and what was chosen.

    ``found`` names the effects added so far; ``missing`` is whether the fit lacks more than the noise allows, and ``unnamed`` (rad, of a
    rate rad/s) the RMS of that, and ``sizes`` that of each kind of discrepancy; ``ties`` are the moves of ``ranked`` that the data do not tell
    apart; ``curves`` and ``plane`` are the tables of missing torques, ``half_swings`` that of what the fitted swings show without a model,
    beside what the model shows. ``widened`` tells by how
    much the standard error of each value is larger for what the model may lack. The last round of a search has what is judged:
    ``findings`` by effect found, ``probabilities`` by effect of being there, ``nothing`` of nothing being missing.
    """

    number: int
    fit: Fit
    holdout: Fit
    noise: Noise
    groups: tuple[Group, ...]
    curves: pd.DataFrame
    plane: pd.DataFrame
    half_swings: pd.DataFrame
    found: tuple[str, ...] = ()
    missing: bool = False
    unnamed: float = 0.0
    sizes: Mapping[str, float] = field(default_factory=dict)
    widened: Mapping[str, float] = field(default_factory=dict)
    ranked: tuple[Candidate, ...] = ()
    ties: tuple[Candidate, ...] = ()
    chosen: Candidate | None = None  # the next model
    reason: str = ""  # why there is none
    findings: Mapping[str, Finding] = field(default_factory=dict)
    probabilities: Mapping[str, float] = field(default_factory=dict)
    nothing: float = 0.0
    next_swing: NextSwing | None = None  # that tells the leading structures apart
    spent: bool = False  # the search's budget
    unit_doubt: str = ""  # in words, where the swings are a pendulum's in another unit
    failed: str = ""  # why the search broke off, where it did
    counting: tuple[tuple[float, Fit], ...] = ()  # how much each structure counts where a value is told
    criterion: Criterion = USUAL  # by which it is judged
    concluded: dict[str, Any] | None = None  # what ``conclusion.conclusion`` gives

    @property
    def bic(self) -> float:
        """The evidence of the fit, to hold the candidates' against."""
        return evidence(self.fit, self.noise)

    @property
    def model(self) -> Model:
        """The model with standard errors that know the noise's colour, and what the model may lack."""
        model, systematic = self.fit.model, np.sum(self.fit.systematic**2, axis=1)
        random = np.diag(self.fit.covariance) - systematic
        errors = dict(zip(self.fit.free, np.sqrt(random * self.noise.inflation + systematic), strict=True))
        return model.with_values(
            model.values,
            {name: float(errors[name]) * self.widened.get(name, 1.0) for name in model.standard_errors},
        )
