"""Straight lines through points with errors in both coordinates, and what follows from a line with its covariance."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Floats, Numbers
from ..errors import InputError

FEWEST = 3  # points; two leave nothing to judge the line by
_ITERATIONS = 200


@dataclass(frozen=True)
class Line:
    """A line, y = intercept + slope x.

    Attributes
    ----------
    intercept, slope
        In the units of x and y.
    covariance
        Of (intercept, slope), of shape (2, 2), by York et al. (2004): at the adjusted points, not scaled by chi2 / dof.
    chi2, dof
        Of the fit.
    adjusted
        Abscissae of the adjusted points, of shape (point,).
    residuals
        y - line(x), of shape (point,).
    """

    intercept: float
    slope: float
    covariance: np.ndarray
    chi2: float
    dof: int
    adjusted: np.ndarray
    residuals: np.ndarray

    @property
    def uncertainties(self) -> Floats:
        """The standard uncertainties of intercept and slope."""
        return np.sqrt(np.diag(self.covariance))

    def predict(self, x: ArrayLike, u_x: ArrayLike = 0.0) -> tuple[Floats, Floats]:
        """y at ``x`` (scalar or array) and its standard uncertainty, ``u_x`` being independent of the line."""
        x = np.asarray(x, dtype=float)
        variance = self._variance(x) + (self.slope * np.asarray(u_x)) ** 2
        return self.intercept + self.slope * x, np.sqrt(variance)

    def inverse(self, y: ArrayLike, u_y: ArrayLike = 0.0) -> tuple[Floats, Floats]:
        """x where the line takes the value ``y``, and its standard uncertainty (ISO/TS 28037, inverse evaluation)."""
        x = (np.asarray(y, dtype=float) - self.intercept) / self.slope
        return x, np.sqrt(self._variance(x) + np.asarray(u_y) ** 2) / abs(self.slope)

    def _variance(self, x: Floats) -> Floats:
        """Of the line's y at x."""
        return self.covariance[0, 0] + 2 * x * self.covariance[0, 1] + x**2 * self.covariance[1, 1]


def fit_line(x: ArrayLike, y: ArrayLike, sd_x: ArrayLike, sd_y: ArrayLike) -> Line:
    """The ``Line`` through points whose errors are independent from point to point and in x and y.

    York, Evensen, López Martínez and De Basabe Delgado, Am. J. Phys. 72, 367 (2004), written with variances.

    Parameters
    ----------
    x, y
        The points, of shape (point,).
    sd_x, sd_y
        Standard deviations, scalars or one a point; 0 is allowed in one coordinate.

    Raises
    ------
    InputError
        For fewer than three points, points without any error, or points on a vertical.
    """
    x, y = _checked(x, y)
    sd_x, sd_y = (np.broadcast_to(np.asarray(v, dtype=float), x.shape) for v in (sd_x, sd_y))
    if np.any(sd_x < 0) or np.any(sd_y < 0) or np.any((sd_x == 0) & (sd_y == 0)):
        problem = "a point has no uncertainty, or a negative one"
        expected = "standard deviations above 0"
        raise InputError("line", problem, expected, "state the uncertainty of every point")
    vx, vy = sd_x**2, sd_y**2

    def step(slope: float) -> tuple[float, Floats, float, float, Floats]:
        weight = 1 / (vy + slope**2 * vx)
        mean_x, mean_y = np.average(x, weights=weight), np.average(y, weights=weight)
        u, v = x - mean_x, y - mean_y
        beta = weight * (u * vy + slope * v * vx)
        slope = float(np.sum(weight * beta * v) / np.sum(weight * beta * u))
        return slope, weight, float(mean_x), float(mean_y), beta

    slope = _settled(lambda b: step(b)[0], np.polyfit(x, y, 1)[0])
    _, weight, mean_x, mean_y, beta = step(slope)
    intercept = mean_y - slope * mean_x
    adjusted = mean_x + beta
    centre = np.average(adjusted, weights=weight)
    slope_variance = 1 / np.sum(weight * (adjusted - centre) ** 2)
    cross = -centre * slope_variance
    covariance = np.array([[1 / weight.sum() + centre**2 * slope_variance, cross], [cross, slope_variance]])
    residuals = y - intercept - slope * x
    chi2 = float(np.sum(weight * residuals**2))
    return Line(float(intercept), float(slope), covariance, chi2, len(x) - 2, adjusted, residuals)


