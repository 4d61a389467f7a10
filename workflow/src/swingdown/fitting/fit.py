"""Fits of models to swings: trajectory least squares with exact sensitivities, and the paper's Nelder-Mead."""

from concurrent.futures import ThreadPoolExecutor
from copy import copy
from dataclasses import dataclass

import numpy as np

from ..engine import interface
from ..engine.trajectory import (
    Compiled,
    TrajectoryError,
    checked_times,
    engine,
    sensitivities,
    simulate,
)
from ..errors import InputError
from ..pendulum.model import Model
from .guess import first_guess

STARTS = ("free", "rest")
_FEWEST = 8  # samples of a swing's first part
_PARTS = (0.15, 0.25, 0.35, 0.45, 0.55, 0.65, 0.75, 0.85, 0.95)  # of the record, for a start
_TOLD = 0.35  # a part that tells all values apart, where a shorter one may have led astray
_SAME = 1e-6  # of the sum of squares: the same optimum
_DENSE, _ENOUGH = (
    32,
    1000,
)  # samples a half-swing, and in all, that are as good as any number to tell where to search
_ROUGH, _ROUGH_EVALUATIONS = (
    1e-6,
    200,
)  # tolerance of a part's optimum, which is only a start; evaluations for all parts
_SMALLEST_FREQUENCY = 1e-3  # rad/s; a pendulum slower than an hour is none


@dataclass(frozen=True)
class Fit:
    """A model fitted to one swing, or to several at once (then ``release_*``, ``angle`` and ``swing_rms`` are tuples).

    ``free`` names the fitted values: the model's parameters, then ``release_angle`` (rad) and ``release_velocity``
    (rad/s) where these are free, of each swing in turn. ``covariance`` is s^2 (J'J)^-1 with s^2 = rss / (n - k): it
    takes the residuals for independent. ``rss`` in rad^2, ``rms`` in rad; ``angle`` is the fitted series in rad. ``own``
    holds for each swing, by name, the parameters that were not shared; the model has their means.
    """

    model: Model
    method: str
    free: tuple
    values: np.ndarray
    covariance: np.ndarray
    rss: float
    n: int
    release_angle: float | tuple
    release_velocity: float | tuple
    angle: np.ndarray | tuple
    swing_rms: float | tuple
    converged: bool
    message: str
    evaluations: int
    own: tuple = ()

    @property
    def rms(self):
        """Root mean square of data minus fit, rad."""
        return float(np.sqrt(self.rss / self.n))

    @property
    def standard_errors(self):
        """Standard errors in the order of ``free``; not finite where the data do not determine a value."""
        return np.sqrt(np.diag(self.covariance))

    @property
    def correlation(self):
        """The correlation matrix in the order of ``free``."""
        errors = self.standard_errors
        return self.covariance / np.outer(errors, errors)

    @property
    def bic(self):
        """Bayesian information criterion, n ln(rss/n) + k ln n, for independent residuals of one unknown variance."""
        return self.n * np.log(self.rss / self.n) + len(self.free) * np.log(self.n)

    @property
    def aicc(self):
        """Akaike's criterion with the correction for small samples."""
        k = len(self.free) + 1
        return self.n * np.log(self.rss / self.n) + 2 * k + 2 * k * (k + 1) / (self.n - k - 1)


def checked_swing(times, angle):
    """Times (s) and angles (rad) as contiguous arrays; InputError unless they match, are finite and increase."""
    times, angle = checked_times(times), np.ascontiguousarray(angle, dtype=float)
    if angle.shape != times.shape:
        raise InputError("swing", f"{angle.size} angles for {times.size} times", "one angle for each time")
    if not np.all(np.isfinite(angle)):
        raise InputError("swing", "an angle is not finite", "numbers only")
    return times, angle


def _limits(definition, bounded):
    """Lower and upper bound of a parameter in a fit; where that is not bounded, only those beyond which there is no such effect."""
    if definition.name == "natural_frequency":
        return _SMALLEST_FREQUENCY, np.inf
    return (definition.lower, definition.upper) if bounded else (definition.least, np.inf)


