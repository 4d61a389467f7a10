"""Two fits held against each other on one experiment: how far apart what they say of it stays, beyond what they could still give way.

What remains of their difference where the release and every value of either model may move, the values as far as the fits leave them
open, is told in standard deviations of the noise: its square is how much the sum of squares will speak for one of them (the
T-optimum of Atkinson and Fedorov, Biometrika 62, 57 (1975)).
"""

from math import sqrt

import numpy as np

from ...arrays import Floats
from ...engine.trajectory import TrajectoryError, TrajectoryWarning
from ...errors import InputError
from ...fitting.problem import RELEASE
from ...fitting.result import Fit
from ...pendulum.catalogue import ANGLE
from ..data.noise import Noise
from .experiments import Experiment, Held

REFUSED = (TrajectoryError, TrajectoryWarning, InputError, np.linalg.LinAlgError)
"""What an experiment raises of which a model can say nothing, where a TrajectoryWarning is an error."""
_KNOWN = 1e-9  # of a value's size, its least standard error
_STEPS = 8  # towards each other, at most
_PARTS = (1.0, 0.3, 0.1, 0.03)  # of a step that is tried
_STILL = 0.98  # of what is left: steps that promise less are not gone


class Duel:
    """Two fits on one experiment. The first says what is read, of a swing from the release that is asked for; the other has a release,
    and all that each recording has for itself, of its own.

    ``predicted`` holds what either says. One of ``REFUSED`` is raised where one of them can say nothing.
    """

    def __init__(self, one: Fit, other: Fit, experiment: Experiment, noise: Noise) -> None:
        self.experiment, self.models = experiment, (one.model, other.model)
        self._noise = noise
        (mine, rows), (theirs, others) = (leeway(fit, noise) for fit in (one, other))
        self._shared, self._own = (mine, theirs), experiment.own(other.model)
        self._sizes = [len(mine), len(theirs), len(self._own)]
        self._known = np.zeros((len(rows) + len(others), sum(self._sizes)))
        self._known[: len(rows), : len(mine)] = rows
        self._known[len(rows) :, len(mine) : len(mine) + len(theirs)] = others
        self._triangle, self.predicted = self._moved(np.zeros(sum(self._sizes)))
        if self._own and other.model.reading == ANGLE:  # a fit begins where the reading does
            self._own[RELEASE[0]] += float(self.predicted[0][0] - self.predicted[1][0])
            self._triangle, self.predicted = self._moved(np.zeros(sum(self._sizes)))
        self._closely: dict[int, float] = {}

    def separation(self, times: int = 1) -> float:
        """By how many standard deviations they differ where it is done so many times, to first order."""
        return self._step(self._triangle, np.zeros(sum(self._sizes)), times)[1]

    def close(self, times: int = 1) -> float:
        """The same where each step is gone and looked from again: swings that stop, and values that are hardly known, are not linear."""
        if times not in self._closely:
            self._closely[times] = self._followed(times)
        return self._closely[times]

    def _followed(self, times: int) -> float:
        at, triangle = np.zeros(sum(self._sizes)), self._triangle
        left = self._left(triangle, at, times)
        for _ in range(_STEPS):
            step, promised = self._step(triangle, at, times)
            if promised > _STILL * left:
                break
            for part in _PARTS:
                there = at + part * step
                try:
                    moved, _ = self._moved(there)
                except REFUSED:
                    continue
                now = self._left(moved, there, times)
                if now < left:
                    at, triangle, left = there, moved, now
                    break
            else:
                break
        return left

    def _moved(self, step: Floats) -> tuple[Floats, tuple[Floats, Floats]]:
        """So far from the fits: the triangle of all slopes with the difference as its last column, in units of the noise; the readings."""
        parts = np.split(step, np.cumsum(self._sizes)[:2])
        ways = [
            self.experiment.own(self.models[0]),
            {n: v + d for (n, v), d in zip(self._own.items(), parts[2], strict=True)},
        ]
        said = []
        for model, names, by, own in zip(self.models, self._shared, parts, ways, strict=False):
            values = {name: model.values[name] + d for name, d in zip(names, by, strict=True)}
            said.append(self.experiment.predicted(model.with_values({**model.values, **values}), names, own))
        one, other = said
        columns = np.column_stack([one.shared, -other.shared, -other.own, one.readings - other.readings])
        triangle = np.asarray(np.linalg.qr(self.experiment.weighed(columns, self._noise), mode="r"))
        return triangle, (one.readings, other.readings)

    def _step(self, triangle: Floats, at: Floats, times: int) -> tuple[Floats, float]:
        """The step that brings both closest, to first order, and how far apart they then are."""
        # what is known of the values stands below the readings; of a release and of what a swing has for itself nothing is known
        rows = np.vstack([sqrt(times) * triangle, np.c_[self._known, self._known @ at]])
        whole, aim = rows[:, :-1], -rows[:, -1]
        size = np.linalg.norm(whole, axis=0)
        size[size == 0] = 1.0
        step = np.linalg.lstsq(whole / size, aim, rcond=1e-12)[0]
        return step / size, float(np.linalg.norm(aim - (whole / size) @ step))

    def _left(self, triangle: Floats, at: Floats, times: int) -> float:
        return float(
            np.hypot(sqrt(times) * np.linalg.norm(triangle[:, -1]), np.linalg.norm(self._known @ at))
        )


def misfit(fit: Fit, experiment: Held, readings: Floats, noise: Noise) -> float:
    """The chi-square that a fit leaves of readings (rad) at known angles, where its values may move as far as it leaves them open."""
    shared, rows = leeway(fit, noise)
    said = experiment.predicted(fit.model, shared, {})
    whole = np.vstack([experiment.weighed(said.shared, noise), rows])
    aim = np.r_[experiment.weighed(readings - said.readings, noise), np.zeros(len(rows))]
    step = np.linalg.lstsq(whole, aim, rcond=None)[0]
    return float(np.sum((aim - whole @ step) ** 2))


def leeway(fit: Fit, noise: Noise) -> tuple[list[str], Floats]:
    """The values that a fit shares and is sure of to some degree, and rows that tell how well each is known."""
    model = fit.model
    shared = [name for name in model.parameters if name in fit.free and name not in model.each]
    at = [fit.free.index(name) for name in shared]
    covariance = fit.covariance[np.ix_(at, at)] * noise.inflation
    sure = np.isfinite(np.diag(covariance))  # not at a bound
    inside, values = covariance[np.ix_(sure, sure)], fit.values[at][sure]
    root = np.sqrt(np.maximum(np.diag(inside), (_KNOWN * np.abs(values)) ** 2 + 1e-300))
    correlation = inside / np.outer(root, root) + 1e-9 * np.eye(root.size)
    rows = np.linalg.inv(np.linalg.cholesky(correlation)) / root
    return [name for name, each in zip(shared, sure, strict=True) if each], rows
