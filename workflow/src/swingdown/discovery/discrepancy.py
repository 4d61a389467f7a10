"""The discrepancy: whatever a model lacks, as Gaussian processes beside the noise, and the evidence of a fit that has it.

    reading = model + G c + noise,   c ~ N(0, s^2) for each kind of discrepancy

The columns of G are what unnamed torques over angle, over angle, speed and side, and over time, and an error of the sensor over its
reading do to the reading, to first order. What the fit's own values can imitate is projected out. The sizes s are those of the
largest marginal likelihood (Kennedy and O'Hagan, J. R. Stat. Soc. B 63, 425 (2001)).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_solve, cholesky
from scipy.linalg.lapack import dpotri
from scipy.optimize import minimize

from ..arrays import Floats
from .campaign import Noise, Swing
from .green import Motion, hats, motion, response
from .linear import Frame

_BINS = 24  # a period: as finely as a pendulum's response to a smooth torque is seen
_ANGLES, _SPEEDS, _TIMES = (
    11,
    6,
    6,
)  # nodes over angle, over speed to either side, and over the time of a record
_SMOOTH = (
    0.35,
    1.2,
)  # of the largest angle, speed and of the record: how far neighbouring torques hang together, of each kind both
_KEPT = 1e-5  # of the largest variance of a kind: directions that have less are left out
_SEEN = 1e-7  # of the largest power of a direction in the readings: of less nothing is seen
# Standard deviation of the logarithm of the noise's variance at the harmonics, beside what it is known to above them, where it is measured.
_NOISE_KNOWN = 0.2
_ANY = 3.0  # the same where something unnamed may be as quick as noise is
_FINE = (
    25,
    0.12,
)  # nodes over angle, and how far they hang together, of a torque that is there at some angles only
KINDS = ("restoring", "dissipative", "time", "sensor")
_STARTS = (
    0.0,
    6.0,
)  # logarithms of each kind's variance over the noise's, at which the search for the largest likelihood begins


@dataclass(frozen=True)
class Discrepancy:
    """What a fit lacks: ``log_evidence`` with a discrepancy, and ``log_plain`` without one (natural logarithms, of one common
    constant for all fits of the same swings); ``size`` (rad), the RMS of its work on the readings beyond what the fit imitates, with what
    is as quick as noise and not the noise; ``sizes`` the same by kind; ``rest``, the RMS beyond fit and discrepancy in units of the
    noise; ``widened``, by how much the standard error of each value that all swings share is larger where the discrepancy may do some
    of its work."""

    log_evidence: float
    log_plain: float
    size: float
    sizes: dict[str, float]
    rest: float
    widened: dict[str, float]


def discrepancy(frame: Frame, noise: Noise, period: float) -> Discrepancy:
    """The ``Discrepancy`` of a fit seen in a ``Frame``, under this noise; ``period`` (s), the pendulum's, about, sets the bins of time in
    which residuals are looked at: fits that are compared need the same."""
    residual, slopes, columns, kinds = _seen(frame, period)
    basis = _basis(slopes)
    outside = columns - basis @ (basis.T @ columns)
    outside -= basis @ (basis.T @ outside)
    left = residual - basis @ (basis.T @ residual)
    variance, rows = noise.slow_variance, residual.size - basis.shape[1]
    triangle, along = _reduced(outside, kinds, left)
    rest = max(float(left @ left - along @ along), 0.0)
    parts = [triangle[:, kinds == kind] for kind in range(kinds[-1] + 1)]
    model = _Likelihood(parts, along, rest, rows, variance, float(np.hypot(_NOISE_KNOWN, noise.known)))
    plain = _minimal(model, None)
    best = min((_minimal(model, start) for start in _STARTS), key=lambda one: one[0])
    sizes, size = model.work(best[1])
    scale = 1 / np.sqrt(frame.samples)
    quick = max(np.exp(best[1][-1]) - 1, 0.0) * variance * rows
    return Discrepancy(
        -best[0],
        -plain[0],
        float(np.hypot(size, np.sqrt(quick)) * scale),
        {name: float(one * scale) for name, one in zip(KINDS, sizes, strict=True)},
        float(np.sqrt(model.left(best[1]) / rows / variance)),
        _widened(frame, slopes, columns * model.deviations(best[1])[kinds], variance * np.exp(best[1][-1])),
    )


def _widened(frame: Frame, slopes: Floats, columns: Floats, variance: float) -> dict[str, float]:
    """By shared value: its standard error with a discrepancy of these columns over that without."""
    size = np.linalg.norm(slopes, axis=0)
    kept = size > 0
    unit = slopes[:, kept] / size[kept]
    inner, across = unit.T @ unit, unit.T @ columns
    within = columns.T @ columns
    within[np.diag_indices_from(within)] += variance
    seen = inner - across @ np.linalg.solve(within, across.T)
    alone, beside = (np.diag(np.linalg.pinv(one, rcond=1e-13, hermitian=True)) for one in (inner, seen))
    ratio = np.sqrt(np.maximum(beside / np.maximum(alone, 1e-300), 1.0))
    names = [name for name, there in zip(frame.names, kept, strict=True) if there]
    shared = [of < 0 for of, there in zip(frame.of, kept, strict=True) if there]
    return {name: float(one) for name, one, is_shared in zip(names, ratio, shared, strict=True) if is_shared}


def _reduced(columns: Floats, kinds: NDArray[np.intp], residual: Floats) -> tuple[Floats, Floats]:
    """(columns, residual) in the few directions in which a discrepancy of any kind does more than next to nothing."""
    size = np.sqrt(np.bincount(kinds, np.einsum("ij,ij->j", columns, columns)))
    size[size == 0] = 1.0
    even = columns / size[kinds]
    if even.shape[0] < even.shape[1]:
        powers, vectors = np.linalg.eigh(even @ even.T)
        directions = vectors[:, powers > _SEEN * powers[-1]]
        return directions.T @ columns, directions.T @ residual
    powers, vectors = np.linalg.eigh(even.T @ even)
    kept = powers > _SEEN * powers[-1]
    root = np.sqrt(powers[kept])
    along = (vectors[:, kept].T @ (even.T @ residual)) / root
    return (root[:, None] * vectors[:, kept].T) * size[kinds], along


class _Likelihood:
    """The negative log-likelihood of what is left of a residual: by the logarithms of each kind's variance and of the noise's."""

    def __init__(
        self, parts: Sequence[Floats], along: Floats, rest: float, rows: int, variance: float, known: float
    ):
        self.along, self.rest, self.rows, self.variance, self.known = along, rest, rows, variance, known
        # in units in which a kind of size one does as much as the noise
        self.scale = [np.sqrt(variance * along.size / max(float(np.sum(p**2)), 1e-300)) for p in parts]
        self.kernels = [(p * s) @ (p * s).T for p, s in zip(parts, self.scale, strict=True)]

    def covariance(self, x: Floats) -> tuple[Floats, float]:
        """The covariance of what is left in the directions that a discrepancy sees, and the noise's variance in it."""
        noise, made = self.variance * np.exp(x[-1]), np.zeros((self.along.size,) * 2)
        for size, kernel in zip(x[:-1], self.kernels, strict=False):
            made += np.exp(size) * kernel
        made[np.diag_indices_from(made)] += noise
        return made, noise

    def __call__(self, x: Floats) -> tuple[float, Floats]:
        """The negative log-likelihood and its slopes."""
        total, noise = self.covariance(x)
        root = cholesky(total, lower=True, overwrite_a=True, check_finite=False)
        weights = cho_solve((root, True), self.along, check_finite=False)
        inverse = dpotri(root, lower=1)[0] if root.size else root  # its lower triangle
        inverse += np.tril(inverse, -1).T
        beyond = self.rows - self.along.size
        value = 0.5 * (weights @ self.along) + np.log(np.diag(root) / np.sqrt(self.variance)).sum()
        known = self.known if len(x) == 1 else _ANY
        value += 0.5 * (beyond * x[-1] + self.rest / noise) + 0.5 * (x[-1] / known) ** 2 + np.log(known)
        slope = np.zeros(len(x))
        for k, kernel in enumerate(self.kernels[: len(x) - 1]):
            slope[k] = 0.5 * np.exp(x[k]) * (np.vdot(inverse, kernel) - weights @ kernel @ weights)
        slope[-1] = 0.5 * noise * (np.trace(inverse) - weights @ weights)
        slope[-1] += 0.5 * (beyond - self.rest / noise) + x[-1] / known**2
        return value, slope

    def deviations(self, x: Floats) -> Floats:
        """The standard deviation of each kind's coefficients."""
        return np.array([np.exp(one / 2) * scale for one, scale in zip(x, self.scale, strict=False)])

    def work(self, x: Floats) -> tuple[list[Any], Any]:
        """(RMS sums by kind, of all together): what the discrepancy does to the projected readings, rad."""
        total, _ = self.covariance(x)
        weights = np.linalg.solve(total, self.along)
        each = [np.exp(one) * kernel @ weights for one, kernel in zip(x, self.kernels, strict=False)]
        each = [sum(each[k :: len(KINDS)]) for k in range(len(KINDS))]
        return [np.linalg.norm(one) for one in each], np.linalg.norm(np.sum(each, axis=0))

    def left(self, x: Floats) -> float:
        """The sum of squares beyond fit and discrepancy."""
        total, noise = self.covariance(x)
        return self.rest + float(np.sum((noise * np.linalg.solve(total, self.along)) ** 2))


