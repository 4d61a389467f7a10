"""Period and loss against amplitude of a model, half-swing by half-swing as they are measured, with what its parameters leave open."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from scipy.interpolate import CubicSpline

from ..arrays import Floats
from ..engine.trajectory import TrajectoryError, simulate, simulate_each
from ..pendulum.catalogue import RATE
from ..pendulum.effect import NATURAL_FREQUENCY
from ..pendulum.model import Model
from ..pendulum.static import resting
from .torques import Ideal

_SAMPLES = 400  # of a half-swing: a turning point lies between two, and Newton's step from them ends within 1e-9 of it
_RELEASES = 24  # a spline through them is within 1e-4 of a loss by a brake a fifth as wide as the swing
_STEP = 0.1  # of a standard error: the differences that uncertainties follow from

_Half = tuple[float, float, float, float]
_NONE: _Half = (np.nan,) * 4


class Course(NamedTuple):
    """What a model's half-swings do by amplitude (rad): ``loss`` of the logarithm of the amplitude in a half-swing, at the root of the
    product of its two turning points; ``period`` (s), twice the time between passages through the middle, or between turning points; ``ideal``
    without friction and all that is beside the weight."""

    amplitude: Floats
    loss: Floats
    period_amplitude: Floats
    period: Floats
    ideal: Ideal

    def at(self, amplitude: Floats) -> tuple[Floats, Floats]:
        """Loss and period (s) at these amplitudes (rad), nan beyond those that were computed."""
        if self.amplitude.size < 4:
            return np.full(amplitude.size, np.nan), np.full(amplitude.size, np.nan)
        loss = CubicSpline(np.log(self.amplitude), np.log(self.loss), extrapolate=False)
        longer, at = self.ideal.lengthening, self.period_amplitude
        period = CubicSpline(at, self.period / longer(at), extrapolate=False)
        return np.exp(loss(np.log(amplitude))), period(amplitude) * longer(amplitude)


def course_of(
    bare: Model, low: float, high: float, passages: bool = True, releases: int = _RELEASES
) -> Course:
    """The ``Course`` of a model that has nothing but its motion, between two amplitudes (rad), by as many ``releases``; its period is that
    between ``passages`` through the middle, or between turning points."""
    middle = resting(bare)
    begun = np.geomspace(0.97 * low, 1.03 * high, releases) * _ahead(bare, high, middle, releases)
    # where the middle is moved, a swing goes further and takes longer on one side of it than on the other
    sides = [middle + begun, middle - begun] if middle else [begun]
    found = np.array(_two(bare, np.concatenate(sides), passages, middle))
    kept = np.mean([found[k : k + releases] for k in range(0, len(found), releases)], axis=0)
    kept = kept[kept[:, 1] > 0]
    kept = kept[kept[:, 0].argsort()]
    rising = np.append([True], np.diff(kept[:, [0, 2]], axis=0).min(axis=1) > 0)[: len(kept)]
    amplitude, loss, period_amplitude, period = kept[rising].T
    return Course(amplitude, loss, period_amplitude, period, Ideal(bare.restoring))


def _ahead(model: Model, high: float, middle: float, releases: int) -> Floats:
    """How much further than a swing of that amplitude each release is: as much as half a half-swing takes, and a whole one at the largest."""
    (first,) = _two(model, np.array([min(high, 3.0)]), False, middle)
    loss = first[1] if first[1] > 0 else 0.0
    return np.linspace(1.0, np.exp(min((1.5 + _late(model)) * loss, 0.5)), releases)


def _late(model: Model) -> int:
    """How many half-swings after its release a model swings as it goes on: what winds up begins unwound."""
    return 1 if any(effect.states for effect in model.effects) else 0


def _two(model: Model, releases: Floats, passages: bool, middle: float) -> list[_Half]:
    """Of each release from rest (rad) amplitude and loss of its half-swing, amplitude and period of the one in the middle of which that ends;
    nan where it does not come back."""
    usable = np.abs(releases) < 3.1
    if not usable.any():
        return [_NONE] * releases.size
    half = np.pi / model.values[NATURAL_FREQUENCY.name] * Ideal(model.restoring).lengthening(releases[usable])
    step = float(half.min()) / _SAMPLES
    times = step * np.arange(int((2.8 + _late(model)) * float(half.max()) / step))
    rows = np.array([[*model.vector(), release, 0.0] for release in releases])
    rates = simulate_each(model.of(RATE), times, rows)
    angles = simulate_each(model, times, rows) if passages else rates
    every = zip(releases, usable, rates, angles, strict=True)
    return [
        _one(model, float(release), times, (rate, angle if passages else None), middle) if good else _NONE
        for release, good, rate, angle in every
    ]


def _one(
    model: Model, release: float, times: Floats, swing: tuple[Floats, Floats | None], middle: float
) -> _Half:
    """The same of one release, by its rates (rad/s) and, where passages tell the period, its angles (rad) at these times (s)."""
    late, (rates, angles) = _late(model), swing
    ends = _zeros(times, rates)[: 2 + late]
    if ends.size < 2 + late:
        return _NONE
    try:
        turns = simulate(model, np.concatenate([[0.0], ends]), release)[late:]
    except TrajectoryError:
        return _NONE
    through = ends if angles is None else _zeros(times, angles - middle)[late:]
    size = np.abs(turns - middle)
    if through.size < 2 or not size.min() > 0:
        return _NONE
    amplitude, loss = float(np.sqrt(size[0] * size[1])), float(np.log(size[0] / size[1]))
    if angles is not None:
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


def effects_on(derived: Callable[[Model], Floats], model: Model, covariance: Floats) -> Floats:
    """What independent errors of a model's parameters, each of its standard uncertainty, do to what is derived from it (JCGM 100, 5.2).

    An array (quantity, error), which times its transpose is the covariance of the quantities. ``derived`` goes from a model to an array
    (quantity,), ``model`` has values, and ``covariance`` (parameter, parameter) is that of its parameters; nan counts as known.
    """
    values = np.array(model.vector())
    known = np.where(np.isfinite(covariance), covariance, 0.0)
    loose = np.flatnonzero(np.diag(known) > 0)
    errors = np.sqrt(np.diag(known))[loose]

    def at(values: Floats) -> Floats:
        return derived(model.with_values(dict(zip(model.parameters, map(float, values), strict=True))))

    slopes = []
    for k, error in zip(loose, errors, strict=True):
        step = np.zeros(values.size)
        step[k] = _STEP * error
        slopes.append((at(values + step) - at(values - step)) / (2 * _STEP))
    if not slopes:
        return np.zeros((derived(model).size, 0))
    sizes, directions = np.linalg.eigh(known[np.ix_(loose, loose)] / np.outer(errors, errors))
    return np.column_stack(slopes) @ (directions * np.sqrt(np.maximum(sizes, 0.0)))
