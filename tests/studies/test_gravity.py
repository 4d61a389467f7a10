"""g from a pendulum and its lengths, against what can be worked out by hand."""

import re

import numpy as np
import pandas as pd
import pytest

from swingdown.errors import InputError
from swingdown.language import language
from swingdown.measurement.stated import Stated
from swingdown.studies.gravity import (
    Gravity,
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
