"""Bytes become samples: none is lost that came whole, none is made up from damage, whatever comes and in whatever pieces."""

import binascii
import string

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from traffic import SETTINGS, crc16, frame, frames

from swingdown.capture.formats import FORMATS, Frames, Lines, parser
from swingdown.capture.order import Order
from swingdown.capture.recorder import Recorder
from swingdown.errors import InputError


def lines(**more):
    return Lines({"columns": ["time_ms", "value"], **more})


def in_pieces(data, cuts):
    edges = [0, *sorted(cut % (len(data) + 1) for cut in cuts), len(data)]
    return [data[a:b] for a, b in zip(edges, edges[1:], strict=False)]


def read(reader, pieces):
    return [sample for piece in pieces for sample in reader.feed(piece)]


def kept(reader, data, rate=100, passed=600.0):
    """The Order of the samples in ``data``, all within ``passed`` seconds."""
    order = Order(reader, rate)
    for sample in reader.feed(data):
        order.add(sample, passed)
    return order


def test_the_documented_frame_is_read(root):
    """The example in the sampler's description is what the format is."""
    text = (root / "resources/firmware/README.md").read_text()
    example = bytes.fromhex(text.split("reading 512 is `")[1].split("`")[0])
    (sample,) = Frames().feed(example)
    assert (sample.sequence, sample.value) == (7, 512)


@given(
    st.lists(st.integers(0, 65535), max_size=30),
    st.integers(0, 65535),
    st.lists(st.integers(0, 10**6), max_size=9),
)
def test_frames_come_whole_in_whatever_pieces(values, first, cuts):
    found = read(Frames(), in_pieces(frames(values, first), cuts))
    assert [sample.value for sample in found] == values
    assert [sample.sequence for sample in found] == [(first + k) % 65536 for k in range(len(values))]
    assert not any(sample.damaged for sample in found)


@given(st.lists(st.integers(0, 4000), max_size=30), st.lists(st.integers(0, 10**6), max_size=9))
def test_lines_come_whole_in_whatever_pieces(values, cuts):
    data = b"\r\n" + b"".join(b"%d,%d\r\n" % (10 * k, value) for k, value in enumerate(values))
    found = read(lines(), in_pieces(data, cuts))
    assert [(sample.ticks, sample.value) for sample in found] == [
        (10 * k, value) for k, value in enumerate(values)
    ]


@settings(max_examples=300)
@given(
    st.binary(max_size=2000), st.lists(st.integers(0, 10**6), max_size=9), st.sampled_from(sorted(FORMATS))
)
def test_random_bytes_neither_hang_nor_raise(data, cuts, name):
    reader = parser({"format": name, "columns": ["sequence", "time_us", "value"]})
    for sample in read(reader, in_pieces(data, cuts)):
        assert np.isfinite(sample.value)
    read(reader, [b"\n" * 3, b"\xa5", frame(1, 2)])
    damaged, claims = reader.pending
    assert damaged >= 0 and all(0 <= claim < 65536 for claim in claims)


@settings(max_examples=300)
@given(
    st.text(alphabet=string.digits + ",.-+e\r\n_ naif\x00", max_size=800),
    st.lists(st.integers(0, 10**6), max_size=9),
)
def test_what_looks_like_lines_neither_hangs_nor_raises(text, cuts):
    for sample in read(lines(), in_pieces(text.encode(), cuts)):
        assert np.isfinite(sample.value) and sample.ticks == int(sample.ticks)