def _minimal(model: _Likelihood, start: float | None) -> tuple[float, Floats]:
    """(least negative log-likelihood, where); None: without a discrepancy."""
    count = 0 if start is None else len(model.kernels)
    begin = np.r_[np.full(count, start or 0.0), 0.0]
    bounds = [(-12.0, 25.0)] * count + [(-1.0, 12.0)]
    found = minimize(
        model, begin, jac=True, method="L-BFGS-B", bounds=bounds, options={"maxiter": 60, "ftol": 1e-7}
    )
    return float(found.fun), found.x


def _seen(frame: Frame, period: float) -> tuple[Floats, Floats, Floats, NDArray[np.intp]]:
    """(residual, the fit's slopes, columns of the discrepancy, kind of each), in bins of time weighed by their samples."""
    means, motions = [], []
    for swing, one, rows in zip(frame.swings, frame.fit.swings, frame.slices, strict=True):
        mean = _Means(swing.times, period / _BINS)
        coarse = Swing(swing.name, mean.times, mean(swing.angle), swing.drive)
        motions.append(motion(one.model, coarse, one.release_angle, one.release_velocity))
        means.append((mean, rows))
    weight = np.concatenate([mean.weight for mean, _ in means])

    def binned(series: Floats) -> Floats:
        return np.concatenate([mean(series[rows]) for mean, rows in means])

    below = slice(frame.samples, None)
    residual = np.r_[binned(frame.residual) * weight, frame.residual[below]]
    slopes = np.vstack([binned(frame.slopes) * weight[:, None], frame.slopes[below]])
    columns, kinds = _columns(motions)
    columns = np.vstack(
        [columns * weight[:, None], np.zeros((residual.size - weight.size, columns.shape[1]))]
    )
    return residual, slopes, columns, kinds