class _Problem:
    """The free variables of a fit and where each sits in every swing's values.

    The variables are the shared parameters, then for each swing in turn its own ones and its release where that is free.
    """

    def __init__(self, model, swings, start, bounded, own=(), fixed=None):
        if start not in STARTS:
            raise InputError("fit, start", f"unknown start {start!r}", " or ".join(STARTS))
        self.fixed = dict(fixed or {})
        if unknown := [name for name in (*own, *self.fixed) if name not in model.parameters]:
            raise InputError(
                "fit, own or fixed",
                f"no parameter {unknown[0]!r} in {model.label}",
                ", ".join(model.parameters),
            )
        self.model, self.swings, self.start = model, [checked_swing(*swing) for swing in swings], start
        self.shared = [name for name in model.parameters if name not in own and name not in self.fixed]
        self.own = [name for name in model.parameters if name in own]
        release = ["release_angle", "release_velocity"]
        slots = [*model.parameters, *release]
        each = [*self.own, *(release if start == "free" else [])]
        count = len(self.swings)
        self.free = self.shared + each * count
        self.given = np.tile([self.fixed.get(name, 0.0) for name in slots], (count, 1))
        self.given[:, slots.index("release_angle")] = [angle[0] for _, angle in self.swings]
        self.where = np.full(self.given.shape, -1, dtype=np.int32)
        for k in range(count):
            place = {name: i for i, name in enumerate(self.shared)}
            place |= {name: len(self.shared) + k * len(each) + i for i, name in enumerate(each)}
            self.where[k] = [place.get(name, -1) for name in slots]
        self.n = sum(times.size for times, _ in self.swings)
        if self.n <= len(self.free):
            raise InputError(
                "fit", f"{self.n} samples for {len(self.free)} free values", "more samples than free values"
            )
        limits = {d.name: _limits(d, bounded) for d in model.definitions}
        self.lower, self.upper = np.array(
            [limits.get(name, (-np.inf, np.inf)) for name in self.free]
        ).T.copy()
        self.compiled = [Compiled(model, float(times[-1] - times[0])) for times, _ in self.swings]
        self._point_at_swings()

    def _point_at_swings(self):
        models = [compiled.c for compiled in self.compiled]
        bounds = interface.Bounds(self.lower, self.upper)
        self.c = interface.FitProblem(models, self.swings, self.where, bounds)

    def thinned(self, frequency):
        """The problem with every so many samples only, as many as tell a pendulum of this frequency (rad/s); or itself."""
        seconds = sum(times[-1] - times[0] for times, _ in self.swings)
        shortest = min(times.size for times, _ in self.swings)
        dense = self.n * np.pi / (_DENSE * max(abs(frequency), _SMALLEST_FREQUENCY) * seconds)
        every = int(min(dense, self.n / _ENOUGH, shortest / _DENSE))
        if every < 2:
            return self
        thin = copy(self)
        thin.swings = [(times[::every].copy(), angle[::every].copy()) for times, angle in self.swings]
        thin._point_at_swings()
        return thin

    def variables(self, values, releases):
        """The vector of free variables for parameter values (by name, 0 where absent) and the swings' releases.

        ``values`` is one dict, or one for each swing.
        """
        each = [values] * len(self.swings) if isinstance(values, dict) else values
        slots = np.array([[one.get(name, 0.0) for name in self.model.parameters] + list(release)
                          for one, release in zip(each, releases, strict=True)])  # fmt: skip
        x = np.zeros(len(self.free))
        taken = self.where >= 0
        x[self.where[taken]] = slots[taken]
        return np.clip(x, self.lower, self.upper)

    def slots(self, x):
        """Every swing's values at the free variables: parameters, release angle, release velocity; (swing, slot)."""
        return np.where(self.where >= 0, np.asarray(x)[self.where], self.given)

    def releases(self, x):
        """The (release angle, release velocity) of each swing at the free variables."""
        return [tuple(row[-2:]) for row in self.slots(x)]


def _starts(problem, guess, seen=True):
    """Starting points, and how many of them, at the end, are seen in the data.

    The guess if there is one; the seen decay laid on all damping effects, and on each in turn.
    """
    known = guess if isinstance(guess, (list, tuple)) else [] if guess is None else [guess]
    if not seen and known and not any(isinstance(one, Model) for one in known):
        return np.array([_from_guess(problem, one, ()) for one in known]), 0
    found = [first_guess(times, angle, problem.model.restoring) for times, angle in problem.swings]
    releases = [(g.release_angle, g.release_velocity) for g in found]
    shares = [g.damping(problem.model) for g in found]
    loss = {name: float(np.mean([share[name] for share in shares])) for name in shares[0]}
    frequency = {"natural_frequency": float(np.mean([g.natural_frequency for g in found]))}
    split = frequency | {name: value / max(1, len(loss)) for name, value in loss.items()}
    alone = [
        frequency | {name: value if name == only else 0.0 for name, value in loss.items()} for only in loss
    ]
    starts = [split, *(alone if len(loss) > 1 else [])]
    starts = [problem.variables(values, releases) for values in starts]
    return np.array([*(_from_guess(problem, one, releases) for one in known), *starts]), len(starts)


