"""What a recording's clocks and values say of it, in sentences with the mend."""

from types import SimpleNamespace

import numpy as np
import pytest

from swingdown.capture import remarks
from swingdown.capture.clocks import Comparison, Course, Stall
from swingdown.capture.order import Row


def compared(ratio=1.0, u_ratio=1e-5, stalls=(), courses=None, wanders=False):
    """What the host's clock says of 20 s."""
    courses = (Course(0.0, 20.0, ratio),) if courses is None else courses
    return Comparison(
        ratio, u_ratio, tuple(stalls), tuple(courses), wanders, 0.0012, 0.01, 0.00034, 0.0415, 0.0021,
        (np.array([0.0, 20.0]), np.zeros(2)),
    )  # fmt: skip


def recorder(found=None, values=(1, 2), rate=100, by_device=None, numbered=True, step=0.01, **settings):
    """A recording that has ended, beside what its clocks say."""
    rows = [Row(k, k * step, k * step, value) for k, value in enumerate(values)]
    return SimpleNamespace(
        rows=rows, rate=rate, scale=0.5, zero=0.0, timed=by_device is not None, order=SimpleNamespace(numbered=numbered),
        settings={"signal_unit": "V"} | settings, compared=lambda: found, device_rate=lambda: by_device,
    )  # fmt: skip


def test_a_sound_recording_says_nothing_against_itself():
    assert remarks.against(recorder(compared())) == [] and remarks.against(recorder(None)) == []
    assert remarks.against(recorder(compared(1.1), values=[1])) == []  # of one sample nothing is known


@pytest.mark.parametrize(
    ("found", "by_device", "told"),
    [
        (compared(1.02), None, "the board sends 98.039 samples a second by the host's clock and capture.rate_hz is 100, 2.0% off; set rate_hz: 98.039, or send the device's time in a column"),
        (compared(1.02), 100.0, "the device's clock is 2.0% slow against the host's"),
        (compared(0.98), 100.0, "the device's clock is 2.0% fast against the host's"),
        (compared(stalls=[Stall(7.0, 0.12)]), 100.0, "the device's clock stood still for 0.12 s at about 7.0 s, by the host's"),
        (compared(stalls=[Stall(3.0, -0.2), Stall(7.0, 0.12)]), 100.0, "the device's clock jumped ahead by 0.20 s at about 3.0 s, stood still for 0.12 s at about 7.0 s, by the host's"),
        (compared(stalls=[Stall(float(k), 0.1) for k in range(5)]), 100.0, " and 2 times more, by the host's"),
        (compared(courses=[Course(0.0, 8.0, 1.01), Course(8.0, 20.0, 0.99)], wanders=True), None, "the board's rate changes, by the host's clock: 99.01 until 8.0 s, 101 from then on (a second)"),
        (compared(courses=[Course(0.0, 8.0, 1.01), Course(8.0, 20.0, 0.99)], wanders=True), 100.0, "the device's clock wanders, by the host's clock: 0.9901 until 8.0 s, 1.01 from then on (seconds in one of the host's)"),
        (compared(courses=[Course(5.0 * k, 5.0 * k + 5, 1 + 0.01 * (k - 1)) for k in range(3)], wanders=True), None, "by the host's clock: 101 until 5.0 s, 100 until 10.0 s, 99.01 from then on (a second)"),
        (compared(courses=[Course(5.0 * k, 5.0 * k + 5, 1 + 0.01 * (k - 1)) for k in range(4)], wanders=True), None, "by the host's clock: most 101 at 2.5 s, least 98.04 at 17.5 s (a second)"),
    ],
)  # fmt: skip
def test_a_clock_that_is_wrong_is_told_with_where_and_by_how_much(found, by_device, told):
    (said,) = remarks.against(recorder(found, by_device=by_device))
    assert told in said


def test_a_clock_that_jumps_where_no_sample_is_missing_is_told_once():
    made = recorder(compared(1.5), values=range(20), by_device=100.0)
    made.rows = [row._replace(time=row.time + (0.75 if row.position > 11 else 0)) for row in made.rows]
    assert remarks.against(made) == [
        "the device's clock jumps by +0.75 s at 0.11 s, where no sample is missing"
    ]


def test_an_interval_unlike_the_rate_that_was_said_hides_losses():
    (said,) = remarks.against(recorder(compared(), by_device=50.0, numbered=False))
    assert said.startswith("samples come 50 a second by the device's clock and capture.rate_hz is 100: losses cannot be counted; set rate_hz: 50")  # fmt: skip
    assert remarks.against(recorder(compared(), by_device=50.0)) == []
    assert remarks.against(recorder(compared(), by_device=81.0, numbered=False)) == []
    assert len(remarks.against(recorder(compared(), by_device=79.0, numbered=False))) == 1


def test_a_sensor_at_its_rail_or_the_end_of_its_range_is_told():
    (said,) = remarks.against(recorder(compared(), values=[7] * 9))
    assert said.startswith("all 9 samples are 3.5 V: a sensor at its rail, or not connected")
    assert remarks.against(recorder(compared(), values=[7] * 9, still=True)) == []
    (said,) = remarks.against(recorder(compared(), values=[0, 2, 4, 10, 10, 12], range=[0, 5]))
    assert said == "4 samples at the end of the range 0 to 5 V: the true signal lies beyond"
    assert remarks.against(recorder(compared(), values=[1, 9], range=[0, 5])) == []


def test_what_is_to_be_known_of_the_times_speaks_against_nothing():
    (few,) = remarks.about(recorder(None))
    assert few == "too few arrivals to compare the board's clock with the host's: capture.rate_hz is not checked"  # fmt: skip
    (known,) = remarks.about(recorder(compared()))
    assert known == (
        "standard uncertainty of the times 0.34 ms; arrivals scatter by 1.2 ms: a stall below 42 ms, or a change of the rate below "
        "0.2% over 3 s, may have passed unseen"
    )  # fmt: skip
    corrected, _ = remarks.about(recorder(compared(1.001)))
    assert corrected == "the board sends 99.9001(10) samples a second where capture.rate_hz is 100, by the host's clock: times are corrected by it"  # fmt: skip
    timed, _ = remarks.about(recorder(compared(1.001), by_device=100.0))
    assert timed == "the device's clock goes 0.999001(10) s in a second by the host's clock: times are corrected by it"  # fmt: skip
    stalled, _ = remarks.about(recorder(compared(stalls=[Stall(7.0, 0.12)])))
    assert stalled == "times are corrected by the host's clock"
    assert len(remarks.about(recorder(compared(1.02)))) == 1  # that it is wrong is a problem, and told as one
