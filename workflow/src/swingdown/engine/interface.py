"""The engine's interface for Python: c/interface.h declares it, once for both; here numpy arrays go in and come out.

Every function takes the loaded library first (``build.load``), gives up the interpreter's lock while C runs, and leaves
checks of what it is given to its callers.
"""

from collections.abc import Callable, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple
from weakref import WeakKeyDictionary

import _cffi_backend
import numpy as np

from ..arrays import Floats, Swing
from . import cache

Places = Sequence[tuple[int, int, int]]
_HEADER = Path(__file__).parent / "c" / "interface.h"


@lru_cache
def ffi() -> Any:
    """The declarations of c/interface.h, as cffi's FFI object (ABI mode).

    cffi's parser takes 50 ms: what it makes of the header is kept in the cache, as the libraries are.
    """
    plain = "".join(
        line for line in _HEADER.read_text().splitlines(keepends=True) if not line.startswith("#")
    )

    def make(path: Path) -> None:
        from cffi import FFI  # here, for the same reason

        declared = FFI()
        declared.cdef(plain)
        declared.set_source("interface", None, compiler_verbose=0)
        declared.emit_python_code(str(path))

    path = cache.kept(f"interface-{cache.key(plain, _cffi_backend.__version__)}.py", make)
    names: dict = {}
    exec(compile(path.read_text(), str(path), "exec"), names)
    return names["ffi"]


def doubles(array: np.ndarray) -> Any:
    """The contiguous float64 array as C's doubles."""
    return ffi().from_buffer("double[]", array)


def integers(array: np.ndarray) -> Any:
    """The contiguous int32 array as C's int."""
    return ffi().from_buffer("int[]", array)


# ---- Models ----


_arrays: WeakKeyDictionary = WeakKeyDictionary()  # what a model points to, alive as long as it


class Layout(NamedTuple):
    """Where effects and their values stand in a model: (row, first parameter, first state) of each effect that moves it, of its sensor
    and of its clock; how many parameters and states there are; the parameters of play and of the drive's delay, or -1."""

    motions: Places
    sensors: Places = ()
    clocks: Places = ()
    n_parameters: int = 1
    n_states: int = 0
    play: int = -1
    delay: int = -1


def model(
    layout: Layout, duration: float, reads_rate: bool = False, drive: tuple[Floats, Floats] | None = None
) -> Any:
    """A C ``Model``.

    ``duration`` in s; ``reads_rate``: what is read is the angular velocity; ``drive``: knots (n + 1, s) and coefficients (n, 4) of what
    drives it.
    """
    kinds = {"motions": layout.motions, "sensors": layout.sensors, "clocks": layout.clocks}
    arrays = {kind: ffi().new("PlacedEffect[]", placed) for kind, placed in kinds.items()}
    counts = {f"n_{kind}": len(placed) for kind, placed in kinds.items()}
    sizes = {"n_parameters": layout.n_parameters, "n_states": layout.n_states, "play": layout.play}
    given = arrays | counts | sizes | {"duration": duration, "reads_rate": int(reads_rate)}
    if drive is not None:
        knots, coefficients = drive
        given["input"] = ffi().new("Input *", (len(coefficients), doubles(knots), doubles(coefficients)))
        given["input_delay"] = layout.delay
    found = ffi().new("Model *", given)
    _arrays[found] = arrays, given, drive
    return found


# ---- Trajectories ----


def status_name(status: int) -> str:
    """The name of a status in c/interface.h."""
    return ffi().typeof("enum Status").elements[status]


class InitialValueProblem(NamedTuple):
    """A motion to follow: values (parameters,), release angle and velocity (rad, rad/s), times (n,) in s, and the codes of the values that
    slopes are wanted by. Errors may be ``coarseness`` times as large as usual; below 1 they are smaller."""

    values: Floats
    release: Sequence[float]
    times: Floats
    free: Sequence[int] = ()
    coarseness: float = 1.0


def swing_trajectory(
    library: Any, model: Any, given: InitialValueProblem, angles: Floats, slopes: Floats | None = None
) -> tuple[int, Any]:
    """The status and the report of a trajectory; ``angles`` (n,) and ``slopes`` (len(free), n) are filled."""
    new, times = ffi().new, given.times
    report, free = new("TrajectoryReport *"), new("int[]", given.free)
    problem = new(
        "InitialValueProblem *",
        (model, doubles(given.values), *given.release, doubles(times), times.size, np.inf, given.coarseness, len(given.free), free),
    )  # fmt: skip
    status = library.swing_trajectory(
        problem, doubles(angles), ffi().NULL if slopes is None else doubles(slopes), report
    )
    return status, report