def _basis(slopes: Floats) -> Floats:
    size = np.linalg.norm(slopes, axis=0)
    return np.linalg.qr(slopes[:, size > 0] / size[size > 0])[0]


class _Means:
    """Means over bins of time, the first sample a bin of its own, since a motion begins there."""

    def __init__(self, times: Floats, width: float):
        label = np.r_[-1, np.floor((times[1:] - times[0]) / width)].astype(int)
        _, self.label, self.count = np.unique(label, return_inverse=True, return_counts=True)
        self.times = self(times)
        self.weight = np.sqrt(self.count)

    def __call__(self, series: Floats) -> Floats:
        flat = series.reshape(series.shape[0], -1)
        sums = np.stack([np.bincount(self.label, one) for one in flat.T], axis=1) / self.count[:, None]
        return sums.reshape(-1, *series.shape[1:])


def _columns(motions: list[Motion]) -> tuple[Floats, NDArray[np.intp]]:
    """The work of each unit of discrepancy on the readings (bin, unit), and the kind of each unit, first of the first smoothness."""
    largest = max(float(np.max(np.abs(one.angle))) for one in motions)
    fastest = max(float(np.max(np.abs(one.speed))) for one in motions)
    blocks: list[list[Floats]] = []
    for k, one in enumerate(motions):
        torques, readings = _shapes(one, largest, fastest)
        edges = np.cumsum([0, *(shape.shape[1] for shape in torques)])
        worked = response(one, np.hstack(torques))
        found = []
        for first in range(0, len(torques) - 2, 3):
            restoring, dissipative, in_time = (
                worked[:, edges[first + j] : edges[first + j + 1]] for j in range(3)
            )
            own = np.zeros((len(worked), len(motions) * in_time.shape[1]))
            own[:, k * in_time.shape[1] : (k + 1) * in_time.shape[1]] = in_time
            found += [restoring, dissipative, own, readings[first // 3]]
        found += [worked[:, edges[-3] : edges[-2]], worked[:, edges[-2] :]]
        blocks.append(found)
    kinds = np.concatenate([np.full(block.shape[1], k) for k, block in enumerate(blocks[0])])
    return np.concatenate([np.hstack(found) for found in blocks]), kinds


def _shapes(one: Motion, largest: float, fastest: float) -> tuple[list[Floats], list[Floats]]:
    """Torques on the grid of times (restoring, dissipative, in time for each smoothness, and a fine one over the angle of either) and errors of the reading at its samples."""
    angles, speeds, since = np.linspace(-1, 1, _ANGLES), np.linspace(0, 1, _SPEEDS), np.linspace(0, 1, _TIMES)
    at = hats(one.angle / largest, angles)
    either = hats(np.abs(one.speed) / fastest, speeds)
    side = (one.speed >= 0)[:, None]
    sides = np.hstack([either * side, either * ~side])
    both = np.einsum("ta,ts->tas", at, sides).reshape(len(at), -1)
    elapsed = hats((one.times - one.times[0]) / (one.times[-1] - one.times[0]), since)
    torques: list[Floats] = []
    readings: list[Floats] = []
    for smooth in _SMOOTH:
        course = elapsed @ _root(_TIMES, 1.0, smooth)
        in_time = [course, course * (one.angle / largest)[:, None], course * (one.speed / fastest)[:, None]]
        along = at @ _root(_ANGLES, 2.0, smooth)
        torques += [along, both @ _root_of_both(smooth), np.hstack(in_time)]
        readings.append(along[one.at])
    fine = hats(one.angle / largest, np.linspace(-1, 1, _FINE[0])) @ _root(_FINE[0], 2.0, _FINE[1])
    return [*torques, fine, np.hstack([fine * side, fine * ~side])], readings


def _near(count: int, span: float, smooth: float) -> Floats:
    nodes = np.linspace(0, span, count)
    return np.exp(-0.5 * np.square((nodes[:, None] - nodes) / smooth))


@cache
def _root(count: int, span: float, smooth: float) -> Floats:
    return _square_root(_near(count, span, smooth))


@cache
def _root_of_both(smooth: float) -> Floats:
    return _square_root(np.kron(_near(_ANGLES, 2.0, smooth), np.kron(np.eye(2), _near(_SPEEDS, 1.0, smooth))))


def _square_root(covariance: Floats) -> Floats:
    """Columns whose products sum to the covariance, those of next to no variance left out."""
    values, vectors = np.linalg.eigh(covariance)
    kept = values > _KEPT * values[-1]
    return vectors[:, kept] * np.sqrt(values[kept])
