"""What a friction of speed alone does to half-swings beyond the first order of the loss, and where in a swing friction acts."""

from typing import NamedTuple

import numpy as np
from scipy.interpolate import CubicSpline

from ..arrays import Floats
from .regression import Posterior
from .torques import Basis, Ideal, Swung, losses, swung

_SPEEDS, _BEGUN = 400, 24  # speeds of a friction that is swung, half-swings that are
_FEWEST = 8  # of those that end in a turning point
_REACH = 1.1  # times beyond the amplitudes asked for, and beyond what two half-swings lose there
# Of a step in the torque at a turning point, over the torque, by how much (over the frequency) the polynomial through it turns too late
_STEP_SEEN = 0.108
_LONGER = 1.25  # period squared over its usual one, less 1, over the square of what a turning point comes early by: 1 viscous, 1.2 to 1.3 others
_ONLY_SO = 1 / 3  # of that: how well it holds for laws of any kind
_SECOND = 1 / 8  # of the loss: how well it is known how early turning points are, to first order


class Course(NamedTuple):
    """The amplitude (rad) of one recording at each half-swing from the first to the last, by ``number``."""

    number: Floats
    amplitude: Floats

    def at(self, number: Floats) -> Floats:
        """The amplitude (rad) at these numbers of half-swings."""
        return np.exp(np.interp(number, self.number, np.log(self.amplitude)))


class Table:
    """Rows by amplitude (rad), with a cubic spline between them over its logarithm."""

    def __init__(self, amplitude: Floats, rows: Floats) -> None:
        self.rows = rows
        self._ends = amplitude[0], amplitude[-1]
        self._between = CubicSpline(np.log(amplitude), rows)

    def at(self, amplitude: Floats) -> Floats:
        """The rows at these amplitudes (amplitude, column); beyond the table's ends those there."""
        return self._between(np.log(np.clip(amplitude, *self._ends)))

    def summed(self, course: Course) -> Floats:
        """Sums of the rows over the half-swings from the first to each (half-swing, column): each at the amplitude in its middle."""
        middle = np.sqrt(course.amplitude[1:] * course.amplitude[:-1])
        return np.vstack([np.zeros(self.rows.shape[1]), np.cumsum(self.at(middle), axis=0)])


class Early(NamedTuple):
    """How much earlier turning points come, between two passages of the middle, than a friction of speed alone says: times the frequency, over the
    loss, with its standard uncertainty, nan where it is not timed. A friction that acts near the turning points makes them earlier, and the swing
    longer."""

    share: float
    u: float

    def stiffer(self, loss: Floats, usual: Floats) -> tuple[Floats, Floats]:
        """What is missing of the restoring torque, as a share of it, and its standard uncertainty, where swings have this ``loss`` and a friction
        of speed alone makes turning points as early as ``usual``."""
        if not np.isfinite(self.u):
            return 0 * loss, loss**2 / 3
        # where the friction ends in a step at the turning point, the polynomial through it hides a part
        excess = self.share * loss * (1 + np.pi * _STEP_SEEN if self.share > 0 else 1.0)
        more = _LONGER * excess * (2 * usual + excess)
        u = np.hypot(self.u, _SECOND * loss) * loss
        return more, np.hypot(2 * _LONGER * (usual + excess) * u, _ONLY_SO * more)


def none_beyond(amplitude: Floats) -> Table:
    """The table of ``beyond_of`` for a friction that is not known yet."""
    return Table(amplitude, np.zeros((amplitude.size, 5)))


def beyond_of(ideal: Ideal, basis: Basis, loss: Posterior, amplitude: Floats) -> Table:
    """What the friction of speed alone that a regression found does beyond the first order of the loss, by amplitude (columns): to the loss, and
    to the time between turning points and between passages through the middle, over that of an ideal pendulum; how late a passage is between two
    turning points, times the frequency, and how early a turning point is between two passages, as the polynomial through it shows it."""
    mean = loss.mean[: len(basis.powers) + basis.nodes.size]
    # two half-swings that meet in a turning point of the table go from further out to further in
    ends = amplitude[[0, -1]]
    room = _REACH * np.exp(2 * (losses(ideal, basis, ends) @ mean))
    least, most = float(ends[0] / room[0]), float(min(ends[1] * room[1], ideal.widest(ends[1])))
    speeds = np.linspace(0.0, float(ideal.speed(np.array([most]))[0]), _SPEEDS)
    drag = basis.at(speeds) @ mean
    begun = np.geomspace(least, most, _BEGUN)
    found = swung(ideal, lambda speed: np.interp(speed, speeds, drag), begun)
    good = np.isfinite(found.loss) & np.isfinite(found.passage)
    # a friction that stops it before its next turning point
    if good.sum() < _FEWEST or not (np.diff(found.amplitude[good]) > 0).all():
        return none_beyond(amplitude)
    found = Swung(*(one[good] for one in found))
    at = found.amplitude
    usual = np.pi * ideal.lengthening(at)
    each = found.passage - found.duration / 2, found.loss, found.duration
    beside, loss_at, duration = (CubicSpline(np.log(at), one) for one in each)
    # two half-swings meet in a turning point: between their passages lie half of each, and what their passages are beside their middles
    here = before = after = np.log(at)
    for _ in range(4):
        before, after = here + loss_at(before) / 2, here - loss_at(after) / 2
    known = (before <= here[-1]) & (after >= here[0])
    if known.sum() < _FEWEST:
        return none_beyond(amplitude)
    here, before, after, turned = here[known], before[known], after[known], at[known]
    between = (duration(before) + duration(after)) / 2 + beside(after) - beside(before)
    lead = (duration(after) - duration(before)) / 4 + (beside(after) + beside(before)) / 2
    step = 2 * float(drag[0]) / ideal.torque(turned)
    columns = (
        CubicSpline(np.log(at), found.loss - losses(ideal, basis, at) @ mean),
        CubicSpline(np.log(at), found.duration / usual - 1),
        CubicSpline(here, between / usual[known] - 1),
        beside,
        CubicSpline(here, lead - _STEP_SEEN * step),
    )
    place = np.log(amplitude)
    inside = [one(np.clip(place, one.x[0], one.x[-1])) for one in columns]
    return Table(amplitude, np.column_stack(inside))
