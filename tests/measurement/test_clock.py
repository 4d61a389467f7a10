"""Times are put right where they are an even clock's, rounded, late or out of order, and are left as they stand where they are not."""

import numpy as np
import pytest
from scipy.stats import linregress

from swingdown.errors import InputError
from swingdown.measurement.swings.clock import counts_rows, counts_ticks, goes_on, in_order, parts

EVEN = np.arange(1200) / 60  # s


def swing(times):
    """Smooth readings of some noise, as a pendulum's of 1.4 s."""
    noise = 1e-4 * np.random.default_rng(3).standard_normal(times.size)
    return 0.3 * np.exp(-times / 40) * np.cos(2 * np.pi * times / 1.4) + noise


def put(times, truth=None):
    return in_order(times, swing(times if truth is None else truth), "a.csv")


def kept(found, times):
    """The places of the rows that are kept."""
    return list(np.arange(times.size)[found.kept])


def test_an_even_clock_stays_as_it_is():
    found = put(EVEN)
    assert found.remarks == [] and found.rate == 0 and kept(found, EVEN) == list(range(1200))
    np.testing.assert_array_equal(found.times, EVEN)


def test_rows_from_the_last_to_the_first_are_turned_round():
    found = put(EVEN[::-1])
    assert found.remarks == ["the rows run backwards in time and were turned round"]
    assert kept(found, EVEN) == list(range(1199, -1, -1))
    np.testing.assert_allclose(found.times, EVEN)


def test_rows_out_of_place_are_sorted_and_counted():
    order = np.arange(1200)
    order[[100, 101, 700, 701]] = 101, 100, 701, 700
    found = put(EVEN[order])
    assert found.remarks == ["the time runs back at 2 of 1200 rows, which were put in order of time"]
    assert kept(found, EVEN) == list(order)  # a swap is its own inverse
    np.testing.assert_allclose(found.times, EVEN)


def test_rows_that_stand_twice_are_left_out_and_those_of_another_reading_counted():
    twice = np.sort(np.append(np.arange(1200), [50, 51, 400]))
    signal = swing(EVEN)[twice]
    signal[np.searchsorted(twice, 400) + 1] += 0.2
    found = in_order(EVEN[twice], signal, "a.csv")
    assert found.remarks == ["3 of 1203 rows repeat the time of another and were left out (1 with another reading)"]  # fmt: skip
    assert list(twice[found.kept]) == list(range(1200))
    np.testing.assert_allclose(found.times, EVEN)


@pytest.mark.parametrize("stopped", [20, 8])
def test_a_clock_that_stops_tells_nothing_of_the_rows_after_it(stopped):
    """As of a logger that went on to write; a few rows of one time at the end are those of any coarse clock."""
    times = np.append(EVEN, np.full(stopped, EVEN[-1]))
    found = put(times)
    told = any("THE CLOCK STOPS at 19.98" in one and f"last {stopped} rows" in one for one in found.remarks)
    assert told == (stopped == 20) and kept(found, times)[-1] == 1199


def test_a_time_that_lost_its_first_digit_is_left_out():
    """12.3 as 2.3, where there is a sample, is not put there."""
    cut = EVEN.copy()
    cut[[740, 900]] -= 10
    found = put(cut, EVEN)
    assert found.remarks == ["in 2 of 1200 rows the time alone jumps back, as where a line lost its start: left out as missing"]  # fmt: skip
    assert kept(found, EVEN) == [k for k in range(1200) if k not in (740, 900)]
    np.testing.assert_allclose(found.times, np.delete(EVEN, [740, 900]))


def test_one_time_for_all_is_refused():
    with pytest.raises(InputError, match="all samples have one time"):
        put(np.full(8, 3.0))


def test_what_runs_back_and_forth_is_no_time_and_how_often_is_told():
    """Of ten changes each, three fall."""
    times = np.cumsum(np.tile([1, 1, -0.5, 1, 1, -0.5, 1, 1, -0.5, 1], 40))
    with pytest.raises(InputError, match="it falls at 30 % of its changes"):
        put(times)


@pytest.mark.parametrize(
    ("places", "told", "lost"),
    [
        (1, "100 ms", []),
        *((places, told, lost) for places, told in [(2, "10 ms"), (3, "1 ms"), (4, None)] for lost in ([], [100, 101, 700])),
    ],
)  # fmt: skip
def test_rounded_stamps_give_way_to_the_clock_behind_them(places, told, lost):
    """Samples may share a stamp, or be missing; a digit far finer than the interval is worth no word."""
    truth = np.delete(EVEN, lost)
    stamps = truth.round(places)
    found = put(stamps, truth)
    expected = [f"the times are those of an even clock, rounded to {told}"] if told else []
    assert found.remarks == expected
    assert np.abs(found.times - truth).max() < 0.1 * 10.0**-places
    line = linregress(truth, stamps)
    assert found.rate == pytest.approx(line.stderr / line.slope, rel=0.02)


@pytest.mark.parametrize("lost", [[], [40, 41], [700]])
def test_stamps_of_four_figures_are_those_of_an_even_clock(lost):
    """9.983, then 10.00, then 100.0, as a program's own format writes them."""
    truth = np.delete(0.05 + np.arange(2400) / 20, lost)
    stamps = np.array([float(f"{t:.4g}") for t in truth])
    found = put(stamps, truth)
    assert found.remarks == ["the times are those of an even clock, written with 4 figures"]
    assert np.abs(found.times - truth).max() < 0.005


def late(truth):
    """Stamps of a computer that writes when it comes to it."""
    return np.sort(truth + np.random.default_rng(5).exponential(0.004, truth.size))


