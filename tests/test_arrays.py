"""Small functions on arrays that several rooms use."""

import numpy as np
import pytest

from swingdown.arrays import (
    DrivenSwing,
    Shown,
    extremes,
    finite_or_none,
    longest,
    runs,
    standard_errors,
    swing_under,
)


def test_standard_errors_are_roots_and_not_known_where_rounding_left_less_than_nothing():
    np.testing.assert_array_equal(standard_errors(np.diag([4.0, 0.0, -1e-20])), [2.0, 0.0, np.nan])


@pytest.mark.parametrize(
    ("marked", "found"),
    [
        ([0, 1, 1, 0, 1], [(1, 3), (4, 5)]),
        ([1, 1, -1, -1, 0], [(0, 2), (2, 4)]),
        ([0, 0], []),
        ([True, False, True], [(0, 1), (2, 3)]),
        ([], []),
    ],
)
def test_runs_begin_and_end_where_a_value_does(marked, found):
    assert runs(np.array(marked)) == found


@pytest.mark.parametrize(
    ("joined", "stretch"),
    [
        ([True, True, False, True], slice(0, 3)),
        ([False, True, True], slice(1, 4)),
        ([False, False], slice(0, 1)),
        ([True], slice(0, 2)),
        ([True, False, True], slice(0, 2)),  # of two as long the first
    ],
)
def test_the_longest_stretch_holds_one_place_more_than_joints(joined, stretch):
    assert longest(np.array(joined)) == stretch


def test_each_column_of_a_picture_keeps_its_least_and_its_greatest():
    values = np.array([0, 5, -1, 2, 3, 3, 9, 2.0])
    assert list(extremes(values, 2)) == [1, 2, 6, 7]
    assert list(extremes(values, 8)) == list(range(8))


def test_a_swing_under_a_drive_is_a_pair_that_brings_it_along():
    times, angles = np.arange(3.0), np.ones(3)
    assert type(swing_under(None, times, angles)) is tuple
    driven = swing_under("motor", times, angles)
    assert isinstance(driven, DrivenSwing) and driven.drive == "motor" and driven == (times, angles)


def test_the_parts_of_a_recording_are_told_by_its_name():
    assert Shown.named("anna, part 2 of 5") == ("anna", "part 2 of 5")
    assert Shown.named("a, part 1, part 2 of 3") == ("a, part 1", "part 2 of 3")
    assert Shown.named("anna, particle 2") == ("anna, particle 2", "")
    shown = [Shown(name, "", *[np.zeros(1)] * 3) for name in "bab"]
    found = Shown.by_recording(shown)
    assert list(found) == ["b", "a"] and [len(part) for part in found.values()] == [2, 1]
    assert shown[0].unit == "rad" and not shown[0].held_out


@pytest.mark.parametrize(
    ("value", "kept"), [(1.5, 1.5), (np.float32(2), 2.0), (np.nan, None), (-np.inf, None), (None, None)]
)
def test_what_is_not_known_is_none_in_a_file(value, kept):
    assert finite_or_none(value) == kept
