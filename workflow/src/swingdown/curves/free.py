"""Period and loss against amplitude, and the torques behind them, from half-swings alone: no model of damping is asked."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import block_diag

from ..arrays import Floats
from ..errors import InputError
from ..studies.amplitudes import HalfSwings
from .regression import Banded, Design, Posterior, Prior, regression
from .second_order import Course, Early, Table, beyond_of, none_beyond
from .torques import Basis, Ideal, beyond_durations, durations, friction, losses, stiffness

FEWEST = 8  # half-swings
_ROUNDS = 3  # in each of which the amplitudes are those that the one before smoothed
_TABLE = 60  # amplitudes at which a torque's work is computed, between which it is interpolated
_LEAST = 4  # half-swings of a recording
_PART = 1e-3  # of an amplitude, for differences
_FEWEST_MARKS = 6
OF_STIFFNESS = 0.1  # of the restoring torque: what a law of its deviation may be a few times of
LEAST_LOSS, LEAST_STIFFNESS = 3e-3, 1e-6  # of the smooth curve that no law has, over the laws

_Each = Sequence[Floats]  # one a recording


@dataclass(frozen=True)
class Free:
    """What half-swings tell: the loss by friction (``loss``, over ``friction``), the period by stiffness (``period``, over ``stiffness``; None where
    nothing is timed), both in units of the frequency ``scale`` (rad/s) of small swings that is taken for 1; ``courses`` of the recordings'
    ``swings``; ``low`` and ``high`` the amplitudes (rad) that they hold."""

    swings: tuple[HalfSwings, ...]
    ideal: Ideal
    friction: Basis
    stiffness: Basis
    loss: Posterior
    period: Posterior | None
    beyond: Table
    passages: bool
    scale: float
    courses: tuple[Course, ...]
    course_errors: tuple[Floats, ...]
    low: float
    high: float
    early: Early

    def loss_at(self, amplitude: Floats) -> Banded:
        """What a half-swing takes from the logarithm of the amplitude (rad)."""
        value, u, factor = self.loss.band(losses(self.ideal, self.friction, amplitude))
        return value + self.beyond.at(amplitude)[:, 0], u, factor

    def period_at(self, amplitude: Floats) -> Banded:
        """The period (s) at these amplitudes (rad); nan where nothing is timed."""
        if self.period is None:
            return _unknown(amplitude)
        rows = durations(self.ideal, self.stiffness, amplitude)
        share, u, factor = self.period.band(rows, self.period_off(amplitude))
        usual = 2 * np.pi / self.scale * self.ideal.lengthening(amplitude)
        share = share + self.beyond.at(amplitude)[:, 2 if self.passages else 1]
        told = self.period.mean[: rows.shape[1]]
        share = share + beyond_durations(self.ideal, self.stiffness, told, amplitude)
        return usual * (1 + share), usual * u, factor

    def period_off(self, amplitude: Floats) -> Floats:
        """By what share the period is off where the amplitude (rad) is by its standard uncertainty."""
        longer = self.ideal.lengthening(amplitude * (1 + _PART)) / self.ideal.lengthening(amplitude) - 1
        return longer / _PART * self.amplitude_error(amplitude)

    def restoring_off(self, angle: Floats) -> Floats:
        """By what share the restoring torque is off where the angle (rad) is by its standard uncertainty."""
        steeper = 1 - angle * self.ideal.slope(angle) / self.ideal.torque(angle)
        return steeper * self.amplitude_error(angle)

    def amplitude_error(self, amplitude: Floats) -> Floats:
        """The standard uncertainty of the logarithm of these amplitudes (rad), where they stand for those of the recordings."""
        each, at = zip(self.courses, self.course_errors, strict=True), -np.log(amplitude)
        variance = [np.interp(at, -np.log(one.amplitude), error**2) for one, error in each]
        return np.sqrt(np.mean(variance, axis=0) / len(variance))

    def restoring_at(self, angle: Floats) -> Banded:
        """The restoring torque over inertia (rad/s²) at these angles (rad); nan where nothing is timed."""
        if self.period is None:
            return _unknown(angle)
        usual = self.scale**2 * self.ideal.torque(angle)
        # where in a swing friction acts matters to the period as the square of the loss
        inside = np.clip(angle, self.low, self.high)
        loss = self.loss_at(inside)[0]
        more, own = self.early.stiffer(loss, self.beyond.at(inside)[:, 3])
        off = np.hypot(own, self.restoring_off(angle))
        share, u, factor = self.period.band(self.stiffness.at(angle), off)
        return usual * (1 + share + more), usual * u, factor

    def friction_at(self, speed: Floats) -> Banded:
        """The torque of friction over inertia (rad/s²) at these speeds (rad/s): what as a function of speed alone takes as much."""
        value, u, factor = self.loss.band(self.friction.at(speed / self.scale))
        u = np.hypot(u, value * self.friction_off)
        return self.scale**2 * value, self.scale**2 * u, factor

    @property
    def friction_off(self) -> float:
        """By what share the friction may be off for the restoring torque is not the ideal one: work and speed are told by that, and either is off by
        half as much as the torque; a law of friction carries it from the widest swings to all."""
        if self.period is None:
            return 0.0
        stiffer = self.period.band(self.stiffness.at(np.geomspace(self.low, self.high, _TABLE)))[0]
        return 0.5 * float(np.abs(stiffer).max())


def _unknown(argument: Floats) -> Banded:
    return (np.full(argument.size, np.nan),) * 3


def free(swings: Sequence[HalfSwings], restoring: str = "sine") -> Free:
    """What the half-swings (``half_swings_of``) of one pendulum's recordings show free of a model.

    InputError where there are fewer than eight, or they do not shrink.
    """
    swings = [one for one in swings if one.angle.size >= _LEAST] or swings[:1]
    if sum(one.angle.size for one in swings) < FEWEST:
        where = swings[0].recording if len(swings) == 1 else "recordings"
        problem = f"{sum(one.angle.size for one in swings)} half-swings above the noise"
        raise InputError(where, problem, f"at least {FEWEST}", "record longer")
    ideal = Ideal(restoring if all(one.scaled for one in swings) else "linear")
    courses = [_first_course(one) for one in swings]
    before: Table | None = None
    for _ in range(_ROUNDS):
        every = np.concatenate([one.amplitude for one in courses])
        low, high = float(every.min()), float(every.max())
        table = np.geomspace(low * 0.98, _beyond(high, ideal, swings[0].recording), _TABLE)
        basis = friction(ideal, every)
        unknown = Table(table, losses(ideal, basis, table))
        beyond = none_beyond(table) if before is None else before
        prior = Prior.enough(len(basis.powers), basis.nodes, typical_of(courses), LEAST_LOSS)
        loss = of_losses(swings, courses, beyond, unknown, prior)
        before = beyond = beyond_of(ideal, basis, loss, table)
        courses = _courses(swings, courses, unknown, beyond, loss)
    errors = _course_errors(swings, courses, unknown, loss)
    shape = stiffness(every)
    scale, period = _period(swings, courses, ideal, beyond, shape, table)
    passages = all(one.passages for one in swings)
    early = _early(swings, unknown, beyond, loss, scale)
    told = loss, period, beyond, passages, scale
    return Free(tuple(swings), ideal, basis, shape, *told, tuple(courses), errors, low, high, early)


def _beyond(high: float, ideal: Ideal, recording: str) -> float:
    """A little more than the largest amplitude (rad); InputError for one that no pendulum swings back and forth by."""
    if ideal.restoring == "linear":
        return high * 1.02
    if high >= np.pi:
        told = f"its swings reach {np.degrees(high):.3g}°", "swings to less than 180°"
        mend = "correct its unit; for a wheel on a spring write ⟨restoring=linear⟩"
        raise InputError(recording, *told, mend)
    return min(high * 1.02, ideal.widest(high))


def _first_course(one: HalfSwings) -> Course:
    """The amplitude by half-swing as a low polynomial in the logarithm, weighed by its errors."""
    size, number = np.abs(one.angle), one.number
    degree = int(min(5, max(1, size.size // 4)))
    weight = size / one.u_angle
    around = np.polynomial.Polynomial.fit(number, np.log(size), degree, w=weight / weight.max())
    every = np.arange(number[0], number[-1] + 0.5)
    amplitude = np.exp(around(every))
    return Course(every, np.clip(amplitude, 0.8 * size.min(), 1.25 * size.max()))


def typical_of(courses: Sequence[Course]) -> float:
    """The friction at the middle speed (rad) if it were all of one law: by what the swings lose from first to last."""
    lost = sum(abs(np.log(one.amplitude[0] / one.amplitude[-1])) for one in courses)
    halves = sum(one.number[-1] - one.number[0] for one in courses)
    size = float(np.exp(np.mean(np.concatenate([np.log(one.amplitude) for one in courses]))))
    return max(2 / np.pi * lost / max(halves, 1.0), 1e-9) * size


def of_losses(
    swings: Sequence[HalfSwings], courses: Sequence[Course], known: Table, unknown: Table, prior: Prior
) -> Posterior:
    """What the turning points tell of the coefficients of the ``unknown`` losses (laws, then the curve) beside a ``known`` one, its first column."""
    observed, error, summed, own = [], [], [], []
    for one, course in zip(swings, courses, strict=True):
        at = (one.number - course.number[0]).astype(int)
        size = course.amplitude[at]
        # about the smooth amplitude, so that the noise of the smallest does not lean to one side
        more = known.summed(course)[at, 0]
        observed.append(np.log(size) + (np.abs(one.angle) - size) / size + more)
        error.append(one.u_angle / size)
        summed.append(-unknown.summed(course)[at])
        own.append(np.column_stack(_own(one, np.sign(one.angle) / size)))
    return _twice(observed, error, summed, own, prior)


def of_marks(
    timed: Sequence[tuple[HalfSwings, Course]],
    known: Sequence[Floats],
    unknown: Table,
    prior: Prior,
    beyond: Callable[[Posterior], Table],
) -> Posterior:
    """What the marks tell of the coefficients of the ``unknown`` halves of a period (s; laws, then the curve) beside ``known`` times (s) of theirs;
    ``beyond`` is what coefficients do to a half beyond the first order."""
    error = [one.u_mark for one, _ in timed]
    summed = [marked(*one, unknown) for one in timed]
    own = [np.column_stack(_own(one._replace(both=one.passages), 1 / one.slope)) for one, _ in timed]
    observed = [one.mark - mark for (one, _), mark in zip(timed, known, strict=True)]
    more = beyond(_twice(observed, error, summed, own, prior))
    observed = [left - marked(*one, more)[:, 0] for one, left in zip(timed, observed, strict=True)]
    return _twice(observed, error, summed, own, prior)


def _own(one: HalfSwings, side: Floats) -> list[Floats]:
    """The columns of what a recording alone has: its beginning; where both sides are there the middle, and its drift."""
    number = one.number if side.size == one.number.size else one.at
    drift = (number - number[0]) / max(number[-1] - number[0], 1.0)
    return [np.ones(side.size), *([side, side * drift] if one.both else [])]


def _twice(observed: _Each, error: _Each, summed: _Each, own: _Each, prior: Prior) -> Posterior:
    """The ``Posterior`` with the errors as large as a first one tells, so that the sizes of laws and curve are over the right noise."""
    sums, stated, values = np.vstack(summed), np.concatenate(error), np.concatenate(observed)
    # what of each recording alone is unknown stands as blocks beside each other
    design = Design(sums[:, : prior.laws], sums[:, prior.laws :], block_diag(*own))
    first = regression(values, stated, design, prior)
    return regression(values, stated * first.noise, design, prior)


def _courses(
    swings: Sequence[HalfSwings], courses: Sequence[Course], table: Table, beyond: Table, loss: Posterior
) -> list[Course]:
    """The courses as the regression smooths them."""
    size_of = table.rows.shape[1]
    found, place = [], size_of
    for one, course in zip(swings, courses, strict=True):
        begin = loss.mean[place]
        place += 3 if one.both else 1
        lost = table.summed(course) @ loss.mean[:size_of] + beyond.summed(course)[:, 0]
        amplitude = np.exp(begin - lost)
        size = np.abs(one.angle)
        found.append(Course(course.number, np.clip(amplitude, 0.5 * size.min(), 1.5 * size.max())))
    return found


def _course_errors(
    swings: Sequence[HalfSwings], courses: Sequence[Course], table: Table, loss: Posterior
) -> tuple[Floats, ...]:
    """The standard uncertainty of the logarithm of each course's amplitudes."""
    found, size = [], table.rows.shape[1]
    place = size
    for one, course in zip(swings, courses, strict=True):
        rows = np.zeros((course.number.size, loss.mean.size))
        rows[:, :size], rows[:, place] = -table.summed(course), 1.0
        place += 3 if one.both else 1
        found.append(loss.at(rows)[1])
    return tuple(found)


