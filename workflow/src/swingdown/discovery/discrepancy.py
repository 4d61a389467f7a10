"""The discrepancy: whatever a model lacks, as Gaussian processes beside the noise, and the evidence of a fit that has it.

    reading = model + G c + noise,   c ~ N(0, s^2) for each kind of discrepancy

The columns of G are what unnamed torques over angle, over angle, speed and side, and over time, and an error of the sensor over its
reading do to the reading, to first order. What the fit's own values can imitate is projected out. The sizes s are those of the
largest marginal likelihood (Kennedy and O'Hagan, J. R. Stat. Soc. B 63, 425 (2001)).
"""

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_solve, cholesky, solve_triangular
from scipy.linalg.lapack import dpotri
from scipy.optimize import brentq

from ..arrays import Floats
from ..fitting.result import Fit
from .campaign import Noise, Swing
from .green import Motion, hats, motion, over_both, response
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
_SEEN = 1e-8  # of the largest power of a direction in the readings: of less nothing is seen
# Standard deviation of the logarithm of the noise's variance at the harmonics, beside what it is known to above them, where it is measured.
_NOISE_KNOWN = 0.2
_ANY = 3.0  # the same where something unnamed may be as quick as noise is
_FINE = (
    25,
    0.12,
)  # nodes over angle, and how far they hang together, of a torque that is there at some angles only
_SIZES, _NOISES = (
    (-12.0, 25.0),
    (-1.0, 12.0),
)  # bounds of these logarithms, and of the noise's over what it is known to be
_ENOUGH = 0.01  # of the log-likelihood: a step that promises less is the last
_FARTHEST, _STEPS = 3.0, 60  # of these logarithms in one step; steps
_LEAST = 1e-6  # damping of a step, of the curvature
KINDS = ("restoring", "dissipative", "time", "sensor")


@dataclass(frozen=True)
class Discrepancy:
    """What a fit lacks: ``log_evidence`` with a discrepancy, and ``log_plain`` without one (natural logarithms, of one common
    constant for all fits of the same swings); ``size`` (rad), the RMS of its work on the readings beyond what the fit imitates, with what
    is as quick as noise and not the noise; ``sizes`` the same by kind; ``rest``, the RMS beyond fit and discrepancy in units of the
    noise; ``widened``, by how much the standard error of each value that all swings share is larger where the discrepancy may do some
    of its work; ``covariance``, that of the values ``names`` beside the discrepancy, in units of its own; ``friction`` and
    ``friction_error`` (rad/s^2), the unnamed torque against the motion that is left at the middle as the speed goes to nothing."""

    log_evidence: float
    log_plain: float
    size: float
    sizes: dict[str, float]
    rest: float
    widened: dict[str, float]
    names: tuple[str, ...]
    covariance: Floats
    friction: float = 0.0
    friction_error: float = 0.0

    def given(self, name: str, held: Collection[str]) -> float:
        """The standard error of a value where those ``held`` are, over that where they are free; 1 of what was not fitted."""
        if name not in self.names:
            return 1.0
        at = [self.names.index(one) for one in (name, *held) if one in self.names]
        known = self.covariance[np.ix_(at, at)]
        scale = np.sqrt(np.maximum(np.diag(known), 1e-300))
        alone = np.linalg.pinv(known / np.outer(scale, scale), hermitian=True)[0, 0]
        return float(1 / np.sqrt(max(alone, 1.0)))


