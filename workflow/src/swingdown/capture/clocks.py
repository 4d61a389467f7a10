"""The device's clock held against the host's: its rate, changes of its rate, stalls, and how well all that is known.

A sample arrives late at times and never early, and what a late host finds waiting comes in one piece. So only the last sample of
each piece counts, and of some pieces the promptest. What these are late by, over the device's time, is a straight line where both
clocks are steady, and its slope is the rate. A line that bends is a rate that changes, one that jumps is a stall.
"""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from ..arrays import Bools, Floats
from ..measurement.slack import CLOCK_TOLERANCE
from . import broken_line
from .broken_line import Breaks, BrokenLine, sure

RATE = 0.005  # part; how far the rates of host and device may differ: a ceramic resonator is good to that
CHANGE = 0.001  # part; how far a sound rate may change: a ceramic resonator's by 30 K (0.3 % over its 100 K)
STRETCH = 3.0  # s; the change of rate that the comparison tells its limit for
_JUMP = 0.05  # s; what a device's own time may jump by between two samples
_PIECES = 10  # of which the promptest counts: half may be late, and of a thousand blocks one is
_BLOCKS = 400  # at most
_FEWEST = 6  # blocks that tell anything, two straight parts
_LEAST = 3  # pieces of a block
_ENOUGH = 60  # blocks, for which few pieces are divided into smaller ones
_PASSES = 4  # a block's promptest piece is known once its slope is
_STAMP = 1e-4  # s; no host's time of arrival is better than that
_LATE = 5  # standard deviations above its neighbours, and a single block is late
_OFTEN = 0.05  # of the pieces hold several samples: that is no late host, but how the line comes
_STEPS = 5  # looks that a host may take in one interval, in step with the samples
_SPREAD = 0.75  # of an interval that the ends of bursts fall into, or they may be in step with the samples
_APART = 6  # standard deviations of arrivals in a step, or two steps cannot be told apart
_SHARP = 1e-7  # s; how long a jump takes
# blocks at an end that are looked at piece by piece, and those beside that tell what they should be
_EDGE, _BODY = 3, 10


class Stall(NamedTuple):
    """The device's clock stood still for ``seconds`` (above 0), or jumped ahead (below 0)."""

    at: float  # s by the device's clock
    seconds: float


class Course(NamedTuple):
    """A stretch (s by the device's clock) in which the rate is steady: ``ratio`` seconds by the host for one by the device."""

    since: float
    until: float
    ratio: float


class Comparison(NamedTuple):
    """What the host's clock says of the device's; all times in s."""

    ratio: float  # seconds by the host for one by the device, over the whole recording
    u_ratio: float  # its standard uncertainty, the host's own quartz included
    stalls: tuple[Stall, ...]
    courses: tuple[Course, ...]
    wanders: bool  # True if the rate changes by more than a sound clock's
    scatter: float  # standard deviation of the promptest arrivals
    interval: float  # between samples
    uncertainty: float  # standard uncertainty of the corrected times against the first, by the host's clock
    unseen_stall: float  # a shorter one may not have been seen
    unseen_change: float  # nor a smaller change of the rate (part) over ``STRETCH``
    knots: tuple[Floats, Floats]  # device times, and what they lack

    @property
    def steady(self) -> bool:
        """True if the rate is the same all the time."""
        return not self.stalls and len(self.courses) == 1

    @property
    def apart(self) -> bool:
        """True if the host's clock establishes another rate than the one said."""
        return abs(self.ratio - 1) > sure(1) * self.u_ratio

    @property
    def wrong(self) -> bool:
        """True if that rate is further off than a sound clock's, whatever step the host looks at the line in."""
        span = self.courses[-1].until - self.courses[0].since
        return abs(self.ratio - 1) - sure(1) * self.u_ratio - self.interval / span > RATE

    def corrected(self, times: npt.ArrayLike) -> Floats:
        """Device times (s) by the host's clock, increasing; as they are where the host establishes no difference."""
        times = np.asarray(times, float)
        if self.steady and not self.apart:
            return times
        at, lack = self.knots
        found = times + np.interp(times, at, lack)
        for end, beyond in ((0, times < at[0]), (-1, times > at[-1])):
            found[beyond] += (self.courses[end].ratio - 1) * (times[beyond] - at[end])
        least = 1e-6 * self.interval * np.arange(len(times))
        return np.maximum.accumulate(found - least) + least


class _Pieces(NamedTuple):
    """Of what came in one piece the last sample: its time by the device, and what it was late by."""

    times: Floats
    late: Floats
    fresh: Bools  # False where it waited already while the piece before was read
    interval: float
    bursts: bool  # True if pieces hold several samples as a rule