def _period(
    swings: Sequence[HalfSwings],
    courses: Sequence[Course],
    ideal: Ideal,
    beyond: Table,
    shape: Basis,
    amplitude: Floats,
) -> tuple[float, Posterior | None]:
    """The frequency of small swings (rad/s) taken as scale, and the ``Posterior`` of the deviation from the ideal; None without times."""
    timed = timed_of(swings, courses)
    if not timed:
        return 1.0, None
    longer = ideal.lengthening(amplitude)
    marks = [_ideal_marks(one, course, ideal, beyond) for one, course in timed]
    slopes = [np.polyfit(mark, one.mark, 1)[0] for (one, _), mark in zip(timed, marks, strict=True)]
    scale = 1 / float(np.median(slopes))
    rows = np.pi / scale * longer[:, np.newaxis] * durations(ideal, shape, amplitude)
    prior = Prior.enough(len(shape.powers), shape.nodes, OF_STIFFNESS, LEAST_STIFFNESS)

    def more(told: Posterior) -> Table:
        share = beyond_durations(ideal, shape, told.mean[: rows.shape[1]], amplitude)
        return Table(amplitude, (np.pi / scale * longer * share)[:, np.newaxis])

    return scale, of_marks(timed, [mark / scale for mark in marks], Table(amplitude, rows), prior, more)