class Unnamed:
    """What may be missing of a pendulum, by what it would do to swings near those of one ``fit``: the same for all fits of these swings, so
    that they can be compared.

    ``period`` (s), the pendulum's, about, sets the bins of time in which residuals are looked at; those of a ``noise`` with memory by what
    they do not have from the bin before.
    """

    def __init__(self, fit: Fit, swings: Sequence[Swing], period: float, noise: Noise):
        self._noise = noise
        self._means = [_Means(swing.times, period / _BINS, noise) for swing in swings]
        motions = []
        for swing, mean, one in zip(swings, self._means, fit.swings, strict=True):
            coarse = Swing(swing.name, mean.times, mean(swing.angle), swing.drive)
            motions.append(motion(one.model, coarse, one.release_angle, one.release_velocity))
        columns, kinds = _columns(motions, self._means)
        self._directions, along = _reduced(columns, kinds)
        self._parts = [along[:, kinds == kind] for kind in range(kinds[-1] + 1)]
        self._kernels = np.stack([part @ part.T for part in self._parts])
        self._rubs = _rubs(self._parts)

    def beside(self, frame: Frame) -> Discrepancy:
        """The ``Discrepancy`` of a fit seen in a ``Frame``."""
        noise = self._noise
        size = np.linalg.norm(frame.slopes, axis=0)
        kept = size > 0
        basis, triangle = np.linalg.qr(self._binned(frame, frame.slopes[:, kept] / size[kept]))
        residual = self._binned(frame, frame.residual[:, None])[:, 0]
        left = residual - basis @ (basis.T @ residual)
        within = slice(None, len(self._directions))
        inside = self._directions.T @ np.column_stack([left[within], basis[within]])
        model = _Likelihood(
            self._parts,
            self._kernels,
            inside[:, 0],
            inside[:, 1:],
            float(left @ left),
            left.size,
            noise.slow_variance,
        )
        at = _minimal(model)
        scale = 1 / np.sqrt(frame.samples)
        sizes, whole = at.work()
        quick = max(at.noise - noise.slow_variance, 0.0) * (left.size - basis.shape[1])
        alone, beside = (
            _inverse(one) for one in (triangle.T @ triangle, triangle.T @ at.seen @ triangle * at.noise)
        )
        ratio = np.sqrt(np.maximum(np.diag(beside) / np.maximum(np.diag(alone), 1e-300), 1.0))
        named = [(name, of) for name, of, there in zip(frame.names, frame.of, kept, strict=True) if there]
        shared = [k for k, (_, of) in enumerate(named) if of < 0]
        return Discrepancy(
            -float(at.cost),
            -model.plain(float(np.hypot(_NOISE_KNOWN, noise.known))),
            float(np.hypot(whole, np.sqrt(quick)) * scale),
            dict(zip(KINDS, (sizes * scale).tolist(), strict=True)),
            float(np.sqrt(at.left / (left.size - basis.shape[1]) / noise.slow_variance)),
            {named[k][0]: float(ratio[k]) for k in shared},
            tuple(named[k][0] for k in shared),
            beside[np.ix_(shared, shared)],
            *at.linear(self._rubs),
        )

    def level(self, frame: Frame) -> float:
        """What the logarithms of evidences lack of those of the readings themselves, in rad: the same for all fits under this noise."""
        rows = sum(mean.count.size for mean in self._means)
        free = rows - np.count_nonzero(np.linalg.norm(frame.slopes, axis=0))
        return sum(mean.volume for mean in self._means) - 0.5 * free * float(
            np.log(self._noise.slow_variance)
        )

    def _binned(self, frame: Frame, series: Floats) -> Floats:
        """Series (samples and what stands below them, any) in bins of time, weighed by their samples."""
        binned = [mean.news(mean(series[rows])) for mean, rows in zip(self._means, frame.slices, strict=True)]
        return np.concatenate([*binned, series[frame.samples :]])


def _inverse(information: Floats) -> Floats:
    return np.linalg.pinv(information, rcond=1e-13, hermitian=True)


def _reduced(columns: Floats, kinds: NDArray[np.intp]) -> tuple[Floats, Floats]:
    """The few directions (orthonormal columns) in which a discrepancy of any kind does more than next to nothing, and the columns along them."""
    size = np.sqrt(np.bincount(kinds, np.einsum("ij,ij->j", columns, columns)))
    size[size == 0] = 1.0
    left, singular, right = np.linalg.svd(columns / size[kinds], full_matrices=False)
    kept = singular**2 > _SEEN * singular[0] ** 2
    return left[:, kept], singular[kept, None] * right[kept] * size[kinds]


