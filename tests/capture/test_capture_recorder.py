"""How a recording begins and ends: the release, the count, the four statuses, what it says is missing."""

import numpy as np
import pytest
from traffic import SETTINGS, frame, frames

from swingdown.capture.recorder import Recorder
from swingdown.capture.take import to_dataset

TRIGGER = {"threshold": 5, "pre_s": 0.2, "wait_s": 30}


@pytest.fixture
def recorder():
    """A function that makes a Recorder and feeds it values at 100 S/s, each as a frame on time."""

    def make(values=(), first=0, start=100.0, **more):
        made = Recorder({**SETTINGS, **more}, start)
        feed(made, values, first, start)
        return made

    return make


def listen(made, start, end):
    """Looks at the line every 50 ms, and nothing comes."""
    for k in range(round((end - start) / 0.05)):
        made.tick(start + (k + 1) * 0.05)


def feed(made, values, first=0, start=100.0):
    for k, value in enumerate(values):
        made.feed(frame(first + k, int(value)), start + k / 100)


def test_a_fixed_duration_is_a_count_of_samples(recorder):
    made = recorder(range(300, 500))
    data = to_dataset(made, {})
    assert made.status == "complete" and data.attrs["partial"] == "no"
    assert list(data["sent"].values) == list(range(300, 400))
    assert data["time"].values == pytest.approx(np.arange(100) / 100)
    assert data.attrs["expected"] == data.attrs["received"] == 100


def test_the_signal_is_what_was_sent_in_its_unit(recorder):
    data = to_dataset(recorder(range(300, 500), scale=0.5), {"campaign": "mine"})
    assert data["voltage"].attrs["units"] == "V"
    assert data["voltage"].values == pytest.approx(np.arange(300, 400) / 2)
    assert data.attrs["emulated"] == "yes" and data.attrs["campaign"] == "mine"
    assert data["arrival"].values == pytest.approx(100 + np.arange(100) / 100)


def test_the_release_starts_it_and_what_came_just_before_is_kept(recorder):
    held = [700, 701] * 50
    swing = [max(700 - k * k / 10, 0) for k in range(200)]
    made = recorder(held + swing, trigger=TRIGGER)
    data = to_dataset(made, {})
    assert made.status == "complete"
    time, sent = data["time"].values, data["sent"].values
    assert time[0] == pytest.approx(-0.2) and time[-1] == pytest.approx(0.99)
    assert abs(sent[time < 0] - 700.5).max() <= 5.5
    assert abs(sent[time == 0].item() - 700.5) > 5
    assert data.attrs["expected"] == 120 and data.attrs["triggered"] == "yes"


def test_it_is_armed_only_when_the_bob_is_still(recorder):
    lifted = list(range(500, 700, 2))
    made = recorder(lifted, trigger=TRIGGER)
    assert made.state == "waiting"
    feed(made, [700] * 21, 100, 101)
    assert made.state == "armed"


def test_a_spike_is_no_release(recorder):
    made = recorder([700] * 50 + [900, 900] + [700] * 50, trigger=TRIGGER)
    assert made.state == "armed" and not made.rows


