"""Samples stand in their order on the device's clock; what is missing between them is told, and what is doubtful waits."""

from types import SimpleNamespace

import pytest

from swingdown.capture.formats import Sample
from swingdown.capture.order import AGAIN, Order, losses

RATE = 100.0


def order(tick=None, tick_modulus=None, resolution=None, sequence_modulus=256):
    parser = SimpleNamespace(
        tick=tick, tick_modulus=tick_modulus, resolution=resolution, sequence_modulus=sequence_modulus
    )
    return Order(parser, RATE)


def numbered(one, numbers, begin=0.0, late=0.0):
    """What becomes certain as samples of these numbers arrive, each when it was taken and so much later."""
    found = []
    for number in numbers:
        sample = number if isinstance(number, Sample) else Sample(number % 256, None, float(number))
        found.append([row.position for row in one.add(sample, begin + sample.value / RATE + late)])
    return found


def test_samples_that_follow_each_other_are_certain_at_once():
    one = order()
    assert numbered(one, range(5, 9)) == [[5], [6], [7], [8]]
    assert [row.time for row in one.rows] == pytest.approx([0, 0.01, 0.02, 0.03])
    assert [row.arrival for row in one.rows] == pytest.approx([0.05, 0.06, 0.07, 0.08])
    assert one.missing == [] and one.numbered and not one.restarted and one.repeated == 0


def test_numbers_wrap_where_the_device_s_do():
    one = order()
    numbered(one, range(250, 262))
    assert [row.position for row in one.rows] == list(range(250, 262))
    wide = order(sequence_modulus=None)  # of 16 bits, until one is larger
    for number in (65534, 65535, 0, 1):
        wide.add(Sample(number, None, float(number)), number % 65534 / RATE)
    assert [row.position for row in wide.rows] == [65534, 65535, 65536, 65537]


def test_what_was_left_out_waits_for_the_next_one_and_is_told_as_missing():
    one = order()
    assert numbered(one, [0, 1, 5]) == [[0], [1], []]
    assert numbered(one, [6]) == [[5, 6]]
    assert one.missing == [(2, False), (3, False), (4, False)] and losses(one.missing) == (3, 0)
    assert [row.time for row in one.rows] == pytest.approx([0, 0.01, 0.05, 0.06])


def test_a_wrong_number_is_a_sample_that_is_missing():
    one = order()
    assert numbered(one, [0, 1]) == [[0], [1]]
    assert one.add(Sample(40, None, 2.0), 0.02) == []  # a digit that flipped: 2 was meant
    assert [row.position for row in one.add(Sample(3, None, 3.0), 0.03)] == [3]
    assert one.missing == [(2, True)] and losses(one.missing) == (0, 1)


def test_frames_that_came_damaged_are_told_apart_from_those_that_never_came():
    one = order()
    numbered(one, [0])
    numbered(one, [Sample(4, None, 4.0, damaged=1, claims=(2,)), 5])
    assert one.missing == [(1, False), (2, True), (3, False)]
    numbered(one, [Sample(9, None, 9.0, damaged=2), 10])
    assert one.missing[3:] == [(6, True), (7, True), (8, False)]
    numbered(one, [Sample(12, None, 12.0, damaged=3, claims=(77,))])  # more than are missing
    assert one.missing[6:] == [(11, True)]


def test_damage_before_the_first_sample_is_no_loss():
    one = order()
    numbered(one, [Sample(3, None, 3.0, damaged=4, claims=(1, 2)), 4, 6, 7])
    assert one.missing == [(5, False)]


def test_two_that_contradict_each_other_are_both_left_out():
    one = order()
    numbered(one, [0, 1])
    for number, at in ((40, 2.0), (30, 3.0)):
        assert one.add(Sample(number, None, at), at / RATE) == []
    assert [row.position for row in one.add(Sample(4, None, 4.0), 0.04)] == [4]
    assert one.missing == [(2, True), (3, True)]


def test_what_is_sent_again_is_counted_and_left_out():
    one = order()
    numbered(one, range(10))
    assert numbered(one, [5, 6, 7]) == [[], [], []]
    assert one.repeated == 3 and len(one.rows) == 10
    assert numbered(one, [10]) == [[10]]


