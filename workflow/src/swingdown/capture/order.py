"""Samples in their order on the device's clock, and the frames that are missing between them."""

from typing import NamedTuple

SLACK = 2.0  # s; how late a sample may be told by the host beyond what its clock says


class Row(NamedTuple):
    """A sample in its place."""

    position: int  # the device's sequence number, unwrapped
    time: float  # s on the device's clock since the first sample
    arrival: float  # s since 1970, by the host's clock
    value: float


class Order:
    """Takes samples as they arrive and keeps them as ``rows``; what is missing between them as ``missing``.

    ``missing`` holds (position, damaged) pairs: damaged is True for a frame that came and did not check out, False for one that
    never came. A sample whose number cannot be reached in the time that passed is left out; if the next one follows from it
    the board has begun anew, and ``restarted`` becomes True: its clock cannot be continued.
    """

    def __init__(self, parser, rate):
        self._parser, self._rate = parser, rate
        self.rows, self.missing = [], []
        self.repeated, self.restarted = 0, False
        self._last, self._arrival, self._suspect, self._damaged = None, None, None, 0
        self._largest = 0

    def add(self, sample, arrival):
        """The Row of the sample, or None if it is left out; ``arrival`` is the host's time (s since 1970)."""
        self._damaged += sample.damaged
        if self._last is None:
            self._damaged = 0  # what came before the first sample is no loss
            return self._keep(sample, arrival, sample.sequence or 0, 0.0)
        frames, seconds = self._forward(self._last, sample)
        if frames == 0:
            self.repeated += 1
            return None
        if not self._within(frames, seconds, arrival - self._arrival):
            if self._suspect and self._within(*self._forward(self._suspect, sample), 0.0):
                self.restarted = True
            elif self._suspect:
                self._damaged += 1
            self._suspect = sample
            return None
        if self._suspect:
            self._suspect = None
            self._damaged += 1
        last = self.rows[-1]
        lost = range(last.position + 1, last.position + frames)
        if lost:
            self.missing += _told_apart(lost, self._damaged, sample.claims, self._parser.sequence_modulus)
        self._damaged = 0
        return self._keep(sample, arrival, last.position + frames, last.time + seconds)

    def _keep(self, sample, arrival, position, time):
        self._last, self._arrival = sample, arrival
        self._largest = max(self._largest, sample.sequence or 0)
        row = Row(position, time, arrival, sample.value)
        self.rows.append(row)
        return row

    def _forward(self, old, new):
        """Frames and seconds from one sample to a later one."""
        frames = seconds = None
        if new.ticks is not None:
            ticks = new.ticks - old.ticks
            if self._parser.tick_modulus and ticks < 0:
                ticks += self._parser.tick_modulus
            seconds = ticks * self._parser.tick
            frames = max(1, round(seconds * self._rate)) if seconds > 0 else 0
        if new.sequence is not None:
            modulus = self._parser.sequence_modulus or (1 << 16 if self._largest < 1 << 16 else 1 << 32)
            frames = (new.sequence - old.sequence) % modulus
            seconds = frames / self._rate if seconds is None else seconds
        return frames, seconds

    def _within(self, frames, seconds, passed):
        return frames > 0 and 0 < seconds <= passed + SLACK and frames <= (passed + SLACK) * self._rate


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
