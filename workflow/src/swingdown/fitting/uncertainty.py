"""The uncertainty of a fit's values: what the colour of its residuals does to it, and what the measurement leaves open.

Residuals are rarely independent: noise has a spectrum, and an incomplete model leaves swings of its own. What counts is
their spectrum where the fitted values act, at the pendulum's frequency and its first harmonics. There it is taken from an
autoregressive model of the residuals (``colour``), averaged to so many a period. The means lie at their times: where samples are missing a
mean has fewer or none, and what lies on either side is as far apart as it was. A line beyond what the means hold, as of the mains, would be
folded to among the pendulum's harmonics: it is taken off before, and what a wave of its size and of any phase does to the values is
added. Least squares keep their optimum: where the noise's spectrum is smooth about one frequency, weights by it would gain next to
nothing (Grenander, Ann. Math. Stat. 25, 252 (1954)).
"""

import warnings
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr, stdtrit

from ..arrays import Floats
from ..engine.trajectory import TrajectoryWarning, sensitivities, simulate
from ..pendulum.catalogue import ANGLE
from ..pendulum.effect import NATURAL_FREQUENCY
from ..quantisation import quantisation_step, rounding
from .coloured_noise import Colour, autoregression, lines_of, weighted
from .course import Courses, Free, Pieces
from .problem import RELEASE, Swings
from .result import Fit

_A_PERIOD = 24  # means of residuals, a period: the pendulum's third harmonic is still there
_LONGER = 3  # times as long pieces, eight a period, where samples are missing
_EVEN = 1e-3  # of a step: times that are off by less are even
_SEEN = 2.0  # standard errors
_LEAST_DOF = 3.0
_LEAST_LEFT = 1e-12  # of a sum of squares
_LEVEL, _NORMAL = 0.95, 1.959963984540054  # standard deviations to either side that hold it of normal errors
_LEAST_LIMIT = 1e-3  # standard deviations: of two errors one as small counts for nothing
_NEWTON = 5  # steps, to 1e-11


@dataclass(frozen=True)
class Uncertainty:
    """The uncertainty of a fit's values that holds the colour of its residuals, in the order of ``fit.free``.

    It is NaN for values that a bound holds, or that the swings leave open.

    Attributes
    ----------
    random
        Covariance by noise and by what the model misses.
    systematic
        The effect of the fit's ``sources``, of shape (free, source). ``covariance`` is both together.
    inflation
        The random variance over that of independent residuals; n over this is the number of independent samples.
    noise
        Standard deviation (rad) of white noise with this spectrum at the pendulum's frequencies.
    dof
        Degrees of freedom of that size.
    limited
        The share of the clock's part of ``systematic`` that is of an error within limits.
    courses
        What free courses do beside the law, where they were asked for.
    """

    random: Floats
    systematic: Floats
    inflation: float
    noise: float
    dof: float
    limited: float = 1.0
    courses: Courses | None = None

    @property
    def factors(self) -> Floats:
        """By value the k of an interval value ± k standard errors that holds it with 95 %: of the sum of an error within the clock's
        limits, any as likely, and of normal ones (JCGM 101), widened as Student's of its degrees of freedom is (JCGM 100, annex G)."""
        systematic = np.sum(self.systematic**2, axis=1)
        with np.errstate(invalid="ignore", divide="ignore"):
            dof = self.dof * (1 + systematic / np.diag(self.random)) ** 2
        known = np.isfinite(dof)
        student = stdtrit(np.where(known, dof, 1e9), 0.975) / _NORMAL
        clock = self.limited * np.sqrt(
            self.systematic[:, -1] ** 2 / np.where(known, np.diag(self.covariance), 1.0)
        )
        return np.where(known, student * half_widths(clock), np.nan)

    @property
    def covariance(self) -> Floats:
        """Random and systematic covariance together."""
        return self.random + self.systematic @ self.systematic.T


