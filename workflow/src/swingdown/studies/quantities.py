"""What an experimenter asks of a pendulum: period, natural frequency, quality factor, decay time, with their uncertainties.

All are of the fitted model, started at rest from a stated amplitude, which is counted from where it hangs: a pendulum whose damping
is not viscous has another quality at each.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Floats, standard_errors
from ..engine.trajectory import simulate_each
from ..pendulum.effect import NATURAL_FREQUENCY, Effect
from ..pendulum.formula import names_in
from ..pendulum.half_swings import lengthening
from ..pendulum.model import Model
from ..pendulum.static import resting
from ..rounding import value_with_uncertainty

_SAMPLES = (
    4000  # of a period: through three of them a parabola finds a turning point to 1e-8 of the amplitude
)
_AMPLITUDES = 6  # at which the loss is asked for, from the stated one to its e-th part
_WIDE, _STEEP, _HEAVY = 2.0, 0.01, 1.0  # rad, of decrements: a swing whose loss changes from one to the next
_COARSE, _LONGER = 200, 4  # samples of a period, and times that a swing is followed twice as long
_SEEN = 3.0  # standard errors of a loss
_STEP = 0.1  # of a standard error: the differences that uncertainties follow from
_HALVED = 8  # times at most that a step is halved


_OF_TIME = {"t", "duration"}


class Quantity(NamedTuple):
    """A number with its standard uncertainty and unit; it prints as ``0.87148(26) s``.

    Attributes
    ----------
    value
        The number, in ``unit``.
    uncertainty
        Its standard uncertainty, in ``unit``; NaN if unknown.
    unit
        Such as ``s``; ``1`` for a plain number.
    """

    value: float
    uncertainty: float
    unit: str

    @property
    def u(self) -> float:
        """The standard uncertainty, in the quantity's unit."""
        return self.uncertainty

    @property
    def ufloat(self) -> Any:
        """A number of the package ``uncertainties``, without the unit.

        Raises
        ------
        ImportError
            If that package is not installed.
        """
        from uncertainties import ufloat

        return ufloat(self.value, self.uncertainty)

    def __repr__(self) -> str:
        number = value_with_uncertainty(self.value, self.uncertainty)
        return number if self.unit == "1" else f"{number} {self.unit}"

    def __float__(self) -> float:
        return float(self.value)


def over_models(
    each: Sequence[tuple[float, Mapping[str, Quantity]]], names: Iterable[str]
) -> dict[str, Quantity]:
    """By name the means of these quantities over models, whose uncertainty holds that of each model and their spread.

    ``each`` is the weight of a model and its quantities. A quantity that no model has with an uncertainty is left out.
    """
    told = {}
    for name in names:
        known = [(share, *found[name]) for share, found in each if name in found]
        known = [one for one in known if np.isfinite(one[1:3]).all()]
        if known:
            shares, values, errors = np.array([one[:3] for one in known]).T
            told[name] = Quantity(*mixed(shares / sum(shares), values, errors), known[0][3])
    return told


def mixed(shares: ArrayLike, values: ArrayLike, errors: ArrayLike) -> tuple[float, float]:
    """The mean of values by these shares, and its standard uncertainty: with their own and with how far they are apart."""
    shares, values, errors = (np.asarray(one, dtype=float) for one in (shares, values, errors))
    mean = float(shares @ values)
    return mean, float(np.sqrt(shares @ (errors**2 + (values - mean) ** 2)))


def about(
    told: Mapping[str, Quantity], each: Sequence[tuple[float, Mapping[str, Quantity]]]
) -> dict[str, Quantity]:
    """The quantities ``told`` of the model that is reported, and uncertainties that hold what they are off in other models (``each`` as of
    ``over_models``)."""
    found = dict(told)
    for name, mean in over_models(each, told).items():
        one = told[name]
        if not np.isfinite(one.uncertainty):
            continue
        found[name] = Quantity(one.value, float(np.hypot(mean.uncertainty, one.value - mean.value)), one.unit)
    return found