def timed_of(swings: Sequence[HalfSwings], courses: Sequence[Course]) -> list[tuple[HalfSwings, Course]]:
    """The recordings that have marks enough, with those alone beside which an amplitude is known."""
    timed = [(_within(one, course), course) for one, course in zip(swings, courses, strict=True)]
    return [(one, course) for one, course in timed if one.mark.size >= _FEWEST_MARKS]


def _early(swings: Sequence[HalfSwings], table: Table, beyond: Table, loss: Posterior, scale: float) -> Early:
    """How early turning points are."""
    found = []
    for one in swings:
        before, after = (np.isin(one.number + side, one.at) for side in (-0.5, 0.5))
        kept = before & after & np.isfinite(one.times)
        if not one.passages or not kept.any():
            continue
        number, size = one.number[kept], np.abs(one.angle[kept])
        ends = [one.mark[np.searchsorted(one.at, number + side)] for side in (-0.5, 0.5)]
        lead = scale * ((ends[0] + ends[1]) / 2 - one.times[kept])
        lost = table.at(size) @ loss.mean[: table.rows.shape[1]] + beyond.at(size)[:, 0]
        # the time of a turning point is known in proportion to its amplitude
        found.append(size * np.vstack([lead - beyond.at(size)[:, 4], lost]))
    lead, lost = np.hstack(found) if found else np.zeros((2, 0))
    power = float(lost @ lost)
    if lead.size < _FEWEST_MARKS or not power > 0:
        return Early(0.0, np.nan)
    share = float(lead @ lost) / power
    left = lead - share * lost
    return Early(share, float(np.sqrt(left @ left / (lead.size - 1) / power)))