class _Likelihood:
    """The restricted likelihood of a residual beside a discrepancy, by the logarithms of each kind's variance and of the noise's.

    ``residual`` and ``basis`` (direction, value) are those of the fit along the directions of the discrepancy, ``squares`` the residual's sum
    of them over all its ``rows``. What the fit's own values can imitate is left out by a factor det(B'B) / det(B'V^-1 B), B being
    their basis and V the covariance (Patterson and Thompson, Biometrika 58, 545 (1971)): no column is projected.
    """

    def __init__(
        self,
        parts: Sequence[Floats],
        kernels: Floats,
        residual: Floats,
        basis: Floats,
        squares: float,
        rows: int,
        variance: float,
    ):
        self.residual, self.basis, self.rows, self.variance = residual, basis, rows, variance
        self.parts = parts
        self.squares, self.kernels = squares, kernels
        self.beyond = (
            np.eye(basis.shape[1]) - basis.T @ basis,
            -basis.T @ residual,
            max(float(squares - residual @ residual), 0.0),
        )
        # in units in which a kind of size one does as much as the noise, beyond what the fit imitates
        power = np.array([np.sum(part**2) - np.sum((basis.T @ part) ** 2) for part in parts])
        self.scale = variance * residual.size / np.maximum(power, 1e-300)

    def at(self, x: Floats) -> "_At":
        """The likelihood at these logarithms."""
        return _At(self, np.exp(x[:-1]) * self.scale, self.variance * np.exp(x[-1]))

    def plain(self, known: float) -> float:
        """The least negative log-likelihood without a discrepancy, the logarithm of the noise's variance being known to so much."""
        free, power = self.rows - self.basis.shape[1], self.squares / self.variance
        low, high = _NOISES

        def slope(x: float) -> float:
            return 0.5 * (free - power * np.exp(-x)) + x / known**2

        x = low if slope(low) > 0 else high if slope(high) < 0 else brentq(slope, low, high)
        return float(0.5 * (free * x + power * np.exp(-x)) + 0.5 * (x / known) ** 2 + np.log(known))