def test_a_number_beyond_what_could_come_in_the_time_is_left_out():
    """Two seconds of slack at a hundred a second are two hundred samples."""
    one = order(sequence_modulus=1 << 16)
    numbered(one, [0])
    assert one.add(Sample(250, None, 1.0), 0.01) == []
    assert not one.restarted and [row.position for row in one.add(Sample(1, None, 2.0), 0.02)] == [1]
    near = order(sequence_modulus=1 << 16)
    numbered(near, [0])
    near.add(Sample(195, None, 1.0), 0.01)
    near.add(Sample(196, None, 2.0), 0.02)
    assert [row.position for row in near.rows] == [0, 195, 196]


def test_three_that_follow_from_each_other_alone_tell_that_the_board_began_anew():
    one = order(sequence_modulus=1 << 16)
    numbered(one, range(5000, 5005))
    found = []
    for k in range(3):
        one.add(Sample(k, None, float(k)), 50.05 + k / RATE)
        found.append(one.restarted)
    assert found == [False, False, True] and [sample.sequence for sample, _ in one.since] == [0, 1, 2]
    other = order(sequence_modulus=1 << 16)
    numbered(other, range(5000, 5005))
    for k in (0, 3000, 9000):  # none of which follows from the other
        other.add(Sample(k, None, float(k)), 50.05 + k / 1e6)
    assert not other.restarted and len(other.since) == 1


def test_a_repeated_block_is_no_longer_than_what_is_remembered():
    one = order(sequence_modulus=1 << 16)
    numbered(one, [Sample(k, None, float(k)) for k in range(AGAIN + 50)])
    numbered(one, [Sample(60, None, 60.0)] * AGAIN)
    assert one.repeated == AGAIN and not one.since
    one.add(Sample(60, None, 60.0), 3.1)
    assert len(one.since) == 1


def test_times_are_the_device_s_where_it_tells_them():
    one = order(tick=1e-3, tick_modulus=1 << 16, resolution=1e-3)
    for ticks in (65_520, 65_530, 4, 14.5):
        one.add(Sample(None, ticks, float(ticks)), (ticks - 65_520) % 65_536 / 1000)
    assert [row.time for row in one.rows] == pytest.approx([0, 0.01, 0.02, 0.0305])
    assert [row.position for row in one.rows] == [0, 1, 2, 3] and not one.numbered and one.clock_step == 0


def test_without_numbers_the_clock_tells_what_is_missing():
    one = order(tick=1e-3, resolution=1e-3)
    for ticks in (0, 10, 40, 50):
        one.add(Sample(None, ticks, float(ticks)), ticks / 1000)
    assert [row.position for row in one.rows] == [0, 1, 4, 5]
    assert one.missing == [(2, False), (3, False)]


@pytest.mark.parametrize(("resolution", "coarse"), [(0.0024, False), (0.0026, True)])
def test_a_clock_whose_steps_are_more_than_a_quarter_of_an_interval_places_no_sample(resolution, coarse):
    assert order(tick=1e-3, resolution=resolution).clock_step == (resolution if coarse else 0)


def test_samples_within_one_step_of_a_coarse_clock_stand_an_interval_apart():
    one = order(tick=0.1, resolution=0.1)
    for k in range(40):
        one.add(Sample(None, float(k // 10), float(k)), k / RATE)
    times = [row.time for row in one.rows]
    assert len(times) == 40 and times == pytest.approx([k / RATE for k in range(40)])
    assert one.missing == [] and one.repeated == 0


def test_of_a_pendulum_at_rest_as_many_alike_are_taken_as_fit_into_a_step():
    one = order(tick=0.1, resolution=0.1)
    for k in range(14):
        one.add(Sample(None, 0.0, 7.0), k / RATE)
    assert len(one.rows) == 11 and one.repeated == 3
    for k in range(14):
        one.add(Sample(None, 1.0 + k // 10, 7.0), 0.14 + k / RATE)
    assert len(one.rows) == 25 and one.repeated == 3
    assert all(b.time > a.time for a, b in zip(one.rows, one.rows[1:], strict=False))