def test_a_hand_that_sinks_slowly_is_no_release(recorder):
    made = recorder([700] * 50 + [700 - k // 20 for k in range(300)], trigger=TRIGGER)
    assert made.state == "armed"


def test_frames_lost_during_the_wait_are_not_the_recordings(recorder):
    made = recorder([700] * 30, trigger=TRIGGER)
    feed(made, [700] * 40 + [600] * 120, 35, 100.35)
    assert made.status == "complete" and not made.missing and not made.problems()


def test_lost_and_damaged_frames_are_told_by_their_numbers(recorder):
    made = recorder(range(300, 350))
    broken = bytearray(frame(50, 350))
    broken[4] ^= 1
    made.feed(bytes(broken), 100.5)
    feed(made, range(352, 450), 52, 100.52)
    data = to_dataset(made, {})
    assert made.status == "complete" and data.attrs["partial"] == "yes"
    assert list(data["missing_sequence"].values) == [50, 51]
    assert list(data["missing_damaged"].values) == [1, 0]
    assert (data.attrs["lost"], data.attrs["damaged"], data.attrs["received"]) == (1, 1, 98)
    assert "1 frames lost and 1 damaged of 100" in data.attrs["problems"]


def test_frames_lost_over_the_end_count_only_as_far_as_the_recording_goes(recorder):
    made = recorder(range(300, 398))
    feed(made, [500] * 5, 104, 101.04)
    data = to_dataset(made, {})
    assert made.status == "complete" and data.attrs["received"] == 98
    assert list(data["missing_sequence"].values) == [98, 99]
    assert data["time"].values[-1] == pytest.approx(0.97)


def test_silence_ends_it(recorder):
    made = recorder(range(300, 350))
    listen(made, 100.5, 100.9)
    assert made.state == "recording"
    listen(made, 100.9, 101.1)
    data = to_dataset(made, {})
    assert data.attrs["status"] == "timed out" and data.attrs["partial"] == "yes"
    assert data.attrs["expected"] == 100 and data.attrs["received"] == 50


def test_a_host_that_stalls_is_no_silence_of_the_board(recorder):
    """A busy or sleeping computer that does not look at the line for 5 s: what came meanwhile waits there."""
    made = recorder(range(300, 350))
    made.tick(105.5)
    made.feed(frames(range(350, 400), 50), 105.6)
    assert made.status == "complete" and len(made.rows) == 100


def test_garbage_without_a_frame_counts_as_silence_and_is_told(recorder):
    made = recorder(range(300, 350))
    for k in range(60):
        made.feed(b"\xa5\x5anoise", 100.5 + k / 100)
    assert made.status == "timed out" and "no whole frame" in made.reason


def test_a_release_that_never_comes(recorder):
    made = recorder([700] * 3200, trigger=TRIGGER)
    assert made.status == "timed out" and "no release within 30 s" in made.reason and not made.rows


def test_a_stop_keeps_what_there_is(recorder):
    made = recorder(range(300, 350))
    made.end("stopped")
    attrs = to_dataset(made, {}).attrs
    assert (attrs["status"], attrs["partial"]) == ("stopped", "yes") and "0.5 s early" in attrs["problems"]


def test_a_stop_is_the_end_where_no_duration_is_fixed(recorder):
    made = recorder(range(300, 350), duration_s=None)
    made.end("stopped")
    attrs = to_dataset(made, {}).attrs
    assert (attrs["status"], attrs["partial"]) == ("stopped", "no")
    assert attrs["expected"] == attrs["received"] == 50


def test_a_board_that_resets_on_opening_is_recorded_from_its_new_beginning(recorder):
    made = recorder([111] * 5, first=4000, settle_s=2)
    listen(made, 100.05, 101.8)  # it boots in silence
    assert made.state == "opening"
    feed(made, range(300, 420), 30, 102.1)
    data = to_dataset(made, {})
    assert made.status == "complete" and data.attrs["partial"] == "no"
    assert data["sequence"].values[0] == 30 and data["sent"].values[0] == 300


def test_a_board_that_resets_while_it_waits_for_the_release_is_no_matter(recorder):
    made = recorder([700] * 60, first=500, trigger=TRIGGER)
    assert made.state == "armed"
    feed(made, [700] * 60 + [600] * 200, 0, 100.9)
    assert made.status == "complete" and not made.problems()


def test_a_board_that_resets_during_the_swing_ends_it(recorder):
    made = recorder(range(300, 350), first=500, timeout_s=5)
    feed(made, range(350, 400), 0, 102)
    data = to_dataset(made, {})
    assert data.attrs["status"] == "disconnected" and "began anew" in data.attrs["problems"]
    assert data.attrs["received"] == 50


def test_the_sequence_wraps_within_a_recording(recorder):
    made = recorder(range(300, 500), first=65500)
    data = to_dataset(made, {})
    assert made.status == "complete" and not made.missing
    assert list(data["sequence"].values) == list(range(65500, 65600))


def test_a_rate_that_is_not_the_devices_is_noticed(recorder):
    """200 S/s said to be 100: every frequency would come out half."""
    made = Recorder({**SETTINGS, "duration_s": 5}, 100.0)
    for k in range(500):
        made.feed(frame(k, 300 + k), 100 + k / 200)
    assert made.status == "complete"
    assert "capture.rate_hz" in made.problems()[0]
    assert to_dataset(made, {}).attrs["rate_by_host_hz"] == pytest.approx(200)


def test_jitter_of_the_host_is_no_such_thing(recorder):
    made = Recorder({**SETTINGS, "duration_s": 5}, 100.0)
    for k in range(0, 500, 10):
        made.feed(frames(range(300 + k, 310 + k), k), 100 + k / 100 + (0.9 if k > 450 else 0.1))
    assert made.status == "complete" and not made.problems()