def fit_line_correlated(x: ArrayLike, y: ArrayLike, covariance_x: ArrayLike, covariance_y: ArrayLike) -> Line:
    """The ``Line`` through points whose errors are correlated from point to point (ISO/TS 28037, clause 10).

    Errors of x and y are independent of each other. With diagonal covariances it is ``fit_line``.

    Parameters
    ----------
    x, y
        The points, of shape (n,).
    covariance_x, covariance_y
        Of shape (n, n); one of them may be zero.

    Raises
    ------
    InputError
        As in ``fit_line``, and for covariances that cannot be inverted.
    """
    x, y = _checked(x, y)
    covariance_x, covariance_y = np.asarray(covariance_x, dtype=float), np.asarray(covariance_y, dtype=float)

    def weights(slope: float) -> Floats:
        try:
            return np.linalg.inv(covariance_y + slope**2 * covariance_x)
        except np.linalg.LinAlgError as error:
            problem = "the covariance of the points cannot be inverted"
            expected = "an error of its own for every point"
            raise InputError("line", problem, expected, "state the uncertainty of every point") from error

    def solve(slope: float) -> tuple[Floats, Floats, Floats]:
        return solve_lines(x, y, covariance_x, weights(slope), slope)

    start = _settled(lambda b: float(solve(b)[1]), float(np.polyfit(x, y, 1)[0]))
    intercept, slope, adjusted = solve(start)
    weight = weights(float(slope))
    design = np.column_stack([np.ones_like(x), adjusted])
    covariance = np.linalg.inv(design.T @ weight @ design)
    residuals = y - intercept - slope * x
    chi2 = float(residuals @ weight @ residuals)
    return Line(float(intercept), float(slope), covariance, chi2, len(x) - 2, adjusted, residuals)


def solve_lines(
    x: Floats, y: Floats, covariance_x: Floats, weight: Floats, slope: Numbers, rounds: int = 1
) -> tuple[Floats, Floats, Floats]:
    """Intercepts, slopes and adjusted abscissae of lines through many draws of the same points.

    Parameters
    ----------
    x, y
        The draws, with the points along the last axis.
    covariance_x
        Of shape (n, n).
    weight
        Inverse of the combined covariance at the line's slope, of shape (n, n), the same for every draw.
    slope
        The slope to start from.
    rounds
        How often the points are adjusted to the line.
    """
    tilt = np.asarray(slope, dtype=float)[..., None]
    intercept = np.sum((y - tilt * x) @ weight, axis=-1, keepdims=True) / weight.sum()
    sums = weight.sum(axis=0)
    for _ in range(rounds):
        adjusted = x + tilt * ((y - intercept - tilt * x) @ (weight @ covariance_x))
        # Two normal equations: (1, adjusted) times weight times (y - intercept - tilt x) vanish.
        tilted = adjusted @ weight
        a, b, p = sums.sum(), np.sum(sums * x, -1, keepdims=True), np.sum(sums * y, -1, keepdims=True)
        c, d, q = (np.sum(t, -1, keepdims=True) for t in (tilted, tilted * x, tilted * y))
        determinant = a * d - b * c
        intercept, tilt = (p * d - b * q) / determinant, (a * q - c * p) / determinant
    return intercept[..., 0], tilt[..., 0], adjusted


def _checked(x: ArrayLike, y: ArrayLike) -> tuple[Floats, Floats]:
    x, y = np.asarray(x, dtype=float), np.asarray(y, dtype=float)
    if x.shape != y.shape or x.ndim != 1 or len(x) < FEWEST:
        problem = f"{x.size} and {y.size} coordinates"
        raise InputError("line", problem, f"at least {FEWEST} points with an x and a y each", "add points")
    if np.ptp(x) == 0:
        problem = f"every point has x = {x[0]:g}"
        raise InputError("line", problem, "points at different x", "spread the points")
    return x, y


def _settled(update: Callable[[float], float], slope: float) -> float:
    for _ in range(_ITERATIONS):
        last, slope = slope, float(update(slope))
        if not np.isfinite(slope):
            break
        if abs(slope - last) <= 4 * np.finfo(float).eps * abs(slope):
            return slope
    # rounding keeps it from settling further
    if np.isfinite(slope) and abs(slope - last) <= 1e-12 * abs(slope):
        return slope
    problem = "no line fits these points: the slope does not settle"
    expected = "points that follow a straight line within their errors"
    raise InputError("line", problem, expected, "look at the points")