def half_widths(limited: Floats) -> Floats:
    """The k of an interval of 95 % for the sum of a normal error and one within limits, which has this share of the standard deviation."""
    share = np.minimum(limited, 1.0)
    limit, normal = np.sqrt(3) * share, np.sqrt(1 - share**2)
    found = np.where(limit < _LEAST_LIMIT, _NORMAL, _LEVEL * limit)
    both = (limit >= _LEAST_LIMIT) & (normal >= _LEAST_LIMIT)
    limit, normal = limit[both], normal[both]
    k = np.full(limit.size, _LEVEL * np.sqrt(3))  # below it: on a curve that bends down no step leads beyond
    for _ in range(_NEWTON):
        low, high = (k - limit) / normal, (k + limit) / normal
        # the mean of a normal error's probability between the two limits, and its slope
        area = high * ndtr(high) - low * ndtr(low) + (np.exp(-(high**2) / 2) - np.exp(-(low**2) / 2)) / np.sqrt(2 * np.pi)  # fmt: skip
        below, slope = normal * area / (2 * limit), (ndtr(high) - ndtr(low)) / (2 * limit)
        k = k - (below - (1 + _LEVEL) / 2) / slope
    found[both] = k
    return found


@np.errstate(over="ignore", invalid="ignore")  # what runs off has no standard errors: NaN
def uncertainty(fit: Fit, swings: Swings, free: bool = False) -> Uncertainty:
    """The ``Uncertainty`` of a fit's values.

    The sandwich A S A: A is the inverse of J'J with what is known beforehand, S = J' R J with the autocovariance R of the
    residuals' autoregressive model (White, Econometrica 48, 817 (1980)). Where readings come in steps, S has what rounding adds.

    Parameters
    ----------
    fit
        The fit.
    swings
        The (times in s, angles in rad) that were fitted; they count as independent.
    free
        Whether ``courses`` of the result says what free courses of frequency and loss do beside the law (``fitting.course``).
    """
    parts = list(_means(fit, swings))
    plain = _of_parts(fit, parts, fit.rss)
    if not free or fit.model.takes_input or not np.isfinite(plain.noise) or not fit.rss > 0:
        return plain
    kept = np.isfinite(np.diag(plain.random))
    pieces = [
        _piece(fit, k, times, part) for k, ((times, _), part) in enumerate(zip(swings, parts, strict=True))
    ]
    try:
        courses = Free(pieces, fit.model.slack.precision_among(fit.free), kept, fit.rss)
        most, seen = courses.most(plain.noise**2)
        noise = _of_parts(fit, *_less(fit, parts, most)).noise if seen else plain.noise
        found = courses.courses(noise**2)
    except np.linalg.LinAlgError:
        return plain
    if not np.isfinite(found.covariance).all():
        return plain
    beside = _of_parts(fit, *_less(fit, parts, found.residual)) if seen else plain
    left = max(1 - 2 * noise**2 * found.gain / fit.rss, _LEAST_LEFT)
    whole = found.covariance.copy()
    whole[: len(fit.free), : len(fit.free)] += np.nan_to_num(beside.covariance)
    return replace(plain, courses=found._replace(covariance=whole, left=left, inflation=beside.inflation))


def _less(fit: Fit, parts: Sequence["_Part"], taken: Sequence[Floats]) -> tuple[list["_Part"], float]:
    """The pieces without what is taken of their sums of residuals, and the sum of squares (rad^2) that is left."""
    found = []
    for part, off in zip(parts, taken, strict=True):
        means = off / np.maximum(part.counts, 1)
        squares = part.squares - 2 * float(means @ part.residual) + float(off @ means)
        found.append(part._replace(residual=part.residual - off, squares=squares))
    left, whole = (sum(part.squares for part in each) for each in (found, parts))
    return found, fit.rss * max(left / whole, 0.0)


def _piece(fit: Fit, k: int, times: Floats, part: "_Part") -> Pieces:
    """What free courses need of a swing's pieces."""
    one = fit.swings[k]
    middles = times[0] + part.first + part.interval * np.arange(part.counts.size)
    model = replace(one.model, record=one.model.record or float(times[-1] - times[0]))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", TrajectoryWarning)  # of the fit they were told
        begun = np.append(times[0], middles[part.first <= 0 :])
        reading = simulate(model, begun, one.release_angle, one.release_velocity)[-middles.size :]
    radians = 0.0 if model.restoring == "linear" else 1.0
    if model.reading != ANGLE:
        radians /= model.values[NATURAL_FREQUENCY.name]
    return Pieces(part.where, part.slopes, part.residual, part.counts, reading, part.interval, radians)