@st.composite
def damaged(draw):
    """Frames 0 to n with up to three bits flipped, bytes cut out, or garbage put in, in some of them."""
    count = draw(st.integers(5, 40))
    values = [(517 * k) % 1024 for k in range(count)]
    pieces = [bytearray(frame(k, value)) for k, value in enumerate(values)]
    for k in draw(st.lists(st.integers(1, count - 2), max_size=6, unique=True)):
        kind = draw(st.sampled_from(["flip", "cut", "garbage"]))
        if kind == "flip":
            for bit in draw(st.lists(st.integers(0, 63), min_size=1, max_size=3, unique=True)):
                pieces[k][bit // 8] ^= 1 << bit % 8
        elif kind == "cut":
            start = draw(st.integers(0, 7))
            del pieces[k][start : start + draw(st.integers(1, 8))]
        else:
            pieces[k] += draw(st.binary(min_size=1, max_size=40))
    return values, b"".join(map(bytes, pieces)), draw(st.lists(st.integers(0, 10**6), max_size=9))


@settings(max_examples=400)
@given(damaged())
def test_damage_never_becomes_a_sample(case):
    """Every sample is one that was sent, in its place; every other is counted as missing."""
    values, data, cuts = case
    order = Order(reader := Frames(), 100)
    for sample in read(reader, in_pieces(data, cuts)):
        order.add(sample, 100.0)
    assert all(values[row.position] == row.value for row in order.rows)
    known = {row.position for row in order.rows} | {position for position, _ in order.missing}
    assert known >= set(range(order.rows[0].position, order.rows[-1].position))
    assert len(known) == len(order.rows) + len(order.missing)


@pytest.mark.parametrize("bit", range(64))
def test_every_flipped_bit_is_found(bit):
    data = bytearray(frames(range(500, 510)))
    data[5 * 8 + bit // 8] ^= 1 << bit % 8
    order = kept(Frames(), bytes(data))
    assert [row.position for row in order.rows] == [0, 1, 2, 3, 4, 6, 7, 8, 9]
    assert order.missing == [(5, True)]


def test_a_lost_frame_and_a_damaged_one_are_told_apart():
    whole = [frame(k, 500) for k in range(10)]
    whole[6] = whole[6][:4] + b"\xff" + whole[6][5:]
    order = kept(Frames(), b"".join(whole[:3] + whole[5:]))
    assert order.missing == [(3, False), (4, False), (6, True)]
    order = kept(Frames(), b"".join(whole[:5] + whole[6:7] + whole[9:]) + frame(10, 500))
    assert order.missing == [(5, False), (6, True), (7, False), (8, False)]


def test_the_sequence_goes_on_through_its_wrap():
    order = kept(Frames(), frames([500] * 10, first=65531))
    assert [row.position for row in order.rows] == list(range(65531, 65541))
    order = kept(Frames(), frames([500] * 3, first=65533) + frames([500] * 3, first=65538))
    assert order.missing == [(65536, False), (65537, False)]
    assert order.rows[-1].time == pytest.approx(0.07)


def test_garbage_before_the_first_frame_is_no_loss():
    order = kept(Frames(), b"\x00\xa5\xffready\r\n\xa5\x5a" + frames([500] * 5))
    assert len(order.rows) == 5 and not order.missing


def test_garbage_between_frames_loses_none():
    order = kept(Frames(), frames([500] * 5) + b"\xa5\x5a\xa5\xff" * 9 + frames([500] * 5, first=5))
    assert len(order.rows) == 10 and not order.missing


def test_a_truncated_line_a_merged_line_and_garbage_are_no_samples():
    good = [b"%d,%d\r\n" % (10 * k, 500 + k) for k in range(12)]
    good[3] = good[3][:2] + b"\r\n"  # truncated: no value
    good[5] = good[5].strip()  # its end is lost: merged with the next
    good[8] = b"\xff\x00" + good[8]
    order = kept(lines(), b"x\n" + b"".join(good))
    assert [row.value for row in order.rows] == [500, 501, 502, 504, 507, 509, 510, 511]
    assert order.missing == [(3, True), (5, True), (6, False), (8, True)]
    assert order.rows[-1].time == pytest.approx(0.11)


def test_a_line_that_lost_digits_is_found_by_its_crc():
    good = [b"%d,%d" % (10 * k, 500 + k) for k in range(6)]
    good = [b"%s,%04X\n" % (text, binascii.crc_hqx(text, 0xFFFF)) for text in good]
    assert crc16(b"0,500") == binascii.crc_hqx(b"0,500", 0xFFFF)
    bad = [*good[:2], good[2].replace(b"502", b"50"), *good[3:]]
    order = kept(lines(columns=["time_ms", "value", "crc"]), b"\n" + b"".join(bad))
    assert [row.value for row in order.rows] == [500, 501, 503, 504, 505]
    assert order.missing == [(2, True)]


def test_the_first_line_may_lack_its_beginning_and_is_left_out():
    (sample,) = lines().feed(b"0,512\r\n20,513\r\n")
    assert sample.value == 513


def test_a_line_without_an_end_is_let_go_with_its_tail():
    reader = lines()
    assert not read(reader, [b"\n", b"9" * 600, b",7\r\n"])
    (sample,) = reader.feed(b"20,8\r\n")
    assert sample.value == 8


def test_damage_before_the_first_sample_makes_no_later_loss_a_damage():
    order = kept(Frames(), b"\xa5\x5a garbage of a reset" + frames([500] * 3) + frames([500] * 3, first=4))
    assert order.missing == [(3, False)]


def test_a_repeated_frame_is_kept_once():
    order = kept(Frames(), frames([500] * 3) + frame(2, 500) * 3 + frames([500] * 3, first=3))
    assert [row.position for row in order.rows] == [0, 1, 2, 3, 4, 5]
    assert order.repeated == 3 and not order.missing and not order.restarted


@pytest.mark.parametrize("name,last", [("time_ms", 2**32 - 15), ("time_us", 2**32 - 15000)])
def test_the_devices_clock_goes_on_through_its_wrap(name, last):
    step = 10 if name == "time_ms" else 10_000
    data = b"\n" + b"".join(b"%d,7\n" % ((last + k * step) % 2**32) for k in range(5))
    order = kept(lines(columns=[name, "value"]), data)
    assert [row.time for row in order.rows] == pytest.approx([0, 0.01, 0.02, 0.03, 0.04])


@pytest.mark.parametrize("size", [16, 32])
def test_a_counter_in_lines_wraps_at_its_own_size(size):
    data = b"\n" + b"".join(b"%d,7\n" % ((2**size - 3 + k) % 2**size) for k in range(6))
    order = kept(lines(columns=["sequence", "value"]), data)
    assert len(order.rows) == 6 and not order.missing


def test_the_devices_clock_is_the_time_base_where_it_sends_one():
    data = b"\n" + b"".join(b"%d,%d,7\n" % (k, 11 * k) for k in range(4))
    order = kept(lines(columns=["sequence", "time_ms", "value"]), data)
    assert [row.time for row in order.rows] == pytest.approx([0, 0.011, 0.022, 0.033])


def ordered(columns, texts, rate=100, pace=None):
    """The Order of lines that come at their pace (1/s)."""
    order = Order(reader := lines(columns=columns), rate)
    reader.feed(b"\n")
    for k, text in enumerate(texts):
        for sample in reader.feed(text + b"\n"):
            order.add(sample, 100 + k / (pace or rate))
    return order


def wrong(texts, at, column, by):
    """The same lines with one number of one line another: what a lost or a flipped digit does."""
    cells = texts[at].split(b",")
    cells[column] = b"%d" % (int(cells[column]) + by)
    return [*texts[:at], b",".join(cells), *texts[at + 1 :]]


@pytest.mark.parametrize("by", [10, 30, 1000, 1900, 5000, -50, -400])
@pytest.mark.parametrize(
    "columns", [["time_ms", "value"], ["sequence", "value"], ["sequence", "time_ms", "value"]]
)
def test_one_wrong_digit_costs_one_line(columns, by):
    """A time or a number that jumps is believed only when the next lines go on from there."""
    by = by if columns[0] == "time_ms" else by // 10
    cells = {"sequence": lambda k: k + 60, "time_ms": lambda k: 10 * (k + 60), "value": lambda k: 500 + k}
    texts = [b",".join(b"%d" % cells[name](k) for name in columns) for k in range(120)]
    order = ordered(columns, wrong(texts, 50, 0, by))
    assert [row.value for row in order.rows] == [500 + k for k in range(120) if k != 50]
    assert not order.restarted and order.missing == [(order.rows[49].position + 1, True)]
    assert order.rows[-1].time == pytest.approx(1.19)


def test_a_wrong_digit_in_the_first_line_costs_that_line():
    texts = wrong([b"%d,%d" % (10 * k, k) for k in range(50)], 0, 0, 7000)
    made = Recorder({**SETTINGS, "format": "csv", "columns": ["time_ms", "value"], "duration_s": 0.4}, 100.0)
    made.feed(b"\n", 100)
    for k, text in enumerate(texts):
        made.feed(text + b"\n", 100 + k / 100)
    assert made.status == "complete" and [row.value for row in made.rows] == list(range(1, 41))


def test_true_losses_are_told_once_the_next_sample_confirms_them():
    texts = [b"%d,%d" % (10 * k, k) for k in range(100)]
    order = ordered(["time_ms", "value"], [text for k, text in enumerate(texts) if k not in (30, 31, 32, 60)])
    assert order.missing == [(30, False), (31, False), (32, False), (60, False)]
    assert len(order.rows) == 96


@pytest.mark.parametrize("rate", [100, 200, 250])
def test_a_clock_with_two_decimals_drops_no_sample_whose_value_differs(rate):
    """Two or three samples share a time; each is one, and stands within the clock's step of where it was taken."""
    texts = [b"%.2f,%d" % (np.floor(100 * (0.003 + k / rate)) / 100, k) for k in range(4 * rate)]
    order = ordered(["time_s", "value"], texts, rate)
    assert [row.value for row in order.rows] == list(range(4 * rate))
    assert not order.repeated and not order.missing
    times = np.array([row.time for row in order.rows])
    assert np.all(np.diff(times) > 0)
    assert np.abs(times - np.arange(4 * rate) / rate).max() <= 0.01


def test_a_pendulum_at_rest_is_no_repetition():
    texts = [b"%.2f,512" % (np.floor(k / 2) / 100) for k in range(400)]
    order = ordered(["time_s", "value"], texts, 200)
    assert len(order.rows) == 400 and not order.repeated


@pytest.mark.parametrize("columns", [["time_ms", "value"], ["sequence", "value"]])
@pytest.mark.parametrize("size", [1, 2, 20])
def test_a_block_that_comes_twice_is_kept_once(columns, size):
    step = 10 if columns[0] == "time_ms" else 1
    texts = [b"%d,%d" % (step * k, k) for k in range(100)]
    order = ordered(columns, [*texts[:60], *texts[60 - size : 60], *texts[60:]])
    assert [row.value for row in order.rows] == list(range(100))
    assert order.repeated == size and not order.restarted and not order.missing


def test_two_frames_from_the_past_do_not_end_the_recording():
    made = Recorder({**SETTINGS}, 100.0)
    data = [
        *(frame(k + 500, k) for k in range(50)),
        frame(20, 7),
        frame(21, 8),
        *(frame(k + 500, k) for k in range(50, 110)),
    ]
    for k, one in enumerate(data):
        made.feed(one, 100 + k / 100)
    assert made.status == "complete" and [row.value for row in made.rows] == list(range(100))
    assert not made.missing


def test_a_reset_with_times_in_seconds_is_noticed():
    """Every later time lies in the past; none of them is a repetition."""
    texts = [b"%.3f,%d" % (5 + k / 100, k) for k in range(50)] + [
        b"%.3f,%d" % (k / 100, k) for k in range(50)
    ]
    made = Recorder({**SETTINGS, "format": "csv", "columns": ["time_s", "value"]}, 100.0)
    made.feed(b"\n", 100)
    for k, text in enumerate(texts):
        made.feed(text + b"\n", 100 + k / 100)
    assert made.status == "disconnected" and "began anew" in made.reason
    assert [row.value for row in made.rows] == list(range(50))


def test_an_impossible_number_is_left_out_and_a_new_beginning_is_noticed():
    order = Order(reader := Frames(), 100)
    for k, sample in enumerate(
        reader.feed(frames([500] * 5) + frame(40_000, 9) + frames([500] * 5, first=6))
    ):
        order.add(sample, k / 100)
    assert (
        not order.restarted
        and [row.value for row in order.rows] == [500] * 10
        and order.missing == [(5, True)]
    )
    for k, sample in enumerate(reader.feed(frames([300] * 3, first=0))):
        order.add(sample, 0.5 + k / 100)
    assert order.restarted


@pytest.mark.parametrize(
    ("settings", "told"),
    [
        ({"columns": ["value"]}, "millis()"),
        ({"columns": []}, "no column"),
        ({"columns": ["time_ms", "a", "b"]}, "one of a, b"),
        ({"columns": ["time_ms", "a"], "signal_column": "c"}, "one of a"),
        ({"columns": ["crc", "time_ms", "a"]}, "crc last"),
        ({"format": "frame"}, "write 'frames'"),
    ],
)
def test_settings_that_cannot_be_are_refused(settings, told):
    with pytest.raises(InputError, match="Mend:") as caught:
        parser({"format": "csv", **settings})
    assert told in str(caught.value)


@pytest.mark.parametrize("piece", [1, 7, 16, 1000])
@pytest.mark.parametrize("name", ["readings", "timed"])
def test_what_a_device_with_a_clock_of_its_own_gives_comes_back_whole(name, piece):
    """In pieces of any size: its number or its time, and the value; what it lost is left out, and nothing is damaged."""
    values = [0.5, -1e300, float("nan"), 3.25, float("inf"), 0.1]
    places = range(2**40, 2**40 + 6) if name == "readings" else [0.0, 0.01, 0.02, 0.03, 0.04, 1e9]
    read = parser({"format": name})
    sent = FORMATS[name].encoded(places, values)
    found = [one for k in range(0, len(sent), piece) for one in read.feed(sent[k : k + piece])]
    kept = [(place, value) for place, value in zip(places, values, strict=True) if np.isfinite(value)]
    assert [one.value for one in found] == [value for _, value in kept]
    assert [one.sequence if name == "readings" else one.ticks for one in found] == [place for place, _ in kept]  # fmt: skip
    assert all((one.ticks if name == "readings" else one.sequence) is None for one in found)
    assert all(one.damaged == 0 and one.claims == () for one in found) and read.pending == (0, ())
    assert (read.tick, read.sequence_modulus) == ((None, 2**64) if name == "readings" else (1.0, None))
    with pytest.raises(ValueError):
        FORMATS[name].encoded(places, values[1:])
