"""The discrepancy: whatever a model lacks, as Gaussian processes beside the noise, and the evidence of a fit that has it.

    reading = model + G c + noise,   c ~ N(0, s^2) for each kind of discrepancy

The columns of G are what unnamed torques over angle, over angle, speed and side, and over time, and an error of the sensor over its
reading do to the reading, to first order. What the fit's own values can imitate is projected out. The sizes s are those of the
largest marginal likelihood (Kennedy and O'Hagan, J. R. Stat. Soc. B 63, 425 (2001)).
"""

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...arrays import Bools, Floats
from ...fitting.result import Fit
from ..data.campaign import Swing
from ..data.noise import Noise
from .green import motion, reach
from .kinds import KINDS, SMOOTH, rubs, units
from .linear import Frame
from .restricted import At, Likelihood, least

_BINS = 24  # a period: as finely as a pendulum's response to a smooth torque is seen
_SEEN = 1e-8  # of the largest power of a direction in the readings: of less nothing is seen
# Standard deviation of the logarithm of the noise's variance at the harmonics, beside what it is known to above them, where it is measured.
_NOISE_KNOWN = 0.2


class Means:
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
        # of a mean's variance, in units of the noise's over (1 - rho)^2 size^2
        own = (1 - rho**2) * size - 2 * rho * forgotten
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


@dataclass(frozen=True)
class Discrepancy:
    """What a fit lacks: ``log_evidence`` with a discrepancy, and ``log_plain`` without one (natural logarithms, of one common
    constant for all fits of the same swings); ``size`` (rad), the RMS of its work on the readings beyond what the fit imitates, with what
    is as quick as noise and not the noise; ``sizes`` the same by kind; ``rest``, the RMS beyond fit and discrepancy in units of the
    noise; ``widened``, by how much the standard error of each value that all swings share is larger where the discrepancy may do some
    of its work; ``friction`` and ``friction_error`` (rad/s^2), the unnamed torque against the motion that is left at the middle as the
    speed goes to nothing."""

    log_evidence: float
    log_plain: float
    size: float
    sizes: dict[str, float]
    rest: float
    widened: dict[str, float]
    friction: float = 0.0
    friction_error: float = 0.0


