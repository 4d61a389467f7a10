"""The next swing to record: that on which the leading structures of a campaign differ most, beyond what they could still give way.

Both fitted models are let go from the same releases. What remains of their difference where the release and every value of
either model may move, the values as far as the fits leave them open, is told in standard deviations of the noise: twice that
is how much the sum of squares will speak for one of them (the T-optimum of Atkinson and Fedorov, Biometrika 62, 57 (1975)).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..arrays import Floats
from ..engine.trajectory import TrajectoryError, sensitivities, simulate
from ..errors import InputError
from ..fitting.problem import RELEASE
from ..fitting.result import Fit
from .campaign import Campaign, Noise

_REACHES = (0.25, 0.5, 1.0, 1.5, 2.0)  # of the largest angle so far
_LASTING = (1.0, 3.0)  # of the longest swing so far
_FARTHEST = np.radians(85.0)  # of a pendulum: beyond, a rod is pushed and not pulled
_NEARLY = 0.9  # of the best separation: less trouble is worth more
_MOST = 3000  # samples that are computed of a swing; its noise is weighed as if all were
_KNOWN = 1e-9  # of a value's size, its least standard error


@dataclass(frozen=True)
class NextSwing:
    """A swing to record: release angle (rad, with its side), how long (s), and by how many standard deviations of the noise the two
    structures (labels) will differ."""

    release_angle: float
    duration: float
    separation: float
    between: tuple[str, str]

    def __str__(self) -> str:
        side = "positive" if self.release_angle > 0 else "negative"
        one, other = (label.replace("_", " ").replace("+", " + ") for label in self.between)
        return (
            f"Release from {np.degrees(abs(self.release_angle)):.2g}° on the {side} side and record {self.duration:.3g} s: "
            f"{one} and {other} then differ by {self.separation:.2g} standard deviations."
        )


def next_swing(one: Fit, other: Fit, campaign: Campaign, noise: Noise) -> NextSwing | None:
    """The ``NextSwing`` that best tells two fits of a campaign apart, of releases from a quarter to twice the largest angle so far,
    from both sides, as long as the longest swing so far or three times that; None where neither model can be let go."""
    swings = (*campaign.fit, *campaign.holdout)
    largest = max(float(np.max(np.abs(swing.angle))) for swing in swings)
    longest = max(float(swing.times[-1] - swing.times[0]) for swing in swings)
    interval = min(float(np.median(np.diff(swing.times))) for swing in swings)
    farthest = max(largest, _FARTHEST) if one.model.restoring == "sine" else np.inf
    found: list[NextSwing] = []
    labels = (one.model.label, other.model.label)
    # the least trouble first
    for lasting in _LASTING:
        for reach in _REACHES:
            for side in (1.0, -1.0):
                angle = min(reach * largest, farthest) * side
                try:
                    apart = separation(one, other, angle, lasting * longest, interval, noise)
                except (TrajectoryError, InputError):
                    continue
                found.append(NextSwing(angle, lasting * longest, apart, labels))
    if not found:
        return None
    best = max(swing.separation for swing in found)
    return next(swing for swing in found if swing.separation >= _NEARLY * best)


def separation(
    one: Fit, other: Fit, release_angle: float, duration: float, interval: float, noise: Noise
) -> float:
    """By how many standard deviations of the noise two fits differ on a swing from rest at ``release_angle`` (rad) of so many
    seconds, sampled every ``interval`` seconds, beyond what their values and the release could do about it."""
    samples = max(int(duration / interval), 2)
    every = -(-samples // _MOST)
    times = np.arange(0, samples, every) * interval
    difference = simulate(one.model, times, release_angle) - simulate(other.model, times, release_angle)
    scale = np.sqrt(noise.slow_variance / every)
    columns, known = [], []
    for fit in (one, other):
        slopes, error = _leeway(fit, times, release_angle, noise)
        columns.append(slopes.T / scale)
        known.append(error)
    # what is known of the values stands below the samples; of releases and of what each swing has for itself nothing is known
    whole = np.vstack([np.hstack(columns), _beneath(known)])
    aim = np.concatenate([difference / scale, np.zeros(whole.shape[0] - difference.size)])
    size = np.linalg.norm(whole, axis=0)
    size[size == 0] = 1.0
    step = np.linalg.lstsq(whole / size, aim, rcond=1e-12)[0]
    return float(np.linalg.norm(aim - (whole / size) @ step))


def _leeway(fit: Fit, times: Floats, release_angle: float, noise: Noise) -> tuple[Floats, Floats]:
    """The slopes of a swing by every free value, and rows that tell how well each is known (of those that are)."""
    model = fit.model
    shared = [name for name in model.parameters if name in fit.free and name not in model.each]
    each = [*model.each, *RELEASE]
    slopes = sensitivities(model, times, release_angle, free=[*shared, *each])[1]
    at = [fit.free.index(name) for name in shared]
    covariance = fit.covariance[np.ix_(at, at)] * noise.inflation
    sure = np.isfinite(np.diag(covariance))
    slopes[: len(shared)][~sure] = 0.0  # at a bound
    rows = np.zeros((int(sure.sum()), len(shared) + len(each)))
    if sure.any():
        inside = covariance[np.ix_(sure, sure)]
        root = np.sqrt(np.maximum(np.diag(inside), (_KNOWN * np.abs(fit.values[at][sure])) ** 2 + 1e-300))
        correlation = inside / np.outer(root, root) + 1e-9 * np.eye(root.size)
        rows[:, np.flatnonzero(sure)] = np.linalg.inv(np.linalg.cholesky(correlation)) / root
    return slopes, rows


def _beneath(known: Sequence[Floats]) -> Floats:
    """Rows of both models, each over its own columns."""
    return np.block([[rows if i == k else np.zeros((rows.shape[0], other.shape[1])) for k, other in enumerate(known)]
                     for i, rows in enumerate(known)])  # fmt: skip
