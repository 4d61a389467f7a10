"""The restricted likelihood of a fit's residual beside a discrepancy, and where it is largest."""

from collections.abc import Sequence

import numpy as np
from scipy.linalg import cho_solve, cholesky, solve_triangular
from scipy.linalg.lapack import dpotri
from scipy.optimize import brentq

from ...arrays import Floats
from .kinds import KINDS

_ANY = 3.0  # standard deviation of the logarithm of the noise's variance where something unnamed may be as quick as noise is
# bounds of these logarithms, and of the noise's over what it is known to be
_SIZES, _NOISES = (-12.0, 25.0), (-1.0, 12.0)
_ENOUGH = 0.01  # of the log-likelihood: a step that promises less is the last
_FARTHEST, _STEPS = 3.0, 60  # of these logarithms in one step; steps
_LEAST = 1e-6  # damping of a step, of the curvature


class Likelihood:
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

    def at(self, x: Floats) -> "At":
        """The likelihood at these logarithms."""
        return At(self, np.exp(x[:-1]) * self.scale, self.variance * np.exp(x[-1]))

    def plain(self, known: float) -> float:
        """The least negative log-likelihood without a discrepancy, the logarithm of the noise's variance being known to so much."""
        free, power = self.rows - self.basis.shape[1], self.squares / self.variance
        low, high = _NOISES

        def slope(x: float) -> float:
            return 0.5 * (free - power * np.exp(-x)) + x / known**2

        x = low if slope(low) > 0 else high if slope(high) < 0 else brentq(slope, low, high)
        return float(0.5 * (free * x + power * np.exp(-x)) + 0.5 * (x / known) ** 2 + np.log(known))


class At:
    """A likelihood at variances of each kind and of the noise: its negative logarithm ``value``, the same (``cost``) of a noise that may be any,
    the information ``seen`` on what the fit's basis spans, and ``pulled``, the residual in units of its variance along the directions of the discrepancy."""

    def __init__(self, model: Likelihood, sizes: Floats, noise: float):
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

    def linear(self, weights: Sequence[Floats]) -> tuple[Floats, Floats, Floats]:
        """(value, standard error, that before the data) of what is linear in the units of each kind, with these weights (any, unit)."""
        of = list(zip(self.sizes, self.model.parts, weights, strict=True))
        along = np.sum([size * part @ weight.T for size, part, weight in of], axis=0)
        within, across = cho_solve((self.root, True), along, check_finite=False), self.across.T @ along
        before = np.sum([size * np.sum(weight**2, axis=1) for size, _, weight in of], axis=0)
        known = np.einsum("ij,ij->j", along, within) - np.einsum("ij,ij->j", across, self.inverse @ across)
        return self.pulled @ along, np.sqrt(np.maximum(before - known, 0.0)), np.sqrt(before)

    @property
    def left(self) -> float:
        """The sum of squares beyond fit and discrepancy."""
        return float(self.noise**2 * self.pulled @ self.pulled + self.outside)


def least(model: Likelihood, most: float = np.inf, wrong: float = 0.0) -> "At":
    """Where the cost is least; each kind begins with all that is left, and does at ``most`` so many times what the noise does (variance). The noise
    is no less than what first order is ``wrong`` by, in units of its variance."""
    count = len(model.kernels)
    quietest = np.log(np.clip(wrong, *np.exp(_NOISES)))
    low, high = np.transpose([*[(_SIZES[0], min(_SIZES[1], np.log(most)))] * count, (quietest, _NOISES[1])])
    left = np.log(max(model.squares / (model.rows * model.variance), 1.0))
    x = np.r_[np.full(count, min(left, high[0])), max(quietest, 0.0)]
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
