"""The device's clock against the host's: a wrong rate, a stall and a jump are told, and a host that jitters is not."""

import arrivals
import numpy as np
import pytest
from traffic import SETTINGS, frame

import swingdown
from swingdown.capture.clocks import compare
from swingdown.capture.recorder import Recorder
from swingdown.capture.take import to_dataset
from swingdown.engine.trajectory import simulate
from swingdown.pendulum.model import Model

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
def test_a_rate_as_good_as_a_resonator_is_measured_and_corrected(rate):
    made = played(counted(rate))
    assert not made.problems()
    data = to_dataset(made, {})
    assert data["time"].values == pytest.approx(np.arange(1000) / rate, abs=0.003)
    assert data.attrs["partial"] == "no"
    assert ("times are corrected by it" in data.attrs["remarks"]) == (rate != 100)


def simulated(name="1 ms", seed=1, **fault):
    """A Recorder of a board with this fault and arrivals of this scatter, and when its samples were taken."""
    true = arrivals.sent(**fault)
    came = arrivals.SCATTER[name](true, np.random.default_rng(seed))
    swing = np.round(512 + 300 * np.cos(5.9658 * true)).astype(int)
    made = Recorder({**SETTINGS, "duration_s": len(true) / arrivals.TOLD, "timeout_s": 2}, 99.0)
    for k, at in enumerate(came):
        made.feed(frame(k, int(swing[k])), 100 + at)
    assert made.status == "complete"
    return made, true - true[0]


def test_the_period_of_a_swing_is_right_although_the_rate_changes():
    """110 then 90 samples a second: a straight count of samples gave a period that was 9 % off, and said nothing."""
    truth = Model("viscous", {"natural_frequency": 5.9658, "viscous_ratio": 0.004})
    true = arrivals.sent(**arrivals.WANDERS["110 then 90"])
    angles = simulate(truth, true - true[0], 0.35)
    came = arrivals.scattered(true, np.random.default_rng(2))
    made = Recorder(
        {**SETTINGS, "duration_s": 20, "scale": 0.001, "signal_unit": "rad", "timeout_s": 2}, 99.0
    )
    for k, at in enumerate(came):
        made.feed(frame(k, 400 + round(1000 * angles[k])), 100 + at)
    data = to_dataset(made, {})
    found = swingdown.fit(data["time"].values, data["angle"].values - 0.4, fitted=["viscous"])
    value, error, _ = found.quantities["natural_frequency"]
    timing = data.attrs["time_standard_uncertainty_s"] / 20  # of the times, over the recording
    assert value == pytest.approx(5.9658, abs=3 * np.hypot(error, 5.9658 * timing))
    assert (
        error < 0.003 and data.attrs["partial"] == "yes"
    )  # what its wandering clock leaves counts for the free courses, too


def off(made, true):
    """By how much (s, standard deviation) the recording's times are wrong, and what it says they are."""
    data = to_dataset(made, {})
    return np.std(data["time"].values - true), data.attrs["time_standard_uncertainty_s"]


@pytest.mark.parametrize("scatter", arrivals.SCATTER)
@pytest.mark.parametrize("fault", arrivals.WANDERS)
def test_a_rate_that_changes_is_told_and_corrected(fault, scatter):
    """The mean is the rate said, or close to it, and each time in between was wrong by up to 0.9 s."""
    made, true = simulated(scatter, **arrivals.WANDERS[fault])
    assert any("the board's rate changes" in told for told in made.problems())
    wrong, said = off(made, true)
    assert wrong < 2 * said < 0.02


@pytest.mark.parametrize("fault", arrivals.SMALL)
def test_a_change_of_0_3_percent_over_3_s_is_told_and_corrected(fault):
    made, true = simulated(**arrivals.SMALL[fault])
    assert any("the board's rate changes" in told for told in made.problems())
    wrong, said = off(made, true)
    assert wrong < 2 * said < 0.001


@pytest.mark.parametrize(
    ("fault", "told"),
    [
        ("110 then 90", "110 until 10.0 s, 90 from then on (a second)"),
        ("100 then 98", "100 until 10.0 s, 98 from then on (a second)"),
        ("thirds at 103, 97, 100", "103 until 6.7 s, 97 until 13.3 s, "),
        ("104 falling to 96", "most 10"),
    ],
)
def test_when_a_rate_changes_is_told(fault, told):
    made, _ = simulated(**arrivals.WANDERS[fault])
    assert told in made.problems()[0]


@pytest.mark.parametrize("fault", arrivals.STALLS)
def test_a_stall_of_four_intervals_is_told_wherever_it_is(fault):
    made, true = simulated(stalls=arrivals.STALLS[fault])
    ((at, long),) = arrivals.STALLS[fault]
    (told,) = made.problems()
    assert f"stood still for {long:.2f} s at about {at:.1f} s" in told
    wrong, said = off(made, true)
    assert wrong < 2 * said < 0.002


def test_stalls_that_a_faster_rate_makes_up_are_told():
    made, true = simulated(rate=arrivals.made_up, stalls=[(5, 0.3), (10, 0.3), (15, 0.3)])
    told = " ".join(made.problems())
    assert "stood still for 0.30 s at about 5.0 s" in told and "the board's rate changes" in told
    wrong, said = off(made, true)
    assert wrong < 2 * said < 0.002


@pytest.mark.parametrize(("rate", "seconds"), [(99.3, 20), (100.55, 60)])
def test_a_steady_offset_is_told_and_corrected(rate, seconds):
    made, true = simulated(rate=arrivals.steady(rate), seconds=seconds)
    said = float(made.problems()[0].split("set rate_hz: ")[1].split(",")[0])
    assert said == pytest.approx(rate, rel=5e-5)
    wrong, said = off(made, true)
    assert wrong < 2 * said < 0.002


@pytest.mark.parametrize("scatter", arrivals.SCATTER)
def test_a_sound_clock_is_sound_and_what_could_not_be_seen_is_told(scatter):
    for seed in range(5):
        made, true = simulated(scatter, seed=seed)
        assert not made.problems()
        assert off(made, true)[0] < 0.001
        told = to_dataset(made, {}).attrs["remarks"]
        least = float(told.split("a stall below ")[1].split(" ms")[0])
        assert 10 < least < 40 and "may have passed unseen" in told


def test_what_could_not_be_seen_grows_with_the_scatter_of_arrivals():
    random, true = np.random.default_rng(1), arrivals.sent()
    times = np.arange(len(true)) / arrivals.TOLD
    found = [compare(times, arrivals.scattered(true, random, size)) for size in (0.001, 0.005, 0.03)]
    assert found[0].unseen_stall < found[1].unseen_stall < 0.04 < found[2].unseen_stall
    assert found[0].unseen_change < 0.003 < found[1].unseen_change < found[2].unseen_change
    assert found[0].uncertainty < found[1].uncertainty < found[2].uncertainty


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
    pieces = pieces + LATE[: len(pieces)]
    arrivals = pieces[np.searchsorted(pieces, times)]
    found = compare(times, arrivals)
    assert found.steady and not found.wrong and abs(found.ratio - 1) < 0.002


def test_too_few_samples_say_nothing():
    assert compare([0, 1, 2], [0, 1, 2]) is None