def swing_trajectories(library: Any, model: Any, values: Floats, times: Floats, angles: Floats) -> None:
    """The angles of one model with other values in each row, into the rows of ``angles`` (rows, n); NaN throughout where they
    cannot be computed.

    ``values`` have in each row the parameters, the release angle (rad) and velocity (rad/s); ``times`` (n,) in s.
    """
    new, size = ffi().new, values.shape[1]
    report, nothing = new("TrajectoryReport *"), ffi().NULL
    given, into = doubles(values), doubles(angles)
    problem = new(
        "InitialValueProblem *", (model, given, 0.0, 0.0, doubles(times), times.size, np.inf, 1.0, 0, nothing)
    )
    for k, (*_, angle, velocity) in enumerate(values.tolist()):
        problem.parameters = given + k * size
        problem.release_angle, problem.release_velocity = angle, velocity
        if library.swing_trajectory(problem, into + k * times.size, nothing, report):
            angles[k] = np.nan


# ---- Least squares ----


class Outcome(NamedTuple):
    """How a search ended: a ``Convergence`` of c/interface.h, its evaluations, whether a swing stops within its record, whether nothing but
    white noise is left, and whether friction drives a swing."""

    converged: int
    evaluations: int
    stops: bool
    ends_in_noise: bool
    driven: bool


class Bounds(NamedTuple):
    """Arrays of the variables' lower and upper bounds; infinite where there is none."""

    lower: np.ndarray
    upper: np.ndarray


class Knowledge(NamedTuple):
    """The variables' means and their precision (matrix, rad^2 over the variables' units) before any swing is seen."""

    mean: np.ndarray
    precision: np.ndarray


class Options(NamedTuple):
    """The most evaluations of a search, the relative fall of the sum of squares below which it is stationary, and whether a
    step that promises less is taken as the slopes foretell it, not tried."""

    most: int
    tolerance: float
    foretells: bool = False


def _outcome(c: Any) -> Outcome:
    flags = bool(c.stops), bool(c.ends_in_noise), bool(c.driven)
    return Outcome(c.converged, c.evaluations, *flags)


def _c_bounds(bounds: Bounds) -> tuple[Any, Any]:
    return doubles(bounds.lower), doubles(bounds.upper)


def minimise(
    library: Any, cost: Callable[[Floats, Floats, Floats], float], x: Floats, bounds: Bounds, options: Options
) -> tuple[float, Floats, Outcome]:
    """Half the least sum of squares, J'J there, and how it ended; ``x`` moves to the minimum.

    ``cost(x, gradient, normal)`` fills the arrays J'r and J'J and returns half the sum of squares; it must not raise.
    """
    size, buffer = x.size, ffi().buffer
    normal, outcome = np.zeros((size, size)), ffi().new("SearchOutcome *")

    def array(pointer: Any, count: int) -> Floats:
        return np.frombuffer(buffer(pointer, 8 * count))

    @ffi().callback("Cost", error=np.nan)  # then the search ends
    def called(_: Any, at: Any, gradient: Any, to: Any) -> float:
        return cost(array(at, size), array(gradient, size), array(to, size * size).reshape(size, size))

    problem = ffi().new("LeastSquares *", (called, ffi().NULL, size, _c_bounds(bounds), options))
    half = library.minimise(problem, doubles(x), doubles(normal), outcome)
    return half, normal, _outcome(outcome)


# ---- Fits of swings ----


class FitProblem:
    """Swings with a common model as C takes them; keeps alive what C points to.

    ``models``: a C ``Model`` for each of the ``swings``, which are (times in s, angles in rad); ``where`` (swing, value):
    the variable that each value is, or -1; ``given`` (swing, value): the values that are no variables; ``bounds``: the variables';
    ``known``: what is known of them beforehand.
    """

    def __init__(
        self,
        models: Sequence[Any],
        swings: Sequence[Swing],
        where: np.ndarray,
        given: Floats,
        bounds: Bounds,
        known: "Knowledge | None" = None,
    ) -> None:
        new = ffi().new
        self._kept = models, swings, where, bounds, known
        self.given = given
        self.n_variables = bounds.lower.size
        self.models = models[0] if len(models) == 1 else new("Model[]", [one[0] for one in models])
        self.times = new("double *[]", [doubles(times) for times, _ in swings])
        self.angles = new("double *[]", [doubles(angles) for _, angles in swings])
        self.where, self.bounds = integers(where), _c_bounds(bounds)
        self.known = (ffi().NULL,) * 2 if known is None else (doubles(known.mean), doubles(known.precision))

    def c(self, lengths: Any, values: Floats) -> Any:
        """It as C's ``FitProblem``; ``lengths`` (C's int[]) and ``values`` (swing, value) are to be kept alive."""
        return ffi().new(
            "FitProblem *",
            (self.models, len(lengths), lengths, self.times, self.angles, doubles(values), self.where, self.n_variables, self.bounds,
             self.known),
        )  # fmt: skip


