"""What a recording's clocks and values say of it, beside the frames that are missing: as sentences, each with its mend."""

import numpy as np

from ..rounding import again, value_with_uncertainty
from . import clocks

# part; with an interval that far from 1/rate_hz, times alone do not tell how many samples are lost
UNLIKE = 0.2
_LISTED = 3  # stalls, or rates, that are told one by one


def against(recorder) -> list[str]:
    """What speaks against the recording; nothing where nothing is wrong. ``recorder`` has ended, or stands still for the moment."""
    if len(recorder.rows) < 2:
        return []
    return [*_clocks(recorder), *_constant(recorder), *_saturated(recorder)]


def about(recorder) -> list[str]:
    """What is to be known of a recording's times, and speaks against nothing."""
    compared = recorder.compared()
    if compared is None:
        return [
            "too few arrivals to compare the board's clock with the host's: capture.rate_hz is not checked"
        ]
    found = []
    if compared.steady and compared.apart and not compared.wrong:
        found.append(
            f"{_rate(recorder, compared.ratio, compared.u_ratio)} by the host's clock: times are corrected by it"
        )
    elif not compared.steady:
        found.append("times are corrected by the host's clock")
    return [
        *found,
        f"standard uncertainty of the times {1e3 * compared.uncertainty:.2g} ms; arrivals scatter by {1e3 * compared.scatter:.2g} ms: "
        f"a stall below {1e3 * compared.unseen_stall:.0f} ms, or a change of the rate below {compared.unseen_change:.1%} over "
        f"{clocks.STRETCH:g} s, may have passed unseen",
    ]


def _clocks(recorder):
    rows, found = recorder.rows, []
    by_device, jumped = recorder.device_rate(), False
    if by_device:
        times = np.array([row.time for row in rows])
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
    compared = recorder.compared()
    if compared is None or jumped:
        return found
    if compared.stalls:
        found.append(_stalled(recorder, compared))
    if compared.wanders:
        found.append(_wandered(recorder, compared))
    elif compared.wrong:
        found.append(_wrong(recorder, compared.ratio))
    return found


def _when(recorder, compared, at):
    """The time (s) in the recording of what happens just after ``at`` by the device's clock."""
    zero, at = (float(compared.corrected([one])[0]) for one in (recorder.zero, at - compared.interval / 2))
    return at - zero


def _stalled(recorder, compared):
    told = [
        f"{'stood still for' if one.seconds > 0 else 'jumped ahead by'} {abs(one.seconds):.2f} s at about {_when(recorder, compared, one.at):.1f} s"
        for one in compared.stalls[:_LISTED]
    ]
    return f"the device's clock {', '.join(told)}{again(len(compared.stalls) - len(told))}, by the host's"


def _wandered(recorder, compared):
    unit, each = ("a second", recorder.rate) if not recorder.timed else ("seconds in one of the host's", 1.0)
    what = "the board's rate changes" if not recorder.timed else "the device's clock wanders"
    if len(compared.courses) <= _LISTED:
        told = [
            f"{each / one.ratio:.4g} until {_when(recorder, compared, one.until):.1f} s"
            for one in compared.courses[:-1]
        ]
        told.append(f"{each / compared.courses[-1].ratio:.4g} from then on")
    else:
        ends = [pick(compared.courses, key=lambda one: one.ratio) for pick in (min, max)]
        told = [
            f"{word} {each / one.ratio:.4g} at {_when(recorder, compared, (one.since + one.until) / 2):.1f} s"
            for word, one in zip(("most", "least"), ends, strict=True)
        ]
    return f"{what}, by the host's clock: {', '.join(told)} ({unit})"


def _wrong(recorder, ratio):
    part = f"{abs(1 - 1 / ratio):.1%}"
    if recorder.timed:
        return f"the device's clock is {part} {'slow' if ratio > 1 else 'fast'} against the host's"
    measured = recorder.rate / ratio
    return (
        f"the board sends {measured:.5g} samples a second by the host's clock and capture.rate_hz is {recorder.rate:g}, "
        f"{part} off; set rate_hz: {measured:.5g}, or send the device's time in a column"
    )


def _rate(recorder, ratio, u_ratio):
    if recorder.timed:
        return f"the device's clock goes {value_with_uncertainty(1 / ratio, u_ratio)} s in a second"
    told = value_with_uncertainty(recorder.rate / ratio, recorder.rate * u_ratio)
    return f"the board sends {told} samples a second where capture.rate_hz is {recorder.rate:g},"


def _constant(recorder):
    """A sensor that is at its rail, or not connected, where a swing was to be recorded."""
    if recorder.settings.get("still"):
        return []  # a bob at rest, read in steps
    values = {row.value for row in recorder.rows}
    if len(values) > 1:
        return []
    value = values.pop() * recorder.scale
    return [
        f"all {len(recorder.rows)} samples are {value:g} {recorder.settings['signal_unit']}: a sensor at its rail, or not connected; "
        "check the wiring, or say role=static for a bob at rest"
    ]


def _saturated(recorder):
    if not (count := saturated(recorder, recorder.rows)):
        return []
    (low, high), unit = recorder.settings["range"], recorder.settings["signal_unit"]
    return [
        f"{count} samples at the end of the range {low:g} to {high:g} {unit}: the true signal lies beyond"
    ]


def saturated(recorder, rows) -> int:
    """How many of a recorder's ``rows`` lie at or beyond the ends of its range (lowest, highest); 0 where it has none."""
    low, high = recorder.settings.get("range") or (-np.inf, np.inf)
    values = np.array([row.value * recorder.scale for row in rows])
    return int(np.sum((values <= low) | (values >= high)))