def test_stamps_of_a_late_computer_give_way_where_the_swing_is_smooth_over_even_times():
    stamps = late(EVEN)
    found = put(stamps, EVEN)
    (told,) = found.remarks
    assert f"the stamps scatter by {1e3 * np.std(stamps - EVEN):.2g} ms" in told
    assert "smooth over the even times" in told
    away = found.times - EVEN
    assert np.ptp(away) < 0.001 and away.mean() == pytest.approx(0.004, abs=5e-4)


def test_times_that_are_uneven_stay_where_the_swing_follows_them():
    times = late(EVEN)
    found = put(times)
    assert found.remarks == [] and found.rate == 0
    np.testing.assert_array_equal(found.times, times)


def test_readings_written_when_an_encoder_moved_keep_their_times():
    """From step to step, at the times at which a swing passes them: over even times they would be straight lines."""
    fine = np.linspace(0, 12, 400_001)
    steps = np.floor(100 * 0.3 * np.cos(2 * np.pi * fine / 1.4))
    at = np.flatnonzero(np.diff(steps)) + 1
    found = in_order(fine[at], steps[at] / 100, "a.csv")
    np.testing.assert_array_equal(found.times, fine[at])


def test_samples_that_share_a_stamp_are_spread_until_the_next_one():
    """Packets of uneven lengths at uneven times: by hand, 3 samples at 0 s and 2 at 0.09 s are at 0, 0.03, 0.06, 0.09, ..."""
    draws = np.random.default_rng(8)
    sizes = draws.integers(2, 6, 200)
    begins = np.cumsum(draws.uniform(0.05, 0.15, 201)) - 0.05
    ends = np.append(begins[1:-1], begins[199] + np.median(np.diff(begins[:-1])))
    each = [a + (b - a) * k / n for a, b, n in zip(begins, ends, sizes, strict=False) for k in range(n)]
    found = put(begins[:200].repeat(sizes), np.array(each))
    assert "too few digits, were spread evenly" in found.remarks[0] and len(found.remarks) == 1
    np.testing.assert_allclose(found.times, each, atol=1e-12)


def spans(times):
    return [(one.start, one.stop) for one in parts(times)]


def test_a_clock_that_counts_anew_begins_another_part():
    assert spans(EVEN) == [(0, 1200)]
    assert spans(np.concatenate([EVEN[:500], EVEN[:300], EVEN])) == [(0, 500), (500, 800), (800, 2000)]


def test_a_row_out_of_place_is_no_restart():
    """Nor is one beside another, nor a step back over fewer samples than ten, nor one so near the end."""
    order = np.arange(1200)
    order[[100, 101]] = 101, 100
    assert spans(EVEN[order]) == [(0, 1200)]
    assert spans(np.concatenate([EVEN[:500], EVEN[491:]])) == [(0, 1209)]
    assert spans(np.concatenate([EVEN[:500], EVEN[490:]])) == [(0, 500), (500, 1210)]
    assert spans(np.concatenate([EVEN, EVEN[:9]])) == [(0, 1209)]
    assert spans(np.concatenate([EVEN, EVEN[:10]])) == [(0, 1200), (1200, 1210)]


def test_what_goes_back_all_the_time_has_no_parts():
    assert spans(np.tile(EVEN[:12], 50)) == [(0, 600)]


def test_a_time_that_lost_its_first_digit_begins_no_part():
    cut = EVEN.copy()
    cut[740] -= 10
    assert spans(cut) == [(0, 1200)]


@pytest.mark.parametrize(
    ("values", "goes"),
    [
        (EVEN, True),
        (EVEN[::-1], False),
        (np.repeat(EVEN, 3), True),  # a coarse clock
        (np.where(np.arange(1200) % 50 == 25, EVEN - 0.1, EVEN), True),  # 1 change of 50 falls
        (np.where(np.arange(1200) % 10 == 5, EVEN - 0.1, EVEN), False),  # 1 of 10
        (np.array([0.0, 1.0, 2.0]), True),
        (np.repeat([0.0, 1.0, 2.0], 20), False),  # it rises twice in 60 rows
        (np.zeros(30), False),
        (np.array([1.0]), False),
    ],
)
def test_a_clock_rises_from_row_to_row_but_for_a_few(values, goes):
    assert goes_on(values) is goes
    assert goes_on(np.insert(values, values.size // 2, np.nan)) is goes or values.size == 3


@pytest.mark.parametrize(
    ("values", "counted"),
    [
        (np.arange(5.0), True),
        (np.arange(5.0)[::-1], True),
        (np.array([1, 2, 3, 5, 6, np.nan, 8]), True),  # rows are lost
        (np.arange(0, 10.0, 2), False),
        (np.arange(5) + 0.5, False),
        (np.array([1, 2, 3, 2, 1.0]), False),
        (np.array([4.0]), False),
    ],
)
def test_rows_are_counted_by_whole_numbers_one_apart(values, counted):
    assert counts_rows(values) is counted


@pytest.mark.parametrize(
    ("steps", "ticks"),
    [
        ([25, 27, 26, 24], True),
        ([25, 26], False),  # a clock of whole seconds that is read every 25.5
        ([10, 20, 30], False),  # tenths of something
        ([25, 27, 26.5], False),
        ([25], False),
        ([-25, -27, -26], False),
    ],
)
def test_a_processor_counts_whole_ticks_of_uneven_numbers(steps, ticks):
    assert counts_ticks(np.cumsum(np.resize(steps, 60))) is ticks
    assert not counts_ticks(np.cumsum(np.resize(steps, 9)))  # too few to tell