class Starts(NamedTuple):
    """Where searches start (start, variable), and what is asked of them.

    Without ``evaluate_best`` no more is asked for than where another search starts: trajectories are coarser, as ``rough`` ones are, and
    J'J is that of a point close by. ``until_noise``: where the first start leads to a minimum that leaves nothing but noise, the others are not tried;
    their sums are NaN.
    """

    variables: Floats
    evaluate_best: bool = True
    until_noise: bool = False
    rough: bool = False


def fit_swings(
    library: Any,
    problem: FitProblem,
    starts: Starts,
    lengths: Sequence[int],
    options: Options,
    angles: Floats | None = None,
) -> tuple[float, Floats, Floats, Floats, Outcome]:
    """The least sum of squares (rad^2) from the starts, the variables there, J'J, the sum from each start, the ``Outcome``.

    ``lengths``: how many samples of each swing count. ``angles`` (n,) of all swings are filled with those at the best point, where that is
    evaluated.
    """
    size, new = problem.n_variables, ffi().new
    values, best, normal = problem.given.copy(), np.zeros(size), np.zeros((size, size))
    variables = np.ascontiguousarray(starts.variables)
    squares = np.zeros(len(variables))
    n_samples = new("int[]", lengths)
    swings = problem.c(n_samples, values)
    into = ffi().NULL if angles is None else doubles(angles)
    result = new(
        "FitResult *",
        {"variables": doubles(best), "normal": doubles(normal), "angles": into, "squares": doubles(squares)},
    )
    asked = starts.evaluate_best, starts.until_noise, starts.rough or not starts.evaluate_best
    all_starts = new("Starts *", (len(variables), doubles(variables), *asked))
    rss = library.fit_swings(swings, all_starts, new("SearchOptions *", options), result)
    return rss, best, normal, squares, _outcome(result.outcome)


class BatchResult(NamedTuple):
    """Arrays for a batch's results by series: variables (series, variable), rss (rad^2), as int32 converged, evaluations and
    whether it was fitted alone, and the sum of squares off the reference (rad^2), of those that were not."""

    values: np.ndarray
    rss: np.ndarray
    converged: np.ndarray
    evaluations: np.ndarray
    alone: np.ndarray
    off: np.ndarray | None = None


class Batch(NamedTuple):
    """What all fits of a batch have in common: a C ``Model``, times (n,) in s, a row of values near which all start (what is computed
    there serves them all), where the variables are, and their bounds.

    ``reference`` (n,) in rad is what fits are compared with; ``curvature`` what J'J lacks of that of half the sum of squares. Errors may be
    ``coarseness`` times as large as usual, of fits that are not alone.
    """

    model: Any
    times: Floats
    guess: Floats
    where: np.ndarray
    bounds: Bounds
    reference: Floats | None = None
    curvature: Floats | None = None
    coarseness: float = 1.0


def fit_batch(
    library: Any, common: Batch, series: Floats, values: Floats, options: Options, result: BatchResult
) -> None:
    """Fit each row of ``series`` (rad) from the values in its row, into the ``BatchResult``."""
    new, bounds = ffi().new, common.bounds
    reference, curvature = (
        ffi().NULL if one is None else doubles(one) for one in (common.reference, common.curvature)
    )
    batch = new(
        "Batch *",
        (common.model, common.times.size, doubles(common.times), len(series), doubles(series), doubles(values), doubles(common.guess),
         integers(common.where), bounds.lower.size, _c_bounds(bounds), reference, curvature, common.coarseness),
    )  # fmt: skip
    into = new(
        "BatchResult *",
        (
            doubles(result.values),
            doubles(result.rss),
            ffi().NULL if result.off is None else doubles(result.off),
            integers(result.converged),
            integers(result.evaluations),
            integers(result.alone),
        ),
    )
    library.fit_batch(batch, new("SearchOptions *", options), into)
