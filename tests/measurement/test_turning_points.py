"""Files of turning points alone: which are told from sampled swings, what is counted, and what is asked."""

import numpy as np
import pytest
from turning import turning_points

from swingdown.errors import InputError
from swingdown.measurement.points.turning_points import points_in, unequal_sides
from swingdown.measurement.recording import ingest
from swingdown.measurement.sheet import COLUMNS

TIMES, ANGLES = turning_points({"natural_frequency": 4.4, "viscous_ratio": 0.004}, 0.3, 60)
SCATTER = np.random.default_rng(3).standard_normal((2, 60))
T, A = TIMES + 1 + 0.01 * SCATTER[0], ANGLES + 0.002 * SCATTER[1]


def taken(folder, header, *columns, **cells):
    """The recording of a file with these columns."""
    path = folder / "points.csv"
    rows = [",".join(f"{value:.6g}" for value in row) for row in zip(*columns, strict=True)]
    path.write_text("\n".join([header, *rows, ""]))
    return ingest({**COLUMNS, "recording": "points", "file": str(path), **cells})


def test_peaks_of_one_side_are_one_a_period(tmp_path):
    found = taken(tmp_path, "t (s),amplitude (rad)", T[::2], A[::2])
    assert found.attrs["taken"].startswith("took `amplitude (rad)` as turning points, one a period, in rad")
    assert list(found["half_swings"].values) == list(range(0, 60, 2))
    assert "the period would be twice this" in found.attrs["remarks"]
    assert "only one side was recorded" in found.attrs["remarks"]


@pytest.mark.parametrize("sign", [1, -1])
def test_turning_points_by_turns_are_one_each_half_swing(tmp_path, sign):
    found = taken(tmp_path, "t (s),angle (rad)", T, sign * A)
    assert "each half-swing" in found.attrs["taken"]
    assert list(found["half_swings"].values) == list(range(60))
    assert "only one side" not in found.attrs.get("remarks", "")
    sizes = np.abs(points_in(T, sign * A, "here", stated="").readings)
    np.testing.assert_array_equal(sizes, np.abs(A))


def test_a_coordinate_at_its_turning_points_is_no_angle(tmp_path):
    header = "t,x,y"
    found = taken(tmp_path, header, T, A, A**2 / 2, signal_column="x", signal_kind="half_swings")
    assert list(found["half_swings"].values) == list(range(60))
    assert "rad" not in found.attrs["taken"] and "is no angle" in found.attrs["remarks"]


def test_where_the_sides_stop_taking_turns_the_longer_part_is_used(tmp_path):
    found = taken(tmp_path, "t (s),angle (rad)", T, np.where(np.arange(60) < 40, A, -A))
    assert list(found["half_swings"].values) == list(range(40))
    assert "follow each other as if on both" in found.attrs["remarks"]
    late = points_in(T, np.where(np.arange(60) < 21, A, -A), "here")
    assert list(late.halves) == list(range(39))
    np.testing.assert_array_equal(np.sign(late.readings), (-1.0) ** late.halves)
    np.testing.assert_array_equal(np.abs(late.readings), np.abs(A[21:]))


def test_sides_without_signs_are_told_by_the_zero_of_the_scale(tmp_path):
    found = taken(tmp_path, "t (s),amplitude (rad)", T, np.abs(A + 0.01))
    assert (
        "each half-swing" in found.attrs["taken"]
        and "the two sides' readings differ" in found.attrs["remarks"]
    )
    # a header that says so does as well, and so does the sheet
    assert "each half-swing" in taken(tmp_path, "t (s),abs angle (rad)", T, np.abs(A)).attrs["taken"]
    stated = taken(tmp_path, "t (s),amplitude (rad)", T, np.abs(A), signal_kind="half_swings")
    assert "each half-swing" in stated.attrs["taken"]


def test_points_that_nobody_wrote_down_are_counted(tmp_path):
    kept = np.r_[0:6, 7:20:3, 24, 30:60]
    found = taken(tmp_path, "t (s),angle (rad)", T[kept], A[kept])
    assert list(found["half_swings"].values) == list(kept)
    assert "more were not written down" in found.attrs["remarks"]


def test_at_a_large_angle_the_longer_period_is_no_point_left_out(tmp_path):
    times, angles = turning_points({"natural_frequency": 4.0, "quadratic_coefficient": 0.03}, 2.6, 60)
    assert np.ptp(np.diff(times)) > 0.3 * np.min(np.diff(times))
    found = taken(tmp_path, "t (s),angle (rad)", times, angles)
    assert list(found["half_swings"].values) == list(range(60))


