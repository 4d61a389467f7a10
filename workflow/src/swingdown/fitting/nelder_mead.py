"""The paper's fit: the Nelder-Mead simplex, restarted until it is stationary."""

from typing import Any

import numpy as np

from ..arrays import Floats
from ..engine.trajectory import TrajectoryError, simulate
from ..pendulum.model import Model, as_model
from .covariance import covariance_at
from .least_squares import Minimum, fit_at
from .problem import Problem
from .result import Fit

_GAIN = 1e-8  # of the sum of squares; a simplex that gains less is stationary


def fit_nelder_mead(
    model: Model | str, times: Any, angle: Any, *, start: str = "free", guess: Any = None, restarts: int = 20
) -> Fit:
    """The ``Fit`` of a model to one swing by the Nelder-Mead simplex, as in the paper, restarted until stationary.

    A simplex is started again from where the last one ended until that gains less than 1e-8 of the sum of squares.

    Parameters
    ----------
    model, times, angle, start, guess
        As in ``fit_trajectory``, and so are the errors.
    restarts
        The most restarts; ``message`` says how many it took.
    """
    from scipy.optimize import minimize  # here, because it takes longer to import than most fits to run

    problem = Problem(as_model(model), [(times, angle)], start, bounded=False)
    (times, angle) = problem.swings[0]
    model = problem.model

    def squares(x: Floats) -> float:
        if np.any(x < problem.lower) or np.any(x > problem.upper):
            return np.inf
        try:
            *values, release_angle, release_velocity = problem.slots(x)[0]
            one = model.with_values(dict(zip(model.parameters, values, strict=True)))
            fitted = simulate(one, times, release_angle, release_velocity)
        except TrajectoryError:
            return np.inf
        return float(np.sum((fitted - angle) ** 2))

    best = min(problem.starts(guess)[0], key=squares)
    # steps in proportion to each value; a coefficient that starts at zero still gets a step of its usual size
    typical = [*(d.typical for d in model.definitions), *[0.1] * (best.size - len(model.parameters))]
    scale = np.maximum(np.abs(best), typical)
    value, evaluations, converged, step = squares(best), 0, False, 0.05
    for count in range(1, restarts + 1):
        origin = best / scale
        simplex = np.vstack([origin, origin + step * np.eye(best.size)])
        options = {"initial_simplex": simplex, "xatol": 1e-6, "fatol": 1e-9 * value, "maxfev": 4000}
        found = minimize(lambda z: squares(z * scale), origin, method="Nelder-Mead", options=options)
        evaluations += found.nfev
        gain = value - found.fun
        if gain > 0:
            value, best = float(found.fun), found.x * scale
        if count > 1 and gain <= _GAIN * value:
            converged = True
            break
        step = -0.4 * step
    message = f"stationary after {count} simplexes"
    if not converged:
        message = f"not stationary after {restarts} simplexes"
    minimum = Minimum(best, covariance_at(problem, best, value), value, converged, evaluations)
    return fit_at(problem, minimum, "Nelder-Mead", message)