def _of_parts(fit: Fit, parts: Sequence["_Part"], rss: float) -> Uncertainty:
    """The ``Uncertainty`` by the residuals of these pieces, whose sum of squares (rad^2) is ``rss``."""
    held = ~np.isfinite(np.diag(fit.covariance))
    scale = np.sqrt(np.where(held, 1.0, np.diag(fit.covariance)))
    size = len(fit.free)
    hessian, scores = np.zeros((2, size, size))
    for colour, members in _coloured(parts):
        for part, spread in members:
            place = np.ix_(part.where, part.where)
            slopes = part.slopes * scale[part.where, np.newaxis]
            hessian[place] += part.counts * slopes @ slopes.T
            scores[place] += weighted(spread * slopes, colour)
            scores[place] += part.besides * np.outer(scale[part.where], scale[part.where])
    kept = np.ix_(~held, ~held)
    precision = fit.model.slack.precision_among(fit.free) * np.outer(scale, scale)
    random = np.full((size, size), np.nan)
    try:
        inverse = np.linalg.inv((hessian + precision)[kept])
    except np.linalg.LinAlgError:  # of what the means do not tell nothing is known
        return Uncertainty(random, fit.systematic, np.nan, np.nan, np.nan)
    random[kept] = inverse @ scores[kept] @ inverse * np.outer(scale, scale)[kept]
    plain = rss / fit.n * np.diag(inverse @ hessian[kept] @ inverse) * scale[~held] ** 2
    ratio = np.diag(random)[~held] / plain
    ratio = ratio[np.isfinite(ratio) & (ratio > 0)]
    inflation = float(np.exp(np.mean(np.log(ratio)))) if ratio.size else np.nan
    # the fit took its values' share out of the residuals just where their spectrum is asked for
    dof = max(fit.n / max(1.0, inflation) - size, _LEAST_DOF) if ratio.size else np.nan
    random *= 1 + size / dof
    noise = float(np.sqrt(rss / fit.n * inflation * (1 + size / dof)))
    return Uncertainty(random, fit.systematic, inflation, noise, dof, fit.model.slack.limited)


class _Part(NamedTuple):
    """One swing by pieces of equal length in time: where its free values sit, the means of their slopes, the sum of its residuals, their
    ``counts``, the sum of their squares, the ``interval`` (s) and how long after the first sample the first piece's middle is (s); and what rounding and lines add to the covariance of slopes times
    residuals, of all samples. A piece without samples has zeros."""

    where: NDArray[np.integer]
    slopes: Floats
    residual: Floats
    counts: NDArray[np.integer]
    squares: float
    interval: float
    besides: Floats
    first: float


def _means(fit: Fit, swings: Swings) -> Iterator[_Part]:
    own = [*fit.swings[0].own, *(RELEASE if RELEASE[0] in fit.free else ())]
    shared = len(fit.free) - len(own) * len(swings)
    period = 2 * np.pi / fit.model.values[NATURAL_FREQUENCY.name]
    for k, ((times, angle), fitted) in enumerate(zip(swings, fit.swings, strict=True)):
        where = np.append(np.arange(shared), shared + k * len(own) + np.arange(len(own)))
        release = fitted.release_angle, fitted.release_velocity
        slopes = sensitivities(fitted.model, times, *release, free=[fit.free[i] for i in where])[1]
        interval, at = in_steps(times)
        slots = np.round(at).astype(np.int64)
        residual = angle - fitted.angle
        rounded = _rounding(slopes, angle, fitted.angle, float(np.var(residual)))
        if np.abs(at - slots).max() > _EVEN:
            rounded += _timing(slopes, times, fitted.angle, residual)
        lines = np.zeros_like(rounded)
        for line in lines_of(residual, 0.5 * _A_PERIOD * interval / period, at):
            waves = np.sum([np.outer(one, one) for one in (line.waves @ slopes.T)], axis=0)
            lines += 0.5 * line.amplitude**2 * waves
            residual = residual - line.fitted
        # of a swing that is shorter than its period (as a wrong model may say), the whole is a period
        length = int(slots[-1]) + 1
        each, counts = _pieces(slots, max(1, int(min(period / interval, length) / _A_PERIOD)))
        whole = slots < length // each * each  # what is left at the end goes
        pieces, size = slots[whole] // each, counts.size
        means = np.array([np.bincount(pieces, one, size) for one in slopes[:, whole]]) / np.maximum(counts, 1)
        kept = residual[whole]
        sums, first = np.bincount(pieces, kept, size).astype(float), (each - 1) / 2 * interval
        yield _Part(where, means, sums, counts, float(kept @ kept), each * interval, rounded + lines, first)


