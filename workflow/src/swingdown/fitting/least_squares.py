"""Trajectory least squares with exact sensitivities: one model to one swing, or to several at once."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from math import sqrt
from typing import Any, NamedTuple

import numpy as np

from ..arrays import Floats, standard_errors
from ..engine import interface
from ..engine.trajectory import TrajectoryError, simulate_compiled, warn_of_drive
from ..pendulum.model import Model, as_model
from . import effort
from .covariance import covariance_of
from .problem import Problem, Swings
from .result import Fit, SwingFit

_labelled = lru_cache(maxsize=100)(as_model)
_FEWEST = 8  # samples of a swing's first part
_PARTS = (0.15, 0.25, 0.35, 0.45, 0.55, 0.65, 0.75, 0.85, 0.95)  # of the record, for a start
_TELLING = 0.35  # a part that tells all values apart, where a shorter one may have led astray
_SAME = 1e-6  # of the sum of squares: the same optimum
# tolerance of a part's optimum, which is only a start; evaluations for all parts
_ROUGH, _ROUGH_EVALUATIONS = 1e-6, 200


def fit_jointly(  # noqa: PLR0913
    model: Model | str,
    swings: Swings,
    *,
    start: str = "free",
    guess: Any = None,
    bounded: bool = False,
    own: Iterable[str] | None = None,
    fixed: Mapping[str, float] | None = None,
    seen: bool = True,
    grown: bool = True,
    most: int = 200,
    tolerance: float = 1e-10,
    rough: bool = False,
) -> Fit:
    """The ``Fit`` of one model to several swings at once: shared parameters, each swing its own release.

    What drifts over a record drifts over the longest one.

    Parameters
    ----------
    model
        A Model (its values are not used) or a label.
    swings
        A list of (times in s, angles in rad).
    start
        ``free`` fits each release angle and velocity; ``rest`` starts at rest at the first sample.
    guess
        A model with values, a fit or a ``Begin``, or several, to start from besides the decay in the data.
    bounded
        Whether parameters keep within the catalogue's bounds.
    own
        Parameters that each swing has for itself. Default: those that the catalogue says, such as a phase.
    fixed
        Values, by name, that are not fitted.
    seen
        Whether to start from the decay where there are fits to start from.
    grown
        Whether to start from fits of ever longer parts of the swings.
    most
        The most evaluations of a start; ``converged`` says whether they sufficed.
    tolerance
        The relative fall of the sum of squares below which a step is the last.
    rough
        Whether trajectories of many panels may be off by up to 1e-6 rad, for fits that are only compared.

    Raises
    ------
    InputError
        For swings that cannot be fitted.
    TrajectoryError
        If no start gives a trajectory.
    """
    model = _labelled(model) if isinstance(model, str) else model
    if model.record is None and len(swings) > 1:
        model = replace(model, record=max(float(times[-1] - times[0]) for times, _ in swings))
    own = (model.each if len(swings) > 1 else ()) if own is None else tuple(own)
    problem = Problem(model, swings, start, bounded, own, fixed)
    starts, from_data = problem.starts(guess, seen)
    first = len(starts) - from_data + 1 if from_data else 0
    found, agreeing, tried = _from_all(problem, starts, first, most, tolerance, grown, rough)
    rss, best, hessian, _, outcome, angles = found
    if outcome.converged < 0:
        raise TrajectoryError(f"model {model.label}: no start of {tried} gives a trajectory")
    ended = "stationary" if outcome.converged else f"not stationary after {outcome.evaluations} evaluations"
    message = f"{agreeing} of {tried} starts reached the best optimum; {ended}"
    covariance, converged = covariance_of(problem, hessian, rss, best), bool(outcome.converged)
    if outcome.driven:
        for compiled, series in zip(problem.compiled, angles, strict=False):
            warn_of_drive(compiled, True, series)
    minimum = Minimum(best, covariance, rss, converged, outcome.evaluations, angles)
    return fit_at(problem, minimum, "least squares", message)


def fit_trajectory(model: Model | str, times: Any, angle: Any, **options: Any) -> Fit:
    """The ``Fit`` of a model to one swing.

    Parameters
    ----------
    model
        A Model (its values are not used) or a label.
    times, angle
        In s and rad, of shape (n,).
    **options
        As in ``fit_jointly``, and so are the errors.
    """
    return fit_jointly(model, [(times, angle)], **options)


class Minimum(NamedTuple):
    """Where a search ended: the free values, their covariance with its systematic part by source, the sum of squares (rad^2) there, whether it
    is stationary, and what it took; and the fitted angles (rad) of each swing, where they are known."""

    best: Floats
    covariance: tuple[Floats, Floats]
    rss: float
    converged: bool
    evaluations: int
    angles: Sequence[Floats] | None = None


def fit_at(problem: Problem, minimum: Minimum, method: str, message: str) -> Fit:
    """The ``Fit`` of a problem at a minimum; ``method`` and ``message`` are what the fit states of itself."""
    names, slots = problem.model.parameters, problem.slots(minimum.best)
    (whole, systematic), angles = minimum.covariance, minimum.angles
    errors = dict(zip(problem.free, standard_errors(whole).tolist(), strict=True))
    shared = np.array(slots)[:, :-2].mean(axis=0).tolist() if problem.own else slots[0][:-2]
    model = problem.model.with_values(
        dict(zip(names, shared, strict=True)), {name: errors[name] for name in problem.shared}
    )
    if angles is None:
        angles = [
            simulate_compiled(compiled, times, np.array(row[:-2]), row[-2:])
            for row, compiled, (times, _) in zip(slots, problem.compiled, problem.swings, strict=True)
        ]
    swings = []
    for row, series, (_, angle), drive in zip(slots, angles, problem.swings, problem.drives, strict=True):
        one = model.with_values(dict(zip(names, row[:-2], strict=True))) if problem.own else model
        one = one.driven_by(drive)
        left = series - angle
        rms = sqrt(left.dot(left) / left.size)
        own = {name: one.values[name] for name in problem.own}
        swings.append(SwingFit(one, row[-2], row[-1], series, rms, own))
    return Fit(
        model, method, tuple(problem.free), minimum.best, whole, float(minimum.rss), problem.n, tuple(swings), minimum.converged,
        message, int(minimum.evaluations), systematic,
    )  # fmt: skip


def _grown(problem: Problem, starts: Floats, most: int, tolerance: float) -> Floats:
    """One more start: the optimum of the first part of every swing, then of ever longer parts.

    Where friction stops the pendulum within the record, the whole record has many minima and its first part few.
    """
    grown, left = starts, _ROUGH_EVALUATIONS
    for share in _PARTS:
        tried = np.vstack([grown, starts]) if share == _TELLING else grown
        part = _search(problem, tried, min(most, left, 30), max(tolerance, _ROUGH), share)
        outcome = part[4]
        if outcome.converged < 0:
            break
        grown = part[1][None]
        left -= outcome.evaluations
        if left <= 0:
            break
    return grown[:1]


def _from_all(
    problem: Problem, starts: Floats, first: int, most: int, tolerance: float, grow: bool, rough: bool
) -> tuple[Any, int, int]:
    """The least sum of squares over the whole of every swing, how many starts reached it and how many were tried.

    The optimum of one part from all starts and the ``first`` so many of them do where they come to one place at which no
    swing stops: then no start is far off. Where one start leads to an optimum that leaves nothing but white noise, of the part
    and of the whole, there is nothing better to be found, and no other is tried. Else parts are grown into the whole, unless ``grow`` is False,
    and all starts tried. Of many samples a few tell where to: the search among all ends there.
    """
    thin = problem.thinned(starts)
    grown, agreed = starts[:0], False
    if not first and len(starts) > 1:
        part = _search(thin, starts, min(most, 30), max(tolerance, _ROUGH), _TELLING)
        if part[4].converged > 0 and np.all(part[3] <= part[0] * (1 + _SAME)):
            starts = part[1][None]
    found: Any = None
    # the sums of squares of the whole to which the first starts led: none of them is tried twice
    known = starts[:0, 0]
    if first:
        for until_noise in (True, False):
            part = _search(thin, starts, min(most, 30), max(tolerance, _ROUGH), _TELLING, until_noise)
            tried = np.vstack([part[1], found[1] if known.size else starts[:first]])
            rss, best, _, squares, outcome, _ = found = _search(
                thin, tried, most, tolerance, until_noise=True, rough=rough
            )
            if outcome.ends_in_noise:
                squares = squares[:1]
                break
            if outcome.converged >= 0 and not known.size:
                known = squares[1:]
            squares = np.append(squares[:1], known)
            if not part[4].ends_in_noise:
                break
        stationary = part[4].converged > 0 and outcome.converged > 0
        agreed = stationary and not outcome.stops and bool(np.all(squares <= rss * (1 + _SAME)))
    if not agreed:
        grown = _grown(thin, starts, most, tolerance) if grow else starts[:0]
        tried = np.vstack([found[1], grown, starts[first:]] if known.size else [grown, starts])
        rss, best, _, squares, _, _ = found = _search(thin, tried, most, tolerance, rough=rough)
        squares = np.append(squares[1:], known) if known.size else squares
    if thin is not problem:
        found = _search(problem, np.vstack([best, grown]), most, tolerance, rough=rough)
    return found, int(np.sum(squares <= rss * (1 + _SAME))), squares.size


def _search(
    problem: Problem,
    starts: Floats,
    most: int,
    tolerance: float,
    share: float = 1.0,
    until_noise: bool = False,
    rough: bool = False,
) -> Any:
    """The least sum of squares over a share of every swing: it, where, J'J (near there, for a part), each start's, and how;
    for the whole the angles (rad) of each swing there."""
    sizes = [times.size for times, _ in problem.swings]
    lengths = [min(size, max(_FEWEST, round(share * size))) for size in sizes]
    options, library = interface.Options(most, tolerance), problem.compiled[0].library
    angles = np.empty(sum(sizes)) if share == 1 else None
    asked = interface.Starts(starts, share == 1, until_noise, rough)
    found = interface.fit_swings(library, problem.c, asked, lengths, options, angles)
    effort.add(found[4].evaluations, starts.shape[1], share * problem.half_swings(starts), sum(lengths))
    if angles is None or len(sizes) == 1:
        return *found, [angles]
    return *found, np.split(angles, np.cumsum(sizes)[:-1])