class _At:
    """A likelihood at variances of each kind and of the noise: its negative logarithm ``value``, the same (``cost``) of a noise that may be any,
    the information ``seen`` on what the fit's basis spans, and ``pulled``, the residual in units of its variance along the directions of the discrepancy."""

    def __init__(self, model: _Likelihood, sizes: Floats, noise: float):
        self.model, self.sizes, self.noise = model, sizes, noise
        count = model.residual.size
        total = (sizes @ model.kernels.reshape(sizes.size, -1)).reshape(count, count)
        total[np.diag_indices(count)] += noise
        self.root = cholesky(total, lower=True, overwrite_a=True, check_finite=False)
        within = cho_solve(
            (self.root, True), np.column_stack([model.residual, model.basis]), check_finite=False
        )
        own, self.across = within[:, 0], within[:, 1:]
        square, cross, rest = model.beyond
        self.seen = square / noise + model.basis.T @ self.across
        known, pull = cholesky(self.seen, lower=True, check_finite=False), cross / noise + model.basis.T @ own
        self.inverse = cho_solve((known, True), np.eye(pull.size), check_finite=False)
        self.step = self.inverse @ pull
        self.pulled = own - self.across @ self.step
        self.outside = rest - 2 * self.step @ cross + self.step @ square @ self.step
        power = rest / noise + model.residual @ own - pull @ self.step
        determinants = np.log(np.diag(self.root)).sum() + np.log(np.diag(known)).sum()
        free = 0.5 * (pull.size - count) * np.log(model.variance)
        level = 0.5 * (model.rows - count) * np.log(noise / model.variance)
        self.louder = np.log(noise / model.variance)
        self.value = float(0.5 * power + determinants + free + level)
        self.cost = self.value + 0.5 * (self.louder / _ANY) ** 2 + np.log(_ANY)

    @property
    def slopes(self) -> Floats:
        """Those of ``cost`` by the logarithms of the variances."""
        model = self.model
        inverse = dpotri(self.root, lower=1)[0]
        inverse = np.tril(inverse) + np.tril(inverse, -1).T
        trace = np.trace(inverse) + (model.rows - len(inverse)) / self.noise
        trace -= np.vdot(self.inverse, model.beyond[0] / self.noise**2 + self.across.T @ self.across)
        inverse -= self.across @ self.inverse @ self.across.T + np.outer(self.pulled, self.pulled)
        kinds = self.sizes * (model.kernels.reshape(self.sizes.size, -1) @ inverse.ravel())
        noise = self.noise * (trace - self.pulled @ self.pulled) - self.outside / self.noise
        return 0.5 * np.r_[kinds, noise] + np.r_[np.zeros(kinds.size), self.louder / _ANY**2]

    @property
    def curvature(self) -> Floats:
        """The average information on the logarithms of the variances (Gilmour, Thompson and Cullis, Biometrics 51, 1440 (1995))."""
        model = self.model
        moved = np.vstack([self.sizes[:, None] * (model.kernels @ self.pulled), self.noise * self.pulled])
        halves = solve_triangular(self.root, moved.T, lower=True, check_finite=False)
        square, cross, _ = model.beyond
        across = moved @ self.across
        across[-1] += (cross - square @ self.step) / self.noise
        found = 0.5 * (halves.T @ halves - across @ self.inverse @ across.T)
        found[-1, -1] += 0.5 * self.outside / self.noise + 1 / _ANY**2
        return found

    def work(self) -> tuple[Floats, float]:
        """(root sum of squares by kind, of all together) of what the discrepancy does to the readings beyond what the fit imitates, rad."""
        each = self.sizes[:, None] * (self.model.kernels @ self.pulled)
        kinds = np.array([each[k :: len(KINDS)].sum(axis=0) for k in range(len(KINDS))])
        done = np.vstack([kinds, each.sum(axis=0)])
        beyond = np.sqrt(
            np.maximum(np.sum(done**2, axis=1) - np.sum((done @ self.model.basis) ** 2, axis=1), 0.0)
        )
        return beyond[:-1], float(beyond[-1])

    def linear(self, weights: Sequence[Floats]) -> tuple[float, float]:
        """(value, standard error) of what is linear in the units of each kind, with these weights."""
        of = zip(self.sizes, self.model.parts, weights, strict=True)
        along = np.sum([size * part @ weight for size, part, weight in of], axis=0)
        across = self.across.T @ along
        known = (
            along @ cho_solve((self.root, True), along, check_finite=False) - across @ self.inverse @ across
        )
        free = sum(size * weight @ weight for size, weight in zip(self.sizes, weights, strict=True))
        return float(along @ self.pulled), float(np.sqrt(max(free - known, 0.0)))

    @property
    def left(self) -> float:
        """The sum of squares beyond fit and discrepancy."""
        return float(self.noise**2 * self.pulled @ self.pulled + self.outside)


def _minimal(model: _Likelihood) -> "_At":
    """Where the cost is least; each kind begins with all that is left."""
    count = len(model.kernels)
    low, high = np.transpose([*[_SIZES] * count, _NOISES])
    x = np.r_[np.full(count, np.log(max(model.squares / (model.rows * model.variance), 1.0))), 0.0]
    at, damping = model.at(x), _LEAST
    for _ in range(_STEPS):
        slopes, curvature = at.slopes, at.curvature
        # to where a size is nothing the way is long: there the slope itself is the curvature
        steep = curvature + 0.5 * np.diag(np.abs(slopes))
        free = ~((x <= low) & (slopes > 0) | (x >= high) & (slopes < 0))
        within = np.ix_(free, free)
        while True:
            step = np.zeros(x.size)
            damped = steep[within] + damping * np.diag(np.diag(steep)[free] + _LEAST)
            step[free] = np.linalg.solve(damped, -slopes[free])
            step = np.clip(x + np.clip(step, -_FARTHEST, _FARTHEST), low, high) - x
            promised = -(slopes + 0.5 * curvature @ step) @ step
            if promised < _ENOUGH:
                return at
            there = model.at(x + step)
            if there.cost < at.cost:
                break
            damping *= 10
        gained, at, x = at.cost - there.cost, there, x + step
        damping = max(damping / 10, _LEAST) if gained > 0.5 * promised else damping
        if 0.3 * promised < gained < _ENOUGH:
            break
    return at


