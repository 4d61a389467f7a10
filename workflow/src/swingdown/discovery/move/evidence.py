"""A move and its refit, and what that is worth by the evidence (BIC), by which candidates are ranked."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from ...fitting.result import Fit
from ..data.noise import Noise
from .candidates import describe

TIE = 10.0  # difference of BIC, below which a candidate may still turn out to be the better one


@dataclass(frozen=True)
class Candidate:
    """A move and its refit: effect added and dropped (or None), the fit, its BIC, and why it is refused (or empty).

    ``also`` names what is added with the first, and belongs to it.
    """

    added: str | None
    dropped: str | None
    fit: Fit
    bic: float
    refused: str = ""
    also: tuple[str, ...] = ()

    @property
    def move(self) -> str:
        """What is done to the model, in words."""
        return describe(self.added, self.dropped, self.also)

    @property
    def names(self) -> tuple[str, ...]:
        """The names of all effects that are added."""
        return () if self.added is None else (self.added, *self.also)


def evidence(fit: Fit, noise: Noise) -> float:
    """The BIC of a fit whose residuals are correlated as the noise is: n effective ln(rss / n) + k ln(n effective).

    What the measurement leaves open is not counted: it is known as well before the fit, and what it takes is in the rss.
    """
    n, free = noise.effective(fit.n), len(fit.free) - len(fit.model.slack.names)
    return float(n * np.log(fit.rss / fit.n) + free * np.log(n))


def best_first(found: Iterable[Candidate | None]) -> list[Candidate]:
    """Those of the candidates that are any, the admissible before the others, each by their evidence."""
    return sorted((one for one in found if one), key=lambda one: (bool(one.refused), one.bic))
