"""One model fitted to many series over the same times, for Monte-Carlo studies."""

from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np

from ..engine import interface
from ..engine.trajectory import Compiled, checked_times
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
) -> BatchFit:
    """The ``BatchFit`` of one model to each of many series of angles over the same times.

    ``guess`` is the model with the values to start from, ``release_angle`` (rad) and ``release_velocity`` (rad/s) the
    release to start from; ``series`` in rad, of shape (series, n). ``workers`` threads share the series; the numbers depend
    neither on how many nor on a series' company. Where no effect has states, adds inertia, may be narrow or reads the angle
    but by a gain and a zero, fits go side by side in the processor's vector lanes, in a sixth of the time (a third where
    the motion depends on the velocity's sign), those apart in which friction stops the pendulum; ``alone`` tells which did
    not. A single series takes longer so, up to twice as long. Raises InputError for arrays that do not fit together.
    """
    times, series = checked_times(times), np.ascontiguousarray(series, dtype=float)
    if series.ndim != 2 or series.shape[1] != times.size or not np.all(np.isfinite(series)):
        raise InputError(
            "series", f"an array of shape {series.shape}", f"finite angles of shape (any, {times.size})"
        )
    size, count = len(guess.parameters), len(series)
    free = guess.parameters + (RELEASE if start == "free" else ())
    first = np.array([*guess.vector(), release_angle, release_velocity], dtype=float)
    starts = np.tile(first, (count, 1))
    starts[:, size] = release_angle if start == "free" else series[:, 0]
    lower, upper = np.array(
        [limits(d, bounded) for d in guess.definitions] + [(-np.inf, np.inf)] * 2
    ).T.copy()
    compiled = Compiled(guess, float(times[-1] - times[0]))
    where = np.arange(size + 2, dtype=np.int32)
    where[len(free) :] = -1
    values, rss = np.zeros((count, len(free))), np.zeros(count)
    converged, evaluations, alone = np.zeros((3, count), dtype=np.int32)
    options, bounds = (
        interface.Options(most, tolerance),
        interface.Bounds(lower[: len(free)], upper[: len(free)]),
    )

    def work(part: slice) -> None:
        into = interface.BatchResult(values[part], rss[part], converged[part], evaluations[part], alone[part])
        interface.fit_batch(
            compiled.library,
            compiled.c,
            times,
            series[part],
            starts[part],
            first,
            where,
            bounds,
            options,
            into,
        )

    edges = np.linspace(0, count, min(workers, count) * 8 + 1).astype(int) if workers > 1 else [0, count]
    parts = [slice(int(a), int(b)) for a, b in zip(edges, edges[1:], strict=False) if b > a]
    if len(parts) > 1:
        with ThreadPoolExecutor(workers) as pool:
            list(pool.map(work, parts))
    elif parts:
        work(parts[0])
    return BatchFit(free, values, rss, converged == 1, evaluations, alone == 1)
