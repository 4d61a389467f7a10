"""What no law of damping tells: free courses of frequency and loss over the amplitude, marginalised beside a fit.

Beside the fitted law the frequency may be off by a share f, and the loss by a share g. Both are smooth functions of the logarithm of the
amplitude: Gaussian processes of mean 0 (Rasmussen and Williams 2006, chapter 2), which stand for what the law lacks (Kennedy and O'Hagan,
J. R. Stat. Soc. B 63, 425 (2001)). They move phase and amplitude of the fitted swing slowly, so all is linear in them beside the fit's own
slopes, and what is beyond first order is taken off. The two sizes are those of the largest marginal likelihood. Each costs AIC's price of a
value: a course that does not earn it counts little, and its size is then small.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.ndimage import uniform_filter1d

from ..arrays import Floats

TOLD = ("natural_frequency", "period", "quality", "decay_time")
_SCALE = 0.5  # of the logarithm of the amplitude, over which the courses change
_KNOTS = 0.8  # scales between two knots
_DEEPEST = 5.0  # e-folds of the amplitude below the largest one
_FREQUENCIES = np.r_[0.0, np.geomspace(1e-5, 3e-2, 8)]  # sizes of f that are tried
_ROUNDS = 5  # of what is beyond first order ...
_BELOW = 0.1  # ... until its sum of squares is below this share of the noise's variance
_LOSSES = np.r_[0.0, np.geomspace(1e-3, 1.0, 7)]  # of g
_SIZES = np.array([(f, g) for f in _FREQUENCIES for g in _LOSSES])


class Pieces(NamedTuple):
    """One swing by pieces of equal length: where its free values sit, the means of their slopes (free, pieces), the sums of its residuals, the
    ``counts`` of its samples; and the fitted reading in the middle of each, the ``interval`` (s), and how many rad of amplitude the reading has
    of its unit (0 where the frequency does not depend on the amplitude)."""

    where: np.ndarray
    slopes: Floats
    residual: Floats
    counts: np.ndarray
    reading: Floats
    interval: float
    radians: float


class Courses(NamedTuple):
    """What the free courses do to a fit's values, and to the shares of ``TOLD`` beside these.

    ``gain`` is the logarithm of the evidence above that of the law alone, prices paid. ``shift`` (free + told) is the mean, ``covariance`` the
    covariance (of ``Free.courses`` what is added to that of the law alone). ``residual`` is by swing what the courses take of the sums of
    residuals, ``left`` the share of the sum of squares that stands for this evidence, ``inflation`` that of what the courses leave.
    ``begins`` is by swing the logarithm of its first amplitude over that of the fit: ``TOLD`` are those of the swing as it begins.
    """

    gain: float
    shift: Floats
    covariance: Floats
    residual: list[Floats]
    begins: list[float]
    left: float = 1.0
    inflation: float = 1.0

    def over(self, free: Sequence[str], names: Sequence[str]) -> tuple[Floats, Floats]:
        """``shift`` and ``covariance`` over parameters (those that the fit has not: 0) and ``TOLD``."""
        size = len(names) + len(TOLD)
        shift, covariance = np.zeros(size), np.zeros((size, size))
        own = [k for k, name in enumerate(names) if name in free]
        to = np.r_[own, np.arange(len(names), size)].astype(int)
        at = np.r_[[free.index(names[k]) for k in own], np.arange(len(free), self.shift.size)].astype(int)
        shift[to], covariance[np.ix_(to, to)] = self.shift[at], self.covariance[np.ix_(at, at)]
        return shift, covariance


class _Swing(NamedTuple):
    """One swing, by pieces."""

    level: Floats  # logarithm of the amplitude
    pace: Floats  # at which it falls, 1/s
    amplitude: Floats  # d reading / d ln amplitude
    phase: Floats  # d reading / d phase
    bend: Floats  # d frequency / d ln amplitude, rad/s
    frequency: float  # rad/s


def _swing(piece: Pieces, floor: float) -> _Swing:
    """The fitted swing; nothing is told of amplitudes below the ``floor``. LinAlgError for a fit that does not move."""
    reading = piece.reading - np.mean(piece.reading)
    speed = np.gradient(reading, piece.interval)
    moved, turned = float(reading @ reading), float(speed @ speed)
    if not (0 < moved < np.inf and 0 < turned < np.inf):
        raise np.linalg.LinAlgError("no swing")
    frequency = float(np.sqrt(turned / moved))
    wide = np.log(np.maximum(np.hypot(reading, speed / frequency), floor))
    period = max(1, round(2 * np.pi / frequency / piece.interval))
    place = np.arange(wide.size)
    few = min(period, wide.size)
    first, last = wide[:few].mean(), wide[-few:].mean()
    trend = first + (last - first) * (place - (few - 1) / 2) / max(wide.size - few, 1)
    level = np.minimum.accumulate(trend + uniform_filter1d(wide - trend, few, mode="nearest"))
    pace = np.maximum(-np.gradient(level, piece.interval), 0.0)
    pace = np.maximum(pace, 1e-3 * pace.mean() + 1e-12)
    size = piece.radians * np.exp(level)
    return _Swing(level, pace, reading, speed / frequency, -frequency * size**2 / 8, frequency)


def _beyond(swing: _Swing, piece: Pieces, first: Floats, floor: float) -> tuple[Floats, Floats]:
    """The change of the logarithm of the amplitude of a change that is ``first`` (of the reading) to first order, and what is beyond that."""
    few = max(1, round(2 * np.pi / swing.frequency / piece.interval))

    def seen(shape: Floats) -> Floats:
        there = uniform_filter1d(shape**2, few, mode="nearest")
        share = uniform_filter1d(first * shape, few, mode="nearest") / np.maximum(there, floor**2)
        return np.clip(share, -1.0, 1.0)

    wider, turned = seen(swing.amplitude), seen(swing.phase)
    whole = np.exp(wider) * (swing.amplitude * np.cos(turned) + swing.phase * np.sin(turned))
    return wider, whole - swing.amplitude - wider * swing.amplitude - turned * swing.phase


def _sums(values: Floats, interval: float) -> Floats:
    """Integrals from the first piece's middle (function, piece)."""
    return (np.cumsum(values, axis=-1) - values / 2 - values[..., :1] / 2) * interval


