"""Least squares on turning points alone: when a pendulum turns, and how far from its middle it is then.

What lies between two turning points is computed by the engine and is not in the data. The two kinds of residuals, of times
and of angles, each have a scatter of their own, which the fit finds (restricted maximum likelihood).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from scipy.optimize import least_squares
from scipy.special import stdtrit

from ..arrays import Floats
from ..engine.trajectory import TrajectoryError, sensitivities, simulate
from ..errors import InputError
from ..pendulum.catalogue import RATE
from ..pendulum.effect import NATURAL_FREQUENCY
from ..pendulum.half_swings import lengthening
from ..pendulum.model import Model
from ..pendulum.slack import time_power
from ..quantisation import rounding
from .coloured_noise import autoregression, weighted
from .guess import Guess
from .nested import unseen

_SAMPLES = 24  # a period, between which turning points are looked for
_ROUNDS = 8  # of fits, each with the scatter that the one before left
_HALVED = 6  # times that a start's damping is halved
_ROUGHLY, _WELL = 1e-5, 1e-10  # tolerances: of the fits that tell which start is best, and of those after it
_SETTLED = 1e-3  # change of a scatter, as a share, that ends them
_LOST = 1e6  # standard deviations: what a motion that cannot be computed is off
_UNITS = {"release_angle": "rad", "first": "s", "zero": "rad"}


class Turns(NamedTuple):
    """Turning points: their times (s), how many half-swings after the first each is, and their angles (rad), of which every second
    half-swing's are below 0.

    ``timed`` is False where nobody wrote times: those here are made up of the count. ``both`` is True where both sides were
    written, so that the middle is seen. ``u_times`` and ``u_angles`` are stated standard uncertainties, nan where there are none;
    ``time_step`` and ``angle_step`` those in which the readings come, 0 where they come in none.
    """

    times: Floats
    halves: np.ndarray
    angles: Floats
    timed: bool = True
    both: bool = False
    u_times: float = np.nan
    u_angles: float = np.nan
    time_step: float = 0.0
    angle_step: float = 0.0


@dataclass(frozen=True)
class TurnsFit:
    """A model fitted to turning points. ``free`` names the fitted values: parameters of the model, ``release_angle`` (the first
    turning point's, rad), its time ``first`` (s) where there are times, and the ``zero`` (rad) of readings of both sides.

    ``random`` is their covariance by the scatter of times and angles, with its colour and rounding; ``systematic`` what the
    clock does to each. ``factors`` are the k of intervals that hold each value with 95 %. ``angles`` and ``times`` are what the
    fit makes of each turning point, ``scatter`` the standard deviation of times (s) and angles (rad) about that. ``inflation``: the
    number of angles over the number that counts as independent.
    """

    model: Model
    turns: Turns
    free: tuple[str, ...]
    values: Floats
    random: Floats
    systematic: Floats
    factors: Floats
    angles: Floats
    times: Floats
    scatter: tuple[float, float]
    inflation: float
    rss: tuple[float, float]
    converged: bool
    evaluations: int

    @property
    def known(self) -> dict[str, float]:
        """The fitted values by name."""
        return dict(zip(self.free, map(float, self.values), strict=True))

    @property
    def covariance(self) -> Floats:
        """Random and systematic covariance together."""
        return self.random + np.outer(self.systematic, self.systematic)

    @property
    def bic(self) -> float:
        """Bayesian information criterion of times and angles, each with a scatter of its own."""
        n = self.turns.angles.size
        parts = [n * np.log(one / n) for one in (self.rss if self.turns.timed else self.rss[1:])]
        return float(sum(parts) + len(self.free) * np.log(n * len(parts)))


class Unmet(InputError):
    """Turning points that no swing of a model meets: another model's may."""


class _Course(NamedTuple):
    """What a model makes of turning points: times after the first (s) and angles (rad), and their slopes (value, point)."""

    times: Floats
    angles: Floats
    time_slopes: Floats
    angle_slopes: Floats


def fit_turns(
    model: Model, turns: Turns, guesses: Sequence[Mapping[str, float]] = (), clock: float = 0.0
) -> TurnsFit:
    """The ``TurnsFit`` of a model to turning points.

    Parameters
    ----------
    model
        The model; its values are not used.
    turns
        The turning points.
    guesses
        Values by name (0 where absent), from which it starts too.
    clock
        Standard uncertainty of the clock's rate, as a share.

    Raises
    ------
    InputError
        For too few turning points; ``Unmet`` where no swing of the model meets them.
    """
    fewest = len(model.parameters) + 2  # a first angle, and two more to tell their scatter
    if turns.angles.size < fewest:
        problem = f"there are {turns.angles.size} of them"
        raise InputError("turning points", problem, f"at least {fewest}", "write down more of them")
    free = _free(model, turns)
    # to begin with, a hundredth of the half-swing and of the largest angle
    half = float(np.median(np.diff(turns.times) / np.diff(turns.halves)))
    scatter = 0.01 * half, 0.01 * float(np.abs(turns.angles).max())
    starts = [np.array([one.get(name, 0.0) for name in free]) for one in guesses]
    if not (unseen(model) and guesses):
        starts = [_start(model, turns, free), *starts]
    tried = [_least(model, turns, free, start, scatter, _ROUGHLY) for start in starts]
    best = min(tried, key=lambda one: one.cost)
    evaluations = sum(one.nfev for one in tried)
    if not best.cost < _LOST**2 / 4:
        problem = f"no swing of the model {model.label} meets them"
        raise Unmet("turning points", problem, "those of a pendulum", "check units and kind")
    for _ in range(_ROUNDS):
        before, scatter = scatter, _scatter(turns, best.jac, best.fun, scatter)
        best = _least(model, turns, free, best.x, scatter)
        evaluations += best.nfev
        if all(abs(new / old - 1) < _SETTLED for new, old in zip(scatter, before, strict=True)):
            break
    return _found(model, turns, free, best, scatter, clock, evaluations)


def _free(model: Model, turns: Turns) -> tuple[str, ...]:
    parameters, first = (model.parameters, ("first",)) if turns.timed else (model.parameters[1:], ())
    return (*parameters, "release_angle", *first, *(("zero",) if turns.both else ()))


def frequency_of(turns: Turns, restoring: str) -> float:
    """The natural frequency (rad/s) from a straight line through the times over the half-swings.

    Each half-swing counts for as much as weight makes it longer at its amplitude.
    """
    size = np.abs(turns.angles)
    longer = lengthening((size[1:] + size[:-1]) / 2) if restoring == "sine" else 1.0
    passed = np.concatenate([[0.0], np.cumsum(np.diff(turns.halves) * longer)])
    return float(np.pi / np.polyfit(passed, turns.times, 1)[0])


def _start(model: Model, turns: Turns, free: Sequence[str]) -> Floats:
    frequency = frequency_of(turns, model.restoring)
    size = np.abs(turns.angles)
    loss = max((size[0] - size[-1]) / turns.halves[-1], 1e-6 * size[0])
    seen = Guess(frequency, size[0], 0.0, float(np.median(size)), loss)
    terms = len(model.effects)  # each explains its share of the loss
    known = {name: value / terms for name, value in seen.damping(model).items()}
    known |= {NATURAL_FREQUENCY.name: frequency, "release_angle": turns.angles[0]}
    known |= {"first": turns.times[0], "zero": 0.0}
    for one in model.definitions:
        if one.name not in known:
            known[one.name] = next(iter(one.starting_values(frequency)), 0.0)
    at = np.array([known[name] for name in free])
    damped = [free.index(name) for name in model.parameters[1:]]
    for _ in range(_HALVED):  # more damping than there is stops it before its last turning point
        if _course(model, turns, free, at) is not None:
            break
        at[damped] /= 2
    return at


def _least(
    model: Model, turns: Turns, free: Sequence[str], start: Floats, scatter: tuple[float, float], tolerance: float = _WELL
) -> Any:  # fmt: skip
    kept: dict[bytes, tuple[Floats, Floats]] = {}

    def both(x: Floats) -> tuple[Floats, Floats]:
        key = x.tobytes()
        if key not in kept:
            kept.clear()
            kept[key] = _residuals(model, turns, free, x, scatter)
        return kept[key]

    return least_squares(
        lambda x: both(x)[0],
        start,
        lambda x: both(x)[1],
        x_scale="jac",
        xtol=tolerance,
        ftol=tolerance,
        gtol=tolerance,
        max_nfev=200,
    )


def _residuals(
    model: Model, turns: Turns, free: Sequence[str], x: Floats, scatter: tuple[float, float]
) -> tuple[Floats, Floats]:
    """The residuals of times (where there are any) and angles over their scatter, and their slopes (residual, value)."""
    course = _course(model, turns, free, x)
    size = turns.angles.size
    if course is None:
        count = 2 * size if turns.timed else size
        return np.full(count, _LOST), np.zeros((count, len(free)))
    at = dict(zip(free, x, strict=True))
    angle = (turns.angles - course.angles - at.get("zero", 0.0)) / scatter[1]
    angle_slopes = -course.angle_slopes / scatter[1]
    if "zero" in at:
        angle_slopes[free.index("zero")] = -1 / scatter[1]
    if not turns.timed:
        return angle, angle_slopes.T
    time = (turns.times - at["first"] - course.times) / scatter[0]
    time_slopes = -course.time_slopes / scatter[0]
    time_slopes[free.index("first")] = -1 / scatter[0]
    return np.concatenate([time, angle]), np.hstack([time_slopes, angle_slopes]).T


def _course(model: Model, turns: Turns, free: Sequence[str], x: Floats) -> _Course | None:
    """The ``_Course`` at these values; None where it cannot be computed, or the pendulum stops before the last turning point."""
    at = dict(zip(free, x, strict=True))
    held = {} if turns.timed else {NATURAL_FREQUENCY.name: _COUNTED}
    one = model.with_values({name: float(at.get(name, held.get(name, np.nan))) for name in model.parameters})
    release = float(at["release_angle"])
    chosen = [name for name in free if name not in ("first", "zero")]
    rows, size = [free.index(name) for name in chosen], turns.angles.size
    turning, slopes = one.of(RATE), np.zeros((2, len(free), size))
    try:
        times = _about(turning, release, int(turns.halves[-1]))
        if times is None:
            return None
        whole = np.concatenate([[0.0], times[turns.halves[1:] - 1]])
        pull = _pull(one, simulate(one, whole, release)[1:])
        for _ in range(2):  # Newton's steps
            whole[1:] -= simulate(turning, whole, release)[1:] / pull
        angle, slopes[1][rows] = sensitivities(one, whole, release, free=chosen)
        speed_slopes = sensitivities(turning, whole, release, free=chosen)[1]
    except (TrajectoryError, InputError):
        return None
    slopes[0][np.ix_(rows, range(1, size))] = -speed_slopes[:, 1:] / _pull(one, angle[1:])
    slopes[1][:, 0] = 0.0
    slopes[1][free.index("release_angle"), 0] = 1.0
    return _Course(whole, angle, slopes[0], slopes[1])


def _about(turning: Model, release: float, count: int) -> Floats | None:
    """The times (s) of the first ``count`` turning points after a release at rest, to a part of a sample; None where there are fewer."""
    frequency = turning.values[NATURAL_FREQUENCY.name]
    if not (frequency > 0 and 0 < abs(release) < 3.1):
        return None
    longer = float(lengthening(release)) if turning.restoring == "sine" else 1.0
    longest = (count + 2) * np.pi / frequency * longer
    times = np.arange(0.0, longest, 2 * np.pi / frequency / _SAMPLES)
    speed = simulate(turning, times, release)
    before = np.flatnonzero(speed[1:-1] * speed[2:] < 0)[:count] + 1
    if before.size < count:
        return None
    return times[before] + (times[1] - times[0]) * speed[before] / (speed[before] - speed[before + 1])


_COUNTED = 2 * np.pi  # rad a swing: the clock of a count


def _pull(model: Model, angle: Floats) -> Floats:
    """The angular acceleration (rad/s^2) at rest at an angle, friction left out; never 0."""
    lever = np.sin(angle) if model.restoring == "sine" else angle
    pull = -(model.values[NATURAL_FREQUENCY.name] ** 2) * lever
    return np.where(np.abs(pull) > 1e-12, pull, 1e-12)


def _scatter(
    turns: Turns, slopes: Floats, residuals: Floats, scatter: tuple[float, float]
) -> tuple[float, float]:
    """The standard deviation of times (s) and of angles (rad) that residuals and slopes (over ``scatter``) tell: restricted maximum
    likelihood. Nowhere below what is stated, nor below that of the rounding."""
    size = turns.angles.size
    parts = np.split(np.arange(residuals.size), [size]) if turns.timed else [np.arange(0), np.arange(size)]
    leverage = np.einsum("ij,ij->i", slopes @ np.linalg.pinv(slopes.T @ slopes), slopes)
    found = []
    floors = ((turns.u_times, turns.time_step), (turns.u_angles, turns.angle_step))
    for part, one, (stated, step) in zip(parts, scatter, floors, strict=True):
        floor = max(np.nan_to_num(stated), step / np.sqrt(12))
        if not part.size:
            found.append(one)
            continue
        left = max(part.size - float(leverage[part].sum()), 0.5)
        found.append(max(one * float(np.sqrt(residuals[part] @ residuals[part] / left)), floor, 1e-9 * one))
    return found[0], found[1]


def _found(
    model: Model,
    turns: Turns,
    free: tuple[str, ...],
    best: Any,
    scatter: tuple[float, float],
    clock: float,
    evaluations: int,
) -> TurnsFit:
    """The ``TurnsFit`` at an optimum, with the sandwich A S A of its random covariance and the degrees of freedom by value."""
    course = _course(model, turns, free, best.x)
    assert course is not None
    at = dict(zip(free, map(float, best.x), strict=True))
    size = turns.angles.size
    jacobian, residuals = best.jac, best.fun
    scale = np.sqrt(np.einsum("ij,ij->j", jacobian, jacobian))
    scale = np.where(scale > 0, scale, 1.0)
    scaled = jacobian / scale
    inverse = np.linalg.pinv(scaled.T @ scaled, hermitian=True)
    leverage = np.einsum("ij,jk,ik->i", scaled, inverse, scaled)
    steps = (turns.time_step, turns.angle_step)
    places = (course.times + at.get("first", 0.0), course.angles)
    parts = [slice(0, size), slice(size, None)] if turns.timed else [slice(0, 0), slice(0, None)]
    variances, freedoms, inflation = [], [], 1.0
    for part, one, step, place in zip(parts, scatter, steps, places, strict=True):
        own, left = scaled[part], residuals[part]
        if not own.size:
            continue
        scores, inflation = middle(own, left, step / one, place / one)
        variances.append(inverse @ scores @ inverse)
        freedoms.append(max((left.size - float(leverage[part].sum())) / inflation, 1.0))
    random = sum(variances) / np.outer(scale, scale)
    shares = np.array([np.diag(one) for one in variances])
    with np.errstate(invalid="ignore", divide="ignore"):
        freedom = shares.sum(axis=0) ** 2 / np.sum(shares**2 / np.array(freedoms)[:, np.newaxis], axis=0)
    units = model.units | _UNITS
    systematic = np.array(
        [time_power(units[name]) * at[name] * clock if name in model.units else 0.0 for name in free]
    )
    named = {name: at[name] for name in model.parameters if name in at}
    if not turns.timed:
        named[NATURAL_FREQUENCY.name] = _COUNTED
    errors = dict(zip(free, np.sqrt(np.diag(random) + systematic**2), strict=True))
    whole = model.with_values(named, {name: float(errors[name]) for name in named if name in errors})
    times, angles = course.times + at.get("first", 0.0), course.angles + at.get("zero", 0.0)
    rss = float(np.sum((turns.times - times) ** 2)), float(np.sum((turns.angles - angles) ** 2))
    return TurnsFit(
        whole, turns, free, best.x, random, systematic, stdtrit(freedom, 0.975), angles, times, scatter, inflation, rss,
        bool(best.status > 0), evaluations,
    )  # fmt: skip


def middle(slopes: Floats, residuals: Floats, step: float, place: Floats) -> tuple[Floats, float]:
    """The covariance of slopes times residuals, both over the scatter, with the residuals' colour and what rounding to ``step`` adds; and
    the variance of slow errors over that of independent ones, at least 1."""
    power, independent = float(residuals @ residuals) / residuals.size, slopes.T @ slopes
    if not power > 0:
        return independent, 1.0
    before = np.sqrt(max(0.0, 1 - step**2 / 12))  # the scatter without the rounding
    rounded = rounding(slopes.T, place, step, before) if step else 0.0
    if step**2 / 12 > 0.5:  # most of the error is the rounding's own, of which all is known
        return independent + rounded, 1.0
    colour = autoregression([residuals])
    slow = float(colour.spectrum(2 * residuals.size)[0]) / power
    if slow <= 1:  # a fit takes slow errors out of its residuals: fewer of these than of others say nothing
        return independent, 1.0
    return weighted(slopes.T, colour) / power + rounded, slow
