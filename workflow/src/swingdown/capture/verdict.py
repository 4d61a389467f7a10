"""What a recording's clocks and values say against it, beside the frames that are missing: as sentences, each with its mend."""

import numpy as np
import numpy.typing as npt

from . import clocks

UNLIKE = (
    0.2  # part; with an interval that far from 1/rate_hz, times alone do not tell how many samples are lost
)


def of(recorder) -> list[str]:
    """The sentences; none where nothing is wrong. ``recorder`` has ended, or stands still for the moment."""
    if len(recorder.rows) < 2:
        return []
    return [*_clocks(recorder), *_saturated(recorder)]


def _clocks(recorder):
    rows, found = recorder.rows, []
    times = np.array([row.time for row in rows])
    duration = float(times[-1] - times[0])
    by_device, jumped = recorder.device_rate(), False
    if by_device:
        beyond, at = clocks.jump([row.position for row in rows], times)
        if jumped := at > 0:
            found.append(
                f"the device's clock jumps by {beyond:+.3g} s at {times[at - 1] - recorder.zero:.2f} s, where no sample is missing"
            )
        if not recorder.order.numbered and abs(by_device / recorder.rate - 1) > UNLIKE:
            found.append(
                f"samples come {by_device:.4g} a second by the device's clock and capture.rate_hz is {recorder.rate:g}: losses "
                f"cannot be counted; set rate_hz: {by_device:.4g}"
            )
    compared = clocks.compare(times, [row.arrival for row in rows])
    if compared is None:
        return found
    if compared.stall and not jumped:
        what = "stood still for" if compared.stall > 0 else "jumped ahead by"
        found.append(
            f"the device's clock {what} {abs(compared.stall):.2f} s at about {compared.at - recorder.zero:.1f} s, by the host's: "
            "times after it are wrong"
        )
    if compared.off(duration):
        found.append(_rates(recorder, compared.ratio, by_device))
    return found


def _rates(recorder, ratio, by_device):
    part = f"{abs(1 - 1 / ratio):.1%}"
    if by_device:
        return f"the device's clock is {part} {'slow' if ratio > 1 else 'fast'} against the host's, and so are all times"
    measured = recorder.rate / ratio
    return (
        f"the board sends {measured:.5g} samples a second by the host's clock and capture.rate_hz is {recorder.rate:g}: "
        f"times and frequencies are {part} off; set rate_hz: {measured:.4g}, or send the device's time in a column"
    )


def _saturated(recorder):
    limits = recorder.settings.get("range")
    if not limits:
        return []
    count = saturated([row.value * recorder.scale for row in recorder.rows], limits)
    unit = recorder.settings["signal_unit"]
    told = f"{count} samples at the end of the range {limits[0]:g} to {limits[1]:g} {unit}: the true signal lies beyond"
    return [told] if count else []


def saturated(values: npt.ArrayLike, limits: tuple[float, float]) -> int:
    """How many of ``values`` lie at or beyond the ends of ``limits`` (lowest, highest)."""
    values = np.asarray(values, float)
    return int(np.sum((values <= limits[0]) | (values >= limits[1])))