def _from_guess(problem, guess, releases):
    """The free variables of a model, with the releases seen in the data, or of a fit, with its own."""
    if isinstance(guess, Model):
        return problem.variables(guess.values, releases)
    several = isinstance(guess.release_angle, tuple)
    angles, velocities = (
        value if several else (value,) for value in (guess.release_angle, guess.release_velocity)
    )
    own = guess.own or ({},) * len(angles)
    return problem.variables([guess.model.values | one for one in own], zip(angles, velocities, strict=True))


def _grown(problem, starts, most, tolerance):
    """One more start: the optimum of the first part of every swing, then of ever longer parts.

    Where friction stops the pendulum within the record, the whole record has many minima and its first part few.
    """
    grown, left = starts, _ROUGH_EVALUATIONS
    for share in _PARTS:
        tried = np.vstack([grown, starts]) if share == _TOLD else grown
        *_, outcome = part = _least_squares(
            problem, tried, min(most, left, 30), max(tolerance, _ROUGH), share
        )
        if outcome.converged < 0:
            break
        grown = part[1][None]
        left -= outcome.evaluations
        if left <= 0:
            break
    return grown[:1]


def _from_all(problem, starts, first, most, tolerance, grow=True):
    """The least sum of squares over the whole of every swing, how many starts reached it and how many were tried.

    The ``first`` so many of the starts and the optimum of one part from all of them do where they come to one place at which
    no swing stops: then no start is far off. Else parts are grown into the whole, unless ``grow`` is False, and all starts
    tried. Of many samples a few tell where to: the search among all ends there.
    """
    thin = problem.thinned(float(problem.slots(starts[0])[0, 0]))
    grown, agreed = starts[:0], False
    if first:
        part = _least_squares(thin, starts, min(most, 30), max(tolerance, _ROUGH), _TOLD)
        tried = np.vstack([part[1], starts[:first]])
        rss, best, _, squares, outcome = found = _least_squares(thin, tried, most, tolerance)
        agreed = (
            part[-1].converged > 0
            and outcome.converged > 0
            and not outcome.stops
            and np.all(squares <= rss * (1 + _SAME))
        )
    if not agreed:
        grown = _grown(thin, starts, most, tolerance) if grow else starts[:0]
        tried = np.vstack([grown, starts])
        rss, best, _, squares, _ = found = _least_squares(thin, tried, most, tolerance)
    if thin is not problem:
        found = _least_squares(problem, np.vstack([best, grown]), most, tolerance)
    return found, int(np.sum(squares <= rss * (1 + _SAME))), len(tried)


def _least_squares(problem, starts, most, tolerance, share=1.0):
    """The least sum of squares over a share of every swing: it, where, J'J (near there, for a part), each start's, and how."""
    lengths = [min(times.size, max(_FEWEST, round(share * times.size))) for times, _ in problem.swings]
    options = interface.Options(most, tolerance)
    return interface.fit_swings(engine(), problem.c, problem.given, starts, lengths, options, share == 1)


def _covariance(hessian, rss, freedom, lower, upper, best):
    """s^2 (J'J)^-1 over the variables that no bound holds; NaN for those held or undetermined."""
    free = (best > lower) & (best < upper)
    covariance = np.full(hessian.shape, np.nan)
    scale = np.sqrt(np.diag(hessian))
    free &= scale > 0
    if not free.any():
        return covariance
    scaled = hessian[np.ix_(free, free)] / np.outer(scale[free], scale[free])
    try:
        inverse = np.linalg.inv(scaled)
    except np.linalg.LinAlgError:
        return covariance
    if np.linalg.cond(scaled) < 1e15:
        covariance[np.ix_(free, free)] = inverse / np.outer(scale[free], scale[free]) * rss / freedom
    return covariance