class Cycle(NamedTuple):
    """One period from rest: its length (s), the logarithmic decrement, and the amplitude (rad) in its middle."""

    period: float
    decrement: float
    amplitude: float


def cycle(model: Model, amplitude: float) -> Cycle:
    """The ``Cycle`` of a model let go at rest; NaN where it does not come back or is none.

    The decrement is twice the logarithm of one turning point's distance over the next one's, from side to side: where the
    swing's middle lies does not matter.
    """
    return _cycle(left_alone(model.motion), amplitude)  # what sensor and drive do is none of the pendulum's


def _cycle(model: Model, amplitude: float) -> Cycle:
    """The same of a model that is nothing but its motion."""
    return _cycles(model, np.array([amplitude]))[0]


def _cycles(model: Model, amplitudes: Floats, later: int = 0) -> list[Cycle]:
    """The ``Cycle`` from each of these amplitudes (rad), about where the model hangs, at the times of the longest; of the swing that begins
    ``later`` half-swings after the rest."""
    frequency = model.values[NATURAL_FREQUENCY.name]
    if not (frequency > 0 and np.isfinite(frequency)):
        return [Cycle(np.nan, np.nan, float(one)) for one in amplitudes]
    ideal = 2 * np.pi / frequency * float(np.max(lengthening(amplitudes)))
    span = 1.5 + later / 2
    times = span * ideal * np.arange(int(span * _SAMPLES)) / (span * _SAMPLES)
    middle = resting(steady(model))
    angles = simulate_each(model, times, [[*model.vector(), middle + one, 0.0] for one in amplitudes])
    each = zip(amplitudes, angles, strict=True)
    return [_one_cycle(times, angle, float(one), later) for one, angle in each]


def _one_cycle(times: Floats, angle: Floats, amplitude: float, later: int) -> Cycle:
    """The ``Cycle`` that these angles (rad) at these times (s) are of."""
    turns = np.flatnonzero(np.diff(np.sign(np.diff(angle[1:]))) != 0) + 2
    if turns.size < 2 + later:
        return Cycle(np.nan, np.nan, amplitude)
    each = [(0.0, float(angle[0])), *(_vertex(times, angle, k) for k in turns[: 2 + later])]
    (began, top), (_, low), (ended, high) = each[later:]
    period, first, second = ended - began, abs(top - low), abs(high - low)
    if not first > second > 0:
        return Cycle(period, np.nan, amplitude)
    return Cycle(period, 2 * float(np.log(first / second)), float(np.sqrt(first * second)) / 2)


def steady(model: Model) -> Model:
    """The model without the effects that change with the time of the record: a drive, a damping that drifts."""
    return _without(model, lambda one: bool(_named_in(one) & _OF_TIME) or one.takes_input)


def left_alone(model: Model) -> Model:
    """The model without its measured drive: as it swings by itself."""
    return _without(model, lambda one: one.takes_input) if model.takes_input else model


def _without(model: Model, unwanted: Callable[[Effect], bool]) -> Model:
    bare = model.with_effects([one.name for one in model.effects if not unwanted(one)])
    return bare.with_values({name: value for name, value in model.values.items() if name in bare.parameters})


def _named_in(effect: Effect) -> set[str]:
    """The names in an effect's formulas of motion."""
    texts = [effect.term] if effect.acts_on == "torque" else []
    texts += [text for text in (effect.inertia, *(state.rate for state in effect.states)) if text]
    return {name for text in texts for name in names_in(text)}


def _vertex(times: Floats, values: Floats, k: int) -> tuple[float, float]:
    """Where the parabola through three neighbouring samples turns: time and value."""
    before, here, after = values[k - 1 : k + 2]
    bend = before - 2 * here + after
    shift = 0.5 * (before - after) / bend if bend else 0.0
    return float(times[k] + shift * (times[1] - times[0])), float(here - 0.25 * (before - after) * shift)


