"""Least squares for any residuals, by the same minimiser that fits swings."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from swingdown.arrays import Floats
from swingdown.engine import interface
from swingdown.engine.trajectory import engine
from swingdown.errors import InputError


@dataclass(frozen=True)
class Minimum:
    """A minimum of a sum of squares.

    Attributes
    ----------
    x
        The variables there, of shape (n,).
    rss
        The sum of squares.
    normal
        J'J there, of shape (n, n).
    converged, evaluations
        Whether the point is stationary, and how many evaluations it took.
    """

    x: np.ndarray
    rss: float
    normal: np.ndarray
    converged: bool
    evaluations: int


def least_squares(
    residuals_and_jacobian: Callable[[Floats], tuple[ArrayLike, ArrayLike]],
    start: ArrayLike,
    lower: ArrayLike | None = None,
    upper: ArrayLike | None = None,
    *,
    most: int = 20000,
    tolerance: float = 1e-14,
) -> Minimum:
    """The ``Minimum`` of a sum of squares within bounds, from ``start``.

    Levenberg-Marquardt with Nielsen's damping (Madsen, Nielsen and Tingleff, Methods for Non-Linear Least Squares Problems, 2004).

    Parameters
    ----------
    residuals_and_jacobian
        Takes the variables (n,) and returns residuals (m,) and derivatives (m, n). From a residual that is not finite the search
        steps back.
    start
        The variables to start from, of shape (n,).
    lower, upper
        Bounds, of shape (n,).
    most
        The most evaluations.
    tolerance
        The relative fall of the sum below which the point is stationary.

    Raises
    ------
    InputError
        If the start cannot be computed, or shapes do not agree.
    """
    x = np.array(start, dtype=float, ndmin=1)
    size = x.size
    most_variables = engine().MAX_VARIABLES
    if x.ndim != 1 or not 0 < size <= most_variables or not np.all(np.isfinite(x)):
        raise InputError("least squares, start", f"{start!r}", f"1 to {most_variables} finite numbers")
    bounds = []
    for name, given, default in (("lower", lower, -np.inf), ("upper", upper, np.inf)):
        bounds.append(np.full(size, default) if given is None else np.array(given, dtype=float))
        if bounds[-1].shape != x.shape:
            problem = f"{bounds[-1].size} bounds for {size} variables"
            raise InputError(f"least squares, {name}", problem, "one each")
    if not np.all(bounds[0] <= bounds[1]):
        raise InputError("least squares, lower", "above the upper bound", "lower at most upper")
    raised: list[BaseException] = []

    def cost(at: Floats, gradient: Floats, normal: Floats) -> float:
        if raised:
            return np.nan
        try:
            parts = residuals_and_jacobian(at.copy())
            residuals, jacobian = (np.asarray(part, dtype=float) for part in parts)
            if residuals.ndim != 1 or jacobian.shape != (residuals.size, size):
                problem = f"residuals of shape {residuals.shape}, derivatives {jacobian.shape}"
                raise InputError("least squares", problem, f"(m,) and (m, {size})")
            if not (np.all(np.isfinite(residuals)) and np.all(np.isfinite(jacobian))):
                return np.inf
            gradient[:] = jacobian.T @ residuals
            normal[:] = jacobian.T @ jacobian
            return 0.5 * float(residuals @ residuals)
        except BaseException as problem:  # nothing may pass through C; it is raised again below
            raised.append(problem)
            return np.nan

    half, normal, outcome = interface.minimise(
        engine(), cost, x, interface.Bounds(*bounds), interface.Options(most, tolerance)
    )
    if raised:
        raise raised[0]
    if outcome.converged < 0:
        problem = f"the residuals at {x} are not finite"
        raise InputError("least squares, start", problem, "a start that can be computed")
    return Minimum(x, 2.0 * half, normal, outcome.converged == 1, outcome.evaluations)
