"""One model fitted to many series over the same times, for Monte-Carlo studies."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..arrays import Floats
from ..engine import interface
from ..engine.trajectory import Compiled, checked_times, simulate_each
from ..errors import InputError
from ..pendulum.model import Model
from .problem import RELEASE, limits
from .result import BatchFit


@dataclass(frozen=True)
class Search:
    """How the fits of a batch are searched for, and what is known beforehand.

    Attributes
    ----------
    bounded
        Whether parameters keep within the catalogue's bounds.
    most
        The most evaluations of a start.
    tolerance
        The relative fall of the sum of squares below which a step is the last.
    foretells
        Whether the last step is taken unseen; the sum is then what the slopes predict.
    coarseness
        How many times as far as 2e-10 of the largest angle a lane may be off.
    starts
        In each row the parameters, release angle and velocity from which that series starts, of shape (series, values).
    reference
        Angles in rad, of shape (n,): ``off`` then has each fit's distance from them.
    curvature
        What J'J lacks of the curvature of half the sum of squares, of shape (free, free).
    """

    bounded: bool = False
    most: int = 100
    tolerance: float = 1e-10
    foretells: bool = False
    coarseness: float = 1.0
    starts: Any = None
    reference: Any = None
    curvature: Any = None


USUAL = Search()


def fit_batch(
    guess: Model,
    times: Any,
    series: Any,
    release: Sequence[float],
    *,
    start: str = "free",
    search: Search = USUAL,
) -> BatchFit:
    """The ``BatchFit`` of one model to each of many series of angles over the same times.

    Fits go side by side in vector lanes where no effect has states, adds inertia, may be narrow, or reads the angle but by a
    gain and a zero. Threads may call it side by side; the numbers do not depend on a series' company. A single series takes up to
    twice as long as by itself.

    Parameters
    ----------
    guess
        The model with the values to start from.
    times
        In s, of shape (n,).
    series
        Angles in rad, of shape (series, n).
    release
        The angle and velocity to start from, in rad and rad/s.
    start
        As in ``fit_jointly``.
    search
        The limits of the search, and what is known beforehand.

    Raises
    ------
    InputError
        For arrays that do not fit together.
    """
    times, series = checked_times(times), np.ascontiguousarray(series, dtype=float)
    if series.ndim != 2 or series.shape[1] != times.size or not np.all(np.isfinite(series)):
        problem = f"an array of shape {series.shape}"
        raise InputError("series", problem, f"finite angles of shape (any, {times.size})")
    size, count = len(guess.parameters), len(series)
    free = guess.parameters + (RELEASE if start == "free" else ())
    first = np.array([*guess.vector(), *release], dtype=float)
    starts = _checked("starts", search.starts, (count, size + 2))
    given = np.tile(first, (count, 1)) if starts is None else starts.copy()
    if start != "free":
        given[:, size], given[:, size + 1] = series[:, 0], release[1]
    compared = _checked("reference", search.reference, times.shape)
    curved = _checked("curvature", search.curvature, (len(free),) * 2)
    each = [*(limits(d, search.bounded) for d in guess.definitions), *[(-np.inf, np.inf)] * 2]
    lower, upper = np.array(each).T.copy()
    compiled = Compiled(guess, float(times[-1] - times[0]), float(times[0]))
    where = np.arange(size + 2, dtype=np.int32)
    where[len(free) :] = -1
    values, rss = np.zeros((count, len(free))), np.zeros(count)
    converged, evaluations, alone = np.zeros((3, count), dtype=np.int32)
    off = np.full(count, np.nan)
    options = interface.Options(search.most, search.tolerance, search.foretells)
    bounds = interface.Bounds(lower[: len(free)], upper[: len(free)])
    common = interface.Batch(compiled.c, times, first, where, bounds, compared, curved, search.coarseness)

    into = interface.BatchResult(values, rss, converged, evaluations, alone, off)
    if count:
        interface.fit_batch(compiled.library, common, series, given, options, into)
    if compared is not None:
        by_itself = np.flatnonzero(alone == 1)
        slots = given[by_itself]
        slots[:, : len(free)] = values[by_itself]
        off[by_itself] = np.sum(np.square(simulate_each(guess, times, slots) - compared), axis=1)
    distance = None if compared is None else np.sqrt(off / times.size)
    return BatchFit(free, values, rss, converged == 1, evaluations, alone == 1, distance)


def _checked(name: str, given: Any, shape: tuple[int, ...]) -> Floats | None:
    """The array as finite numbers of this shape, or None where none is given; InputError for any other."""
    if given is None:
        return None
    array = np.ascontiguousarray(given, dtype=float)
    if array.shape != shape or not np.all(np.isfinite(array)):
        raise InputError(name, f"an array of shape {array.shape}", f"finite values of shape {shape}")
    return array