def _decay_time(model: Model, amplitude: float, start: Cycle) -> float:
    """The time (s) in which the amplitude (rad) of a model that is nothing but its motion falls to its e-th part; NaN where it stops before.

    The time a period takes over what is lost in it, as a function of the amplitude (a polynomial through a few), summed over
    the logarithm of the amplitude: for a loss that is small in a period, the fall of the turning points. ``start`` is its cycle from there.

    Friction that winds up is unwound at rest and never later, so there a cycle begins after a half-swing.
    """
    later = int(any(one.states for one in model.effects))
    if not np.isfinite(start.decrement):
        return float("nan")
    # what loses more than the e-th part in each half-swing hardly comes back
    if (amplitude > _WIDE and start.decrement > _STEEP) or _HEAVY < start.decrement < np.pi:
        return _fall(model, amplitude, start)
    top = np.log(amplitude)
    above = min(float(top) + (1 + later) * start.decrement / 2, float(np.log(3.0)))
    nodes = _cycles(model, np.exp(np.linspace(top - 1, max(above, float(top)), _AMPLITUDES)), later)
    if not all(np.isfinite(one.decrement) for one in nodes):
        return float("nan")
    at = np.log([one.amplitude for one in nodes]) - top
    pace = np.polynomial.Polynomial.fit(at, [one.period / one.decrement for one in nodes], _AMPLITUDES - 2)
    # no time: it was drawn out too far beyond what was asked for
    if np.min(pace(np.linspace(-1.0, 0.0, 2 * _AMPLITUDES))) <= 0:
        return float("nan")
    whole = pace.integ()
    return float(whole(0.0) - whole(-1.0))


def _fall(model: Model, amplitude: float, start: Cycle) -> float:
    """The same of a wide swing that falls steeply: by its turning points, between which the logarithm of their distance runs straight."""
    middle, span = resting(steady(model)), 2 * start.period / start.decrement
    for _ in range(_LONGER):
        times = np.arange(0.0, span, start.period / _COARSE)
        (angles,) = simulate_each(model, times, [[*model.vector(), middle + amplitude, 0.0]])
        turns = np.flatnonzero(np.diff(np.sign(np.diff(angles[1:]))) != 0) + 2
        when, where = np.array([(0.0, angles[0]), *(_vertex(times, angles, k) for k in turns[:-1])]).T
        stopped = np.flatnonzero((where[1:] - middle) * (where[:-1] - middle) >= 0)
        ends = stopped[0] + 1 if stopped.size else where.size
        fallen = -np.log(np.abs(where[:ends] - middle) / amplitude)
        if fallen.size > 1 and fallen[-2] > 1.0:  # it swings on from there
            return float(np.interp(1.0, np.maximum.accumulate(fallen), when[:ends]))
        span *= 2
    return float("nan")


UNITS = {"natural_frequency": "rad/s", "period": "s", "quality": "1", "decay_time": "s"}


class Beside(NamedTuple):
    """What free courses beside a model say (``fitting.course``): the mean change of its parameters and of the logarithms of natural frequency,
    period, quality and decay time, and the covariance of all these."""

    shift: Floats
    covariance: Floats


