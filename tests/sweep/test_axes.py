"""An axis of a sweep as somebody writes it."""

import pytest

from swingdown.errors import InputError
from swingdown.sweep.axes import keys, steps


def test_one_key_has_its_values_as_they_are_written():
    assert keys("simulation.snr") == ("simulation.snr",)
    assert steps("simulation.snr", [5, 10], "here") == [(5,), (10,)]


def test_keys_with_commas_change_together():
    assert keys("a.b , c.d") == ("a.b", "c.d")
    assert steps("a, b", [[1, 2], [3, 4]], "here") == [(1, 2), (3, 4)]
    for entries, number in (([[1, 2], 3], 2), ([[1, 2, 3]], 1)):
        with pytest.raises(InputError, match=f"here, value {number}.*a list of 2 values"):
            steps("a, b", entries, "here")


def test_a_range_has_both_its_ends_in_equal_steps_or_equal_ratios():
    assert steps("a", {"from": 0, "to": 1, "steps": 5}, "here") == [(0.0,), (0.25,), (0.5,), (0.75,), (1.0,)]
    assert steps("a", {"from": 0.1, "to": 10, "steps": 3, "spacing": "log"}, "here") == [
        (0.1,),
        (1.0,),
        (10.0,),
    ]
    assert steps("a", {"from": 1, "to": 0.01, "steps": 3, "spacing": "log"}, "here") == [
        (1.0,),
        (0.1,),
        (0.01,),
    ]
    assert steps("a", {"from": 0, "to": 0.3, "steps": 4}, "here") == [
        (0.0,),
        (0.1,),
        (0.2,),
        (0.3,),
    ]  # not 0.30000000000000004


@pytest.mark.parametrize("ends", [(0, 1), (1, 0), (-1, 1)])
def test_ratios_need_both_ends_above_nothing(ends):
    with pytest.raises(InputError, match="both ends above 0"):
        steps("a", {"from": ends[0], "to": ends[1], "steps": 3, "spacing": "log"}, "here")


def test_several_keys_have_no_range():
    with pytest.raises(InputError, match="a range of several keys"):
        steps("a, b", {"from": 0, "to": 1, "steps": 5}, "here")
