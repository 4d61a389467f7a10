"""The device's clock against the host's: a wrong rate, a stall and a jump are told, and a host that jitters is not."""

import numpy as np
import pytest
from traffic import SETTINGS, frame

from swingdown.capture.clocks import compare
from swingdown.capture.recorder import Recorder
from swingdown.capture.take import to_dataset

LATE = np.random.default_rng(7).exponential(0.004, 10_000)  # s; what a host under load adds to each arrival


def played(lines, **more):
    """The Recorder of (arrival, bytes) pairs."""
    made = Recorder({**SETTINGS, "duration_s": 10, **more}, 99.0)
    for k, (arrival, data) in enumerate(lines):
        made.feed(data, 100 + arrival + LATE[k])
    return made


def counted(rate, seconds=12, stall=None):
    """Frames ``rate`` a second; from ``stall`` = (when, how long) the board stands still, and counts on where it was."""
    when, long = stall or (0, 0)
    return [
        (k / rate + long * (k / rate >= when), frame(k, 300 + k % 500)) for k in range(int(seconds * rate))
    ]


def timed(rate, seconds=12, sent=lambda k, t: (k, 1000 * t)):
    """Lines sequence, time_ms, value."""
    found = []
    for k in range(int(seconds * rate)):
        number, ms = sent(k, k / rate)
        found.append((k / rate, b"%d,%d,%d\n" % (number, round(ms), 300 + k % 500)))
    return [(0, b"\n"), *found]


COLUMNS = {"format": "csv", "columns": ["sequence", "time_ms", "value"]}
CLOCKED = {"format": "csv", "columns": ["time_ms", "value"]}


@pytest.mark.parametrize("rate", [97, 103, 108])
def test_a_rate_that_is_not_the_one_said_makes_the_recording_partial_and_names_both(rate):
    """A ``delay(10)`` loop: every natural frequency would come out 3 to 8 % off."""
    attrs = to_dataset(played(counted(rate)), {}).attrs
    assert attrs["status"] == "complete" and attrs["partial"] == "yes"
    told = attrs["problems"]
    said = float(told.split("set rate_hz: ")[1].split(",")[0])
    assert said == pytest.approx(rate, rel=0.001) and "capture.rate_hz is 100" in told


@pytest.mark.parametrize("rate", [99.8, 100, 100.2])
def test_a_rate_as_good_as_a_resonator_is_fine(rate):
    assert not played(counted(rate)).problems()


@pytest.mark.parametrize("when", [3, 7.2, 9])
def test_a_board_that_stands_still_and_counts_on_is_told(when):
    """1.9 s, less than the silence that ends a recording: all times after it are 1.9 s too early."""
    made = played(counted(100, 14, (when, 1.9)), timeout_s=2)
    told = made.problems()
    assert made.status == "complete" and len(told) == 1
    assert "stood still for 1.9" in told[0]
    assert float(told[0].split("at about ")[1].split(" s")[0]) == pytest.approx(when, abs=0.5)


@pytest.mark.parametrize("ahead", [1.5, 0.3])
def test_a_device_clock_that_jumps_while_its_numbers_go_on_is_told(ahead):
    lines = timed(100, sent=lambda k, t: (k, 1000 * (t + ahead * (t >= 5))))
    made = played(lines, **COLUMNS)
    assert made.status == "complete"
    assert any(f"jumps by +{ahead:.3g} s at 4.99 s" in told for told in made.problems())


@pytest.mark.parametrize("rate", [97, 103])
def test_a_time_column_needs_no_exact_rate(rate):
    """The times are the device's own, so a ``delay(10)`` loop that prints ``millis()`` is whole."""
    made = played(timed(rate), **COLUMNS)
    assert made.status == "complete" and not made.problems()
    assert made.rows[-1].time - made.zero == pytest.approx(10, abs=0.02)
    assert to_dataset(made, {}).attrs["expected"] == len(made.rows)


def test_a_device_clock_that_runs_slow_is_told():
    made = played(timed(100, sent=lambda k, t: (k, 970 * t)), **COLUMNS)
    assert "3.0% slow" in " ".join(made.problems())


@pytest.mark.parametrize("columns", [COLUMNS, CLOCKED])
@pytest.mark.parametrize("rate", [115, 200])
def test_the_end_is_the_devices_time_and_no_count(columns, rate):
    lines = timed(rate)
    if columns is CLOCKED:
        lines = [(at, data.partition(b",")[2] or data) for at, data in lines]
    made = played(lines, **columns)
    assert made.status == "complete"
    assert made.rows[-1].time - made.zero == pytest.approx(10, abs=0.02)
    assert len(made.rows) == pytest.approx(10 * rate, abs=2)
    uncounted = rate == 200 and columns is CLOCKED  # nothing tells a lost sample from an interval of rate_hz
    assert any(f"set rate_hz: {rate}" in told for told in made.problems()) == uncounted


def test_a_host_that_looks_late_blames_no_board():
    """Pieces of a third of a second, and once one of two seconds: within each only the last sample came on time."""
    times = np.arange(3000) / 100
    pieces = np.unique(np.r_[np.arange(0.33, 30, 0.33), 30])
    pieces = pieces[(pieces < 12) | (pieces > 14)]
    arrivals = pieces[np.searchsorted(pieces, times)] + 0.02 * np.sin(times)
    found = compare(times, arrivals)
    assert found.stall == 0 and abs(found.ratio - 1) < 0.002


def test_too_few_samples_say_nothing():
    assert compare([0, 1, 2], [0, 1, 2]) is None