def test_a_point_that_stands_twice_counts_once(tmp_path):
    times, angles = np.insert(T[::2], 5, T[8] + 0.03), np.insert(A[::2], 5, A[8] - 0.001)
    found = taken(tmp_path, "t (s),amplitude (rad)", times, angles)
    assert list(found["half_swings"].values) == list(range(0, 60, 2))
    assert "stands twice" in found.attrs["remarks"]


def test_rows_sorted_by_angle_are_put_in_the_order_of_time(tmp_path):
    order = np.argsort(-A[::2])
    found = taken(tmp_path, "t (s),amplitude (rad)", T[::2][order], A[::2][order])
    assert np.all(np.diff(found["time"].values) > 0) and "order of their times" in found.attrs["remarks"]


@pytest.mark.parametrize("head", ["n", "swing", "number of swings", "No. of oscillations"])
def test_numbers_of_swings_are_no_times(tmp_path, head):
    found = taken(tmp_path, f"{head},amplitude (cm)", np.arange(30), 100 * A[::2])
    assert "order of their times" not in found.attrs["remarks"]
    assert "each number is taken for a whole swing" in found.attrs["remarks"]
    assert "as the number of the swing" in found.attrs["taken"] and "in cm" in found.attrs["taken"]
    assert list(found["half_swings"].values) == list(range(0, 60, 2))


@pytest.mark.parametrize("step", [10.0, 1.4167])
def test_times_of_equal_steps_are_asked_about(tmp_path, step):
    times = step * np.arange(30)
    with pytest.raises(InputError, match=f"{step:g} s apart to the last digit: is that the period"):
        taken(tmp_path, "t (s),amplitude (deg)", times, np.degrees(A[::2]))
    found = taken(tmp_path, "t (s),amplitude (deg)", times, np.degrees(A[::2]), signal_kind="turning_points")
    assert found.sizes["time"] == 30


def test_times_without_a_common_interval_are_refused_in_words(tmp_path):
    times = np.cumsum(np.random.default_rng(5).uniform(1, 2, 30))
    with pytest.raises(InputError, match="the swings between its points cannot be counted"):
        taken(tmp_path, "t (s),amplitude (rad)", times, np.abs(A[::2]))


def test_points_are_used_up_to_the_last_that_can_be_counted():
    gaps = np.random.default_rng(5).uniform(3, 5, 8)
    times = np.append(1.4612 * np.arange(40), 1.4612 * 39 + np.cumsum(gaps))
    found = points_in(times, 0.3 * np.exp(-times / 60), "here", stated="")
    assert 40 <= found.times.size < times.size
    assert f"used from 0 to {found.times[-1]:.6g} s: how many swings passed beyond" in " ".join(found.remarks)


def test_a_few_points_of_which_some_do_not_fit_are_asked_about(tmp_path):
    """Turning points written down now and then fall, and some of them happen to be as far apart as others."""
    times = [0, 7.23, 17.5, 31.9, 47.4, 63.7, 79.1, 93.4]
    with pytest.raises(InputError, match="cannot be counted") as problem:
        taken(tmp_path, "t (s),theta (rad)", times, 0.22 * np.exp(-0.02 * np.array(times)))
    assert "signal_kind" in problem.value.mend


def test_a_sampled_swing_is_never_taken_for_turning_points(tmp_path):
    for rate, offset, name in (
        (8, 0.0, "amplitude (rad)"),
        (30, 0.0, "angle (rad)"),
        (30, 1.0, "angle (rad)"),
    ):
        times = np.arange(0, 60, 1 / rate)
        swing = offset + 0.3 * np.exp(-0.02 * times) * np.cos(4.4 * times)
        found = taken(tmp_path, f"t (s),{name}", times, swing)
        assert "half_swings" not in found and found.sizes["time"] == times.size


def test_the_way_down_of_one_swing_is_no_envelope(tmp_path):
    times = np.arange(0, 0.7, 0.033)
    with pytest.raises(InputError) as refused:
        taken(tmp_path, "t (s),angle (rad)", times, 0.5 * np.cos(2 * times))
    assert "turning points" not in str(refused.value)