def quantities(
    model: Model, amplitude: float, covariance: Floats | None = None, beside: Beside | None = None
) -> dict[str, Quantity]:
    """By name the ``Quantity`` of natural frequency (rad/s), period (s), quality (1), decay time (s), and the model's other parameters.

    The natural frequency is that of small undamped swings, the period that of the first whole swing from rest, the quality pi
    over that swing's logarithmic decrement. Uncertainties are propagated linearly (JCGM 100, 5.2), by differences over a tenth of an
    error, or less beside a bound; NaN where no pendulum is near.

    Parameters
    ----------
    model
        The model with its values.
    amplitude
        The release angle (rad) at which they hold.
    covariance
        Of the model's parameters in their order. A NaN variance marks a value that was held.
    beside
        The free courses beside the model; natural frequency, period, quality and decay time are with them.
    """
    values, motion = np.array(model.vector()), left_alone(model.motion)
    moving = [model.parameters.index(name) for name in motion.parameters]

    def derived(at: Floats) -> Floats:
        one = motion.with_values(dict(zip(motion.parameters, map(float, at[moving]), strict=True)))
        first = _cycle(one, amplitude)
        return np.array([at[0], first.period, np.pi / first.decrement, _decay_time(one, amplitude, first)])

    found, errors = derived(values), np.full(len(UNITS), np.nan)
    own = np.full(values.size, np.nan)
    if covariance is not None:
        known = np.where(np.isfinite(covariance), covariance, 0.0)
        own = np.where(np.diag(known) > 0, standard_errors(known), np.nan)
        whole = known if beside is None else beside.covariance
        slopes = _slopes(derived, values, found, np.sqrt(np.diag(whole)[: values.size]))
        variance = np.einsum("ij,jk,ik->i", slopes, known, slopes)
        if beside is not None:
            slopes = np.c_[slopes, np.diag(found)]
            # what the courses take off the residuals makes no value surer: they are right to first order alone
            variance = np.maximum(variance, np.einsum("ij,jk,ik->i", slopes, whole, slopes))
            # of a loss that is not seen by powers of ten, and by more than numbers hold
            with np.errstate(over="ignore", invalid="ignore"):
                scale = np.exp(slopes @ beside.shift / found)
                found, variance = found * scale, variance * scale**2
        errors = np.where(np.isfinite(found) & (variance > 0), np.sqrt(np.maximum(variance, 0.0)), np.nan)
    units = UNITS | {one.name: one.unit for one in model.definitions[1:]}
    each = zip(units.items(), [*found, *values[1:]], [*errors, *own[1:]], strict=True)
    return {name: Quantity(float(value), float(error), unit) for (name, unit), value, error in each}


def in_its_middle(amplitude: float, known: Mapping[str, Quantity]) -> float:
    """The amplitude in the middle of the first whole swing that begins at rest at ``amplitude``, by the quality in the quantities ``known``:
    there period and quality hold to second order of the loss; without a quality nothing is seen to be lost."""
    quality = known.get("quality")
    if quality and quality.value > 0:
        return amplitude * float(np.exp(-np.pi / (2 * quality.value)))
    return amplitude


def loss_seen(known: Mapping[str, Quantity]) -> bool:
    """Whether a pendulum is seen to die away, by its quantities: its loss is three standard errors from none."""
    quality = known.get("quality")
    if quality is None:  # so much is lost that it does not come back, or nothing
        return "period" not in known
    return not _SEEN * quality.uncertainty > quality.value > 0


def _slopes(function: Callable[[Floats], Floats], values: Floats, here: Floats, errors: Floats) -> Floats:
    """The derivatives of a function's values, which are these ``here``, by each of its arguments (value, argument); 0 by one without an
    error. Where a step leads beyond a bound it is halved, and at a bound one side has to do."""
    columns = []
    for k, error in enumerate(errors):
        step = np.zeros(values.size)
        step[k] = _STEP * error
        if not error > 0:
            columns.append(np.zeros(len(UNITS)))
            continue
        for _ in range(_HALVED):
            ahead, behind = function(values + step), function(values - step)
            if np.array_equal(np.isfinite(ahead) & np.isfinite(behind), np.isfinite(here)):
                break
            step /= 2
        sides = np.isfinite(ahead) * 1 + np.isfinite(behind)
        risen = np.where(np.isfinite(ahead), ahead, here) - np.where(np.isfinite(behind), behind, here)
        columns.append(np.where(sides > 0, risen, np.nan) / (np.maximum(sides, 1) * step[k]))
    return np.array(columns).T
