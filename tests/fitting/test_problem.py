"""The variables of a fit: which they are, where they sit in each swing, their bounds, and from where they start."""

import numpy as np
import pytest

from swingdown.engine.trajectory import simulate
from swingdown.errors import InputError
from swingdown.fitting.problem import Problem
from swingdown.pendulum.catalogue import RATE
from swingdown.pendulum.model import Model
from swingdown.pendulum.slack import reading_slack

MODEL = Model(
    "viscous+load_coulomb", {"natural_frequency": 6.0, "viscous_ratio": 0.01, "load_friction": 0.002}
)
TIMES = np.arange(3000) / 100


def swing(release=0.4, times=TIMES, model=MODEL):
    return times, simulate(model, times, release)


def test_shared_values_come_first_and_then_each_swing_s_own_and_its_release():
    one = Problem(MODEL, [swing(), swing(0.2)], "free", False, own=["load_friction"])
    own = ["load_friction", "release_angle", "release_velocity"]
    assert list(one.free) == ["natural_frequency", "viscous_ratio", *own, *own]
    values = [{"natural_frequency": 6.0, "viscous_ratio": 0.01, "load_friction": c} for c in (0.001, 0.002)]
    x = one.variables(values, [(0.4, 0.1), (0.2, -0.1)])
    assert x == pytest.approx([6.0, 0.01, 0.001, 0.4, 0.1, 0.002, 0.2, -0.1])
    assert one.slots(x) == [[6.0, 0.01, 0.001, 0.4, 0.1], [6.0, 0.01, 0.002, 0.2, -0.1]]


def test_what_is_fixed_is_no_variable_and_keeps_its_value():
    one = Problem(MODEL, [swing()], "free", False, fixed={"natural_frequency": 5.5})
    assert list(one.free) == ["viscous_ratio", "load_friction", "release_angle", "release_velocity"]
    assert one.slots(np.array([0.01, 0.002, 0.4, 0.1])) == [[5.5, 0.01, 0.002, 0.4, 0.1]]
    assert one.half_swings(np.array([[0.01, 0.002, 0.4, 0.1]])) == pytest.approx(5.5 * 29.99 / np.pi)


def test_a_release_at_rest_is_that_of_the_first_sample():
    times, angle = swing()
    one = Problem(MODEL, [(times, angle)], "rest", False)
    assert list(one.free) == list(MODEL.parameters)
    assert one.slots(np.array([6.0, 0.01, 0.002])) == [[6.0, 0.01, 0.002, angle[0], 0.0]]


def test_a_frequency_is_nowhere_beyond_what_the_samples_show_and_a_friction_above_zero_where_bounded():
    one = Problem(MODEL, [swing(), swing(0.2, TIMES[::2])], "free", True)
    at = one.free.index("natural_frequency")
    assert 2 * np.pi * 100 / 4 <= one.upper[at] <= 2 * np.pi * 100  # of the swing with more samples
    assert one.lower[one.free.index("viscous_ratio")] == 0
    assert list(one.variables({"natural_frequency": 1e9, "viscous_ratio": -1.0}, [(0.4, 0.0), (0.2, 0.0)])[:2]) == [one.upper[at], 0.0]  # fmt: skip
    assert np.isneginf(Problem(MODEL, [swing()], "free", False).lower[one.free.index("viscous_ratio")])


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"start": "anyhow"}, "unknown start 'anyhow'"),
        ({"own": ["wind"]}, "no parameter 'wind'"),
        ({"fixed": {"wind": 1.0}}, "no parameter 'wind'"),
        ({"model": MODEL.of(RATE), "start": "rest"}, "angular rate"),
        ({"times": TIMES[:5]}, "5 samples for 5 free values"),
    ],
)
def test_what_no_fit_can_begin_with_is_refused(given, words):
    given = {"model": MODEL, "times": TIMES, "start": "free"} | given
    times, model = given.pop("times"), given.pop("model")
    with pytest.raises(InputError, match=words):
        Problem(model, [swing(times=times)], bounded=False, **given)
    assert Problem(MODEL, [swing(times=TIMES[:6])], "free", False).n == 6


def test_a_thinned_problem_has_samples_enough_and_what_is_known_weighs_as_much_beside_them():
    slack = reading_slack({"sensor_gain": {"length": 0.005}}).weighed(1e-3)
    often = np.arange(30_000) / 1000
    one = Problem(MODEL.with_slack(slack), [swing(times=often)], "free", False)
    starts = np.zeros((1, len(one.free)))
    starts[0, 0] = 6.0
    thin = one.thinned(starts)
    every = one.swings[0][0].size / thin.swings[0][0].size
    assert every > 5 and np.array_equal(thin.swings[0][0], often[:: round(every)])
    assert 8 < thin.swings[0][0].size / one.half_swings(starts) < 100
    gain = one.free.index("sensor_gain")
    assert thin.known.precision[gain, gain] == pytest.approx(one.known.precision[gain, gain] / round(every))
    assert one.known.precision[gain, gain] == pytest.approx((1e-3 / 0.005) ** 2)
    few = Problem(MODEL, [swing(times=TIMES[::10])], "free", False)
    assert few.thinned(starts) is few
    # a higher frequency needs more of them
    starts[0, 0] = 60.0
    assert one.thinned(starts).swings[0][0].size > 5 * thin.swings[0][0].size


def test_starts_are_the_guesses_and_the_decay_laid_on_all_effects_and_on_each_alone():
    one = Problem(MODEL, [swing(), swing(0.2)], "free", False)
    starts, seen = one.starts(MODEL)
    assert seen == 3 and len(starts) == 4
    assert starts[0, :3] == pytest.approx(MODEL.vector())
    assert starts[:, 0] == pytest.approx(6.0, rel=0.02)
    assert starts[:, 3] == pytest.approx(0.4, rel=0.02) and starts[:, 5] == pytest.approx(0.2, rel=0.02)
    split, viscous, load = starts[1:, 1:3]
    assert viscous[1] == load[0] == 0
    assert split == pytest.approx([viscous[0] / 2, load[1] / 2])
    assert (
        0.01 < viscous[0] < 0.03 and 0.002 < load[1] < 0.01
    )  # alone it takes more than it does beside the other
    assert one.starts(None)[0] == pytest.approx(starts[1:])
