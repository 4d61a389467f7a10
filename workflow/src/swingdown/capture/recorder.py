"""One recording as it goes on: waiting for the release, recording, and how it ended.

It knows neither port nor clock: it is fed bytes with the time they came, live or again from the journal, and what it makes
of them is the same.
"""

from . import clocks, remarks
from .formats import parser
from .order import ANEW, Order, losses
from .trigger import SPREAD, Watch, noise, release

COMPLETE, STOPPED, DISCONNECTED, TIMED_OUT = "complete", "stopped", "disconnected", "timed out"
STALL = 0.25  # s; a longer pause between two looks at the line is the host's own, and no silence of the board
_RECENT = 200  # samples that the noise is told from


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
        self._since = None  # how long had been listened when the recording began
        self._compared = (None, None)
        self._begin()

    def _begin(self):
        """Forget the samples so far: the board has begun anew and the recording has not."""
        self.order = Order(self.parser, self.rate)
        self.first = None  # position of the first sample that is kept
        self.zero = None  # time of the release, or of the first sample
        self.watch = Watch(self.trigger, self.rate, self.scale) if self.trigger else None

    @property
    def rows(self):
        """The samples recorded so far, in order."""
        return self.order.rows if self.first is not None else []

    @property
    def timed(self):
        """True if the device sends the time of each sample: its end is then a time, else a count."""
        return self.parser.tick is not None

    @property
    def expected(self):
        """How many samples the recording has when it is complete, or should have by now where no duration is fixed."""
        if not self.rows:
            return 0 if self.duration is None else self._before + round(self.duration * self.rate)
        so_far = self.rows[-1].position - self.first + 1
        if self.duration is None or (self.timed and self.status == COMPLETE):
            return so_far
        before = round((self.zero - self.rows[0].time) * self.rate) if self.timed else self._before
        return before + round(self.duration * ((self.device_rate() if self.timed else None) or self.rate))

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
            self._place(sample, arrival)
        self._check(arrival)

    def _place(self, sample, arrival):
        found = self.order.add(sample, arrival)
        if self.order.restarted:
            if self.state == "recording" and len(self.order.rows) > ANEW:
                self.end(
                    DISCONNECTED, "the board began anew, or its clock jumped: its numbers cannot be continued"
                )
                return
            self.state = "waiting" if self.trigger else self.state
            since = self.order.since
            self._begin()
            for one, at in since:
                self._place(one, at)
        for row in found:
            if self.state != "ended":
                self._heard = self._listened
                self._take(row)

    def tick(self, now):
        """Notice that nothing came in the last look at the line, which ended at ``now`` (s since 1970)."""
        self._listen(now)
        self._check(now)

    def _listen(self, now):
        self._listened += min(max(now - self._now, 0.0), STALL)
        # what came before the recording began, and waited, tells of no silence
        self._now = max(now, self._now)

    @property
    def silent(self):
        """Seconds since the last sample, or since the port was opened."""
        return self._listened - (0.0 if self.state == "opening" else self._heard)

    @property
    def patience(self):
        """Seconds of silence that end the recording; a board that starts, after the reset that opening causes, has more."""
        return self.settings["timeout_s"] + (self.settings["settle_s"] if self.state == "opening" else 0)

    def _check(self, now):
        """End where the board has been silent too long, or a release never comes."""
        if self.state == "ended":
            return
        if self.silent > self.patience:
            damaged, _ = self.parser.pending
            heard = "bytes came, and no whole frame in them" if damaged else "nothing came"
            self.end(TIMED_OUT, f"for {self.silent:.1f} s {heard}")
        elif (
            self.state in ("waiting", "armed")
            and now - self.opened > self.settings["settle_s"] + self.trigger["wait_s"]
        ):
            self.end(TIMED_OUT, f"no release within {self.trigger['wait_s']:g} s{self._never()}")
        elif self._since is not None and self.duration is not None:
            passed = self._listened - self._since
            if passed > self.duration + self.settings["timeout_s"]:
                rate = self.measured_rate()
                came = f", {rate:.4g} a second" if rate else ""
                self.end(
                    TIMED_OUT,
                    f"{len(self.rows)} samples came in {passed:.1f} s{came}, where {self.expected} should in {self.duration:g} s",
                )

    def end(self, status, reason=""):
        """Close the recording with one of the four statuses; the first end stands."""
        if self.state != "ended":
            self.state, self.status, self.reason = "ended", status, reason

    def _take(self, row):
        if self.state in ("waiting", "armed"):
            self._await(row)
        elif self.first is None:
            self.first, self.zero = row.position, row.time
        if self.first is not None and self._since is None:
            self._since = self._listened
        if self.first is not None and self.duration is not None:
            self._end_in_time(row)

    def _end_in_time(self, row):
        """End with the last sample before the duration is over: by the device's clock, else by its count."""
        rows = self.order.rows
        if self.timed:
            interval = 1 / ((self.device_rate() if row.time > self.zero else None) or self.rate)
            if row.time < self.zero + self.duration - 1.25 * interval:
                return
            while len(rows) > 1 and rows[-1].time > self.zero + self.duration - 0.25 * interval:
                rows.pop()
        else:
            last = self.first + self.expected - 1
            if row.position < last:
                return
            while rows[-1].position > last:
                rows.pop()
        self.end(COMPLETE)

    def _await(self, row):
        """Arm when the bob has been still for the pre-trigger time; record when it then leaves its place."""
        rows, begun = self.order.rows, self.watch.take(row)
        if begun:
            self._release(begun)
            return
        if len(rows) > 2 * self.watch.needed + 1000:
            del rows[: -self.watch.needed]
        self.state = "armed" if self.watch.armed else "waiting"

    def _release(self, noticed):
        self.state = "recording"
        rows, before = self.order.rows, self.trigger["pre_s"]
        at = next(k for k in range(len(rows) - 1, -1, -1) if rows[k].position == noticed.position)
        start = next(k for k in range(at + 1) if rows[k].time >= noticed.time - before)
        around = rows[start:]
        values = [row.value * self.scale for row in around]
        power = 1 if self.settings["signal_unit"] == "rad/s" else 2
        self.zero = release(
            [row.time for row in around], values, at - start, self.trigger["threshold"], power
        )
        if self.timed:
            del rows[: next(k for k in range(at + 1) if rows[k].time >= self.zero - before - 1e-9)]
        else:
            first = next(row.position for row in rows if row.time == self.zero) - self._before
            while rows[0].position < first:
                del rows[0]
        self.first = rows[0].position  # a lost frame may stand where the first should be

    def noise(self):
        """The standard deviation (in the signal's unit) of the noise of late, whatever the bob does."""
        return noise([row.value * self.scale for row in self.order.rows[-_RECENT:]])

    def unarmed(self):
        """Why the trigger cannot arm however still the bob is held, or ""."""
        if self.state != "waiting" or len(self.order.rows) < 20:
            return ""
        return too_noisy(self.noise(), self.trigger["threshold"], self.settings["signal_unit"])

    def _never(self):
        if self.state == "armed":
            return ""
        why = self.unarmed() or (
            f"the signal moved by {self.watch.spread:.3g} {self.settings['signal_unit']} where the threshold is "
            f"{self.trigger['threshold']:g}"
        )
        return f", and it was never still: {why}"

    def device_rate(self):
        """Samples a second by the device's own clock, or None where it sends none or too few came."""
        return self._rate("time", 0.0) if self.timed else None

    def measured_rate(self):
        """Samples a second by the host's clock, or None while that tells nothing."""
        return self._rate("arrival", 1.0)

    def _rate(self, clock, least):
        """Samples a second by one of the clocks of a ``Row``, or None where no more than so many seconds have passed."""
        rows = self.rows or self.order.rows
        if len(rows) < 2:
            return None
        passed = getattr(rows[-1], clock) - getattr(rows[0], clock)
        return (rows[-1].position - rows[0].position) / passed if passed > least else None

    def compared(self):
        """The ``clocks.Comparison`` of the recording's times with their arrivals, or None where there are too few."""
        rows = self.rows
        if self._compared[0] != len(rows):
            found = clocks.compare([row.time for row in rows], [row.arrival for row in rows])
            self._compared = len(rows), found
        return self._compared[1]

    def problems(self):
        """Why the recording is not whole, as sentences; empty if nothing that should be there is missing."""
        found = []
        received, missing = len(self.rows), self.missing
        if self.status in (DISCONNECTED, TIMED_OUT):
            found.append(f"{self.status}: {self.reason}")
        if self.duration is not None and self.rows and self.status == STOPPED:
            lacking = self.zero + self.duration - 1 / self.rate - self.rows[-1].time
            if round(lacking * self.rate) > 0:
                early = round(lacking * self.rate) / self.rate
                found.append(f"stopped {early:g} s early" + (f": {self.reason}" if self.reason else ""))
        if missing:
            lost, damaged = losses(missing)
            found.append(f"{lost} frames lost and {damaged} damaged of {received + len(missing)}")
        return found + remarks.against(self)


def too_noisy(noise_rms, threshold, unit):
    """That noise alone spreads beyond the trigger's threshold, and the mend; "" where it does not."""
    spread = SPREAD * noise_rms
    if spread <= threshold:
        return ""
    return (
        f"noise of {noise_rms:.3g} {unit} spreads over {spread:.3g} {unit}, beyond capture.trigger.threshold "
        f"({threshold:g}): raise it to {2 * spread:.2g} at least, or shield the sensor's cable"
    )
