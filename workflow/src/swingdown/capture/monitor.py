"""The signal without a recording: value and angle, noise against the threshold, range, rate, and the swing as it goes on."""

import math
import time
from pathlib import Path

from .. import dataset
from ..errors import InputError
from . import source
from .listener import Listener
from .live import measured, trace_of
from .order import losses
from .recorder import Recorder, too_noisy
from .remarks import saturated

KEEP = 20.0  # s of the signal
_SHOW = 0.2  # s between pictures
_WIDTH = 100  # characters of the trace
CALIBRATION = Path("results/calibration/calibration.nc")


class Monitor:
    """Takes bytes as a recorder does and keeps the last seconds; ``lines`` says what an experimenter wants to know."""

    def __init__(self, settings, opened):
        self.settings = settings | {"trigger": None, "duration_s": None, "timeout_s": math.inf}
        self._threshold = (settings.get("trigger") or {}).get("threshold")
        self._angle = angle_of(settings)
        self.recorder = Recorder(self.settings, opened)

    def feed(self, data, arrival):
        """Take what a listener gave: bytes, or none."""
        if not data:
            self.recorder.tick(arrival)
            return
        self.recorder.feed(data, arrival)
        if self.recorder.state == "ended":  # the board began anew
            self.recorder = Recorder(self.settings | {"settle_s": 0}, arrival)
            return
        rows, most = self.recorder.order.rows, int(KEEP * self.recorder.rate)
        if len(rows) > 2 * most:
            del rows[:-most]
            self.recorder.order.missing.clear()

    def line(self) -> str:
        """The signal of this moment in one line."""
        recorder, unit = self.recorder, self.settings["signal_unit"]
        if not recorder.order.rows:
            return f"nothing yet, for {recorder.silent:.0f} s ({recorder.bytes} bytes)"
        if recorder.silent > 1:
            return f"SILENT for {recorder.silent:.0f} s"
        value = recorder.order.rows[-1].value * recorder.scale
        parts = [f"{value:.4f} {unit}"]
        if (degrees := self._angle(value)) is not None:
            parts.append(f"{degrees:+.2f} deg")
        return " | ".join([*parts, f"noise {recorder.noise():.2g} {unit}"])

    def lines(self, trace: bool = True) -> list[str]:
        """All that is known of the last seconds, as lines; the ``trace`` at their end."""
        recorder, unit = self.recorder, self.settings["signal_unit"]
        found, rows = [self.line()], recorder.order.rows
        if len(rows) > 20:
            if self._threshold:
                noisy = too_noisy(recorder.noise(), self._threshold, unit)
                found[0] += f" (threshold {self._threshold:g}: {'ABOVE IT' if noisy else 'it will arm'})"
                found += [noisy] if noisy else []
            found.append(self._rates())
            if swing := measured(recorder, KEEP):
                found.append(swing)
            if count := saturated(recorder, rows):
                low, high = self.settings["range"]
                found.append(f"SATURATED: {count} of the last samples are at the end of {low:g} to {high:g}")
            found += trace_of(recorder, _WIDTH) if trace else []
        return found

    def _rates(self):
        recorder, parts = self.recorder, []
        if by_host := recorder.measured_rate():
            parts.append(f"{by_host:.2f} S/s by this computer")
        if by_device := recorder.device_rate():
            parts.append(f"{by_device:.2f} S/s by the board's clock")
        lost = "{} lost, {} damaged".format(*losses(recorder.order.missing))
        return " | ".join([*parts, f"rate_hz {recorder.rate:g}", lost])


def went_away(opened, error, before="", then=""):
    """What is told where the source went away: ``before`` which recording, and what the same command does ``then``."""
    problem = f"the port went away{before} ({error or type(error).__name__})"
    mend = f"plug it in and run the same command again{then}"
    return InputError(f"capture.port, {opened.name}", problem, "a board that stays plugged in", mend)


def angle_of(settings):
    """A function that turns a signal into degrees, or into None where nobody knows how: volts need a calibration."""
    unit = settings["signal_unit"]
    if unit in ("deg", "rad"):
        return lambda value: value if unit == "deg" else math.degrees(value)
    if unit == "counts" and settings.get("counts_per_revolution"):
        return lambda value: 360 * value / settings["counts_per_revolution"]
    if unit == "V" and CALIBRATION.is_file():
        try:
            line = dataset.read(CALIBRATION)["line"].sel(mode="gum")
        except (InputError, KeyError):
            return lambda value: None
        slope, intercept = (float(line.sel(coefficient=name)) for name in ("slope", "intercept"))
        return lambda value: math.degrees(intercept + slope * value)
    return lambda value: None


def watch(settings, show, stop):
    """A last line on the signal, when it is told to stop.

    Parameters
    ----------
    settings
        The config's ``capture``.
    show
        Called with a list of lines a few times a second.
    stop
        The event that ends it.

    Raises
    ------
    InputError
        If the source cannot be used, or goes away.
    """
    settings = source.completed(settings)
    opened = source.connect(settings)
    if opened.rate:
        settings["rate_hz"] = opened.rate
    listener, shown = Listener(opened), 0.0
    try:
        monitor = Monitor(settings, listener.began)
        while not stop.is_set():
            arrival, data = listener.take() or (None, None)
            if isinstance(data, Exception):
                raise went_away(opened, data)
            if arrival is not None:
                monitor.feed(data, arrival)
            if time.monotonic() - shown > _SHOW:
                show(monitor.lines())
                shown = time.monotonic()
        return "\n".join(["nothing was recorded; at the end:", *monitor.lines(trace=False)])
    finally:
        listener.close()