def _within(one: HalfSwings, course: Course) -> HalfSwings:
    """The half-swings without the marks before the first turning point and after the last, where no amplitude is known."""
    kept = (one.at >= course.number[0]) & (one.at <= course.number[-1])
    return one._replace(at=one.at[kept], mark=one.mark[kept], u_mark=one.u_mark[kept], slope=one.slope[kept])


def marked(one: HalfSwings, course: Course, table: Table) -> Floats:
    """Sums of the rows from the first mark to each (mark, column), each at the amplitude midway between two."""
    return _summed(one, table.at(_midway(one, course)))


def _ideal_marks(one: HalfSwings, course: Course, ideal: Ideal, beyond: Table) -> Floats:
    """The time of each mark after the first, times the frequency of small swings, under the ideal torque and the friction that is known."""
    size = _midway(one, course)
    each = np.pi * ideal.lengthening(size) * (1 + beyond.at(size)[:, 2 if one.passages else 1])
    return _summed(one, each[:, np.newaxis])[:, 0]


def _midway(one: HalfSwings, course: Course) -> Floats:
    """The amplitude midway between each two marks."""
    return course.at(np.arange(one.at[0] + 0.5, one.at[-1]))


def _summed(one: HalfSwings, each: Floats) -> Floats:
    sums = np.vstack([np.zeros(each.shape[1]), np.cumsum(each, axis=0)])
    return sums[np.round(one.at - one.at[0]).astype(int)]