class _Means:
    """Means over bins of time, the first sample a bin of its own, since a motion begins there; and their ``news``.

    Of first-order autocorrelated noise the means over so many samples are about such noise as well.
    """

    def __init__(self, times: Floats, width: float, noise: Noise):
        label = np.r_[-1, np.floor((times[1:] - times[0]) / width)].astype(int)
        bins, self.label, self.count = np.unique(label, return_inverse=True, return_counts=True)
        self.times = self(times)
        self.weight = np.sqrt(self.count)
        rho, size = noise.correlation, float(np.median(self.count))
        forgotten = 1 - rho**size
        own = (
            1 - rho**2
        ) * size - 2 * rho * forgotten  # of a mean's variance, of the noise's over (1 - rho)^2 size^2
        self._memory = rho * forgotten**2 / own
        # what is slow is as large beside noise without memory as it was
        self._alone = np.sqrt((1 - rho**2) * size / own)
        self._next = self._alone / np.sqrt(1 - self._memory**2)
        self._first = np.sqrt(noise.inflation)
        # the first mean is of one sample; where bins are missing nothing is remembered
        self._goes_on = np.flatnonzero(np.diff(bins) == 1)[1:]

    def __call__(self, series: Floats) -> Floats:
        flat = series.reshape(series.shape[0], -1)
        sums = np.stack([np.bincount(self.label, one) for one in flat.T], axis=1) / self.count[:, None]
        return sums.reshape(-1, *series.shape[1:])

    @property
    def volume(self) -> float:
        """The logarithm of the determinant of the ``news`` by the means."""
        goes_on, alone = self._goes_on.size, self.count.size - 1 - self._goes_on.size
        return float(np.log(self._first) + goes_on * np.log(self._next) + alone * np.log(self._alone))

    def news(self, means: Floats) -> Floats:
        """Means (bin, any), weighed by their samples, without what noise remembers of the bin before."""
        weighed = means * self.weight[:, None]
        found = weighed * self._alone
        found[0] = weighed[0] * self._first
        found[self._goes_on + 1] = self._next * (
            weighed[self._goes_on + 1] - self._memory * weighed[self._goes_on]
        )
        return found


def _columns(motions: list[Motion], means: Sequence[_Means]) -> tuple[Floats, NDArray[np.intp]]:
    """The work of each unit of discrepancy on the news of the readings (bin, unit), and the kind of each unit, first of the first smoothness."""
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
    news = [mean.news(np.hstack(found)) for mean, found in zip(means, blocks, strict=True)]
    return np.concatenate(news), kinds


def _shapes(one: Motion, largest: float, fastest: float) -> tuple[list[Floats], list[Floats]]:
    """Torques on the grid of times (restoring, dissipative, in time for each smoothness, and a fine one over the angle of either) and errors of the reading at its samples."""
    angles, speeds, since = np.linspace(-1, 1, _ANGLES), np.linspace(0, 1, _SPEEDS), np.linspace(0, 1, _TIMES)
    at = hats(one.angle / largest, angles)
    side = (one.speed >= 0)[:, None]
    both = over_both(one.angle / largest, one.speed / fastest, angles, speeds)
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


def _rubs(parts: Sequence[Floats]) -> list[Floats]:
    """The weights of the units of each kind in the torque against the motion at the middle, as the speed goes to nothing.

    At the middle, since at an edge a loss in bent material is a torque at rest as well.
    """
    weights: list[Floats] = [np.zeros(part.shape[1]) for part in parts]
    slow = np.zeros((_ANGLES, 2, _SPEEDS))
    slow[_ANGLES // 2, :, 0] = -0.5, 0.5  # of those of either direction (``over_both``)
    for k, smooth in enumerate(_SMOOTH):
        weights[len(KINDS) * k + 1] = _root_of_both(smooth).T @ slow.ravel()
    middle = _root(_FINE[0], 2.0, _FINE[1])[_FINE[0] // 2]
    weights[-1] = np.concatenate([-0.5 * middle, 0.5 * middle])
    return weights


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