class _Edge(NamedTuple):
    """Pieces at an end that a stall parts from the others: ``many`` of them, ``size`` (s) later than they should be."""

    many: int = 0
    size: float = 0.0


def compare(times: npt.ArrayLike, arrivals: npt.ArrayLike) -> Comparison | None:
    """The device's clock (``times``, s) beside the computer's (``arrivals``, s), or None where there are too few samples to compare."""
    pieces = _pieces(np.asarray(times, float), np.asarray(arrivals, float))
    if pieces is None:
        return None
    known, steps = np.zeros(len(pieces.times)), 0.0
    for _ in range(_PASSES):
        chosen, scatter = _prompt(pieces, known + steps)
        head, tail = _edges(pieces, known, chosen, scatter)
        inside = chosen[(chosen >= head.many) & (chosen < len(known) - tail.many)]
        if len(inside) < _FEWEST:
            return None
        line, hidden = _line(pieces, inside, scatter)
        known, steps = line.at(pieces.times), _steps(pieces, head, tail)
    return _told(pieces, line, hidden, head, tail)


def jump(positions: npt.ArrayLike, times: npt.ArrayLike) -> tuple[float, int]:
    """The largest jump of the device's clock between samples whose numbers say otherwise: the seconds too many, and the index of the sample after it.

    Both are 0 where all intervals agree with the usual one within half of it and 50 ms. ``positions`` are the samples' numbers, ``times``
    the device's (s).
    """
    positions, times = np.asarray(positions), np.asarray(times, float)
    if len(times) < 4:
        return 0.0, 0
    steps = np.diff(positions)
    usual = float(np.median(np.diff(times) / steps))
    beyond = np.diff(times) - usual * steps
    k = int(np.argmax(np.abs(beyond)))
    if abs(beyond[k]) <= max(0.5 * usual * steps[k], _JUMP):
        return 0.0, 0
    return float(beyond[k]), k + 1


def _pieces(times, arrivals):
    last = np.flatnonzero(np.diff(arrivals) > 0)  # of each piece but the final one, which may be cut short
    if len(last) < _FEWEST * _LEAST:
        return None
    interval = float(np.median(np.diff(times)))
    held = np.diff(last, prepend=-1)
    waited = np.diff(arrivals[last], prepend=-np.inf)
    late = arrivals[last] - times[last]
    bursts = bool(np.mean(held > 1) > _OFTEN)
    return _Pieces(times[last], late - late[0], waited > held * interval / 2, interval, bursts)


