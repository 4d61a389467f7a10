"""Samples in their order on the device's clock, and the frames that are missing between them."""

import math
from collections import deque
from collections.abc import Sequence
from typing import NamedTuple

from .formats import Sample

SLACK = 2.0  # s; how late a sample may be told by the host beyond what its clock says
AGAIN = 256  # samples; a repeated block is not longer, and reaches not further back
# samples that follow from one another and not from the last: the board began anew, and it is no damage
ANEW = 3
COARSE = 0.25  # of an interval; a device's clock with larger steps cannot place a sample by itself


class Row(NamedTuple):
    """A sample in its place."""

    position: int  # the device's sequence number, unwrapped
    time: float  # s on the device's clock since the first sample
    arrival: float  # s since 1970, by the host's clock
    value: float


class _Step(NamedTuple):
    """From one sample to a later one."""

    frames: int
    seconds: float  # by the device's clock as sent


class Order:
    """Takes samples as they arrive and keeps them as ``rows``; what is missing between them as ``missing``.

    ``missing`` holds (position, damaged) pairs: damaged is True for a frame that came and did not check out, False for one that
    never came. A sample that leaves some out is held back until the next one confirms it: a single wrong digit looks the same.
    One that cannot be reached at all in the time that passed is left out; if the next ones follow from it and none from the last,
    the board has begun anew, and ``restarted`` becomes True: its clock cannot be continued. ``since`` then holds the samples
    after the new beginning.
    """

    def __init__(self, parser, rate):
        self._parser, self._rate = parser, rate
        self.rows, self.missing = [], []
        self.repeated, self.restarted = 0, False
        self._last, self._arrival = None, None
        self._held = None  # (sample, arrival, damaged before it, claims): it leaves some out and nothing confirms it yet
        self._strange = []  # (sample, arrival) that cannot be reached from the last
        self._damaged, self._claims = 0, ()  # since the last sample, or the one that is held
        self._recent, self._again = deque(maxlen=AGAIN), 0
        self._largest = 0
        # s; how far the last sample is, or may be, beyond what its clock says
        self._lead, self._most = 0.0, 0.0

    @property
    def since(self):
        """The (sample, arrival) pairs since the board began anew."""
        return self._strange

    @property
    def numbered(self):
        """True if the device numbers its samples, so that losses are told by more than the time."""
        return self._last is not None and self._last.sequence is not None

    @property
    def clock_step(self):
        """The step (s) of the device's clock where samples cannot be placed by it alone, else 0."""
        step = self._parser.resolution or 0.0
        return step if step * self._rate > COARSE else 0.0

    def add(self, sample, arrival):
        """The Rows that are certain now, as a list; ``arrival`` is the host's time (s since 1970)."""
        self._damaged += sample.damaged
        self._claims = (*self._claims, *sample.claims)[-1000:]
        if self._last is None:
            self._damaged, self._claims = 0, ()  # what came before the first sample is no loss
            return [self._keep(sample, arrival, sample.sequence or 0, 0.0, 0.0, self.clock_step)]
        if self._seen(sample):
            self.repeated += 1
            self._again += 1
            return [] if self._again <= AGAIN else self._odd(sample, arrival)
        near = self._step(self._last, sample, arrival - self._arrival, self._most)
        excused = self._damaged + len(self._strange)
        if self._held:
            excused += 1 + self._held[2]
        if near and near.frames - 1 <= excused:
            if self._held:  # it stood in the place of one that is missing
                _, _, damaged, claims = self._held
                self._damaged, self._claims = excused, (*claims, *self._claims)
            else:
                self._damaged = excused
            return [self._believe(sample, arrival, near)]
        if self._held and self._step(self._held[0], sample, arrival - self._held[1], self.clock_step):
            return self._confirm() + self.add(sample._replace(damaged=0, claims=()), arrival)
        if near:
            if self._held:  # two that contradict each other and the last: neither is certain
                self._damaged += 1 + self._held[2]
            self._held = (sample, arrival, self._damaged, self._claims)
            self._damaged, self._claims = 0, ()
            return []
        return self._odd(sample, arrival)

    def _confirm(self):
        """The Row of the sample that was held back, now that another follows from it."""
        sample, arrival, damaged, claims = self._held
        later = self._damaged, self._claims
        step = self._step(self._last, sample, arrival - self._arrival, self._most)
        self._damaged, self._claims = damaged, claims
        row = self._believe(sample, arrival, step)
        self._damaged, self._claims = later
        return [row]

    def _odd(self, sample, arrival):
        """No row: the sample cannot be reached from the last."""
        last, at = self._strange[-1] if self._strange else (None, arrival)
        if last and not self._step(last, sample, arrival - at, self.clock_step):
            self._strange.clear()
        self._strange.append((sample, arrival))
        self.restarted = len(self._strange) >= ANEW
        return []

    def _seen(self, sample):
        """True if the very same was sent before, not long ago."""
        if (sample.sequence, sample.ticks, sample.value) not in self._recent:
            return False
        if sample.sequence is not None or not self.clock_step:
            return True
        # A clock that stands still for several samples, of a pendulum at rest: the same again is a sample of its own,
        # as long as there are no more of them than fit into one step of the clock.
        alike = sum(ticks == sample.ticks for _, ticks, _ in self._recent)
        return sample.ticks != self._last.ticks or alike > math.ceil(self.clock_step * self._rate)

    def _believe(self, sample, arrival, step):
        last = self.rows[-1]
        position = last.position + step.frames
        if lost := range(last.position + 1, position):
            self.missing += _told_apart(lost, self._damaged, self._claims, self._parser.sequence_modulus)
        self._damaged, self._claims = 0, ()
        self._held, self._again = None, 0
        self._strange.clear()
        raw = last.time - self._lead + step.seconds  # what the device's clock says
        time, size = raw, self._parser.resolution or 0.0
        most = raw
        if coarse := self.clock_step:
            time = max(raw, last.time + step.frames / self._rate)
            most = min(raw + coarse, last.time - self._lead + self._most + step.frames / self._rate)
            if most < raw:
                most = raw + coarse
        if time <= last.time or (coarse and time >= raw + coarse):
            halfway = (last.time + raw + size) / 2  # more samples than fit: still one after the other
            time = max(halfway, math.nextafter(last.time, math.inf))
        return self._keep(sample, arrival, position, time, time - raw, most - raw)

    def _keep(self, sample, arrival, position, time, lead, most):
        self._last, self._arrival, self._lead, self._most = sample, arrival, lead, most
        self._largest = max(self._largest, sample.sequence or 0)
        self._recent.append((sample.sequence, sample.ticks, sample.value))
        row = Row(position, time, arrival, sample.value)
        self.rows.append(row)
        return row

    def _step(self, old: Sample, new: Sample, passed: float, most: float):
        """The _Step from one sample to a later one, or None where it cannot be in the time that ``passed``.

        ``most`` (s) is how far the old one may have been beyond what its clock says.
        """
        frames, seconds = 0, None
        if new.ticks is not None and old.ticks is not None:
            ticks = new.ticks - old.ticks
            if self._parser.tick_modulus and ticks < 0:
                ticks += self._parser.tick_modulus
            seconds = ticks * self._parser.tick
            behind = most if self.clock_step else 0.0
            frames = max(1, math.ceil((seconds - behind) * self._rate - 0.5 - 1e-9))
        if new.sequence is not None and old.sequence is not None:
            modulus = self._parser.sequence_modulus or (1 << 16 if self._largest < 1 << 16 else 1 << 32)
            frames = (new.sequence - old.sequence) % modulus
            seconds = frames / self._rate if seconds is None else seconds
        could = passed + SLACK
        if seconds is None or not (0 < frames <= max(could * self._rate, 1) and 0 <= seconds <= could):
            return None
        return _Step(frames, seconds)


def losses(missing: Sequence[tuple[int, bool]]) -> tuple[int, int]:
    """How many of the missing frames never came, and how many came damaged."""
    damaged = sum(flag for _, flag in missing)
    return len(missing) - damaged, damaged


def _told_apart(lost, damaged, claims, modulus):
    """Which of the missing positions came damaged: those that damaged frames claimed first, then the earliest."""
    place = {position % modulus if modulus else position: position for position in lost} if claims else {}
    claimed = [place[claim] for claim in dict.fromkeys(claims) if claim in place][:damaged]
    for position in lost:
        if len(claimed) >= min(damaged, len(lost)):
            break
        if position not in claimed:
            claimed.append(position)
    claimed = set(claimed)
    return [(position, position in claimed) for position in lost]
