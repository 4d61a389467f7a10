"""g from a pendulum and its lengths, against what can be worked out by hand."""

import re

import numpy as np
import pandas as pd
import pytest
from scipy.special import ellipk

from swingdown.errors import InputError
from swingdown.language import language
from swingdown.measurement.stated import Stated
from swingdown.studies.gravity import (
    Gravity,
    budgets,
    gravity,
    gravity_of_two_pivots,
    of_two_pivots,
    of_words,
    with_gravity,
)

SECOND = Stated(np.pi, 0.0, "rad/s")  # the frequency of a period of 2 s


def part(found, name):
    return found.budget.set_index("quantity").loc[name]


def test_a_seconds_pendulum():
    """T = 2 s and L = 0.994 m: g = pi^2 L; a millimetre is a thousandth of it, and a ms of the period too."""
    found = gravity(Stated(np.pi, np.pi * 5e-4, "rad/s"), Stated(0.994, 0.001, "m"))
    assert found.value == pytest.approx(np.pi**2 * 0.994, rel=1e-12)
    assert part(found, "length")["contribution_m_per_s2"] == pytest.approx(np.pi**2 * 0.001)
    assert part(found, "natural frequency")["contribution_m_per_s2"] == pytest.approx(found.value * 1e-3)
    assert found.uncertainty == pytest.approx(np.hypot(np.pi**2 * 0.001, found.value * 1e-3))
    assert "point" in found.of and "g = 9.810 ± 0.014 m/s²" in found.sentence


def test_a_ball_has_two_fifths_of_its_radius_squared_more_inertia():
    length, radius = 0.5, 0.05
    ideal = gravity(SECOND, Stated(length, 1e-4))
    ball = gravity(SECOND, Stated(length, 1e-4), bob_diameter=Stated(2 * radius, 1e-4))
    assert ball.value / ideal.value == pytest.approx(1 + 0.4 * radius**2 / length**2)
    assert ball.of.startswith("a ball")


def test_air_carries_the_bob_and_is_carried_along():
    """The density of air over that of cork is 1.2 / 240: weight falls by that share, inertia rises by half of it."""
    ideal, cork = (gravity(SECOND, Stated(1.0, 1e-4), bob_density=one) for one in (None, Stated(240.0, 1.0)))
    assert cork.value / ideal.value == pytest.approx((1 + 0.5 / 200) / (1 - 1 / 200))
    assert cork.uncertainty > 10 * ideal.uncertainty  # how much air goes along is not known well


def test_without_an_uncertainty_of_the_length_none_is_invented():
    found = gravity(Stated(np.pi, 1e-3), Stated(0.994))
    assert np.isnan(found.uncertainty) and found.to_dict()["standard_uncertainty"] is None
    assert found.u_without_length == pytest.approx(2 * found.value * 1e-3 / np.pi)
    assert found.to_dict()["text"] == "9.810(?)"
    assert found.sentence == f"g = 9.810(?) m/s², {of_words(found)}" and "was not given" in found.sentence
    told = language("de").text(found.sentence)
    assert told.startswith("g = 9,810(?) m/s², für einen Punkt") and "nicht angegeben" in told


def rod(distance, length=1.0, g=9.81):
    """The frequency of a thin rod about a pivot so far from its middle."""
    return np.sqrt(g * distance / (length**2 / 12 + distance**2))


def test_a_rod_about_two_pivots_gives_g_whatever_its_inertia():
    near, far = 0.2, 0.5
    found = gravity_of_two_pivots(
        [Stated(rod(near), 1e-4), Stated(rod(far), 1e-4)], [Stated(near, 1e-4), Stated(far, 1e-4)]
    )
    assert found.value == pytest.approx(9.81, rel=1e-12)
    draw = np.random.default_rng(1).standard_normal((4, 4000)) * 1e-4
    one, other, here, there = np.array([rod(near), rod(far), near, far])[:, np.newaxis] + draw
    drawn = (here**2 - there**2) / (here / one**2 - there / other**2)
    assert found.uncertainty == pytest.approx(drawn.std(), rel=0.05)


def test_katers_pivots_have_one_period():
    """Where the periods are equal, g is that of a string as long as the pivots are apart."""
    found = gravity_of_two_pivots([SECOND, SECOND], [Stated(0.6, 1e-4), Stated(0.394, 1e-4)])
    assert found.value == pytest.approx(np.pi**2 * 0.994)


@pytest.mark.parametrize(("frequencies", "distances"), [((5.0, 5.0), (0.3, 0.3)), ((4.0, 5.0), (0.5, 0.6)), ((5.0, 4.0), (0.5, 0.6))])  # fmt: skip
def test_pivots_that_no_body_has_are_refused(frequencies, distances):
    """The same distance twice, a g below 0, and an inertia below 0."""
    with pytest.raises(InputError, match="give no g"):
        gravity_of_two_pivots(
            [Stated(one, 1e-4) for one in frequencies], [Stated(one, 1e-4) for one in distances]
        )


def row(name, **cells):
    known = {
        "campaign": "one",
        "recording": name,
        "natural_frequency_rad_per_s": np.pi,
        "natural_frequency_rad_per_s_u": 1e-3,
    }
    return known | {"period_s": 2.02, "amplitude_rad": 0.3} | cells  # fmt: skip


def test_what_no_body_has_is_told_by_its_distances_and_periods():
    with pytest.raises(InputError, match=r"0\.5 m and 0\.6 m give no g with periods of 2 s and 4 s"):
        gravity_of_two_pivots([SECOND, Stated(np.pi / 2, 1e-4)], [Stated(0.5, 1e-4), Stated(0.6, 1e-4)])