def _prompt(pieces, known):
    """Indices of the promptest piece of each block, but for blocks that are late as a whole; and their standard deviation."""
    left = pieces.late - known
    count = len(left)
    blocks = min(_BLOCKS, max(count // _PIECES, min(count // _LEAST, _ENOUGH)))
    ends = np.linspace(0, count, blocks + 1).astype(int)
    chosen = np.array([a + int(np.argmin(left[a:b])) for a, b in zip(ends[:-1], ends[1:], strict=True)])
    above = _above(pieces.times[chosen], left[chosen])
    scatter = _deviation(above)
    prompt = np.concatenate(([True], above < _LATE * scatter, [True]))
    return chosen[prompt], scatter


def _above(times, late):
    """By how much each point but the first and the last lies above the line between its neighbours, in deviations of a point."""
    part = (times[1:-1] - times[:-2]) / (times[2:] - times[:-2])
    return (late[1:-1] - (1 - part) * late[:-2] - part * late[2:]) / np.sqrt(1 + part**2 + (1 - part) ** 2)


def _deviation(values):
    """The standard deviation of values about 0, whatever a tenth of them does: the larger of what half and 9 of 10 tell."""
    half, most = np.quantile(np.abs(values), [0.5, 0.9])
    return float(max(half / 0.6745, most / 1.645, _STAMP))


def _edges(pieces, known, chosen, scatter):
    """The _Edge at the beginning and the one at the end."""
    left, last = pieces.late - known, len(known) - 1
    tail = _edge(pieces.times, left, pieces.fresh, chosen, scatter, pieces.interval)
    head = _edge(
        -pieces.times[::-1], left[::-1], pieces.fresh[::-1], last - chosen[::-1], scatter, pieces.interval
    )
    return head, tail


def _edge(times, left, fresh, chosen, scatter, interval):
    """The _Edge at the end: pieces that all lie further from what the blocks before them tell than one interval and noise."""
    if len(chosen) < 2 * _EDGE:
        return _Edge()
    body = chosen[-_EDGE - _BODY : -_EDGE]
    line = broken_line.part(times[body], left[body], 0, len(body))
    at = np.arange(chosen[-_EDGE - 1] + 1, len(times))
    away = left[at] - line.at(times[at])
    near = np.arange(body[0], body[-1] + 1)
    scatter = max(scatter, _deviation(_centred(left[near] - line.at(times[near]))))
    beyond = interval + scatter * sure(len(times)) * np.sqrt(1 + line.variance(times[-1]))
    for sign in (1, -1):
        out = sign * away > beyond
        within = np.flatnonzero(~out)
        count = len(at) - (within[-1] + 1 if len(within) else 0)
        told = int(np.sum(fresh[at[len(at) - count :]]))
        others = 1 + int(np.sum(sign * left[: at[0]] > sign * np.median(left[: at[0]]) + beyond))
        if 0 < count < len(at) and len(times) * (others / len(times)) ** told < broken_line.ALPHA:
            return _Edge(count, float(np.min(away[len(at) - count :])))
    return _Edge()


def _steps(pieces, head, tail):
    """What the edges add to what each piece is late by."""
    found = np.zeros(len(pieces.times))
    found[: head.many] = head.size
    found[len(found) - tail.many :] = tail.size
    return found


def _line(pieces, inside, scatter):
    """(BrokenLine, s that the host's looks at the line hide) of the promptest pieces; jumps are placed where the pieces have them.

    What a host that looks at the line in steps makes of a sound clock lies within a band as wide as a step, and is no break.
    """
    times, late = pieces.times[inside], pieces.late[inside]
    breaks = broken_line.breaks(
        broken_line.parts(times, late, scatter), times, scatter, least=pieces.interval
    )
    line = plain = BrokenLine(times, late, scatter, Breaks(small=breaks.small))
    if breaks.bends or breaks.jumps:
        line = BrokenLine(times, late, scatter, breaks)
        hidden = _hidden(pieces, plain) or (0.0 if pieces.bursts else _step(pieces, line))
        if hidden and broken_line.band(times, late) < hidden + 2 * scatter * sure(len(times)):
            return plain, hidden
        jumps = zip(breaks.jumps, line.jumped(), strict=True)
        placed = tuple(_placed(pieces, inside, line, at, size) for at, size in jumps)
        line = BrokenLine(times, late, scatter, breaks._replace(jumps=placed))
    return line, _hidden(pieces, line)


def _placed(pieces, inside, line, at, size):
    """The time of a jump, between the two pieces where all of those near it fit best."""
    around = np.searchsorted(pieces.times[inside], at)
    near = np.arange(inside[max(around - 2, 0)], inside[min(around + 1, len(inside) - 1)] + 1)
    left = pieces.late[near] - line.at(pieces.times[near]) + size * (pieces.times[near] >= at)
    fits = np.concatenate(([0.0], np.cumsum(np.abs(left) - np.abs(left - size))))
    k = near[min(max(int(np.argmin(fits)), 1), len(near) - 1)]
    return _parted(pieces, k)


def _hidden(pieces, line):
    """How far (s) all the promptest may be late in common, because the host looks at the line in step with the samples.

    The ends of bursts leave out that part of an interval; where it is more than a quarter it may be all, as in a recording that
    is too short for a step of the host's to drift against the samples.
    """
    if line.end - line.first < STRETCH:
        return pieces.interval
    if not pieces.bursts:
        return 0.0
    count = len(pieces.times) // _PIECES
    left = (pieces.late - line.at(pieces.times))[: count * _PIECES].reshape(count, _PIECES)
    span = 2 * float(np.median(np.diff(np.quantile(left, [0.25, 0.75], axis=1), axis=0))) if count else 0.0
    return max(pieces.interval - span, 0.0) if span > _SPREAD * pieces.interval else pieces.interval


def _step(pieces, line):
    """The step (s), in step with the samples, in which the host looks at the line; 0 where that tells its arrivals less well."""
    arrivals = pieces.times + pieces.late
    spread = np.mean(np.abs(_centred(pieces.late - line.at(pieces.times))))
    as_well = spread * (1 + sure(1) / np.sqrt(2 * len(arrivals)))
    for part in range(1, _STEPS + 1):
        step = _refined(arrivals, np.median(np.diff(arrivals)) / part)
        turns = np.exp(2j * np.pi * arrivals / step)
        off = np.angle(turns / np.mean(turns)) / (2 * np.pi) * step
        left = np.mean(np.abs(_centred(off)))
        # 0.8: of a normal distribution's standard deviation
        if left < as_well and _APART * left / 0.8 < step:
            return step
    return 0.0


def _refined(arrivals, step):
    """The ``step`` of which all differences between arrivals are multiples, better and better from ever longer ones."""
    for lag in 2 ** np.arange(int(np.log2(len(arrivals)))):
        long = arrivals[lag:] - arrivals[:-lag]
        step = float(np.median(long / np.maximum(np.round(long / step), 1)))
    return step


def _centred(values):
    return values - np.median(values)


def _told(pieces, line, hidden, head, tail):
    scatter, span = line.scatter, line.end - line.first
    stalls = [Stall(at, size) for at, size in zip(line.breaks.jumps, line.jumped(), strict=True)]
    for edge, sign, k in ((head, -1, head.many), (tail, 1, len(pieces.times) - tail.many)):
        if edge.many:
            stalls.append(Stall(_parted(pieces, k), sign * edge.size))
    courses = tuple(Course(since, until, 1 + slope) for since, until, slope in line.slopes())
    knots = _knots(pieces, line, head, tail)
    bent = np.sqrt(broken_line.break_price(line.count) * len(courses) / line.count) * scatter
    # how long samples of a burst are before its last
    waiting = np.median(np.diff(pieces.times)) - pieces.interval
    misplaced = sum(one.seconds**2 for one in stalls) * max(waiting, 0.0) / 2 / span
    common = float(
        np.sqrt(hidden**2 / 6 + np.sum(np.square(line.breaks.small)) / 12 + bent**2 / 3 + misplaced)
    )
    grid = np.linspace(line.first, line.end, _BLOCKS)
    u_end = float(np.hypot(line.uncertainty(line.end, line.first)[0], hidden / np.sqrt(6)))
    u_ratio = float(np.hypot(u_end / span, CLOCK_TOLERANCE / np.sqrt(3)))  # the host's clock is a quartz
    lack = line.at([line.first, line.end])
    unsure = scatter * sure(line.count)
    many = min(line.count, max(line.count * STRETCH / span, broken_line.SHORTEST))
    found = Comparison(
        ratio=courses[0].ratio if len(courses) == 1 else 1 + float(lack[1] - lack[0]) / span,
        u_ratio=u_ratio,
        stalls=tuple(sorted(stalls)),
        courses=courses,
        wanders=_wanders(courses, line, scatter),
        scatter=scatter,
        interval=pieces.interval,
        uncertainty=float(np.hypot(np.max(line.uncertainty(grid, line.first)), common)),
        unseen_stall=pieces.interval + hidden + unsure,
        unseen_change=float(CHANGE + (hidden + unsure * np.sqrt(24 / many)) / min(STRETCH, span)),
        knots=knots,
    )
    if not found.steady or found.apart:
        return found
    uncorrected = abs(found.ratio - 1) * span / np.sqrt(3)
    return found._replace(uncertainty=float(np.hypot(found.uncertainty, uncorrected)))


def _wanders(courses, line, scatter):
    """True if two stretches differ in rate by more than a sound clock's do, and than noise makes them."""
    if len(courses) == 1:
        return False
    each = line.count / (line.end - line.first)  # points a second
    ratio = np.array([one.ratio for one in courses])
    long = np.array([max(one.until - one.since, broken_line.SHORTEST / each) for one in courses])
    variance = 12 * scatter**2 / (each * long**3)
    apart = np.abs(ratio[:, None] - ratio) - sure(len(courses) ** 2) * np.sqrt(variance[:, None] + variance)
    return bool(np.any(apart > CHANGE))


def _knots(pieces, line, head, tail):
    """(device times, what they lack): the broken line, and the steps at its ends, from knot to knot."""
    begins, ends = _parted(pieces, head.many), _parted(pieces, len(pieces.times) - tail.many)
    sharp = [*line.breaks.jumps, *([begins] if head.many else []), *([ends] if tail.many else [])]
    at = [pieces.times[0], *line.breaks.bends, pieces.times[-1]]
    at = np.unique([*at, *(one + side for one in sharp for side in (-_SHARP, _SHARP))])
    lack = line.at(at)
    if head.many:
        lack += head.size * (at < begins)
    if tail.many:
        lack += tail.size * (at > ends)
    return at, lack


def _parted(pieces, k):
    """The time between a piece and the one before it."""
    k = min(max(k, 1), len(pieces.times) - 1)
    return float(pieces.times[k - 1] + pieces.times[k]) / 2
