"""What a move and its refit are worth: the evidence, which candidates it does not tell apart, and how alike they are."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from ..fitting.result import Fit
from .campaign import Noise
from .candidates import describe
from .linear import Frame

TIE = 10.0  # difference of BIC below which two candidates are told as tied
_SUGGESTED = (
    4.0  # chi-square by which a richer effect must beat a simpler one that it contains to be tied with it
)


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


def tied(ranked: Sequence[Candidate], noise: Noise) -> list[Candidate]:
    """The admissible candidates that the evidence does not tell from the best: within ``TIE`` of its BIC, additions first.

    Of a richer effect and a simpler one that it contains, the simpler is preferred unless the evidence is for the richer,
    and the richer stays in the tie only if something suggests it.
    """
    admissible = [one for one in ranked if not one.refused]
    if not admissible:
        return []
    near = [one for one in admissible if one.bic - admissible[0].bic < TIE]
    kept = []
    for one in near:
        contained = one.fit.model.catalogue.contained_in(one.added) if one.added else ()
        simpler = [other for other in near if other.added in contained and other.bic <= one.bic]
        scale = noise.deviation**2 * noise.inflation
        if all((other.fit.rss - one.fit.rss) / scale > _SUGGESTED for other in simpler):
            kept.append(one)
    # the model that is known stands: what is added to it goes before what takes the place of a part of it
    return sorted(kept, key=lambda one: one.dropped is not None)


def correlation(here: Frame, first: Candidate, second: Candidate) -> float:
    """How alike two candidates are to the data: the correlation of what each adds to the angles, beyond the current fit."""
    changes = [here.outside(one.fit.angle - here.fit.angle) for one in (first, second)]
    size = np.linalg.norm(changes[0]) * np.linalg.norm(changes[1])
    return float(changes[0] @ changes[1] / size) if size > 0 else np.nan
