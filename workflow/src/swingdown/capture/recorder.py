"""One recording as it goes on: waiting for the release, recording, and how it ended.

It knows neither port nor clock: it is fed bytes with the time they came, live or again from the journal, and what it makes
of them is the same.
"""

from collections import deque

from .formats import parser
from .order import Order

COMPLETE, STOPPED, DISCONNECTED, TIMED_OUT = "complete", "stopped", "disconnected", "timed out"
CONFIRM = 3  # samples beyond the threshold before it is a release and no spike
STALL = 0.25  # s; a longer pause between two looks at the line is the host's own, and no silence of the board
DRIFT = (0.5, 0.01)  # s, and part of the duration: how far the clocks of host and device may part


class Recorder:
    """Takes bytes and time; keeps ``rows`` of the recording, its ``state`` and, once it has ended, ``status`` and ``reason``.

    ``settings`` is the config's ``capture`` with its defaults, ``opened`` the host's time (s since 1970) at which the port was
    opened. ``state`` is one of opening, waiting, armed, recording, ended.
    """

    def __init__(self, settings, opened):
        self.settings, self.opened = settings, opened
        self.rate, self.scale = settings["rate_hz"], settings["scale"]
        self.trigger = settings.get("trigger")
        self.duration = settings.get("duration_s")
        self.parser = parser(settings)
        self.state, self.status, self.reason = "opening", None, ""
        self.bytes = 0
        self._now, self._listened, self._heard = opened, 0.0, 0.0
        self._begin()

    def _begin(self):
        """Forget the samples so far: the board has begun anew and the recording has not."""
        self.order = Order(self.parser, self.rate)
        self.first = None  # position of the first sample that is kept
        self.zero = None  # time of the release, or of the first sample
        self._quiet, self._beyond = deque(), []
        self._level = 0.0  # sum over _quiet

    @property
    def rows(self):
        """The samples recorded so far, in order."""
        return self.order.rows if self.first is not None else []

    @property
    def expected(self):
        """How many samples the recording has when it is complete, or should have by now where no duration is fixed."""
        if self.duration is not None:
            return self._before + round(self.duration * self.rate)
        return self.rows[-1].position - self.first + 1 if self.rows else 0

    @property
    def missing(self):
        """(position, damaged) of the frames that are missing between the first sample recorded and the last to be."""
        if self.first is None:
            return []
        last = self.first + self.expected - 1
        return [pair for pair in self.order.missing if self.first < pair[0] <= last]

    @property
    def _before(self):
        return round(self.trigger["pre_s"] * self.rate) if self.trigger else 0

    def feed(self, data, arrival):
        """Take bytes that came at ``arrival`` (s since 1970)."""
        self.bytes += len(data)
        self._listen(arrival)
        for sample in self.parser.feed(data):
            if self.state == "ended":
                return
            if self.state == "opening":
                if arrival - self.opened < self.settings["settle_s"]:
                    continue  # frames from before the reset that opening the port causes
                self.state = "waiting" if self.trigger else "recording"
            row = self.order.add(sample, arrival)
            if self.order.restarted:
                if self.state == "recording":
                    self.end(
                        DISCONNECTED, "the board began anew: its sequence numbers and clock started again"
                    )
                    return
                self.state = "waiting" if self.trigger else self.state
                self._begin()
            elif row:
                self._heard = self._listened
                self._take(row)
        self._check(arrival)

    def tick(self, now):
        """Notice that nothing came in the last look at the line, which ended at ``now`` (s since 1970)."""
        self._listen(now)
        self._check(now)

    def _listen(self, now):
        self._listened += min(max(now - self._now, 0.0), STALL)
        self._now = now

    def _check(self, now):
        """End where the board has been silent too long, or a release never comes."""
        if self.state == "ended":
            return
        opening = (
            self.state == "opening"
        )  # the board may be starting, and silent, after having sent something before its reset
        silent = self._listened - (0.0 if opening else self._heard)
        if silent > self.settings["timeout_s"] + (self.settings["settle_s"] if opening else 0):
            damaged, _ = self.parser.pending
            heard = "bytes came, and no whole frame in them" if damaged else "nothing came"
            self.end(TIMED_OUT, f"for {silent:.1f} s {heard}")
        elif (
            self.state in ("waiting", "armed")
            and now - self.opened > self.settings["settle_s"] + self.trigger["wait_s"]
        ):
            self.end(TIMED_OUT, f"no release within {self.trigger['wait_s']:g} s")

    def end(self, status, reason=""):
        """Close the recording with one of the four statuses; the first end stands."""
        if self.state != "ended":
            self.state, self.status, self.reason = "ended", status, reason

    def _take(self, row):
        if self.state in ("waiting", "armed"):
            self._watch(row)
        elif self.first is None:
            self.first, self.zero = row.position, row.time
        if self.first is not None and self.duration is not None:
            last = self.first + self.expected - 1
            if row.position >= last:
                while self.rows[-1].position > last:
                    self.rows.pop()
                self.end(COMPLETE)

    def _watch(self, row):
        """Arm when the signal has been still for the pre-trigger time; record when it then leaves its level."""
        threshold, value = self.trigger["threshold"], row.value * self.scale
        size = max(self._before, 2 * CONFIRM)
        if self.state == "armed":
            if abs(value - self._level / len(self._quiet)) > threshold:
                self._beyond.append(row)
                if len(self._beyond) >= CONFIRM:
                    self._release(self._beyond[0])
                return
            self._beyond = []
        self._quiet.append(value)
        self._level += value
        if len(self._quiet) > size:
            self._level -= self._quiet.popleft()
        if len(self.order.rows) > 4 * size + 1000:
            del self.order.rows[: -2 * size]
        if (
            self.state == "waiting"
            and len(self._quiet) == size
            and max(self._quiet) - min(self._quiet) <= threshold
        ):
            self.state = "armed"

    def _release(self, row):
        self.state, self.zero = "recording", row.time
        self.first = row.position - self._before
        rows = self.order.rows
        while rows[0].position < self.first:
            del rows[0]
        self.first = rows[0].position  # a lost frame may stand where the first should be

    def measured_rate(self):
        """Samples a second by the host's clock, or None while that tells nothing."""
        rows = self.rows or self.order.rows
        if len(rows) < 2 or (passed := rows[-1].arrival - rows[0].arrival) < 1:
            return None
        return (rows[-1].position - rows[0].position) / passed

    def _drift(self):
        """By how much (s) the host's clock runs ahead of the device's from the first third to the last.

        Arrivals are late at times and never early, so the promptest of each third are compared.
        """
        if (third := len(self.rows) // 3) < 3:
            return 0.0
        behind = [row.arrival - row.time for row in self.rows]
        return min(behind[-third:]) - min(behind[:third])

    def problems(self):
        """Why the recording is not whole, as sentences; empty if nothing that should be there is missing."""
        found = []
        received, missing = len(self.rows), self.missing
        if self.status in (DISCONNECTED, TIMED_OUT):
            found.append(f"{self.status}: {self.reason}")
        if self.duration is not None and self.rows:
            lacking = self.first + self.expected - 1 - self.rows[-1].position
            if lacking > 0 and self.status == STOPPED:
                found.append(
                    f"stopped {lacking / self.rate:g} s early" + (f": {self.reason}" if self.reason else "")
                )
        if missing:
            damaged = sum(damaged for _, damaged in missing)
            found.append(
                f"{len(missing) - damaged} frames lost and {damaged} damaged of {received + len(missing)}"
            )
        if (late := self._drift()) and abs(late) > DRIFT[0] + DRIFT[1] * (
            self.rows[-1].time - self.rows[0].time
        ):
            found.append(
                f"the host's clock and the device's part by {late:+.2f} s: is capture.rate_hz the device's own?"
            )
        return found
