"""How a recording begins and ends: the release, the count, the four statuses, what it says is missing."""

import numpy as np
import pytest
from traffic import SETTINGS, frame, frames

from swingdown.capture import live
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
    assert abs(sent[time < 0] - 700.5).max() <= 0.5
    released = list(sent[time >= 0]).index(698) - 4  # it is 698 four samples after it was let go
    assert (
        abs(released) <= 2
    )  # by then it has moved by less than the half step that the held signal spreads over
    assert data.attrs["expected"] == 120 and data.attrs["triggered"] == "yes"


@pytest.mark.parametrize("angle", [5, 24, 60])
@pytest.mark.parametrize("noise", [0, 0.5])
def test_zero_is_where_the_bob_was_let_go(angle, noise):
    """A pendulum of 7.25 rad/s: the threshold is passed some 40 ms (1 degree) later than the release, which is 0."""
    errors, per_degree, random = [], 14.2, np.random.default_rng(3)
    for at in 1.5 + random.uniform(0, 0.01, 12):
        times = np.arange(500) / 100
        swing = angle * np.where(times < at, 1, np.cos(7.25 * (times - at)))
        values = np.round(500 + per_degree * swing / max(angle / 30, 1) + noise * random.standard_normal(500))
        made = Recorder({**SETTINGS, "trigger": {"threshold": 10, "pre_s": 0.5, "wait_s": 30}}, 100.0)
        feed(made, values)
        assert made.status == "complete"
        zero = next(row.position for row in made.rows if row.time == made.zero)
        errors.append(zero / 100 - at)
    assert np.max(np.abs(errors)) < 0.015


def test_noise_above_the_threshold_is_told_while_waiting_and_at_the_end():
    random = np.random.default_rng(3)
    made = Recorder({**SETTINGS, "trigger": {"threshold": 5, "pre_s": 0.5, "wait_s": 5}}, 100.0)
    feed(made, 500 + 4 * random.standard_normal(400))
    assert made.state == "waiting" and "raise it to" in made.unarmed()
    least = float(made.unarmed().split("raise it to ")[1].split(" ")[0])
    assert 30 < least < 45 and "noise of" in live.hint(made)
    feed(made, 500 + 4 * random.standard_normal(400), 400, 104)
    assert made.status == "timed out" and "raise it to" in made.reason

    calm = Recorder({**SETTINGS, "trigger": {"threshold": least, "pre_s": 0.5, "wait_s": 5}}, 100.0)
    feed(calm, 500 + 4 * random.standard_normal(400))
    assert calm.state == "armed"  # and the mend is one


def test_a_bob_that_is_not_held_still_is_told_with_what_is_still(recorder):
    made = recorder([500 + 40 * np.sin(k / 12) for k in range(300)], trigger=TRIGGER)
    assert made.state == "waiting" and not made.unarmed()
    assert "still is below 5" in live.hint(made)


def test_samples_at_the_end_of_the_range_make_it_partial(recorder):
    values = [min(int(500 + 450 * np.sin(k / 15) + 100), 1023) for k in range(200)]
    made = recorder(values, range=[0, 1023])
    assert made.problems()[0].startswith(
        f"{sum(value >= 1023 or value <= 0 for value in values[:100])} samples at the end"
    )
    assert not recorder(values, range=[-200, 1024]).problems()


def test_live_amplitude_period_and_decay():
    """A pendulum of 0.8667 s that loses 2 % of its amplitude each swing; the loss is told from the eleventh on."""
    period, per_swing = 2 * np.pi / 7.25, 0.02
    times = np.arange(1500) / 100
    values = 512 + 300 * (1 - per_swing) ** (times / period) * np.cos(7.25 * times)
    made = Recorder({**SETTINGS, "duration_s": 20}, 100.0)
    feed(made, np.round(values[:600]))
    told = live.measured(made, 20)
    assert "period 0.866" in told and "loses" not in told
    feed(made, np.round(values[600:]), 600, 106)
    told = live.measured(made, 20)
    assert float(told.split("loses ")[1].split("%")[0]) == pytest.approx(2, abs=0.2)
    last = 300 * 0.98 ** (14.5 / period)
    assert float(told.split("amplitude ")[1].split(" ")[0]) == pytest.approx(last, rel=0.03)


def test_a_pendulum_at_rest_has_no_swing(recorder):
    random = np.random.default_rng(3)
    assert live.measured(recorder(np.round(512 + 2 * random.standard_normal(90))), 20) == ""


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


def test_what_waited_from_before_the_recording_is_no_silence_of_the_board(recorder):
    """In a session the port is read all along: while one recording is written, samples pile up that no recording is made of."""
    made = recorder()
    feed(made, range(200, 320), 0, 98.8)
    assert made.state == "opening" and made.silent == 0
    feed(made, range(320, 420), 120)
    assert made.status == "complete" and made.rows[0].position == 120


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
    """Pieces that are late, and a host that is held up for 0.9 s and then finds all at once what came meanwhile."""
    made = Recorder({**SETTINGS, "duration_s": 5}, 100.0)
    for k in [*range(0, 400, 10), 400, 490]:
        count = 90 if k == 400 else 10
        made.feed(frames(range(300 + k, 300 + k + count), k), 100 + (k + count) / 100 + 0.09 * (k % 3 == 0))
    assert made.status == "complete" and not made.problems()
