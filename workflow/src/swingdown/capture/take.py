"""A recording that has ended as a dataset, and on disk: never in the place of another."""

from datetime import UTC, datetime
from pathlib import Path

import numpy as np
import xarray as xr

from .. import dataset
from ..errors import InputError
from . import remarks
from .order import losses

SIGNALS = {  # unit: variable, what it is
    "V": ("voltage", "voltage of the angle sensor"),
    "rad": ("angle", "angle as recorded"),
    "deg": ("angle", "angle as recorded"),
    "counts": ("counts", "counts as recorded"),
    "rad/s": ("rate", "angular rate as recorded"),
}


def to_dataset(recorder, about):
    """The dataset of a recording that has ended with at least one sample; ``about`` are texts by name, which join the attributes.

    Along ``time`` (s; 0 is the release, or the first sample): the value as sent, the signal in its unit, the device's sequence number
    (unwrapped) and the host's arrival time (s since 1970, UTC). Along ``gap``: the sequence numbers that are missing, and whether they came
    damaged.
    """
    settings, rows = recorder.settings, recorder.rows
    unit = settings["signal_unit"]
    name, text = SIGNALS[unit]
    values = np.array([row.value for row in rows])
    if np.all(values == np.round(values)) and np.all(np.abs(values) < 2**31):
        values = values.astype("int32")
    numbers = np.array([row.position for row in rows], dtype="int64")
    missing = recorder.missing
    variable, arrivals = dataset.variable, [row.arrival for row in rows]
    arrived = "arrival at the host, in Unix time (UTC); jitters and is no time base"
    lost = np.array([position for position, _ in missing], dtype="int64")
    came = np.array([damaged for _, damaged in missing], dtype="int8")
    variables = {
        "sent": variable("time", values, "value as the device sent it", "1"),
        name: variable("time", values * float(recorder.scale), text, unit),
        "sequence": variable("time", numbers, "sequence number of the device, unwrapped"),
        "arrival": variable("time", arrivals, arrived, "s"),
        "missing_sequence": variable("gap", lost, "sequence number that is missing"),
        "missing_damaged": variable("gap", came, "1 where the frame came damaged, 0 where it never came"),
    }
    times, clock, about_times = _times(recorder)
    lost_frames, damaged = losses(missing)
    problems = recorder.problems() + list(about.pop("problems", ()))
    attrs = {
        "status": recorder.status,
        "partial": "yes" if problems else "no",
        "problems": "; ".join(problems),
        "remarks": "; ".join([*about.pop("remarks", ()), *remarks.about(recorder)]),
        "expected": recorder.expected,
        "received": len(rows),
        "lost": lost_frames,
        "damaged": damaged,
        "repeated": recorder.order.repeated,
        "triggered": "yes" if recorder.trigger else "no",
        "rate_hz": float(recorder.rate),
        "rate_by_host_hz": float(recorder.measured_rate() or np.nan),
        "units_per_count": float(recorder.scale),
        "started": datetime.fromtimestamp(rows[0].arrival, UTC).isoformat(timespec="milliseconds"),
        **{key: settings[key] for key in ("format", "operator", "apparatus", "notes")},
        "emulated": "yes" if settings["emulated"] else "no",
        "captured": "yes",
        **about_times,
        **about,
    }
    return xr.Dataset(variables, {"time": ("time", times, clock)}, attrs)


def _times(recorder):
    """The times (s) of a recording, their attributes, and the recording's that tell how well they are known.

    They are the device's, corrected where the host's clock establishes a difference (``clocks``). ``clock_ratio`` is seconds by
    the host for one by the device.
    """
    device, zero = np.array([row.time for row in recorder.rows]), recorder.zero
    attrs = {"units": "s", "long_name": "time on the device's clock since the release or the first sample"}
    compared = recorder.compared()
    if compared is None:
        return device - zero, attrs, {}
    known = {
        "clock_ratio": compared.ratio,
        "clock_ratio_uncertainty": compared.u_ratio,
        "time_standard_uncertainty_s": compared.uncertainty,
    }
    times = compared.corrected(device)
    if times is device:
        return device - zero, attrs, known
    attrs["long_name"] = (
        "time since the release or the first sample: the device's, corrected by the host's clock"
    )
    return times - np.interp(zero, device, times), attrs, known


def write_new(data, path):
    """The path at which the dataset was written; InputError if there is a file of that name, which is left as it is."""
    check_absent(path)
    try:
        return dataset.write(data, path, replace=False)
    except FileExistsError:
        raise _there(path) from None


def check_absent(path):
    """None, or InputError if there is a recording at ``path``."""
    if Path(path).exists():
        raise _there(path)


def _there(path):
    problem = "there is a recording of this name, and a recording is never overwritten"
    expected = "a name that is not taken"
    return InputError(path, problem, expected, "choose another name, or move the file away yourself")