class _Basis:
    """Smooth functions of the level: their size is 1 where all coefficients are normal numbers."""

    def __init__(self, top: float, low: float) -> None:
        self.knots = np.linspace(low, top, 2 + int((top - low) / (_KNOTS * _SCALE)))
        matrix = self._kernel(self.knots) + 1e-6 * np.eye(self.knots.size)
        self.root = np.linalg.inv(np.linalg.cholesky(matrix))

    def _kernel(self, level: Floats) -> Floats:
        return np.exp(-(((level[:, np.newaxis] - self.knots) / _SCALE) ** 2) / 2)

    def at(self, level: Floats) -> Floats:
        """Their values (function, level)."""
        return self.root @ self._kernel(level).T


def _columns(swing: _Swing, basis: _Basis, interval: float) -> Floats:
    """The slopes of the reading by the coefficients of f, then g (coefficient, piece)."""
    shares = basis.at(swing.level)
    turned = _sums(swing.frequency * shares, interval)
    wider = -swing.pace * _sums(shares, interval)
    later = _sums(swing.bend * wider, interval)
    return np.vstack([swing.phase * turned, swing.amplitude * wider + swing.phase * later])


def _asked(swing: _Swing, basis: _Basis, top: float) -> Floats:
    """What the coefficients do to the logarithms of ``TOLD`` (told, coefficient)."""
    size = basis.knots.size
    found = np.zeros((len(TOLD), 2 * size))
    cycle = np.pi / swing.frequency * swing.pace[0]
    here = basis.at(np.array([top - cycle]))[:, 0]
    levels = np.linspace(top - 1, top, 21)
    weight = 1 / np.interp(-levels, -swing.level, swing.pace)
    found[1, :size] = -here
    found[2, size:] = -here
    found[3, size:] = -basis.at(levels) @ weight / weight.sum()
    return found


