"""One model fitted to many series over the same times, for Monte-Carlo studies."""

from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np

from ..engine import interface
from ..engine.trajectory import Compiled, checked_times, simulate_each
from ..errors import InputError
from ..pendulum.model import Model
from .problem import RELEASE, limits
from .result import BatchFit


def fit_batch(
    guess: Model,
    times: Any,
    series: Any,
    release_angle: float,
    release_velocity: float = 0.0,
    *,
    start: str = "free",
    bounded: bool = False,
    workers: int = 1,
    most: int = 100,
    tolerance: float = 1e-10,
    foretells: bool = False,
    starts: Any = None,
    reference: Any = None,
    curvature: Any = None,
    coarseness: float = 1.0,
) -> BatchFit:
    """The ``BatchFit`` of one model to each of many series of angles over the same times.

    Fits go side by side in vector lanes where no effect has states, adds inertia, may be narrow, or reads the angle but by a
    gain and a zero. The numbers depend neither on the threads nor on a series' company. A single series takes up to twice as
    long as by itself.

    Parameters
    ----------
    guess
        The model with the values to start from.
    times
        In s, of shape (n,).
    series
        Angles in rad, of shape (series, n).
    release_angle, release_velocity
        The release to start from, in rad and rad/s.
    start, bounded
        As in ``fit_jointly``.
    workers
        Threads that share the series.
    most
        The most evaluations of a start.
    tolerance
        The relative fall of the sum of squares below which a step is the last.
    foretells
        Whether the last step is taken unseen; the sum is then what the slopes predict.
    starts
        In each row the parameters, release angle and velocity from which that series starts, of shape (series, values).
    reference
        Angles in rad, of shape (n,): ``off`` then has each fit's distance from them.
    curvature
        What J'J lacks of the curvature of half the sum of squares, of shape (free, free), where it is known beforehand.
    coarseness
        How many times as far as 2e-10 of the largest angle a lane may be off.

    Raises
    ------
    InputError
        For arrays that do not fit together.
    """
    times, series = checked_times(times), np.ascontiguousarray(series, dtype=float)
    if series.ndim != 2 or series.shape[1] != times.size or not np.all(np.isfinite(series)):
        raise InputError(
            "series", f"an array of shape {series.shape}", f"finite angles of shape (any, {times.size})"
        )
    size, count = len(guess.parameters), len(series)
    free = guess.parameters + (RELEASE if start == "free" else ())
    first = np.array([*guess.vector(), release_angle, release_velocity], dtype=float)
    given = np.tile(first, (count, 1)) if starts is None else np.array(starts, dtype=float, order="C")
    if given.shape != (count, size + 2) or not np.all(np.isfinite(given)):
        raise InputError(
            "starts", f"an array of shape {given.shape}", f"finite values of shape {(count, size + 2)}"
        )
    if start != "free":
        given[:, size], given[:, size + 1] = series[:, 0], release_velocity
    compared = None if reference is None else np.ascontiguousarray(reference, dtype=float)
    if compared is not None and (compared.shape != times.shape or not np.all(np.isfinite(compared))):
        raise InputError(
            "reference", f"an array of shape {compared.shape}", f"finite angles of shape {times.shape}"
        )
    lower, upper = np.array(
        [limits(d, bounded) for d in guess.definitions] + [(-np.inf, np.inf)] * 2
    ).T.copy()
    compiled = Compiled(guess, float(times[-1] - times[0]), float(times[0]))
    where = np.arange(size + 2, dtype=np.int32)
    where[len(free) :] = -1
    values, rss = np.zeros((count, len(free))), np.zeros(count)
    curved = None if curvature is None else np.ascontiguousarray(curvature, dtype=float)
    if curved is not None and (curved.shape != (len(free),) * 2 or not np.all(np.isfinite(curved))):
        raise InputError(
            "curvature", f"an array of shape {curved.shape}", f"finite, of shape {(len(free),) * 2}"
        )
    converged, evaluations, alone = np.zeros((3, count), dtype=np.int32)
    off = np.full(count, np.nan)
    options, bounds = (
        interface.Options(most, tolerance, foretells),
        interface.Bounds(lower[: len(free)], upper[: len(free)]),
    )

    def work(part: slice) -> None:
        into = interface.BatchResult(
            values[part], rss[part], converged[part], evaluations[part], alone[part], off[part]
        )
        interface.fit_batch(
            compiled.library,
            compiled.c,
            times,
            series[part],
            given[part],
            first,
            where,
            bounds,
            options,
            into,
            compared,
            curved,
            coarseness,
        )

    edges = np.linspace(0, count, min(workers, count) * 8 + 1).astype(int) if workers > 1 else [0, count]
    parts = [slice(int(a), int(b)) for a, b in zip(edges, edges[1:], strict=False) if b > a]
    if len(parts) > 1:
        with ThreadPoolExecutor(workers) as pool:
            list(pool.map(work, parts))
    elif parts:
        work(parts[0])
    if compared is not None:
        by_itself = np.flatnonzero(alone == 1)
        slots = given[by_itself]
        slots[:, : len(free)] = values[by_itself]
        off[by_itself] = np.sum(np.square(simulate_each(guess, times, slots) - compared), axis=1)
    distance = None if compared is None else np.sqrt(off / times.size)
    return BatchFit(free, values, rss, converged == 1, evaluations, alone == 1, distance)