def test_a_swing_that_is_sampled_beside_its_zero_is_no_series_of_turning_points():
    times = np.arange(0.0, 2400.0)
    rng = np.random.default_rng(1)
    readings = 0.0635 - 4e-7 * times + 0.0013 * np.exp(-times / 800) * np.cos(2 * np.pi * times / 306)
    readings = np.round(readings + rng.normal(0, 1e-4, times.size), 4)
    readings[104] = 0.067
    assert points_in(times, readings, "here") is None


def test_sides_that_differ_a_little_are_asked_about():
    sizes = 4.7 * np.exp(-np.arange(83) / 75) + np.random.default_rng(0).normal(0, 0.05, 83)
    times = 0.76 * np.arange(83.0)
    with pytest.raises(InputError, match="one side, or of both sides.*half_swings"):
        points_in(times, sizes + 0.02 * (-1.0) ** np.arange(83), "here")


def test_turning_points_that_stand_several_times_end_no_series():
    times = 2.0 * np.arange(200.0) + np.random.default_rng(2).normal(0, 0.003, 200)
    sizes = 0.8 * np.exp(-np.arange(200) / 60)
    again = times[60] + np.array([0.2, 0.35, 0.6, 1.1, 1.4, 1.7])
    found = points_in(
        np.sort(np.concatenate([times, again])),
        np.concatenate([sizes[:61], np.full(6, sizes[60]), sizes[61:]]),
        "here", in_rad=1.0,
    )  # fmt: skip
    assert np.median(np.diff(found.times)) == pytest.approx(2.0, abs=2e-3)
    assert found.times.size >= 100 and (np.diff(found.halves) == 2).all()


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("decay", [8, 12, 30, 100])
@pytest.mark.parametrize("scatter", [0.0, 0.003, 0.02])
def test_an_envelope_of_any_depth_is_a_series_of_turning_points(seed, decay, scatter):
    rng = np.random.default_rng(seed)
    sizes = np.exp(-np.arange(40) / decay) * (1 + scatter * rng.normal(size=40))
    times = 1.4612 * np.arange(40) + rng.normal(0, 0.004, 40)
    assert points_in(times, sizes, "here", stated="").times.size == 40


def test_a_long_series_whose_period_changes_by_a_percent_is_counted_throughout():
    """The straight line through 420 turning points misses them by a fifth of the interval, and nobody left one out but at 100 and 101."""
    number = np.delete(np.arange(420), [100, 101])
    times = 0.68 * number - 8e-6 * number**2 + 0.02 * np.random.default_rng(2).standard_normal(number.size)
    angles = 0.3 * np.exp(-number / 180) * (-1.0) ** number
    found = points_in(times, angles, "points", name="angle")
    assert list(found.halves) == list(number) and len(found.times) == number.size


@pytest.mark.parametrize("sign", [1, -1])
def test_a_point_at_the_zero_of_the_scale_is_on_the_side_of_the_others(sign):
    sizes = np.append(A[:58:2], 0.0)
    found = points_in(T[::2], sign * sizes, "here", stated="turning_points")
    assert not found.both and list(found.halves) == list(range(0, 60, 2))
    assert found.readings[0] == pytest.approx(A[0], abs=1e-12)


def test_sides_are_taken_for_unequal_by_chance_as_often_as_is_asked_for():
    draws = np.random.default_rng(1)
    sizes = np.exp(-np.arange(30) / 40) + 0.01 * draws.standard_normal((1000, 30))
    assert np.mean([unequal_sides(one, 0.1) != 0 for one in sizes]) == pytest.approx(0.1, abs=0.03)
    shifted = sizes[0] + 0.02 * (-1.0) ** np.arange(30)
    assert unequal_sides(shifted) == pytest.approx(0.02, abs=0.006)
    assert unequal_sides(shifted[:7]) == 0.0  # too few to tell


@pytest.mark.parametrize(("step", "is_one"), [(0.105, True), (0.095, False)])
def test_no_pendulum_turns_on_one_side_ten_times_a_second(step, is_one):
    times = step * np.arange(30) + 1e-3 * step * SCATTER[0, :30]
    assert (points_in(times, 0.3 * 0.97 ** np.arange(30), "here") is not None) is is_one


def test_an_envelope_that_no_quintic_follows_is_no_swing_for_its_few_sides():
    halves = np.arange(60)
    sizes = 0.2 * np.exp(-halves / 6) + 0.2 * np.exp(-halves / 60)
    assert points_in(T, sizes, "here") is not None
