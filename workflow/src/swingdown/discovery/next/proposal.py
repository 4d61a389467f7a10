"""The next experiment: that on which the leading structures of a campaign differ most, beyond what they could still give way.

Both fitted models are asked what they say of every experiment of the menu (``duel``). The least trouble that tells them apart is asked
for, as often as needed; where none does, that is told.
"""

import warnings
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ...engine.trajectory import TrajectoryWarning
from ...fitting.result import Fit
from ..data.campaign import Campaign
from ..data.noise import Noise
from .duel import REFUSED, Duel
from .experiments import LetGo, menu

APART = 5.0  # standard deviations that an experiment must be worth to be asked for
_PLAIN = 7.0  # that repeated swings are to be worth: a tie may stand 10 the wrong way round before
_AMPLE = 10.0  # more than that is worth no trouble
_NEARLY = 0.9  # of the best separation: less trouble is worth more
_LOOKS = 8  # experiments that are looked at closely


@dataclass(frozen=True)
class NextSwing:
    """An experiment to do: release angle (rad, with its side), how long (s), and by how many standard deviations of the noise the two
    structures (labels) will differ.

    ``kind`` is ``release``, ``push`` (with that release velocity, rad/s) or ``held``: readings at rest at known ``angles`` (rad, known to
    ``limit``), of which ``predicted`` holds what either structure says (rad, of a rate rad/s), each lasting ``duration``; ``release_angle``
    is then the largest. A swing is recorded so many ``times``. ``do`` says it in words.
    """

    release_angle: float
    duration: float
    separation: float
    between: tuple[str, str]
    kind: str = "release"
    release_velocity: float = 0.0
    times: int = 1
    angles: tuple[float, ...] = ()
    limit: float | None = None
    predicted: tuple[tuple[float, ...], ...] = ()
    do: str = ""

    @property
    def told(self) -> tuple[str, str]:
        """What either structure has that the other lacks, as words."""
        one, other = (label.split("+") for label in self.between)
        return _beside(one, other), _beside(other, one)

    def __str__(self) -> str:
        one, other = self.told
        if self.separation < APART:
            often = f", done {self.times} times," if self.times > 1 else ""
            return (
                f"None of the swings and readings that were computed tells {one} from {other}: the best{often} would differ by "
                f"{self.separation:.2g} standard deviations."
            )
        text = f"{self.do}: {one} and {other} then differ by {self.separation:.2g} standard deviations"
        return text + (f" ({self._readings()})." if self.predicted else ".")

    def _readings(self) -> str:
        """What either structure says of the reading at which they differ most."""
        first, second = map(np.array, self.predicted)
        at = int(np.argmax(np.abs(first - second)))
        unit = "°/s" if len(self.angles) == 1 else "°"
        one, other = (f"{np.degrees(each[at]):.4g}{unit}" for each in (first, second))
        return f"at {np.degrees(self.angles[at]):.3g}° the reading is {one} or {other}"


def next_swing(one: Fit, other: Fit, campaign: Campaign, noise: Noise) -> NextSwing | None:
    """The ``NextSwing`` that best tells two fits of a campaign apart, of all on the menu; None where neither can be asked.

    Parameters
    ----------
    one, other
        The fits whose predictions are compared.
    campaign
        The swings that they were fitted to.
    noise
        That of its recordings. Where both fits leave more, what the better one leaves counts as noise.

    Returns
    -------
    NextSwing or None
        The least trouble that is ample, or worth nine tenths of the best; where none is plain, the best, done as often as needed. A
        ``separation`` below ``APART`` says that nothing tells the fits apart.
    """
    left = replace(noise, deviation=max(noise.deviation, min(one.rms, other.rms)))
    with warnings.catch_warnings():
        # friction that drives the pendulum is no prediction
        warnings.simplefilter("error", TrajectoryWarning)
        return _next_swing(one, other, campaign, left)


def _next_swing(one: Fit, other: Fit, campaign: Campaign, noise: Noise) -> NextSwing | None:
    duels: list[Duel] = []
    looks = _LOOKS
    for experiment in menu(campaign, one.model, other.model):
        try:
            duels.append(Duel(one, other, experiment, noise))
        except REFUSED:
            continue
        if looks and duels[-1].separation() >= _AMPLE:
            looks -= 1
            if duels[-1].close() >= _AMPLE:
                return _asked(duels[-1], 1)
    if not duels:
        return None
    best = _least_trouble(duels, often=False)
    if best.close() >= _PLAIN:
        return _asked(best, 1)
    best = _least_trouble(duels, often=True)
    most = best.experiment.most
    if best.close(most) < APART:
        return _asked(best, most)
    nearer = best.close(most) / best.separation(most)
    return _asked(best, next((k for k in range(1, most) if nearer * best.separation(k) >= _PLAIN), most))


def _least_trouble(duels: Sequence[Duel], often: bool) -> Duel:
    """The first of these that is worth nine tenths of the best, done once or as ``often`` as it can be."""
    times = [duel.experiment.most if often else 1 for duel in duels]
    worth = [duel.separation(k) for duel, k in zip(duels, times, strict=True)]
    close: set[int] = set()

    def looked(k: int) -> float:
        if k not in close:
            close.add(k)
            worth[k] = duels[k].close(times[k])
        return worth[k]

    best = int(np.argmax(worth))
    while best not in close and len(close) < _LOOKS:
        looked(best)
        best = int(np.argmax(worth))
    if best not in close:  # the rest is known to first order only, which promised too much so often
        best = max(close, key=lambda k: worth[k])
    least = _NEARLY * worth[best]
    first = (k for k in range(best) if worth[k] >= least and (k in close or len(close) < 2 * _LOOKS))
    return duels[next((k for k in first if looked(k) >= least), best)]


def _asked(duel: Duel, times: int) -> NextSwing:
    experiment, (one, other) = duel.experiment, duel.models
    asked = NextSwing(
        experiment.angle, experiment.duration, duel.close(times), (one.label, other.label), experiment.kind, experiment.velocity,
        times, do=experiment.words(times, one),
    )  # fmt: skip
    if isinstance(experiment, LetGo):
        return asked
    said = tuple(tuple(map(float, each)) for each in duel.predicted)
    return replace(asked, angles=experiment.angles, limit=experiment.limit, predicted=said)


def _beside(names: Sequence[str], others: Sequence[str]) -> str:
    """What these names have that the others lack, as words."""
    own = [name.replace("_", " ") for name in names if name not in others]
    return " + ".join(own) or "the model without it"