class Unnamed:
    """What may be missing of a pendulum, by what it would do to swings near those of one ``fit``: the same for all fits of these swings, so
    that they can be compared.

    ``period`` (s), the pendulum's, about, sets the bins of time in which residuals are looked at; those of a ``noise`` with memory by what
    they do not have from the bin before. Of recordings between which something was changed it is what all of them lack ``alike``.
    """

    def __init__(self, fit: Fit, swings: Sequence[Swing], period: float, noise: Noise, alike: bool = False):
        self._swings, self._width, self._alike = swings, period / _BINS, alike
        # rad over which a torque hangs together
        self._smooth = SMOOTH[0] * max(float(np.ptp(one.angle)) for one in swings) / 2
        motions = []
        for swing, mean, one in zip(swings, self._binned_under(noise), fit.swings, strict=True):
            coarse = Swing(swing.name, mean.times, mean(swing.angle), swing.drive)
            motions.append(motion(one.model, coarse, one.release_angle, one.release_velocity))
        self._worked, self._kinds = units(motions, alike)
        self.reach, self.recordings = reach(motions), 1 if alike else len(motions)
        self._rubs = rubs(self.recordings)
        self._set(noise)

    def under(self, noise: Noise) -> "Unnamed":
        """The same torques on readings with another noise."""
        found = copy(self)
        found._set(noise)
        return found

    def _binned_under(self, noise: Noise) -> list[Means]:
        return [Means(swing.times, self._width, noise) for swing in self._swings]

    def _set(self, noise: Noise) -> None:
        self._noise, self._means = noise, self._binned_under(noise)
        news = [mean.news(worked) for mean, worked in zip(self._means, self._worked, strict=True)]
        self._directions, along = _reduced(np.concatenate(news), self._kinds)
        self._parts = [along[:, self._kinds == kind] for kind in range(self._kinds[-1] + 1)]
        self._kernels = np.stack([part @ part.T for part in self._parts])
        self._most = self._first_order() if self._alike else np.inf

    def beside(self, frame: Frame) -> Discrepancy:
        """The ``Discrepancy`` of a fit seen in a ``Frame``."""
        noise, at, triangle, kept = self._noise, *self._likeliest(frame)
        model, free = at.model, at.model.rows - len(triangle)
        scale = 1 / np.sqrt(frame.samples)
        sizes, whole = at.work()
        quick = max(at.noise - noise.slow_variance, 0.0) * free
        alone, beside = (
            _inverse(one) for one in (triangle.T @ triangle, triangle.T @ at.seen @ triangle * at.noise)
        )
        ratio = np.sqrt(np.maximum(np.diag(beside) / np.maximum(np.diag(alone), 1e-300), 1.0))
        named = [(name, of) for name, of, there in zip(frame.names, frame.of, kept, strict=True) if there]
        shared = [k for k, (_, of) in enumerate(named) if of < 0]
        friction, error, _ = at.linear([one[None] for one in self._rubs])
        return Discrepancy(
            -float(at.cost),
            -model.plain(float(np.hypot(_NOISE_KNOWN, noise.known))),
            float(np.hypot(whole, np.sqrt(quick)) * scale),
            dict(zip(KINDS, (sizes * scale).tolist(), strict=True)),
            float(np.sqrt(at.left / free / noise.slow_variance)),
            {named[k][0]: float(ratio[k]) for k in shared},
            float(friction[0]),
            float(error[0]),
        )

    def most_likely(self, frame: Frame) -> At:
        """The most likely discrepancy of a fit seen in a ``Frame``: ``At.linear`` of ``kinds.weights`` is the torque (rad/s^2) that it lacks."""
        return self._likeliest(frame)[0]

    def _likeliest(self, frame: Frame) -> tuple[At, Floats, Bools]:
        """The likelihood of a fit's residual where it is largest; what the fit's values do, as a triangle, and which do anything."""
        size = np.linalg.norm(frame.slopes, axis=0)
        kept = size > 0
        basis, triangle = np.linalg.qr(self._binned(frame, frame.slopes[:, kept] / size[kept]))
        residual = self._binned(frame, frame.residual[:, None])[:, 0]
        left = residual - basis @ (basis.T @ residual)
        within = slice(None, len(self._directions))
        inside = self._directions.T @ np.column_stack([left[within], basis[within]])
        model = Likelihood(
            self._parts,
            self._kernels,
            inside[:, 0],
            inside[:, 1:],
            float(left @ left),
            left.size,
            self._noise.slow_variance,
        )
        return least(model, self._most, self._beyond_first_order(frame)), triangle, kept

    def level(self, frame: Frame) -> float:
        """What the logarithms of evidences lack of those of the readings themselves, in rad: the same for all fits under this noise."""
        rows = sum(mean.count.size for mean in self._means)
        free = rows - np.count_nonzero(np.linalg.norm(frame.slopes, axis=0))
        return sum(mean.volume for mean in self._means) - 0.5 * free * float(
            np.log(self._noise.slow_variance)
        )

    def _beyond_first_order(self, frame: Frame) -> float:
        """The variance that first order is wrong by, of the noise's: a torque of smoothness l that moves a swing by d is another one there, by about
        d / l of it."""
        squared = float(np.mean(frame.residual**4)) / self._smooth**2  # (d^2 / l)^2
        of_a_bin = frame.samples / sum(mean.count.size for mean in self._means)
        return squared * of_a_bin / self._noise.slow_variance

    def _first_order(self) -> float:
        """How much a discrepancy may do, of what the noise does (variance), for first order to be right to the noise: d^2 / l is less than the noise."""
        samples = sum(one.times.size for one in self._swings)
        squared = self._smooth * self._noise.deviation  # d^2
        return float(squared * samples / self._directions.shape[1] / self._noise.slow_variance)

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
    scaled = columns / size[kinds]
    power, along = np.linalg.eigh(scaled.T @ scaled)
    kept = power > _SEEN * power[-1]
    strength, along = np.sqrt(power[kept]), along[:, kept]
    return scaled @ along / strength, (along * strength).T * size[kinds]