def _result(problem, method, best, covariance, rss, converged, message, evaluations):
    names, slots = problem.model.parameters, problem.slots(best)
    errors = dict(zip(problem.free, np.sqrt(np.diag(covariance)), strict=True))
    values = {
        name: float(value)
        for name, value in zip(
            names, (slots[:, :-2].mean(axis=0) if problem.own else slots[0, :-2]), strict=True
        )
    }
    model = problem.model.with_values(values, {name: float(errors[name]) for name in problem.shared})
    each = [model] * len(slots)
    if problem.own:
        each = [model.with_values(dict(zip(names, map(float, row[:-2]), strict=True))) for row in slots]
    series = tuple(
        simulate(one, times, *row[-2:])
        for one, (times, _), row in zip(each, problem.swings, slots, strict=True)
    )
    spread = tuple(
        float(np.sqrt(np.mean((fit - y) ** 2))) for fit, (_, y) in zip(series, problem.swings, strict=True)
    )
    own = tuple({name: one.values[name] for name in problem.own} for one in each)
    angles, velocities = (tuple(map(float, column)) for column in slots[:, -2:].T)
    return Fit(model, method, tuple(problem.free), best, covariance, float(rss), problem.n, angles, velocities, series, spread,
               bool(converged), message, int(evaluations), own)  # fmt: skip


def _single(fit):
    parts = {
        name: getattr(fit, name)[0] for name in ("release_angle", "release_velocity", "angle", "swing_rms")
    }
    return Fit(**{name: getattr(fit, name) for name in fit.__dataclass_fields__} | parts)


def fit_jointly(effects, swings, *, start="free", guess=None, restoring="sine", form="consistent", bounded=False,
                own=(), fixed=None, seen=True, grown=True, most=200, tolerance=1e-10):  # fmt: skip
    """The ``Fit`` of one model to several swings at once: shared parameters, each swing its own release.

    ``effects`` a label or names; ``swings`` a list of (times in s, angles in rad). ``start``: ``free`` fits each
    release angle and velocity, ``rest`` starts each swing at rest at its first sample. ``guess``: a model or a fit, or
    several, to start from besides the decay seen in the data. ``bounded`` keeps parameters within the catalogue's bounds. ``own``
    names parameters that each swing has for itself, such as a phase; ``fixed`` holds values, by name, that are not fitted.
    ``seen=False`` leaves out the starts from the decay where there are fits to start from, ``grown=False`` the one that is
    found by fitting ever longer parts of the swings. ``most`` evaluations a start are
    spent, fewer where a trajectory takes far more work than those of a pendulum usually do; ``converged`` tells.
    Raises InputError for swings that cannot be fitted and TrajectoryError where no start gives a trajectory.
    """
    problem = _Problem(Model(effects, restoring=restoring, form=form), swings, start, bounded, own, fixed)
    starts, from_data = _starts(problem, guess, seen)
    first = len(starts) - from_data + 1 if from_data else 0
    found, agreeing, tried = _from_all(problem, starts, first, most, tolerance, grown)
    rss, best, hessian, _, outcome = found
    if outcome.converged < 0:
        raise TrajectoryError(f"model {problem.model.label}: no start of {tried} gives a trajectory")
    message = f"{agreeing} of {tried} starts reached the best optimum; "
    message += (
        "stationary" if outcome.converged else f"not stationary after {outcome.evaluations} evaluations"
    )
    covariance = _covariance(hessian, rss, problem.n - len(problem.free), problem.lower, problem.upper, best)
    return _result(
        problem, "least squares", best, covariance, rss, outcome.converged, message, outcome.evaluations
    )


def fit_trajectory(effects, times, angle, **options):
    """The ``Fit`` of a model to one swing by trajectory least squares; options as in ``fit_jointly``."""
    return _single(fit_jointly(effects, [(times, angle)], **options))


