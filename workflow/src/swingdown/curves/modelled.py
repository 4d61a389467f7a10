"""Period and loss against amplitude of a model, half-swing by half-swing as they are measured, with what its parameters leave open."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from scipy.interpolate import CubicSpline

from ..arrays import Floats
from ..engine.trajectory import TrajectoryError, simulate
from ..pendulum.catalogue import RATE
from ..pendulum.effect import NATURAL_FREQUENCY
from ..pendulum.formula import evaluate
from ..pendulum.ideal import lengthening
from ..pendulum.model import Model
from ..studies.quantities import steady

_SAMPLES = 400  # of a half-swing: a turning point lies between two, and Newton's step from them ends within 1e-9 of it
_NEAR = 1e-4  # rad
_RELEASES = 10
_STEP = 0.1  # of a standard error: the differences that uncertainties follow from


def static(model: Model) -> Callable[[Floats], Floats]:
    """The torque over inertia (rad/s²) of a model at rest at an angle (rad), its friction left out."""
    given = {"thetadot": 0.0, "thetaddot": 0.0, "t": 0.0, "duration": 1.0}
    given |= {"omega_n": model.values[NATURAL_FREQUENCY.name]}
    given |= {one.symbol: model.values[one.name] for one in model.definitions}
    given |= {state.symbol: 0.0 for effect in model.effects for state in effect.states}
    terms = [model.gravity.term, *(effect.term for effect in model.effects if effect.acts_on == "torque")]

    def torque(angle: Floats) -> Floats:
        each = [evaluate(term, theta=angle, **given) for term in terms]
        return np.sum(np.broadcast_arrays(angle, *each)[1:], axis=0)

    return torque


def _rest(model: Model) -> float:
    """Where a model hangs (rad): the zero of its static torque beside 0."""
    torque = static(model)
    place = 0.0
    for _ in range(20):  # Newton's steps
        about = torque(np.array([place - _NEAR, place, place + _NEAR]))
        slope = (about[2] - about[0]) / (2 * _NEAR)
        if not slope < 0:
            return 0.0
        place -= float(about[1] / slope)
        if abs(about[1] / slope) < 1e-12:
            break
    return place if abs(place) < 1 else 0.0


class Course(NamedTuple):
    """What a model's half-swings do by amplitude (rad): ``loss`` of the logarithm of the amplitude in a half-swing, at the root of the
    product of its two turning points; ``period`` (s), twice the time between passages through the middle, or between turning points."""

    amplitude: Floats
    loss: Floats
    period_amplitude: Floats
    period: Floats

    def at(self, amplitude: Floats) -> tuple[Floats, Floats]:
        """Loss and period (s) at these amplitudes (rad), nan beyond those that were computed."""
        if self.amplitude.size < 4:
            return np.full(amplitude.size, np.nan), np.full(amplitude.size, np.nan)
        loss = CubicSpline(self.amplitude, self.loss, extrapolate=False)
        period = CubicSpline(self.period_amplitude, self.period, extrapolate=False)
        return loss(amplitude), period(amplitude)


def course(model: Model, low: float, high: float, passages: bool = True) -> Course:
    """The ``Course`` of a model, without what its sensor does and what changes with time, between these amplitudes (rad)."""
    return course_of(steady(model.motion), low, high, passages)


def course_of(bare: Model, low: float, high: float, passages: bool = True) -> Course:
    """The ``Course`` of a model that has nothing but its motion."""
    middle = _rest(bare)
    releases = np.geomspace(0.97 * low, 1.03 * high, _RELEASES) * _ahead(bare, high, middle)
    found = [_two(bare, release + middle, passages, middle) for release in releases]
    kept = np.array([one for one in found if one is not None]).reshape(-1, 4)
    kept = kept[kept[:, 0].argsort()]
    rising = np.append([True], np.diff(kept[:, [0, 2]], axis=0).min(axis=1) > 0)[: len(kept)]
    return Course(*kept[rising].T)


def _ahead(model: Model, high: float, middle: float) -> Floats:
    """How much further than a swing of that amplitude each release is: as much as half a half-swing takes, and a whole one at the largest."""
    first = _two(model, min(high, 3.0), False, middle)
    loss = first[1] if first else 0.0
    return np.linspace(1.0, np.exp(min((1.5 + _late(model)) * loss, 0.5)), _RELEASES)


def _late(model: Model) -> int:
    """How many half-swings after its release a model swings as it goes on: what winds up begins unwound."""
    return 1 if any(effect.states for effect in model.effects) else 0


def _two(
    model: Model, release: float, passages: bool, middle: float
) -> tuple[float, float, float, float] | None:
    """Amplitude and loss of the half-swing from rest at ``release`` (rad), amplitude and period of the one in the middle of which it ends; None where it
    does not come back."""
    if not 0 < release < 3.1:
        return None
    frequency = model.values[NATURAL_FREQUENCY.name]
    half = np.pi / frequency * (float(lengthening(release)) if model.restoring == "sine" else 1.0)
    late = _late(model)
    times = half / _SAMPLES * np.arange(int((2.8 + late) * _SAMPLES))
    try:
        ends = _zeros(times, simulate(model.of(RATE), times, release))[: 2 + late]
        if ends.size < 2 + late:
            return None
        turns = simulate(model, np.concatenate([[0.0], ends]), release)[late:]
        through = _zeros(times, simulate(model, times, release) - middle)[late:] if passages else ends
    except TrajectoryError:
        return None
    size = np.abs(turns - middle)
    if through.size < 2 or not size[0] > size[1] > 0:
        return None
    amplitude, loss = float(np.sqrt(size[0] * size[1])), float(np.log(size[0] / size[1]))
    if passages:
        return amplitude, loss, float(size[1]), 2 * float(through[1] - through[0])
    return amplitude, loss, amplitude, 2 * float(ends[late] - (ends[late - 1] if late else 0.0))


def _zeros(times: Floats, values: Floats) -> Floats:
    """Times (s) after the first sample at which a smooth series passes zero, by a cubic through four samples."""
    before = np.flatnonzero(values[1:-1] * values[2:] < 0) + 1
    found = []
    for k in before[(before > 1) & (before < times.size - 2)]:
        rows = slice(k - 1, k + 1)
        # from the side before it: where friction turns round the slope has a step
        slope = np.diff(values[rows])[0] / np.diff(times[rows])[0]
        bend = np.diff(values[k - 2 : k + 1], 2)[0] / (times[1] - times[0]) ** 2
        slope += bend * (times[1] - times[0]) / 2
        late = -values[k] / slope
        for _ in range(4):
            late = -values[k] / (slope + bend * late / 2)
        found.append(times[k] + late)
    return np.array(found)


def with_band(model: Model, covariance: Floats, derived: Callable[[Model], Floats]) -> tuple[Floats, Floats]:
    """What is ``derived`` from a model, and its covariance by that of the parameters (JCGM 100, 5.2); nan in it counts as known."""
    values = np.array(model.vector())
    known = np.where(np.isfinite(covariance), covariance, 0.0)
    errors = np.sqrt(np.diag(known))
    whole = derived(model)
    slopes = np.zeros((whole.size, values.size))
    for k in np.flatnonzero(errors > 0):
        step = np.zeros(values.size)
        step[k] = _STEP * errors[k]
        ends = [
            derived(
                model.with_values(dict(zip(model.parameters, map(float, values + sign * step), strict=True)))
            )
            for sign in (1, -1)
        ]
        slopes[:, k] = (ends[0] - ends[1]) / (2 * step[k])
    return whole, slopes @ known @ slopes.T
