"""The least squares of one swing where there is no C compiler: scipy's, over trajectories in Python."""

from typing import Any

import numpy as np

from ..arrays import Floats
from ..engine import uncompiled
from ..engine.interface import Outcome
from .problem import Problem

_PART = 0.35  # of the record, for a start
_ROUGH = 1e-4
_FURTHER = 1e-4  # times the tolerance that is asked for: one step more, and rounding does not tell where the search ends


def least_squares(
    problem: Problem, starts: Floats, most: int, tolerance: float
) -> tuple[tuple[float, Floats, Floats, Floats, Outcome, list[Floats]], int, int]:
    """The least sum of squares of the problem's one swing: it (rad^2), where, J'J there, each start's, how it ended, and the
    angles (rad) there; how many starts reached it, and how many were tried.

    Of the first part of the swing the optimum is sought from every start, of the whole of it from the best of those.
    EngineError for several swings.
    """
    if len(problem.swings) > 1:
        raise uncompiled.refusal()
    size = problem.swings[0][0].size
    parts = [_search(problem, start, max(8, round(_PART * size)), min(most, 30), _ROUGH) for start in starts]
    squares = np.array([part[0] for part in parts])
    nothing = np.zeros((len(problem.free), len(problem.free)))
    if not np.isfinite(squares).any():
        lost = Outcome(-1, 0, np.inf, False, False, False)
        return (np.inf, starts[0], nothing, squares, lost, []), 0, len(starts)
    rss, best, evaluations, converged = _search(
        problem, parts[int(np.argmin(squares))][1], size, most, tolerance
    )
    angles, by, report = _course(problem, best, size, slopes=True)
    hessian = by @ by.T + (0 if problem.known is None else problem.known.precision)
    evaluations += sum(part[2] for part in parts)
    outcome = Outcome(int(converged), evaluations, 0.0, report.stuck_after >= 0, False, report.driven)
    agreeing = int(np.sum(squares <= squares.min() * (1 + _ROUGH)))
    return (rss, best, hessian, squares, outcome, [angles]), agreeing, len(starts)


def _course(problem: Problem, x: Floats, size: int, slopes: bool) -> tuple[Floats, Floats, Any]:
    """The angles (rad) of the swing's first samples at the variables, their derivatives by these, and the report."""
    compiled, times, row = problem.compiled[0], problem.swings[0][0][:size], np.array(problem.slots(x)[0])
    model, duration = compiled.model, compiled.duration
    angles, report = uncompiled.trajectory(model, duration, row[:-2], row[-2:], times)
    if not slopes:
        return angles, np.zeros((0, size)), report
    codes = [
        *range(row.size - 2),
        uncompiled.Uncompiled.RELEASE_ANGLE,
        uncompiled.Uncompiled.RELEASE_VELOCITY,
    ]
    place = {
        int(variable): code for variable, code in zip(problem.where[0], codes, strict=True) if variable >= 0
    }
    chosen = [place[k] for k in range(len(problem.free))]
    return angles, uncompiled.slopes(model, duration, row[:-2], row[-2:], times, chosen), report


def _search(
    problem: Problem, start: Floats, size: int, most: int, tolerance: float
) -> tuple[float, Floats, int, bool]:
    """The least sum of squares (rad^2) over the first samples, where, trajectories with slopes, and whether it is stationary."""
    from scipy.optimize import least_squares as minimise  # here, because it takes long to import

    angle = problem.swings[0][1][:size]
    root = np.zeros((0, start.size))
    if problem.known is not None:
        values, vectors = np.linalg.eigh(problem.known.precision)
        root = (vectors * np.sqrt(np.maximum(values, 0.0))).T

    def residuals(x: Floats) -> Floats:
        try:
            return np.concatenate([_course(problem, x, size, slopes=False)[0] - angle, root @ x])
        except uncompiled.Failure:
            return np.full(size + len(root), np.inf)

    def jacobian(x: Floats) -> Floats:
        return np.vstack([_course(problem, x, size, slopes=True)[1].T, root])

    upper = problem.upper.copy()
    if problem.where[0, 0] >= 0:
        upper[problem.where[0, 0]] = np.inf  # a frequency's bound, far off as it is, would turn scipy's steps
    try:
        found = minimise(
            residuals, start, jacobian, (problem.lower, upper), "trf", x_scale="jac", max_nfev=most,
            ftol=tolerance if tolerance == _ROUGH else _FURTHER * tolerance, xtol=1e-2 * tolerance, gtol=1e-15,
        )  # fmt: skip
    except (ValueError, uncompiled.Failure):  # what scipy says of a start that cannot be computed
        return np.inf, start, 1, False
    best = np.where(
        found.active_mask < 0, problem.lower, np.where(found.active_mask > 0, problem.upper, found.x)
    )
    return 2 * float(found.cost), best, int(found.nfev), bool(found.success)