class Free:
    """The free courses beside a fit, before their sizes are known."""

    def __init__(self, pieces: Sequence[Pieces], precision: Floats, kept: Floats, rss: float) -> None:
        self.pieces, self.kept, self.precision, self.rss = pieces, kept, precision, rss
        self.floor = float(np.sqrt(rss / sum(int(one.counts.sum()) for one in pieces)))
        self.swings = [_swing(one, self.floor) for one in pieces]
        self.first = int(np.argmax([one.level[0] for one in self.swings]))
        self.leading = self.swings[self.first]
        self.top = float(self.leading.level[0])
        low = max(min(float(one.level[-1]) for one in self.swings), self.top - _DEEPEST)
        self.basis = _Basis(self.top, min(low, self.top - 1))
        self.count, self.own = self.basis.knots.size, int(kept.sum())
        self._about([one.level for one in self.swings], [np.zeros(one.counts.size) for one in pieces])
        self.start = self.law @ self.pull[: self.own]  # 0 but for what the pieces are too coarse for

    def _about(self, levels: Sequence[Floats], bent: list[Floats]) -> None:
        """The normal equations where swings have these levels, without what is ``bent`` (of the reading)."""
        self.bent = bent
        self.swings = [swing._replace(level=level) for swing, level in zip(self.swings, levels, strict=True)]
        self.columns = [
            _columns(swing, self.basis, one.interval)
            for swing, one in zip(self.swings, self.pieces, strict=True)
        ]
        size = self.kept.size
        whole = size + 2 * self.count
        gram, pull = np.zeros((whole, whole)), np.zeros(whole)
        gram[:size, :size] = self.precision
        for one, more, off in zip(self.pieces, self.columns, bent, strict=True):
            place = np.append(one.where, np.arange(size, whole))
            slopes = np.vstack([one.slopes, more])
            gram[np.ix_(place, place)] += one.counts * slopes @ slopes.T
            pull[place] += slopes @ (one.residual - one.counts * off)
        used = np.append(self.kept, np.ones(2 * self.count, bool))
        self.gram, self.pull = gram[np.ix_(used, used)], pull[used]
        self.scale = np.sqrt(np.diag(self.gram)[: self.own])
        inner = self.gram[: self.own, : self.own] / np.outer(self.scale, self.scale)
        cross = self.gram[: self.own, self.own :] / self.scale[:, np.newaxis]
        solved = np.linalg.solve(inner, np.c_[cross, self.pull[: self.own] / self.scale])
        self.left = self.gram[self.own :, self.own :] - cross.T @ solved[:, :-1]
        self.drawn = self.pull[self.own :] - cross.T @ solved[:, -1]
        self.law = np.linalg.inv(inner) / np.outer(self.scale, self.scale)

    def sizes(self, frequency: float, loss: float) -> Floats:
        """The size of each coefficient."""
        return np.repeat([frequency, loss], self.count)

    def posterior(self, frequency: float, loss: float, variance: float) -> tuple[Floats, Floats]:
        """Mean and covariance of the values and the coefficients (in their sizes), for noise of this variance."""
        size = np.append(1 / self.scale, self.sizes(frequency, loss))
        matrix = self.gram * np.outer(size, size)
        matrix[self.own :, self.own :] += variance * np.eye(2 * self.count)
        inverse = np.linalg.inv(matrix) * np.outer(size, size)
        return inverse @ self.pull, variance * inverse

    def taken(self, mean: Floats) -> list[Floats]:
        """By swing what this mean of values and coefficients takes of the sums of residuals."""
        values = np.zeros(self.kept.size)
        values[self.kept] = mean[: self.own]
        return [
            one.counts * (values[one.where] @ one.slopes + mean[self.own :] @ more + off)
            for one, more, off in zip(self.pieces, self.columns, self.bent, strict=True)
        ]

    def most(self, variance: float) -> tuple[list[Floats], bool]:
        """What the courses take where their sizes are the largest, and whether that is more than they take of noise.

        All that follows is about the swing that they lead to, repeated until what is beyond first order is below the noise.
        """
        laws = [one.level for one in self.swings]
        for _ in range(_ROUNDS):
            taken = self.taken(self.posterior(_FREQUENCIES[-1], _LOSSES[-1], variance)[0])
            first = [
                off / np.maximum(one.counts, 1) - bent
                for off, one, bent in zip(taken, self.pieces, self.bent, strict=True)
            ]
            seen = [
                _beyond(swing, one, off, self.floor)
                for swing, one, off in zip(self.swings, self.pieces, first, strict=True)
            ]
            bent = [off for _, off in seen]
            changed = sum(
                float(one.counts @ (off - before) ** 2)
                for one, off, before in zip(self.pieces, bent, self.bent, strict=True)
            )
            if not self._takes_more_than_noise(taken):
                return taken, False
            self._about([law + wider for law, (wider, _) in zip(laws, seen, strict=True)], bent)
            if changed < _BELOW * variance:
                break
        return taken, True

    def _takes_more_than_noise(self, taken: Sequence[Floats]) -> bool:
        """Whether the sum of squares falls by more than twice what so many coefficients take of noise."""
        size, more = sum(int(one.counts.sum()) for one in self.pieces), 0.0
        for one, off in zip(self.pieces, taken, strict=True):
            more += float((2 * one.residual - off) @ (off / np.maximum(one.counts, 1)))
        return more > 4 * self.count * max(self.rss - more, 0.0) / size

    def _bending(self) -> float:
        """By how much the sum of squares of a law with its values fitted again falls with what is beyond first order."""
        taken = sum(
            float((2 * one.residual - one.counts * off) @ off)
            for one, off in zip(self.pieces, self.bent, strict=True)
        )
        return taken + float(self.pull[: self.own] @ self.law @ self.pull[: self.own])

    def gains(self, variance: float) -> Floats:
        """Logarithms of the evidence above that of the law alone (frequency, loss), for noise of this variance."""
        sizes = np.repeat(_SIZES, self.count, axis=1)
        matrix = np.eye(2 * self.count) + sizes[:, :, None] * self.left / variance * sizes[:, None, :]
        drawn = sizes * self.drawn / variance
        lower = np.linalg.cholesky(matrix)
        halves = np.linalg.solve(lower, drawn[..., None])[..., 0]
        found = 0.5 * np.sum(halves**2, axis=1) - np.sum(np.log(np.diagonal(lower, axis1=1, axis2=2)), axis=1)
        found[1:] += self._bending() / (2 * variance)
        return found.reshape(_FREQUENCIES.size, _LOSSES.size)

    def courses(self, variance: float) -> Courses:
        """The ``Courses`` over the sizes, for noise of this variance."""
        chosen = _chosen(self.gains(variance))
        logs = np.array([gain for _, _, gain in chosen])
        weight = np.exp(logs - logs.max())
        gain, weight = float(logs.max() + np.log(weight.sum())), weight / weight.sum()
        each = [self.posterior(_FREQUENCIES[f], _LOSSES[g], variance) for f, g, _ in chosen]
        for mean, _ in each:
            mean[: self.own] -= self.start
        taken = self.taken(sum(share * mean for share, (mean, _) in zip(weight, each, strict=True)))
        begins = self.begins(taken)
        own, size = self.kept.size, self.kept.size + len(TOLD)
        onto = np.zeros((size, self.own + 2 * self.count))
        onto[np.flatnonzero(self.kept), np.arange(self.own)] = 1.0
        onto[own:, self.own :] = _asked(self.leading, self.basis, self.top + begins[self.first])
        shift, second = np.zeros(size), np.zeros((size, size))
        for share, (mean, covariance), (f, _, _) in zip(weight, each, chosen, strict=True):
            told, spread = onto @ mean, onto @ covariance @ onto.T
            spread[own, own] += _FREQUENCIES[f] ** 2  # small swings are beyond the record
            shift += share * told
            second += share * (spread + np.outer(told, told))
        covariance = second - np.outer(shift, shift)
        covariance -= variance * onto[:, : self.own] @ self.law @ onto[:, : self.own].T
        return Courses(gain, shift, covariance, taken, begins)

    def begins(self, taken: Sequence[Floats]) -> list[float]:
        """By swing the logarithm of its first amplitude over that of the law, where the courses take this of the sums of residuals."""
        found = []
        for swing, one, off, bent in zip(self.swings, self.pieces, taken, self.bent, strict=True):
            first = off / np.maximum(one.counts, 1) - bent
            found.append(float(_beyond(swing, one, first, self.floor)[0][0]))
        return found


def _chosen(gains: Floats) -> list[tuple[int, int, float]]:
    """No course, one of frequency, one of loss, and both, each with the places of its best sizes and its gain, prices paid."""
    found = [(0, 0, float(gains[0, 0]))]
    none, some = slice(1), slice(1, None)
    for rows, columns, price in ((some, none, 1), (none, some, 1), (some, some, 2)):
        part = gains[rows, columns]
        f, g = np.unravel_index(int(np.argmax(part)), part.shape)
        found.append((int(f) + (rows.start or 0), int(g) + (columns.start or 0), float(part[f, g]) - price))
    return found