def test_recordings_of_one_pendulum_share_its_length():
    table = pd.DataFrame([row("a"), row("b"), row("(joint)")])
    both, found = with_gravity(table, {"a": {"length": "99.4(1) cm"}, "b": {"length": "99.4(1) cm"}})
    assert list(both["g_m_per_s2_text"]) == ["9.810(12)"] * 3 and list(found) == ["a", "b", "one"]
    other, found = with_gravity(table, {"a": {"length": "99.4(1) cm"}, "b": {"length": "0.5"}})
    assert list(found) == ["a", "b"] and "is the length's unit right" not in other["g_of"].iloc[1]


def test_a_body_about_two_pivots_needs_two_periods_and_two_distances():
    table = pd.DataFrame([row("a"), row("b"), row("c", natural_frequency_rad_per_s=np.nan)])
    first, second = rod(0.3), rod(0.45)
    known = table.assign(natural_frequency_rad_per_s=[first, second, np.nan])
    pivots = {"a": {"pivot_distance": "0.3000(1)"}, "b": {"pivot_distance": "0.4500(1)"}}
    (found,) = of_two_pivots(known, pivots).values()
    assert found.value == pytest.approx(9.81, abs=3 * found.uncertainty)
    assert of_two_pivots(known, {"a": {"length": "1"}}) == {}
    for lacking in ({"a": pivots["a"]}, {"a": pivots["a"], "c": pivots["b"]}):
        with pytest.raises(InputError, match="1 recordings with a period and the distance of a pivot"):
            of_two_pivots(known, lacking)


def test_how_much_air_goes_along_is_half_of_what_is_displaced_give_or_take_as_much():
    found = gravity(SECOND, Stated(1.0, 1e-4), bob_density=Stated(240.0, 1.0))
    (carried,) = found.budget[found.budget["value"] == 0.5].to_dict("records")
    assert carried["standard_uncertainty"] == pytest.approx(0.5 / np.sqrt(3))  # a rectangle from none to all


def test_no_g_of_a_spring_of_pixels_or_without_a_frequency():
    table = pd.DataFrame([row("a")])
    assert not with_gravity(table, {"a": {"length": "1"}}, restoring="linear")[1]
    assert not with_gravity(table, {"a": {"length": "350px"}})[1]
    assert not with_gravity(table.assign(natural_frequency_rad_per_s=np.nan), {"a": {"length": "1"}})[1]


def test_centimetres_taken_for_metres_are_told():
    table, _ = with_gravity(pd.DataFrame([row("a")]), {"a": {"length": "99.4"}})
    assert "no place on Earth has it: are the units of length and time right" in table["g_of"].iloc[0]


@pytest.mark.parametrize("code", ["de", "fr", "es", "it", "pt"])
def test_what_is_said_of_g_is_said_in_each_language(code):
    one = Gravity(30.6, np.nan, 0.05, "a point on a string without mass, air left out", pd.DataFrame())
    words = of_words(one)
    assert "no place on Earth" in words and "was not given" in words
    told = language(code).text(words)
    assert not {"without", "place", "units", "length", "given", "else"} & set(re.findall(r"[a-z]+", told))


def test_a_budget_says_what_the_fit_has_taken_off_the_period():
    """The square of the elliptic period's factor, and what else the period of the swing is longer than that of small undamped ones by."""
    found = gravity(SECOND, Stated(0.994, 1e-3), amplitude=0.6, period=2.06)
    amplitude, damping = found.budget["value"].tolist()[-2:]
    assert amplitude == pytest.approx((2 / np.pi * ellipk(np.sin(0.3) ** 2)) ** 2)
    assert amplitude * damping == pytest.approx((2.06 / 2) ** 2)
    assert "34.4°" in found.budget["quantity"].iloc[-2]
    assert len(gravity(SECOND, Stated(0.994, 1e-3), amplitude=0.6).budget) == len(found.budget) - 2


def test_sensitivities_are_slopes_with_their_signs():
    """By differences: g rises with the length and the frequency, and falls where a bob is denser."""
    inputs = {"natural_frequency": np.pi, "length": 0.5, "bob_diameter": 0.1, "bob_density": 800.0}
    stated = {name: Stated(value, 1e-4) for name, value in inputs.items()}
    found = gravity(**stated)
    names = {"natural frequency": "natural_frequency", "length": "length", "bob's diameter": "bob_diameter", "bob's density": "bob_density"}  # fmt: skip
    for told, name in names.items():
        ends = [gravity(**stated | {name: Stated(inputs[name] * (1 + h), 1e-4)}).value for h in (-1e-5, 1e-5)]
        slope = (ends[1] - ends[0]) / (2e-5 * inputs[name])
        assert part(found, told)["sensitivity"] == pytest.approx(slope, rel=1e-6)
        assert part(found, told)["contribution_m_per_s2"] == pytest.approx(abs(slope) * 1e-4, rel=1e-6)
    parts = found.budget["contribution_m_per_s2"].to_numpy(float)
    assert found.uncertainty == pytest.approx(np.sqrt(np.sum(parts**2)))
    held = np.delete(parts, list(found.budget["quantity"]).index("length"))
    assert found.u_without_length == pytest.approx(np.sqrt(np.sum(held**2)))


def test_budgets_stand_below_each_other_each_with_its_g():
    each = {"a": gravity(SECOND, Stated(0.994, 1e-3)), "b": gravity(SECOND, Stated(1.0, 1e-3))}
    whole = budgets(each)
    assert list(whole["recording"]) == ["a"] * 3 + ["b"] * 3
    own = whole[whole["quantity"] == "g"]
    assert list(own["value"]) == [one.value for one in each.values()]
    assert list(own["contribution_m_per_s2"]) == [one.uncertainty for one in each.values()]
    assert list(own["sensitivity"]) == [1.0, 1.0] and budgets({}).empty