def fit_nelder_mead(effects, times, angle, *, start="free", guess=None, restoring="sine", form="consistent", bounded=False,
                    restarts=20):  # fmt: skip
    """The ``Fit`` of a model to one swing by the Nelder-Mead simplex, as in the paper, restarted until stationary.

    Options as in ``fit_trajectory``. A simplex with steps in proportion to each value is started again from where the
    last one ended until that gains less than 1e-8 of the sum of squares; ``message`` says how many it took.
    """
    from scipy.optimize import minimize  # here, because it takes longer to import than most fits to run

    problem = _Problem(Model(effects, restoring=restoring, form=form), [(times, angle)], start, bounded)
    (times, angle) = problem.swings[0]
    model = problem.model

    def squares(x):
        if np.any(x < problem.lower) or np.any(x > problem.upper):
            return np.inf
        try:
            *values, release_angle, release_velocity = problem.slots(x)[0]
            one = model.with_values(dict(zip(model.parameters, values, strict=True)))
            fitted = simulate(one, times, release_angle, release_velocity)
        except TrajectoryError:
            return np.inf
        return float(np.sum((fitted - angle) ** 2))

    best = min(_starts(problem, guess)[0], key=squares)
    # steps in proportion to each value; a coefficient that starts at zero still gets a step of its usual size
    scale = np.maximum(
        np.abs(best), [*(d.typical for d in model.definitions), *[0.1] * (best.size - len(model.parameters))]
    )
    value, evaluations, converged, step = squares(best), 0, False, 0.05
    for count in range(1, restarts + 1):
        origin = best / scale
        found = minimize(
            lambda z: squares(z * scale), origin, method="Nelder-Mead",
            options={"initial_simplex": np.vstack([origin, origin + step * np.eye(best.size)]), "xatol": 1e-6, "fatol": 1e-9 * value,
                     "maxfev": 4000},
        )  # fmt: skip
        evaluations += found.nfev
        gain = value - found.fun
        if gain > 0:
            value, best = float(found.fun), found.x * scale
        if count > 1 and gain <= 1e-8 * value:
            converged = True
            break
        step = -0.4 * step
    covariance = _slopes_covariance(problem, best, value)
    message = (
        f"stationary after {count} simplexes" if converged else f"not stationary after {restarts} simplexes"
    )
    return _single(_result(problem, "Nelder-Mead", best, covariance, value, converged, message, evaluations))


@dataclass(frozen=True)
class BatchFit:
    """Many series fitted alike: ``values`` (series, free), and of each series rss (rad^2), converged, evaluations."""

    free: tuple
    values: np.ndarray
    rss: np.ndarray
    converged: np.ndarray
    evaluations: np.ndarray


def fit_batch(guess, times, series, release_angle, release_velocity=0.0, *, start="free", bounded=False, workers=1,
              most=100, tolerance=1e-10):  # fmt: skip
    """The ``BatchFit`` of one model to each of many series of angles over the same times, for Monte-Carlo studies.

    ``guess`` is the model with the values to start from, ``release_angle`` (rad) and ``release_velocity`` (rad/s) the
    release to start from; ``series`` in rad, of shape (series, n). ``workers`` threads share the series; the numbers do
    not depend on how many. Raises InputError for arrays that do not fit together.
    """
    times, series = checked_times(times), np.ascontiguousarray(series, dtype=float)
    if series.ndim != 2 or series.shape[1] != times.size or not np.all(np.isfinite(series)):
        raise InputError(
            "series", f"an array of shape {series.shape}", f"finite angles of shape (any, {times.size})"
        )
    size, count = len(guess.parameters), len(series)
    free = guess.parameters + (("release_angle", "release_velocity") if start == "free" else ())
    first = np.array([*guess.vector(), release_angle, release_velocity], dtype=float)
    starts = np.tile(first, (count, 1))
    starts[:, size] = release_angle if start == "free" else series[:, 0]
    limits = [_limits(d, bounded) for d in guess.definitions] + [(-np.inf, np.inf)] * 2
    lower, upper = np.array(limits).T.copy()
    compiled = Compiled(guess, float(times[-1] - times[0]))
    where = np.arange(size + 2, dtype=np.int32)
    where[len(free) :] = -1
    values, rss = np.zeros((count, len(free))), np.zeros(count)
    converged, evaluations = np.zeros(count, dtype=np.int32), np.zeros(count, dtype=np.int32)
    library, options = engine(), interface.Options(most, tolerance)
    bounds = interface.Bounds(lower[: len(free)], upper[: len(free)])

    def work(part):
        into = interface.BatchResult(values[part], rss[part], converged[part], evaluations[part])
        interface.fit_batch(
            library, compiled.c, times, series[part], starts[part], where, bounds, options, into
        )

    edges = np.linspace(0, count, min(workers, count) * 8 + 1).astype(int) if workers > 1 else [0, count]
    parts = [slice(int(a), int(b)) for a, b in zip(edges, edges[1:], strict=False) if b > a]
    if len(parts) > 1:
        with ThreadPoolExecutor(workers) as pool:
            list(pool.map(work, parts))
    elif parts:
        work(parts[0])
    return BatchFit(free, values, rss, converged == 1, evaluations)


def _slopes_covariance(problem, best, rss):
    (times, _), (*values, release_angle, release_velocity) = problem.swings[0], problem.slots(best)[0]
    model = problem.model.with_values(dict(zip(problem.model.parameters, values, strict=True)))
    _, slopes = sensitivities(model, times, release_angle, release_velocity, free=problem.free)
    return _covariance(
        slopes @ slopes.T, rss, problem.n - len(problem.free), problem.lower, problem.upper, best
    )