def _pieces(slots: NDArray[np.integer], each: int) -> tuple[int, NDArray[np.integer]]:
    """How many slots a piece has, and how many samples each whole piece has: ``each``, or where so many pieces are empty that most cannot
    be foretold from the two before, up to so many more that the pendulum's third harmonic is still there."""
    for longer in range(each, _LONGER * each + 1):
        size = (int(slots[-1]) + 1) // longer
        counts = np.bincount(slots[slots < size * longer] // longer, minlength=size)
        there = counts > 0
        if size < 3 or np.mean(there[2:] & there[1:-1] & there[:-2]) > 0.5:
            break
    return longer, counts


def in_steps(times: Floats) -> tuple[float, Floats]:
    """The usual interval (s) of a recorder that kept its rate, and how many of them each of its rising times (s) is after the first: whole
    numbers, those of missing samples left out."""
    steps = np.diff(times)
    # the lower quartile, as where every third sample is lost half of the steps are two intervals
    whole = np.maximum(1.0, np.round(steps / np.quantile(steps, 0.25)))
    interval = float((times[-1] - times[0]) / whole.sum())
    return interval, (times - times[0]) / interval


def _timing(slopes: Floats, times: Floats, fitted: Floats, residual: Floats) -> Floats:
    """What wrong stamps add to the covariance of slopes times residuals, above white noise as strong: they err by the speed, and the
    fastest samples say most of the frequency.

    The squared residuals tell by a line over the squared speed what is of the stamps (Breusch
    and Pagan, Econometrica 47, 1287 (1979)), where that is more than two standard errors.
    """
    fast = np.gradient(fitted, times) ** 2
    away, square = fast / np.mean(fast) - 1, residual**2
    (slope, rest), covariance = np.polyfit(away, square, 1, cov=True)
    if slope < _SEEN * np.sqrt(covariance[0, 0]):
        return np.zeros((len(slopes), len(slopes)))
    slope = min(slope, rest)  # at rest the variance is 0 and no less
    more, white = (slopes * (slope * away)) @ slopes.T, np.sqrt(np.sum(slopes**2, axis=1))
    size = np.where(white > 0, white, 1.0)
    # where it would be less than by white noise, the noise's colour may have taken that already
    share, axes = np.linalg.eigh(more / np.outer(size, size))
    return (axes * np.maximum(share, 0.0)) @ axes.T * np.outer(size, size)


def _rounding(slopes: Floats, angle: Floats, fitted: Floats, variance: float) -> Floats:
    """What the steps in which the angles (rad) of a swing come add to the covariance of slopes times residuals."""
    step = quantisation_step(angle)
    before = np.sqrt(max(0.0, variance - step**2 / 12))
    return rounding(slopes, fitted, step, before) if step else np.zeros((len(slopes), len(slopes)))


def _coloured(parts: Sequence[_Part]) -> Iterator[tuple[Colour, list[tuple[_Part, Floats]]]]:
    """The colour of all swings of about one sampling interval together, with these swings; beside each the standard deviation of the sum of
    residuals in each piece over that of the colour's series."""
    left = list(parts)
    while left:
        alike = [part for part in left if abs(part.interval / left[0].interval - 1) < 0.05]
        left = [part for part in left if not any(part is one for one in alike)]
        spreads = [np.sqrt(part.counts * (1 + (part.counts - 1) * _within(alike))) for part in alike]
        with np.errstate(invalid="ignore"):  # of a piece without samples nothing is known: 0/0
            series = [part.residual / spread for part, spread in zip(alike, spreads, strict=True)]
        yield autoregression(series), list(zip(alike, spreads, strict=True))


def _within(parts: Sequence[_Part]) -> float:
    """The correlation of two residuals in one piece, as all of them tell it; at least 0."""
    counts = np.concatenate([part.counts for part in parts])
    sums = np.concatenate([part.residual for part in parts])
    squares, pairs = sum(part.squares for part in parts), float(counts @ (counts - 1))
    # nothing where each piece has one sample: then there is no pair
    alone = pairs * squares / float(counts.sum())
    return float(np.clip((float(sums @ sums) - squares) / (alone or np.inf), 0.0, 1.0))
